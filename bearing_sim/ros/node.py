# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_node`: one bearing or several as a managed ROS 2 node.

Subscribes to shaft speed and radial load, advances each model in real time on its own thread, publishes cage slip, life and roller loads,
reports health on ``/diagnostics``, and records on request.  `bearing_sim.ros.interface` handles one bearing; this module handles the
node's lifecycle and its parameters.  Run it with ``bearing_node``, ``python -m bearing_sim.ros.node`` or ``ros2 run bearing_sim bearing_node``.

**Lifecycle.**  Configuring checks parameters and scenes, creates publishers and services, and starts compiling the models on a separate
thread.  It answers within a second however long compiling takes: lifecycle managers give up on slow answers, and the node stays responsive.
Activating opens inputs and recordings of each bearing as soon as its model is compiled: a fleet does not wait for its slowest member.
``/diagnostics`` reports in every state what the node is waiting for, as a warning where a bearing should be monitored and is not.  Each activation
is a new run: state and damage start over (``~/pause`` holds them), recordings get fresh names.  Unless ``autostart`` is false, the node configures
itself, and activates itself once the first of its models is compiled, so that *active* means that there is something that it monitors.
"""

import sys

if __name__ == "__main__":  # before anything is imported, which takes a second or two: a signal must end the node cleanly in the meantime, too
    from bearing_sim.files.programs import bearing_node

    sys.exit(bearing_node())

import dataclasses
import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial, wraps

from rclpy.clock import Clock, ClockType, JumpHandle, JumpThreshold
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.task import Future

from bearing_sim.files.cores import cores
from bearing_sim.inputs.static_transforms import StaticTransforms
from bearing_sim.messages import diagnostics, topics
from bearing_sim.messages.cdr import message_type
from bearing_sim.messages.events import Event, Level
from bearing_sim.recording.recorder import Recorder
from bearing_sim.ros.interface import BearingInterface, PublishedTopics
from bearing_sim.ros.messages import message_class
from bearing_sim.ros.network import close_other_interfaces
from bearing_sim.ros.parameters import BearingSettings, NodeSettings, ParameterServer, SettingsError, follows_clock, scene_values_in
from bearing_sim.ros.polling import POLLED_FROM, PolledSubscriptions
from bearing_sim.ros.process import CannotRun, run_node
from bearing_sim.ros.qos import STATE_QOS, entities_of_bearing, profiles, publisher
from bearing_sim.ros.rclpy_internals import RclError, wrap_service
from bearing_sim.ros.transforms import TransformInterface
from bearing_sim.ros.warm_up import WarmUp
from bearing_sim.ros.workers import NodeLink, Order, Worker, Workers, passed_arguments, process_count, shares, worker_connection
from bearing_sim.runtime.health import Condition, not_running
from bearing_sim.runtime.solver_threads import SolverThreads
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import with_values

SUCCESS, FAILURE, ERROR = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE, TransitionCallbackReturn.ERROR
_REVIEW_PERIOD = {False: 0.2, True: 0.05}  # [s] delay until a change of health, and with sim time an output, is published
_REVIEWED_AT_ONCE = 10  # bearings; a node with more of them reviews each less often, because a review takes a millisecond
_LONGEST_REVIEW = 3  # times as long as with few bearings
_LATE = 5  # review periods without a review
_NODE = {"node_name": "bearing_node"}
_WARMING = Event(0.0, Level.WARN, "run.warming_up", "", "warming up, not monitored yet: compiling the model; messages that come now are not used")


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
    """Answer "no" to a request for a transition that the current state does not have; rclpy of ROS 2 Jazzy alone would end the process."""

    def answering(change_state: Callable) -> Callable:
        def answered(request, response):
            try:
                return change_state(request, response)
            except RclError as error:
                node.get_logger().warning(f"transition {request.transition.label or request.transition.id} refused: {' '.join(str(error).split())}")
                response.success = False
                return response

        return answered

    wrap_service(node, "change_state", answering)


def _worker_options(order: Order) -> dict[str, object]:
    """Return the options of the ROS node of a worker process, which has no services of its own."""
    return {
        "node_name": order.name,
        "namespace": order.namespace,
        "parameter_overrides": [Parameter(name, value=value) for name, value in order.parameters.items()],
        "start_parameter_services": False,
        "enable_communication_interface": False,
    }


class BearingNode(LifecycleNode):
    """The lifecycle and the parameters of a node that hosts one or more bearings.

    Parameters
    ----------
    ended : receives a `CannotRun` when the node ends itself.
    order : of a worker process (see `bearing_sim.ros.workers`); None for the node itself.
    arguments : the command line, for worker processes.

    Attributes
    ----------
    review_period : time from one review of a bearing to the next [s].
    """

    def __init__(self, ended: Future, order: Order | None = None, arguments: Sequence[str] = ()):
        super().__init__(**_NODE if order is None else _worker_options(order), automatically_declare_parameters_from_overrides=True)
        self._ended, self._order, self._arguments = ended, order, arguments
        self._component = self.get_fully_qualified_name().lstrip("/") if order is None else order.component
        self.error = ""  # why the last transition failed
        # Subjects that have been reported, by component: a status that is not reported any more would turn stale.
        self._told_of: dict[str, set[str]] = {} if order is None else dict(order.reported)
        self.published_topics = PublishedTopics(self)
        self.bearings: list[BearingInterface] = []
        self._to_review: deque[BearingInterface] = deque()
        self.workers = Workers()
        self.polled: PolledSubscriptions | None = None
        self._scenes: dict[str, Scene] = {}  # of the bearings of workers
        self._state, self._next_report_ns, self._reviewed = "unconfigured", 0, time.monotonic()
        self._warm_up = WarmUp()
        self.recorder = Recorder()
        self.solver_threads = SolverThreads()
        self.parameters = ParameterServer(self)
        self._shared: NodeSettings | None = None
        self._frames: TransformInterface | None = None
        self._diagnostics: Publisher | None = None
        self._report_by(STATE_QOS)
        self.review_period = _REVIEW_PERIOD[follows_clock(self)]
        self._ticks = 0  # of the timer of reviews
        _create_steady_timer(self, self.review_period, self._review)
        self._clock_watch = self._watch_clock()
        self._activates_itself = False  # as soon as there is something to monitor
        self.manages_itself = bool(self.parameters.value("autostart"))
        if order is None:
            _refuse_impossible_transitions(self)

    def start(self) -> None:
        """Configure, and activate once the first model is compiled, as requested by ``autostart``.

        Raises
        ------
        CannotRun
            Parameters or a scene cannot be used.
        """
        if self.trigger_configure() != SUCCESS:
            raise self._failure()
        self._activates_itself = True

    def declare_parameters(self, namespace: str, parameters: Sequence[tuple], ignore_override: bool = False) -> list[Parameter]:
        """Declare parameters; an empty list, which has no type in a parameter file, counts as a list with an empty text: rclpy would raise."""
        typed = [(name, [""], *rest[1:]) if rest and rest[0] is None else (name, *rest) for name, *rest in parameters]
        return super().declare_parameters(namespace, typed, ignore_override)

    def close(self) -> bool:
        """Stop the models and complete recordings.  Returns whether all threads ended."""
        self._warm_up.close()
        self.workers.end()
        stopped = [bearing.destroy() for bearing in self.bearings]
        self.bearings = []
        self._to_review.clear()
        self.recorder.close(timeout=2.0)
        return all(stopped) and not self._warm_up.is_working

    @_reported
    def on_configure(self, state) -> TransitionCallbackReturn:
        """Check parameters, load scenes, create topics and services, and start compiling."""
        self._shared, bearings = self.parameters.settings()
        name = self.resolve_topic_name(f"/{topics.DIAGNOSTICS[0]}")
        self._report_by(profiles(self.parameters, [publisher(name, STATE_QOS)])[name, "publisher"])
        processes = process_count(int(self.parameters.value("processes")), len(bearings), cores())
        if processes > 1:
            self._start_workers(bearings, processes)
            bearings = []
        try:
            self._frames = TransformInterface(self, bearings)
            for settings in bearings:
                self.bearings.append(BearingInterface(self, settings, self._shared))
                self.parameters.show_scene(settings.name, self.bearings[-1].scene)
        except Exception:
            self._release()
            raise
        self.parameters.warn_of_unknown_topics()
        for bearing in self.bearings:
            self._warm_up.request(partial(self._warm_up.compile, bearing.scene))
            self._warm_up.request(bearing.warm_up)
        self._state = "inactive"
        return super().on_configure(state)

    @_reported
    def on_activate(self, state) -> TransitionCallbackReturn:
        """Start the bearings that have warmed up; the others follow as soon as they have."""
        if not self._activates_itself and (errors := [bearing.error for bearing in self.bearings if bearing.error]):
            raise CannotRun(f"{errors[0]}; clean up and configure again")
        self.workers.activate(True)
        try:
            self._open_warm_bearings()
        except Exception:
            self._close()
            raise
        self._state, self._activates_itself = "active", False
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
        reasons = [bearing.reason_to_refuse(self.parameters.changes_of(bearing.settings.name, changes)) for bearing in self.bearings]
        reasons += [worker.reason_to_refuse(self.parameters.of_share(changes, worker.bearings)) for worker in self.workers]
        return next(filter(None, reasons), "")

    def apply(self, changes: dict[str, object]) -> None:
        """Apply parameter changes."""
        for bearing in self.bearings:
            bearing.apply(self.parameters.changes_of(bearing.settings.name, changes))
            self.parameters.show_scene(bearing.settings.name, bearing.scene)
        for worker in self.workers:
            worker.adjust(self.parameters.of_share(changes, worker.bearings))
        for name, scene in self._scenes.items():
            self._scenes[name] = with_values(scene, scene_values_in(self.parameters.changes_of(name, changes)))
            self.parameters.show_scene(name, self._scenes[name])
        if self._shared is not None and changes.get("publish_rate", self._shared.publish_rate) != self._shared.publish_rate:
            self._shared = dataclasses.replace(self._shared, publish_rate=changes["publish_rate"])
            for bearing in self.bearings:
                bearing.publish_at(changes["publish_rate"])
        if self._shared is not None and changes.get("governor", self._shared.governor) != self._shared.governor:
            self._shared = dataclasses.replace(self._shared, governor=changes["governor"])
            for bearing in self.bearings:
                bearing.govern(changes["governor"], self._warm_up)

    def report_soon(self) -> None:
        """Publish diagnostics at the next review."""
        self._next_report_ns = 0
        for bearing in self.bearings:
            bearing.report_soon()
        for worker in self.workers:
            worker.show_error(self.error)

    def publish_diagnostics(self, now_ns: int, condition: Condition, component: str, hardware_id: str) -> None:
        """Publish a condition on /diagnostics, with the state of the node."""
        values = {"state": self._state, **condition.values}
        if self._order is not None and self._order.restarts:
            values["state: restarts of the process"] = self._order.restarts
        before = self._told_of.get(component, set())
        unused = condition.unused - before
        fields = diagnostics.report(now_ns, condition.events, values, component, hardware_id, condition.remarks, condition.otherwise, unused)
        if new := {status["name"].partition(": ")[2] for status in fields["status"]} - before:
            self._note_reported(component, new)
        self._diagnostics.publish(message_type(topics.DIAGNOSTICS[1]).serialize(fields))

    def _note_reported(self, component: str, subjects: set[str]) -> None:
        """Note subjects that have been reported for the first time."""
        self._told_of.setdefault(component, set()).update(subjects)

    @property
    def service_prefix(self) -> str:
        """What the names of the bearings' services begin with: the node's name, also in a worker process, whose own name is hidden."""
        return "~" if self._order is None else f"/{self._order.component}"

    def component_of(self, bearing: str) -> str:
        """Return the first half of the names of a bearing's statuses: the node's name, and the bearing's if it has one."""
        return f"{self._component}/{bearing}" if bearing else self._component

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

    def _report_by(self, profile: QoSProfile) -> None:
        """Publish diagnostics with this quality of service."""
        if self._diagnostics is not None:
            if self._diagnostics.qos_profile == profile:
                return
            self.destroy_publisher(self._diagnostics)
        name, ros_type = topics.DIAGNOSTICS
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        self._diagnostics = self.create_publisher(message_class(ros_type), f"/{name}", profile, event_callbacks=quiet)

    def _open_warm_bearings(self) -> None:
        for bearing in self.bearings:
            if bearing.live is None and bearing.is_warm and not bearing.error:
                bearing.open()

    def _close(self) -> None:
        self.workers.activate(False)
        for bearing in self.bearings:
            if not bearing.close():
                self._warm_up.request(bearing.warm_up)  # its model is still in use by the thread that did not end

    def _release(self) -> None:
        self._activates_itself = False
        self._close()
        self._warm_up.cancel()
        self.workers.end()
        self._scenes.clear()
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
        self._start_warm()
        now_ns = self.now_ns()
        period = _REVIEW_PERIOD[follows_clock(self)]
        every = 1 if follows_clock(self) else min(1 + len(self.bearings) // (_REVIEWED_AT_ONCE + 1), _LONGEST_REVIEW)
        self._ticks, self.review_period = (self._ticks + 1) % every, every * period
        if self._ticks == 0 and not self._to_review:
            self._to_review.extend(self.bearings)
            self._review_next()
        if self.workers:
            self._review_workers()
        steady_ns = time.monotonic_ns()  # /clock may stand still
        if not self.bearings and steady_ns >= self._next_report_ns:
            self._next_report_ns = steady_ns + 1_000_000_000
            self._report_alone(now_ns)

    def _report_alone(self, now_ns: int) -> None:
        """Report the state of bearings for which nobody else does: of an unconfigured node, or of workers that are not there yet."""
        events = {name: self._state_event(None) for name in dict.fromkeys(self.parameters.bearings() or [""]) if not self.workers}
        for worker in self.workers:
            if not worker.is_configured:
                event = Event(0.0, Level.ERROR, "run.failed", "", worker.loss) if worker.loss else _WARMING
                events |= dict.fromkeys(worker.bearings, event)
        for name, event in events.items():
            serial = str(self.parameters.value("serial", name))
            self.publish_diagnostics(now_ns, not_running(event), self.component_of(name), serial)

    def _start_workers(self, bearings: Sequence[BearingSettings], processes: int) -> None:
        """Start worker processes for bearings whose scenes can be used."""
        self._scenes = {each.name: load_scene(each.scene, each.scene_overrides, each.allow_outside) for each in bearings}
        for name, scene in self._scenes.items():
            self.parameters.show_scene(name, scene)
            profiles(self.parameters, entities_of_bearing(scene, lambda topic: self.resolve_topic_name(f"{name}/{topic}"), follows_clock(self)))
        node, workers = self.get_name(), []
        for number, share in enumerate(shares(list(self._scenes), processes), 1):
            own = self.parameters.for_worker([settings for settings in bearings if settings.name in share])
            order = Order(f"_{node}_{number}", self.get_namespace(), self._component, passed_arguments(self._arguments, node), own, 0, self._told_of)
            workers.append(Worker(share, order))
            self.get_logger().info(f"process {workers[-1].pid} for {workers[-1].named}")
        self.workers = Workers(workers)

    def _review_workers(self) -> None:
        """Take what worker processes say, and start those again that have ended."""
        for worker in self.workers:
            loss = worker.loss
            failure = worker.review()
            if worker.loss and worker.loss != loss:
                self.get_logger().error(worker.loss)
                self._next_report_ns = 0
            if failure is not None:
                self._handle_failure(CannotRun(failure.text, failure.exit_code))
                return
        if self.manages_itself and all(worker.errors for worker in self.workers):
            self._end(CannotRun("\n".join(error for worker in self.workers for error in worker.errors), exit_code=1))

    def _handle_failure(self, failure: CannotRun) -> None:
        """End a node that manages itself; deactivate one that somebody else manages."""
        if self.manages_itself:
            self._end(failure)
            return
        self.get_logger().error(str(failure))
        if self._state == "active":
            self.trigger_deactivate()
            self.error = f"activate failed: {failure}"
            self.report_soon()

    def _review_next(self) -> None:
        """Review one bearing, and leave the next one to a task, so that messages that have come in the meantime are taken in between."""
        if not self._to_review:  # the node has been cleaned up in the meantime
            return
        bearing = self._to_review.popleft()
        bearing.review(self.now_ns(), self._state_event(bearing), self._warm_up)
        if self._to_review:
            self.executor.create_task(self._review_next)

    def _start_warm(self) -> None:
        """Start bearings that have warmed up; end a node that manages itself if a recording or all its bearings fail."""
        if self._activates_itself and any(each.is_warm for each in (*self.bearings, *self.workers)) and self.trigger_activate() != SUCCESS:
            self._end(self._failure())
            return
        try:
            if self._state == "active":
                self._open_warm_bearings()
        except OSError as error:
            self._handle_failure(CannotRun(str(error)))
            return
        if self.bearings and self.manages_itself and all(bearing.error for bearing in self.bearings):
            self._end(CannotRun("\n".join(bearing.error for bearing in self.bearings), exit_code=1))

    def _failure(self) -> CannotRun:
        """Return why the last transition failed."""
        return CannotRun(self.error.partition("failed: ")[2] or self.error)

    def _end(self, error: CannotRun) -> None:
        if not self._ended.done():
            self._ended.set_exception(error)

    def _state_event(self, bearing: BearingInterface | None) -> Event:
        if self.error:
            return Event(0.0, Level.ERROR, "run.failed", "", self.error)
        if bearing is not None and not bearing.is_warm:
            return _WARMING
        text = {
            "unconfigured": "unconfigured: waiting to be configured",
            "inactive": "inactive: ready to be activated",
            "finalized": "shut down: end the process",
        }
        return Event(0.0, Level.OK, f"run.{self._state}", "", text.get(self._state, self._state))


def _create_steady_timer(node: LifecycleNode, period: float, callback: Callable[[], None]):
    """Return a timer in wall time [s], which keeps running when /clock stands still or is absent."""
    return node.create_timer(period, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))


