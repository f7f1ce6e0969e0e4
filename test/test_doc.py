# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The documents build without a warning, and what they name exists."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("sphinx", reason="building the documents needs Sphinx (pip install 'bearing_sim[doc]')")
pytest.importorskip("myst_parser", reason="building the documents needs myst-parser (pip install 'bearing_sim[doc]')")

ROOT = Path(__file__).resolve().parents[1]
DOC = ROOT / "doc"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("doc")
    command = [sys.executable, "-m", "sphinx", "-q", "-E", "-W", "--keep-going", "-b", "html", "-d", folder / "trees", DOC, folder / "html"]
    build = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=500, check=False)
    return build, folder / "html"


@pytest.mark.long
def test_the_documents_build_without_a_warning_and_without_a_broken_internal_link(built):
    build, _ = built
    assert build.returncode == 0, build.stderr
    assert build.stderr.strip() == ""


@pytest.mark.long
def test_the_generated_reference_has_an_entry_for_what_the_code_declares(built):
    from bearing_sim.messages import topics
    from bearing_sim.model.sample import OBSERVABLES
    from bearing_sim.model.validity import BY_NAME

    _, html = built
    for page, names in {
        "observables": [observable.name for observable in OBSERVABLES],
        "topics": [*topics.INPUTS, *topics.OUTPUTS, *topics.MEASUREMENTS, *topics.ESTIMATED],
        "recording": list(topics.RECORDED),
        "scene": ["bearing.outer_raceway", "mixture_fraction", "pocket_friction", "relative_tolerance"],
        "services": ["~/reset", "~/start_recording", "~/stop_recording", "~/pause"],
        "validity": list(BY_NAME),
        "command_line": ["bearing-sim run", "bearing-sim replay", "bearing-sim calibrate", "bearing_player"],
    }.items():
        text = (html / "reference" / f"{page}.html").read_text()
        assert [name for name in names if name not in re.sub(r"<[^>]+>", "", text)] == [], page


@pytest.mark.long
def test_pages_need_no_network_and_every_equation_is_mathml(built):
    pytest.importorskip("math_core", reason="equations become MathML by math-core (pip install 'bearing_sim[doc]')")
    _, html = built
    pages = {path: path.read_text() for path in html.rglob("*.html")}
    styles = {path: path.read_text() for path in html.rglob("*.css")}
    loaded = r"<(?:script|link|img|iframe)[^>]+(?:src|href)=\"(?:https?:)?//(?![^\"]*\bcanonical)[^\"]*\"|url\([\"']?(?:https?:)?//|@import[^;]*//"
    assert [str(path) for path, text in (pages | styles).items() if re.search(loaded, text)] == []
    assert sum(text.count("<math") for text in pages.values()) > 2000
    raw = re.compile(r"\\(?:frac|begin|cdot|left|right|mathrm|qquad|dot|sum)\b")
    assert [path.name for path, text in pages.items() if raw.search(re.sub(r"<(pre|script|code)\b.*?</\1>", "", text, flags=re.DOTALL))] == []


def test_the_configuration_can_be_executed_from_another_folder_as_rosdoc2_does(tmp_path):
    (tmp_path / "conf.py").write_text(f'exec(open("{DOC / "conf.py"}").read())\nhtml_theme = "sphinx_rtd_theme"\n')
    settings = runpy.run_path(str(tmp_path / "conf.py"))
    assert settings["project"] == "bearing_sim" and "generated_reference" in settings["extensions"]
    assert [Path(folder).is_dir() for folder in settings["html_static_path"]] == [True]


PAPERS = sorted([*DOC.rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "QUALITY_DECLARATION.md"])
_PATHS = re.compile(r"(?<![\w/.])((?:bearing_sim|doc|test|launch_scripts|resource)/[\w./*-]*[\w*/])")


def test_every_path_that_a_document_names_exists():
    missing = []
    for page in PAPERS:
        for path in set(_PATHS.findall(page.read_text())):
            if not list(ROOT.glob(path.rstrip("/"))):
                missing.append(f"{page.relative_to(ROOT)}: {path}")
    assert sorted(missing) == []


