# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A front file that a scene names: the level it decides is the same on every machine, and a file that cannot decide is said."""

import hashlib
import json
import math
from unittest.mock import Mock

import pytest
import yaml
from click.testing import CliRunner

from bearing_sim import SceneError, load_scene
from bearing_sim.cli.main import main
from bearing_sim.files.kept import with_checksum
from bearing_sim.runtime.governor import settings_to_fall
from bearing_sim.scene import measured_tradeoffs
from bearing_sim.scene.loader import measured_of, scene_from_yaml, scene_to_yaml
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, add_to_front, complete_overrides, digest_of, keep, read_front
from bearing_sim.studies.trade import Errors

NAMES = Errors._fields
FILE = """\
name: rig
level: auto
wants: {slip: 0.3 %, life: 5 %}
front: rig.front.json
bearing: {preset: NU 210/C3}
lubricant: {oil: ISO VG 68, supply: oil_bath, temperature: 70 degC}
operating: {shaft_speed: 3000 rpm, radial_load: 5 kN}
"""
HERE = load_scene({**yaml.safe_load(FILE), "level": "slip", "wants": []})


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path / "cache")
    (tmp_path / "rig.yaml").write_text(FILE)
    return tmp_path


def setting(level="planar", factor=5.0, slip=0.05, overrides=(), detail="tolerances x 3"):
    errors = dict.fromkeys(NAMES, math.nan) | {"slip": slip, "largest_slip": 2.0 * slip, "life": 0.01, "window_life": 0.02}
    return Setting(level, detail, complete_overrides(load_scene(HERE, [f"level={level}", *overrides])), factor, errors)


SETTINGS = (setting(overrides=["integration.relative_tolerance=0.09"]), setting("slip", 20.0, 2.0), setting(factor=0.5, detail="tolerances x 1"))


def course(*settings, scene=HERE, name="manoeuvre"):
    speed, load, oil = abs(scene.operating.shaft_speed), scene.operating.radial_load, scene.lubricant.temperature
    extent = {"shaft_speed": (0.5 * speed, speed), "radial_load": (0.5 * load, load), "oil_temperature": (oil, oil)}
    return MeasuredCourse(name, "planar with tolerances x 0.01", dict.fromkeys(NAMES, 1e-4), extent, settings or SETTINGS)


def written(folder, scene=HERE, *settings):
    return add_to_front(folder / "rig.front.json", scene, course(*settings, scene=scene))


def stored(path):
    return json.loads(path.read_bytes())["front"]


def test_a_scene_gets_the_level_that_its_front_decides_and_says_which_file_that_was(folder):
    written(folder)
    found = load_scene(folder / "rig.yaml")
    assert found.level == "planar" and found.integration.relative_tolerance == 0.09
    assert "front rig.front.json" in found.level_reason and str(folder) not in found.level_reason and "this machine" not in found.level_reason


def test_another_machine_and_program_change_nothing_of_what_a_front_decides(folder, monkeypatch):
    written(folder)
    here = load_scene(folder / "rig.yaml")
    monkeypatch.setattr(measured_tradeoffs, "machine", lambda: "elsewhere, another processor")
    monkeypatch.setattr(measured_tradeoffs, "_program", lambda: "another version")
    keep(HERE, course(setting("slip", 20.0, 0.0001)))  # kept by that machine, which the front overrules
    assert load_scene(folder / "rig.yaml") == here


def test_a_scene_that_is_recorded_after_the_choice_needs_no_front(folder):
    written(folder)
    found = load_scene(folder / "rig.yaml")
    (folder / "rig.front.json").unlink()
    assert scene_from_yaml(scene_to_yaml(found)) == found and found.front is None


