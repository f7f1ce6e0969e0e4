# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether damage of a recording is seen: ``python test/benchmarks/damaged_recordings.py``.

Three recordings are damaged at random: a run, what a node records (received inputs with their stamps, events and diagnostics), and its replay.
A damage is one flipped bit, a cut, a cut with a flipped bit before it, or up to 4096 bytes overwritten by random ones.  Each damaged file goes
through ``info``, through the reader of recordings, and through ``recover``.

How to read it: a case is "reported" if ``info`` exits with 1 and names the damage, or refuses the file.  It is "harmless" if ``info`` calls the file
whole and all of it is as it was: every message, metadata record, schema and channel.  It is "silent" if any of this holds, and none may: ``info``
calls a file whole that differs; the reader yields samples or a scene that differ from those of the whole recording, or fewer, and says nothing;
a recovered file has a message that the whole recording has not, another order, or another scene.  "recovered" files have everything again, those
recovered "in part" have some of it, and of the last nothing could be saved.  Recovered files are also read by the mcap library, all checksums on.
Exit code 1 if any case is silent.
"""

import json
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np
from click.testing import CliRunner
from mcap.reader import NonSeekingReader
from mcap.records import Attachment, Channel, Metadata, Schema

from bearing_sim.cli.main import main
from bearing_sim.cli.options import json_option
from bearing_sim.cli.reporting import FailedRun, print_json, print_rows
from bearing_sim.messages.events import Event, Level, ReceivedInputs, Report, Start
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation

SCENE = "deng2017_table1"
_LEVEL = ["level=slip"]
_START = 1_700_000_000_000_000_000  # ns
_LONGEST_OVERWRITTEN = 4096  # [byte]
_BAG = "rosbag2"  # its metadata record counts messages, and is written anew by `recover`


class Damage(NamedTuple):
    """A kind of damage, and how it is done.

    Attributes
    ----------
    name : of the kind.
    apply : returns the damaged bytes of a file.
    share : of all cases.
    """

    name: str
    apply: Callable[[bytes, random.Random], bytes]
    share: float


class Whole(NamedTuple):
    """What a recording holds before it is damaged.

    Attributes
    ----------
    name : of the recording.
    data : the bytes of the file.
    records : all its records but messages, as comparable tuples.
    messages : (topic, sequence, log time, publish time, data) of each, in order.
    scene : as YAML in the metadata.
    samples : times and loads of the samples, as bytes.
    """

    name: str
    data: bytes
    records: list
    messages: list
    scene: str
    samples: bytes


def flipped(data: bytes, chance: random.Random) -> bytes:
    """Return a file with one bit flipped."""
    damaged, bit = bytearray(data), chance.randrange(8 * len(data))
    damaged[bit // 8] ^= 1 << bit % 8
    return bytes(damaged)


def cut(data: bytes, chance: random.Random) -> bytes:
    """Return a beginning of a file."""
    return data[: chance.randrange(len(data))]


def cut_and_flipped(data: bytes, chance: random.Random) -> bytes:
    """Return a beginning of a file with one bit flipped."""
    return flipped(data[: 1 + chance.randrange(len(data) - 1)], chance)


def overwritten(data: bytes, chance: random.Random) -> bytes:
    """Return a file with some bytes that were replaced by others."""
    begin, length = chance.randrange(len(data)), chance.randint(1, _LONGEST_OVERWRITTEN)
    end = min(begin + length, len(data))
    return data[:begin] + chance.randbytes(end - begin) + data[end:]


DAMAGES = (
    Damage("one bit flipped", flipped, 0.6),
    Damage("cut", cut, 0.2),
    Damage("cut, and one bit flipped", cut_and_flipped, 0.1),
    Damage("up to 4096 bytes overwritten", overwritten, 0.1),
)


def recordings(folder: Path, duration: float) -> list[Path]:
    """Make a recording of a run, one as a node makes it, and a replay of that."""
    run, node, replayed = (folder / f"{name}.mcap" for name in ("run", "node", "replayed"))
    _command("run", SCENE, "--level", "slip", "--duration", duration, "--out", run)
    _as_node(node, duration)
    _command("replay", node, "--from-recording", "-o", replayed)
    return [run, node, replayed]


def _command(*words) -> None:
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        done = CliRunner().invoke(main, [str(word) for word in words])
    if done.exit_code:
        raise FailedRun(f"bearing-sim {' '.join(map(str, words))} ended with {done.exit_code}: {done.output}")


def _as_node(path: Path, duration: float) -> None:
    """Record as the node does: blocks of 10 samples at 1 kHz, inputs at 100 Hz, events, and a report of all subjects once a second."""
    inputs = Inputs(1500.0, 800.0, -50.0, 393.15)
    run = Simulation(load_scene(SCENE, _LEVEL), inputs)
    with McapSink(path, load_scene(SCENE, _LEVEL), _START) as sink:
        sink.write(Start(np.atleast_1d(run.sample)))
        for k in range(round(duration / 0.01)):
            sink.write(ReceivedInputs(0.01 * k, inputs))
            sink.write(run.advance(0.01, inputs, 10))
            if k % 10 == 5:
                sink.write(Event(0.01 * k, Level.WARN, "slip.high", "slip", f"is {k} %"))
            if k % 100 == 0:
                sink.write(Report(0.01 * k, [Event(0.01 * k, Level.OK, "solver.pace", "pace", "keeps up")], {"pace.lag": 0.001}))


def whole(path: Path) -> Whole:
    """Return what an undamaged recording holds; its messages as the mcap library reads them."""
    with open(path, "rb") as stream:
        messages = [
            (channel.topic, message.sequence, message.log_time, message.publish_time, bytes(message.data))
            for _, channel, message in NonSeekingReader(stream, validate_crcs=True).iter_messages(log_time_order=False)
        ]
    recording = Recording(path)
    samples = np.concatenate([item for item in recording if isinstance(item, np.ndarray)])
    return Whole(path.stem, path.read_bytes(), _others(path), messages, recording.metadata["scene"], samples.tobytes())


def _others(path: Path) -> list:
    """Return all records but messages of a file, comparable."""
    kept = (Schema, Channel, Metadata, Attachment)
    return [record for record in McapReader(path) if isinstance(record, kept)]


def _messages(path: Path) -> list:
    reader, found = McapReader(path), []
    for record in reader:
        if isinstance(record, Message) and record.channel_id in reader.topics:
            found.append((reader.topics[record.channel_id], *record[1:]))
    return found


def outcome(of: Whole, path: Path, recovered: Path) -> tuple[str, str, str]:
    """Return how a damaged file was taken.

    Returns
    -------
    seen : ``reported`` or ``harmless``; ``silent`` if something is wrong and nothing says so.
    saved : ``recovered``, ``in part`` or ``nothing``.
    reason : what is wrong; empty unless it is silent.
    """
    seen, reason = _seen(of, path)
    saved, wrong = _saved(of, path, recovered)
    reason = reason or _wrong_in_reader(of, path) or wrong
    return "silent" if reason else seen, saved, reason


def _seen(of: Whole, path: Path) -> tuple[str, str]:
    try:
        found = contents(path)
    except RecordingError:
        return "reported", ""
    if not found.is_sound:
        return "reported", "" if found.ends or found.damage else "info says that it is damaged, but not where"
    is_same = _others(path) == of.records and _messages(path) == of.messages
    return "harmless", "" if is_same else "info calls a damaged file whole"


def _wrong_in_reader(of: Whole, path: Path) -> str:
    """Return what the reader of recordings yields that is wrong and not said; empty if nothing is."""
    try:
        recording = Recording(path)
        blocks = [item for item in recording if isinstance(item, np.ndarray)]
    except RecordingError:
        return ""
    samples = np.concatenate(blocks).tobytes() if blocks else b""
    if recording.metadata["scene"] != of.scene:
        return "the reader loads another scene"
    if not of.samples.startswith(samples):
        return "the reader yields other samples"
    return "" if len(samples) == len(of.samples) or recording.unfinished else "the reader yields fewer samples and does not say so"


def _saved(of: Whole, path: Path, recovered: Path) -> tuple[str, str]:
    recovered.unlink(missing_ok=True)
    try:
        recover(path, recovered)
    except RecordingError:
        return "nothing", ""
    found = contents(recovered)
    if not found.is_sound or not found.covers_all:
        return "in part", f"the recovered file is not whole: {found.ends} {found.damage}"
    with open(recovered, "rb") as stream:
        messages = [
            (channel.topic, *message_fields)
            for _, channel, message in NonSeekingReader(stream, validate_crcs=True).iter_messages(log_time_order=False)
            for message_fields in [(message.sequence, message.log_time, message.publish_time, bytes(message.data))]
        ]
    remaining = iter(of.messages)
    if not all(message in remaining for message in messages):
        return "in part", "the recovered file has messages that the whole one has not, or in another order"
    metadata = {record.name: record.metadata for record in of.records if isinstance(record, Metadata)}
    if any(found.metadata[name] != metadata.get(name) for name in found.metadata if name != _BAG):
        return "in part", "the recovered file has other metadata"
    is_all = len(messages) == len(of.messages) and set(metadata) == set(found.metadata)
    return ("recovered" if is_all else "in part"), ""


@click.command()
@click.option("--cases", type=click.IntRange(min=1), default=3000, show_default=True, metavar="N", help="Number of damaged files.")
@click.option("--duration", type=float, default=0.2, show_default=True, metavar="S", help="Length of the recordings.")
@click.option("--seed", type=int, default=1, show_default=True, help="Seed of the random damages.")
@json_option
def command(cases, duration, seed, as_json):
    """Damage three recordings at random, and report which damages are seen, harmless, or silent, and what is recovered.

    Exit code 1 if any is silent.
    """
    chance, counts, silent = random.Random(seed), {}, []
    with tempfile.TemporaryDirectory() as folder:
        originals = [whole(path) for path in recordings(Path(folder), duration)]
        damaged, recovered = Path(folder, "damaged.mcap"), Path(folder, "recovered.mcap")
        for number in range(cases):
            of = originals[number % len(originals)]
            damage = chance.choices(DAMAGES, [each.share for each in DAMAGES])[0]
            damaged.write_bytes(damage.apply(of.data, chance))
            try:
                seen, saved, reason = outcome(of, damaged, recovered)
            except Exception as error:  # the answer to a damaged file is never a traceback
                seen, saved, reason = "silent", "nothing", repr(error)
            counted = counts.setdefault((of.name, damage.name), Counter())
            counted.update(["cases", seen, saved])
            if reason:
                silent.append({"case": number, "recording": of.name, "damage": damage.name, "reason": reason})
            if sys.stderr.isatty() and number % 50 == 0:
                click.echo(f"\r{number} of {cases}", err=True, nl=False)
        sizes = {of.name: len(of.data) for of in originals}
    columns = ("cases", "reported", "harmless", "silent", "recovered", "in part", "nothing")
    rows = [(name, kind, *(counted[column] for column in columns)) for (name, kind), counted in sorted(counts.items())]
    rows.append(("all", "all", *(sum(row[2 + k] for row in rows) for k in range(len(columns)))))
    if as_json:
        print_json({"seed": seed, "sizes": sizes, "silent": silent, "rows": [dict(zip(("recording", "damage", *columns), row)) for row in rows]})
    else:
        sized = ", ".join(f"{name} {size / 1e3:.0f} kB" for name, size in sizes.items())
        print_rows(f"damaged recordings ({sized}; seed {seed})", ("recording", "damage", *columns), [tuple(map(str, row)) for row in rows])
    if silent:
        raise FailedRun(f"{len(silent)} damages are silent: {json.dumps(silent[:5])}")


if __name__ == "__main__":
    command()
