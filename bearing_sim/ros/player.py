# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""`bearing_player`: publish the inputs of an MCAP log on the real topics, with the log's timing.

Run by ``bearing_player LOG.mcap`` or ``python -m bearing_sim.ros.player LOG.mcap``; remappings follow ``--ros-args``.
"""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import click
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from bearing_sim import topics
from bearing_sim.input_log import InputLogError, read_input_log
from bearing_sim.ros.playback import Play, Player, Timeline, plays


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


@contextmanager
def served(node: Node) -> Iterator[None]:
    """Answer the node's services on a thread of their own."""
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
@click.option("--rate", type=click.FloatRange(1e-3, 1e3), default=1.0, show_default=True, help="How many times as fast as recorded.")
@click.option(
    "--clock",
    "clock_rate",
    type=click.FloatRange(0.1, 1000.0),
    metavar="HZ",
    help="Show the log's time on /clock so often a second, and keep the log's stamps: for nodes with use_sim_time [default: no clock].",
)
@click.option("--stamps", type=click.Choice(["header", "log"]), default="header", show_default=True, help="With --clock: which stamps, as in replay.")
@click.option("--start-paused", is_flag=True, help="Wait for the service ~/pause (std_srvs/SetBool, data: false).")
@click.option("--loop", is_flag=True, help="Begin again at the end, until a signal comes; with --clock its time jumps back.")
@click.option(
    "--wait-until-used",
    "use_limit",
    type=click.FloatRange(0.0),
    default=0.0,
    metavar="S",
    help="With --clock: stay at the end until followers say that they have used all, so long at most [default: 0].",
)
@click.option("--wait-for-subscribers/--no-wait", default=True, show_default=True, help="Start when somebody listens to speed and load.")
@click.option("--wait-limit", type=click.FloatRange(0.0), default=60.0, show_default=True, help="Give up waiting after so many seconds.")
@click.option("--input-type", type=click.Choice(["stamped", "scalar"]), default="stamped", show_default=True, help="As the node's parameter.")
@click.option("--joint", default=topics.SHAFT_JOINT, show_default=True, help="Name of the shaft's joint, in the log and as it is played.")
@click.option("--cage-joint", default=topics.CAGE_JOINT, show_default=True, help="Name of the cage's joint likewise.")
@click.pass_context
def command(context, log, rate, clock_rate, stamps, start_paused, loop, use_limit, wait_for_subscribers, wait_limit, input_type, joint, cage_joint):
    """Publish the inputs of the MCAP recording LOG with its timing: shaft speed, radial load, oil temperature, measured cage speed.

    ROS arguments (remappings, namespace) follow --ros-args.
    """
    try:
        recording = read_input_log(log, joint=joint, stamps=stamps, cage_joint=cage_joint)
    except InputLogError as fault:
        click.echo(f"bearing_player: {fault}", err=True)
        context.exit(2)
    if recording.unfinished:
        click.echo(f"bearing_player: {recording.unfinished}", err=True)
    messages = plays(recording, by_stamps=clock_rate is not None)
    stop: Stop = context.obj
    node = rclpy.create_node("bearing_player", start_parameter_services=False)
    joints = {"shaft_speed": joint, topics.MEASURED: cage_joint}
    player = Player(node, lambda: stop.wanted, recording.series, Timeline(rate, start_paused), input_type == "scalar", clock_rate, joints)
    try:
        with served(node):
            if wait_for_subscribers and not player.wait_until_heard(wait_limit):
                if not stop.wanted:
                    click.echo(f"bearing_player: nobody listens to {', '.join(player.unheard())} after {wait_limit:g} s", err=True)
                context.exit(130 if stop.wanted else 1)
            complete = _play(player, messages, log.name, use_limit if clock_rate else 0.0)
            while complete and loop:
                complete = _play(player, messages, log.name, use_limit if clock_rate else 0.0)
        counts = ", ".join(f"{count} {channel}" for channel, count in player.sent.items())
        late = 1e3 * player.lateness / max(1, player.sent.total())
        ending = "played" if complete else "stopped by a signal after"
        click.echo(f"{ending} {player.reached:.1f} s of log at rate {rate:g}: {counts}; {late:.2f} ms late on average")
        context.exit(0 if complete else 130)
    finally:
        node.destroy_node()


def _play(player: Player, messages: list[Play], name: str, use_limit: float) -> bool:
    """Play all and let followers of the clock use it, for so long at most [s]; False after a signal."""
    progress = Progress(f"playing {name}", messages[-1].time)
    try:
        complete = player.play(messages, progress)
    finally:
        progress.close()
    if not (complete and use_limit):
        return complete
    if player.wait_until_used(messages, use_limit):
        return True
    if not player.wants_end:
        click.echo(f"bearing_player: no follower of /clock has said within {use_limit:g} s that it has used all", err=True)
    return not player.wants_end


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
