# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The Python interface: settled states, sweeps, operating points and inputs with units, copies of simulations, and types."""

import copy
import dataclasses
import inspect
import math
import os
import pickle
import re
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from generate_names import STUB, stub
from scipy.optimize import brentq

import bearing_sim
from bearing_sim import Inputs, SceneError, Settled, Simulation, load_scene, run_sweep, settle
from bearing_sim.scene.fidelity import WANTS, WantName
from bearing_sim.scene.fields import blocks
from bearing_sim.scene.requirements import MEASURED
from bearing_sim.scene.scene import OPERATING_POINT, WantedError
from bearing_sim.simulation import scene_inputs
from bearing_sim.studies.uncertainty_propagation import UncertaintyError, study
from bearing_sim.sweep.grid import FieldError, axis, read_axis
from bearing_sim.sweep.point import point_row
from bearing_sim.sweep.tasks import Execution

ROOT = Path(__file__).resolve().parents[1]
PUBLIC = sorted(
    "FieldError Inputs IntegrationError Level OBSERVABLES PartialRecording Recording RecordingError Scene SceneError Settled Simulation Table "
    "UncertaintyError load_scene run_sweep scene_fields settle to_pandas to_xarray".split()
)
# What a type checker accepts, lines each of which it refuses with these words, and what it knows of the types of expressions.
ACCEPTED = """
import numpy as np
from bearing_sim import Inputs, Level, Recording, Scene, Settled, Simulation, Table, load_scene, run_sweep, settle, to_pandas

scene: Scene = load_scene("deng2017_table1", ["level=steady"])
scene = load_scene({"name": "x"}, {"operating": {"radial_load": 800.0}, "bearing.clearance": "40 um"})
level: Level = scene.level
result: Settled = settle(scene, "planar", shaft_speed=4000.0, radial_load="5 kN")
slip: float = result.cage_slip
largest: float = result.inner_load.max()
block = Simulation(scene).advance("10 ms", Inputs.of(shaft_speed="3000 rpm", oil_temperature=350.0), samples=3)
to_pandas(block, ["cage_slip", "inner_load"])
table: Table = run_sweep(scene, {"radial_load": [100.0, "200 N"]}, level="steady")
table = run_sweep(scene, [{"radial_load": 100.0, "bearing.clearance": "C3"}], {"level": "steady"})
temperature: float = result.sample["oil_temperature"]
for item in Recording("run.mcap"):
    print(item)
for name in ("cage_slip", "inner_load"):
    print(block[name].mean(), np.concatenate([block, block])[name])
again = Simulation(scene, start=block[-1])
"""
REFUSED = {
    "result.cage_slp": 'has no attribute "cage_slp"',
    "result.inner_load.mx()": 'has no attribute "mx"',
    "scene.bearing.rollr": 'has no attribute "rollr"',
    "scene.operating.speed": 'has no attribute "speed"',
    'settle(scene, "plannar")': "plannar",
    'scene.at_level("plannar")': "plannar",
    'run_sweep(scene, {"radial_load": [1.0]}, level="plannar")': "plannar",
    'settle(scene, start="skidding")': "skidding",
    "settle(scene, shaft_speed=[1.0, 2.0])": "list[float]",
    "settle(scene, speed=3.0)": '"speed"',
    'load_scene("deng2017_table1", "level=steady")': 'incompatible type "str"',
    'load_scene("deng2017_table1", [3])': 'incompatible type "int"',
    "load_scene(3)": 'incompatible type "int"',
    'Simulation("deng2017_table1")': 'incompatible type "str"',
    'Simulation(scene).advance(0.1, {"radial_load": 3.0})': "incompatible type",
    'to_pandas(block, "cage_slip")': 'incompatible type "str"',
    'to_pandas(block, ["cage_slp"])': "List item 0 has incompatible type",
    "run_sweep(scene, 3)": 'incompatible type "int"',
    "table.to_panda()": 'has no attribute "to_panda"',
    "import bearing_sim; bearing_sim.settl": 'has no attribute "settl"',
    "scene.bearing.roller.diameter.mm": '"float" has no attribute "mm"',
    'scene.bearing.cage.guide_radius + "1 mm"': "Unsupported",
    "scene.operating.radial_load.upper()": '"float" has no attribute "upper"',
    'result.verdict == "setled"': "Non-overlapping equality check",
    "result.sample.cage_slip": 'has no attribute "cage_slip"',
    "block[0].at": 'has no attribute "at"',
}
REVEALED = {
    "scene.operating.shaft_speed": "float",
    "scene.bearing.roller.count": "int",
    "scene.bearing.cage.guide_radius": "float | None",
    "scene.lubricant.temperature": "float",
    "scene.table.correction": "Literal['none'] | Literal['planar']",
    "result.cage_slip": "float",
    "result.settled": "bool",
    "result.start": "Literal['rolling'] | Literal['skid'] | Literal['nearby']",
    'result.bands["cage_slip"].low': "float",
    'result.sample["oil_temperature"]': "numpy.float64",
    'result.sample["inner_load"]': "ndarray",
    "result.window": "Block",
    "block[0]": "Sample",
    "block[1:]": "Block",
    'block["cage_slip"]': "numpy.float64",
    "table.rows[0]": "dict[str, Any]",
    "table.columns[0].unit": "str",
    'Recording("run.mcap").scene': "Scene",
    'next(iter(Recording("run.mcap")))': "Block | ",
}
MOTOR = {
    "name": "motor",
    "bearing": "NU 210/C3",
    "lubricant": {"oil": "ISO VG 68", "temperature": "70 degC", "supply": "oil_bath"},
    "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"},
}
PAPER, PAPER_STEADY = "deng2017_table1", ["level=steady"]
ROUND = ["bearing.outer_raceway.d_value=0 um", "bearing.outer_raceway.low_radius=34.88 mm"]