def test_the_governor_falls_along_the_front_that_the_scene_names_alone_and_also_beside_a_level_of_its_own(folder):
    fine = setting("planar", 1.5, 0.01, overrides=["integration.relative_tolerance=0.001"])
    front = written(folder, HERE, *SETTINGS, fine)
    keep(HERE, course(setting("slip", 20.0, 0.0001), fine))  # by this machine, which counts nothing beside a front that is named

    def fallen(*overrides):
        scene = load_scene(folder / "rig.yaml", [*fine.overrides, *overrides])
        measured = measured_of(folder / "rig.yaml", overrides, False, scene)
        return measured.name, [one.level for one in settings_to_fall(scene, measured) if not math.isnan(one.errors["slip"])]

    assert fallen("level=planar") == (front.name, ["planar", "planar", "slip"])
    assert fallen("level=planar", "front=null")[1] == ["planar", "slip"]
    assert fallen("level=planar", "bearing=NU 212")[1] == [], "it does not fit"
    front.path.write_bytes(b"damaged")
    with pytest.raises(ValueError, match="overwritten"):
        fallen("level=planar")


def test_a_kept_front_that_decided_is_said_by_name(folder):
    path = keep(HERE, course()).path
    reason = load_scene(folder / "rig.yaml", ["front=null"]).level_reason
    assert f"kept front {path.name}" in reason and "this bearing and machine" in reason


def refusal(folder, *overrides):
    with pytest.raises(SceneError) as error:
        load_scene(folder / "rig.yaml", overrides)
    (only,) = error.value.errors
    assert only.path == "front"
    return only.reason


def test_a_missing_front_is_an_error_that_names_the_command_which_writes_it(folder):
    reason = refusal(folder)
    assert "no such file" in reason and f"bearing-sim trade {folder / 'rig.yaml'} --front rig.front.json" in reason


@pytest.mark.parametrize("contents", [b"", b"{}", b"\0\xff", b'{"format": "bearing_sim front", "version": 3, "front": {}}', b"[" * 100_000])
def test_a_damaged_front_is_an_error(folder, contents):
    (folder / "rig.front.json").write_bytes(contents)
    assert "write it with: bearing-sim trade" in refusal(folder)


def test_every_single_changed_byte_of_a_front_is_noticed(folder):
    whole = written(folder).path.read_bytes()
    for place in range(0, len(whole) - 1, 97):
        (folder / "rig.front.json").write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises(ValueError):
            read_front(folder / "rig.front.json")


def test_a_front_outside_of_the_folder_is_not_read_unless_that_is_allowed(folder, tmp_path_factory):
    other = tmp_path_factory.mktemp("other") / "far.json"
    add_to_front(other, HERE, course())
    (folder / "rig.yaml").write_text(FILE.replace("rig.front.json", str(other)))
    assert "outside of the folder" in refusal(folder)
    assert load_scene(folder / "rig.yaml", allow_outside=True).level == "planar"
    with pytest.raises(SceneError, match="cannot name others"):
        scene_from_yaml(FILE)


def rewritten(folder, change):
    written(folder)
    contents = stored(folder / "rig.front.json")
    change(contents["courses"][0])
    (folder / "rig.front.json").write_bytes(with_checksum("front", 3, contents))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda one: one["settings"][0].update(overrides=["bearing.outer_raceway.contour_file=/etc/passwd"]), "which is no setting"),
        (lambda one: one["settings"][0].update(overrides=["level=slip"]), "which is no setting"),
        (lambda one: one["settings"][0].update(real_time_factor=-1.0), "-1.0"),
        (lambda one: one["settings"][0].update(real_time_factor="fast"), "something else"),
        (lambda one: one["settings"][0]["errors"].update(slip=-0.1), "-0.1"),
        (lambda one: one["settings"][0]["errors"].pop("largest_slip"), "largest_slip"),
        (lambda one: one["extent"].pop("radial_load"), "radial_load"),
        (lambda one: one.update(settings=None), "something else"),
    ],
)
def test_a_front_of_sound_checksum_that_holds_what_no_trade_writes_is_refused(folder, change, words):
    rewritten(folder, change)
    assert words in refusal(folder)


