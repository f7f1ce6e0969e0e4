# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_node`: the bearing as a ROS 2 node.

Subscribes to shaft speed and radial load, advances the model in real time on its own thread, publishes cage slip, life
and roller loads, tells its health on ``/diagnostics``, and records when asked to.  Everything but the ROS doors is in
`bearing_sim.runtime.live`.  Run by ``bearing_node``, ``python -m bearing_sim.ros.node`` or ``ros2 run bearing_sim bearing_node``.
"""

import subprocess
import sys
import threading
from functools import partial
from pathlib import Path

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_srvs.srv import SetBool, Trigger

from bearing_sim import topics
from bearing_sim.effects import hint
from bearing_sim.events import Event, Level
from bearing_sim.ros.cheaper_levels import levels_to_compile, start_compiling
from bearing_sim.ros.messages import message, message_class
from bearing_sim.ros.parameters import Settings, SettingsError, declare
from bearing_sim.ros.process import CannotRun, run_node
from bearing_sim.ros.recordings import fresh_path, limits_of, open_recording, open_view, prepare
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Condition
from bearing_sim.runtime.live import LiveModel, governor_of, warmed_up
from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, load_scene
from bearing_sim.simulation import IntegrationError, Simulation

_REVIEW_PERIOD = 0.05  # [s] how soon a change of health is told
_DIAGNOSTICS_PERIOD = 1.0  # [s] (REP 107)
_STATE_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
# As sensor data, so that any publisher matches, but deeper: a recording shall not miss inputs when the machine stalls.
_INPUT_QOS = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)


class BearingNode(Node):
    """The ROS doors of a `LiveModel`: parameters, topics, services, diagnostics.

    Raises
    ------
    SettingsError, SceneError
        The parameters or the scene cannot be used.
    """

    def __init__(self):
        super().__init__("bearing_node", automatically_declare_parameters_from_overrides=True)
        self.settings: Settings = declare(self)
        self.scene: Scene = load_scene(self.settings.scene, self.settings.overrides)
        self.live: LiveModel | None = None
        self._warm_up_fault: Exception | None = None
        self._governor: Governor | None = None
        self._compiling: subprocess.Popen | None = None
        self._last_level: Level | None = None
        self._next_report_ns = 0
        self._published_time = float("-inf")
        name, ros_type = topics.DIAGNOSTICS
        self._diagnostics = self.create_publisher(message_class(ros_type), f"/{name}", _STATE_QOS)
        self._outputs = {
            topic.name: self.create_publisher(message_class(topic.ros_type), topic.name, _STATE_QOS) for topic in topics.outputs(self.scene).values()
        }
        residual = topics.MEASUREMENTS["cage_slip_residual"]
        self._residual, self._residual_time = self.create_publisher(message_class(residual.ros_type), residual.name, _STATE_QOS), float("-inf")
        # Compiling takes seconds: on its own thread, so that the node answers signals and says what it is doing.
        self._warm_up = threading.Thread(target=self._compile, name="warm-up", daemon=True)
        self._warm_up.start()
        self.create_timer(_REVIEW_PERIOD, self._review)
        self.get_logger().info(f"scene {self.scene.name!r}, bearing {self.scene.bearing.name!r}, level {self.scene.level!r}: warming up")
        if cheaper := hint(self.scene):
            self.get_logger().info(cheaper)

    def close(self) -> bool:
        """Stop the model and complete recordings.  Returns whether every thread ended."""
        if self._compiling is not None:
            self._compiling.kill()
        stopped = self.live.close() if self.live is not None else True
        return stopped and not self._warm_up.is_alive()

    def _compile(self) -> None:
        try:
            prepare(view=bool(self.settings.rrd or self.settings.rerun_port))
            self._simulation: Simulation = warmed_up(self.scene, self.settings.sample_rate)
            if self.settings.governor and levels_to_compile(self.scene):
                self._compiling = start_compiling(self.scene, self.settings.sample_rate)
            elif self.settings.governor:
                self._governor = governor_of(self._simulation, self.settings.sample_rate)
        except Exception as fault:  # handed over to the main thread, which raises it
            self._warm_up_fault = fault

    def _join_governor(self) -> None:
        """Let the governor begin once the cheaper levels are compiled; until then time is given up where the machine is too slow."""
        if self._compiling is None or self._compiling.poll() is None:
            return
        self._compiling = None
        try:
            governor = governor_of(self._simulation, self.settings.sample_rate)
        except IntegrationError as fault:
            self.get_logger().warning(f"no cheaper level can take over: {fault}")
            return
        if governor is not None:
            self.live.govern(governor)
            self.get_logger().info("the cheaper levels are compiled: the governor can fall back on them")

    def _open(self) -> None:
        """Begin: run time 0 is now; open recordings, subscriptions and services."""
        settings = self.settings
        start_ns = self._now_ns()
        self.live = LiveModel(self.scene, self._simulation, start_ns, settings.sample_rate, settings.maximum_lag, governor=self._governor)
        try:
            if settings.record:
                self._start_recording(Path(settings.record))
            if settings.rrd or settings.rerun_port:
                self.live.attach("view", open_view(self.scene, start_ns, settings.rrd, settings.rerun_port))
        except OSError as fault:
            raise CannotRun(str(fault)) from None
        for channel, topic in topics.INPUTS.items():
            ros_type = topic.ros_type
            if settings.input_type == "scalar" and "std_msgs/msg/Float64" in topics.input_types(channel):
                ros_type = "std_msgs/msg/Float64"
            self.create_subscription(message_class(ros_type), channel, partial(self._take, channel, ros_type), _INPUT_QOS)
        ros_type = topics.MEASUREMENTS[topics.MEASURED].ros_type
        self.create_subscription(message_class(ros_type), topics.MEASURED, partial(self._take, topics.MEASURED, ros_type), _INPUT_QOS)
        self.create_service(Trigger, "~/reset", self._serve_reset)
        self.create_service(Trigger, "~/start_recording", self._serve_start_recording)
        self.create_service(Trigger, "~/stop_recording", self._serve_stop_recording)
        self.create_service(SetBool, "~/pause", self._serve_pause)
        self.create_timer(1.0 / settings.publish_rate, self._publish)
        self.get_logger().info("ready: listening to shaft_speed and radial_load")
        if self._compiling is not None:
            self.get_logger().info("compiling cheaper levels for the governor beside this, once for this version")

    def _take(self, channel: str, ros_type: str, incoming) -> None:
        now_ns = self._now_ns()
        try:
            joint = self.settings.cage_joint if channel == topics.MEASURED else self.settings.joint
            values = topics.input_values(channel, ros_type, incoming, joint)
        except ValueError as fault:
            self.live.refuse(channel, "input.malformed", str(fault), now_ns)
            return
        self.live.offer(channel, values, topics.header_stamp_ns(incoming), now_ns, topics.frame_of(incoming))

    def _publish(self) -> None:
        """Publish the newest sample, if it is new."""
        sample = self.live.runner.newest
        if sample is None or sample["time"] <= self._published_time:
            return
        self._published_time = float(sample["time"])
        stamp_ns = self.live.start_ns + round(self._published_time * 1e9)
        for name, publisher in self._outputs.items():
            topic = topics.OUTPUTS[name]
            publisher.publish(message(topic.ros_type, topic.message(stamp_ns, sample)))
        compared = self.live.residual
        if compared.time > self._residual_time:
            self._residual_time, topic = compared.time, topics.MEASUREMENTS["cage_slip_residual"]
            self._residual.publish(message(topic.ros_type, topic.message(stamp_ns, compared.residual)))

    def _review(self) -> None:
        """Feed the sinks, log what is new, and report when a second has passed or the level has changed."""
        now_ns = self._now_ns()
        if self.live is None:
            if isinstance(self._warm_up_fault, IntegrationError):
                raise CannotRun(f"the scene's own operating conditions cannot be computed: {self._warm_up_fault}", exit_code=1)
            if self._warm_up_fault is not None:
                raise self._warm_up_fault
            if self._warm_up.is_alive():
                warming = Event(0.0, Level.WARN, "run.warming_up", "warming up: compiling the model; messages that come now are not used")
                self._report(now_ns, Condition([warming], {}))
                return
            self._open()
            now_ns = self._now_ns()
        self._join_governor()
        for event in self.live.collect(now_ns):
            self._log(event)
        self._report(now_ns, self.live.condition(now_ns))

    def _report(self, now_ns: int, condition: Condition) -> None:
        if now_ns < self._next_report_ns and condition.level == self._last_level:
            return
        self._last_level = condition.level
        self._next_report_ns = now_ns + round((_DIAGNOSTICS_PERIOD - _REVIEW_PERIOD / 2) * 1e9)
        fields = topics.diagnostics(now_ns, condition.events, condition.values, self.get_name(), self.scene.bearing.name)
        self._diagnostics.publish(message(topics.DIAGNOSTICS[1], fields))
        if self.live is not None:
            self.live.record_diagnostics(condition, now_ns)

    def _log(self, event: Event) -> None:
        logger, line = self.get_logger(), f"{event.code}: {event.text}"
        # rclpy refuses a line of code that logs at more than one severity.
        if event.level == Level.ERROR:
            logger.error(line)
        elif event.level == Level.WARN:
            logger.warning(line)
        else:
            logger.info(line)

    def _start_recording(self, path: Path) -> None:
        sink = open_recording(path, self.scene, self.live.start_ns, limits_of(self.settings), self.settings.sample_rate)
        self.live.attach("record", sink)
        taken = "" if sink.path == path else f" ({path} exists and stays as it is)"
        self.get_logger().info(f"recording {sink.path}{taken}")

    def _serve_start_recording(self, _, response):
        if self.live.has("record"):
            response.success, response.message = False, "a recording is going on; stop it first"
            return response
        path = fresh_path(Path(self.settings.record or "recordings/run.mcap"))
        try:
            self._start_recording(path)
        except OSError as fault:
            response.success, response.message = False, str(fault)
        else:
            response.success, response.message = True, str(path.resolve())
        return response

    def _serve_stop_recording(self, _, response):
        try:
            sink = self.live.detach("record")
        except OSError as fault:
            response.success, response.message = False, str(fault)
        else:
            response.success = sink is not None
            response.message = f"{sink.path} is complete" if sink is not None else "there is no recording to stop"
        return response

    def _serve_reset(self, _, response):
        response.success = self.live.runner.reset()
        late = "not done within two seconds; it is done after the running tick"
        response.message = "state and damage are at the start" if response.success else late
        return response

    def _serve_pause(self, request, response):
        self.live.runner.pause(request.data)
        response.success, response.message = True, "paused" if request.data else "running"
        return response

    def _now_ns(self) -> int:
        return self.get_clock().now().nanoseconds


def _make_node() -> BearingNode:
    try:
        return BearingNode()
    except (SceneError, SettingsError) as fault:
        raise CannotRun(str(fault)) from None


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM.

    Returns
    -------
    0 after a signal, 2 when parameters, scene or recording paths cannot be used, 1 when the scene cannot be computed.
    """
    return run_node("bearing_node", _make_node, args)


if __name__ == "__main__":
    sys.exit(main())
