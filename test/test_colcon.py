# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""colcon builds, installs and tests the package, with the environment that these tests run in as the only underlay."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
COLCON = shutil.which("colcon", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
SELECTION = ["test/test_package.py", "test/test_topics.py", "test/test_pacer.py"]  # seconds; all tests would run these again
LEFT_BEHIND = (".git", ".venv", ".*_cache", ".hypothesis", "__pycache__", "*.egg-info", "build", "install", "log", "runs")

pytestmark = [
    pytest.mark.skipif(" " in sys.executable, reason=f"colcon's own scripts cannot hold a path with a space: {sys.executable}"),
    pytest.mark.skipif(COLCON is None, reason="colcon is not installed: pip install colcon-common-extensions"),
    pytest.mark.timeout(180),
]


class Workspace:
    """A colcon workspace with a copy of the package in src."""

    def __init__(self, folder):
        self.folder = folder
        shutil.copytree(ROOT, folder / "src" / "bearing_sim", ignore=shutil.ignore_patterns(*LEFT_BEHIND))

    def run(self, *command, timeout=120):
        prefix = sys.prefix
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        environment = {**os.environ, "PATH": path, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        environment.pop("PYTHONPATH", None)  # the copy shall be found by itself
        for name in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
            environment[name] = os.pathsep.join(filter(None, [prefix, os.environ.get(name)]))
        return subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, timeout=timeout)

    def installed(self, words):
        """Run a command with the workspace sourced, as its user does."""
        return self.run("bash", "-c", f". install/local_setup.bash && {words}")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    workspace = Workspace(tmp_path_factory.mktemp("workspace"))
    done = workspace.run(COLCON, "build")
    assert done.returncode == 0, done.stdout + done.stderr
    return workspace


@pytest.mark.long
def test_colcon_takes_the_package_for_a_ros_package(built):
    (line,) = built.run(COLCON, "list").stdout.splitlines()
    assert line.split() == ["bearing_sim", "src/bearing_sim", "(ros.ament_python)"]


def test_colcon_installs_what_ros_looks_for(built):
    prefix = built.folder / "install" / "bearing_sim"
    assert (prefix / "share/ament_index/resource_index/packages/bearing_sim").is_file()
    assert (prefix / "share/bearing_sim/package.xml").is_file()
    launch_files = {path.name for path in (ROOT / "launch_scripts").glob("*.launch.py")}
    assert {path.name for path in (prefix / "share/bearing_sim/launch").iterdir()} == launch_files
    assert {path.name for path in (prefix / "share/bearing_sim/layouts").iterdir()} == {"bearing.rviz", "foxglove.json", "plotjuggler.xml"}
    for folder in ("bin", "lib/bearing_sim"):  # on the PATH, and where ros2 run and launch look
        assert {path.name for path in (prefix / folder).iterdir()} == {"bearing-sim", "bearing_node", "bearing_player"}
    hooks = built.installed('python -c "import bearing_sim; print(bearing_sim.__file__)"; echo $AMENT_PREFIX_PATH')
    module, path = hooks.stdout.split()
    assert Path(module).is_relative_to(built.folder) and path.split(os.pathsep)[0] == str(prefix)


@pytest.mark.long
def test_the_installed_programs_run_and_find_the_bundled_scenes(built):
    scenes = built.installed("bearing-sim scenes && which bearing-sim")
    assert scenes.returncode == 0 and "deng2017_table1" in scenes.stdout, scenes.stderr
    assert Path(scenes.stdout.split()[-1]).is_relative_to(built.folder)
    pytest.importorskip("rclpy", reason="bearing_node and bearing_player need ROS 2")
    programs = "timeout -s KILL 60 install/bearing_sim/lib/bearing_sim"
    node = built.installed(f"{programs}/bearing_node --ros-args -r __ns:=/m1 -p scene:=deng2017_tabel1")
    assert node.returncode == 2 and "deng2017_table1" in node.stderr and "Traceback" not in node.stderr, node.stderr
    player = built.installed("timeout -s KILL 60 bearing_player --help")
    assert player.returncode == 0 and "--wait-limit" in player.stdout


@pytest.mark.long
def test_colcon_test_passes_and_its_result_says_so(built):
    done = built.run(COLCON, "test", "--return-code-on-test-failure", "--pytest-args", *SELECTION)
    assert done.returncode == 0, done.stdout + done.stderr
    result = built.run(COLCON, "test-result", "--verbose", "--all")
    assert result.returncode == 0, result.stdout
    tests, errors, failures = _counts(result)
    assert tests > 20 and errors == failures == 0


def _counts(result):
    numbers = [int(word) for word in result.stdout.partition("Summary:")[2].replace(",", " ").split() if word.isdigit()]
    return numbers[0], numbers[1], numbers[2]


def test_a_test_that_fails_is_told_by_colcon(built):
    failing = built.folder / "src" / "bearing_sim" / "test" / "test_that_fails.py"
    failing.write_text("def test_false():\n    assert False\n")
    try:
        built.run(COLCON, "test", "--pytest-args", f"test/{failing.name}")
        result = built.run(COLCON, "test-result")
        assert result.returncode == 1 and _counts(result)[2] == 1
    finally:
        failing.unlink()
