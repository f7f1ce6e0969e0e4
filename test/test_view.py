# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim view``: from a recording to a file for rerun, and to a picture where a graphics driver is there."""

import shlex
import shutil
import socket
import struct

import numpy as np
import pytest
from click.testing import CliRunner
from rerun.chunk import RrdReader
from synthetic_run import synthetic_block

from bearing_sim.cli import view
from bearing_sim.messages.events import Event, Level
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.view import screenshot
from bearing_sim.view.blueprint import section_title
from bearing_sim.view.screenshot import HOW_TO_GET_VULKAN, HeadlessViewer, ViewerFailed
from bearing_sim.view.sink import RerunSink

SCENE = load_scene("deng2017_table1")


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("view") / "run.mcap"
    with McapSink(path, SCENE, 1_700_000_000_000_000_000) as sink:
        sink.write(synthetic_block(SCENE, 0.005 * np.arange(1, 61)))
        sink.write(Event(0.2, Level.WARN, "bearing.slip", "cage slip", "6 % has reached 5 %"))
    return path


def run(*arguments):
    return CliRunner().invoke(view.view, [str(argument) for argument in arguments])


def picture_or_skip(*arguments):
    result = run(*arguments)
    if HOW_TO_GET_VULKAN in result.output:
        pytest.skip(f"needs a Vulkan driver: {HOW_TO_GET_VULKAN}")
    assert result.exit_code == 0, result.output
    return result


def test_recording_becomes_a_file_for_rerun_with_its_events(recording, tmp_path):
    result = run(recording, "-o", tmp_path / "run.rrd", "--no-open")
    assert result.exit_code == 0, result.output
    words = shlex.split(result.output.removeprefix("open it with: "))
    assert shutil.which(words[0]) and words[0].endswith("rerun") and words[1:] == ["--bind", "127.0.0.1", "--port", "auto", str(tmp_path / "run.rrd")]
    texts, speeds = [], 0
    for chunk in RrdReader(str(tmp_path / "run.rrd")).stream():
        if chunk.entity_path == "/log":
            texts += [text for (text,) in chunk.to_record_batch().column("TextLog:text").to_pylist()]
        if chunk.entity_path == "/speed/shaft" and not chunk.is_static:
            speeds += chunk.to_record_batch().num_rows
    assert "cage slip: 6 % has reached 5 %  [bearing.slip]" in texts
    assert speeds == 60


def test_file_for_rerun_lies_beside_the_recording_unless_told_otherwise(recording):
    assert run(recording, "--no-open").exit_code == 0
    assert recording.with_suffix(".rrd").is_file()


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--at", "99", "--screenshot", "a.png"], "covers 0.005 to 0.3 s"),
        (["--size", "wide"], "expected WIDTHxHEIGHT"),
    ],
)
def test_senseless_options_are_told_with_exit_code_2(recording, tmp_path, arguments, reason):
    result = run(recording, "-o", tmp_path / "run.rrd", *arguments)
    assert result.exit_code == 2 and reason in result.output


def test_missing_graphics_driver_is_told_with_the_way_to_get_one(recording, tmp_path, monkeypatch):
    viewer = tmp_path / "viewer"
    viewer.write_text("#!/bin/sh\necho 'Failed to get render context: No graphics adapter was found' >&2\nexit 102\n")
    viewer.chmod(0o755)
    monkeypatch.setattr(screenshot, "viewer_program", lambda: viewer)
    result = run(recording, "-o", tmp_path / "run.rrd", "--screenshot", tmp_path / "a.png")
    assert result.exit_code == 1
    assert "mesa-vulkan-drivers" in result.output and not (tmp_path / "a.png").exists()


def test_harder_compressed_picture_has_the_same_pixels():
    from io import BytesIO

    from PIL import Image

    pixels = np.add.outer(np.arange(90), np.arange(120)).astype(np.uint8)
    plain = BytesIO()
    Image.fromarray(pixels).save(plain, "PNG", compress_level=1)
    smaller = screenshot.smaller_png(plain.getvalue())
    assert len(smaller) < len(plain.getvalue())
    assert (np.asarray(Image.open(BytesIO(smaller))) == pixels).all()


def test_picture_has_the_size_asked_for_and_no_view_reports_a_problem(recording, tmp_path):
    # The command itself fails where a view or the viewer complains.
    picture_or_skip(recording, "-o", tmp_path / "run.rrd", "--screenshot", tmp_path / "a.png", "--at", "0.2", "--size", "1000x700")
    content = (tmp_path / "a.png").read_bytes()
    assert content.startswith(b"\x89PNG") and struct.unpack(">II", content[16:24]) == (1000, 700)


@pytest.mark.long
def test_live_view_reaches_a_viewer_that_comes_late():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with RerunSink(SCENE, serve_port=port) as sink:
        assert sink.wait_until_ready()
        for part in np.array_split(synthetic_block(SCENE, 0.005 * np.arange(1, 61)), 20):
            sink.write(part)
        try:
            with HeadlessViewer(f"rerun+http://127.0.0.1:{port}/proxy", size=(1000, 700)) as viewer:
                viewer.seek(0.3)
                assert section_title(SCENE) in viewer.views()
                assert viewer.problems() == []
                assert viewer.span()[1] == pytest.approx(0.3)
        except ViewerFailed as fault:
            if HOW_TO_GET_VULKAN not in str(fault):
                raise
            pytest.skip(f"needs a Vulkan driver: {fault}")
    assert sink.dropped == 0 and sink.failure is None
