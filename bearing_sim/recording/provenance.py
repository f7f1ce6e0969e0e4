# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where a result comes from: version and git hash of this package, nothing of the machine it ran on."""

import platform
import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path


@cache
def package_version() -> str:
    """Return the installed version; ``""`` where the package runs without being installed."""
    try:
        return metadata.version("bearing_sim")
    except metadata.PackageNotFoundError:
        return ""


@cache
def git_hash() -> str:
    """Return the commit of the package's own checkout, with ``-dirty`` after it where files differ; ``""`` when there is none."""
    checkout = Path(__file__).resolve().parent.parent
    if not (checkout / ".git").exists():  # asking git alone would find a repository that merely contains the installation
        return ""
    command = ["git", "-C", str(checkout), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        described = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):  # no git here: the hash is not known
        return ""
    return described.stdout.strip() if described.returncode == 0 else ""


_PACKAGES = {
    "numpy": ("numpy",),
    "numba": ("numba",),
    "scipy": ("scipy",),
    "mcap": ("mcap",),
    "rclpy": ("rclpy", "ros-jazzy-rclpy", "ros-kilted-rclpy"),
}


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that a result may depend on, by name; without those that are not installed."""
    found = {"python": platform.python_version()}
    for name, distributions in _PACKAGES.items():
        for distribution in distributions:
            try:
                found[name] = metadata.version(distribution)
                break
            except metadata.PackageNotFoundError:
                continue
    return found
