# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_player`: publish the inputs of an MCAP log on the real topics, with the log's timing.

Run by ``bearing_player LOG.mcap`` or ``python -m bearing_sim.ros.player LOG.mcap``; remappings follow ``--ros-args``.
"""

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import click
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from bearing_sim import topics
from bearing_sim.input_log import REQUIRED, InputLog, InputLogError, read_input_log
from bearing_sim.ros.messages import message, message_class
from bearing_sim.simulation import Inputs

_SLICE = 0.05  # [s] a sleep is cut into such slices, so that a signal is obeyed
_DELIVERY = 0.2  # [s] best-effort subscribers acknowledge nothing, and a message of a publisher that is gone is lost
_COURTESY = 1.0  # [s] how long the optional channels are waited for once the required ones are heard
_SCALAR = "std_msgs/msg/Float64"


class Play(NamedTuple):
    """One message to be published."""

    time: float  # [s] since the first message of the log
    channel: str
    values: tuple[float, ...]


def plays(log: InputLog) -> list[Play]:
    """Return a log's messages in the order of their log times."""
    first = min(series.log_times[0] for series in log.series.values() if series.log_times)
    merged = [
        Play((log_ns - first) * 1e-9, channel, values)
        for channel, series in log.series.items()
        for log_ns, values in zip(series.log_times, series.values)
    ]
    return sorted(merged, key=lambda play: play.time)


class Stop:
    """Whether a signal has asked for the end."""

    def __init__(self):
        self.wanted = False

    def __call__(self, *_) -> None:
        self.wanted = True


@contextmanager
def stop_on_signals() -> Iterator[Stop]:
    """Turn SIGINT and SIGTERM into a wish; rclpy's own handlers would take the context away in the middle of a message."""
    stop = Stop()
    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class Player:
    """Publishes plays through a node.

    Parameters
    ----------
    node : the node whose names and remappings count.
    stop : tells when to end early.
    channels : the channels that will be published.
    scalar : publish shaft speed and radial load as Float64.
    """

    def __init__(self, node: Node, stop: Stop, channels, scalar: bool = False):
        self._node, self._stop = node, stop
        self.sent: Counter[str] = Counter()
        self.lateness = 0.0  # [s] summed over all messages
        self.reached = 0.0  # [s] time in the log
        self._types = {
            channel: _SCALAR if scalar and _SCALAR in topics.input_types(channel) else topics.INPUTS[channel].ros_type for channel in channels
        }
        # Offered reliable, so that any subscriber matches.
        qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
        self._publishers = {channel: node.create_publisher(message_class(kind), channel, qos) for channel, kind in self._types.items()}

    def unheard(self, channels=REQUIRED) -> list[str]:
        """Return those of the channels that nobody listens to."""
        return [channel for channel in channels if self._publishers[channel].get_subscription_count() == 0]

    def wait_until_heard(self, limit: float) -> bool:
        """Wait for a subscriber of every required channel; False when ``limit`` [s] passed or a signal came."""
        if not self._wait(REQUIRED, limit):
            return False
        self._wait(self._publishers, _COURTESY)
        return not self._stop.wanted

    def _wait(self, channels, limit: float) -> bool:
        deadline = time.monotonic() + limit
        while self.unheard(channels):
            if time.monotonic() > deadline or self._stop.wanted:
                return False
            time.sleep(_SLICE)
        return True

    def play(self, plays: list[Play], rate: float, progress) -> bool:
        """Publish all, ``rate`` times as fast as recorded; ``progress(time)`` is called as time goes.  False after a signal."""
        start_ns, start = self._node.get_clock().now().nanoseconds, time.monotonic()
        for play in plays:
            due = start + play.time / rate
            while (rest := due - time.monotonic()) > 0.0:
                progress(play.time - rest * rate)
                if self._stop.wanted:
                    return False
                time.sleep(min(rest, _SLICE))
            if self._stop.wanted:
                return False
            self.lateness += max(0.0, time.monotonic() - due)
            self.reached = play.time
            self._publish(play, start_ns + round(play.time / rate * 1e9))
        progress(plays[-1].time)
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=1))
        time.sleep(_DELIVERY)
        return True

    def _publish(self, play: Play, stamp_ns: int) -> None:
        kind = self._types[play.channel]
        if kind == _SCALAR:
            fields = {"data": float(play.values[0])}
        else:
            fields = topics.INPUTS[play.channel].message(stamp_ns, _inputs(play))
        self._publishers[play.channel].publish(message(kind, fields))
        self.sent[play.channel] += 1