class WorkerNode(BearingNode):
    """A node in a worker process (see `bearing_sim.ros.workers`), which does what the node asks for.

    Parameters
    ----------
    ended : see `BearingNode`; completed when the node ends.
    link : to the node.
    """

    def __init__(self, ended: Future, link: NodeLink):
        self._link, self._is_listening, self._has_told_warm = link, False, False
        super().__init__(ended, link.order)
        self.manages_itself = True  # what makes it impossible to run is passed to the node
        if len(link.order.parameters["bearings"]) > POLLED_FROM and not follows_clock(self):  # with sim time no message may be lost
            self.polled = PolledSubscriptions(self)

    def close(self) -> bool:
        """Stop the models and complete recordings.  Returns whether all threads ended."""
        stopped = super().close()
        if self.polled is not None:
            self.polled.destroy()
        return stopped

    def start(self) -> None:
        """Configure; the node says when to activate."""
        if self.trigger_configure() != SUCCESS:
            self._fail()
            raise CannotRun(self.error)
        self._link.send("configured")

    def _review(self) -> None:
        if not self._is_listening:  # there is an executor now
            self._is_listening = True
            self._link.listen(lambda message: self.executor.create_task(self._obey, *message), self._end_soon)
        if not self._has_told_warm and any(bearing.is_warm for bearing in self.bearings):
            self._has_told_warm = True
            self._link.send("warm")
        super()._review()

    def _obey(self, kind: str, *rest) -> None:
        if kind == "activate" and not self.is_running and self.trigger_activate() != SUCCESS:
            self._fail()
        elif kind == "deactivate" and self.is_running:
            self.trigger_deactivate()
        elif kind == "set":
            self.set_parameters([Parameter(name, value=value) for name, value in rest[0].items()])
        elif kind == "check":
            self._link.send("answer", rest[0], self.reason_to_refuse(rest[1]))
        elif kind == "error":
            self.error = rest[0]
            super().report_soon()
        elif kind == "end":
            self._end_now()

    def _note_reported(self, component: str, subjects: set[str]) -> None:
        """Tell the node, so that other processes report them, too, should this one end."""
        super()._note_reported(component, subjects)
        self._link.send("reported", component, subjects)

    def _fail(self) -> None:
        self._link.send("failed", self.error.partition("failed: ")[2] or self.error, 2)

    def _end(self, error: CannotRun) -> None:
        """Tell the node; models that cannot be computed are no reason to end, because other workers may have others."""
        if error.exit_code == 1:
            self._link.send("errors", str(error).splitlines())
            return
        self._link.send("failed", str(error), error.exit_code)
        super()._end(error)

    def _end_soon(self) -> None:
        self.executor.create_task(self._end_now)

    def _end_now(self) -> None:
        if not self._ended.done():
            self._ended.set_result(None)


def _started(node: BearingNode) -> BearingNode:
    close_other_interfaces(node)
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
    arguments = sys.argv[1:] if args is None else args
    if (connection := worker_connection(arguments)) is not None:
        link = NodeLink(connection)
        return run_node("bearing_node", lambda ended: _started(WorkerNode(ended, link)), ["--ros-args", *link.order.arguments])
    return run_node("bearing_node", lambda ended: _started(BearingNode(ended, arguments=arguments)), args)
