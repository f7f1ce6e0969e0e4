# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The ROS doors of one bearing: its topics, services, diagnostics and recordings, in front of its `LiveModel`."""

import dataclasses
import subprocess
import time
from functools import partial
from pathlib import Path

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_srvs.srv import SetBool, Trigger

from bearing_sim import topics
from bearing_sim.effects import hint
from bearing_sim.events import Event, Level
from bearing_sim.ros.cheaper_levels import levels_to_compile, start_compiling
from bearing_sim.ros.event_log import log_event
from bearing_sim.ros.inputs import InputReader, Refused
from bearing_sim.ros.messages import message_class
from bearing_sim.ros.outputs import Outputs, Soon
from bearing_sim.ros.parameters import OIL_TEMPERATURE, BearingSettings, NodeSettings, scene_value
from bearing_sim.ros.recordings import fresh_path, limits_of, open_lossless_recording, open_recording, open_view, prepare
from bearing_sim.ros.sim_time import OUTPUT_QOS, follows_clock, subscribe_to_all
from bearing_sim.ros.warm_up import WarmUp
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Condition
from bearing_sim.runtime.live import LiveModel, governor_of, warmed_up
from bearing_sim.runtime.sim_time import SimTimeModel
from bearing_sim.scene import Scene
from bearing_sim.scene_file import load_scene
from bearing_sim.scene_monitoring import with_thresholds
from bearing_sim.simulation import IntegrationError, Simulation

_DIAGNOSTICS_PERIOD = 1.0  # [s] (REP 107)
STATE_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
# As sensor data, so that any publisher matches, but deeper: a recording shall not miss inputs when the machine stalls.
_INPUT_QOS = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)


