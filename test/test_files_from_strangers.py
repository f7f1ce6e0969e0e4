# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Files from strangers cost bounded memory and time, name no file outside of their folder, and end in one message.

``test/benchmarks/hostile_files.py`` tries some 200 of them in processes with little memory; here are those that cost no time.
"""

import os
import sys
import threading
from pathlib import Path

import click
import pytest
import yaml
from click.testing import CliRunner

from bearing_sim import load_scene
from bearing_sim.cli.main import main
from bearing_sim.files import limits
from bearing_sim.files.limits import FileError, LimitError, printable
from bearing_sim.files.outside import allowing_outside, why_outside
from bearing_sim.files.reading import read_bytes, read_text
from bearing_sim.files.yaml_text import values_of
from bearing_sim.inputs.csv_import import mapping_from_yaml, read_table
from bearing_sim.inputs.csv_text import TableError
from bearing_sim.scene.loader import SceneError, scene_from_yaml, scene_to_yaml
from bearing_sim.scene.quantity import to_si
from bearing_sim.watchers.estimation import response

sys.path.insert(0, str(Path(__file__).parent / "benchmarks"))

import hostile_scenes  # noqa: E402
import hostile_tables  # noqa: E402
import hostile_vibration  # noqa: E402

CONTOUR = "angle [deg], radius [mm]\n" + "".join(f"{angle},{40.8 + 0.01 * (angle % 10 > 4)}\n" for angle in range(0, 360, 5))
MAPPING = (
    "name: m\ntime: {{column: t, {time}}}\nshaft_speed: {{column: n, unit: rpm}}\nradial_load: {{law: sum, columns: [{{column: f, unit: N}}]}}\n"
)


def scene_of(folder: Path, contour_file: str) -> Path:
    """Write a scene that names a contour, and return its path."""
    path = folder / "scene.yaml"
    path.write_text(hostile_scenes.plain(bearing=f"outer_raceway: {{contour_file: {contour_file}}}"))
    return path


def run(*arguments):
    """Return the result of a command, run in this process."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


# Slow ones, and those that a limited address space ends, are left to the benchmark.
QUICK = [
    case
    for case in (*hostile_scenes.CASES, *hostile_tables.CASES)
    if case.name.startswith(("scene: a ", "scene: an ", "mapping: a ", "mapping: an ", "state: ", "contour: /", "crown: /"))
    and not any(word in case.name for word in ("million", "10 GB", "100,000", "10,000", "3,000 deep", "400", "grow to 9^5"))
    and not case.accepted
]
QUICK_RECORDS = (
    "CSV: a pipe",
    "CSV: values of 1e308",
    "CSV: values of 5e-324",
    "CSV: 100,000 columns",
    "NPZ: an array of 2^62 numbers",
    "NPY: an archive",
    "MAT: 2,000 cells within cells",
    "MAT: a matrix that says it has 2^31 numbers",
    "MAT: a negative size",
    "H5: few numbers in a piece of 4 GB",
    "H5: numbers in /dev/zero",
    "H5: numbers in another HDF5 file",
    "WAV: 2^63 bytes",
    "WAV: no channels",
    "MCAP: blocks of two rates",
)
QUICK += [case for case in hostile_vibration.CASES if case.name.removeprefix("vibration ") in QUICK_RECORDS]
RESPONSES = [
    case for case in hostile_vibration.CASES if case.name.startswith("response: ") and not any(word in case.name for word in ("GB", "million"))
]


@pytest.mark.parametrize("case", QUICK, ids=[case.name.replace(" ", "_") for case in QUICK])
def test_a_hostile_file_ends_in_one_message_and_an_exit_code(case, tmp_path, monkeypatch):
    if " H5: " in case.name:
        pytest.importorskip("h5py")
    case.make(tmp_path)
    monkeypatch.chdir(tmp_path)
    done = run(*case.command)
    assert done.exit_code in (1, 2) and isinstance(done.exception, SystemExit), done.exception
    assert done.stderr.startswith("Error: ") and len(done.stderr) < 20_000 and done.stderr.replace("\n", "").isprintable()