def test_every_name_that_architecture_says_to_change_stands_in_its_file():
    _, _, rest = (DOC / "architecture.md").read_text().partition("## Where to change what\n")
    rows = [line for line in rest.partition("\n## ")[0].splitlines() if line.startswith("| ") and "`bearing_sim/" in line]
    checked = 0
    for row in rows:
        file = row.split("|")[2]
        (path, *_) = [path for path in _PATHS.findall(file)]
        for name in re.findall(r"`(_?[A-Z][A-Z_]+)`", file):
            checked += 1
            assert re.search(rf"^{name}\b", (ROOT / path).read_text(), re.MULTILINE), f"{name} is not in {path}"
    assert checked >= 5, "drag coefficient, topic, observable, parameter, chunk size"


def test_every_room_has_its_purpose_in_architecture():
    from test_architecture import ROOMS

    listed = re.findall(r"^\| `(\w+)` \|", (DOC / "architecture.md").read_text(), re.MULTILINE)
    assert listed == [room for room in ROOMS if room != "__init__"]


def commands(text, program="bearing-sim"):
    """Return each command of a program on a page, in code blocks and in running text."""
    blocks = re.findall(r"^```(?:bash|text)\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()] + re.findall(r"`([^`\n]+)`", text)
    return [part.strip() for line in lines for part in re.split(r"&&|;|\|", line.partition(" #")[0]) if part.strip().startswith(f"{program} ")]


def test_every_command_and_option_that_a_document_names_exists():
    import shlex

    import click

    from bearing_sim.cli.main import main

    unknown, checked = [], 0
    for page in PAPERS:
        for line in commands(page.read_text()):
            words, command = shlex.split(line)[1:], main
            while words and isinstance(command, click.Group) and not words[0].startswith("-"):
                found = command.get_command(click.Context(command), words[0])
                if found is None:
                    break
                command, words = found, words[1:]
            options = {name for parameter in command.params for name in parameter.opts + parameter.secondary_opts} | {"--help", "--version", "-h"}
            wrong = [word for word in words if re.match(r"--?[a-z]", word) and word not in options]
            wrong += words[:1] if isinstance(command, click.Group) and words and not words[0].startswith("-") else []
            unknown += [f"{page.relative_to(ROOT)}: {line}: {word}" for word in wrong]
            checked += 1
    assert unknown == [] and checked > 50


def test_every_option_of_the_player_and_every_parameter_of_the_node_that_a_document_names_exists():
    pytest.importorskip("rclpy", reason="the node needs ROS 2")
    from bearing_sim.ros.parameters import DECLARATIONS, SCENE_DECLARATIONS
    from bearing_sim.ros.player import command

    options = {"--ros-args"} | {name for parameter in command.params for name in parameter.opts + parameter.secondary_opts}
    parameters = {"use_sim_time"} | {row.name for row in (*DECLARATIONS, *SCENE_DECLARATIONS)}
    unknown, checked = [], 0
    for page in PAPERS:
        for line in (*commands(page.read_text(), "bearing_player"), *commands(page.read_text(), "bearing_node")):
            used = {*re.findall(r"(?<= )--[a-z][a-z-]*", line), *re.findall(r"-p (?:front\.|rear\.)?([\w.]+):=", line)}
            unknown += [(page.name, name) for name in used - options - parameters]
            checked += 1
    assert unknown == [] and checked > 5


def test_the_metadata_of_a_recording_has_the_documented_keys(tmp_path):
    from synthetic_run import synthetic_block

    from bearing_sim import load_scene
    from bearing_sim.recording.reader import Recording
    from bearing_sim.recording.writer import McapSink

    scene = load_scene("deng2017_table1")
    with McapSink(tmp_path / "run.mcap", scene, 10**18, seed=1, advance=(0.005, 1)) as sink:
        sink.write(synthetic_block(scene, [0.0, 1.0]))
    section = (DOC / "reference" / "recording.md").read_text().partition("## Metadata")[2].partition("\n## ")[0]
    documented = set(re.findall(r"`(\w+)`", "".join(line.split("|")[1] for line in section.splitlines() if line.startswith("| `"))))
    found = Recording(tmp_path / "run.mcap").metadata.keys()
    assert {key for key in found if not key.startswith("version_")} == {key for key in documented if not key.startswith("version_")}
    assert {key for key in documented if key.startswith("version_")} <= found


def test_the_readme_has_at_most_150_lines():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 150
