# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The ROS interface of one bearing: its topics, services, diagnostics and recordings, in front of its live model."""

import dataclasses
import math
import shlex
import subprocess
import time
from collections.abc import Callable
from contextlib import ExitStack
from difflib import SequenceMatcher
from functools import partial
from pathlib import Path

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from std_srvs.srv import SetBool, Trigger

from bearing_sim.files.extras import what_is_missing
from bearing_sim.inputs.gate import REQUIRED, Sources
from bearing_sim.messages import topics
from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.sample_messages import FilledMessages, SampleMessages, message_templates
from bearing_sim.messages.topics import Topic
from bearing_sim.ros.messages import InputReader, Refused, message, message_class
from bearing_sim.ros.parameters import OIL_TEMPERATURE, BearingSettings, NodeSettings, follows_clock, scene_values_in
from bearing_sim.ros.polling import PolledSubscriptions
from bearing_sim.ros.qos import INPUT_QOS, LOSSY_QOS, entities_of_bearing, profiles
from bearing_sim.ros.rclpy_internals import raw_publish
from bearing_sim.ros.recordings import fresh_path, limits_of, open_recording, open_view, prepare
from bearing_sim.ros.warm_up import WarmUp, levels_to_compile
from bearing_sim.runtime.governor import RECORD as GOVERNOR_RECORD
from bearing_sim.runtime.governor import Governor, governor_record, settings_to_fall
from bearing_sim.runtime.health import Condition, Phase, not_running
from bearing_sim.runtime.live import LiveModel, governor_of, warmed_up
from bearing_sim.runtime.sim_time import SimTimeModel
from bearing_sim.scene.fidelity import hint
from bearing_sim.scene.loader import load_scene, measured_of
from bearing_sim.scene.measured_tradeoffs import Setting, Tradeoffs
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import messages, with_values
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.view.viewer import stream_url, viewer_command
from bearing_sim.watchers.monitoring.watchers import MEMORY, SERVICES, Watcher, kind_of, resources

_DIAGNOSTICS_PERIOD = 1.0  # [s] (REP 107)
_SCALAR = "std_msgs/msg/Float64"


def subscribe_to_all(
    node: Node,
    kind: type,
    topic: str,
    callback: Callable,
    profile: QoSProfile,
    replace: Callable[[Subscription], None],
    report_loss: Callable[[str], None],
) -> Subscription:
    """Return a subscription to serialised messages that loses none where its publishers are reliable.

    Parameters
    ----------
    kind, topic, callback, profile : as for ``create_subscription``.
    replace : called with the subscription that takes over when a publisher offers best effort only; messages may then be lost.
    report_loss : called with a text when that happens, and when messages were lost.
    """

    def fall_back(_) -> None:
        if fallen:
            return
        fallen.append(True)
        report_loss(f"{topic}: a publisher offers best effort only; if messages are lost, this run differs from the recording")
        node.destroy_subscription(subscription)
        replace(node.create_subscription(kind, topic, callback, LOSSY_QOS, event_callbacks=losses, raw=True))

    fallen: list[bool] = []
    losses = SubscriptionEventCallbacks(
        message_lost=lambda info: report_loss(f"{topic}: {info.total_count} messages were lost; inputs are interpolated linearly across the gap")
    )
    events = SubscriptionEventCallbacks(incompatible_qos=fall_back, message_lost=losses.message_lost)
    subscription = node.create_subscription(kind, topic, callback, profile, event_callbacks=events, raw=True)
    return subscription


class PublishedTopics:
    """Finds topics that somebody publishes; looks once a second for all bearings of a node.

    Parameters
    ----------
    node : asked for the graph.
    """

    def __init__(self, node: Node):
        self._node, self._looked_at = node, -math.inf
        self._by_type: dict[str, list[str]] = {}

    def like(self, name: str, ros_type: str) -> tuple[str, ...]:
        """Return at most two topics of a type, other than outputs of bearings, those first whose names are closest to ``name``."""
        if time.monotonic() - self._looked_at >= _DIAGNOSTICS_PERIOD:
            self._looked_at, self._by_type = time.monotonic(), {}
        if ros_type not in self._by_type:
            of_type = (found for found, types in self._node.get_topic_names_and_types() if ros_type in types)
            own = {subscription.topic_name for subscription in self._node.subscriptions}
            candidates = (found for found in of_type if found not in own and found.rpartition("/")[2] not in topics.OUTPUTS)
            self._by_type[ros_type] = sorted(found for found in candidates if self._node.count_publishers(found))
        ranked = sorted(self._by_type[ros_type], key=lambda found: -SequenceMatcher(None, found, name).ratio())
        return tuple(ranked[:2])