@pytest.mark.parametrize("case", RESPONSES, ids=[case.name.replace(" ", "_") for case in RESPONSES])
def test_a_kept_response_is_used_only_if_it_is_whole_and_that_of_the_scene(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(response, "FOLDER", tmp_path)
    if case.accepted:
        case.command()
    else:
        with pytest.raises(SystemExit):
            case.command()
    assert not Path("harmed").exists()


def test_only_regular_files_within_the_limit_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("nowhere")
    (tmp_path / "large").write_bytes(bytes(limits.CROWN_FILE.value + 1))
    (tmp_path / "latin").write_bytes(b"a\nb\xfc\n")
    for name, reason in (
        ("pipe", "a pipe, expected a file"),
        ("link", "a link to a file that does not exist"),
        ("", "a folder, expected a file"),
        ("/dev/zero", "a device, expected a file"),
        ("nothing", "no such file"),
        ("large", "BEARING_SIM_LIMITS=crown_file=NUMBER"),
        ("latin", "line 2: byte 0xfc is no UTF-8 text"),
    ):
        with pytest.raises(FileError, match=reason):
            read_text(tmp_path / name, limits.CROWN_FILE)
    assert read_bytes("/proc/self/comm", limits.CROWN_FILE)  # whose size the system gives as zero


def test_an_environment_variable_raises_a_limit_by_its_name_and_refuses_another(tmp_path, monkeypatch):
    (tmp_path / "file").write_bytes(bytes(2_000_000))
    monkeypatch.setenv(limits.VARIABLE, "crown_file=2e6, yaml_nodes=30000")
    assert len(read_bytes(tmp_path / "file", limits.CROWN_FILE)) == 2_000_000 and limits.YAML_NODES.value == 30_000
    for wrong in ("crown=2", "crown_file", "crown_file=0", "crown_file=1e30", "crown_file=nan"):
        monkeypatch.setenv(limits.VARIABLE, wrong)
        with pytest.raises(LimitError, match=limits.VARIABLE):
            read_bytes(tmp_path / "file", limits.CROWN_FILE)


def test_every_limit_is_listed_once():
    declared = [value for value in vars(limits).values() if isinstance(value, limits.Limit)]
    assert sorted(limit.name for limit in limits.LIMITS) == sorted({limit.name for limit in declared})


def test_aliases_count_as_often_as_they_are_used_and_may_not_contain_themselves():
    assert values_of("{a: &a [1, 2], b: *a, c: [*a, *a]}") == {"a": [1, 2], "b": [1, 2], "c": [[1, 2], [1, 2]]}
    with pytest.raises(LimitError, match="aliases written out"):
        values_of("a0: &a0 [1]\n" + "".join(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]\n" for k in range(1, 60)))
    with pytest.raises(FileError, match="stands within what it stands for"):
        values_of("&a [*a]")


@pytest.mark.parametrize(
    "text", ["a: 1", "a: [1.5, -2, 1e3, true, null, text, '7', 2026-01-02]", "a: {b: {c: [x, {d: 1}]}}", "a: |\n  b\n  c\n", "- [a]"]
)
def test_usual_yaml_means_what_it_means_to_others(text):
    read = yaml.safe_load(text.replace("1e3", "1000.0"))
    assert values_of(text) == read


@pytest.mark.parametrize("unit", ["N", "kN", "kg*m/s^2", "kg * m / s ^ 2", "kg*m/s**2", "(kg*m)/s^2", "N^1.0", "kg*(m/s)^2/m"])
def test_units_with_powers_are_still_read(unit):
    assert to_si(f"2 {unit}", "N") == pytest.approx(2000.0 if unit == "kN" else 2.0)


@pytest.mark.parametrize("unit", ["N**9**9**9**9", "9**9**9**9 N", "N^9^9", "(9**9)**9*(9**9)**9 N", "N**(9**9**9)", "N**999999999", "N ** 9 ** 9"])
def test_powers_of_powers_in_a_unit_are_refused_before_they_are_computed(unit):
    with pytest.raises(ValueError, match="powers of powers"):
        to_si(f"1 {unit}", "N")  # which never returns if they are


def test_a_scene_names_files_below_its_folder_only_unless_that_is_allowed(tmp_path):
    inner = tmp_path / "scenes"
    (inner / "contours").mkdir(parents=True)
    for folder in (tmp_path, inner, inner / "contours"):
        (folder / "c.csv").write_text(CONTOUR)
    (inner / "link.csv").symlink_to(tmp_path / "c.csv")
    expected = load_scene(scene_of(inner, "c.csv"))
    for inside in ("contours/c.csv", "./c.csv", "contours/../c.csv", inner / "c.csv"):
        assert load_scene(scene_of(inner, inside)) == expected
    for outside in ("../c.csv", tmp_path / "c.csv", "link.csv", "contours/../../c.csv"):
        path = scene_of(inner, outside)
        with pytest.raises(SceneError, match="outside of the folder of the file that names it"):
            load_scene(path)
        allowed = load_scene(path, allow_outside=True)
        assert allowed.bearing.outer_raceway.contour == expected.bearing.outer_raceway.contour
        assert load_scene(path, [f"bearing.outer_raceway.contour_file={inner / 'c.csv'}"]) == expected  # whoever gives a path means it
    crown = inner / "crown.yaml"
    crown.write_text(hostile_scenes.plain(bearing="roller: {crown: {law: table, file: ../crown.csv}}"))
    with pytest.raises(SceneError, match=r"roller\.crown\.file = '\.\./crown\.csv': outside"):
        load_scene(crown)


def test_what_one_thread_may_read_outside_no_other_may(tmp_path):
    reasons = []
    with allowing_outside():
        other = threading.Thread(target=lambda: reasons.append(why_outside("../c.csv", tmp_path)))
        other.start()
        other.join()
        assert why_outside("../c.csv", tmp_path) == ""
    assert "outside of the folder" in reasons[0] and reasons[0] == why_outside("../c.csv", tmp_path)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a/b.csv", "a/b.csv"),
        ("bell\a", "bell\\x07"),
        ("ä" * 20, "ä" * 20),
        ("0123456789" * 5, "012345678...23456789"),
        ("\a" * 50, "\\x07\\x07\\...\\x07\\x07"),
    ],
)
def test_of_a_long_text_beginning_and_end_are_shown_and_nothing_acts_on_a_terminal(text, shown):
    assert printable(text, 20) == shown and len(shown) <= 20


