# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pages of results: of a design, a sweep, a run, a replay and a folder of them; each holds all it shows, and names command and origin."""

import html.parser
import json

import pytest
from click.testing import CliRunner
from recordings import steady_log, truncated, write_log

from bearing_sim.cli.main import main
from bearing_sim.messages.events import Event, Level
from bearing_sim.model.turning import span_text
from bearing_sim.recording.reader import Recording
from bearing_sim.scene.display import hours
from bearing_sim.studies.report_page import _events_table, _grouped
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table, read_table, write_table

LOW = "bearing.outer_raceway.low_radius"
DESIGN = ["design", "deng2017_table1", "--slip-below", "10%", "--life-above", "300h", "--low-radius", "34.861mm:34.865mm:3", "--workers", "1"]
DESIGN += ["--d-value", "0.098mm,0.1mm", "--speed-tolerance", "0", "--load-tolerance", "0", "--verify-level", "slip"]
DESIGN += ["--point", "45000 rpm, 800 N, 3", "--point", "40000 rpm, 600 N, 1", "--tolerance", "bearing.roller.diameter=0.1um"]


class Page(html.parser.HTMLParser):
    """What a page loads and says; every tag is closed."""

    def __init__(self, path):
        super().__init__()
        self.sources, self.links, self.words, self.open, self.headings = [], [], [], [], []
        self.feed(path.read_text())
        assert self.open == []
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        assert tag not in ("script", "link", "iframe", "object")
        self.sources += [value for name, value in attributes.items() if name in ("src", "srcset", "data", "poster", "background")]
        self.links += [attributes["href"]] if "href" in attributes else []
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)
        if self.open and self.open[-1] in ("h2", "h3"):
            self.headings.append(data)