@pytest.fixture(scope="module")
def motor():
    return load_scene(MOTOR)


@pytest.fixture(scope="module")
def paper():
    return load_scene(PAPER, PAPER_STEADY)


# Scenes at other operating points.


def test_a_scene_at_another_operating_point_is_that_of_the_overrides(paper):
    changed = paper.at(shaft_speed="30000 rpm", radial_load="0.5 kN", load_angle="90 deg", oil_temperature="100 degC")
    overrides = [f"{OPERATING_POINT['shaft_speed']}=30000 rpm", "operating.radial_load=500", "operating.load_angle=90 deg"]
    assert changed == load_scene(PAPER, [*PAPER_STEADY, *overrides, "lubricant.temperature=100 degC"])
    assert paper.at(radial_load=np.float64(500.0)).at(radial_load=np.int64(800)) == paper.at(), "numbers of NumPy are numbers in SI"


@pytest.mark.parametrize(
    ("path", "value"), [("bearing.clearance", "C4"), ("bearing.clearance", 4e-5), ("bearing.inner_raceway.bore_diameter", "49.9 mm")]
)
def test_a_quantity_at_another_value_is_that_of_an_override(motor, path, value):
    assert motor.at({path: value}) == load_scene(motor, [f"{path}={value}"]) != motor


def test_a_loaded_scene_and_what_a_file_holds_are_scenes_to_load(motor):
    assert load_scene(motor) == motor == load_scene(copy.deepcopy(MOTOR))
    assert load_scene(MOTOR, ["level=steady"]).level == "steady" and "level" not in MOTOR, "the mapping stays as it was"


