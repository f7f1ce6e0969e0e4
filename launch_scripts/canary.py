#!/usr/bin/env python3
# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Try this checkout in fresh environments: with each Python of this machine, another ROS, or the newest of everything that it uses.

    python3 launch_scripts/canary.py                              # each Python found: install, short tests, a row
    python3 launch_scripts/canary.py /usr/bin/python3.14 --demo   # this one, and the demo
    python3 launch_scripts/canary.py --ros kilted                 # ROS 2 Kilted from wheels instead of Jazzy
    python3 launch_scripts/canary.py --ros installed              # the ROS 2 whose setup file is sourced; also launch files and nodes
    python3 launch_scripts/canary.py --ros ""                     # without ROS
    python3 launch_scripts/canary.py --newest                     # without upper bounds; says what is newer than setup.py allows
    python3 launch_scripts/canary.py --newest --pre               # and with what is not yet released
    python3 launch_scripts/canary.py --oldest python3.11          # at the lower bounds

An environment takes 1.7 GB, a minute or two to install and some minutes to compile; it is removed afterwards.  Exit code 1: something failed.
"""

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
MINORS = range(11, 17)  # of Python 3, looked for
TESTS = [  # what depends on the versions of others, each with what it tries
    ("test_kernels.py", "numba: vectors over LLVM"),
    ("test_linking.py -k not steady", "numba: one program for each function that Python calls, and its files"),
    ("test_compiled_call.py -k not steady", "numba: calls without looking at types; level slip compiled"),
    ("test_rclpy_internals.py", "rclpy: what it does not promise"),
    ("test_sample_messages.py", "messages: fields and order"),
    ("test_view_layout.py", "rerun: lay-out"),
    ("test_scene_file.py", "pydantic, pint, PyYAML"),
    ("test_mcap_rows.py", "mcap, rosbags"),
    ("test_input_log.py", "NumPy"),
    ("test_sweep_executor.py -k order_of_the_tasks", "processes"),
]
WITH_ROS = [
    ("test_launch_files.py", "launch, launch_ros"),
    ("test_node_lifecycle.py test_node_recording.py", "nodes over DDS"),
]  # where it is installed
TOOLS = ["hypothesis>=6", "pytest>=8,<9.2", "pytest-timeout", "pytest-xdist"]
EXTRAS = "dask,plot,tables,terminal,vibration,view"
ROS_PACKAGES = ("rclpy[fastrtps]", "std-msgs", "sensor-msgs", "geometry-msgs", "diagnostic-msgs", "std-srvs")
REQUIREMENT = re.compile(r'"([\w-]+(?:\[\w+\])?)([<>=]=?[^";{]+)')  # name and bounds, as setup.py writes them
INSTALLED = """
import sys
from importlib.metadata import PackageNotFoundError, version
from packaging.requirements import Requirement
for text in sys.argv[1:]:
    wanted = Requirement(text)
    try:
        found = version(wanted.name)
    except PackageNotFoundError:
        continue
    print(f"  {wanted.name} {found}" + ("" if wanted.specifier.contains(found, prereleases=True) else f": OUTSIDE of {wanted.specifier}"))
