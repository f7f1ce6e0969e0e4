# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the files that people bring: how loggers write numbers, times, units and names is read as it is meant, or asked for in one line."""

import bz2
import gzip
import lzma

import numpy as np
import pytest
import zstandard

from bearing_sim.inputs.csv_guess import guess
from bearing_sim.inputs.csv_import import TableError, mapping_from_yaml, read_table
from bearing_sim.inputs.log import InputLogError, read_input_log
from bearing_sim.inputs.mission import write_mission
from bearing_sim.messages.definitions import decoder, ros2_name
from bearing_sim.watchers.vibration.reading import read_vibration

RPM = np.pi / 30.0
LABVIEW = (
    "LabVIEW Measurement\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tOne\nDate\t2026/05/04\nTime\t10:00:00\n***End_of_Header***\n\n"
    "Channels\t2\nSamples\t40\t40\nDate\t2026/05/04\t2026/05/04\nTime\t10:00:00.5\t10:00:00.5\nY_Unit_Label\trpm\tkN\nX_Dimension\tTime\tTime\n"
    "X0\t0.0\t0.0\nDelta_X\t0.01\t0.01\n***End_of_Header***\t\t\nX_Value\tspeed\tload\tComment\n"
)


def table(folder, heading, row, count=60, encoding="utf-8"):
    path = folder / "table.csv"
    path.write_bytes("\n".join([heading, *(row(k) for k in range(count)), ""]).encode(encoding))
    return path


def imported(path):
    found = guess(path)
    assert not found.questions, found.questions
    return found, read_table(path, mapping_from_yaml(found.text))


@pytest.mark.parametrize("space", ["\N{NO-BREAK SPACE}", "\N{NARROW NO-BREAK SPACE}", "\N{THIN SPACE}", "\N{RIGHT SINGLE QUOTATION MARK}", " ", "."])
def test_separators_of_thousands_are_those_of_the_column(tmp_path, space):
    path = table(tmp_path, "time [s];speed [rpm];load [N]", lambda k: f"{k};1{space}48{k % 10},5;5{space}0{k:02d},0")
    found, read = imported(path)
    assert found.tree["thousands"] and read.values["shaft_speed"][3] == pytest.approx(1483.5 * RPM) and read.values["radial_load"][7] == 5007.0


def test_numbers_grouped_as_in_india_are_read(tmp_path):
    _, read = imported(table(tmp_path, "time [s];speed [rpm];load [N]", lambda k: f"{k};1480.5;1,05,1{k:02d}.0"))
    assert read.values["radial_load"][5] == 105105.0


@pytest.mark.parametrize(
    "heading, cell", [("speed", "98.3 %"), ("speed [rpm]", "98.3 %"), ("Drehzahl in % von n_N", "98.3"), ("speed_percent", "98.3")]
)
def test_per_cent_of_a_speed_asks_for_the_speed_at_100_per_cent(tmp_path, heading, cell):
    path = table(tmp_path, f"time [s],{heading},load [kN]", lambda k: f"{k},{cell},5.0")
    assert "give the speed at 100 %: --unit shaft_speed='% of 1500 rpm'" in guess(path).questions["shaft_speed"]
    found = guess(path, units={"shaft_speed": "% of 1500 rpm"})
    assert read_table(path, mapping_from_yaml(found.text)).values["shaft_speed"][0] == pytest.approx(0.983 * 1500 * RPM)


def test_a_mapping_in_rpm_is_refused_where_the_cells_are_per_cent(tmp_path):
    path = table(tmp_path, "t,n,f", lambda k: f"{k},98.3 %,5.0")
    columns = "shaft_speed: {column: n, unit: rpm}\nradial_load: {law: sum, columns: [{column: f, unit: N}]}\n"
    with pytest.raises(TableError, match="n: the cells are percentages .%., not rpm"):
        read_table(path, mapping_from_yaml(f"name: rig\ntime: {{column: t, unit: s}}\n{columns}"))


def test_units_behind_the_numbers_are_those_of_the_column(tmp_path):
    _, read = imported(table(tmp_path, "time [s],speed,load", lambda k: f"{k},1480 rpm,5.0 kN"))
    assert read.values["shaft_speed"][0] == pytest.approx(1480 * RPM) and read.values["radial_load"][0] == 5000.0


