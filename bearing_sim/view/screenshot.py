# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pictures of a rerun recording without a display: rerun's own headless viewer, steered over a local port.

Needs a Vulkan driver; a software one will do.
"""

import io
import os
import subprocess
import tempfile
import time
from pathlib import Path

from PIL import Image

from bearing_sim.recording.priority import give_idle_time
from bearing_sim.view.plots import TIMELINE
from bearing_sim.view.viewer import HOST, free_port, stream_url

HOW_TO_GET_VULKAN = (
    "the viewer found no graphics driver; a software one is enough: on Debian or Ubuntu "
    "`apt-get install -y --no-install-recommends mesa-vulkan-drivers`, on Fedora `dnf install mesa-vulkan-drivers`, on Arch `pacman -S vulkan-swrast`"
)
_HARMLESS_NOTICES = ("oftware rasterizer", "NameHasOwner")  # notices about the machine, not about what is shown
_READY_WITHIN = 240.0  # [s] for the recording to be loaded, on a busy machine


class ViewerFailed(RuntimeError):
    """The headless viewer could not be started, or did not get ready."""


class HeadlessViewer:
    """A viewer without a window, as a context manager.

    Parameters
    ----------
    recording : path of an .rrd file, or the URL of a running server.
    size : width and height of the picture [px].
    in_idle_time : True runs the viewer in idle time once it is ready, so that it takes no processor time from a solver on the same machine; a
        viewer that starts in idle time on a busy machine might never get ready.

    Raises
    ------
    ViewerFailed
        On entry, saying why and what to do.
    """

    def __init__(self, recording: str | Path, size: tuple[int, int] = (1600, 1000), in_idle_time: bool = False):
        self._recording, self._size, self._in_idle_time = str(recording), size, in_idle_time

    def __enter__(self) -> "HeadlessViewer":
        program = viewer_program()
        self._home = tempfile.TemporaryDirectory(prefix="bearing_sim_viewer_")
        environment = dict(os.environ, RUST_LOG="error", HOME=self._home.name, XDG_RUNTIME_DIR=self._home.name)
        environment.pop("DISPLAY", None)
        subprocess.run([program, "analytics", "disable"], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        port = free_port()
        options = ["--headless", "--bind", HOST, "--port", str(port), "--memory-limit", "2GB", "--hide-welcome-screen"]
        self._messages = tempfile.TemporaryFile()
        command = [program, *options, "--window-size", f"{self._size[0]}x{self._size[1]}", self._recording]
        self._process = subprocess.Popen(
            command,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=self._messages,
        )
        try:
            self._connect(port)
        except BaseException:
            self.__exit__()
            raise
        if self._in_idle_time:
            give_idle_time(self.pid)
        return self

    def __exit__(self, *_) -> None:
        self._process.terminate()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._messages.close()
        self._home.cleanup()

    def _connect(self, port: int) -> None:
        from rerun.experimental import ViewerClient

        deadline = time.monotonic() + _READY_WITHIN
        last_error = "it did not answer"
        while time.monotonic() < deadline:
            if self._process.poll() is not None:
                raise ViewerFailed(self._why_it_ended())
            try:
                self._client = ViewerClient.connect(stream_url(port))
                state = self._client.get_state()
                if state.recordings and state.recordings[0].timelines and not state.loading:
                    return
                last_error = "it shows no recording"
            except (RuntimeError, ConnectionError, OSError, ValueError) as error:  # not listening yet
                last_error = str(error)
            time.sleep(0.1)
        raise ViewerFailed(f"the viewer was not ready after {_READY_WITHIN:g} s: {last_error}")

    def _why_it_ended(self) -> str:
        self._messages.seek(0)
        output = self._messages.read().decode(errors="replace").strip()
        lowered = output.lower()
        if "graphics" in lowered or "render context" in lowered or "adapter" in lowered:
            return HOW_TO_GET_VULKAN
        return f"the viewer ended with code {self._process.returncode}: {output[-800:] or 'no message'}"

    @property
    def pid(self) -> int:
        """Number of the viewer's process."""
        return self._process.pid

    def span(self) -> tuple[float, float]:
        """Return first and last time of the recording's timeline [s]."""
        line = next(line for line in self._client.get_state().recordings[0].timelines if line.name == TIMELINE)
        return (line.start or 0) / 1e9, (line.end or 0) / 1e9

    def seek(self, seconds: float) -> None:
        """Seek to a time and wait until the picture is stable (layout and zoom are animated)."""
        self._client.set_time(TIMELINE, duration=seconds, play_state="paused")
        before = None
        for _ in range(40):
            now = self._client.take_screenshot(max_size=480)
            if now == before:
                return
            before = now
            time.sleep(0.15)

    def png(self) -> bytes:
        """Return the picture as PNG."""
        return smaller_png(self._client.take_screenshot())

    def views(self) -> list[str]:
        """Return the names of the views on the screen."""
        return [view.name for view in self._client.get_state().views]

    def problems(self) -> list[str]:
        """Return the problems that a view or the viewer itself reports."""
        reported = [f"{view.name}: {report.severity} {report.summary}" for view in self._client.get_state().views for report in view.reports]
        logged = [f"{entry.level}: {entry.message}" for entry in self._client.get_logs() if entry.level in ("WARN", "ERROR")]
        return reported + [text for text in logged if not any(notice in text for notice in _HARMLESS_NOTICES)]


def smaller_png(content: bytes) -> bytes:
    """Return the same picture, compressed harder: about a third smaller than the file that the viewer writes in haste."""
    smaller = io.BytesIO()
    Image.open(io.BytesIO(content)).save(smaller, "PNG", optimize=True)
    return smaller.getvalue()


def viewer_program() -> Path:
    """Return the native viewer: the console script only starts it as a child, which would survive a kill."""
    import rerun_cli

    return Path(rerun_cli.__file__).with_name("rerun.exe" if os.name == "nt" else "rerun")