class BearingDoors:
    """One bearing of a node, from the node's configure to its cleanup.

    All methods belong to the node's thread but for `warm_up`.

    Parameters
    ----------
    node : on which topics and services are made.
    settings : of this bearing; one with a name has topics and services below it.
    shared : settings of the node.

    Raises
    ------
    SceneError
        The scene cannot be used.
    """

    def __init__(self, node: LifecycleNode, settings: BearingSettings, shared: NodeSettings):
        self._node, self._logger, self.settings, self._shared = node, node.get_logger(), settings, shared
        self.scene: Scene = load_scene(settings.scene, settings.scene_overrides)
        self.live: LiveModel | None = None
        self.fault = ""  # why the model cannot run; told until the next configure
        self._fault_cause: Exception | None = None
        self._simulation: Simulation | None = None
        self._governor: Governor | None = None
        self._joining: Governor | None = None  # made on the thread of warm_up, to be taken over
        self._compiling: subprocess.Popen | None = None
        self._last_level: Level | None = None
        self._next_report_ns = 0
        self._now_ns = node.now_ns
        self._subscriptions = {}
        component = node.get_fully_qualified_name().lstrip("/")
        self.component = f"{component}/{settings.name}" if settings.name else component
        self.hardware_id = f"{settings.name}/{self.scene.bearing.name}" if settings.name else self.scene.bearing.name
        self._outputs = Outputs(node, self.scene, self._topic_name, OUTPUT_QOS if follows_clock(node) else STATE_QOS)
        self._publish_soon = Soon(node, self._publish_due)
        self._services = [
            node.create_service(kind, self._service_name(name), serve)
            for kind, name, serve in (
                (Trigger, "reset", self._serve_reset),
                (Trigger, "start_recording", self._serve_start_recording),
                (Trigger, "stop_recording", self._serve_stop_recording),
                (SetBool, "pause", self._serve_pause),
            )
        ]
        self.say(f"scene {self.scene.name!r}, bearing {self.scene.bearing.name!r}, level {self.scene.level!r}: warming up")
        if cheaper := hint(self.scene):
            self.say(cheaper)

    @property
    def is_warm(self) -> bool:
        """Whether the model is compiled."""
        return self._simulation is not None

    def warm_up(self) -> None:
        """Compile or load the model; takes seconds to minutes.  Belongs to a thread of its own, see `warm_up`."""
        settings = self.settings
        try:
            prepare(bool(settings.rrd or settings.rerun_port), None if follows_clock(self._node) else self._node.recorder)
            self._outputs.lay_out()
            simulation = warmed_up(self.scene)
            governs = self._shared.governor and not follows_clock(self._node)  # by sim time nothing is given up
            if governs and levels_to_compile(self.scene):
                self._compiling = start_compiling(self.scene)
            elif governs:
                self._governor = governor_of(simulation)
            self._simulation = simulation
        except IntegrationError as fault:
            self.fault, self._fault_cause = f"the scene's own operating conditions cannot be computed: {fault}", fault
        except Exception as fault:  # a fault of the program: told by the node, which is where people look
            self.fault, self._fault_cause = f"the model could not be made: {fault!r}", fault

    def open(self) -> None:
        """Begin a run: run time 0 is now, or with sim time where the inputs begin; open recordings and subscriptions.

        Raises
        ------
        OSError
            A recording or a view cannot be opened.
        """
        settings = self.settings
        # By wall time, the same as of the node's clock at a fraction of the cost.
        self._now_ns = self._node.now_ns if follows_clock(self._node) else time.time_ns
        self.live = self._sim_time_model() if follows_clock(self._node) else self._wall_time_model()
        if settings.record:
            self._start_recording(Path(settings.record))
        if settings.rrd or settings.rerun_port:
            self.live.open("view", lambda start_ns: open_view(self.scene, start_ns, settings.rrd, settings.rerun_port))
        for channel, topic in topics.INPUTS.items():
            ros_type = topic.ros_type
            if self._shared.input_type == "scalar" and "std_msgs/msg/Float64" in topics.input_types(channel):
                ros_type = "std_msgs/msg/Float64"
            self._subscribe(channel, ros_type)
        self._subscribe(topics.MEASURED, topics.MEASUREMENTS[topics.MEASURED].ros_type)
        self.say("ready: listening to shaft_speed and radial_load")
        if self._compiling is not None:
            self.say("compiling cheaper levels for the governor beside this, once for this version")

    def _wall_time_model(self) -> LiveModel:
        governor = self._governor if self._shared.governor else None
        shared, due = self._shared, self._publish_soon
        timing = {"sample_rate": shared.sample_rate, "maximum_lag": shared.maximum_lag, "publish_rate": shared.publish_rate}
        return LiveModel(self.scene, self._simulation, self._node.now_ns(), **timing, governor=governor, due=due, receiver=self._now_ns)

    def _sim_time_model(self) -> SimTimeModel:
        shared = self._shared
        model = SimTimeModel(self.scene, self._simulation, shared.sample_rate, shared.publish_rate, shared.clock_jump_back)
        model.tick(self._node.now_ns())
        return model

    def tick(self, now_ns: int) -> None:
        """Take in a reading of /clock, where the model follows it."""
        if isinstance(self.live, SimTimeModel):
            self.live.tick(now_ns)

    def close(self) -> bool:
        """End the run, complete recordings.  Returns whether the solver's thread ended; else the model must be warmed up anew."""
        for subscription in self._subscriptions.values():
            self._node.destroy_subscription(subscription)
        self._subscriptions = {}
        live, self.live = self.live, None
        stopped = live.close() if live is not None else True
        if not stopped:
            self._simulation = self._governor = None
        return stopped

    def destroy(self) -> bool:
        """Take the doors away.  Returns whether the solver's thread ended."""
        stopped = self.close()
        if self._compiling is not None:
            self._compiling.kill()
            self._compiling.wait()
        for service in self._services:
            self._node.destroy_service(service)
        self._outputs.destroy()
        return stopped

    def review(self, now_ns: int, state: Event, warm_up: WarmUp) -> None:
        """Feed the sinks, log what is new, and report when a second has passed or the level has changed.

        Parameters
        ----------
        state : what the node's lifecycle calls for; told while the model does not run.
        warm_up : makes a governor when its levels are compiled.
        """
        if self.live is None:
            told = Event(0.0, Level.ERROR, "run.failed", self.fault) if self.fault else state
            if self._report_is_due(told.level):
                self._report(now_ns, Condition([told], {}))
            return
        self._join_governor(warm_up)
        for event in self.live.collect(now_ns):
            log_event(self._logger, event, self.settings.name)
        self._outputs.look()
        if follows_clock(self._node):  # by wall time outputs leave as they come
            self._publish()
        if self._report_is_due(self.live.level):
            self._report(now_ns, self.live.condition(now_ns))

    def _report_is_due(self, level: Level) -> bool:
        return level != self._last_level or time.monotonic_ns() >= self._next_report_ns  # not by /clock, which may stand still

    def _report(self, now_ns: int, condition: Condition) -> None:
        """Publish the condition on /diagnostics."""
        if self.live is not None:  # now and then is enough
            for channel, subscription in self._subscriptions.items():
                self.live.note_senders(channel, self._node.count_publishers(subscription.topic_name))
        self._last_level = condition.level
        self._next_report_ns = time.monotonic_ns() + round((_DIAGNOSTICS_PERIOD - self._node.review_period / 2) * 1e9)
        self._node.tell(now_ns, condition, self.component, self.hardware_id)
        if self.live is not None:
            self.live.record_diagnostics(condition, now_ns)

    def objection(self, changes: dict[str, object]) -> str:
        """Return why parameters of this bearing cannot be changed so; empty where they can."""
        if OIL_TEMPERATURE in changes and self.live is not None and self.live.gate.accepted["oil_temperature"]:
            return f"{OIL_TEMPERATURE}: the topic oil_temperature has given the temperature in this run, and counts instead"
        try:
            with_thresholds(self.scene.thresholds, _thresholds(changes))
        except ValueError as fault:
            return str(fault)
        return ""

    def apply(self, changes: dict[str, object]) -> None:
        """Change parameters of this bearing from now on."""
        if found := _thresholds(changes):
            thresholds = with_thresholds(self.scene.thresholds, found)
            self.scene = dataclasses.replace(self.scene, thresholds=thresholds)
            if self.live is not None:
                self.live.adjust(thresholds)
        if OIL_TEMPERATURE in changes:
            self.scene = dataclasses.replace(self.scene, lubricant=dataclasses.replace(self.scene.lubricant, temperature=changes[OIL_TEMPERATURE]))
            if self.live is not None:
                self.live.hold_oil_temperature(changes[OIL_TEMPERATURE], self._node.now_ns())

    def publish_at(self, rate: float) -> None:
        """Publish so often from now on [Hz], with sim time for each simulated second."""
        self._shared = dataclasses.replace(self._shared, publish_rate=rate)
        if self.live is not None:
            self.live.publish_at(rate)

    def govern(self, wanted: bool, warm_up: WarmUp) -> None:
        """Let a governor change levels from now on, made by ``warm_up`` where there is none yet, or let none."""
        self._shared = dataclasses.replace(self._shared, governor=wanted)
        if follows_clock(self._node):
            return
        if wanted and self._governor is None and self._compiling is None and self.is_warm:
            warm_up.ask(self._make_governor)
        elif self.live is not None:
            self.live.govern(self._governor if wanted else None)

    def report_soon(self) -> None:
        """Publish diagnostics at the next review, whenever the last were."""
        self._next_report_ns = 0

    def say(self, text: str) -> None:
        """Log something about this bearing."""
        self._logger.info(f"{self.settings.name}: {text}" if self.settings.name else text)

    def _publish_due(self) -> None:
        self._publish()
        self._node.review_if_late()

    def _publish(self) -> None:
        """Publish what is new: with sim time every output at its stamp, else the newest."""
        if self.live is None:  # the run has ended since this was asked for
            return
        for stamp_ns, sample in self.live.published():
            self._outputs.publish(stamp_ns, sample)
        for stamp_ns, residual in self.live.residuals():
            self._outputs.publish_residual(stamp_ns, residual)

    def _subscribe(self, channel: str, ros_type: str) -> None:
        joint = self.settings.cage_joint if channel == topics.MEASURED else self.settings.joint
        taking = partial(self._take, channel, InputReader(channel, ros_type, joint, self.settings.frame_id))
        kind, name = message_class(ros_type), self._topic_name(channel)
        if follows_clock(self._node):
            replaced = partial(self._subscriptions.__setitem__, channel)
            self._subscriptions[channel] = subscribe_to_all(self._node, kind, name, taking, replaced, self._tell_loss)
            return
        quiet = SubscriptionEventCallbacks(use_default_callbacks=False)  # any publisher matches: nothing to watch
        self._subscriptions[channel] = self._node.create_subscription(kind, name, taking, _INPUT_QOS, event_callbacks=quiet, raw=True)

    def _tell_loss(self, text: str) -> None:
        if self.live is not None:
            self.live.note_loss(text)

    def _topic_name(self, name: str) -> str:
        return f"{self.settings.name}/{name}" if self.settings.name else name

    def _service_name(self, name: str) -> str:
        return f"{self.settings.name}/{name}" if self.settings.name else f"~/{name}"

    def _make_governor(self) -> None:
        """Make a governor; belongs to the thread of `warm_up`."""
        try:
            self._joining = governor_of(self._simulation)
        except IntegrationError as fault:
            self._logger.warning(f"no cheaper level can take over: {fault}")

    def _join_governor(self, warm_up: WarmUp) -> None:
        """Let the governor begin once the cheaper levels are compiled; until then time is given up where the machine is too slow."""
        if self._compiling is not None and self._compiling.poll() is not None:
            self._compiling = None
            warm_up.ask(self._make_governor)
        if self._joining is not None:
            self._governor, self._joining = self._joining, None
            if self._shared.governor:
                self.live.govern(self._governor)
                self.say("the cheaper levels are compiled: the governor can fall back on them")

    def _take(self, channel: str, reader: InputReader, cdr: bytes) -> None:
        if self.live is None:  # a message that was on its way when the run ended
            return
        now_ns = self._now_ns()
        try:
            values, stamp_ns, frame_id = reader.read(cdr)
        except Refused as fault:
            self.live.refuse(channel, fault.code, str(fault), now_ns)
            return
        self.live.offer(channel, values, stamp_ns, now_ns, frame_id)

    def _start_recording(self, path: Path) -> None:
        def opened(start_ns: int):
            limits = limits_of(self._shared)
            if follows_clock(self._node):
                sink = open_lossless_recording(path, self.scene, start_ns, limits)
            else:
                sink = open_recording(path, self.scene, start_ns, limits, self.live.cadence, self._node.recorder)
            self.say(f"recording {sink.path}" + (f" ({path} exists and stays as it is)" if sink.path != path else ""))
            return sink

        self.live.open("record", opened, anew=True)

    def _refused(self, response) -> bool:
        """Fill the response where there is no run to serve; return whether so."""
        if self.live is None:
            response.success, response.message = False, f"not running: {self.fault or 'activate the node first, and let it warm up'}"
        return self.live is None

    def _serve_start_recording(self, _, response):
        if self._refused(response):
            return response
        if self.live.has("record"):
            response.success, response.message = False, "a recording is going on; stop it first"
            return response
        name = f"run_{self.settings.name}" if self.settings.name else "run"
        path = fresh_path(Path(self.settings.record or f"recordings/{name}.mcap"))
        try:
            self._start_recording(path)
        except OSError as fault:
            response.success, response.message = False, str(fault)
        else:
            response.success, response.message = True, str(path.resolve())
        return response

    def _serve_stop_recording(self, _, response):
        if self._refused(response):
            return response
        try:
            sink = self.live.detach("record")
        except OSError as fault:
            response.success, response.message = False, str(fault)
        else:
            response.success = sink is not None
            response.message = f"{sink.path} is complete" if sink is not None else "there is no recording to stop"
        return response

    def _serve_reset(self, _, response):
        if self._refused(response):
            return response
        response.success = self.live.reset()
        late = "not done within two seconds; it is done after the running tick"
        response.message = "state and damage are at the start" if response.success else late
        return response

    def _serve_pause(self, request, response):
        if self._refused(response):
            return response
        self.live.runner.pause(request.data)
        response.success, response.message = True, "paused" if request.data else "running"
        return response


def _thresholds(changes: dict[str, object]) -> dict[str, object]:
    return {name.removeprefix("thresholds."): scene_value(name, value) for name, value in changes.items() if name.startswith("thresholds.")}
