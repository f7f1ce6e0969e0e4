# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The package's papers agree: package.xml, setup.py, setup.cfg, the changelog, and what lies at the top."""

import ast
import configparser
import fnmatch
import os
import re
from pathlib import Path

import pytest
import yaml

catkin_package = pytest.importorskip("catkin_pkg.package", reason="catkin_pkg reads package.xml and the changelog; it comes with colcon")
from catkin_pkg.changelog import get_changelog_from_path  # noqa: E402

from bearing_sim.files.extras import EXTRAS, what_is_missing  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
TOP_LEVEL = {
    *("package.xml", "setup.py", "setup.cfg", "bearing_sim", "launch_scripts", "test", "resource"),
    *("README.md", "LICENSE", "CHANGELOG.rst", "QUALITY_DECLARATION.md"),
    *("doc", "examples", "CONTRIBUTING.md", "CITATION.cff", "MANIFEST.in"),
}
KEYS = {
    "PyYAML": "python3-yaml",
    "pillow": "python3-pil",
    "lz4": "mcap-ros2-support",
    "mcap": "mcap-ros2-support",
    "mcap-ros2-support": "mcap-ros2-support",
    "rosbags": "python3-rosbags-pip",
    "zstandard": "mcap-ros2-support",
}
DISTRIBUTIONS = {"PIL": "pillow", "nptdms": "npTDMS", "rerun": "rerun-sdk", "rclpy": "ros-jazzy-rclpy"} | {
    name: f"ros-jazzy-{name.replace('_', '-')}" for name in ("std_msgs", "std_srvs", "sensor_msgs", "geometry_msgs", "diagnostic_msgs")
}
STANDARD_ROS = {"rclpy", "rcl_interfaces", "launch", "launch_ros"}


@pytest.fixture(scope="module")
def package():
    warnings = []
    found = catkin_package.parse_package(str(ROOT / "package.xml"), warnings=warnings)
    found.validate(warnings=warnings)
    assert warnings == []
    return found


def _setup(keyword):
    """Return the value of a keyword of setup() in setup.py."""
    (call,) = [
        node
        for node in ast.walk(ast.parse((ROOT / "setup.py").read_text()))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "setup"
    ]
    return {argument.arg: argument.value for argument in call.keywords}[keyword]


def _assigned(name):
    """Return what setup.py assigns to a name before it calls setup()."""
    tree = ast.parse((ROOT / "setup.py").read_text())
    before = [node for node in tree.body if isinstance(node, (ast.Assign, ast.ImportFrom)) and "setuptools" not in ast.dump(node)]
    found = {}
    exec(compile(ast.Module(before, []), "setup.py", "exec"), found)
    return found[name]


def test_package_xml_is_of_format_3_and_known_as_a_ros_package(package):
    assert package.package_format == 3 and package.get_build_type() == "ament_python"
    # colcon takes a package with an address that it does not like for plain Python, without a word
    assert all(re.fullmatch(r"[\w.+-]+@[\w-]+(\.[\w-]+)*\.[a-z]{2,}", maintainer.email) for maintainer in package.maintainers)


def test_versions_names_and_licences_agree(package):
    assert package.version == ast.literal_eval(_setup("version"))
    assert package.name == "bearing_sim" and (ROOT / "resource" / package.name).is_file()
    assert package.licenses == [ast.literal_eval(_setup("license"))] == ["Apache-2.0"]
    assert "Apache License" in (ROOT / "LICENSE").read_text()
    assert package.description == ast.literal_eval(_setup("description"))
    assert [maintainer.email for maintainer in package.maintainers] == [ast.literal_eval(_setup("maintainer_email"))]


def test_the_citation_names_the_version_the_licence_and_the_paper(package):
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert (citation["title"], citation["version"], citation["license"]) == (package.name, package.version, package.licenses[0])
    assert [reference["doi"] for reference in citation["references"]] == ["10.1016/j.cja.2017.07.001"]


def test_every_data_file_of_the_package_is_installed():
    package = ROOT / "bearing_sim"
    (declared,) = (
        ast.literal_eval(keyword.value.values[0])
        for keyword in ast.walk(ast.parse((ROOT / "setup.py").read_text()))
        if isinstance(keyword, ast.keyword) and keyword.arg == "package_data"
    )
    installed = {path for pattern in declared for path in package.glob(pattern)}
    data = {path for path in package.rglob("*") if path.is_file() and path.suffix not in (".py", ".pyc")}
    assert data and not data - installed
    assert all(any(package.glob(pattern)) for pattern in declared)


def test_the_changelog_can_be_read_and_its_newest_version_is_the_packages(package):
    changelog = get_changelog_from_path(str(ROOT), package.name)
    versions = [version for version, _, _ in changelog.foreach_version()]
    assert versions[0] == package.version and len(set(versions)) == len(versions)
    for version, date, entries in changelog.foreach_version():
        assert date is not None and entries, version


