# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Packages that only some commands need: by which extra of bearing_sim each is installed.

The smallest installation runs the node, records and replays.  What needs more imports it when it is used, and says what is missing.
"""

import platform

EXTRAS = {
    "view": ("rerun", "PIL"),
    "tables": ("openpyxl", "pandas", "xarray", "pyarrow"),
    "plot": ("matplotlib",),
    "terminal": ("rich",),
    "vibration": ("h5py", "pyuff"),
    "tdms": ("nptdms",),
    "dask": ("dask", "distributed"),
    "ros": ("rclpy", "rcl_interfaces", "rosgraph_msgs", "std_msgs", "std_srvs", "sensor_msgs", "geometry_msgs", "diagnostic_msgs"),
}
"""Import names of packages, by extra; ``full`` has all of them."""


def what_is_missing(error: ModuleNotFoundError) -> str:
    """Return which package is not installed and how to install it; raise the error if it is not a package of an extra."""
    package = (error.name or "").partition(".")[0]
    for extra, packages in EXTRAS.items():
        if package in packages:
            return f"{package} is not installed: {_how_to_install_ros() if extra == 'ros' else _by_pip(extra)}"
    raise error


def _by_pip(extra: str) -> str:
    return f"pip install 'bearing_sim[{extra}]'"


def _how_to_install_ros() -> str:
    """Return how this machine gets ROS 2: from wheels, as setup.py does, or only with the system's packages."""
    if (platform.system(), platform.machine()) == ("Linux", "x86_64"):
        return f"{_by_pip('ros')}, or source the setup file of a ROS 2 installation"
    return (
        f"there are no wheels of ROS 2 for {platform.system()} on {platform.machine()}; install it with apt (ros-jazzy-ros-base) and "
        "source its setup file; everything but the node, the player and the demo works without ROS 2"
    )