def test_a_scene_without_a_file_of_its_own_reads_none_and_keeps_no_path(tmp_path):
    (tmp_path / "c.csv").write_text(CONTOUR)
    path = scene_of(tmp_path, "c.csv")
    text = scene_to_yaml(load_scene(path))
    (tmp_path / "c.csv").unlink()
    assert scene_from_yaml(text).bearing.outer_raceway.contour == CONTOUR.strip() and str(tmp_path) not in text
    with pytest.raises(SceneError, match="cannot name others"):
        scene_from_yaml(path.read_text())
    hidden = scene_from_yaml(text.replace("contour_file: c.csv", "contour_file: /home/somebody/c.csv"))
    assert hidden.bearing.outer_raceway.contour_file == "c.csv"


def test_every_command_that_takes_a_scene_has_the_option_that_allows_files_outside(tmp_path):
    (tmp_path / "c.csv").write_text(CONTOUR)
    (tmp_path / "scenes").mkdir()
    path = scene_of(tmp_path / "scenes", "../c.csv")

    def commands(group, name):
        context = click.Context(group)
        for each in group.list_commands(context):
            command = group.get_command(context, each)
            yield from commands(command, f"{name} {each}") if isinstance(command, click.Group) else [(f"{name} {each}", command)]

    taking = {name: command for name, command in commands(main, "") if any(each.name == "scene_name" for each in command.params)}
    assert len(taking) > 15 and [name for name, each in taking.items() if not any("--allow-outside" in one.opts for one in each.params)] == []
    assert "outside of the folder" in run("run", path, "--duration", "1ms").stderr
    with click.Context(taking[" loads"]) as context:
        taking[" loads"].parse_args(context, ["x", "--allow-outside"])
        assert load_scene(path).bearing.outer_raceway.contour_file == "c.csv"
    with pytest.raises(SceneError):  # the permission ends with the command
        load_scene(path)


def table_of(folder: Path, text: str, time: str = "unit: s"):
    """Return a table read by the test's mapping."""
    (folder / "d.csv").write_text(text)
    return read_table(folder / "d.csv", mapping_from_yaml(MAPPING.format(time=time)))


@pytest.mark.parametrize(
    "cell, kind", [("1e990000", "out_of_range"), ("1e30", "out_of_range"), ("2e10", "out_of_range"), ("-5", "out_of_range"), ("nan", "unreadable")]
)
def test_a_time_that_no_stamp_can_hold_costs_its_row(tmp_path, cell, kind):
    table = table_of(tmp_path, f"t,n,f\n0,1,2\n{cell},1,2\n1,1,2\n")
    assert table.tally.refused == {f"time.{kind}": 1} and list(table.stamps["shaft_speed"]) == [0, 10**9]


@pytest.mark.parametrize(
    "time", ["format: '%Y %Y'", "format: '%Y %'", "format: '%Q'", f"format: '{'%Y-' * 60}'", "unit: s**9**9**9", "zone: '+99:00'"]
)
def test_a_format_or_unit_of_times_that_cannot_be_read_is_an_error_of_the_mapping(time):
    with pytest.raises(SceneError, match="time"):
        mapping_from_yaml(MAPPING.format(time=time))


@pytest.mark.parametrize(
    "name, limit, text, where",
    [
        ("table_rows", 100, "t,n,f\n" + "".join(f"{k},1,1\n" for k in range(200)), "d.csv"),
        ("table_line", 1000, "t,n,f\n0,1,1\n" + "1" * 2000 + "\n", "line 3"),
        ("table_line", 1000, 't,n,f\n0,"' + "1\n" * 900 + '",1\n', "line 2"),
        ("table_columns", 50, ",".join(["t,n,f", *(f"c{k}" for k in range(100))]) + "\n", "line 1"),
        ("table_file", 1000, "t,n,f\n" + "0,1,1\n" * 1000, "d.csv"),
    ],
)
def test_a_table_beyond_a_limit_is_refused_with_the_name_that_raises_it(tmp_path, monkeypatch, name, limit, text, where):
    monkeypatch.setenv(limits.VARIABLE, f"{name}={limit}")
    with pytest.raises(TableError, match=f"{where}.*{limits.VARIABLE}={name}=NUMBER"):
        table_of(tmp_path, text)


def test_a_guessed_mapping_cannot_be_written_by_a_heading(tmp_path):
    (tmp_path / "d.csv").write_text("time [s],speed [rpm],load [N],x\u2028radial_load: {law: constant}\n0,1,1,1\n1,1,1,1\n")
    done = run("import-csv", tmp_path / "d.csv", "--guess")
    assert done.exit_code == 2 and "control characters" in done.stderr and "\u2028" not in done.output
