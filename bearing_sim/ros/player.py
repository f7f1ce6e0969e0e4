# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_player`: publish the inputs of an MCAP log on their topics, with the log's timing, and optionally its time on /clock.

Run it with ``bearing_player LOG.mcap`` or ``python -m bearing_sim.ros.player LOG.mcap``; remappings follow ``--ros-args``.
"""

import math
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import NamedTuple

import click
import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from rclpy.utilities import remove_ros_args
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

from bearing_sim.files.standard_streams import standard_streams
from bearing_sim.inputs.gate import with_values
from bearing_sim.inputs.log import REQUIRED, InputLog, InputLogError, read_input_log
from bearing_sim.messages import topics
from bearing_sim.ros.messages import message, message_class
from bearing_sim.ros.network import close_other_interfaces, use_loopback
from bearing_sim.ros.process import signals_end
from bearing_sim.ros.rclpy_internals import RclError
from bearing_sim.ros.shared_memory import remove_unfinished_ports
from bearing_sim.runtime.sim_time import CAUGHT_UP
from bearing_sim.simulation import Inputs

_SLICE = 0.05  # [s] longest sleep, so that signals are obeyed
_ACKNOWLEDGED = 1.0  # [s] time to wait for acknowledgements
_DELIVERY = 0.2  # [s] best-effort subscribers do not acknowledge, and messages of a destroyed publisher are lost
_COURTESY = 1.0  # [s] time to wait for subscribers of optional channels once the required ones have theirs
_SETTLED = 1.0  # [s] after the end before a follower of the clock can know that everything has arrived
_SCALAR = "std_msgs/msg/Float64"


class ScheduledMessage(NamedTuple):
    """A message to be published."""

    time: float  # [s] since the first message of the log
    channel: str
    values: tuple[float, ...]
    stamp_ns: int  # as in the log [ns since the epoch]


def schedule(log: InputLog, by_stamps: bool = False) -> list[ScheduledMessage]:
    """Return a log's messages in the order of their log times, or of their stamps.

    By stamps, each channel keeps its order: a message with an earlier stamp than its predecessor is due together with it.
    """
    found = []
    for channel, series in log.series.items():
        newest = 0
        for log_ns, stamp, values in zip(series.log_times, series.stamps, series.values):
            newest = max(newest, stamp)
            found.append((newest if by_stamps else log_ns, channel, values, stamp))
    found.sort(key=lambda entry: entry[0])
    return [ScheduledMessage((due - found[0][0]) * 1e-9, channel, values, stamp) for due, channel, values, stamp in found]


class Timeline:
    """The playback position in the log: wall time times the rate, except for pauses.

    Parameters
    ----------
    rate : log seconds per second.
    paused : whether it starts paused.
    """

    def __init__(self, rate: float, paused: bool = False):
        self.rate, self._held, self._anchor = rate, 0.0 if paused else None, (time.monotonic(), 0.0)

    @property
    def is_paused(self) -> bool:
        """Whether the position is held."""
        return self._held is not None

    @property
    def position(self) -> float:
        """The position [s since the first message]."""
        held, (wall, position) = self._held, self._anchor
        return held if held is not None else position + (time.monotonic() - wall) * self.rate

    def pause(self, paused: bool) -> None:
        """Hold the position, or continue from it."""
        position = self.position
        self._anchor, self._held = (time.monotonic(), position), position if paused else None

    def restart(self) -> None:
        """Return to the first message."""
        self._anchor, self._held = (time.monotonic(), 0.0), 0.0 if self.is_paused else None


class Player:
    """Publishes scheduled messages through a node.

    Parameters
    ----------
    node : its names and remappings apply; spun by the caller, for its service ``~/pause`` (std_srvs/SetBool).
    wants_end : ``wants_end()`` returns whether to stop early.
    channels : channels to be published.
    timeline : position in the log.
    scalar : publish shaft speed and radial load as Float64.
    clock_rate : readings of /clock per second of wall time [Hz]; stamps are then the log's own.  None: no clock, stamps of the present time.
    joints : names of the joints, by channel.

    Attributes
    ----------
    sent : messages published, by channel.
    lateness : summed over all messages [s].
    reached : time in the log [s].
    """

    def __init__(
        self,
        node: Node,
        wants_end: Callable[[], bool],
        channels: Iterable[str],
        timeline: Timeline,
        scalar: bool = False,
        clock_rate: float | None = None,
        joints: dict[str, str] | None = None,
    ):
        self._node, self.wants_end, self.timeline = node, wants_end, timeline
        self._clock_period, self._next_clock = 1.0 / clock_rate if clock_rate else None, 0.0
        self._joints = joints or {}
        self.sent: Counter[str] = Counter()
        self.lateness = self.reached = 0.0
        self._caught_up: dict[str, tuple[float, bool]] = {}
        self._types = {}
        for channel in channels:
            possible = topics.input_types(channel)
            self._types[channel] = _SCALAR if scalar and _SCALAR in possible else possible[0]
        # Reliable, so that any subscriber matches; all messages are kept until acknowledged, so that a burst loses none.
        qos = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
        self._publishers = {channel: node.create_publisher(message_class(kind), channel, qos) for channel, kind in self._types.items()}
        node.create_service(SetBool, "~/pause", self._serve_pause)
        if clock_rate:
            self._clock = node.create_publisher(Clock, "/clock", QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE))
            name, kind = topics.DIAGNOSTICS
            node.create_subscription(message_class(kind), f"/{name}", self._note_diagnostics, 100)

    def without_subscriber(self, channels: Iterable[str] = REQUIRED) -> list[str]:
        """Return the channels that have no subscriber."""
        return [channel for channel in channels if self._publishers[channel].get_subscription_count() == 0]

    def wait_for_subscribers(self, limit: float) -> bool:
        """Wait until every required channel has a subscriber; False after ``limit`` [s] or a signal."""
        if not self._wait(REQUIRED, limit):
            return False
        self._wait(self._publishers, _COURTESY)
        return not self.wants_end()

    def _wait(self, channels: Iterable[str], limit: float) -> bool:
        deadline = time.monotonic() + limit
        while self.without_subscriber(channels):
            if time.monotonic() > deadline or self.wants_end():
                return False
            time.sleep(_SLICE)
        return True

    def play(self, messages: list[ScheduledMessage], progress: Callable[[float], None]) -> bool:
        """Publish all messages, calling ``progress(time)`` meanwhile; False after a signal."""
        start_ns, line = self._node.get_clock().now().nanoseconds, self.timeline
        first_ns = messages[0].stamp_ns
        line.restart()
        for due in messages:
            while (rest := due.time - line.position) > 0.0 or line.is_paused:
                self._show_clock(first_ns + round(min(line.position, due.time) * 1e9))
                progress(line.position)
                if self.wants_end():
                    return False
                time.sleep(min(_SLICE if line.is_paused else rest / line.rate, _SLICE, self._clock_period or _SLICE))
            if self.wants_end():
                return False
            self.lateness += -rest / line.rate
            self.reached = due.time
            self._show_clock(first_ns + round(due.time * 1e9))
            self._publish(due, start_ns + round(due.time / line.rate * 1e9) if self._clock_period is None else due.stamp_ns)
        progress(messages[-1].time)
        end_ns = first_ns + round(messages[-1].time * 1e9)
        self._show_clock(end_ns, at_once=True)
        deadline = time.monotonic() + _ACKNOWLEDGED
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=max(deadline - time.monotonic(), 0.0)))
        for _ in range(4):  # followers use the last messages only if they receive the clock's end
            self._show_clock(end_ns, at_once=True)
            time.sleep(_DELIVERY / 4)
        return True

    def wait_until_used(self, messages: list[ScheduledMessage], limit: float) -> bool:
        """Show the end of the log until every follower reports that it has used all messages; False after ``limit`` [s] or a signal."""
        began, end_ns = time.monotonic(), messages[0].stamp_ns + round(messages[-1].time * 1e9)
        while time.monotonic() - began < limit and not self.wants_end():
            self._show_clock(end_ns)
            known = [caught_up for at, caught_up in self._caught_up.values() if at - began > _SETTLED]
            if known and all(known) and len(known) == len(self._caught_up):
                return True
            time.sleep(_SLICE)
        return False

    def _publish(self, due: ScheduledMessage, stamp_ns: int) -> None:
        kind = self._types[due.channel]
        fields = {"data": float(due.values[0])} if kind == _SCALAR else _fields(due, stamp_ns)
        if due.channel in self._joints and "name" in fields:
            own = self._joints[due.channel]
            fields["name"] = [own, topics.standard_error_joint(own)][: len(fields["name"])]
        filled = message(kind, fields)
        while not self.wants_end():
            try:
                self._publishers[due.channel].publish(filled)
            except RclError:  # the queue is full of messages that a slow subscriber has not acknowledged
                time.sleep(_SLICE)
            else:
                break
        self.sent[due.channel] += 1

    def _show_clock(self, time_ns: int, at_once: bool = False) -> None:
        if self._clock_period is None or (not at_once and time.monotonic() < self._next_clock):
            return
        self._next_clock = max(self._next_clock + self._clock_period, time.monotonic())
        self._clock.publish(message("rosgraph_msgs/msg/Clock", {"clock": topics.stamp(time_ns)}))

    def _serve_pause(self, request, response):
        self.timeline.pause(request.data)
        state = "paused" if request.data else "playing"
        response.success, response.message = True, f"{state} at {self.timeline.position:.3f} s of the log"
        return response

    def _note_diagnostics(self, report) -> None:
        for status in report.status[:1]:
            for pair in status.values:
                if pair.key == CAUGHT_UP:
                    self._caught_up[status.name] = (time.monotonic(), pair.value == "True")


def _fields(due: ScheduledMessage, stamp_ns: int) -> dict:
    if due.channel in topics.MEASURED_CHANNELS:
        return topics.MEASUREMENTS[due.channel].message(stamp_ns, due.values)
    return topics.INPUTS[due.channel].message(stamp_ns, with_values(Inputs(0.0, 0.0, 0.0, 0.0), due.channel, due.values))


@contextmanager
def progress_of(title: str, total: float) -> Iterator[Callable[[float], None]]:
    """Show progress on stderr, a bar on a terminal, otherwise a line every 10 %; yields the function that takes how much of ``total`` is done."""
    if sys.stderr.isatty():
        with click.progressbar(length=math.ceil(total), label=title, file=sys.stderr) as bar:  # which counts whole seconds
            yield lambda time: bar.update(math.ceil(time) - bar.pos)
        return
    due = 0.1

    def show(time: float) -> None:
        nonlocal due
        if total > 0 and time / total >= due - 1e-9:
            print(f"{title}: {100 * time / total:.0f} % ({time:.1f} of {total:.1f} s)", file=sys.stderr, flush=True)
            due = int(10 * time / total) / 10 + 0.1

    yield show


@contextmanager
def services_running(node: Node) -> Iterator[None]:
    """Serve the node's services on a separate thread."""
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def spin() -> None:
        try:
            executor.spin()
        except ExternalShutdownException:
            pass

    thread = Thread(target=spin, name="services", daemon=True)
    thread.start()
    try:
        yield
    finally:
        executor.shutdown(1.0)
        thread.join(1.0)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("log", type=click.Path(path_type=Path))