@pytest.mark.parametrize(
    ("fields", "point", "words"),
    [
        ({}, {"shaft_speed": "3000", "radial_load": "5 kg"}, ["2 errors", "'3000' has no unit; write 3000 rpm", "'5 kg' has the wrong dimension"]),
        ({}, {"oil_temperature": 80}, ["80 K is outside", "write 80 degC?"]),
        ({}, {"shaft_speed": math.nan}, ["nan rad/s is outside"]),
        ({"bearing.cleerance": "40 um"}, {}, ["bearing.cleerance: no quantity of a scene (did you mean 'bearing.clearance'?)"]),
        ({"level": "slip"}, {}, ["level: no quantity of a scene", "load_scene(scene, ['level=...'])"]),
        ({"bearing.roller.diameter": "20 mm"}, {}, ["rollers of 20 mm do not fit"]),
    ],
)
def test_what_no_scene_can_be_is_refused_with_all_its_faults(motor, fields, point, words):
    with pytest.raises(SceneError) as caught:
        motor.at(fields, **point)
    assert [each for each in words if each not in str(caught.value)] == []


def test_an_unknown_level_and_one_that_would_ignore_the_scene_are_refused(motor):
    with pytest.raises(SceneError, match=r"level = 'stedy': expected one of steady, slip, planar, spatial \(did you mean 'steady'\?\)"):
        settle(motor, "stedy")
    tilted = load_scene(PAPER, ["level=spatial", "operating.misalignment=1 mrad"])
    with pytest.raises(SceneError, match="needs level spatial, whose ring tilts; level slip would ignore it"):
        settle(tilted, "slip")


# Settled states.


def test_a_settled_state_has_the_results_of_a_sweeps_point_and_the_means_of_its_window(paper):
    result, row = settle(paper), point_row(paper)
    assert result.settled and result.verdict == "settled" and result.reason == ""
    assert 100.0 * result.cage_slip == pytest.approx(row["cage_slip"], rel=1e-12)
    assert result.rating_life == row["rating_life"] and 1e6 * result.running_clearance == pytest.approx(row["running_clearance"], rel=1e-12)
    assert result.cage_speed == result.window["cage_speed"].mean() and result.inner_load.shape == (18,)
    table = result.to_pandas()
    assert dict(table["unit"][["cage_slip", "running_clearance", "rating_life", "shaft_power"]]) == dict(
        cage_slip="1", running_clearance="m", rating_life="h", shaft_power="W"
    )
    assert table.loc["inner_load_maximum", "value"] == result.inner_load_maximum
    shown = repr(result)
    assert "45,000 rpm, 800 N, oil at 120 °C; level steady" in shown and f"{100.0 * result.cage_slip:.3g} %" in shown
    again = pickle.loads(pickle.dumps(result))
    assert again.rating_life == result.rating_life and "cage_slip" in dir(again)


def test_a_result_that_does_not_exist_is_named_with_the_nearest(paper):
    with pytest.raises(AttributeError, match=r"no result 'cage_slp' \(did you mean 'cage_slip'\?\)"):
        print(settle(paper).cage_slp)


def test_the_load_of_two_per_cent_slip_is_a_root_and_integrated_motion_agrees(motor):
    load = brentq(lambda newton: settle(motor, "steady", radial_load=newton).cage_slip - 0.02, 50.0, 5000.0, xtol=0.1)
    at_root = settle(motor, "steady", radial_load=load)
    assert at_root.cage_slip == pytest.approx(0.02, abs=1e-5)
    assert settle(motor, "slip", radial_load=load).cage_slip == pytest.approx(0.02, abs=5e-4), "from ideal rolling, to the tolerance of settling"
    assert settle(motor, "steady", radial_load=1.1 * load).cage_slip < 0.02 < settle(motor, "steady", radial_load=0.9 * load).cage_slip


@pytest.mark.parametrize("level", ["slip", "planar"])
def test_a_run_that_starts_near_its_end_ends_where_one_from_ideal_rolling_does(level):
    scene = load_scene(PAPER, ["level=steady", "operating.shaft_speed=30000 rpm"])
    neighbour = settle(scene, radial_load="900 N", shaft_speed="33000 rpm")
    near, far = settle(scene, level, start=neighbour), settle(scene, level)
    assert near.settled and near.cage_slip == pytest.approx(far.cage_slip, abs=1e-3)
    assert near.simulated < 0.2 and far.simulated > 0.49, "some 15 cage turns instead of half a second"