def test_every_ros_package_that_is_imported_or_spoken_is_declared(package):
    declared = {dependency.name for dependency in package.exec_depends}
    used = set()
    for path in [*(ROOT / "bearing_sim").rglob("*.py"), *(ROOT / "launch_scripts").glob("*.py")]:
        text = path.read_text()
        used |= set(re.findall(r"\b([a-z_]+)/(?:msg|srv)/[A-Z]", text))
        for node in ast.walk(ast.parse(text)):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [n.name for n in node.names] if isinstance(node, ast.Import) else []
            tops = {name.partition(".")[0] for name in names}
            used |= {top for top in tops if top in STANDARD_ROS or top.endswith(("_msgs", "_srvs"))}
    used -= {"builtin_interfaces", "package"}  # part of every message; the word of a docstring
    used -= {"nav_msgs", "visualization_msgs"}  # named to say what a view of another program's recording leaves out
    assert {"rclpy", "sensor_msgs", "launch_ros"} <= used <= declared


def test_every_python_requirement_has_its_key_or_is_told_to_have_none(package):
    requirements = [item.value for item in _setup("install_requires").elts if isinstance(item, ast.Constant)]
    (without,) = re.findall(r"Without a rosdep key[^:]*: ([^.]*)\.", (ROOT / "package.xml").read_text())
    keys, without = {dependency.name for dependency in package.exec_depends}, set(without.split(", "))
    for requirement in requirements:
        name = re.match(r"[\w-]+", requirement)[0]
        assert (KEYS.get(name, f"python3-{name}") in keys) != (name in without), f"{name}: declare its rosdep key, or say that it has none"


def test_every_package_of_an_extra_is_named_where_one_is_missing():
    optional = _assigned("optional")
    assert set(optional) == set(EXTRAS)
    for extra, requirements in optional.items():
        found = {re.match(r"[\w-]+", requirement)[0] for requirement in requirements}
        imported = {DISTRIBUTIONS.get(name, name) for name in EXTRAS[extra]}
        assert found <= imported, f"{extra}: {found - imported}"


def test_what_no_extra_has_is_an_error_of_the_program():
    assert what_is_missing(ModuleNotFoundError("", name="rerun.blueprint")) == "rerun is not installed: pip install 'bearing_sim[view]'"
    assert "ROS 2" in what_is_missing(ModuleNotFoundError("", name="rclpy"))
    with pytest.raises(ModuleNotFoundError):
        what_is_missing(ModuleNotFoundError("", name="bearing_sim.misspelt"))


@pytest.mark.parametrize(
    ("machine", "said"), [("x86_64", r"pip install 'bearing_sim\[ros\]', or source"), ("aarch64", "no wheels of ROS 2 .*with apt")]
)
def test_a_program_without_ros_says_how_this_machine_gets_it(machine, said, monkeypatch):
    monkeypatch.setattr("platform.machine", lambda: machine)
    monkeypatch.setattr("platform.system", lambda: "Linux")
    assert re.search(f"rclpy is not installed: .*{said}", what_is_missing(ModuleNotFoundError("", name="rclpy")))


def test_programs_are_on_the_path_and_where_ros_looks_for_them():
    config = configparser.ConfigParser()
    config.read(ROOT / "setup.cfg")
    assert dict(config["develop"]) == {"script_dir": "$base/bin"}
    assert dict(config["install"]) == {"install_scripts": "$base/bin"}
    points = {point.partition(" = ")[0] for point in ast.literal_eval(_setup("entry_points"))["console_scripts"]}
    found = list((ROOT / "launch_scripts" / "libexec").iterdir())
    assert {path.name for path in found} == points and all(os.access(path, os.X_OK) for path in found)


def test_nothing_optional_is_imported_at_the_top_of_what_the_node_imports():
    rooms = ("scene", "model", "levels", "messages", "inputs", "monitoring", "runtime", "ros")
    optional = {package for extra, packages in EXTRAS.items() if extra != "ros" for package in packages}
    for path in (path for room in rooms for path in ROOT.glob(f"bearing_sim/{room}/**/*.py")):
        for node in ast.parse(path.read_text()).body:
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [n.name for n in node.names] if isinstance(node, ast.Import) else []
            assert not optional & {name.partition(".")[0] for name in names}, path


def test_nothing_unusual_lies_at_the_top():
    ignored = [line.strip("/") for line in (ROOT / ".gitignore").read_text().split()]
    found = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    assert {name for name in found if not any(fnmatch.fnmatch(name, pattern) for pattern in ignored)} <= TOP_LEVEL


def test_the_quality_declaration_claims_no_more_than_level_4():
    text = (ROOT / "QUALITY_DECLARATION.md").read_text()
    assert "**Quality Level 4**" in text and not re.search(r"claims \*\*Quality Level [123]", text)


def test_on_several_cores_the_tests_of_a_group_stay_on_one_worker(request):
    if hasattr(request.config, "workerinput"):
        assert request.node.nodeid.endswith("@test_package"), "this pytest-xdist does not understand this pytest"
