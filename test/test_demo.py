# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The demonstration end to end, on a shortened mission and in this environment: node, player, recording, view, summary."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="the demonstration needs ROS 2")

from ros_bench import PATIENCE, NodeProcess, fresh_domain  # noqa: E402

from bearing_sim.inputs.log import read_input_log  # noqa: E402
from bearing_sim.inputs.mission import mission  # noqa: E402

pytestmark = pytest.mark.timeout(240)
REPOSITORY = Path(__file__).resolve().parent.parent
SCRIPTS = REPOSITORY / "launch_scripts"


def demo(folder, *arguments):
    """Start the demonstration with its runs in a folder."""
    return NodeProcess(
        folder, fresh_domain(), "--out", str(folder / "my runs"), "--no-open", "--no-estimates", *arguments, module="bearing_sim.ros.demo", limit=220
    )


def the_run(folder):
    (run,) = (folder / "my runs").iterdir()
    return run


@pytest.mark.long
def test_the_demonstration_plays_a_mission_over_dds_and_leaves_recording_view_and_summary(tmp_path):
    seconds = 6.0
    process = demo(tmp_path, "--duration", str(seconds))
    assert process.process.wait(200) == 0, process.text
    run = the_run(tmp_path)
    log = read_input_log(run / "run.mcap")
    played = read_input_log(run / "mission.mcap")
    for channel, series in played.series.items():
        assert len(log.series[channel].values) >= 0.95 * len(series.values) - 1, f"{channel}: nearly every message arrived"
    fastest = max(value for (value,) in log.series["shaft_speed"].values)
    assert fastest == pytest.approx(max(mission(seconds * k / 100, seconds).shaft_speed for k in range(101)), rel=1e-3)
    verified = subprocess.run([str(Path(sys.executable).with_name("rerun")), "rrd", "verify", str(run / "run.rrd")], capture_output=True, timeout=60)
    assert verified.returncode == 0
    assert re.search(r"largest shaft speed\s+45000 rpm", process.text)
    assert re.search(r"cage slip while turning\s+mean \d", process.text)
    opened = f"rerun --bind 127.0.0.1 --port auto '{run / 'run.rrd'}'"
    assert opened in process.text, "the command that opens the recording, quoted for the space in its path"
    assert "Traceback" not in process.text


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_demonstration_ends_its_processes_and_completes_the_recording(tmp_path, number):
    process = demo(tmp_path, "--duration", "15")
    deadline = time.monotonic() + 100.0
    while "10 %" not in process.text:
        assert time.monotonic() < deadline and process.process.poll() is None, process.text
        time.sleep(0.2)
    assert process.end(number) == 130, process.text
    assert "interrupted" in process.text and "Traceback" not in process.text
    run = the_run(tmp_path)
    assert (run / "run.mcap").is_file() and not list(run.glob("*.active"))
    assert "Traceback" not in (run / "node.log").read_text()


@pytest.mark.long
def test_killing_the_demonstration_by_force_leaves_no_node_behind(tmp_path):
    process = demo(tmp_path, "--duration", "15")
    deadline = time.monotonic() + 100.0
    while "10 %" not in process.text:
        assert time.monotonic() < deadline and process.process.poll() is None, process.text
        time.sleep(0.2)
    process.end(signal.SIGKILL)
    recording = the_run(tmp_path) / "run.mcap"
    while not recording.is_file():
        assert time.monotonic() < deadline, "the node did not end and complete its recording"
        time.sleep(0.2)


def test_a_wrong_scene_is_told_before_anything_starts(tmp_path):
    process = demo(tmp_path, "--set", "lubricant.temprature=300")
    assert process.wait() == 2
    assert "did you mean 'temperature'" in process.text
    assert not (tmp_path / "my runs").exists()


@pytest.mark.long
def test_a_player_whom_nobody_hears_gives_up_with_a_word(tmp_path):
    process = NodeProcess(tmp_path, fresh_domain(), str(tmp_path / "no.mcap"), module="bearing_sim.ros.player")
    assert process.wait() == 2 and "no such file" in process.text
    from recordings import steady_log

    log = steady_log(tmp_path / "log.mcap", duration=0.2)
    process = NodeProcess(tmp_path, fresh_domain(), str(log), "--wait-limit", "0.5", module="bearing_sim.ros.player")
    assert process.wait() == 1
    assert "no subscriber for shaft_speed, radial_load" in process.text and "Traceback" not in process.text


