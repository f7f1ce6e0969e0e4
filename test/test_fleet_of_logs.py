# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Many logs at once: one row for each bearing, whatever is wrong with a log, and nothing computed twice."""

import json
import math

import pyarrow
import pyarrow.parquet
import pytest
from click.testing import CliRunner
from made_up_response import ASKING, made_up_response

from bearing_sim.cli import estimation
from bearing_sim.cli import replay as replay_command
from bearing_sim.cli.main import main
from bearing_sim.sweep.table import read_table

MAPPING = """
name: rig
time: {column: t, unit: s, epoch: 2026-01-01}
shaft_speed: {column: n, unit: rpm}
radial_load: {law: sum, columns: [{column: F, unit: kN}]}
"""
ROWS = 11  # at 5 Hz


def rows(rpm, load=2.0):
    """Return times [s], speeds [rpm] and loads [kN] of two seconds."""
    return [(0.2 * k, rpm, load) for k in range(ROWS)]


def text(values):
    return "\n".join(["t,n,F", *(",".join(map(repr, row)) for row in values)]) + "\n"


@pytest.fixture
def fleet(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "logs" / "north").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    (tmp_path / "rig.yaml").write_text(MAPPING)
    (tmp_path / "logs" / "A.csv").write_text(text(rows(20_000.0)))
    (tmp_path / "logs" / "north" / "B.csv").write_text(text(rows(30_000.0)))
    return tmp_path


def replay_fleet(*words, code=0):
    common = ["--mapping", "rig.yaml", "--scene", "deng2017_table1", "--set", "level=slip", "--workers", "1", "-o", "out/fleet.parquet", "--json"]
    result = CliRunner().invoke(main, ["replay-fleet", *common, "--force", *map(str, words)], catch_exceptions=False)
    assert result.exit_code == code, result.output
    return (json.loads(result.stdout) if code in (0, 1, 3) else {}), result.stderr


def bearings(*words, code=0):
    return {row["bearing"]: row for row in replay_fleet(*words, code=code)[0]["bearings"]}


def test_a_row_says_what_replay_says_of_its_log_and_turns_are_speed_times_time(fleet):
    found = bearings("logs")
    assert list(found) == ["A", "north/B"]
    for name, rpm in (("north/B", 30_000.0),):
        path = fleet / "logs" / f"{name}.csv"
        for words in (
            ["import-csv", path, "rig.yaml", "-o", "one.mcap"],
            ["replay", "one.mcap", "--scene", "deng2017_table1", "--set", "level=slip"],
        ):
            alone = CliRunner().invoke(main, [*map(str, words), "--json"], catch_exceptions=False)
        report, row = json.loads(alone.stdout), found[name]
        assert row["damage"] == pytest.approx(100.0 * report["damage"], rel=1e-9)
        assert [row[f"slip_{each}"] for each in ("mean", "p95", "maximum")] == pytest.approx(
            [100.0 * report[each] for each in ("cage_slip", "cage_slip_p95", "cage_slip_maximum")], rel=1e-9
        )
        assert row["revolutions"] == pytest.approx(rpm / 60.0 * 2.0) and row["running_hours"] == pytest.approx(2.0 / 3600.0)
        assert row["status"] == "ok" and row["life_method"] == report["life_method"]
        limit, slips = 5.0, row["slip_maximum"]
        assert 0.0 <= row["above_slip_error"] <= row["above_slip_warning"] <= 100.0 and (row["above_slip_warning"] > 0.0) == (slips > limit)
    table = read_table(fleet / "out" / "fleet.parquet")
    assert table.column("revolutions").meaning and table.column("damage").unit == "%" and "replay-fleet" in table.about["command"]