def invoked(*words):
    result = CliRunner().invoke(main, [str(word) for word in words], catch_exceptions=False)
    assert result.exit_code in (0, 3), result.output
    return result.output


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a design, a sweep, a run and a replay."""
    folder = tmp_path_factory.mktemp("results")
    invoked(*DESIGN, "-o", folder / "design.parquet")
    invoked(
        "sweep", "deng2017_table1", "--vary", f"{LOW}=34.861mm:34.865mm:3", "--duration", "0.05", "--workers", "1", "-o", folder / "sweep.parquet"
    )
    invoked("run", "deng2017_table1", "--set", "operating.radial_load=0.5 kN", "--duration", "0.05", "--out", folder / "run.mcap")
    (folder / "log").mkdir()
    steady_log(folder / "log" / "in.mcap", duration=0.5)
    invoked("replay", folder / "log" / "in.mcap", "--scene", "deng2017_table1", "-o", folder / "replay.mcap")
    return folder


def page_of(source, out):
    invoked("report", source, "-o", out, "--force")
    page = Page(out)
    assert all(each.startswith("data:image/png;base64,") for each in page.sources) and all(link.startswith("#") for link in page.links)
    assert "url(" not in out.read_text() and "@import" not in out.read_text()
    return page


@pytest.mark.long
def test_the_page_of_a_design_shows_both_bands_both_levels_points_tolerances_and_command(folder, tmp_path):
    page = page_of(folder / "design.parquet", tmp_path / "d.html")
    expected = ["Summary", "Operating points", "Picture", "Intervals of radii", "Both levels", "Map", "Bearing and conditions", "Provenance"]
    assert page.headings == expected and len(page.sources) == 1
    borders, checks = (read_table(folder / f"design_{name}.parquet") for name in ("borders", "checks"))
    for row in borders.rows:
        assert f"{row['low_radius_from']:.8g}" in page.text and row["verdict"] in page.text
    for row in checks.rows:
        assert f"{row['life']:.5g}" in page.text and f"{row['verified_life']:.5g}" in page.text and row["place"] in page.text
    for text in (
        "bearing-sim design deng2017_table1 --slip-below 10%",
        "'45000 rpm, 800 N, 3'",
        "0.75",
        "40000",
        "bearing.roller.diameter ±0.0001 mm",
    ):
        assert text in page.text
    assert "life [h at steady]" in page.text and "verified life [h at slip]" in page.text and "Widest interval" in page.text
    narrowed = sum(row["verdict"] == "narrowed" for row in borders.rows)
    assert (narrowed > 0) == ("narrowed at level slip" in page.text)


def test_the_page_of_a_sweep_shows_every_row_the_picture_the_scene_and_the_command(folder, tmp_path):
    for name in ("sweep.parquet", "sweep.csv"):
        page = page_of(folder / name, tmp_path / "s.html")
        assert page.headings == ["Summary", "Pictures", "Results", "Bearing and conditions", "Provenance"] and len(page.sources) == 1
        for row in read_table(folder / "sweep.parquet").rows:
            assert f"{row['cage_slip']:.5g}" in page.text and f"{row['rating_life']:.5g}" in page.text
        assert f"bearing-sim sweep deng2017_table1 --vary {LOW}=34.861mm:34.865mm:3" in page.text and "3 ok" in page.text
        assert "mixture_fraction: 0.03" in page.text and "R_low" in page.text and "rollers 18" in page.text


def test_the_page_of_a_run_shows_its_course_its_loads_its_last_results_and_how_to_repeat_it(folder, tmp_path):
    page = page_of(folder / "run.mcap", tmp_path / "r.html")
    expected = ["Summary", "Answer sheet, mean over the last 20 %", "Pictures", "Observables", "Bearing and conditions", "Provenance"]
    assert page.headings == expected and len(page.sources) == 2
    recording = Recording(folder / "run.mcap")
    last = [block for block in recording][-1][-1]
    assert recording.command.startswith("bearing-sim run deng2017_table1 --set 'operating.radial_load=0.5 kN'")
    assert recording.command in page.text and "bearing-sim replay --from-recording run.mcap" in page.text
    assert f"{recording.samples} samples" in page.text
    used = float(last["damage"])
    assert f"{100 * used:.4g} %" in page.text and f"{recording.duration / 3600 / used:.4g} h" in page.text
    assert "radial_load: 500" in page.text


def test_the_page_of_a_replay_tells_warnings_of_the_run(folder, tmp_path):
    page = page_of(folder / "replay.mcap", tmp_path / "r.html")
    assert "bearing-sim replay" in page.text and "--scene deng2017_table1" in page.text
    page = page_of(truncated(folder / "replay.mcap", tmp_path / "cut.mcap", 3 * (folder / "replay.mcap").stat().st_size // 4), tmp_path / "c.html")
    assert (
        "2 warnings" in page.text
        and "the recording is used in part only" in page.text
        and "ends early" in page.text
        and "without resistance" in page.text
    )


@pytest.mark.timeout(120)
def test_a_page_and_a_replay_have_one_life_and_one_time_of_skid_also_across_a_gap(tmp_path):
    """Half of the time of the log is a gap: a life over the whole log would be twice that over the time that is known."""
    times = [0.02 * k for k in range(101)] + [4.0 + 0.02 * k for k in range(101)]
    log = write_log(tmp_path / "log.mcap", [(time, 4700.0 - 400.0 * time) for time in times], [(time, 800.0, 0.0) for time in times])
    options = "--scene", "deng2017_table1", "--set", "thresholds.slip_warning=3%"
    report = json.loads(CliRunner().invoke(main, ["replay", str(log), *options, "-o", str(tmp_path / "run.mcap"), "--json"]).stdout)
    assert report["gap_seconds"] == pytest.approx(2.0) and report["sim_seconds"] == pytest.approx(4.0)
    assert 0.0 < report["skid_seconds"] < report["turning_seconds"] == pytest.approx(report["sim_seconds"])
    page = page_of(tmp_path / "run.mcap", tmp_path / "r.html")
    assert hours(report["life_hours"]) in page.text and hours(1.5 * report["life_hours"]) not in page.text
    told = f"{span_text(report['skid_seconds'])} with slip above 3 % under load"
    assert told in page.text, (told, page.text)


def event(time, text, level=Level.WARN, subject="cage slip"):
    return Event(time, level, "bearing.slip", subject, text)


def test_a_warning_stands_with_the_time_of_its_own_number_and_once_on_a_page():
    events = [event(1.0 + k, f"{5 + k} % has reached 5 %") for k in range(8000)] + [event(2.5, "back within its limits", Level.OK)]
    first, back = _grouped(events)
    assert (first.count, first.last, back.count) == (8000, 8000.0, 1)
    assert "5 % has reached" in first.warning and "at 1 s; 8000 times until 8000 s" in first.warning and "8004 %" not in first.warning
    assert back.warning.endswith("(at 2.5 s)")
    assert _events_table(events).count("<tr>") == 1 + 2, "a heading, and a row for each"


def test_the_page_of_a_folder_shows_all_its_results_and_names_what_it_could_not_show(folder, tmp_path):
    page = page_of(folder, tmp_path / "f.html")
    assert page.text.count("bearing-sim replay --from-recording") == 2 and len(page.sources) == 1 + 1 + 2 * 2
    assert sum(heading[0].isdigit() for heading in page.headings) == 4 and "4 results in" in page.text
    foreign = steady_log(tmp_path / "log.mcap", duration=0.2)
    write_table(tmp_path / "t", Table((Column("a", "mm", "x"),), [{"a": 1.5}], {"kind": "numbers"}))
    page = page_of(tmp_path, tmp_path / "mixed.html")
    assert f"not shown: {foreign}" in page.text and "no recording of bearing_sim" in page.text and "a [mm]" in page.text


def test_warnings_open_the_page(tmp_path):
    columns = Column("a", "", "x"), Column("status", "", ""), Column("reason", "", "")
    rows = [{"a": 1.0, "status": "ok", "reason": ""}] + [{"a": 2.0, "status": "unsettled", "reason": "slip was still <changing>"}] * 2
    write_table(tmp_path / "t", Table(columns, rows, {"kind": "sweep", "scene": "<b>", "level": "slip", "axes": []}))
    page = page_of(tmp_path / "t.parquet", tmp_path / "t.html")
    assert "1 warning 2 of 3 rows unsettled: slip was still <changing>" in page.text and "Sweep of <b> at level slip" in page.text
    assert "No picture: a picture shows one or two varied fields" in page.text


def test_a_scene_of_another_version_is_shown_as_text_with_a_warning(folder, tmp_path):
    table = read_table(folder / "sweep.parquet")
    older = table.about["scene_of_first_point"].replace("mixture_fraction", "mixture_of_another_version")
    write_table(tmp_path / "t", table._replace(about=table.about | {"scene_of_first_point": older, "version": "9.9"}))
    page = page_of(tmp_path / "t.parquet", tmp_path / "t.html")
    assert "written by another version of bearing_sim (9.9)" in page.text and "mixture_of_another_version: 0.03" in page.text
    assert f"{table.rows[0]['cage_slip']:.5g}" in page.text


def test_a_csv_alone_says_that_its_origin_is_unknown(tmp_path):
    (tmp_path / "t.csv").write_text("name,length [mm]\na,1.25\nb,nan\n")
    page = page_of(tmp_path / "t.csv", tmp_path / "t.html")
    assert "the origin of these numbers is not known" in page.text and "length [mm]" in page.text and "1.25" in page.text


def test_the_page_goes_beside_its_source_unless_told_otherwise(folder):
    assert str(folder / "sweep.html") in invoked("report", folder / "sweep.parquet")
    (folder / "sweep.html").unlink()


@pytest.mark.parametrize(
    ("name", "text", "reported"),
    [
        ("missing.parquet", None, "does not exist; expected a table of sweep or design"),
        ("note.txt", "x", "expected a table (.parquet, .csv), a recording (.mcap), or a folder"),
        ("t.parquet", "x", "Error: {path}: not readable as Parquet"),
        ("t.csv", "a,b\n1\n", "Error: {path}: expected a heading and lines with as many values"),
        ("t.mcap", "x", "t.mcap"),
    ],
)
def test_what_is_no_result_is_refused_with_what_was_expected(tmp_path, name, text, reported):
    if text is not None:
        (tmp_path / name).write_text(text)
    result = CliRunner().invoke(main, ["report", str(tmp_path / name)])
    assert result.exit_code == 2 and reported.format(path=tmp_path / name) in " ".join(result.output.split())


def test_a_design_without_its_further_tables_is_refused_by_the_name_of_the_missing_one(folder, tmp_path):
    (tmp_path / "design.parquet").write_bytes((folder / "design.parquet").read_bytes())
    result = CliRunner().invoke(main, ["report", str(tmp_path / "design.parquet")])
    assert result.exit_code == 2 and "design_borders.parquet" in result.output


def test_a_page_of_validation_names_what_makes_it_now(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["report", "validation"])
    assert result.exit_code == 2 and "python test/validation report" in result.output
