# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What trades keep of a bearing: found again by what errors depend on, merged over courses, whole or not at all."""

import json
import math
import multiprocessing
from unittest.mock import Mock

import pytest
from click.testing import CliRunner

from bearing_sim import load_scene
from bearing_sim.cli.main import main
from bearing_sim.scene import measured_tradeoffs
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, complete_overrides, keep, kept_path, read_kept_tradeoffs
from bearing_sim.studies.trade import Errors, settings_of

NAMES = Errors._fields
EXTENT = {"shaft_speed": (1000.0, 5000.0), "radial_load": (400.0, 800.0), "oil_temperature": (370.0, 380.0)}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path / "fronts")
    return tmp_path / "fronts"


def scene(*overrides):
    return load_scene("deng2017_table1", overrides)


def setting(level, factor, slip, life=0.01, detail="tolerances x 1", overrides=()):
    errors = dict.fromkeys(NAMES, math.nan) | {"slip": slip, "largest_slip": 2.0 * slip, "life": life, "window_life": 2.0 * life}
    return Setting(level, detail, tuple(overrides), factor, errors)


def course(name, *settings, extent=EXTENT, reference="planar with tolerances x 0.01", own=0.001):
    return MeasuredCourse(name, reference, dict.fromkeys(NAMES, own), extent, settings)


def same(one, other):
    return repr(one) == repr(other)  # NaN is not equal to itself


def test_what_is_kept_is_read_again():
    one = course("idle", setting("slip", 12.0, 1.9), setting("planar", 5.0, 0.05, overrides=["integration.relative_tolerance=0.03"]))
    keep(scene(), one)
    (found,) = read_kept_tradeoffs(scene()).courses
    assert same(found, one)


@pytest.mark.parametrize(
    ("override", "is_same"),
    [
        ("level=planar", True),
        ("integration.relative_tolerance=0.003", True),
        ("bearing.roller.slices=50", True),
        ("operating.shaft_speed=1000 rpm", True),
        ("operating.radial_load=100 N", True),
        ("lubricant.temperature=60 degC", True),
        ("table.correction=planar", True),
        ("table.maximum_speed=46000 rpm", False),
        ("bearing.roller.count=17", False),
        ("bearing.cage.pocket_clearance=0.3 mm", False),
        ("lubricant.mixture_fraction=0.02", False),
        ("life.reliability=99 %", False),
    ],
)
def test_a_front_belongs_to_bearing_and_oil_and_not_to_what_a_setting_or_a_course_changes(override, is_same):
    assert (kept_path(scene(override)) == kept_path(scene())) == is_same


def test_another_machine_or_program_has_a_front_of_its_own(monkeypatch):
    paths = {kept_path(scene())}
    monkeypatch.setattr(measured_tradeoffs, "machine", lambda: "another machine, another processor")
    paths.add(kept_path(scene()))
    monkeypatch.setattr(measured_tradeoffs, "_program", lambda: "another program")
    paths.add(kept_path(scene()))
    assert len(paths) == 3


def test_a_recorded_scene_finds_the_front_of_its_bearing():
    assert kept_path(scene_from_yaml(scene_to_yaml(scene("level=planar")))) == kept_path(scene())


def test_courses_are_merged_and_settings_measured_again_are_replaced():
    keep(scene(), course("idle", setting("slip", 12.0, 1.9), setting("planar", 5.0, 0.05)))
    keep(scene(), course("start", setting("slip", 11.0, 2.5)))
    front = keep(scene(), course("idle", setting("planar", 4.0, 0.04)))
    assert [each.name for each in front.courses] == ["start", "idle"]
    assert {one.level: one.real_time_factor for one in front.courses[1].settings} == {"slip": 12.0, "planar": 4.0}
    front = keep(scene(), course("idle", setting("planar", 3.0, 0.2), reference="spatial with tolerances x 0.01"))
    assert [one.level for one in front.courses[1].settings] == ["planar"]  # errors against another reference say another thing
    assert same(read_kept_tradeoffs(scene()).courses, front.courses)


def test_of_several_courses_the_worst_counts_and_what_one_lacks_is_not_known():
    keep(scene(), course("idle", setting("slip", 12.0, 1.9), setting("planar", 5.0, 0.05), setting("steady", 900.0, 2.0)))
    front = keep(scene(), course("start", setting("slip", 9.0, 2.5), setting("planar", 6.0, 0.02)))
    found = {one.level: (one.real_time_factor, one.errors["slip"]) for one in front.settings()}
    assert found == {"slip": (9.0, 2.5), "planar": (5.0, 0.05)}


