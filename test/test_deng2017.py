# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The study of Deng 2017: what its claims table says follows from its tables, which follow from single runs; the page holds all of it."""

import html.parser
import json
import re
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from deng2017 import claims as deng2017_claims
from deng2017.__main__ import deng2017
from deng2017.claims import CLAIMS, FAILS, HOLDS, IN_PART, Course, judge
from deng2017.page import study_page
from deng2017.study import D_VALUE, LEVELS, LOAD, LOW, ROUNDNESS, SPEED, STUDIES, plan_study
from reference_slip import Reference

from bearing_sim import Simulation, load_scene
from bearing_sim.studies.page import NoResults
from bearing_sim.sweep.grid import point_count, read_axis
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table, read_table

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    result = CliRunner().invoke(deng2017, ["--quick", "-o", str(folder), "--json"], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["computed"] == len({task.key for task in plan_study(quick=True).tasks})
    return folder


@pytest.fixture(scope="module")
def about(folder):
    return json.loads((folder / "study.json").read_text())


@pytest.fixture(scope="module")
def tables(folder):
    return {(each.name, level): read_table(folder / "tables" / f"{each.name}_{level}.parquet") for each in STUDIES for level in LEVELS}


def column(table, x, y, **fixed):
    rows = [row for row in table.rows if all(abs(row[name] - value) < 1e-9 for name, value in fixed.items())]
    return np.array([[row[x], row[y]] for row in sorted(rows, key=lambda row: row[x])]).T


def test_every_claim_is_judged_at_both_levels_and_every_figure_of_the_paper_is_drawn(about):
    judged = {(each["claim"], each["level"]) for each in about["claims"]}
    assert judged == {(0, "elastic ring")} | {(number, level) for number in range(1, len(CLAIMS) + 1) for level in LEVELS}
    told = " ".join(each["title"] for each in about["figures"])
    assert all(re.search(rf"\b{number}\b", told) for number in (3, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23))
    assert "Trajectories" in told and "design question" in told


def test_all_parameters_are_those_of_the_bundled_scenes_but_what_a_figure_varies(tables):
    varied = {"low_radius", "d_value", "shaft_speed", "radial_load", "installation_angle", "roundness", "mixture_fraction", "mass"}
    for study in STUDIES:
        assert {text.partition("=")[0].rpartition(".")[2] for text in (*study.axes, *study.overrides)} <= varied
        assert not study.figures or not {"mixture_fraction", "mass"} & {text.partition("=")[0].rpartition(".")[2] for text in study.axes}


def test_the_full_study_has_the_ranges_of_the_paper():
    full = {study.name: {axis.field.path: axis.shown for axis in map(read_axis, study.axes)} for study in STUDIES}
    assert full["low_radius"][LOW][0] == 34.86 and full["low_radius"][LOW][-1] == 34.8675
    assert full["d_value"][D_VALUE][0] == 0.08 and full["d_value"][D_VALUE][-1] == 0.12
    for name in ("speed", "table2"):
        assert full[name][SPEED][0] == 15000 and full[name][SPEED][-1] == 52000
    assert full["load"][LOAD][0] == 100 and full["load"][LOAD][-1] == 3000 and full["load"][LOW] == [34.86, 34.8625, 34.865, 34.8675]
    assert full["angle"]["bearing.outer_raceway.installation_angle"][-1] == 60
    assert full["roundness"]["bearing.outer_raceway.roundness"][-1] == 10
    assert len(LEVELS) * sum(point_count([read_axis(text) for text in study.axes]) for study in STUDIES) > 400


def test_a_point_of_the_study_is_a_single_run(tables):
    row = next(row for row in tables["speed", "slip"].rows if row[LOW] == 34.865 and row[SPEED] == 38000)
    run = Simulation(load_scene("deng2017_table1", [f"{LOW}=34.865mm", f"{SPEED}=38000rpm"]))
    run.advance(row["simulated"] - 0.04)
    block = run.advance(0.04, samples=100)
    assert row["cage_slip"] == pytest.approx(100 * block["cage_slip"].mean(), rel=5e-3)
    assert row["rating_life"] == pytest.approx(block["rating_life"].mean(), rel=5e-3)


def test_claims_at_level_slip_follow_from_the_tables(tables, about):
    verdicts = {each["claim"]: each["verdict"] for each in about["claims"] if each["level"] == "slip"}
    for name, x, claim in (("low_radius", LOW, 1), ("d_value", D_VALUE, 2)):
        for y in ("cage_slip", "rating_life"):
            assert np.all(np.diff(column(tables[name, "slip"], x, y)[1]) > 0), claim
    speeds = [column(tables["speed", "slip"], SPEED, "cage_slip", **{LOW: low})[1] for low in (34.86, 34.8625, 34.865, 34.8675)]
    assert np.all(np.diff(speeds, axis=1) > 0) and np.all(np.diff([each[-1] - each[0] for each in speeds]) > 0)
    assert verdicts[3] == HOLDS
    loads = [column(tables["load", "slip"], LOAD, "cage_slip", **{LOW: low})[1] for low in (34.86, 34.8625, 34.865, 34.8675)]
    changes = [1 - each[-1] / each[0] for each in loads]
    assert changes[0] < 0.1 and changes == sorted(changes) and changes[3] > 0.5
    angle = "bearing.outer_raceway.installation_angle"
    slip, life = (column(tables["angle", "slip"], angle, y)[1] for y in ("cage_slip", "rating_life"))
    assert np.ptp(slip) < 0.01 * slip[0] and 1.0 < life[-1] / life[0] < 1.1 and verdicts[5] == HOLDS
    lives = dict(zip(*column(tables["low_radius", "slip"], LOW, "rating_life")))
    assert lives[34.86] < 300 < lives[34.8625] and lives[34.865] > 300 and verdicts[7] == HOLDS
    for ring, sign in (("inner", -1), ("outer", 1)):
        for low in (34.86, 34.8625, 34.865, 34.8675):
            assert np.all(sign * np.diff(column(tables["speed", "slip"], SPEED, f"{ring}_load_maximum", **{LOW: low})[1]) > -3)
    assert np.all(np.diff(column(tables["table2", "slip"], SPEED, "cage_slip")[1]) > 0) and verdicts[9] == HOLDS
    (second,) = [each for each in about["claims"] if (each["claim"], each["level"]) == (2, "slip")]
    assert second["verdict"] == IN_PART and "not 10 %" in second["off"], "slip and life rise, but past 10 % sooner"
    assert column(tables["d_value", "slip"], D_VALUE, "rating_life")[1].min() > 300 and verdicts[10] == FAILS
    roundness = "bearing.outer_raceway.roundness"
    assert column(tables["roundness", "slip"], roundness, "rating_life")[1].min() > 300 and verdicts[11] == FAILS
    assert verdicts[6] == IN_PART  # an inner ring that is free to move hardly notices


def test_largest_loads_are_those_of_an_independent_model(tables):
    # no shared code; the cage slower by the slip of the row
    row = next(row for row in tables["low_radius", "slip"].rows if row[LOW] == 34.865)
    model = Reference(low_radius=34.865e-3)
    cage = (1 - row["cage_slip"] / 100) * model.shaft_speed * (1 - model.roller_radius / model.pitch_radius) / 2
    loads = [model.loads(angle, cage)[:2] for angle in np.linspace(0, 2 * np.pi / 18, 60, endpoint=False)]
    inner, outer = (max(each[ring].max() for each in loads) for ring in (0, 1))
    assert row["inner_load_maximum"] == pytest.approx(inner, rel=0.01)
    assert row["outer_load_maximum"] == pytest.approx(outer, rel=0.01)


def turned_round(table, x, y):
    """Return a table whose column y runs backwards along x."""
    ordered = sorted(table.rows, key=lambda row: tuple(row[name] for name in (LOW, x) if name in row))
    values = [row[y] for row in ordered]
    return Table(table.columns, [row | {y: value} for row, value in zip(ordered, reversed(values))], table.about)


@pytest.mark.parametrize(
    ("claim", "name", "x", "y"),
    [
        (1, "low_radius", LOW, "cage_slip"),
        (2, "d_value", D_VALUE, "rating_life"),
        (3, "speed", SPEED, "cage_slip"),
        (7, "low_radius", LOW, "rating_life"),
        (8, "speed", SPEED, "inner_load_maximum"),
        (9, "table2", SPEED, "cage_slip"),
    ],
)
def test_a_claim_whose_numbers_are_turned_round_does_not_hold_and_says_by_how_much(tables, claim, name, x, y):
    turned = tables | {(name, "slip"): turned_round(tables[name, "slip"], x, y)}
    before, after = ({each.claim: each for each in judge(each, ["slip"])}[claim] for each in (tables, turned))
    assert before.verdict in (HOLDS, IN_PART)
    assert after.verdict in (IN_PART, FAILS) and after.verdict != HOLDS and after.off and after.why
    assert (before.verdict, before.off) != (after.verdict, after.off)


def test_slips_that_do_not_rise_in_the_order_of_the_radii_are_told(tables):
    """The rows of the tightest and the loosest radius change places."""
    other = {34.86: 34.8675, 34.8675: 34.86}
    rows = [row | {LOW: other.get(row[LOW], row[LOW])} for row in tables["speed", "slip"].rows]
    swapped = tables | {("speed", "slip"): Table(tables["speed", "slip"].columns, rows, tables["speed", "slip"].about)}
    (found,) = [each for each in judge(swapped, ["slip"]) if each.claim == 3]
    assert found.verdict == IN_PART and "does not increase with the radius" in found.off


@pytest.mark.parametrize(("broken", "verdict"), [(0, HOLDS), (1, IN_PART), (5, IN_PART), (6, FAILS), (10, FAILS)])
def test_a_claim_fails_where_more_than_half_of_the_steps_go_wrong(broken, verdict):
    """Of ten even steps upwards so many go down instead."""
    steps = np.ones(10)
    steps[:broken] = -1.0
    rows = [{SPEED: 1e4 + k, "cage_slip": slip, "inner_equivalent_load": 1.0} for k, slip in enumerate(np.cumsum([20.0, *steps]).tolist())]
    columns = tuple(Column(name, "", "") for name in rows[0])
    found = deng2017_claims.table2({("table2", "slip"): Table(columns, rows, {})}, "slip")
    assert found.verdict == verdict


def test_a_step_back_within_noise_is_no_fall_and_one_beyond_is():
    calm = np.zeros(3, bool)
    assert Course(np.arange(3.0), np.array([1.0, 0.995, 2.0]), calm).backward() == []
    assert Course(np.arange(3.0), np.array([1.0, 0.98, 2.0]), calm).backward() == [0]
    assert Course(np.arange(3.0), np.array([3.0, np.nan, 2.0]), calm).backward(rising=False) == [0, 1]  # no result is no fall


def test_the_design_question_is_answered_beside_the_papers_answer(folder, about):
    (shown,) = [each for each in about["figures"] if each["file"] == "design.png"]
    found = re.search(r"at nominal speed and load: R_low ([\d.]+) to ([\d.]+) mm", shown["caption"])
    assert 34.861 < float(found[1]) < 34.8625 < float(found[2]) < 34.8655 and "34.8625 to 34.8650 mm" in shown["caption"]
    borders = read_table(folder / "tables" / "design_borders.parquet")
    assert {row["kind"] for row in borders.rows} == {"nominal", "worst"} and (folder / "figures" / "design.png").stat().st_size > 20_000


def test_a_value_is_crossed_between_the_points_linearly_and_nowhere_where_it_is_always_or_never_reached():
    rising = Course(np.array([1.0, 2.0, 3.0]), np.array([8.0, 9.0, 11.0]), np.zeros(3, bool))
    assert deng2017_claims._crossing(rising, 10.0) == pytest.approx(2.5)
    assert np.isnan(deng2017_claims._crossing(rising, 7.0)) and np.isnan(deng2017_claims._crossing(rising, 12.0))


def test_contours_of_the_machining_model_grow_as_the_arc_is_turned(folder):
    rows = read_table(folder / "tables" / "machining.parquet").rows
    for name, sign in (("high_radius", 1), ("low_radius", -1), ("d_value", 1), ("roundness", 1)):
        assert np.all(sign * np.diff([row[name] for row in rows]) > 0), name
    assert rows[0]["d_value"] == pytest.approx(98, abs=3) and rows[0]["roundness"] < 1e-6


def test_a_second_call_computes_nothing_and_says_the_same(folder, about, tmp_path, monkeypatch):
    shutil.copy(folder / "study.journal", tmp_path)
    monkeypatch.setattr("deng2017.run.plot_study", lambda *all_of_it: [])
    result = CliRunner().invoke(deng2017, ["--quick", "-o", str(tmp_path), "--json"], catch_exceptions=False)
    again = json.loads(result.stdout)
    assert again["computed"] == 0 and again["claims"] == about["claims"]


class Page(html.parser.HTMLParser):
    """What a page loads and says."""

    def __init__(self):
        super().__init__()
        self.sources, self.links, self.text, self.open = [], [], [], []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.sources += [value for name, value in attributes.items() if name in ("src", "srcset", "data", "poster", "background")]
        self.links += [attributes["href"]] if "href" in attributes else []
        assert tag not in ("script", "link", "iframe", "object")
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def page_of(folder, path):
    path.write_text(study_page(folder))
    page = Page()
    page.feed(path.read_text())
    assert page.open == []
    return page, " ".join("".join(page.text).split())


def test_the_page_holds_all_it_shows_and_says_every_claim_figure_setting_and_version(folder, about, tmp_path):
    page, text = page_of(folder, tmp_path / "r.html")
    assert (folder / "report.html").read_text() == (tmp_path / "r.html").read_text()
    assert len(page.sources) == len(about["figures"]) and all(source.startswith("data:image/png;base64,") for source in page.sources)
    assert {link for link in page.links if not link.startswith("#")} == {f"https://doi.org/{about['doi']}"}
    assert "url(" not in (tmp_path / "r.html").read_text() and "@import" not in (tmp_path / "r.html").read_text()
    for each in about["claims"]:
        for name in ("says", "verdict", "gives", "off", "why"):
            assert " ".join(each[name].split()) in text
    for each in about["figures"]:
        assert each["title"] in text and each["caption"] in text
    for version in about["versions"].values():
        assert version in text
    assert "This is a quick run" in text and "--vary" in text and "mixture_fraction: 0.03" in text


def test_the_page_shows_marks_and_scripts_as_they_are_written(folder, about, tmp_path):
    (tmp_path / "figures").symlink_to(folder / "figures")
    nasty = '<script>alert("x")</script> & <b>'
    about = json.loads(json.dumps(about))
    about["title"] = about["claims"][0]["gives"] = about["figures"][0]["title"] = about["sweeps"][0]["vary"][0] = nasty
    about["versions"]["commit"] = about["scenes"]["deng2017_table1"] = about["command"] = about["levels"]["slip"] = nasty
    about["statuses"] = {nasty: 1}
    (tmp_path / "study.json").write_text(json.dumps(about))
    page, text = page_of(tmp_path, tmp_path / "r.html")
    assert text.count('<script>alert("x")</script> & <b>') >= 9


def test_a_folder_without_a_study_is_refused(tmp_path):
    with pytest.raises(NoResults, match="no such file"):
        study_page(tmp_path)
    (tmp_path / "study.json").write_text("{")
    with pytest.raises(NoResults, match="not readable as JSON"):
        study_page(tmp_path)


def test_the_page_of_a_study_shows_no_file_of_another_folder(tmp_path):
    (tmp_path / "secret.png").write_bytes(b"secret")
    about = {name: "" for name in ("title", "doi", "command", "quick", "points", "duration")} | {"levels": {}, "statuses": {}, "claims": []}
    figure = {"file": "../secret.png", "title": "", "caption": "", "tables": []}
    (tmp_path / "study.json").write_text(json.dumps(about | {"figures": [figure], "versions": {}, "sweeps": [], "scenes": {}}))
    with pytest.raises(NoResults, match="expected the name of a file in the folder figures"):
        study_page(tmp_path)


def test_every_claim_names_its_figure_in_words_of_the_paper():
    assert [number for number, *_ in CLAIMS] == list(range(1, 12))
    assert all(figures and len(says) > 30 for _, figures, says, _ in CLAIMS)


def test_slip_that_rises_ever_faster_holds_and_its_slope_is_told_in_points_for_a_micrometre():
    rows = [
        {LOW: 34.86 + 0.0025 * k, "cage_slip": slip, "rating_life": 300.0 + k, "inner_equivalent_load": 1.0, "churning_power": 900.0}
        for k, slip in enumerate((1.0, 2.0, 4.0, 7.0))
    ]
    columns = tuple(Column(name, "", "") for name in rows[0])
    found = deng2017_claims.low_radius({("low_radius", "slip"): Table(columns, rows, {})}, "slip")
    assert found.verdict == HOLDS and found.gives.endswith("slope of slip 0.4 to 1.2 points/um")


@pytest.mark.parametrize(
    ("judge_life", "name", "x", "values", "short"),
    [
        (deng2017_claims.short_life_of_low_lobes, "d_value", D_VALUE, (0.08, 0.09, 0.095, 0.12), (True, True, False, False)),
        (deng2017_claims.short_life_of_uneven_lobes, "roundness", ROUNDNESS, (0.0, 6.0, 8.0, 10.0), (False, False, True, True)),
    ],
)
def test_a_life_below_300_h_is_claimed_of_low_or_uneven_lobes_alone(judge_life, name, x, values, short):
    def judged(lives):
        rows = [{x: value, "rating_life": life, "inner_equivalent_load": 1.0} for value, life in zip(values, lives)]
        table = Table(tuple(Column(each, "", "") for each in rows[0]), rows, {})
        radii = zip((34.86, 34.862, 34.864), (200, 320, 440))
        grid = [{D_VALUE: 0.08, LOW: low, "rating_life": life, "inner_equivalent_load": 1.0} for low, life in radii]
        region = Table(tuple(Column(each, "", "") for each in grid[0]), grid, {})
        return judge_life({(name, "slip"): table, ("map", "slip"): region}, "slip")

    assert judged([290.0 if each else 310.0 for each in short]).verdict == HOLDS
    long = judged([310.0] * 4)
    assert long.verdict == FAILS and "life is 310 h at least" in long.off and long.why
    assert judged([290.0] * 4).verdict == IN_PART


def test_claims_are_numbered_as_they_are_listed():
    assert [number for number, *_ in CLAIMS] == list(range(1, len(CLAIMS) + 1))
