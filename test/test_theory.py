# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The theory manual speaks of this code: the names that it quotes exist, and its check values are those that the code computes."""

import importlib
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import line_contact_stiffness
from bearing_sim.physics.drag import churning_force, cylinder_torque
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.rating_life import ring_ratings
from bearing_sim.physics.traction import CONTACT, traction
from bearing_sim.scene.ratings import load_rating
from bearing_sim.studies.machining import Blank, Pressing, machine

ROOT = Path(__file__).resolve().parents[1]
PAGES = {page.name: page.read_text() for page in sorted((ROOT / "doc" / "theory").glob("*.md"))}
CODE = re.compile(r"`([^`\n]+)`")
DOTTED = re.compile(r"bearing_sim(\.\w+)+")
PATH = re.compile(r"(doc|bearing_sim|test)(/[\w.*-]+)+/?")
WORDS = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*")


def quoted(pattern):
    """Return what the pages quote as code and the pattern matches as a whole, with the page."""
    blocks = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)  # math, figures and tables of contents quote nothing
    return [(name, code) for name, text in PAGES.items() for code in CODE.findall(blocks.sub("", text)) if pattern.fullmatch(code)]


def exists(dotted):
    parts = dotted.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for part in parts[length:]:
            if not hasattr(found, part):
                return False
            found = getattr(found, part)
        return True
    return False


def test_every_dotted_name_in_the_manual_can_be_imported():
    names = quoted(DOTTED)
    assert len(names) > 50
    assert [(page, name) for page, name in names if not exists(name)] == []


def test_every_path_in_the_manual_exists():
    paths = quoted(PATH)
    assert paths
    assert [(page, path) for page, path in paths if not any(ROOT.glob(path.rstrip("/")))] == []


def test_every_identifier_that_the_manual_quotes_occurs_in_the_code():
    files = [file for ending in ("*.py", "*.yaml") for file in (ROOT / "bearing_sim").rglob(ending)]
    known = set(re.findall(r"\w+", " ".join(file.read_text() for file in files)))
    names = quoted(WORDS)
    assert len(names) > 150
    assert [(page, name) for page, name in names if not set(name.split(".")) <= known] == []


def test_the_script_draws_every_figure_of_the_manual(tmp_path):
    script = ROOT / "doc" / "theory" / "figures" / "draw.py"
    subprocess.run([sys.executable, script, "--folder", tmp_path], check=True, timeout=120)
    drawn = {file.name for file in tmp_path.iterdir()}
    assert {Path(figure).name for text in PAGES.values() for figure in re.findall(r"figures/\w+\.svg", text)} == drawn
    assert all((script.parent / name).is_file() for name in drawn)


SCENE = load_scene("deng2017_table1")
PARAMS = pack(SCENE)
LUBRICATION = lubricate(SCENE.lubricant, PARAMS, 393.15)
DIMENSIONS = (PARAMS.rollers.count, 2 * PARAMS.rollers.radius, PARAMS.rollers.length, PARAMS.raceways.diameter_ratio)


def traction_coefficient(slide_to_roll):
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.load], contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding] = 1000.0, 73.0, 73.0 * slide_to_roll
    traction(contacts, LUBRICATION.inner, LUBRICATION.outer, FULL_FILMS)
    return contacts[0, CONTACT.force, 0] / 1000.0


def churning():
    """Drag on a roller at 45,000 rpm of the shaft and no slip [N]."""
    speed = PARAMS.raceways.pitch_radius * 0.5 * 1500 * math.pi * (1 - PARAMS.raceways.diameter_ratio)
    return churning_force(speed, LUBRICATION.mixture_density, LUBRICATION.viscosity, 2 * PARAMS.rollers.radius, PARAMS.rollers.length)[0]


def damping_ratio():
    """Viscous damping ratio of a roller between two raceways that carry 500 N each."""
    stiffness = PARAMS.raceways.stiffness
    penetration = (500.0 / stiffness) ** 0.9
    spring, damper = 2 * 10 / 9 * 500.0 / penetration, 2 * PARAMS.raceways.damping.hysteresis * 500.0
    return damper / (2 * math.sqrt(spring * PARAMS.rollers.mass))