@click.option("--rate", type=click.FloatRange(1e-3, 1e3), default=1.0, show_default=True, help="Playback speed relative to the recording.")
@click.option(
    "--clock",
    "clock_rate",
    type=click.FloatRange(0.1, 1000.0),
    metavar="HZ",
    help="Publish the log's time on /clock at this rate and keep the log's stamps, for nodes with use_sim_time [default: no clock].",
)
@click.option(
    "--stamps", type=click.Choice(["header", "log"]), default="header", show_default=True, help="With --clock: which stamps to use, as in replay."
)
@click.option("--start-paused", is_flag=True, help="Wait for the service ~/pause (std_srvs/SetBool, data: false).")
@click.option("--loop", is_flag=True, help="Start again at the end, until a signal arrives; with --clock the time jumps back.")
@click.option(
    "--wait-until-used",
    "use_limit",
    type=click.FloatRange(0.0),
    default=0.0,
    metavar="S",
    help="With --clock: at the end, wait up to S seconds until all followers report that they have used all messages [default: 0].",
)
@click.option("--wait-for-subscribers/--no-wait", default=True, show_default=True, help="Start once speed and load have a subscriber.")
@click.option("--wait-limit", type=click.FloatRange(0.0), default=60.0, show_default=True, metavar="S", help="Stop waiting after S seconds.")
@click.option("--input-type", type=click.Choice(["stamped", "scalar"]), default="stamped", show_default=True, help="As the node's parameter.")
@click.option("--joint", default=topics.SHAFT_JOINT, show_default=True, help="Name of the shaft's joint, in the log and in the messages.")
@click.option("--cage-joint", default=topics.CAGE_JOINT, show_default=True, help="Name of the cage's joint, likewise.")
@click.pass_context
def command(context, log, rate, clock_rate, stamps, start_paused, loop, use_limit, wait_for_subscribers, wait_limit, input_type, joint, cage_joint):
    """Publish the inputs of the MCAP recording LOG with its timing: speed, load, temperatures, measured cage speed and clearance.

    ROS arguments (remappings, namespace) follow --ros-args.
    """
    try:
        recording = read_input_log(log, joint=joint, stamps=stamps, cage_joint=cage_joint)
    except InputLogError as error:
        click.echo(f"bearing_player: {error}", err=True)
        context.exit(2)
    if recording.unfinished:
        click.echo(f"bearing_player: {recording.unfinished}", err=True)
    messages = schedule(recording, by_stamps=clock_rate is not None)
    ended: Future = context.obj  # done after a signal
    try:
        node = rclpy.create_node("bearing_player", start_parameter_services=False)
    except RclError as error:
        click.echo(f"bearing_player: cannot start ROS: {' '.join(str(error).split())}", err=True)
        context.exit(2)
    close_other_interfaces(node)
    joints = {"shaft_speed": joint, topics.MEASURED: cage_joint}
    player = Player(node, ended.done, recording.series, Timeline(rate, start_paused), input_type == "scalar", clock_rate, joints)
    try:
        with services_running(node):
            if wait_for_subscribers and not player.wait_for_subscribers(wait_limit):
                if not ended.done():
                    click.echo(f"bearing_player: no subscriber for {', '.join(player.without_subscriber())} within {wait_limit:g} s", err=True)
                context.exit(130 if ended.done() else 1)
            complete = _play(player, messages, log.name, use_limit if clock_rate else 0.0)
            while complete and loop:
                complete = _play(player, messages, log.name, use_limit if clock_rate else 0.0)
        counts = ", ".join(f"{count} {channel}" for channel, count in player.sent.items())
        late = 1e3 * player.lateness / max(1, player.sent.total())
        ending = "played" if complete else "stopped by a signal after"
        click.echo(f"{ending} {player.reached:.1f} s of the log at rate {rate:g}: {counts}; mean delay {late:.2f} ms")
        context.exit(0 if complete else 130)
    finally:
        node.destroy_node()