def test_temperatures_that_start_near_equilibrium_end_in_it(motor):
    heated = load_scene(motor, ["heat.law=network", "level=steady"])
    neighbour = settle(heated, radial_load="1.2 kN")
    near, far = settle(heated, radial_load="1 kN", start=neighbour), settle(heated, radial_load="1 kN")
    assert near.inner_ring_temperature == pytest.approx(far.inner_ring_temperature, abs=0.02)
    assert abs(near.inner_ring_temperature - neighbour.inner_ring_temperature) > 0.1 and "ring temperatures" in repr(near)


def test_a_start_that_fits_no_bearing_is_refused(motor, paper):
    with pytest.raises(ValueError, match="cannot start a bearing of 16 rollers from a sample of another bearing"):
        settle(motor, "steady", start=settle(paper))
    with pytest.raises(ValueError, match="a shaft at rest, which has no slip"):
        settle(paper, start=settle(paper, shaft_speed=0.0))


def test_a_bearing_that_does_not_settle_says_what_it_does():
    result = settle(load_scene(PAPER, ROUND), radial_load=5.0, longest="0.5 s")
    assert not result.settled and result.verdict == "drifting" and math.isnan(result.settling_time)
    assert "cage slip still rises" in result.reason and "no, drifting: after 0.5 s" in repr(result)


@pytest.mark.parametrize("longest", [math.nan, math.inf, 0.0, "-1 s"])
def test_a_longest_run_that_would_never_end_is_refused(paper, longest):
    with pytest.raises(ValueError, match="longest = .*: expected a positive time such as '0.5 s'"):
        settle(paper, longest=longest)
    with pytest.raises(ValueError, match="duration = .*: expected a positive time"):
        run_sweep(paper, {"radial_load": [1.0]}, duration=longest)


def test_a_shaft_at_rest_has_no_slip(paper):
    assert math.isnan(settle(paper, shaft_speed=0.0).cage_slip) and "none, the shaft is at rest" in repr(settle(paper, shaft_speed=0.0))


def test_bands_are_those_of_the_uncertainty_study_without_its_shares(paper):
    result, whole = settle(paper, bands=True, samples=7), study(paper, 8, 2017, execution=Execution(workers=1))
    assert result.bands["cage_slip"] == whole.bands["cage_slip"] and result.bands["modified_rating_life"] == whole.bands["life_hours"]
    assert result.bands["cage_slip"].low < result.cage_slip < result.bands["cage_slip"].high
    assert result.to_pandas().loc["cage_slip", "low"] == result.bands["cage_slip"].low and "90 % of cases between" in repr(result)
    assert "h (no dimension is uncertain)" in repr(result)
    assert settle(paper).bands == {}
    with pytest.raises(UncertaintyError, match="the scene has no uncertain fields"):
        settle(load_scene(paper, [f"uncertainty.{each.field}=null" for each in paper.uncertainty]), bands=True)


# Sweeps.


