# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A command whose output nobody reads, or that cannot write it, does its work, says at most one line, and has the exit code of what it has done."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bearing_sim.recording.recovery import contents

ROOT = Path(__file__).resolve().parent.parent
NEW = "-m bearing_sim.cli new 'NU 210' --oil 'ISO VG 68' --speed 3000rpm --load 5kN"
FULL = "Error: standard output could not be written: No space left on device\n"


def run(command, redirected, folder):
    """Return the exit code of a command of Python and what it wrote on stderr, with streams redirected by the shell."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    line = ["bash", "-o", "pipefail", "-c", f"{sys.executable} {command} {redirected}"]
    done = subprocess.run(line, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=120)
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    ("redirected", "expected"),
    [
        ("| cat", (0, "")),
        ("| true", (0, "")),
        (">&-", (0, "")),
        ("<&- >&- 2>&-", (0, "")),
        ("2> /dev/full", (0, "")),
        ("> /dev/full", (1, FULL)),
        ("> /dev/full 2>&-", (1, "")),
    ],
)
def test_a_closed_pipe_is_quiet_and_a_full_disk_is_one_line(redirected, expected, tmp_path):
    assert run(NEW, redirected, tmp_path) == expected


@pytest.mark.parametrize(("redirected", "expected"), [("| true", (0, "")), ("> /dev/full", (1, FULL))])
@pytest.mark.parametrize("command", ["-m bearing_sim.cli --help", "-m bearing_sim.cli scenes --json", "-m bearing_sim.ros.parameters"])
def test_the_same_holds_for_help_for_json_and_for_programs_of_ros(command, redirected, expected, tmp_path):
    if "ros" in command:
        pytest.importorskip("rclpy", reason="needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
    assert run(command, redirected, tmp_path) == expected


@pytest.mark.parametrize(("redirected", "code"), [("| true", 0), (">&- 2>&- <&-", 0), ("> /dev/full", 1)])
def test_what_is_written_to_a_file_is_complete_whatever_becomes_of_the_output(redirected, code, tmp_path):
    code_of_it, _ = run("-m bearing_sim.cli mission --duration 2 -o m.mcap", redirected, tmp_path)  # which says what it has written
    written = contents(tmp_path / "m.mcap")
    assert code_of_it == code and written.is_sound and written.seconds == pytest.approx(2.0, abs=0.1)


def test_a_command_that_fails_keeps_its_exit_code(tmp_path):
    for redirected in ("| true", ">&-", "> /dev/full"):
        code, said = run("-m bearing_sim.cli info absent.mcap", redirected, tmp_path)
        assert code == 2 and said.startswith("Error: absent.mcap: no such file")


def test_a_stream_that_is_closed_is_no_file_that_is_opened_later(tmp_path):
    lines = (
        "import os",
        "from bearing_sim.files.standard_streams import standard_streams",
        "with standard_streams(), open('kept', 'w') as file:",
        "    os.write(1, b'lost')",
        "    file.write('data')",
    )
    (tmp_path / "program.py").write_text("\n".join(lines))
    assert run("program.py", ">&-", tmp_path) == (0, "") and (tmp_path / "kept").read_text() == "data"
