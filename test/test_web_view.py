# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The view in a browser: served on 127.0.0.1 only, complete without the internet, the same picture live and of a recording."""

import http.client
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import quote

import chromium
import numpy as np
import pytest
from synthetic_run import synthetic_block

from bearing_sim.scene.loader import load_scene
from bearing_sim.view.sink import RerunSink
from bearing_sim.view.viewer import HOST, free_port
from bearing_sim.view.web import NoWebViewer, WebViewer
from bearing_sim.view.worker import RerunFile

SCENE = load_scene("deng2017_table1")
PATIENCE = 240.0  # [s]: rendering without a graphics card on a busy machine
SHAFT, WARNING = (86, 180, 233), (240, 228, 66)  # colours of Okabe and Ito: blue of the shaft, yellow of thresholds and load
LEAST = 15  # pixels of a colour
needs_chromium = pytest.mark.skipif(chromium.program() is None, reason="no Chromium is installed (apt-get install chromium)")


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("web") / "run.rrd"
    with RerunFile(SCENE, path, 1_700_000_000_000_000_000, 0.3) as view:
        view.write(synthetic_block(SCENE, 0.005 * np.arange(1, 61)))
    return path


def answer(port, path, host=None):
    connection = http.client.HTTPConnection(HOST, port, timeout=60)
    connection.request("GET", path, headers={"Host": host or f"{HOST}:{port}"})
    found = connection.getresponse()
    content = found.read()
    connection.close()
    return found, content


def addresses(port):
    """Return the addresses on which a port listens, IPv4 and IPv6 as the kernel writes them."""
    lines = [line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]]
    return {line[1].split(":")[0] for line in lines if int(line[1].split(":")[1], 16) == port and line[3] == "0A"}


LOOPBACK = {"0100007F"}  # 127.0.0.1


def test_the_viewer_is_served_on_loopback_and_nothing_else_is(recording):
    with WebViewer(0, recording=recording) as viewer:
        port = int(viewer.url.rpartition(":")[2])
        assert addresses(port) == LOOPBACK
        found, _ = answer(port, "/")
        assert found.status == 302 and "recording.rrd" in found.headers["Location"]
        found, page = answer(port, found.headers["Location"])
        assert found.status == 200 and b"re_viewer" in page
        assert re.findall(rb"""(?:src|href)=["']?(https?:[^"' >]*)""", page.partition(b"<body>")[0]) == []
        policy = dict(part.strip().split(" ", 1) for part in found.headers["Content-Security-Policy"].split(";"))
        sources = {word for words in policy.values() for word in words.split() if ":" in word} - {"blob:", "data:"}
        assert sources == {"http://127.0.0.1:*", "ws://127.0.0.1:*"} and policy["default-src"].startswith("'self'")
        assert answer(port, "/recording.rrd")[1] == recording.read_bytes()
        for path in ("/../../etc/passwd", "/etc/passwd", "/run.rrd", "//", "/re_viewer.js/.."):
            assert answer(port, path)[0].status in (302, 404), path
        assert answer(port, "/recording.rrd", host="elsewhere.example")[0].status == 403
        with pytest.raises(NoWebViewer, match=f"port {port} on 127.0.0.1 cannot be used"):
            WebViewer(port, recording=recording)
    with pytest.raises(ConnectionRefusedError):
        answer(port, "/")


def drawn(page):
    """Wait until a page has enough pixels of each colour, that is, until curves and pictures are drawn; return how many it has."""
    deadline = time.monotonic() + PATIENCE
    while True:
        pixels = page.picture().reshape(-1, 3).astype(int)
        counts = [int((np.abs(pixels - colour).max(axis=1) < 16).sum()) for colour in (SHAFT, WARNING)]
        if min(counts) >= LEAST or time.monotonic() > deadline:
            return counts
        time.sleep(3.0)  # each picture costs one


def hosts(addresses):
    """Return where addresses lead, without their paths."""
    return {address.partition("://")[2].partition("/")[0] for address in addresses}


@pytest.fixture
def live():
    """Yield the ports of a live view, for browsers and of its stream."""
    web, stream = free_port(), free_port()
    with RerunSink(SCENE, serve_port=stream, web_port=web) as sink:
        assert sink.wait_until_ready(PATIENCE) and sink.no_browsers is None and sink.failure is None
        assert addresses(web) == addresses(stream) == LOOPBACK
        for block in np.array_split(synthetic_block(SCENE, 0.005 * np.arange(1, 401)), 20):
            sink.write(block)
            time.sleep(0.02)
        yield web, stream


@pytest.mark.long
@needs_chromium
def test_a_browser_fetches_a_recording_and_a_live_stream_and_asks_for_nothing_that_is_not_on_this_machine(recording, live):
    web, stream = live
    with chromium.Chromium() as page, WebViewer(0, recording=recording) as viewer:
        location = answer(web, "/")[0].headers["Location"]
        page.open(f"{viewer.url}/{location.lstrip('/')}&url={quote(viewer.url + '/recording.rrd', safe='')}")
        own, theirs = viewer.url.partition("://")[2], f"{HOST}:{stream}"
        page.wait(lambda: theirs in hosts(page.requests) and f"{viewer.url}/recording.rrd" in page.requests, "the viewer does not begin")
        assert hosts(page.requests) == {own, theirs}, page.problems


@needs_chromium
@pytest.mark.skipif("BEARING_SIM_PICTURES" not in os.environ, reason="BEARING_SIM_PICTURES=1 draws in software, which takes a minute of a core")
def test_a_browser_draws_a_recording_and_a_live_run(recording, live, tmp_path):
    with chromium.Chromium() as page, WebViewer(0, recording=recording) as viewer:
        for name, url in (("recording", viewer.url), ("live", f"http://{HOST}:{live[0]}")):
            page.open(url)
            counts = drawn(page)
            (tmp_path / f"{name}.png").write_bytes(page.png)
            assert min(counts) >= LEAST, (name, counts, page.problems)


@pytest.mark.long
def test_the_command_serves_until_it_is_interrupted(tmp_path):
    from recordings import steady_log

    path, port = steady_log(tmp_path / "log.mcap", duration=0.2), free_port()
    command = [
        sys.executable,
        "-m",
        "bearing_sim.cli",
        "view",
        str(path),
        "-o",
        str(tmp_path / "run.rrd"),
        "--web",
        "--web-port",
        str(port),
        "--no-open",
    ]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        assert f"http://127.0.0.1:{port}" in line and addresses(port) == LOOPBACK
        assert answer(port, "/recording.rrd")[1] == (tmp_path / "run.rrd").read_bytes()
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
