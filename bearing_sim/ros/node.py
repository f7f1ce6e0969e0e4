# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_node`: one bearing or several as a managed ROS 2 node.

Subscribes to shaft speed and radial load, advances each model in real time on its own thread, publishes cage slip, life and roller loads,
reports health on ``/diagnostics``, and records on request.  `bearing_sim.ros.interface` handles one bearing; this module handles the
node's lifecycle and its parameters.  Run it with ``bearing_node``, ``python -m bearing_sim.ros.node`` or ``ros2 run bearing_sim bearing_node``.

**Lifecycle.**  Configuring checks parameters and scenes, creates publishers and services, and starts compiling the models on a separate
thread.  It answers within a second however long compiling takes: lifecycle managers give up on slow answers, and the node stays responsive.
Activating opens inputs and recordings of each bearing as soon as its model is compiled: a fleet does not wait for its slowest member.
``/diagnostics`` reports in every state what the node is waiting for.  Each activation is a new run: state and damage start over (``~/pause``
holds them), recordings get fresh names.  Unless ``autostart`` is false, the node configures and activates itself.
"""

import dataclasses
import sys
import time
from collections import deque
from collections.abc import Callable
from functools import wraps

from rclpy.clock import Clock, ClockType, JumpHandle, JumpThreshold
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.task import Future

from bearing_sim.inputs.static_transforms import StaticTransforms
from bearing_sim.messages import diagnostics, topics
from bearing_sim.messages.cdr import message_type
from bearing_sim.messages.events import Event, Level
from bearing_sim.monitoring.health import Condition, not_running
from bearing_sim.recording.recorder import Recorder
from bearing_sim.ros.interface import STATE_QOS, BearingInterface
from bearing_sim.ros.messages import message_class
from bearing_sim.ros.parameters import NodeSettings, ParameterServer, SettingsError, follows_clock
from bearing_sim.ros.process import CannotRun, run_node
from bearing_sim.ros.transforms import TransformInterface
from bearing_sim.ros.warm_up import WarmUp
from bearing_sim.runtime.solver_threads import SolverThreads
from bearing_sim.scene.loader import SceneError

SUCCESS, FAILURE, ERROR = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE, TransitionCallbackReturn.ERROR
_REVIEW_PERIOD = {False: 0.2, True: 0.05}  # [s] delay until a change of health, and with sim time an output, is published
_REVIEWED_AT_ONCE = 10  # bearings; a node with more of them reviews each less often, because a review takes a millisecond
_LONGEST_REVIEW = 3  # times as long as with few bearings
_LATE = 5  # review periods without a review
_WARMING = "warming up: compiling the model; messages received now are not used"


def _reported(transition: Callable) -> Callable:
    """Report why a transition failed, in the log and on /diagnostics; rclpy alone would drop the reason."""

    @wraps(transition)
    def guarded(node, state) -> TransitionCallbackReturn:
        name, before = transition.__name__.removeprefix("on_"), node._state
        try:
            result, node.error = transition(node, state), ""
        except (SettingsError, SceneError, OSError, CannotRun) as error:
            result, node.error = FAILURE, f"{name} failed: {error}"
        except Exception as error:
            result, node.error = ERROR, f"{name} failed unexpectedly: {error!r}"
        if node.error:
            node.get_logger().error(node.error)
            node.report_soon()
        else:
            node.get_logger().info(f"lifecycle: {name}: {before} -> {node._state}")
        return result

    return guarded


def _refuse_impossible_transitions(node: LifecycleNode) -> None:
    """Answer "no" to a request for a transition that the current state does not have; rclpy alone would end the process."""
    (service,) = (service for service in node.services if service.srv_name.endswith("/change_state"))
    change_state = service.callback

    def answered(request, response):
        try:
            return change_state(request, response)
        except rclpy_implementation.RCLError as error:
            node.get_logger().warning(f"transition {request.transition.label or request.transition.id} refused: {' '.join(str(error).split())}")
            response.success = False
            return response

    service.callback = answered


class BearingNode(LifecycleNode):
    """The lifecycle and the parameters of a node that hosts one or more bearings.

    Parameters
    ----------
    ended : receives a `CannotRun` when the node ends itself.

    Attributes
    ----------
    review_period : time from one review of a bearing to the next [s].
    """

    def __init__(self, ended: Future):
        super().__init__("bearing_node", automatically_declare_parameters_from_overrides=True)
        self._ended = ended
        self.error = ""  # why the last transition failed
        self.bearings: list[BearingInterface] = []
        self._to_review: deque[BearingInterface] = deque()
        self._state, self._next_report_ns, self._reviewed = "unconfigured", 0, time.monotonic()
        self._warm_up = WarmUp()
        self.recorder = Recorder()  # one process for the recordings of all bearings
        self.solver_threads = SolverThreads()
        self.parameters = ParameterServer(self)
        self._shared: NodeSettings | None = None
        self._frames: TransformInterface | None = None
        name, ros_type = topics.DIAGNOSTICS
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        self._diagnostics = self.create_publisher(message_class(ros_type), f"/{name}", STATE_QOS, event_callbacks=quiet)
        self.review_period = _REVIEW_PERIOD[follows_clock(self)]
        self._ticks = 0  # of the timer of reviews
        _create_steady_timer(self, self.review_period, self._review)
        self._clock_watch = self._watch_clock()
        self.manages_itself = bool(self.parameters.value("autostart"))
        _refuse_impossible_transitions(self)

    def start(self) -> None:
        """Configure and activate, as requested by ``autostart``.

        Raises
        ------
        CannotRun
            Parameters, a scene or a recording cannot be used.
        """
        for transition in (self.trigger_configure, self.trigger_activate):
            if transition() != SUCCESS:
                raise CannotRun(self.error.partition("failed: ")[2] or self.error)

    def close(self) -> bool:
        """Stop the models and complete recordings.  Returns whether all threads ended."""
        self._warm_up.cancel()
        stopped = [bearing.destroy() for bearing in self.bearings]
        self.bearings = []
        self._to_review.clear()
        self.recorder.close(timeout=2.0)
        return all(stopped) and not self._warm_up.is_working

    @_reported
    def on_configure(self, state) -> TransitionCallbackReturn:
        """Check parameters, load scenes, create topics and services, and start compiling."""
        self._shared, bearings = self.parameters.settings()
        try:
            self._frames = TransformInterface(self, bearings)
            for settings in bearings:
                self.bearings.append(BearingInterface(self, settings, self._shared))
                self.parameters.show_scene(settings.name, self.bearings[-1].scene)
        except Exception:
            self._release()
            raise
        for bearing in self.bearings:
            self._warm_up.request(bearing.warm_up)
        self._state = "inactive"
        return super().on_configure(state)

    @_reported
    def on_activate(self, state) -> TransitionCallbackReturn:
        """Start the bearings that have warmed up; the others follow as soon as they have."""
        if errors := [bearing.error for bearing in self.bearings if bearing.error]:
            raise CannotRun(f"{errors[0]}; clean up and configure again")
        try:
            self._open_warm_bearings()
        except Exception:
            self._close()
            raise
        self._state = "active"
        return super().on_activate(state)

    @_reported
    def on_deactivate(self, state) -> TransitionCallbackReturn:
        """End the runs and complete recordings; the compiled models are kept."""
        self._close()
        self._state = "inactive"
        return super().on_deactivate(state)

    @_reported
    def on_cleanup(self, state) -> TransitionCallbackReturn:
        """Release everything that configuring created."""
        self._release()
        self._state = "unconfigured"
        return super().on_cleanup(state)

    @_reported
    def on_shutdown(self, state) -> TransitionCallbackReturn:
        """Release everything for good; the process stays until a signal arrives."""
        self._release()
        self._state = "finalized"
        return super().on_shutdown(state)

    def on_error(self, state) -> TransitionCallbackReturn:
        """Release everything after a programming error in a transition; the node can be configured again."""
        self._release()
        self._state = "unconfigured"
        return super().on_error(state)

    @property
    def is_running(self) -> bool:
        """Whether the node is active, so that parameters that take effect at configure cannot change."""
        return self._state == "active"

    def reason_to_refuse(self, changes: dict[str, object]) -> str:
        """Return why parameter changes are refused; empty if they can be applied."""
        reasons = (bearing.reason_to_refuse(self.parameters.changes_of(bearing.settings.name, changes)) for bearing in self.bearings)
        return next(filter(None, reasons), "")

    def apply(self, changes: dict[str, object]) -> None:
        """Apply parameter changes."""
        for bearing in self.bearings:
            bearing.apply(self.parameters.changes_of(bearing.settings.name, changes))
            self.parameters.show_scene(bearing.settings.name, bearing.scene)
        if "publish_rate" in changes and self._shared is not None:
            self._shared = dataclasses.replace(self._shared, publish_rate=changes["publish_rate"])
            for bearing in self.bearings:
                bearing.publish_at(changes["publish_rate"])
        if "governor" in changes:
            for bearing in self.bearings:
                bearing.govern(changes["governor"], self._warm_up)

    def report_soon(self) -> None:
        """Publish diagnostics at the next review."""
        self._next_report_ns = 0
        for bearing in self.bearings:
            bearing.report_soon()

    def publish_diagnostics(self, now_ns: int, condition: Condition, component: str, hardware_id: str) -> None:
        """Publish a condition on /diagnostics, with the state of the node."""
        values = {"state": self._state, **condition.values}
        fields = diagnostics.report(now_ns, condition.events, values, component, hardware_id, condition.remarks, condition.otherwise)
        self._diagnostics.publish(message_type(topics.DIAGNOSTICS[1]).serialize(fields))

    def component_of(self, bearing: str) -> str:
        """Return the first half of the names of a bearing's statuses: the node's name, and the bearing's if it has one."""
        node = self.get_fully_qualified_name().lstrip("/")
        return f"{node}/{bearing}" if bearing else node

    @property
    def transforms(self) -> StaticTransforms:
        """The static transforms that the node knows while it is configured."""
        return self._frames.transforms

    def review_if_late(self) -> None:
        """Review now if the timer has stalled: an rclpy built against an old glibc waits on the system clock, which may be set back."""
        if time.monotonic() - self._reviewed > _LATE * self.review_period:
            self._review()

    def now_ns(self) -> int:
        """Return the node's time [ns since the epoch]."""
        clock = self.get_clock()
        return clock.now().nanoseconds if clock.ros_time_is_active else time.time_ns()  # the same, without the overhead

    def _open_warm_bearings(self) -> None:
        for bearing in self.bearings:
            if bearing.live is None and bearing.is_warm and not bearing.error:
                bearing.open()

    def _close(self) -> None:
        for bearing in self.bearings:
            if not bearing.close():
                self._warm_up.request(bearing.warm_up)  # its model is still in use by the thread that did not end

    def _release(self) -> None:
        self._close()
        self._warm_up.cancel()
        for bearing in self.bearings:
            bearing.destroy()
        self.bearings = []
        self._to_review.clear()
        frames, self._frames = self._frames, None
        if frames is not None:
            frames.destroy()

    def _watch_clock(self) -> JumpHandle:
        """Pass every reading of /clock to the bearings, as long as the returned handle is kept."""

        def tick(_) -> None:
            now_ns = self.get_clock().now().nanoseconds
            for bearing in self.bearings:
                bearing.tick(now_ns)

        threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1), on_clock_change=True)
        return self.get_clock().create_jump_callback(threshold, post_callback=tick)

    def _review(self) -> None:
        """Start bearings that have warmed up, review every bearing, and report the node's state if it has none."""
        self._reviewed = time.monotonic()
        if self._state == "active":
            self._start_late()
        now_ns = self.now_ns()
        period = _REVIEW_PERIOD[follows_clock(self)]
        every = 1 if follows_clock(self) else min(1 + len(self.bearings) // (_REVIEWED_AT_ONCE + 1), _LONGEST_REVIEW)
        self._ticks, self.review_period = (self._ticks + 1) % every, every * period
        if self._ticks == 0 and not self._to_review:
            self._to_review.extend(self.bearings)
            self._review_next()
        steady_ns = time.monotonic_ns()  # /clock may stand still
        if not self.bearings and steady_ns >= self._next_report_ns:
            self._next_report_ns = steady_ns + 1_000_000_000
            for name in dict.fromkeys(self.parameters.bearings() or [""]):
                serial = str(self.parameters.value("serial", name))
                self.publish_diagnostics(now_ns, not_running(self._state_event(None)), self.component_of(name), serial)

    def _review_next(self) -> None:
        """Review one bearing, and leave the next one to a task, so that messages that have come in the meantime are taken in between."""
        if not self._to_review:  # the node has been cleaned up in the meantime
            return
        bearing = self._to_review.popleft()
        bearing.review(self.now_ns(), self._state_event(bearing), self._warm_up)
        if self._to_review:
            self.executor.create_task(self._review_next)

    def _start_late(self) -> None:
        """Start bearings that have warmed up; end a node that manages itself if a recording or all its bearings fail."""
        try:
            self._open_warm_bearings()
        except OSError as error:
            if self.manages_itself:
                self._end(CannotRun(str(error)))
                return
            self.get_logger().error(str(error))
            self.trigger_deactivate()
            self.error = f"activate failed: {error}"
            return
        if self.manages_itself and all(bearing.error for bearing in self.bearings):
            self._end(CannotRun("\n".join(bearing.error for bearing in self.bearings), exit_code=1))

    def _end(self, error: CannotRun) -> None:
        if not self._ended.done():
            self._ended.set_exception(error)

    def _state_event(self, bearing: BearingInterface | None) -> Event:
        if self.error:
            return Event(0.0, Level.ERROR, "run.failed", "", self.error)
        if bearing is not None and not bearing.is_warm:
            return Event(0.0, Level.OK, "run.warming_up", "", _WARMING)
        text = {
            "unconfigured": "unconfigured: waiting to be configured",
            "inactive": "inactive: ready to be activated",
            "finalized": "shut down: end the process",
        }
        return Event(0.0, Level.OK, f"run.{self._state}", "", text.get(self._state, self._state))


def _create_steady_timer(node: LifecycleNode, period: float, callback: Callable[[], None]):
    """Return a timer in wall time [s], which keeps running when /clock stands still or is absent."""
    return node.create_timer(period, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))


def _make_node(ended: Future) -> BearingNode:
    node = BearingNode(ended)
    try:
        if node.manages_itself:
            node.start()
    except CannotRun:
        node.close()
        node.destroy_node()
        raise
    return node


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM.

    Returns
    -------
    0 after a signal.  A node that manages itself: 2 if parameters, scene or recording paths cannot be used, 1 if the scene cannot be computed.
    """
    return run_node("bearing_node", _make_node, args)


if __name__ == "__main__":
    sys.exit(main())