class DeferredCall:
    """Schedules an action on the thread that spins a node; requests made before it runs are merged into one.

    Parameters
    ----------
    node : its executor runs the action.
    action : what to run.
    """

    def __init__(self, node: Node, action: Callable[[], None]):
        self._node, self._action, self._is_pending = node, action, False

    def __call__(self) -> None:
        """Request the action, from any one thread; a request is dropped while the node has no executor."""
        executor = self._node.executor
        if executor is None or self._is_pending:
            return
        self._is_pending = True
        executor.create_task(self._run)

    def _run(self) -> None:
        self._is_pending = False  # first, so that a request made while the action runs is not missed
        self._action()


class Outputs:
    """The output topics of a bearing, the residual slip of a measured cage, and the bands that the scene asks for.

    The serialised messages of a sample are filled with its numbers all at once, and only topics with a subscriber are published: building
    message objects and serialising them with rclpy would cost more than the rest of the node.  QoS events are not watched; a subscriber with
    incompatible QoS is warned on its own side.  The publishers are plain ones: there are no samples while the node is inactive, and rclpy's
    lifecycle publishers would check the state at every message.

    Parameters
    ----------
    node : owner of the publishers.
    scene : of the bearing; its level determines the topics.
    name_of : ``name_of(topic)`` returns the name under which a topic is published.
    profile_of : ``profile_of(topic)`` returns the offered QoS.
    frame : the bearing's.
    """

    def __init__(self, node: Node, scene: Scene, name_of: Callable[[str], str], profile_of: Callable[[str], QoSProfile], frame: str):
        self._node, self._name_of, self._profile_of, self._frame = node, name_of, profile_of, frame
        self._topics, self._rollers = tuple(topics.outputs(scene).values()), scene.bearing.roller.count
        self._publishers = [self._publisher(topic) for topic in self._topics]
        self._borrowed = ExitStack()
        self._sends = [raw_publish(publisher, self._borrowed) for publisher in self._publishers]
        self._messages: SampleMessages | None = None
        self._residual_topic = topics.MEASUREMENTS["cage_slip_residual"]
        self._residual = self._publisher(self._residual_topic)
        self._estimates = {topic.name: self._publisher(topic) for topic in topics.estimated(scene).values()}
        self._band_messages = FilledMessages()
        self._subscribed: tuple[SampleMessages | None, list[tuple[memoryview, Callable[[bytes], None]]]] = (None, [])

    def prepare(self) -> None:
        """Lay out the messages.  To be called once before anything is published, on any thread: it takes a moment."""
        self._messages = SampleMessages(message_templates(self._topics, self._rollers, self._frame))

    def adjust(self, scene: Scene) -> None:
        """Take over the thresholds of a scene, which messages may show."""
        self._topics = tuple(topics.outputs(scene).values())
        if self._messages is not None:
            self.prepare()
            self.update_subscribed()

    def update_subscribed(self) -> None:
        """Note which topics have subscribers; asking at every message would cost a quarter of publishing it."""
        counts = [publisher.get_subscription_count() for publisher in self._publishers]
        self._messages.compute([count > 0 for count in counts])
        heard = [(part, send) for part, send, count in zip(self._messages.parts, self._sends, counts) if count]
        self._subscribed = self._messages, heard  # one assignment, because `publish` runs on another thread

    def publish(self, stamp_ns: int, sample) -> None:
        """Publish a sample on the topics that had subscribers at the last `update_subscribed`; from one thread only."""
        messages, heard = self._subscribed
        if not heard:
            return
        messages.fill(stamp_ns, sample)
        for part, send in heard:
            send(bytes(part))

    @property
    def topic_names(self) -> list[str]:
        """The full names of the topics, after namespace and remapping."""
        return [publisher.topic_name for publisher in self._all_publishers]

    def publish_residual(self, stamp_ns: int, residual: float) -> None:
        """Publish the measured minus the predicted cage slip."""
        topic = self._residual_topic
        self._residual.publish(message(topic.ros_type, topic.message(stamp_ns, residual)))

    def publish_bands(self, bands: Bands, stamps_ns: list[int]) -> None:
        """Publish quantities with their bands, a message for each stamp [ns since the epoch]."""
        publisher = self._estimates[bands.topic]
        if publisher.get_subscription_count():
            for serialised in self._band_messages.of_bands(bands, stamps_ns, self._frame):
                publisher.publish(serialised)

    @property
    def _all_publishers(self) -> list[Publisher]:
        return [*self._publishers, self._residual, *self._estimates.values()]

    def destroy(self) -> None:
        """Destroy the publishers."""
        self._borrowed.close()
        for publisher in self._all_publishers:
            self._node.destroy_publisher(publisher)

    def _publisher(self, topic: Topic) -> Publisher:
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        return self._node.create_publisher(
            message_class(topic.ros_type), self._name_of(topic.name), self._profile_of(topic.name), event_callbacks=quiet
        )