"""


def pythons() -> list[str]:
    """Return the interpreters on the PATH and of pyenv, one of each minor version."""
    found = {}
    for minor in MINORS:
        candidates = [shutil.which(f"python3.{minor}"), *sorted(Path.home().glob(f".pyenv/versions/3.{minor}.*/bin/python"))]
        for candidate in filter(None, candidates):
            if subprocess.run([candidate, "-c", "import ensurepip, venv"], capture_output=True).returncode == 0:  # a shim of pyenv may start nothing
                found[minor] = str(candidate)
    return list(found.values())


def newest(requirement: re.Match) -> str:
    """Return a requirement of setup.py without its upper bound."""
    name, bounds = requirement.groups()
    return f'"{name}' + "".join(bound for bound in bounds.split(",") if bound.startswith(">="))


def oldest(requirement: re.Match) -> str:
    """Return a requirement of setup.py that takes releases of its lower bound alone: 2.0 any 2.0.x; one without a lower bound as it is."""
    name, bounds = requirement.groups()
    return f'"{name}' + "".join(f"=={bound[2:]}.*" for bound in bounds.split(",") if bound.startswith(">=")) if ">=" in bounds else requirement[0]


class Environment:
    """A fresh copy of the checkout with a fresh virtual environment and home beside it."""

    def __init__(self, folder: Path, python: str, given: argparse.Namespace):
        self.folder, self.python, self.given = folder, python, given
        self.copy, self.own = folder / "checkout", folder / "checkout" / ".venv" / "bin" / "python"
        kept = ("PATH", "LANG", "TMPDIR", "SSL_CERT_FILE", *(name for name in os.environ if name.startswith("PIP_")))
        if given.ros == "installed":
            kept += ("PYTHONPATH", "AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION", "RMW_IMPLEMENTATION")
        self.variables = {name: os.environ[name] for name in kept if name in os.environ}
        self.variables |= {"HOME": str(folder / "home"), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}

    def _run(self, *words: str) -> subprocess.CompletedProcess:
        return subprocess.run(words, cwd=self.copy, env=self.variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def install(self) -> str:
        """Install; return an error, empty if there is none."""
        (self.folder / "home").mkdir(parents=True)
        shutil.copytree(HERE, self.copy, ignore=shutil.ignore_patterns(".git", ".venv", "build", "runs", "__pycache__", "*.egg-info", ".hypothesis"))
        setup = self.copy / "setup.py"
        self.wanted = ["".join(found) for found in REQUIREMENT.findall(setup.read_text())]
        if self.given.bounds is not None:
            setup.write_text(REQUIREMENT.sub(self.given.bounds, setup.read_text()))
        jazzy = self.given.ros == "jazzy"  # that of setup.py
        ros = [] if self.given.ros in ("jazzy", "installed", "") else [f"ros-{self.given.ros}-{name}" for name in ROS_PACKAGES]
        packages = [f"{self.copy}[{'full' if jazzy else EXTRAS}]", *ros, *TOOLS]
        steps = [
            [self.python, "-m", "venv", str(self.copy / ".venv")],
            [str(self.own), "-m", "pip", "install", "-qq", *(["--pre"] if self.given.pre else []), *packages],
        ]
        for words in steps:
            done = self._run(*words)
            if done.returncode:
                return next((line for line in done.stdout.splitlines() if "ERROR" in line), done.stdout[-300:]).strip()
        return ""

    def test(self) -> tuple[int, list[str]]:
        """Run the short list; return how many passed and what failed."""
        passed, failed = 0, []
        for words, tried in TESTS + (WITH_ROS if self.given.ros == "installed" else []):
            files, _, chosen = words.partition(" -k ")
            command = [str(self.own), "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not long"]
            command += ["-o", "filterwarnings=error::DeprecationWarning:bearing_sim", *(["-k", chosen] if chosen else [])]
            done = self._run(*command, *(f"test/{name}" for name in files.split()))
            passed += int((re.findall(r"(\d+) passed", done.stdout) or [0])[-1])
            if done.returncode not in (0, 5):  # 5: all were skipped, such as what needs ROS
                failed += [f"{tried}: {line}" for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))] or [
                    f"{tried}: {done.stdout[-500:]}"
                ]
        return passed, failed

    def demo(self) -> str:
        """Run the demo; return how it ended."""
        done = self._run(str(self.own), "-m", "bearing_sim.ros.demo", "--out", str(self.folder / "runs"), "--no-open")
        return "yes" if done.returncode == 0 else f"exit code {done.returncode}: {done.stdout[-500:]}"

    def versions(self) -> str:
        """Return the version of each requirement that is installed, and which are outside of the bounds of setup.py."""
        return self._run(str(self.own), "-c", INSTALLED, *self.wanted).stdout


def system() -> str:
    """Return the name of the operating system."""
    try:
        release = platform.freedesktop_os_release()
    except OSError:
        return platform.platform()
    return release.get("PRETTY_NAME", release["NAME"])


def main() -> int:
    """Print a row for each Python; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("python", nargs="*", help="interpreters; without any, each that is found")
    parser.add_argument("--ros", default="jazzy", help="distribution of ROS 2 to take from wheels, or installed; empty: none (default: %(default)s)")
    bounds = parser.add_mutually_exclusive_group()
    bounds.add_argument("--newest", dest="bounds", action="store_const", const=newest, help="without the upper bounds of setup.py")
    bounds.add_argument("--oldest", dest="bounds", action="store_const", const=oldest, help="at the lower bounds of setup.py")
    parser.add_argument("--pre", action="store_true", help="with pre-releases")
    parser.add_argument("--demo", action="store_true", help="run the demo, too")
    given = parser.parse_args()
    ended = 0
    print("| Python | system | ROS 2 | installed | short tests | demo |\n|---|---|---|---|---|---|", flush=True)
    for python in given.python or pythons():
        version = subprocess.run([python, "-c", "import platform; print(platform.python_version())"], capture_output=True, text=True).stdout.strip()
        with tempfile.TemporaryDirectory(prefix="canary_") as folder:
            environment, begin = Environment(Path(folder), python, given), time.monotonic()
            told, failed, demo, versions = environment.install(), [], "not run", ""
            installed = f"no: {told}" if told else f"yes, {time.monotonic() - begin:.0f} s"
            passed = "not run"
            if not told:
                versions = environment.versions()
                count, failed = environment.test()
                passed = f"{count} passed" + (f", {len(failed)} failed" if failed else "")
                demo = environment.demo() if given.demo else demo
        print(f"| {version} | {system()} | {given.ros or 'none'} | {installed} | {passed} | {demo.splitlines()[0]} |", flush=True)
        if given.bounds or failed or "\n" in demo:
            print(*failed, demo, versions.rstrip(), sep="\n", file=sys.stderr, flush=True)
        ended |= bool(told or failed or demo.startswith("exit"))
    return ended


if __name__ == "__main__":
    sys.exit(main())