def test_a_sweep_from_python_is_that_of_the_command_line_with_names_and_si_units(paper):
    given = run_sweep(paper, {"shaft_speed": ["15000 rpm", "45000 rpm"], "radial_load": [400.0, np.float64(800.0)]}, workers=1)
    texts = [read_axis("operating.shaft_speed=15000rpm:45000rpm:2"), read_axis("operating.radial_load=400N:800N:2")]
    assert str(given.rows) == str(run_sweep(PAPER, texts, PAPER_STEADY, workers=1).rows), "as text, in which NaN equals NaN"
    assert "sweep of deng2017_table1: 4 points (4 ok)\n  over operating.shaft_speed [rpm] x 2\n" in repr(given)
    data, frame = given.to_xarray(), given.to_pandas()
    assert dict(data.sizes) == {"shaft_speed": 2, "radial_load": 2}
    assert data["shaft_speed"].values == pytest.approx(np.array([15_000, 45_000]) * math.pi / 30) and data["shaft_speed"].attrs["units"] == "rad/s"
    one = float(data["cage_slip"].sel(radial_load=800.0).isel(shaft_speed=1))
    assert one == pytest.approx(settle(paper).cage_slip, rel=1e-12) and data["cage_slip"].attrs["units"] == "1"
    assert data["running_clearance"].attrs["units"] == "m" and float(data["running_clearance"].max()) < 1e-3
    assert frame.attrs["units"]["shaft_speed"] == "rad/s" and frame.attrs["units"]["status"] is None
    assert list(frame["cage_slip"]) == list(data["cage_slip"].values.ravel()) and (data["status"] == "ok").all()


@pytest.mark.long
def test_a_script_without_a_guard_sweeps_in_processes(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from bearing_sim import run_sweep\n"
        "print('once')\n"
        f"table = run_sweep('{PAPER}', {{'radial_load': '100 N:800 N:6'}}, level='steady', workers=2)\n"
        "print(sum(row['status'] == 'ok' for row in table.rows))\n"
    )
    found = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300, env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert found.stdout.split() == ["once", "6"], found.stderr


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ({"speed": [1.0]}, "speed: unknown field"),
        ({"radial_load": []}, "operating.radial_load: no values"),
        ({"radial_load": ["5 kg"]}, "operating.radial_load: '5 kg' has the wrong dimension"),
        ({"radial_load": [True]}, "operating.radial_load takes a quantity in N, got True"),
        ({"bearing.roller.count": [16.5]}, "bearing.roller.count takes a whole number, got 16.5"),
        ({"radial_load": np.arange(1001.0), "shaft_speed": np.arange(1001.0)}, "1002001 points; a sweep has at most 1000000"),
    ],
)
def test_an_axis_that_cannot_be_varied_is_refused(motor, axes, words):
    with pytest.raises(FieldError, match=words):
        run_sweep(motor, axes)


def test_an_axis_reads_numbers_texts_and_names():
    assert axis("bearing.clearance", ["C3", "40 um", 5e-5]).values == ("C3", pytest.approx(4e-5), 5e-5)
    assert axis("bearing.roller.count", np.array([14, 15])).values == (14, 15)
    assert axis("shaft_speed", "15000 rpm:45000 rpm:3") == read_axis("operating.shaft_speed=15000 rpm:45000 rpm:3")


# Inputs.


def test_inputs_are_read_with_units_and_changed_by_name(motor):
    inputs = Inputs.of(shaft_speed="3000 rpm", radial_load="5 kN", load_angle="90 deg", oil_temperature="70 degC")
    assert inputs[:4] == pytest.approx((100.0 * math.pi, 0.0, 5000.0, 343.15)) and math.isnan(inputs.inner_ring_temperature)
    assert inputs.at(radial_load=100)[1:3] == pytest.approx((0.0, 100.0)), "the load keeps its direction"
    assert inputs.at(load_angle=0.0)[1:3] == pytest.approx((5000.0, 0.0)), "and its amount"
    assert inputs.at(load_angle=0.0)[:4] == pytest.approx(scene_inputs(motor)[:4])
    assert inputs.at(inner_ring_temperature="80 degC").inner_ring_temperature == 353.15
    with pytest.raises(ValueError, match=r"shaft_speed = '3000': '3000' has no unit.*; oil_temperature = 70: 70 K is outside.*write 70 degC\?"):
        Inputs.of(shaft_speed="3000", oil_temperature=70)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"shaft_speed": "3000 rpm"}, "could not convert string to float: '3000 rpm'; inputs are numbers in SI, Inputs.of reads texts with units"),
        ({"oil_temperature": 80.0}, r"oil_temperature = 80.0 K: expected -53.15 degC to 326.85 degC; inputs are numbers in SI"),
        ({"shaft_speed": 45_000.0}, "shaft_speed = 45000.0 rad/s: expected -114592 rpm to 114592 rpm"),
        ({"load_z": math.inf}, "load_z = inf: expected a finite number"),
        ({"inner_ring_temperature": 70.0}, "inner_ring_temperature = 70.0 K: expected -123.15 degC to 526.85 degC"),
    ],
)
def test_inputs_that_no_bearing_has_are_refused_at_the_door(paper, changed, words):
    simulation = Simulation(paper)
    with pytest.raises(ValueError, match=words):
        simulation.advance(0.1, simulation.inputs._replace(**changed))
    assert simulation.time == 0.0


