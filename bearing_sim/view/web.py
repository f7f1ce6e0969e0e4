# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rerun's web viewer for a browser on this machine: served on 127.0.0.1 only, and it loads nothing from elsewhere.

``rerun.serve_web_viewer`` and ``serve_grpc`` of rerun 0.41 listen on all interfaces, the page asks Google for a font, and the viewer reports to its
makers.  Its files are therefore taken once from the program ``rerun``, which can be bound to 127.0.0.1, kept in the user's cache, and served
by this module with a policy that forbids the browser everything that is not on this machine.
"""

import atexit
import contextlib
import hashlib
import http.client
import logging
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import zipfile
from collections.abc import Mapping
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import version
from pathlib import Path
from typing import BinaryIO
from urllib.parse import quote, urlsplit

from bearing_sim.files.kept import cache_folder, checked_contents, kept_if_possible, read_kept, tell_once, with_checksum
from bearing_sim.files.limits import JSON_FILE
from bearing_sim.view.viewer import HOST, free_port, stream_url

_PAGE = "index.html"
_NEEDED = (_PAGE, "re_viewer.js", "re_viewer_bg.wasm")
_FILES = (*_NEEDED, "favicon.ico")  # of the viewer
_TYPES = {".html": "text/html; charset=utf-8", ".js": "text/javascript", ".wasm": "application/wasm"}  # whatever the machine says
_DIGESTS = "digests.json"  # of the files, beside them
# What the viewer is: its own files, code that it compiles, and streams from servers on this machine.
_POLICY = (
    "default-src 'self' blob: data:; script-src 'self' 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval' blob:; style-src 'self' 'unsafe-inline'; "
    "worker-src 'self' blob:; connect-src 'self' blob: data: http://127.0.0.1:* ws://127.0.0.1:*"
)
_START_UP = 60.0  # [s] for the program to serve its files on a busy machine
_log = logging.getLogger(__name__)


class NoWebViewer(RuntimeError):
    """The web viewer cannot be served; the message says why."""


class WebViewer:
    """Serves rerun's web viewer on 127.0.0.1 until it is closed; a context manager.

    Parameters
    ----------
    port : on 127.0.0.1; 0 for any that is free.
    stream : port on 127.0.0.1 of a server of recordings (`bearing_sim.view.run_view`), or None.
    recording : an .rrd file to show, or None; one of both.

    Attributes
    ----------
    url : to open in a browser.

    Raises
    ------
    NoWebViewer
        The port is taken, or the viewer's files are not to be had.
    """

    def __init__(self, port: int, stream: int | None = None, recording: Path | None = None):
        folder = viewer_files()
        served = {f"/{name}": folder / name for name in _FILES}
        if recording is not None:
            served["/recording.rrd"] = recording
        try:
            self._server = _Server((HOST, port), _Handler)
        except OSError as error:
            text = (
                f"port {port} on {HOST} cannot be used for the web viewer ({error.strerror}); close the program that uses it or choose another port"
            )
            raise NoWebViewer(text) from None
        self.url = f"http://{HOST}:{self._server.server_port}"
        shown = f"{self.url}/recording.rrd" if stream is None else stream_url(stream)
        self._server.served, self._server.shown = served, f"/?url={quote(shown, safe='')}&hide_welcome_screen&persist=0&theme=dark"
        self._thread = threading.Thread(target=self._server.serve_forever, name="web-viewer", daemon=True)
        self._thread.start()

    def __enter__(self) -> "WebViewer":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


class _Server(ThreadingHTTPServer):
    """A server that does not wait for browsers when it ends."""

    daemon_threads = True
    allow_reuse_address = True
    served: Mapping[str, Path]  # by the path of a request
    shown: str  # where the page begins

    def handle_error(self, request, client_address) -> None:
        """Ignore browsers that leave in the middle of an answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            _log.exception("the web viewer could not be served")