@pytest.mark.parametrize("rate, digits", [(10.0, 0), (25.0, 1), (300.0, 2)])
def test_rounded_times_give_an_even_rate_that_is_said_and_no_gap(tmp_path, rate, digits):
    _, read = imported(table(tmp_path, "time [s],speed [rpm],load [kN]", lambda k: f"{k / rate:.{digits}f},{1480 + k % 7},5.0", 900))
    assert read.tally.is_whole and not read.gaps and any("times are rounded" in note for note in read.notes)
    assert np.diff(read.stamps["shaft_speed"]) * 1e-9 == pytest.approx(np.full(899, 1.0 / rate), rel=0.03)


def test_a_gap_between_rounded_times_stays_one_and_rows_of_two_machines_are_not_taken_for_one(tmp_path):
    _, read = imported(table(tmp_path, "time [s],speed [rpm],load [kN]", lambda k: f"{k // 10 + 50 * (k >= 300)},{1480 + k % 7},5.0", 600))
    assert [line for _, line, _ in read.gaps] == [302, 302] and read.tally.is_whole
    path = table(tmp_path, "time [s],machine,speed [rpm],load [kN]", lambda k: f"{k // 2},{'AB'[k % 2]},1480,5.0")
    _, read = imported(path)
    assert read.tally.refused["time.repeated"] == 30


def test_days_of_a_spreadsheet_are_dates_and_its_other_system_is_named(tmp_path):
    found, read = imported(table(tmp_path, "time,speed [rpm],load [kN]", lambda k: f"{45234.5 + k / 86400:.8f},1480,5.0"))
    assert "1904-01-01" in found.reasons["time"] and read.stamps["shaft_speed"][0] == 1_699_099_200_000_000_000  # 2023-11-04 12:00 UTC


def test_names_and_units_come_from_lines_above_the_numbers(tmp_path):
    path = table(tmp_path, "time;speed;load\ns;rpm;kN\nSmp;Avg;Avg", lambda k: f"{k};1480;5.0")
    _, read = imported(path)
    assert read.tally.used == read.tally.there == 60 and read.values["radial_load"][0] == 5000.0


@pytest.mark.parametrize("times", ["One", "No"])
def test_labview_text_keeps_its_names_units_and_start_with_and_without_times(tmp_path, times):
    path = tmp_path / "rig.lvm"
    rows = "".join(f"{k * 0.01 if times == 'One' else ''}\t{1480 + k % 7}\t5.0\n" for k in range(40))
    path.write_text(LABVIEW.replace("X_Columns\tOne", f"X_Columns\t{times}") + rows)
    found, read = imported(path)
    assert found.tree["shaft_speed"]["column"] == "speed [rpm]" and read.tally.used == 40 and read.spacing == pytest.approx(0.01)
    assert read.stamps["shaft_speed"][0] == 1_777_888_800_500_000_000  # 2026-05-04 10:00:00.5 UTC


def test_a_second_segment_of_labview_text_follows_the_first_by_its_own_start(tmp_path):
    path = tmp_path / "rig.lvm"
    rows = "".join(f"{k * 0.01:.2f}\t1480\t5.0\n" for k in range(40))
    again = "\nChannels\t2\nDate\t2026/05/04\t2026/05/04\nTime\t10:00:10.5\t10:00:10.5\n***End_of_Header***\nX_Value\tspeed\tload\tComment\n"
    path.write_text(LABVIEW + rows + again + rows)
    _, read = imported(path)
    assert read.tally.used == 80 and len(read.gaps) == 2 and read.stamps["shaft_speed"][40] - read.stamps["shaft_speed"][0] == 10_000_000_000


@pytest.mark.parametrize("digits, offset", [(5, 0.0), (3, 0.0), (4, 10.0)])
def test_the_rate_of_a_vibration_record_survives_times_that_are_rounded(tmp_path, digits, offset):
    path = tmp_path / "record.csv"
    path.write_text("time [s],a\n" + "".join(f"{offset + k / 51200:.{digits}f},{k % 13}\n" for k in range(20000)))
    assert read_vibration(path).rate == pytest.approx(51200.0, rel=2e-3)