# Copies.


def advanced(simulation):
    """Return the samples of a simulation over a change of load, as bytes."""
    return simulation.advance(0.02, simulation.inputs.at(radial_load="900 N"), samples=4).tobytes()


@pytest.mark.parametrize("level", ["steady", "slip", "planar", "spatial"])
def test_a_copy_of_a_simulation_continues_to_the_last_digit(level):
    simulation = Simulation(load_scene(PAPER, [f"level={level}"]))
    simulation.advance(0.01, samples=3)
    copies = [pickle.loads(pickle.dumps(simulation)), copy.deepcopy(simulation)]
    assert repr(copies[0]) == repr(simulation)
    assert repr(simulation).endswith(f"at level {level}, 0.01 s, cage slip {100 * simulation.sample['cage_slip']:.3g} %")
    before = simulation.counters
    assert [advanced(each) for each in copies] == [advanced(simulation)] * 2
    assert all(each.counters == simulation.counters != before for each in copies)


@pytest.mark.parametrize("measured", [None, "80 degC"])
def test_a_copy_continues_with_its_thermal_network(motor, measured):
    simulation = Simulation(load_scene(motor, ["heat.law=network", "level=steady"]))
    simulation.advance(7.3, simulation.inputs.at(inner_ring_temperature=measured))
    copies = [pickle.loads(pickle.dumps(simulation)), copy.deepcopy(simulation)]
    whole = simulation.advance(11.7, samples=5).tobytes()
    assert [each.advance(11.7, samples=5).tobytes() for each in copies] == [whole] * 2


@pytest.mark.long
def test_a_simulation_goes_to_another_process_and_comes_back(paper):
    simulation = Simulation(paper)
    simulation.advance(0.01)
    with ProcessPoolExecutor(1, mp_context=get_context("forkserver")) as pool:
        there = pool.submit(advanced, simulation).result(timeout=300)
    assert there == advanced(simulation)


# Types.


def test_type_checkers_see_the_names_that_the_package_exports():
    assert sorted(bearing_sim.__all__) == PUBLIC and all(hasattr(bearing_sim, name) for name in PUBLIC)
    assert STUB.read_text() == stub(), "python test/generate_names.py writes it"
    packed = (ROOT / "setup.py").read_text()
    assert (ROOT / "bearing_sim/py.typed").is_file() and '"py.typed"' in packed and '"__init__.pyi"' in packed and '"model/names.pyi"' in packed


def fields_of_a_scene() -> list[str]:
    """Return all fields of the records of a scene, as expressions."""
    records = dict.fromkeys(block.record for block in blocks(bearing_sim.Scene))
    return [f"{record.__module__}.{record.__name__}.{field.name}" for record in records for field in dataclasses.fields(record)]