class _Handler(SimpleHTTPRequestHandler):
    """Answers requests for the files of the viewer and for the recording; all others are refused."""

    protocol_version = "HTTP/1.1"
    extensions_map = SimpleHTTPRequestHandler.extensions_map | _TYPES
    server: _Server

    def send_head(self) -> BinaryIO | None:
        """Send the head of an answer; return the file that follows, if any."""
        host = self.headers.get("Host", "").rpartition(":")[0]
        if host not in (HOST, "localhost"):  # a page from elsewhere whose name leads to this machine
            self.send_error(403, f"this viewer is for browsers on this machine: http://{HOST}:{self.server.server_port}")
            return None
        asked = urlsplit(self.path)
        if asked.path == "/" and "url=" not in asked.query:
            self.send_response(302)
            self.send_header("Location", self.server.shown)
            self.send_header("Content-Length", "0")
            self.end_headers()
            return None
        return super().send_head()

    def translate_path(self, path: str) -> str:
        """Return the file that a path of a request means; empty, which is no file, where nothing is served."""
        asked = urlsplit(path).path
        return str(self.server.served.get(f"/{_PAGE}" if asked == "/" else asked, ""))

    def end_headers(self) -> None:
        """Send what every answer says of itself, and the end of its head."""
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def log_message(self, format, *arguments) -> None:
        """Log requests for developers only."""
        _log.debug(format, *arguments)


def viewer_files() -> Path:
    """Return the folder with the files of the web viewer of the installed rerun.

    Raises
    ------
    NoWebViewer
        They are not in the package, and its program does not serve them.
    """
    folder = cache_folder() / "web_viewer" / version("rerun-sdk")
    kept = read_kept(folder / _DIGESTS, JSON_FILE, lambda data: checked_contents(data, "web_viewer")[1])
    if kept is not None:
        if kept == _digests(folder):
            return folder
        tell_once(f"{folder} is damaged; its files are taken from rerun again", folder)
    with kept_if_possible(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as draft:
            _fill(Path(draft))
            folder.mkdir(exist_ok=True)
            for name in (*_FILES, _DIGESTS):
                if (Path(draft) / name).is_file():
                    os.replace(Path(draft) / name, folder / name)
        return folder
    folder = Path(tempfile.mkdtemp(prefix="bearing_sim_web_viewer_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)  # another server of this process may use them until then
    _fill(folder)
    return folder


def _digests(folder: Path) -> dict[str, str]:
    """Return a digest of each file of the viewer that there is, by name."""
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in _FILES if (folder / name).is_file()}


def _fill(folder: Path) -> None:
    """Write the files of the viewer and their digests into a folder; errors as of `viewer_files`."""
    _unpack(folder)
    _without_fonts(folder / _PAGE)
    (folder / _DIGESTS).write_bytes(with_checksum("web_viewer", 1, _digests(folder)))


def _unpack(folder: Path) -> None:
    """Write the files of the viewer into a folder: from the package's archive, or as the program serves them."""
    import rerun

    archive = Path(rerun.__file__).with_name("web_viewer.zip")  # in wheels whose program has none
    if archive.is_file():
        with zipfile.ZipFile(archive) as packed:
            for member in packed.namelist():
                if Path(member).name in _FILES:
                    (folder / Path(member).name).write_bytes(packed.read(member))
        return
    ports = [free_port(), free_port()]
    command = [sys.executable, "-m", "rerun", "--serve-web", "--bind", HOST, "--port", str(ports[0]), "--web-viewer-port", str(ports[1])]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + _START_UP
        for name in _FILES:
            if (content := _downloaded(ports[1], name, deadline, process)) is not None:
                (folder / name).write_bytes(content)
    finally:
        process.kill()
        process.wait()
    if not all((folder / name).is_file() for name in _NEEDED):
        raise NoWebViewer(f"the installed rerun {version('rerun-sdk')} has no web viewer; open the native one: rerun RUN.rrd")


def _downloaded(port: int, name: str, deadline: float, process: subprocess.Popen) -> bytes | None:
    """Return a file that the program serves on 127.0.0.1; None if it has none of this name."""
    while process.poll() is None and time.monotonic() < deadline:
        connection = http.client.HTTPConnection(HOST, port, timeout=_START_UP)
        with contextlib.closing(connection):
            try:
                connection.request("GET", f"/{name}")
                answer = connection.getresponse()
                return answer.read() if answer.status == 200 else None
            except ConnectionRefusedError:  # it has not begun
                time.sleep(0.1)
    raise NoWebViewer(f"the program rerun ended, or served no web viewer within {_START_UP:g} s")


def _without_fonts(page: Path) -> None:
    """Remove the links to Google's fonts from the page, so that a browser does not ask for what the policy forbids."""
    text = page.read_text(encoding="utf-8")
    page.write_text(re.sub(r"<link\b[^>]*fonts\.(?:googleapis|gstatic)\.com[^>]*>", "", text), encoding="utf-8")
