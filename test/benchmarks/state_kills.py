# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How much of a bearing's stored state a kill or a loss of power takes: ``python test/benchmarks/state_kills.py``.

Real nodes with a state file get constant inputs over DDS on the loopback interface; each is killed (SIGKILL) at a random moment, in its start
or while it runs, and started again.  After each kill the state file is read as a restart reads it.

How to read it: **restored** is the life used that a restart continues from. It must lie between what the killed process published 10 s before
its end, or began with if it did not live that long, and the last that it published. **lost** is how long before the end the restored life was
published; **damage lost** is the life that is missing, as the time in which the bearing uses it: less where the machine was too busy to
simulate. The sum over all lives must not be above what they published, and that not above the damage of an uninterrupted run of the same bearing
over the same time, from the first input that was sent to the last output that was heard. After each kill a loss of power is played on copies of
the files: cut short, overwritten, missing, or an older one in place of the newest; the older state must be found, and said. Exit code 1
otherwise.
"""

import random
import shutil
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import click  # noqa: E402
import numpy as np  # noqa: E402
import rclpy  # noqa: E402
from rclpy.qos import qos_profile_sensor_data  # noqa: E402
from ros_bench import NodeProcess, fresh_domain  # noqa: E402
from std_msgs.msg import Float64  # noqa: E402

from bearing_sim.cli.options import json_option  # noqa: E402
from bearing_sim.cli.reporting import FailedRun, print_json, print_table  # noqa: E402
from bearing_sim.ros.shared_memory import remove_unfinished_ports  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402
from bearing_sim.simulation import Inputs, Simulation  # noqa: E402
from bearing_sim.watchers.stored_state.state_file import previous_path, read_state  # noqa: E402

PROMISE = 10.0  # [s] of damage that a kill may take
_LONGEST_LIFE = 14.0  # [s] after the first output
_KILLED_EARLY = 0.1  # fraction of lives that end before the first output
_LONGEST_START = 3.0  # [s] of those
_PATIENCE = 120.0  # [s] for a node to begin on a busy machine
_IN_FLIGHT = 0.3  # [s] for what was published before a kill to arrive
_RATE = 50.0  # [Hz] of inputs
_INPUTS = Inputs(shaft_speed=1000.0, load_y=800.0, load_z=0.0, oil_temperature=393.15)
_SETTINGS = {"scene": "deng2017_table1", "overrides": "['level=steady']", "governor": "false", "input_type": "scalar", "maximum_lag": "10.0"}
_LIFETIME = 3600  # [s] after which a node that is left over ends
_READY = "ready: listening"  # in the node's log
FAULTS = ("cut short", "overwritten", "missing", "older")
"""What a loss of power does to a file."""


class Kill(NamedTuple):
    """The result of one kill.

    Attributes
    ----------
    lived : from the first input sent to the last output heard [s]; 0 without an output.
    begun_with, earlier, restored, last : life used: that the process began with, published `PROMISE` before its end, restored, last published.
    lost : how long before the end the restored life was published [s].
    fault : which loss of power was played afterwards; ``""`` while there was no state before the newest.
    is_said : whether the older state was found then, and said.
    """

    lived: float
    begun_with: float
    earlier: float
    restored: float
    last: float
    lost: float
    fault: str
    is_said: bool

    @property
    def is_good(self) -> bool:
        """Whether the restored life lies where it must."""
        return self.earlier <= self.restored <= self.last


@dataclass
class Chain:
    """The lives of one bearing, one after the other."""

    number: int
    path: Path
    process: NodeProcess | None = None
    heard: list[tuple[float, float]] = field(default_factory=list)  # time and life used, of this life
    first_sent: float = 0.0
    spawned: float = 0.0
    kill_at: float | None = None
    begun_with: float = 0.0
    kills: list[Kill] = field(default_factory=list)

    @property
    def is_ready(self) -> bool:
        """Whether the node listens: the subscriptions of the one before look matched for some time after its end."""
        return bool(self.first_sent) or _READY in self.process.text


class Driver:
    """Sends inputs to the nodes of all chains and hears the life that they publish."""

    def __init__(self, domain: int, chains: list[Chain]):
        remove_unfinished_ports()
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = rclpy.create_node("state_kills", context=self._context, enable_rosout=False)
        self._chains = chains
        self._publishers = [
            [(self._node.create_publisher(Float64, f"/n{chain.number}/{name}", qos_profile_sensor_data), value) for name, value in _VALUES]
            for chain in chains
        ]
        self._ears = [self._node.create_subscription(Float64, f"/n{chain.number}/damage", lambda _: None, 200) for chain in chains]
        self._due = time.monotonic()

    def step(self) -> None:
        """Send inputs if they are due, and take what has come."""
        now = time.monotonic()
        if now >= self._due:
            self._due = max(self._due + 1.0 / _RATE, now)
            for chain, publishers in zip(self._chains, self._publishers):
                if chain.process is not None and chain.is_ready:
                    chain.first_sent = chain.first_sent or now
                    for publisher, value in publishers:
                        publisher.publish(Float64(data=value))
        for chain, ear in zip(self._chains, self._ears):
            with ear.handle:
                while (taken := ear.handle.take_message(ear.msg_type, False)) is not None:
                    chain.heard.append((time.monotonic(), taken[0].data))
        time.sleep(0.002)

    def close(self) -> None:
        """Leave the domain."""
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)


_VALUES = (("shaft_speed", _INPUTS.shaft_speed), ("radial_load", _INPUTS.load_y))


def kill_nodes(folder: Path, kills: int, at_once: int, seed: int, progress=lambda text: None, longest: float = _LONGEST_LIFE) -> list[Kill]:
    """Kill nodes at random moments and read what their state files restore.

    Parameters
    ----------
    folder : for the states.
    kills : number of kills, over all bearings.
    at_once : bearings, each with a node of its own, under way at the same time.
    seed : of moments and faults.
    progress : called with a text after each kill.
    longest : life of a node after its first output [s].
    """
    chance, domain = random.Random(seed), fresh_domain()
    chains = [Chain(number, folder / f"bearing_{number}.json") for number in range(at_once)]
    driver, done, started = Driver(domain, chains), 0, 0
    try:
        while done < kills:
            for chain in chains:
                if chain.process is None and started < kills:
                    _start(chain, folder, domain, chance)
                    started += 1
                elif chain.process is not None and _is_due(chain, chance, longest):
                    chain.kills.append(_kill(chain, driver, chance))
                    done += 1
                    last = chain.kills[-1]
                    progress(f"{done} of {kills}: lived {last.lived:.2f} s, lost {last.lost:.2f} s, {'good' if last.is_good else 'BAD'}")
            driver.step()
    finally:
        for chain in chains:
            if chain.process is not None:
                chain.process.end(9)
        driver.close()
    return [kill for chain in chains for kill in chain.kills]


def _start(chain: Chain, folder: Path, domain: int, chance: random.Random) -> None:
    chain.begun_with = _restored(chain.path)
    chain.heard, chain.first_sent, chain.kill_at = [], 0.0, None
    given = [f"{name}:={value}" for name, value in {**_SETTINGS, "serial": f"S{chain.number}", "state_file": chain.path}.items()]
    arguments = ["--ros-args", "-r", f"__ns:=/n{chain.number}", *(word for each in given for word in ("-p", each))]
    chain.spawned = time.monotonic()
    chain.process = NodeProcess(folder, domain, *arguments, limit=_LIFETIME)
    if chance.random() < _KILLED_EARLY:
        chain.kill_at = chain.spawned + chance.uniform(0.0, _LONGEST_START)


def _is_due(chain: Chain, chance: random.Random, longest: float) -> bool:
    now = time.monotonic()
    if chain.process.process.poll() is not None:
        raise RuntimeError(f"a node ended by itself: {chain.process.text}")
    if chain.kill_at is None:
        if chain.heard:
            chain.kill_at = chain.heard[0][0] + chance.uniform(0.0, longest)
        elif now - chain.spawned > _PATIENCE:
            raise RuntimeError(f"a node did not begin within {_PATIENCE:g} s: {chain.process.text}")
        return False
    return now >= chain.kill_at


def _kill(chain: Chain, driver: Driver, chance: random.Random) -> Kill:
    chain.process.end(9)
    ended = time.monotonic()
    chain.process = None
    while time.monotonic() < ended + _IN_FLIGHT:
        driver.step()
    restored = _restored(chain.path)
    last = max((life for _, life in chain.heard), default=chain.begun_with)
    earlier = max((life for when, life in chain.heard if when <= ended - PROMISE), default=chain.begun_with)
    lived = chain.heard[-1][0] - chain.first_sent if chain.heard else 0.0
    later = [when for when, life in chain.heard if life >= restored]
    lost = ended - later[0] if later else 0.0
    fault, is_said = _power_loss(chain.path, chance)
    return Kill(lived, chain.begun_with, earlier, restored, last, lost, fault, is_said)


def _restored(path: Path) -> float:
    with suppress(FileNotFoundError):
        return read_state(path)[0].totals.damage
    return 0.0


def _power_loss(path: Path, chance: random.Random) -> tuple[str, bool]:
    """Play a loss of power on copies of the files; return the fault, and whether the older state was found and said."""
    if not path.exists() or not previous_path(path).exists():
        return "", True
    newest, before = read_state(path)[0], read_state(previous_path(path))[0]
    fault = chance.choice(FAULTS)
    if fault == FAULTS[-1] and before.writes == newest.writes:  # killed between keeping the last state and putting the next in its place
        return "", True
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        for each in (path, previous_path(path), path.with_name(f"{path.name}.lock")):
            shutil.copy(each, copy.with_name(each.name))
        data = bytearray(copy.read_bytes())
        if fault == "cut short":
            copy.write_bytes(data[: chance.randrange(len(data) - 1)])
        elif fault == "overwritten":
            data[chance.randrange(len(data) - 1)] ^= 1 << chance.randrange(7)
            copy.write_bytes(data)
        elif fault == "missing":
            copy.unlink()
        else:
            shutil.copy(previous_path(copy), copy)
        found, news = read_state(copy)
        is_said = any(each.kind == "state.restored" for each in news)
        return fault, is_said and found.writes == before.writes


@click.command()
@click.option("--kills", type=click.IntRange(min=1), default=200, show_default=True, metavar="N", help="Number of kills.")
@click.option("--at-once", type=click.IntRange(1, 20), default=4, show_default=True, metavar="N", help="Nodes under way at the same time.")
@click.option("--seed", type=int, default=1, show_default=True, help="Seed of moments and faults.")
@json_option
def command(kills, at_once, seed, as_json):
    """Kill nodes with a stored state at random moments (SIGKILL), and report what each restart continues from."""
    with tempfile.TemporaryDirectory() as folder:
        done = kill_nodes(Path(folder), kills, at_once, seed, lambda text: click.echo(text, err=True))
        totals = [_restored(path) for path in sorted(Path(folder).glob("bearing_*.json"))]
        largest = max(path.stat().st_size for path in Path(folder).glob("bearing_*.json*"))
    lost, lived = np.array([kill.lost for kill in done]), sum(kill.lived for kill in done)
    simulation = Simulation(load_scene(_SETTINGS["scene"], ["level=steady"]), _INPUTS)
    rate = float(simulation.advance(1.0)["damage"][-1])  # [1/s]
    uninterrupted, taken = lived * rate, np.array([kill.last - kill.restored for kill in done]) / rate
    published = sum(kill.last - kill.begun_with for kill in done)
    faults = {fault: [kill.is_said for kill in done if kill.fault == fault] for fault in FAULTS}
    report = {
        "kills": len(done),
        "seed": seed,
        "good": sum(kill.is_good for kill in done),
        "killed_before_an_output": sum(not kill.lived for kill in done),
        "lost_median": float(np.median(lost)),
        "lost_most": float(lost.max()),
        "damage_lost_most": float(taken.max()),
        "lived": lived,
        "restored_in_total": sum(totals),
        "published_in_total": published,
        "uninterrupted": uninterrupted,
        "older_state_said": {fault: f"{sum(said)} of {len(said)}" for fault, said in faults.items()},
        "largest_file": largest,
    }
    if as_json:
        print_json({**report, "each": [kill._asdict() for kill in done]})
    else:
        rows = [
            ("restored between 10 s earlier and the last published", f"{report['good']} of {len(done)}"),
            ("killed before their first output", str(report["killed_before_an_output"])),
            ("lost by a kill", f"median {np.median(lost):.2f} s, most {lost.max():.2f} s"),
            ("damage lost by a kill, as running time", f"median {np.median(taken):.2f} s, most {taken.max():.2f} s"),
            ("restored in total", f"{sum(totals):.6e}, published {published:.6e}, an uninterrupted run of {lived:.0f} s {uninterrupted:.6e}"),
            ("loss of power: older state found and said", ", ".join(f"{fault} {said}" for fault, said in report["older_state_said"].items())),
            ("largest state file", f"{largest} bytes"),
        ]
        print_table(f"stored states of {at_once} nodes at level steady, killed (seed {seed})", rows)
    if report["good"] < len(done) or not sum(totals) <= published <= uninterrupted or not all(kill.is_said for kill in done):
        raise FailedRun("a kill took more than 10 s of damage or counted some twice, or an older state was not said")


if __name__ == "__main__":
    command()
