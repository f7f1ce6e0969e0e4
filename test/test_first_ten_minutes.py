# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The commands of the tutorial on live monitoring do what it says: each is executed, those of ``ros2`` through rclpy."""

import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rcl_interfaces.srv import SetParameters  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402

pytestmark = pytest.mark.timeout(240)
ROOT = Path(__file__).resolve().parents[1]
PAGE, TITLE = ROOT / "doc" / "tutorials" / "live_monitoring.md", "## The first ten minutes"


def commands():
    """Return the commands of the tutorial's section, in order, without their comments."""
    text = PAGE.read_text()
    assert TITLE in text, f"the tutorial has no section {TITLE!r}"
    (block,) = re.findall(r"```text\n(.*?)```", text.partition(TITLE)[2].partition("\n## ")[0], flags=re.DOTALL)
    return [shlex.split(line, comments=True) for line in block.splitlines() if shlex.split(line, comments=True)]


class User:
    """Runs the commands in a folder; what is started keeps running."""

    def __init__(self, folder):
        self.folder, self.domain = folder, fresh_domain()
        self.client, self.node, self.player = Client(self.domain), None, None

    def close(self):
        self.client.close()
        for process in (self.player, self.node):
            if process is not None:
                process.end(signal.SIGKILL)

    def run(self, words):
        """Run one command; a command that this does not know fails."""
        match words:
            case ["bearing_node"]:
                self.node = NodeProcess(self.folder, self.domain, limit=220, from_scratch=True)
            case ["bearing-sim", *rest]:
                subprocess.run([sys.executable, "-m", "bearing_sim.cli", *rest, *(["--no-open"] if rest[0] == "view" else [])],
                               cwd=self.folder, env=self._environment(), check=True, timeout=120)  # fmt: skip
            case ["bearing_player", log]:
                self.player = NodeProcess(self.folder, self.domain, log, module="bearing_sim.ros.player", limit=200)
            case ["ros2", "topic", "list"]:
                self._list_topics()
            case ["ros2", "topic", "echo", "/cage_slip"]:
                self._wait(lambda: any(message.data == message.data for message in self.client.received["cage_slip"]), "slip is a number")
            case ["ros2", "param", "set", "/bearing_node", name, value]:
                request = SetParameters.Request(parameters=[Parameter(name, value=float(value)).to_parameter_msg()])
                (result,) = self.client.call(SetParameters, "set_parameters", request, self.node).results
                assert result.successful, result.reason
            case ["ros2", "topic", "echo", "/diagnostics"]:
                self._wait(lambda: [s for s in self.client.statuses() if s[:2] == (1, "bearing_node: bearing.slip")], "the slip is a warning")
                (text,) = {re.sub(r"[\d.]+ %", "X %", s[2]) for s in self.client.statuses() if s[1:2] == ("bearing_node: bearing.slip",)} or {""}
                assert text.startswith("cage slip: X % has reached X %")
            case ["ros2", "service", "call", service, "std_srvs/srv/Trigger"]:
                answer = self.client.call(Trigger, service.removeprefix("/bearing_node/"), Trigger.Request(), self.node)
                assert answer.success, answer.message
                self.client.spin(1.0)
            case _:
                raise AssertionError(f"a command of the tutorial that is not run here: {shlex.join(words)}")

    def _list_topics(self):
        scene = load_scene("deng2017_table1")
        wanted = {f"/{name}" for name in (*topics.outputs(scene), *topics.inputs(scene), topics.MEASURED, "diagnostics")}
        self._wait(lambda: wanted <= {name for name, _ in self.client.node.get_topic_names_and_types()}, "all topics are there")

    def _wait(self, condition, what):
        self.client.spin_until(condition, what, self.node, patience=120.0)

    def _environment(self):
        import os

        return {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.mark.long
def test_the_commands_of_the_first_ten_minutes_do_what_the_tutorial_says(tmp_path):
    user = User(tmp_path)
    try:
        done = [user.run(words) for words in commands()]
        assert len(done) >= 9, "start, feed, list, echo, change a threshold, see the warning, record, stop, open"
        assert Recording(tmp_path / "recordings" / "run.mcap").samples > 20
        assert user.node.end(signal.SIGINT) == 0 and "Traceback" not in user.node.text
    finally:
        user.close()