def slope_force():
    """Largest force of the contour's slope on a roller without slip [N], over a lobe of cage rotation."""
    run, largest = Simulation(SCENE), 0.0
    speed = 0.5 * 1500 * math.pi * (1 - PARAMS.raceways.diameter_ratio)
    for angle in np.linspace(0.0, 2 * math.pi / 3, 200):
        balance_loads(angle, speed, 800.0, 0.0, PARAMS, run._work)
        loads = run._work.loads
        largest = max(largest, np.abs(loads[LOAD.outer] * loads[LOAD.contour_slope] / loads[LOAD.radius]).max())
    return largest


def onset(reynolds_at_41, radius, clearance):
    """Reynolds number at which the torque between cylinders leaves Petroff's law, by halving."""
    low, high = 1.0, reynolds_at_41
    for _ in range(60):
        middle = 0.5 * (low + high)
        speed = middle * LUBRICATION.viscosity / (LUBRICATION.mixture_density * radius * clearance)
        torque, slope = cylinder_torque(speed, radius, clearance, 1e-3, LUBRICATION.mixture_density, LUBRICATION.viscosity)
        low, high = (middle, high) if slope * speed <= torque * (1 + 1e-9) else (low, middle)
    return low


# page, what it says, the number in it, the same number computed by the code
CHECK_VALUES = {
    "stiffness": ("contact.md", r"K = 4.535\cdot10^5", 4.535e5, lambda: line_contact_stiffness(7e-3, 2.06e11, 0.3) / 1e3 ** (10 / 9)),
    "damping ratio": ("contact.md", "a viscous damping ratio of 0.05 at 500 N", 0.05, damping_ratio),
    "traction at 0.01": ("traction.md", r"= 0.0013,\ 0.0052,\ 0.0094", 0.0013, lambda: traction_coefficient(0.01)),
    "traction at 0.05": ("traction.md", r"= 0.0013,\ 0.0052,\ 0.0094", 0.0052, lambda: traction_coefficient(0.05)),
    "traction at 0.2": ("traction.md", r"= 0.0013,\ 0.0052,\ 0.0094", 0.0094, lambda: traction_coefficient(0.2)),
    "load rating": ("life.md", "$C_r$ = 30.2 kN", 30.2, lambda: load_rating(*DIMENSIONS) / 1e3),
    "inner rating": ("life.md", "$Q_{ci}$ = 5681 N", 5681, lambda: ring_ratings(load_rating(*DIMENSIONS), DIMENSIONS[0], DIMENSIONS[3])[0]),
    "outer rating": ("life.md", "$Q_{ce}$ = 7646 N", 7646, lambda: ring_ratings(load_rating(*DIMENSIONS), DIMENSIONS[0], DIMENSIONS[3])[1]),
    "MIL-L-7808": ("oil.md", "(120 °C) = 2.09 mPa s", 2.09, lambda: 1e3 * LUBRICATION.viscosity),
    "MIL-L-23699": (
        "oil.md",
        "(100 °C) = 5.01 mPa s",
        5.01,
        lambda: 1e3 * oil_at(load_scene("deng2017_table1", ["lubricant.oil=mil_l_23699"]).lubricant.oil, 373.15).viscosity,
    ),
    "churning": ("drag.md", "3.26 N per roller", 3.26, churning),
    "machined lobes": (
        "raceway.md",
        "3.4 mm gives $D$ = 0.097 mm",
        0.097,
        lambda: 1e3 * machine(Blank(35.8e-3, 0.014, 3.4e-3, 2.06e11), Pressing(2e6), low_radius=34.8625e-3).d_value,
    ),
    "force of the contour's slope": ("raceway.md", "2.8 N, nearly as much", 2.8, slope_force),
    "onset of vortices": ("drag.md", "$Ta$ = 25.2", 25.2, lambda: onset(1000.0, 0.03, 0.001) * math.sqrt(0.001 / 0.03)),
    "onset of turbulence": ("drag.md", "$Re$ = 693", 693, lambda: onset(1e4, 1.0, 1e-5)),
}


@pytest.mark.parametrize("name", CHECK_VALUES)
def test_check_value_of_the_manual_is_what_the_code_computes(name):
    page, says, printed, compute = CHECK_VALUES[name]
    assert says in PAGES[page]
    digits = len(f"{printed:.4g}".replace(".", "").lstrip("0")) if printed < 1e4 else 4
    assert float(f"{compute():.{digits}g}") == pytest.approx(printed, rel=1e-12)
