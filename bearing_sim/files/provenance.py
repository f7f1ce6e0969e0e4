# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where a result comes from: version and git hash of this package, and nothing about the machine."""

import platform
import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path


@cache
def package_version() -> str:
    """Return the installed version; ``""`` if the package is not installed."""
    try:
        return metadata.version("bearing_sim")
    except metadata.PackageNotFoundError:
        return ""


@cache
def git_hash() -> str:
    """Return the commit of the package's own checkout, followed by ``-dirty`` if files differ; ``""`` without a checkout."""
    checkout = Path(__file__).resolve().parents[2]
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
    "rclpy": ("rclpy", "ros-jazzy-rclpy", "ros-kilted-rclpy"),
}


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of the installed packages on which a result may depend, by name."""
    found = {"python": platform.python_version()}
    for name, distributions in _PACKAGES.items():
        for distribution in distributions:
            try:
                found[name] = metadata.version(distribution)
                break
            except metadata.PackageNotFoundError:
                continue
    return found