@pytest.mark.long
def test_a_type_checker_accepts_what_runs_knows_types_and_refuses_each_mistake_in_its_line(tmp_path):
    pytest.importorskip("mypy", reason="pip install 'bearing_sim[test]' brings mypy")
    fields, accepted = fields_of_a_scene(), ACCEPTED.strip().splitlines()
    modules = sorted({each.rsplit(".", 2)[0] for each in fields})
    program = [*accepted, *REFUSED, *(f"import {each}" for each in modules), *(f"reveal_type({each})" for each in (*REVEALED, *fields))]
    (tmp_path / "program.py").write_text("\n".join(program))
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", "--strict-equality", "--cache-dir", str(tmp_path / "cache"), "program.py"]
    found = subprocess.run(command, capture_output=True, text=True, timeout=400, cwd=tmp_path, env={**os.environ, "MYPYPATH": str(ROOT)}).stdout
    said = {"error": {}, "note": {}}
    for number, kind, words in re.findall(r"^program.py:(\d+): (error|note): (.*)$", found, re.MULTILINE):
        said[kind][program[int(number) - 1]] = words
    assert [text for text in said["error"] if text not in REFUSED] == [] and "bearing_sim/" not in found, found
    assert [text for text, words in REFUSED.items() if words not in said["error"].get(text, "absent")] == [], found
    types = {text.removeprefix("reveal_type(")[:-1]: words.partition('"')[2][:-1] for text, words in said["note"].items() if "Revealed" in words}
    assert {text: types[text] for text, kind in REVEALED.items() if kind not in types[text]} == {}
    assert {text: types[text] for text in fields if re.search(r"\bAny\b", types[text])} == {}


def test_names_that_are_written_for_type_checkers_are_those_of_their_tables():
    assert get_args(WantName) == tuple(WANTS) and get_args(WantedError.__annotations__["want"]) == tuple(MEASURED)


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda scene: Simulation("deng2017_table1"), TypeError, "expected a Scene; load_scene reads one"),
        (lambda scene: Simulation(scene, {"shaft_speed": 3.0}), TypeError, "expected Inputs; Inputs.of makes them"),
        (lambda scene: Simulation(scene).reset("3000 rpm"), TypeError, "expected Inputs"),
        (lambda scene: Simulation(scene).take_over(scene), TypeError, "expected a Simulation"),
        (lambda scene: Simulation(scene).advance("ten"), ValueError, "duration = 'ten': expected a time such as '0.5 s'"),
        (lambda scene: Simulation(scene).advance(True), ValueError, "duration = True: expected a time"),
        (lambda scene: Simulation(scene).advance(-1), ValueError, "duration = -1: expected a positive time"),
        (lambda scene: Simulation(scene).advance(0.01, samples=2.5), ValueError, "samples = 2.5: expected a whole number of at least 1"),
        (lambda scene: load_scene(3), TypeError, "scene = 3: expected the name of a bundled scene"),
        (lambda scene: load_scene(scene, "level=steady"), TypeError, r"expected a list of texts such as \['level=steady'\]"),
        (lambda scene: load_scene(scene, [3]), TypeError, r"overrides = \[3\]: expected a list of texts"),
        (lambda scene: load_scene(scene, {"operating": {"radial_lod": 3.0}}), SceneError, "radial_lod"),
        (lambda scene: scene.at("radial_load=3"), TypeError, "expected a mapping such as"),
        (lambda scene: settle("..."), SceneError, "no such file or bundled scene"),
        (lambda scene: settle(scene, bands=True, samples=-1), ValueError, "samples = -1: expected a whole number"),
        (lambda scene: run_sweep(scene, 3), FieldError, "3: expected a mapping of fields to values, or a list of points"),
        (lambda scene: run_sweep(scene, []), FieldError, "at least one"),
        (lambda scene: run_sweep(scene, {"radial_load": 3.0}), FieldError, r"operating.radial_load: 3.0; expected values such as \[3.0\]"),
        (lambda scene: run_sweep(scene, [{"radial_load": 1.0}, {"shaft_speed": 1.0}]), FieldError, "point 1 is .* the same fields"),
        (lambda scene: run_sweep(scene, [{"radial_load": "5 kg"}]), FieldError, "'5 kg' has the wrong dimension"),
        (lambda scene: bearing_sim.scene_fields("bearing.cleerance"), LookupError, "did you mean 'bearing.clearance'"),
    ],
)
def test_a_wrong_argument_is_named_with_what_was_expected(paper, call, kind, words):
    with pytest.raises(kind, match=words):
        call(paper)