def _play(player: Player, messages: list[ScheduledMessage], name: str, use_limit: float) -> bool:
    """Play all messages and wait up to ``use_limit`` [s] until followers of the clock have used them; False after a signal."""
    with progress_of(f"playing {name}", messages[-1].time) as show:
        complete = player.play(messages, show)
    if not (complete and use_limit):
        return complete
    if player.wait_until_used(messages, use_limit):
        return True
    if not player.wants_end():
        click.echo(f"bearing_player: no follower of /clock reported within {use_limit:g} s that it has used all messages", err=True)
    return not player.wants_end()


@standard_streams()
def main(args: list[str] | None = None) -> int:
    """Run the player.

    Returns
    -------
    0 if all messages were published, 1 if there was no subscriber, 2 if the log cannot be used, 130 after a signal.
    """
    argv = sys.argv if args is None else ["bearing_player", *args]
    own = remove_ros_args(argv)[1:]
    if {"-h", "--help"} & set(own):
        return command.main(own, prog_name="bearing_player", standalone_mode=False) or 0
    if note := use_loopback():
        click.echo(f"bearing_player: {note}", err=True)
    try:
        rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        click.echo(f"bearing_player: cannot start ROS: {' '.join(str(error).split())}", err=True)
        return 2
    for warning in remove_unfinished_ports():
        click.echo(f"bearing_player: {warning}", err=True)
    ended = Future()
    try:
        with signals_end(ended):
            return command.main(own, prog_name="bearing_player", standalone_mode=False, obj=ended) or 0
    except click.ClickException as error:
        error.show()
        return error.exit_code
    finally:
        rclpy.shutdown()


if __name__ == "__main__":
    sys.exit(main())