def script(folder, *arguments, **environment):
    """Run a copy of demo.sh that stands in a folder of its own; nothing is installed."""
    place = folder / "a copy" / "launch_scripts"
    place.mkdir(parents=True, exist_ok=True)
    for name in ("demo.sh", "environment.sh"):
        shutil.copy(SCRIPTS / name, place)
    clean = {"PATH": os.environ["PATH"], "HOME": str(folder)} | environment
    return subprocess.run([str(place / "demo.sh"), *arguments], env=clean, cwd="/", capture_output=True, text=True, timeout=PATIENCE)


def test_the_shell_script_is_sound_and_says_which_python_it_needs(tmp_path):
    assert all(subprocess.run(["bash", "-n", str(path)], timeout=PATIENCE).returncode == 0 for path in SCRIPTS.glob("*.sh"))
    old = tmp_path / "old"
    old.mkdir()
    for name in ("python3", "python3.11", "python3.12", "python3.13", "python3.14"):
        fake = old / name
        fake.write_text('#!/bin/sh\n[ "$1" = --version ] && echo "Python 3.9.2" && exit 0\nexit 1\n')
        fake.chmod(0o755)
    done = script(tmp_path, PATH=f"{old}:{os.environ['PATH']}")
    assert done.returncode == 2 and "needs Python 3.11 to 3.14, for which there are wheels of ROS 2; python3 is Python 3.9.2" in done.stderr


def test_the_shell_script_says_how_to_get_venv(tmp_path):
    fake = tmp_path / "python3"
    fake.write_text(f'#!/bin/sh\ncase "$*" in *ensurepip*) exit 1;; esac\nexec "{sys.executable}" "$@"\n')
    fake.chmod(0o755)
    done = script(tmp_path, PYTHON=str(fake))
    assert done.returncode == 2 and "apt install python3-venv" in done.stderr


def in_environment(folder, commands):
    """Run shell commands that know the functions of environment.sh, with a folder that stands for the checkout."""
    text = f"set -euo pipefail; here='{folder}'; . '{SCRIPTS / 'environment.sh'}'; {commands}"
    return subprocess.run(["bash", "-c", text], capture_output=True, text=True, timeout=PATIENCE)


def test_each_stage_of_the_installation_says_how_long_it_took_the_last_time_or_what_to_expect(tmp_path):
    (tmp_path / ".venv").mkdir()
    assert in_environment(tmp_path, "timed ros 3 'installing ROS 2' true").stderr == "installing ROS 2\n", "nothing is known yet"
    (tmp_path / ".venv" / ".bearing_sim_seconds_venv").write_text("7\n")
    (tmp_path / ".venv" / ".bearing_sim_seconds_ros").unlink()
    failed = in_environment(tmp_path, "timed ros 3 'installing ROS 2' false")
    assert failed.returncode == 1 and failed.stderr == "installing ROS 2 (about 21 s)\n"
    in_environment(tmp_path, "timed ros 3 'installing ROS 2' sleep 1.1")
    done = in_environment(tmp_path, "timed ros 3 'installing ROS 2' echo installed")
    assert done.stdout == "installed\n" and done.stderr in [f"installing ROS 2 ({seconds} s the last time here)\n" for seconds in (1, 2)]


@pytest.mark.parametrize(("commands", "has_ros", "failed"), [("touch ready", True, False), ("exit 0", False, False), ("exit 3", False, True)])
def test_the_demonstration_waits_for_ros_and_then_for_all_that_is_installed_beside_it(commands, has_ros, failed, tmp_path):
    from bearing_sim.ros.demo import DemoFailed, _await

    process = subprocess.Popen(["sh", "-c", f"sleep 0.3; {commands}; sleep 0.3"], cwd=tmp_path)
    try:
        _await((process.pid, tmp_path / "ready"))
        assert (tmp_path / "ready").exists() is has_ros and not failed
    except DemoFailed as error:
        assert failed and "installation failed" in str(error)
    _await((process.pid, tmp_path / "ready"), all_of_it=True)
    with pytest.raises(ChildProcessError):
        os.waitpid(process.pid, os.WNOHANG)