def _inputs(play: Play) -> Inputs:
    """Return inputs that hold the play's values; the message of its channel reads no others."""
    values = (*play.values, 0.0)
    return Inputs(shaft_speed=values[0], load_y=values[0], load_z=values[1], oil_temperature=values[0])


class Progress:
    """Progress on stderr: a bar on a terminal, else a line every tenth."""

    def __init__(self, title: str, total: float):
        self._title, self._total, self._next = title, total, 0.1
        self._bar = None
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import Progress as Bar

            self._bar = Bar(console=Console(stderr=True))
            self._task = self._bar.add_task(title, total=total)
            self._bar.start()

    def __call__(self, time: float) -> None:
        if self._bar is not None:
            self._bar.update(self._task, completed=time)
        elif self._total > 0 and time / self._total >= self._next - 1e-9:
            print(f"{self._title}: {100 * time / self._total:.0f} % ({time:.1f} of {self._total:.1f} s)", file=sys.stderr, flush=True)
            self._next = int(10 * time / self._total) / 10 + 0.1

    def close(self) -> None:
        """Leave the last state standing."""
        if self._bar is not None:
            self._bar.stop()


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("log", type=click.Path(path_type=Path))
@click.option("--rate", type=click.FloatRange(1e-3, 1e3), default=1.0, show_default=True, help="How many times as fast as recorded.")
@click.option("--wait-for-subscribers/--no-wait", default=True, show_default=True, help="Start when somebody listens to speed and load.")
@click.option("--wait-limit", type=click.FloatRange(0.0), default=60.0, show_default=True, help="Give up waiting after so many seconds.")
@click.option("--input-type", type=click.Choice(["stamped", "scalar"]), default="stamped", show_default=True, help="As the node's parameter.")
@click.option("--joint", default=topics.SHAFT_JOINT, show_default=True, help="Name of the shaft's joint in the log.")
@click.pass_context
def command(context, log, rate, wait_for_subscribers, wait_limit, input_type, joint):
    """Publish the shaft speed, radial load and oil temperature of the MCAP recording LOG, with its timing.

    ROS arguments (remappings, namespace) follow --ros-args.
    """
    try:
        recording = read_input_log(log, joint=joint)
    except InputLogError as fault:
        click.echo(f"bearing_player: {fault}", err=True)
        context.exit(2)
    if recording.unfinished:
        click.echo(f"bearing_player: {recording.unfinished}", err=True)
    messages = plays(recording)
    node = rclpy.create_node("bearing_player", start_parameter_services=False)
    stop: Stop = context.obj
    player = Player(node, stop, recording.series, input_type == "scalar")
    try:
        if wait_for_subscribers and not player.wait_until_heard(wait_limit):
            if not stop.wanted:
                click.echo(f"bearing_player: nobody listens to {', '.join(player.unheard())} after {wait_limit:g} s", err=True)
            context.exit(130 if stop.wanted else 1)
        progress = Progress(f"playing {log.name}", messages[-1].time)
        try:
            complete = player.play(messages, rate, progress)
        finally:
            progress.close()
        counts = ", ".join(f"{count} {channel}" for channel, count in player.sent.items())
        late = 1e3 * player.lateness / max(1, player.sent.total())
        ending = "played" if complete else "stopped by a signal after"
        click.echo(f"{ending} {player.reached:.1f} s of log at rate {rate:g}: {counts}; {late:.2f} ms late on average")
        context.exit(0 if complete else 130)
    finally:
        node.destroy_node()


def main(args: list[str] | None = None) -> int:
    """Run the player.

    Returns
    -------
    0 when all was published, 1 when nobody listened, 2 when the log cannot be used, 130 after a signal.
    """
    argv = sys.argv if args is None else ["bearing_player", *args]
    own = remove_ros_args(argv)[1:]
    if {"-h", "--help"} & set(own):
        return command.main(own, prog_name="bearing_player", standalone_mode=False) or 0
    try:
        rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as fault:
        click.echo(f"bearing_player: cannot start ROS: {' '.join(str(fault).split())}", err=True)
        return 2
    try:
        with stop_on_signals() as stop:
            return command.main(own, prog_name="bearing_player", standalone_mode=False, obj=stop) or 0
    except click.ClickException as fault:
        fault.show()
        return fault.exit_code
    finally:
        rclpy.shutdown()


if __name__ == "__main__":
    sys.exit(main())