def test_a_vibration_record_in_labview_text_is_read_with_name_unit_and_rate(tmp_path):
    path = tmp_path / "record.lvm"
    path.write_text(LABVIEW.replace("rpm\tkN", "g\tg").replace("X_Columns\tOne", "X_Columns\tNo") + "".join(f"\t{k % 13}\t0\n" for k in range(2000)))
    found = read_vibration(path, channel="speed [g]")
    assert found.rate == pytest.approx(100.0) and "[g]" in found.name and found.samples[14] == 1.0


def test_tdms_and_universal_files_have_their_rate_and_unit(tmp_path):
    nptdms, pyuff = pytest.importorskip("nptdms"), pytest.importorskip("pyuff")
    samples = np.sin(np.arange(5000.0))
    with nptdms.TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment([nptdms.ChannelObject("rig", "x", samples, properties={"wf_increment": 1 / 51200, "unit_string": "g"})])
    names = dict.fromkeys(("rsp_ent_name", "ref_ent_name", "id2", "id3", "id4", "id5"), "NONE") | {"id1": "acc", "ordinate_axis_units_lab": "g"}
    numbers = dict.fromkeys(("rsp_node", "rsp_dir", "ref_node", "ref_dir", "func_type", "binary", "abscissa_spacing", "orddenom_spec_data_type"), 1)
    times = {"x": np.arange(5000) / 51200, "abscissa_inc": 1 / 51200, "abscissa_min": 0.0}
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets({"type": 58, "data": samples, **names, **numbers, **times})
    for name in ("a.tdms", "a.uff"):
        found = read_vibration(tmp_path / name)
        assert found.rate == pytest.approx(51200.0, rel=1e-4) and "[g]" in found.name and found.samples == pytest.approx(samples, abs=1e-4)


@pytest.mark.parametrize("name", ["std_msgs::msg::dds_::Float64_", "std_msgs::msg::Float64", "std_msgs/Float64", "std_msgs/msg/Float64"])
def test_names_of_types_are_those_of_ros_2_however_a_recorder_writes_them(name):
    assert ros2_name(name) == "std_msgs/msg/Float64"


def test_a_known_type_whose_definition_names_an_unknown_one_is_read_by_that_of_ros_2_and_a_strange_one_is_not():
    notes = []
    assert decoder("std_msgs/msg/Float64", "ros2msg", b"this is none", notes.append)(b"\0\1\0\0" + np.array([2.5]).tobytes()).data == 2.5
    assert "that of ROS 2 Jazzy is used" in notes[0]
    with pytest.raises(ValueError, match="drive_msgs/this is not defined"):
        decoder("drive_msgs/msg/State", "ros2msg", b"this is none")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "log.mcap"
    write_mission(path, 1_700_000_000_000_000_000, 2.0, 20.0)
    return path


@pytest.mark.parametrize(("pack", "command"), [(gzip.compress, "gunzip -k"), (bz2.compress, "bunzip2 -k"), (lzma.compress, "unxz -k")])
def test_a_recording_compressed_otherwise_is_refused_with_the_command_that_unpacks_it(log, tmp_path, pack, command):
    path = tmp_path / "packed.mcap"
    path.write_bytes(pack(log.read_bytes()))
    with pytest.raises(InputLogError, match=f"unpack it first, for example by: {command} .*packed.mcap"):
        read_input_log(path)


@pytest.mark.parametrize("name", ["log.mcap.zstd", "log.mcap.zst", "log.mcap"])
def test_a_recording_compressed_by_zstd_is_read_whatever_its_name(log, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(zstandard.compress(log.read_bytes()))
    found = read_input_log(path)
    assert found.series["shaft_speed"].values == read_input_log(log).series["shaft_speed"].values and "compressed by zstd" in found.lost.notes[0]


def test_a_joint_of_another_name_is_refused_with_the_option_that_chooses_it(log):
    with pytest.raises(InputLogError, match="no joint 'spindle' in the message; it has 'shaft'; --joint NAME chooses one"):
        read_input_log(log, joint="spindle")
