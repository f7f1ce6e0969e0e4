# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is said about how long a stage will take follows from the last time on this machine, or from the machine's speed."""

import pytest

from bearing_sim.runtime import durations, precompilation
from bearing_sim.runtime.precompilation import Build, announcement


@pytest.fixture(autouse=True)
def kept(tmp_path, monkeypatch):
    """A folder of durations of its own, and a machine as fast as the reference machine."""
    monkeypatch.setattr(durations, "CACHE_FOLDER", tmp_path / "compiled" / "version")
    monkeypatch.setattr(durations, "_count", lambda: durations._COUNT_SECONDS)
    return tmp_path / "durations.json"


@pytest.mark.parametrize(("times_slower", "text"), [(1.0, "about 95 s"), (3.0, "about 280 s"), (0.02, "about 2 s")])
def test_without_a_last_time_the_speed_of_the_machine_decides(times_slower, text, monkeypatch):
    monkeypatch.setattr(durations, "_count", lambda: times_slower * durations._COUNT_SECONDS)
    assert durations.expected("compiling", 95.0) == text


def test_the_last_time_is_told_stage_by_stage(kept):
    for seconds in (50.0, 41.6):
        durations.keep("compiling slip", seconds)
    durations.keep("view", 3.0)
    assert durations.expected("compiling slip", 95.0) == "42 s the last time here" and durations.expected("view", 9.0) == "3 s the last time here"
    assert [each.name for each in kept.parent.iterdir()] == [kept.name]


@pytest.mark.parametrize("text", ["", "{", "[1]", "7", '{"view": "soon"}', '{"view": -1}', '{"view": NaN}', '{"view": [1]}'])
def test_a_file_that_is_none_of_durations_is_ignored_and_replaced(kept, text):
    kept.write_text(text)
    assert durations.expected("view", 9.0) == "about 9 s"
    durations.keep("view", 3.0)
    assert durations.expected("view", 9.0) == "3 s the last time here"


def test_a_failed_stage_and_a_folder_that_cannot_be_written_keep_nothing(kept, monkeypatch):
    with pytest.raises(ZeroDivisionError), durations.timed("view"):
        raise ZeroDivisionError
    assert not kept.exists()
    monkeypatch.setattr(durations, "CACHE_FOLDER", kept.parent / "a file" / "compiled" / "version")
    (kept.parent / "a file").write_text("")
    durations.keep("view", 3.0)
    assert durations.expected("view", 9.0) == "about 9 s"


def test_a_line_before_compiling_names_each_part_with_its_time():
    durations.keep("compiling planar", 120.0)
    line = announcement([Build("planar"), Build("slip", equilibrium=True)])
    assert line.startswith("compiling, once per version: planar 120 s the last time here, thermal equilibrium about ")


@pytest.mark.parametrize(("writable", "told", "built"), [(True, "once per version: slip about", ["slip"]), (False, "cannot be written", [])])
def test_a_run_compiles_ahead_only_where_its_code_can_be_kept(writable, told, built, monkeypatch):
    from bearing_sim.scene.loader import load_scene

    lines, compiled = [], []
    monkeypatch.setattr(precompilation, "is_compiled_for", lambda scene, with_states: False)
    monkeypatch.setattr(precompilation, "_can_keep", lambda: writable)
    monkeypatch.setattr(precompilation, "compile_all", lambda wanted: [compiled.append(str(each)) for each in wanted])
    precompilation.compile_for(load_scene("deng2017_table1"), lines.append)
    assert len(lines) == 1 and told in lines[0] and compiled == built
