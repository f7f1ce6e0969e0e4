# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What writing a recording costs: all topics of one bearing at 1 kHz, by our writer and by others, as a share of one core.

All write the same messages, in chunks of 64 KiB compressed with zstd; the writers take turns, several times over, and processor time is
counted.  `mcap` writes message by message from Python, `foxglove-sdk` (if it is installed) from Rust.
"""

import statistics
import tempfile
import time
from pathlib import Path

import click
import numpy as np

from bearing_sim.messages.cdr import load_message_types, message_type
from bearing_sim.messages.sample_messages import SampleMessages, message_templates
from bearing_sim.messages.topics import recorded
from bearing_sim.model.sample import flat, new_block
from bearing_sim.recording.bag import QOS_TEXT
from bearing_sim.recording.writer import McapFile, SampleRows
from bearing_sim.scene.loader import load_scene

RATE, BLOCK, CHUNK = 1000, 20, 64 * 1024
START = 1_700_000_000_000_000_000


def our_rows(path: Path, topics, rollers: int, blocks) -> None:
    """Write blocks of samples as rows."""
    layout = SampleRows(topics, rollers)
    with McapFile(path) as file:
        for block, times_ns in blocks:
            file.write_rows(layout, block, times_ns)


def plain_mcap(path: Path, topics, rollers: int, blocks) -> None:
    """Write message by message with the `mcap` library."""
    from mcap.writer import CompressionType, Writer

    messages = SampleMessages(message_templates(topics, rollers))
    with open(path, "wb") as stream:
        writer = Writer(stream, chunk_size=CHUNK, compression=CompressionType.ZSTD)
        writer.start(profile="ros2", library="bearing_sim")
        channels = []
        for topic in topics:
            kind = message_type(topic.ros_type)
            schema = writer.register_schema(topic.ros_type, "ros2msg", kind.definition.encode())
            channels.append(writer.register_channel(f"/{topic.name}", "cdr", schema, {"offered_qos_profiles": QOS_TEXT}))
        for block, times_ns in blocks:
            for sample, time_ns in zip(block, times_ns.tolist()):
                messages.fill(time_ns, sample)
                for channel, part in zip(channels, messages.parts):
                    writer.add_message(channel, time_ns, bytes(part), time_ns)
        writer.finish()


def foxglove_sdk(path: Path, topics, rollers: int, blocks) -> None:
    """Write message by message with the Rust writer of `foxglove-sdk`."""
    import foxglove
    from foxglove.mcap import MCAPCompression, MCAPWriteOptions

    messages, context = SampleMessages(message_templates(topics, rollers)), foxglove.Context()
    options = MCAPWriteOptions(profile="ros2", chunk_size=CHUNK, compression=MCAPCompression.Zstd, compression_threads=0)
    channels = [
        foxglove.Channel(
            f"/{topic.name}",
            schema=foxglove.Schema(name=topic.ros_type, encoding="ros2msg", data=message_type(topic.ros_type).definition.encode()),
            message_encoding="cdr",
            context=context,
            metadata={"offered_qos_profiles": QOS_TEXT},
        )
        for topic in topics
    ]
    with foxglove.open_mcap(str(path), context=context, writer_options=options):
        for block, times_ns in blocks:
            for sample, time_ns in zip(block, times_ns.tolist()):
                messages.fill(time_ns, sample)
                for channel, part in zip(channels, messages.parts):
                    channel.log(bytes(part), log_time=time_ns)


WRITERS = {"bearing_sim": our_rows, "foxglove-sdk": foxglove_sdk, "mcap": plain_mcap}


@click.command()
@click.option("--seconds", type=click.IntRange(min=1), default=10, show_default=True, metavar="N", help="Simulated time of each recording.")
@click.option("--turns", type=click.IntRange(min=1), default=5, show_default=True, metavar="N", help="How often each writer writes.")
def command(seconds, turns):
    """Compare writers of recordings: processor time as a share of one core, and size."""
    scene = load_scene("deng2017_table1", ["level=spatial"])
    topics, rollers = tuple(recorded(scene).values()), scene.bearing.roller.count
    samples = new_block(seconds * RATE, rollers)
    flat(samples)[:] = np.random.default_rng(1).normal(1.0, 1e-4, flat(samples).shape)
    times_ns = np.uint64(START) + np.arange(len(samples), dtype=np.uint64) * np.uint64(10**9 // RATE)
    blocks = [(samples[k : k + BLOCK], times_ns[k : k + BLOCK]) for k in range(0, len(samples), BLOCK)]
    load_message_types()
    shares, sizes = {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(turns):
            for name, write in WRITERS.items():
                path, began = Path(folder) / f"{name}_{turn}.mcap", time.process_time()
                try:
                    write(path, topics, rollers, blocks)
                except ImportError:
                    continue
                shares.setdefault(name, []).append((time.process_time() - began) / seconds)
                sizes[name] = path.stat().st_size / seconds
                path.unlink()
    click.echo(f"{len(topics)} topics at {RATE} Hz, {turns} turns of {seconds} s")
    for name, found in shares.items():
        spread = f"{100 * min(found):.2f} to {100 * max(found):.2f}"
        click.echo(f"{name:14} {100 * statistics.median(found):6.2f} % of a core (median; {spread}), {sizes[name] / 1e6:.2f} MB/s")


if __name__ == "__main__":
    command()
