# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A browser without a window, driven by the DevTools protocol over pipes: what a page loads, and its picture."""

import base64
import contextlib
import io
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

import numpy as np
from PIL import Image

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync "
    "--disable-dev-shm-usage --use-angle=swiftshader --enable-unsafe-swiftshader --remote-debugging-pipe --window-size=1000,640"
).split()
_PATIENCE = 120.0  # [s] on a busy machine


def program() -> str | None:
    """Return the path of an installed Chromium, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Chromium:
    """A page in a browser of its own, with an empty profile; a context manager.

    Attributes
    ----------
    requests : addresses that the page asked for, in order.
    problems : what the page logged as an error, and requests that failed or were refused.
    """

    def __init__(self):
        self.requests, self.problems = [], []
        self._profile, self._buffer, self._number, self._answers = tempfile.mkdtemp(), b"", 0, {}
        theirs, self._write = os.pipe()
        self._read, theirs_out = os.pipe()
        command = f'exec "$@" 3<&{theirs} 4>&{theirs_out}'
        words = ["bash", "-c", command, "browser", program(), *_FLAGS, f"--user-data-dir={self._profile}", "about:blank"]
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self._process = subprocess.Popen(words, pass_fds=(theirs, theirs_out), start_new_session=True, **quiet)
        os.close(theirs)
        os.close(theirs_out)
        self._session = None

    def __enter__(self):
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Network", "Page", "Runtime", "Log"):
            self._call(f"{domain}.enable")
        return self

    def __exit__(self, *_):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)  # with its helpers; the group is its own
        self._process.wait()
        os.close(self._read)
        os.close(self._write)
        shutil.rmtree(self._profile, ignore_errors=True)

    def open(self, url):
        """Go to an address, and wait until its page is loaded."""
        self._loaded = False
        self._call("Page.navigate", url=url)
        self.wait(lambda: self._loaded, f"{url} is not loaded")

    def picture(self) -> np.ndarray:
        """Return what the page shows, shape (height, width, 3), and keep it as ``png``."""
        self.png = base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"])
        return np.asarray(Image.open(io.BytesIO(self.png)).convert("RGB"))

    def _call(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        self.wait(lambda: self._number in self._answers, f"no answer to {method}")
        answer = self._answers.pop(self._number)
        assert "error" not in answer, answer
        return answer["result"]

    def wait(self, condition, otherwise):
        """Wait until a condition of what the page has done holds."""
        deadline = time.monotonic() + _PATIENCE
        while not condition():
            assert self._process.poll() is None, "the browser ended"
            assert time.monotonic() < deadline, otherwise
            if select.select([self._read], [], [], 0.2)[0]:
                self._take(os.read(self._read, 1 << 20))

    def _take(self, data):
        *messages, self._buffer = (self._buffer + data).split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self._answers[message["id"]] = message
                continue
            method, content = message["method"], message["params"]
            if method == "Page.loadEventFired":
                self._loaded = True
            elif method == "Network.requestWillBeSent":
                self.requests.append(content["request"]["url"])
            elif method == "Network.loadingFailed" and not content.get("canceled"):
                self.problems.append(content["errorText"])
            elif method == "Log.entryAdded" and content["entry"]["level"] == "error":
                self.problems.append(content["entry"]["text"])
            elif method == "Runtime.exceptionThrown":
                self.problems.append(str(content["exceptionDetails"].get("exception", content)))