@pytest.mark.parametrize("number", [b"NaN", b"Infinity"])
def test_no_number_of_a_front_may_be_nan_or_infinite(folder, number):
    contents = written(folder).path.read_bytes().partition(b', "front": ')[2].removesuffix(b"}\n")
    contents = contents.replace(b'"real_time_factor": 5.0', b'"real_time_factor": ' + number)
    assert number in contents
    head = {"format": "bearing_sim front", "version": 3, "checksum": hashlib.sha256(b"3 " + contents).hexdigest()}
    (folder / "rig.front.json").write_bytes(json.dumps(head).encode()[:-1] + b', "front": ' + contents + b"}\n")
    assert "where a number that is not negative belongs" in refusal(folder)


def test_a_front_has_the_errors_that_a_trade_measures():
    assert measured_tradeoffs.ERRORS == NAMES


def test_an_error_that_was_not_measured_keeps_no_want(folder):
    rewritten(folder, lambda one: [each["errors"].update(life=None) for each in one["settings"]])
    found = load_scene(folder / "rig.yaml")
    assert found.level == "planar" and "no setting measured on manoeuvre (front rig.front.json) keeps them" in found.level_reason


@pytest.mark.parametrize(
    "override",
    ["bearing=NU 212", "bearing.roller.count=13", "bearing.outer_raceway.d_value=60 um", "lubricant.oil=ISO VG 100", "life.a_iso=bath_17_14"],
)
def test_a_front_of_another_bearing_oil_or_life_decides_nothing_and_that_is_said(folder, override):
    written(folder)
    found = load_scene(folder / "rig.yaml", [override])
    assert found.level == "planar" and found.integration == HERE.integration
    assert "front rig.front.json was measured on another bearing" in found.level_reason and "--front FILE" in found.level_reason


def test_a_front_of_a_bearing_whose_rollers_are_no_multiple_of_its_lobes_fits_that_bearing_alone(folder):
    odd = load_scene(HERE, ["bearing.roller.count=13", "bearing.outer_raceway.lobes=3", "bearing.outer_raceway.d_value=60 um"])
    written(folder, odd, *SETTINGS)
    fitting = ["bearing.roller.count=13", "bearing.outer_raceway.lobes=3", "bearing.outer_raceway.d_value=60 um"]
    assert load_scene(folder / "rig.yaml", fitting).integration.relative_tolerance == 0.09
    assert "another bearing" in load_scene(folder / "rig.yaml", ["bearing.roller.count=12", *fitting[1:]]).level_reason
    assert "another bearing" in load_scene(folder / "rig.yaml").level_reason


def test_a_front_measured_elsewhere_decides_nothing_here(folder):
    written(folder)
    reason = load_scene(folder / "rig.yaml", ["operating.radial_load=20 kN"]).level_reason
    assert "in front rig.front.json errors were measured elsewhere" in reason and "--front rig.front.json" in reason


def test_a_front_without_wanted_errors_is_an_error_and_beside_a_level_of_its_own_it_is_not_read(folder):
    written(folder)
    assert "nothing is wanted with an error" in refusal(folder, "wants=[life]")
    (folder / "rig.front.json").unlink()
    assert load_scene(folder / "rig.yaml", ["level=slip"]).front is None
    with pytest.raises(SceneError, match="front"):
        load_scene(folder / "rig.yaml", ["front=5", "level=slip"])


def test_what_a_front_fits_does_not_hang_on_last_digits_operating_points_and_settings():
    same = ["integration.relative_tolerance=0.001", "operating.radial_load=1 kN", "operating.shaft_speed=100 rpm", "level=planar"]
    assert digest_of(load_scene(HERE, same)) == digest_of(HERE)
    length = HERE.bearing.roller.length
    assert digest_of(HERE.at({"bearing.roller.length": math.nextafter(length, 1.0)})) == digest_of(HERE)
    assert digest_of(HERE.at({"bearing.roller.length": length * (1.0 + 1e-6)})) != digest_of(HERE)