class BearingInterface:
    """One bearing of a node, from the node's configure to its cleanup.

    All methods belong to the node's thread, except `warm_up`.  Outputs in wall time are published on a solver thread.

    Parameters
    ----------
    node : owner of topics and services.
    settings : of this bearing; if it has a name, its topics are below that name in the namespace, its services below that name and the node's.
    shared : settings of the node.

    Raises
    ------
    SceneError
        The scene cannot be used.
    SettingsError
        The quality of service of a topic cannot be used.
    OSError
        The bearing's state cannot be used.
    """

    def __init__(self, node: LifecycleNode, settings: BearingSettings, shared: NodeSettings):
        self._node, self._logger, self.settings, self._shared = node, node.get_logger(), settings, shared
        self.scene: Scene = load_scene(settings.scene, settings.scene_overrides, settings.allow_outside)
        self._profiles = profiles(node.parameters, entities_of_bearing(self.scene, self._full_name, follows_clock(node)))
        self._given: dict[str, object] = {}  # to watchers: the state of the bearing, and what takes long to read
        if (state := self._open_state(settings.serial)) is not None:
            self._given[MEMORY] = state
        self.live: LiveModel | SimTimeModel | None = None
        self._wanted_serial = settings.serial  # in use from ~/replace_bearing on
        self.error = ""  # why the model cannot run; reported until the next configure
        self._simulation: Simulation | None = None
        self._governor: Governor | None = None
        self._settings: list[Setting] = []  # measured ones, along which the governor falls
        self._front: Tradeoffs | None = None  # that has them, where the scene operates
        self._wants_governor = False
        self._new_governor: Governor | None = None  # made on the warm-up thread, taken over at the next review
        self._compiling: subprocess.Popen | None = None
        self._last_level: Level | None = None
        self._next_report_ns = 0
        self._now_ns = node.now_ns
        self._subscriptions: dict[str, Subscription] = {}
        self._types: dict[str, str] = {}  # that are listened to, by channel
        self._found: dict[str, tuple[int, int, Sources]] = {}  # by channel: publishers of any type, and good messages, when they were looked at
        self.component = node.component_of(settings.name)
        self._outputs = Outputs(node, self.scene, self._topic_name, partial(self._profile, "publisher"), settings.frame)
        self._publish_residuals_soon = DeferredCall(node, self._publish_residuals)
        self._services = [
            node.create_service(kind, self._service_name(name), self._served(act))
            for kind, name, act in (
                (Trigger, "reset", self._reset),
                (Trigger, "replace_bearing", self._replace_bearing),
                (Trigger, "start_recording", self._begin_recording),
                (Trigger, "stop_recording", self._stop_recording),
                (SetBool, "pause", self._pause),
                *((Trigger, name, lambda _, name=name: self.live.watchers.serve(name)) for name in SERVICES),
            )
        ]
        self._log(f"scene {self.scene.name!r}, bearing {self.scene.bearing.name!r}, level {self.scene.level!r}: warming up")
        if cheaper := hint(self.scene):
            self._log(cheaper)

    @property
    def hardware_id(self) -> str:
        """The serial number of the bearing in service; the bearing's name if there is none."""
        return self.settings.serial or "/".join(filter(None, (self.settings.name, self.scene.bearing.name)))

    @property
    def is_warm(self) -> bool:
        """Whether the model is compiled."""
        return self._simulation is not None

    def warm_up(self) -> None:
        """Compile or load the model, which takes seconds to minutes; runs on the thread of `WarmUp`."""
        settings = self.settings
        try:
            prepare(settings.has_view)
            self._outputs.prepare()
            self._given |= resources(self.scene)
            simulation = warmed_up(self.scene)
            governs = self._shared.governor and not follows_clock(self._node)  # with sim time no time is skipped
            self._read_front()
            self._wants_governor = governs  # made once the run has begun, which does not wait for the code of other levels
            self._simulation = simulation
        except IntegrationError as error:
            self.error = f"the scene's own operating conditions cannot be computed: {error}"
        except Exception as error:  # a programming error: reported by the node, where users look
            self.error = f"the model could not be made: {error!r}"

    def _read_front(self) -> None:
        """Find the measured settings along which the governor falls, by the front of the scene alone if it names one."""
        settings = self.settings
        try:
            front = measured_of(settings.scene, settings.scene_overrides, settings.allow_outside, self.scene)
            self._front = front and front.at(self.scene)
        except ValueError as error:
            self._logger.warning(f"the governor falls along levels only; the front that the scene names cannot be read: {error}")
        self._settings = settings_to_fall(self.scene, self._front)

    def open(self) -> None:
        """Start a run: open recordings and subscriptions.  Run time 0 is now, or the first input with sim time.

        Raises
        ------
        OSError
            A recording or a view cannot be opened.
        """
        settings, shared = self.settings, self._shared
        if follows_clock(self._node):
            self._now_ns = self._node.now_ns
            self.live = SimTimeModel(
                self.scene,
                self._simulation,
                shared.sample_rate,
                shared.publish_rate,
                shared.clock_jump_back,
                given=self._given,
                inputs_expected_within=shared.inputs_expected_within,
                clock_tolerance=shared.clock_tolerance,
            )
            self.live.tick(self._now_ns())
        else:
            self._now_ns = time.time_ns  # the node's clock without its overhead
            self.live = LiveModel(
                self.scene,
                self._simulation,
                self._now_ns(),
                sample_rate=shared.sample_rate,
                maximum_lag=shared.maximum_lag,
                publish_rate=shared.publish_rate,
                governor=self._governor if shared.governor else None,
                due=self._publish_newest,
                receiver=self._now_ns,
                threads=self._node.solver_threads,
                given=self._given,
                inputs_expected_within=shared.inputs_expected_within,
                stamp_tolerance=shared.stamp_tolerance,
            )
            temperature = self.scene.lubricant.temperature
            if self._simulation.inputs.oil_temperature != temperature:  # set while inactive, or given by the topic in the last run
                self.live.set_oil_temperature(temperature, self._now_ns())
        if settings.record:
            self._start_recording(Path(settings.record))
        if settings.has_view:
            self._open_view()
        for channel, topic in topics.inputs(self.scene).items():
            self._subscribe(channel, _SCALAR if shared.input_type == "scalar" and _SCALAR in topics.input_types(channel) else topic.ros_type)
        for channel in topics.MEASURED_CHANNELS:
            self._subscribe(channel, topics.MEASUREMENTS[channel].ros_type)
        if self.scene.vibration.is_asked:
            self._subscribe_to_vibration()
        self._log(f"publishing {', '.join(self._outputs.topic_names)}")
        self._log(f"ready: listening to {', '.join(subscription.topic_name for subscription in self._subscriptions.values())}")
        if self._front is not None and shared.governor and not follows_clock(self._node):
            found = "; ".join(setting.name for setting in self._settings) or "none for this bearing where it operates, so it falls along levels"
            self._log(f"the governor falls along measured settings of {self._front.name}: {found}")

    def tick(self, now_ns: int) -> None:
        """Pass on a reading of /clock, if the model follows it."""
        if isinstance(self.live, SimTimeModel):
            self.live.tick(now_ns)

    def close(self) -> bool:
        """End the run and complete recordings.

        Returns
        -------
        whether the solver's thread ended; otherwise the model must be warmed up again.
        """
        for subscription in self._subscriptions.values():
            self._listener.destroy_subscription(subscription)
        self._subscriptions, self._found = {}, {}
        live, self.live = self.live, None
        stopped = live.close() if live is not None else True
        if live is not None and (state := live.watchers.get(MEMORY)) is not None:
            self._given[MEMORY] = state
        if not stopped:
            self._simulation = self._governor = None
        return stopped

    def destroy(self) -> bool:
        """End the run and destroy topics and services.  Returns whether the solver's thread ended."""
        stopped = self.close()
        if (state := self._given.pop(MEMORY, None)) is not None:
            state.leave()
        if self._compiling is not None:
            self._compiling.kill()
            self._compiling.wait()
        for service in self._services:
            self._node.destroy_service(service)
        self._outputs.destroy()
        return stopped

    def review(self, now_ns: int, state: Event, warm_up: WarmUp) -> None:
        """Feed the sinks, log new events, and publish diagnostics every second and when the level changes.

        Parameters
        ----------
        state : the node's lifecycle state, reported while the model does not run.
        warm_up : makes a governor once its levels are compiled.
        """
        if self.live is None:
            event = Event(0.0, Level.ERROR, "run.failed", "", self.error) if self.error else state
            if self._report_is_due(event.level):
                self._report(now_ns, not_running(event))
            return
        self._join_governor(warm_up)
        if follows_clock(self._node) and self.live.solver.phase is Phase.WAITING:
            self._look_for_publishers()  # whether the run waits for a first oil temperature is decided once, when it starts
        for event in self.live.collect(now_ns):
            self._log_event(event)
        self._outputs.update_subscribed()
        if follows_clock(self._node):  # otherwise outputs are published as soon as they are due
            self._publish_all()
        for bands in self.live.bands():
            self._outputs.publish_bands(bands, [self.live.stamp(time) for time in bands.times.tolist()])
        if self._report_is_due(self.live.level):
            self._look_for_resources()
            self._look_for_publishers()  # once a second is enough
            self._report(now_ns, self.live.condition(now_ns))

    def _report_is_due(self, level: Level) -> bool:
        return level != self._last_level or time.monotonic_ns() >= self._next_report_ns  # /clock may stand still

    def _report(self, now_ns: int, condition: Condition) -> None:
        """Publish the condition on /diagnostics."""
        self._last_level = condition.level
        self._next_report_ns = time.monotonic_ns() + round((_DIAGNOSTICS_PERIOD - self._node.review_period / 2) * 1e9)
        self._node.publish_diagnostics(now_ns, condition, self.component, self.hardware_id)
        if self.live is not None:
            self.live.record_diagnostics(condition, now_ns)

    def _look_for_resources(self) -> None:
        """Let watchers begin whose resources have been made since the start; with simulated time a run must not depend on when that was."""
        if not follows_clock(self._node) and (found := self.live.watchers.complete()):
            self._given |= found
            self._log(f"what was missing at the start is there: {', '.join(found)}")

    def _look_for_publishers(self) -> None:
        """Tell the model who publishes its inputs, and which topics the scene does not use have a publisher."""
        for channel in (*self._types, *(channel for channel in topics.INPUTS if channel not in self._types)):
            name, accepted = self._full_name(channel), self.live.gate.accepted[channel]
            count = self._node.count_publishers(name)
            if channel not in self._types:
                self.live.note_publishers(channel, count)
                continue
            before = self._found.get(channel)
            # Looking at each publisher costs more than counting them: where nothing changes and messages come, nothing is to be found.
            if before is None or count != before[0] or (accepted == before[1] and (count or channel in REQUIRED)):
                self._found[channel] = count, accepted, self._sources_of(channel, name, count)
            else:
                self._found[channel] = count, accepted, before[2]
            self.live.note_sources(channel, self._found[channel][2])

    def _sources_of(self, channel: str, name: str, count: int) -> Sources:
        ros_type, profile = self._types[channel], self._subscriptions[channel].qos_profile
        if not count:
            alternatives = self._node.published_topics.like(name, ros_type) if channel in REQUIRED else ()
            return Sources(name, ros_type, 0, alternatives=alternatives)
        publishers, others, misfits = 0, [], []
        for publisher in self._node.get_publishers_info_by_topic(name):
            compatibility, reason = qos_check_compatible(publisher.qos_profile, profile)
            if publisher.topic_type != ros_type:
                others.append(publisher.topic_type)
            elif compatibility == QoSCompatibility.ERROR:
                misfits.append(reason.removeprefix("ERROR: ").rstrip(";. "))
            else:
                publishers += 1
        return Sources(name, ros_type, publishers, tuple(sorted(set(others))), tuple(sorted(set(misfits))))

    def reason_to_refuse(self, changes: dict[str, object]) -> str:
        """Return why changes of this bearing's parameters are refused; empty if they can be applied."""
        has_message = self.live is not None and self.live.gate.accepted["oil_temperature"]
        if has_message and changes.get(OIL_TEMPERATURE, self.scene.lubricant.temperature) != self.scene.lubricant.temperature:
            return f"{OIL_TEMPERATURE}: the topic oil_temperature has given the temperature in this run and takes precedence"
        try:
            with_values(self.scene, scene_values_in(changes))
        except ValueError as error:
            return messages(error)
        return ""

    def apply(self, changes: dict[str, object]) -> None:
        """Apply changes of this bearing's parameters."""
        before, self.scene = self.scene, with_values(self.scene, scene_values_in(changes))
        if self.scene.thresholds != before.thresholds:
            self._outputs.adjust(self.scene)
            if self.live is not None:
                self.live.adjust(self.scene.thresholds)
        if "serial" in changes:
            self._wanted_serial = changes["serial"]
        if self.live is not None and self.scene.lubricant.temperature != before.lubricant.temperature:
            self.live.set_oil_temperature(self.scene.lubricant.temperature, self._now_ns())

    def _open_state(self, serial: str) -> Watcher | None:
        """Return what keeps the state of a bearing, None if nothing is to be remembered; raise OSError if it cannot be used."""
        keeper = kind_of(MEMORY).of_bearing(self.scene, serial, self.settings.state_file.strip(), follows_clock(self._node))
        if keeper is not None:
            self._log(f"state of the bearing: {keeper.path}")
        return keeper

    def publish_at(self, rate: float) -> None:
        """Set the publish rate [Hz]; with sim time per simulated second."""
        self._shared = dataclasses.replace(self._shared, publish_rate=rate)
        if self.live is not None:
            self.live.publish_at(rate)

    def govern(self, wanted: bool, warm_up: WarmUp) -> None:
        """Enable or disable the governor; ``warm_up`` makes it if there is none yet."""
        self._shared = dataclasses.replace(self._shared, governor=wanted)
        if follows_clock(self._node):
            return
        if wanted and self._governor is None and self.is_warm:
            self._wants_governor = True
        elif self.live is not None:
            self.live.govern(self._governor if wanted else None)

    def report_soon(self) -> None:
        """Publish diagnostics at the next review."""
        self._next_report_ns = 0

    def _log(self, text: str) -> None:
        self._logger.info(f"{self.settings.name}: {text}" if self.settings.name else text)

    def _log_event(self, event: Event) -> None:
        line = f"{self.settings.name}: {event.kind}: {event.text}" if self.settings.name else f"{event.kind}: {event.text}"
        # rclpy refuses one line of code that logs at several severities.
        if event.level == Level.ERROR:
            self._logger.error(line)
        elif event.level == Level.WARN:
            self._logger.warning(line)
        else:
            self._logger.info(line)

    def _publish_newest(self) -> None:
        """Publish the newest output, on a solver thread: to hand it to the node's thread would cost more than to publish it."""
        live = self.live
        if live is None:  # the run has ended in the meantime
            return
        for stamp_ns, sample in live.published():
            self._outputs.publish(stamp_ns, sample)
        if live.has_residuals:
            self._publish_residuals_soon()

    def _publish_all(self) -> None:
        """With sim time: publish every output at its stamp."""
        for stamp_ns, sample in self.live.published():
            self._outputs.publish(stamp_ns, sample)
        self._publish_residuals()

    def _publish_residuals(self) -> None:
        if self.live is None:  # the run has ended since this was requested
            return
        for stamp_ns, residual in self.live.residuals():
            self._outputs.publish_residual(stamp_ns, residual)

    def _subscribe(self, channel: str, ros_type: str) -> None:
        joints = {topics.MEASURED: self.settings.cage_joint, topics.MEASURED_CLEARANCE: topics.CLEARANCE_JOINT}
        joint = joints.get(channel, self.settings.joint)
        self._types[channel] = ros_type
        receive = partial(self._receive, channel, InputReader(channel, ros_type, joint, self.settings.frame_id, self._node.transforms))
        kind, name = message_class(ros_type), self._topic_name(channel)
        if follows_clock(self._node):
            replace = partial(self._subscriptions.__setitem__, channel)
            profile = self._profile("subscription", channel)
            self._subscriptions[channel] = subscribe_to_all(self._node, kind, name, receive, profile, replace, self._report_loss)
            return
        self._subscriptions[channel] = self._listen(channel, kind, receive)

    def _listen(self, name: str, kind: type, receive: Callable[[bytes], None]) -> Subscription:
        """Return a subscription to serialised messages of an input, of which some may be lost."""
        profile = self._profile("subscription", name)
        events = SubscriptionEventCallbacks(use_default_callbacks=profile != INPUT_QOS)  # which any publisher matches: nothing to watch
        return self._listener.create_subscription(kind, self._topic_name(name), receive, profile, event_callbacks=events, raw=True)

    def _subscribe_to_vibration(self) -> None:
        """Listen to blocks of vibration; not in simulated time, where a result would come at an instant that depends on the machine."""
        if follows_clock(self._node):
            self._log("vibration: not listened to with use_sim_time; find the cage speed with bearing-sim vibration, and send cage_speed_measured")
            return
        topic, kind = topics.VIBRATION.name, message_class(topics.VIBRATION.ros_type)
        self._subscriptions[topic] = self._listen(topic, kind, partial(self._receive_vibration, kind))

    def _receive_vibration(self, kind: type, cdr: bytes) -> None:
        live = self.live
        if live is None:  # the message was on its way when the run ended
            return
        try:
            block = deserialize_message(cdr, kind)
        except Exception as error:  # its type depends on the middleware
            block = f"{len(cdr)} bytes cannot be read: {' '.join(str(error).split())}"
        live.hear(topics.VIBRATION.name, block, self._now_ns())

    @property
    def _listener(self) -> Node | PolledSubscriptions:
        """The owner of the subscriptions."""
        return self._node.polled if self._node.polled is not None else self._node

    def _report_loss(self, text: str) -> None:
        if self.live is not None:
            self.live.note_loss(text)

    def _topic_name(self, name: str) -> str:
        return f"{self.settings.name}/{name}" if self.settings.name else name

    def _full_name(self, name: str) -> str:
        """Return the name of a topic after namespace and remapping."""
        return self._node.resolve_topic_name(self._topic_name(name))

    def _profile(self, kind: str, name: str) -> QoSProfile:
        return self._profiles[self._full_name(name), kind]

    def _service_name(self, name: str) -> str:
        return "/".join(filter(None, (self._node.service_prefix, self.settings.name, name)))

    def _make_governor(self) -> None:
        """Make a governor, on the thread of `WarmUp`."""
        if self._simulation is None:  # the run has ended, and its thread has not
            return
        try:
            self._new_governor = governor_of(self._simulation, self._settings, self._front.courses if self._front else ())
        except IntegrationError as error:
            self._logger.warning(f"the governor has no level of lower fidelity to use: {error}")

    def _join_governor(self, warm_up: WarmUp) -> None:
        """Hand over the governor once its levels are compiled; until then a machine that is too slow skips time."""
        if self._compiling is not None and self._compiling.poll() is not None:
            self._compiling, self._wants_governor = None, False
            warm_up.request(self._make_governor)
        elif self._wants_governor and self._compiling is None:
            if not levels_to_compile(self.scene):
                self._wants_governor = False
                warm_up.request(self._make_governor)
            elif (compiling := warm_up.compile_lower(self.scene)) is not None:
                self._compiling = compiling
                self._log("compiling levels of lower fidelity for the governor in the background, once for this version")
        if self._new_governor is not None:
            self._governor, self._new_governor = self._new_governor, None
            if self._shared.governor:
                self.live.govern(self._governor)
                self._log("the governor can use levels of lower fidelity")

    def _receive(self, channel: str, reader: InputReader, cdr: bytes) -> None:
        live = self.live
        if live is None:  # the message was on its way when the run ended
            return
        now_ns = self._now_ns()
        try:
            values, stamp_ns, frame_id = reader.read(cdr)
        except Refused as error:
            live.refuse(channel, error.kind, str(error), now_ns)
            return
        live.offer(channel, values, stamp_ns, now_ns, frame_id)
        self._node.review_if_late()

    def _start_recording(self, path: Path) -> None:
        def records() -> dict[str, dict[str, str]]:
            found = dict(self.live.watchers.memory.records)
            if self._settings and isinstance(self.live, LiveModel):
                found[GOVERNOR_RECORD] = governor_record(self._settings, self.live.setting)
            return found

        def opened(start_ns: int):
            schedule = None if follows_clock(self._node) else self.live.schedule
            further = (self.settings.frame, records, self._recorded_names())
            sink = open_recording(path, self.scene, start_ns, limits_of(self._shared), schedule, self._node.recorder, *further)
            self._log(f"recording {sink.path}" + (f" ({path} exists and is kept)" if sink.path != path else ""))
            return sink

        try:
            self.live.open("record", opened, reopen=True)
        except OSError as error:
            self.live.sinks.fail("record", self.live.run_time(self._now_ns()), error)
            raise

    def _recorded_names(self) -> topics.Names:
        """Return the names that topics and statuses have in the ROS graph."""
        scene, diagnostics = self.scene, topics.DIAGNOSTICS[0]
        own = {*topics.recorded(scene), *topics.inputs(scene), *topics.MEASUREMENTS, *topics.estimated(scene)}
        full = {name: self._full_name(name) for name in sorted(own)} | {diagnostics: self._node.resolve_topic_name(f"/{diagnostics}")}
        return topics.Names({name: each for name, each in full.items() if each != f"/{name}"}, self.component, self.hardware_id)

    def _open_view(self) -> None:
        """Open the view; the node does without where its packages are not installed."""
        settings = self.settings
        try:
            if settings.rerun_web_port:
                self._log(f"the view is at http://127.0.0.1:{settings.rerun_web_port} for browsers on this machine")
            self.live.open("view", lambda start_ns: open_view(self.scene, start_ns, settings.rrd, settings.rerun_port, settings.rerun_web_port))
        except ModuleNotFoundError as error:
            self.live.sinks.lack("view", what_is_missing(error))
            return
        if settings.rerun_port and (command := viewer_command(stream_url(settings.rerun_port))):
            self._log(f"to see it, run {shlex.join(command)}")

    def _served(self, act: Callable[[object], tuple[bool, str]]) -> Callable:
        """Return the callback of a service, which answers with what ``act`` makes of the request, or that there is no run to serve."""

        def serve(request, response):
            response.success, response.message = False, f"not running: {self.error or 'activate the node and wait until it has warmed up'}"
            if self.live is not None:
                try:
                    response.success, response.message = act(request)
                except OSError as error:
                    response.message = str(error)
            return response

        return serve

    def _begin_recording(self, _) -> tuple[bool, str]:
        """Begin a recording; the answer names the file."""
        if self.live.has("record"):
            return False, "a recording is already running; stop it first"
        path = fresh_path(self._recording_path)
        self._start_recording(path)
        return True, str(path.resolve())

    @property
    def _recording_path(self) -> Path:
        """Where a recording goes that a service begins."""
        name = f"run_{self.settings.name}" if self.settings.name else "run"
        return Path(self.settings.record or f"recordings/{name}.mcap")

    def _stop_recording(self, _) -> tuple[bool, str]:
        """Complete the recording; the answer names the file."""
        sink = self.live.detach("record")
        return sink is not None, f"{sink.path} is complete" if sink is not None else "there is no recording to stop"

    def _reset(self, _) -> tuple[bool, str]:
        """Return the model to the start of the scene; without a stored state, damage as well."""
        if self.live.reset():
            is_new = self.live.watchers.memory.life_used is None
            return True, "state and damage are reset" if is_new else "the model is reset; the totals of the bearing continue"
        return False, "not done within two seconds; the reset follows after the running tick"

    def _replace_bearing(self, _) -> tuple[bool, str]:
        """End the stored state of the bearing, which is kept, and begin that of the bearing whose serial number was set before."""
        before, serial = self.live.watchers.get(MEMORY), kind_of(MEMORY).checked(self._wanted_serial)
        number = before.serial if before is not None else ""
        if not serial or serial == number:
            return False, f"set serial to the number of the new bearing first; it is {serial or 'empty'!r}, and the bearing in service is {number!r}"
        path = self.settings.state_file.strip()
        if follows_clock(self._node) and not path:
            return False, "nothing is remembered with use_sim_time unless state_file is given"
        recording = self.live.has("record")
        if recording:  # a recording belongs to one bearing
            self.live.detach("record")
        kept = []

        def change() -> Watcher:
            other = None if path else self._open_state(serial)
            try:
                if before is not None:
                    kept.append(before.retire(into_archive=bool(path)))
            except OSError:
                if other is not None:
                    other.close()
                raise
            return other or self._open_state(serial)

        try:
            self.live.replace_bearing(change)
            self.settings = dataclasses.replace(self.settings, serial=serial)
        finally:
            if recording:
                self._start_recording(self._recording_path)
        state = self.live.watchers.get(MEMORY)
        ended = f"; the state of {number!r} is kept in {kept[0]}" if kept else ""
        return True, f"serial number {serial}: {100.0 * state.used:.6g} % of life used, in {state.path}{ended}"

    def _pause(self, request) -> tuple[bool, str]:
        """Hold simulated time, or continue."""
        self.live.pause(request.data)
        return True, "paused" if request.data else "running"