def test_bearings_whose_scene_asks_for_bands_have_those_of_their_replay_and_equal_bearings_share_one_response(fleet, monkeypatch):
    made = []

    def respond(scene):
        made.append(made_up_response(scene))
        return made[-1]

    for module in (estimation, replay_command):
        monkeypatch.setattr(module, "response_with_progress", respond)
    ends = [f"{name}_{end}" for name in ("slip_mean", "least_rating_life", "least_running_clearance", "remaining_life") for end in ("low", "high")]
    without = bearings("logs")["A"]
    assert all(without[end] is None for end in ends) and made == []
    asking = [word for override in ASKING for word in ("--set", override)]
    found = bearings("logs", *asking)["A"]
    assert len(made) == 1 and found["slip_mean"] == without["slip_mean"]
    CliRunner().invoke(main, ["import-csv", "logs/A.csv", "rig.yaml", "-o", "one.mcap"], catch_exceptions=False)
    words = ["replay", "one.mcap", "--scene", "deng2017_table1", "--set", "level=slip", *asking, "--json"]
    alone = json.loads(CliRunner().invoke(main, words, catch_exceptions=False).stdout)
    bands = [
        *(100.0 * each for each in alone["cage_slip_band"]),
        *alone["least_rating_life_band"],
        *(1e6 * each for each in alone["least_running_clearance_band"]),
        *alone["remaining_life_band"],
    ]
    assert [found[end] for end in ends] == pytest.approx(bands, rel=1e-9) and found["slip_mean_low"] < found["slip_mean"] < found["slip_mean_high"]


def test_a_log_that_cannot_be_used_is_a_row_that_says_why_and_the_others_are_computed(fleet):
    logs = fleet / "logs"
    (logs / "empty.csv").write_text("")
    (logs / "foreign.csv").write_text("a,b\n1,2\n")
    (logs / "words.csv").write_text("t,n,F\n0,fast,1\n1,fast,1\n")
    (logs / "cut.mcap").write_bytes(b"\x89MCAP0\r\n")
    (logs / "over.csv").write_text(text([*rows(20_000.0)[:5], (1.0, 9e6, 2.0), *rows(20_000.0)[6:]]))
    found = bearings("logs", code=1)
    assert {name: row["status"] for name, row in found.items()} == {
        "A": "ok",
        "cut": "refused",
        "empty": "refused",
        "foreign": "refused",
        "north/B": "ok",
        "over": "partly used",
        "words": "refused",
    }
    assert "no column 't'" in found["foreign"]["reason"] and "not_a_number" in found["words"]["reason"] and found["words"]["damage"] is None
    assert found["over"]["unknown_hours"] > 0.0 and found["over"]["life_and_damage"] == "at most, at least"
    for name in ("cut", "empty", "foreign", "words"):
        (logs / name).with_suffix(".mcap" if name == "cut" else ".csv").unlink()
    bearings("logs", code=3)


def test_what_was_computed_is_kept_by_the_contents_of_a_log_and_not_by_its_name(fleet):
    logs = fleet / "logs"

    def computed(*words):
        report, _ = replay_fleet("logs", *words)
        return report["computed"], report["kept_from_before"]

    assert computed() == (2, 0)
    (logs / "A.csv").rename(logs / "Z.csv")
    (logs / "C.csv").write_text(text(rows(25_000.0)))
    assert computed() == (1, 2)
    (logs / "C.csv").write_text(text(rows(25_000.0, 2.5)))
    assert computed() == (1, 2)
    assert computed("--set", "lubricant.temperature=110degC") == (3, 0)
    assert computed("--oil-temperature", "110degC") == (3, 0)
    journal = fleet / "out" / "fleet.journal"
    whole = journal.read_bytes()
    journal.write_bytes(whole[:-20])  # as a kill leaves it
    assert computed("--oil-temperature", "110degC") == (1, 2)
    assert journal.read_bytes() == whole


def test_a_table_says_which_bearing_has_which_log(fleet):
    (fleet / "bearings.csv").write_text(
        "log; serial; lubricant.temperature; mapping.radial_load; scene\n"
        "A; front; 90 degC; ;\nA; rear; ; '{law: constant, value: 4 kN}'; \nnorth/C; ; ; ;\n".replace("'", "")
    )
    found = bearings("logs", "--bearings", "bearings.csv", code=1)
    assert list(found) == ["front", "rear", "north/C", "north/B"]
    assert "did you mean 'north/B'" in found["north/C"]["reason"] and found["north/C"]["status"] == "refused"
    assert found["front"]["largest_load"] == pytest.approx(2000.0) and found["rear"]["largest_load"] == pytest.approx(4000.0)
    alone = bearings("logs")
    assert found["north/B"]["damage"] == alone["north/B"]["damage"] and found["front"]["slip_mean"] != alone["A"]["slip_mean"]
    for heading, expected in (("log,lubricnt.temperature", "did you mean 'lubricant'"), ("serial,scene", "no column 'log'")):
        (fleet / "bearings.csv").write_text(f"{heading}\nA,1\n")
        result = CliRunner().invoke(main, ["replay-fleet", "logs", "--bearings", "bearings.csv"])
        assert result.exit_code == 2 and expected in result.output