def test_overrides_as_a_mapping_are_those_as_texts_with_numbers_in_si(motor):
    changes = {
        "uncertainty": {"lubricant.temperature": ["60 degC", "80 degC"]},
        "level": "steady",
        "operating": {"radial_load": 3000.0, "shaft_speed": 400.0},
        "bearing.roller.count": np.int64(15),
    }
    texts = [
        "uncertainty.lubricant.temperature=[60 degC, 80 degC]",
        "level=steady",
        "operating.radial_load=3000",
        "operating.shaft_speed=400 rad/s",
        "bearing.roller.count=15",
    ]
    assert load_scene(motor, changes) == load_scene(motor, texts) != motor
    assert load_scene(motor, {"operating.radial_load": "3 kN"}).operating.radial_load == 3000.0


def test_a_duration_is_a_number_of_seconds_or_a_text_with_its_unit(paper):
    given, written = Simulation(paper), Simulation(paper)
    assert given.advance(0.01).tobytes() == written.advance("10 ms").tobytes() and written.time == 0.01


def test_a_sweep_over_points_has_their_rows_in_order(paper):
    points = [{"shaft_speed": "45000 rpm", "radial_load": 800.0}, {"shaft_speed": "15000 rpm", "radial_load": 400.0}]
    table, grid = run_sweep(paper, points, workers=1), run_sweep(paper, {"shaft_speed": ["15000 rpm", "45000 rpm"], "radial_load": [400.0, 800.0]})
    assert str(table.rows) == str([grid.rows[3], grid.rows[0]]), "as text, in which NaN equals NaN"
    assert "points of deng2017_table1: 2 points (2 ok)" in repr(table) and list(table.to_pandas()["radial_load"]) == [800.0, 400.0]
    pandas = pytest.importorskip("pandas", reason="pip install 'bearing_sim[tables]'")
    assert str(run_sweep(paper, pandas.DataFrame(points), workers=1).rows) == str(table.rows)
    with pytest.raises(ValueError, match="a table of points has no axes; use to_pandas"):
        table.to_xarray()


def test_lists_of_fields_and_observables_are_those_of_the_commands():
    found = bearing_sim.scene_fields("bearing.roller")
    assert {each.path for each in found} > {"bearing.roller.diameter", "bearing.roller.count"} and all(
        each.path.startswith("bearing.roller") for each in found
    )
    assert len(bearing_sim.scene_fields()) > 200 and [each.kind for each in bearing_sim.scene_fields("operating.radial_load")] == ["N"]
    assert {each.name: each.unit for each in bearing_sim.OBSERVABLES}["inner_load"] == "N"


def test_every_parameter_of_the_interface_has_a_type():
    public = [getattr(bearing_sim, name) for name in bearing_sim.__all__]
    written = [getattr(kind, name) for kind in (Simulation, Settled, Inputs) for name in vars(kind) if not name.startswith("_")]
    methods = [each for each in written if inspect.isroutine(each) and hasattr(each, "__code__")] + [Inputs.of]
    untyped = []
    for each in (*[function for function in public if inspect.isfunction(function)], *methods, bearing_sim.Scene.at, bearing_sim.Scene.at_level):
        signature = inspect.signature(each)
        untyped += [
            f"{each.__qualname__}({name})"
            for name, one in signature.parameters.items()
            if one.annotation is one.empty and name not in ("self", "cls")
        ]
        untyped += [f"{each.__qualname__} ->"] * (signature.return_annotation is signature.empty)
    assert untyped == []
