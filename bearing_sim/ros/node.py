# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_node`: one bearing or several as a managed ROS 2 node.

Subscribes to shaft speed and radial load, advances the models in real time on threads of their own, publishes cage slip, life
and roller loads, tells their health on ``/diagnostics``, and records when asked to.  What belongs to one bearing is in
`bearing_sim.ros.bearing_doors`; here are the node's life and its parameters.  Run by ``bearing_node``,
``python -m bearing_sim.ros.node`` or ``ros2 run bearing_sim bearing_node``.

**Life.**  Configuring checks parameters and scenes, makes publishers and services and begins to compile the models on a thread of their
own; it answers within a second, however long compiling takes, because those who manage nodes give up on a slow answer, and because the
node shall be heard meanwhile.  Activating opens inputs and recordings, for each bearing as soon as its model is compiled: a fleet does not
wait for its slowest member.  ``/diagnostics`` says in every state what the node is waiting for.  Each activation is a run of its own:
state and damage begin anew (``~/pause`` holds them), recordings get fresh names.  Unless ``autostart`` is false, the node configures and
activates itself.
"""

import dataclasses
import sys
import time
from collections.abc import Callable
from functools import wraps

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.task import Future

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.ros.bearing_doors import STATE_QOS, BearingDoors
from bearing_sim.ros.messages import message, message_class
from bearing_sim.ros.parameter_server import ParameterServer
from bearing_sim.ros.parameters import NodeSettings, SettingsError
from bearing_sim.ros.process import CannotRun, run_node
from bearing_sim.ros.sim_time import create_steady_timer, follows_clock, watch_clock
from bearing_sim.ros.warm_up import WarmUp
from bearing_sim.runtime.health import Condition
from bearing_sim.scene_file import SceneError
from bearing_sim.sinks.recorder import Recorder

SUCCESS, FAILURE, ERROR = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE, TransitionCallbackReturn.ERROR
_REVIEW_PERIOD = {False: 0.2, True: 0.05}  # [s] how soon a change of health is told, and where the node follows /clock what has come of it
_LATE = 5  # review periods without a review
_WARMING = "warming up: compiling the model; messages that come now are not used"


def _told(transition: Callable) -> Callable:
    """Let a transition that fails say why, in the log and on /diagnostics; rclpy alone would drop the reason."""

    @wraps(transition)
    def guarded(node, state) -> TransitionCallbackReturn:
        name = transition.__name__.removeprefix("on_")
        try:
            result, node.fault = transition(node, state), ""
        except (SettingsError, SceneError, OSError, CannotRun) as fault:
            result, node.fault = FAILURE, f"{name} failed: {fault}"
        except Exception as fault:
            result, node.fault = ERROR, f"{name} failed by a program fault: {fault!r}"
        if node.fault:
            node.get_logger().error(node.fault)
            node.report_soon()
        return result

    return guarded


def _refuse_impossible_transitions(node: LifecycleNode) -> None:
    """Let a request for a transition that the state does not have be answered by "no"; in rclpy alone it ends the process."""
    (service,) = (service for service in node.services if service.srv_name.endswith("/change_state"))
    change_state = service.callback

    def answered(request, response):
        try:
            return change_state(request, response)
        except rclpy_implementation.RCLError as fault:
            node.get_logger().warning(f"transition {request.transition.label or request.transition.id} refused: {' '.join(str(fault).split())}")
            response.success = False
            return response

    service.callback = answered


class BearingNode(LifecycleNode):
    """The life and the parameters of a node that hosts bearings.

    Parameters
    ----------
    ended : given a `CannotRun` where the node ends itself.

    Attributes
    ----------
    review_period : from one review to the next [s].
    """

    def __init__(self, ended: Future):
        super().__init__("bearing_node", automatically_declare_parameters_from_overrides=True)
        self._ended = ended
        self.fault = ""  # why the last transition did not succeed
        self.bearings: list[BearingDoors] = []
        self._state, self._next_report_ns, self._reviewed = "unconfigured", 0, time.monotonic()
        self._warm_up = WarmUp()
        self.recorder = Recorder()  # one process for the recordings of all bearings
        self.parameters = ParameterServer(self, self)
        self._shared: NodeSettings | None = None
        name, ros_type = topics.DIAGNOSTICS
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        self._diagnostics = self.create_publisher(message_class(ros_type), f"/{name}", STATE_QOS, event_callbacks=quiet)
        self.review_period = _REVIEW_PERIOD[follows_clock(self)]
        create_steady_timer(self, self.review_period, self._review)
        self._clock_watch = watch_clock(self, self._tick)
        self.manages_itself = bool(self.parameters.value("autostart"))
        _refuse_impossible_transitions(self)

    def start(self) -> None:
        """Configure and activate, as ``autostart`` asks for.

        Raises
        ------
        CannotRun
            Parameters, a scene or a recording cannot be used.
        """
        for transition in (self.trigger_configure, self.trigger_activate):
            if transition() != SUCCESS:
                raise CannotRun(self.fault.partition("failed: ")[2] or self.fault)

    def close(self) -> bool:
        """Stop the models and complete recordings.  Returns whether every thread ended."""
        self._warm_up.forget()
        stopped = [bearing.destroy() for bearing in self.bearings]
        self.bearings = []
        self.recorder.close(timeout=2.0)
        return all(stopped) and not self._warm_up.is_working

    @_told
    def on_configure(self, state) -> TransitionCallbackReturn:
        """Check parameters, load scenes, make doors, begin to compile."""
        self._shared, bearings = self.parameters.read()
        try:
            for settings in bearings:
                self.bearings.append(BearingDoors(self, settings, self._shared))
                self.parameters.show_scene(settings.name, self.bearings[-1].scene)
        except Exception:
            self._release()
            raise
        for bearing in self.bearings:
            self._warm_up.ask(bearing.warm_up)
        self._state = "inactive"
        return super().on_configure(state)

    @_told
    def on_activate(self, state) -> TransitionCallbackReturn:
        """Let the bearings run that are warm, and the others as soon as they are."""
        if faults := [bearing.fault for bearing in self.bearings if bearing.fault]:
            raise CannotRun(f"{faults[0]}; clean up and configure anew")
        try:
            self._open_those_warm()
        except Exception:
            self._close()
            raise
        self._state = "active"
        return super().on_activate(state)

    @_told
    def on_deactivate(self, state) -> TransitionCallbackReturn:
        """End the runs, complete recordings; the compiled models stay."""
        self._close()
        self._state = "inactive"
        return super().on_deactivate(state)

    @_told
    def on_cleanup(self, state) -> TransitionCallbackReturn:
        """Let everything go that configuring has made."""
        self._release()
        self._state = "unconfigured"
        return super().on_cleanup(state)

    @_told
    def on_shutdown(self, state) -> TransitionCallbackReturn:
        """Let everything go for good; the process stays until a signal comes."""
        self._release()
        self._state = "finalized"
        return super().on_shutdown(state)

    def on_error(self, state) -> TransitionCallbackReturn:
        """Let everything go after a program fault in a transition; the node can be configured anew."""
        self._release()
        self._state = "unconfigured"
        return super().on_error(state)

    @property
    def is_running(self) -> bool:
        """Whether the node is active, so that parameters that need a re-configure cannot change."""
        return self._state == "active"

    def objection(self, changes: dict[str, object]) -> str:
        """Return why parameters cannot be changed so; empty where they can."""
        reasons = (bearing.objection(self.parameters.changes_of(bearing.settings.name, changes)) for bearing in self.bearings)
        return next(filter(None, reasons), "")

    def apply(self, changes: dict[str, object]) -> None:
        """Change parameters from now on."""
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
        """Publish diagnostics at the next review, whenever the last were."""
        self._next_report_ns = 0
        for bearing in self.bearings:
            bearing.report_soon()

    def tell(self, now_ns: int, condition: Condition, component: str, hardware_id: str) -> None:
        """Publish a condition on /diagnostics."""
        values = {"state": self._state, **condition.values}
        fields = topics.diagnostics(now_ns, condition.events, values, component, hardware_id)
        self._diagnostics.publish(message(topics.DIAGNOSTICS[1], fields))

    def review_if_late(self) -> None:
        """Review now where the timer stands still: an rclpy built against an old glibc waits for it by the system's clock, which may be set back."""
        if time.monotonic() - self._reviewed > _LATE * self.review_period:
            self._review()

    def now_ns(self) -> int:
        """Return the node's time [ns since the epoch]."""
        clock = self.get_clock()
        return clock.now().nanoseconds if clock.ros_time_is_active else time.time_ns()  # the same, at a fraction of the cost

    def _open_those_warm(self) -> None:
        for bearing in self.bearings:
            if bearing.live is None and bearing.is_warm and not bearing.fault:
                bearing.open()

    def _close(self) -> None:
        for bearing in self.bearings:
            if not bearing.close():
                self._warm_up.ask(bearing.warm_up)  # its model is still in the hands of the thread that did not end

    def _release(self) -> None:
        self._close()
        self._warm_up.forget()
        for bearing in self.bearings:
            bearing.destroy()
        self.bearings = []

    def _tick(self, now_ns: int) -> None:
        for bearing in self.bearings:
            bearing.tick(now_ns)

    def _review(self) -> None:
        """Open what has become warm, let every bearing review itself, and say what the node waits for where none does."""
        self._reviewed = time.monotonic()
        if self._state == "active":
            self._begin_late()
        now_ns = self.now_ns()
        for bearing in self.bearings:
            bearing.review(now_ns, self._state_event(bearing), self._warm_up)
        steady_ns = time.monotonic_ns()  # /clock may stand still
        if not self.bearings and steady_ns >= self._next_report_ns:
            self._next_report_ns = steady_ns + 1_000_000_000
            self.tell(now_ns, Condition([self._state_event(None)], {}), self.get_fully_qualified_name().lstrip("/"), "")

    def _begin_late(self) -> None:
        """Begin with bearings that have become warm; one that cannot is told, and ends the node where it manages itself and has no other."""
        try:
            self._open_those_warm()
        except OSError as fault:
            if self.manages_itself:
                self._end(CannotRun(str(fault)))
                return
            self.get_logger().error(str(fault))
            self.trigger_deactivate()
            self.fault = f"activate failed: {fault}"
            return
        if self.manages_itself and all(bearing.fault for bearing in self.bearings):
            self._end(CannotRun("\n".join(bearing.fault for bearing in self.bearings), exit_code=1))

    def _end(self, fault: CannotRun) -> None:
        if not self._ended.done():
            self._ended.set_exception(fault)

    def _state_event(self, bearing: BearingDoors | None) -> Event:
        if self.fault:
            return Event(0.0, Level.ERROR, "run.failed", self.fault)
        if bearing is not None and not bearing.is_warm:
            return Event(0.0, Level.WARN, "run.warming_up", _WARMING)
        said = {
            "unconfigured": "unconfigured: waiting to be configured",
            "inactive": "inactive: ready to be activated",
            "finalized": "shut down: end the process",
        }
        return Event(0.0, Level.OK, f"run.{self._state}", said.get(self._state, self._state))


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
    0 after a signal; where the node manages itself, 2 when parameters, scene or recording paths cannot be used, 1 when the scene cannot be
    computed.
    """
    return run_node("bearing_node", _make_node, args)


if __name__ == "__main__":
    sys.exit(main())