def test_a_data_set_of_many_machines_gives_what_a_file_for_each_gives(fleet):
    columns = {"t": [], "n": [], "F": [], "site": []}
    for machine, rpm in (("7", 30_000.0), ("3", 20_000.0)):
        for row in reversed(rows(rpm)) if machine == "7" else rows(rpm):  # the files of a data set have no order
            for name, value in zip(columns, (*row, machine)):
                columns[name].append(value)
    whole = pyarrow.table(columns | {"site": [int(site) for site in columns["site"]]})
    pyarrow.parquet.write_to_dataset(whole, fleet / "scada", partition_cols=["site"])
    for site in ("3", "7"):  # two files for each
        folder = fleet / "scada" / f"site={site}"
        (file,) = folder.iterdir()
        part = pyarrow.parquet.read_table(file)
        pyarrow.parquet.write_table(part.slice(0, 6), folder / "1.parquet")
        pyarrow.parquet.write_table(part.slice(6), folder / "0.parquet")
        file.unlink()
    alone, found = bearings("logs"), bearings("scada", "--by", "site")
    assert list(found) == ["3", "7"]
    assert [row["damage"] for row in found.values()] == [row["damage"] for row in alone.values()]
    (fleet / "all.csv").write_text("\n".join(["t,n,F,site", *(",".join(map(repr, (*row, 3))) for row in rows(20_000.0))]))
    assert bearings("all.csv", "--by", "site")["3"]["damage"] == alone["A"]["damage"]
    assert "no column 'side'" in replay_fleet("scada", "--by", "side", code=2)[1]
    pyarrow.parquet.write_table(pyarrow.table({"t": pyarrow.array([0, 1], pyarrow.timestamp("ns")), "n": [1.0, 1.0], "F": [1.0, 1.0]}), "s.parquet")
    assert "expected time.format: iso" in bearings("s.parquet", code=1)["s"]["reason"]


def test_all_logs_of_a_bearing_share_one_table_of_operating_points(fleet, monkeypatch):
    from bearing_sim.levels.steady.table import empty_table
    from bearing_sim.studies import fleet as replay

    built = []

    def obtain_table(scene, temperatures):
        built.append((scene.table.maximum_speed, temperatures))
        return empty_table(), None

    monkeypatch.setattr(replay, "obtain_table", obtain_table)
    monkeypatch.setattr("bearing_sim.cli.table.build_with_progress", lambda *_: None)
    (fleet / "logs" / "fast.csv").write_text(text(rows(60_000.0)))
    found = bearings("logs", "--set", "level=steady", "--set", "input_limits.maximum_speed=70000rpm")
    assert {row["status"] for row in found.values()} == {"ok"} and len(built) == 1
    speed, (low, high) = built[0]
    assert speed >= 60_000.0 * math.pi / 30.0 and low == high


@pytest.mark.parametrize(
    "words, expected",
    [
        (["nowhere", "--scene", "deng2017_table1"], "nowhere: no such file or folder"),
        (["logs/north", "--scene", "deng2017_tabel1"], "did you mean 'deng2017_table1'"),
        (["logs"], "give --scene, or --bearings"),
        (["--scene", "deng2017_table1"], "no logs"),
        (["void", "--scene", "deng2017_table1"], "no logs; expected files .csv"),
        (["logs", "--scene", "deng2017_table1", "--mapping", "rigg.yaml"], "no such file or bundled mapping"),
        (["logs", "--scene", "deng2017_table1", "--load", "800"], "a number without a unit"),
    ],
)
def test_what_cannot_be_meant_ends_before_anything_is_computed(fleet, words, expected):
    (fleet / "void").mkdir()
    result = CliRunner().invoke(main, ["replay-fleet", *words])
    assert result.exit_code == 2 and expected in result.output, result.output


def test_replay_of_a_folder_of_logs_names_the_command_for_many(fleet):
    result = CliRunner().invoke(main, ["replay", "logs", "--scene", "deng2017_table1"])
    assert result.exit_code == 2 and "bearing-sim replay-fleet logs" in result.output
