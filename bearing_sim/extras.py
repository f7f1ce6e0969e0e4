# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Packages that only some commands need: by which extra of bearing_sim each is installed.

The smallest installation runs the node, records and replays.  What needs more imports it when it is used, and says what is missing.
"""

EXTRAS = {
    "view": ("rerun", "PIL"),
    "tables": ("pandas", "xarray", "pyarrow"),
    "plot": ("matplotlib",),
    "terminal": ("rich",),
    "vibration": ("h5py",),
    "dask": ("dask", "distributed"),
    "ros": ("rclpy", "rcl_interfaces", "rosgraph_msgs", "std_msgs", "std_srvs", "sensor_msgs", "geometry_msgs", "diagnostic_msgs"),
}
"""Import names of packages, by extra; ``full`` has all of them."""


def what_is_missing(error: ModuleNotFoundError) -> str:
    """Return which package is not installed and how to install it; raise the error if it is not a package of an extra."""
    package = (error.name or "").partition(".")[0]
    for extra, packages in EXTRAS.items():
        if package in packages:
            sourced = ", or source the setup file of a ROS 2 installation" if extra == "ros" else ""
            return f"{package} is not installed: pip install 'bearing_sim[{extra}]'{sourced}"
    raise error