def test_a_course_holds_where_it_was_measured():
    one = course("idle")
    inside = ("operating.shaft_speed=2000 rad/s", "operating.radial_load=500 N", "lubricant.temperature=375 K")
    assert one.covers(scene(*inside))
    assert one.covers(scene(*inside, "operating.radial_load=900 N"))  # nearly so
    for outside in ("operating.radial_load=2 kN", "operating.shaft_speed=9000 rad/s", "lubricant.temperature=60 degC"):
        assert not one.covers(scene(*inside, outside))
    assert one.covers(scene(*inside, "operating.shaft_speed=-2000 rad/s"))


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"format": 99, "courses": []}', b'{"format": 1, "courses": [{"name": "a"}]}', b"\xff\xfe"])
def test_a_file_that_is_not_whole_counts_as_none(folder, content):
    folder.mkdir()
    kept_path(scene()).write_bytes(content)
    assert read_kept_tradeoffs(scene()) is None
    assert keep(scene(), course("idle")).courses[0].name == "idle"  # and is replaced


def _keep_one(folder, number):
    measured_tradeoffs.FOLDER = folder
    keep(load_scene("deng2017_table1"), course(f"log {number}", setting("slip", 10.0, number)))


def test_trades_that_end_at_the_same_time_lose_nothing(folder):
    folder.mkdir()
    processes = [multiprocessing.get_context("fork").Process(target=_keep_one, args=(folder, number)) for number in range(6)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(60)
    assert {each.name for each in read_kept_tradeoffs(scene()).courses} == {f"log {number}" for number in range(6)}


def test_complete_overrides_give_any_scene_the_settings_of_the_measured_one():
    for one in (*settings_of("spatial"), *settings_of("planar"), *settings_of("steady")):
        measured = scene(f"level={one.level}", *one.overrides)
        other = scene(f"level={one.level}", "integration.relative_tolerance=0.5", "bearing.roller.slices=7", *complete_overrides(measured))
        if one.level == "steady":
            continue  # takes no steps
        assert other.integration == measured.integration
        assert one.level != "spatial" or other.bearing.roller.slices == measured.bearing.roller.slices


WORDS = ("trade", "deng2017_table1", "--course", "start", "--level", "slip", "--workers", "1", "--json")


@pytest.mark.long
def test_a_trade_says_where_it_is_kept_unless_it_is_not(folder, monkeypatch):
    monkeypatch.setattr("bearing_sim.studies.trade._FACTORS", (1.0,))
    monkeypatch.setattr("bearing_sim.studies.trade._REFERENCE", 0.1)
    result = CliRunner().invoke(main, [*WORDS, "--no-keep"])
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["kept"] is None and not folder.exists()
    result = CliRunner().invoke(main, [*WORDS, "--quick"])
    assert json.loads(result.stdout)["kept"] is None and not folder.exists()
    result = CliRunner().invoke(main, list(WORDS))
    report = json.loads(result.stdout)
    assert report["kept"] == str(kept_path(scene()))
    (one,) = read_kept_tradeoffs(scene()).courses
    assert one.name == "start" and one.extent["shaft_speed"][1] == pytest.approx(scene().operating.shaft_speed)
    assert {each.detail: each.real_time_factor for each in one.settings} == {
        each["setting"]: pytest.approx(each["real_time_factor"]) for each in report["settings"]
    }


@pytest.mark.long
def test_errors_against_a_level_that_leaves_something_out_are_not_kept(folder):
    result = CliRunner().invoke(main, [*WORDS, "--against", "slip"])
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["kept"] is None and not folder.exists()
    assert "not kept: errors against level slip say nothing of what it leaves out" in result.stderr


def test_a_folder_that_cannot_be_written_is_a_warning(folder, monkeypatch):
    folder.write_text("a file stands where the folder should be")
    from bearing_sim.cli import trade as command

    monkeypatch.setattr("bearing_sim.studies.trade.measured_course", lambda found: course("idle"))
    said = []
    monkeypatch.setattr(command.click, "echo", lambda text, err=False: said.append(text))
    assert command._keep(scene(), Mock(is_complete=True)) is None
    assert said[0].startswith("warning: the settings are not kept: ")