def trade(monkeypatch, folder, *words, settings=SETTINGS, **more):
    from bearing_sim.studies import trade as study

    measured = [
        study.Traded(study.Candidate(one.level, one.detail, ()), one.real_time_factor, Errors(**one.errors), "", one.overrides) for one in settings
    ]
    found = study.Trade(measured, study.front_of(measured), "planar", Errors(*[1e-4] * 8), study.built_in("manoeuvre", HERE), {}, **more)
    monkeypatch.setattr(study, "trade", Mock(return_value=found))
    return CliRunner().invoke(main, ["trade", str(folder / "rig.yaml"), *map(str, words)])


def test_trade_writes_a_front_that_the_scene_then_chooses_by_and_adds_to_it(folder, monkeypatch):
    path = folder / "rig.front.json"
    result = trade(monkeypatch, folder, "--front", path, "--no-keep")  # the scene names it, and it is not there yet
    assert result.exit_code == 0, result.output
    assert f"added to {path} (manoeuvre)" in result.output and not (folder / "cache").exists()
    assert load_scene(folder / "rig.yaml").integration.relative_tolerance == 0.09
    assert trade(monkeypatch, folder, "--front", path, "--no-keep").exit_code == 0
    assert len(read_front(path).courses) == 1


def test_trade_refuses_before_it_measures_a_front_of_something_else(folder, monkeypatch):
    path = written(folder, load_scene(HERE, ["bearing=NU 212"])).path
    before = path.read_bytes()
    result = trade(monkeypatch, folder, "--front", path)
    assert result.exit_code == 2 and "was measured on another bearing" in result.output and path.read_bytes() == before
    path.write_bytes(b"notes of mine")
    assert trade(monkeypatch, folder, "--front", path).exit_code == 2 and path.read_bytes() == b"notes of mine"
    result = trade(monkeypatch, folder, "--front", folder / "new.json", "--against", "slip")
    assert result.exit_code == 2 and "new.json: errors against level slip say nothing of what it leaves out" in result.output
    assert "there is no folder" in trade(monkeypatch, folder, "--front", folder / "absent" / "new.json").output
    assert "--quick measures too little" in trade(monkeypatch, folder, "--front", folder / "new.json", "--quick").output


@pytest.mark.parametrize("words", [(), ("--error", 0.1), ("--factor", 3)])
def test_trade_writes_the_chosen_setting_as_fields_of_a_scene(folder, monkeypatch, words):
    out = folder / "chosen.yaml"
    result = trade(monkeypatch, folder, "--chosen", out, "--no-keep", *words, settings=SETTINGS[::-1])
    assert result.exit_code == 0, result.output
    fields = yaml.safe_load(out.read_text())
    tree = {**yaml.safe_load(FILE), **fields, "front": None, "wants": []}
    assert load_scene(tree).integration.relative_tolerance == 0.09 and load_scene(tree).level == "planar"
    assert "bearing-sim trade on manoeuvre" in out.read_text()


def test_trade_writes_no_setting_where_nothing_is_chosen_by_or_none_is_good_enough(folder, monkeypatch):
    out = folder / "chosen.yaml"
    result = trade(monkeypatch, folder, "--chosen", out, "--set", "wants=[life]", "--set", "level=slip")
    assert result.exit_code == 2 and "nothing says what to choose by" in result.output
    result = trade(monkeypatch, folder, "--chosen", out, "--error", 1e-9, "--no-keep")
    assert result.exit_code == 1 and "no setting is that fast and that accurate" in result.output and not out.exists()


def test_what_trade_has_measured_is_told_also_where_front_and_chosen_setting_cannot_be_written(folder, monkeypatch):
    front, out = folder / "other.json", folder / "chosen.yaml"
    monkeypatch.setattr(measured_tradeoffs, "replaced", Mock(side_effect=OSError("the disk is full")))
    result = trade(monkeypatch, folder, "--front", front, "--json", "--no-keep")
    assert result.exit_code == 1 and f"{front} is not written: the disk is full" in result.stderr and not front.exists()
    assert len(json.loads(result.stdout)["settings"]) == len(SETTINGS)
    result = trade(monkeypatch, folder, "--chosen", out, "--error", 1e-9, "--no-keep")
    assert "tolerances x 3" in result.stdout
