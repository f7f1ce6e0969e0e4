# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What was dropped is counted: in every reader, in the result, and in the exit code."""

import json
from collections import Counter

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import JOINTS, SECOND, WRENCH, flipped, joint_state, steady_log, truncated, wrench
from synthetic_run import synthetic_block

from bearing_sim.cli.main import main
from bearing_sim.cli.reporting import EXIT_CODES, Ending
from bearing_sim.files.tally import PartlyUsedWarning, Tally
from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.recording.bag import PartialRecording
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapFile, McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

pytestmark = pytest.mark.filterwarnings("ignore::bearing_sim.files.tally.PartlyUsedWarning")
SCENE = load_scene("deng2017_table1")
START = 1_700_000_000 * SECOND
SPACING = 0.05  # [s] between messages of a channel
YEAR = 365.25 * 86_400.0


def log_of(path, speed_offset, load_offset=None, count=200):
    """Write speed and load at 20 Hz; each offset(k) [s] shifts the k-th stamp from the time of recording, None leaves the message out."""
    with McapFile(path) as recording:
        for k in range(count):
            logged = START + round(k * SPACING * SECOND)
            for offset, topic, kind, message in (
                (speed_offset, "/shaft_speed", JOINTS, lambda stamp: joint_state(stamp, 314.0)),
                (load_offset or speed_offset, "/radial_load", WRENCH, lambda stamp: wrench(stamp, 5000.0)),
            ):
                if (shift := offset(k)) is not None:
                    recording.write(topic, kind, logged, message(logged + round(shift * SECOND)))
    return path


def judged(path, stamps="header"):
    return judge(read_input_log(path, stamps=stamps), InputLimits(), Inputs(0.0, 0.0, 0.0, 350.0))


def steps(*at):
    """Return the offset that steps back by some seconds at some messages: (message, seconds) pairs."""
    return lambda k: -sum(seconds for place, seconds in at if k >= place)


@pytest.mark.parametrize(
    "speed, load, refused, dropped",
    [
        (steps((20, 20.0)), None, 2 * 180, 9.0),
        (steps((20, 0.5)), None, 2 * 10, 0.5),
        (steps((20, 0.5), (100, 1.0)), None, 2 * 30, 1.5),
        (steps((20, 20.0)), steps(), 180, 9.0),
        (steps(), steps((100, 3600.0)), 100, 5.0),
        (lambda k: 0.0 if k < 20 else -SPACING * (k - 19), None, 2 * 180, 9.0),  # stamps stand still to the end
        (lambda k: -SPACING * (k - 19) if 20 <= k < 30 else 0.0, None, 2 * 10, 0.0),  # and go on where the clock is
        (lambda k: -0.12 if k == 50 else 0.0, None, 2, 0.0),  # one message out of order
        (lambda k: YEAR if k == 20 else 0.0, None, 2 * 179, 8.95),  # one stamp of the next year
    ],
)
def test_the_time_that_stamps_drop_is_told_by_the_clock_of_the_recording(tmp_path, speed, load, refused, dropped):
    """Of a log of 9.95 s; the expected seconds are spacings of messages times their number."""
    path = log_of(tmp_path / "log.mcap", speed, load)
    course = judged(path)
    old = sum(course.tally.refused[f"input.time_{kind}"] for kind in ("backwards", "repeated"))
    assert course.tally.there == 400 and old == refused and course.tally.used == 400 - course.tally.refused.total()
    assert course.dropped_seconds == pytest.approx(dropped, abs=1e-6) and course.unknown_seconds == pytest.approx(dropped, abs=1e-6)
    assert course.log_seconds == pytest.approx(9.95, abs=1e-6) or course.log_seconds > YEAR
    with pytest.warns(PartlyUsedWarning, match="--stamps log"):
        judged(path)
    by_log = judged(path, "log")
    assert by_log.tally.is_whole and by_log.end == pytest.approx(9.95 * SECOND)


def test_a_jump_of_the_stamps_by_a_year_uses_everything_and_is_noted(tmp_path):
    course = judged(log_of(tmp_path / "log.mcap", lambda k: YEAR if k >= 100 else 0.0))
    assert course.tally.is_whole and len(course.tally.notes) == 2 and "stamps jump by 3.156e+07 s within 0.05 s" in course.tally.notes[0]


def test_messages_of_a_channel_while_the_other_one_is_silent_are_not_used(tmp_path):
    course = judged(log_of(tmp_path / "log.mcap", lambda k: 0.0, lambda k: 0.0 if k < 100 else None))
    late = 200 - 100 - round(1.0 / SPACING)  # after the second for which a load counts
    assert course.tally.there == 300 and course.tally.used == 300 - late and course.tally.refused == {"no radial_load at that time": late}


def test_replay_of_a_part_ends_with_code_3_the_counts_the_seconds_and_the_way_out(tmp_path):
    log = log_of(tmp_path / "log.mcap", steps((20, 20.0)))
    ran = CliRunner().invoke(main, ["replay", str(log), "--scene", "deng2017_table1", "--json"])
    report = json.loads(ran.stdout)
    assert ran.exit_code == 3 and (report["read"]["there"], report["read"]["used"]) == (400, 40)
    assert report["log_seconds"] == pytest.approx(9.95) and report["unknown_seconds"] == pytest.approx(9.0)
    for words in ("40 of 400 messages used (360 x input.time_backwards)", "--stamps log", "9 s of 9.95 s", "9 s of that are not simulated"):
        assert words in ran.stderr
    whole = CliRunner().invoke(main, ["replay", str(log), "--scene", "deng2017_table1", "--stamps", "log"])
    assert whole.exit_code == 0 and "400 of 400 messages used" in whole.stdout and whole.stderr == ""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.mcap"
    with McapSink(path, SCENE, START) as sink:
        for begin in range(0, 400, 20):
            sink.write(synthetic_block(SCENE, 0.001 * np.arange(begin + 1, begin + 21)))
    return path


def without_index(path, target):
    """Copy a file without what follows its data: the summary, which has the index, and the end."""
    return truncated(path, target, path.read_bytes().rindex(b"\x0f\x04\0\0\0\0\0\0\0"))  # the record that ends the data


def damaged(run, folder):
    size = run.stat().st_size
    yield truncated(run, folder / "cut.mcap", size // 2)
    yield flipped(run, folder / "flipped.mcap", size // 2)
    yield without_index(run, folder / "lost.mcap")


def test_a_damaged_recording_raises_in_python_after_all_that_can_be_read_unless_a_part_is_asked_for(run, tmp_path):
    for path in damaged(run, tmp_path):
        read = []
        with pytest.raises(PartialRecording, match=r"samples used.*bearing-sim recover .*allow_partial=True") as raised:
            read += Recording(path)
        allowed = Recording(path, allow_partial=True)
        blocks = [item for item in allowed if isinstance(item, np.ndarray)]
        assert raised.value.tally.used == allowed.tally.used == sum(map(len, blocks)) > 100 and not allowed.tally.is_whole


def test_of_a_recording_with_an_index_the_samples_that_are_missing_are_counted(run, tmp_path):
    recording = Recording(flipped(run, tmp_path / "flipped.mcap", run.stat().st_size // 2), allow_partial=True)
    read = sum(len(item) for item in recording if isinstance(item, np.ndarray))
    assert recording.tally.there == 400 and recording.tally.refused == {"not readable": 400 - read} and 0 < read < 400


@pytest.mark.parametrize("command, suffix", [("to-csv", ".csv"), ("to-parquet", ".parquet"), ("plot", ".png")])
def test_commands_use_the_readable_part_of_a_recording_and_end_with_code_3(run, tmp_path, command, suffix):
    broken = flipped(run, tmp_path / "flipped.mcap", run.stat().st_size // 2)
    ran = CliRunner().invoke(main, [command, str(broken), "-o", str(tmp_path / f"out{suffix}")])
    assert ran.exit_code == 3 and "of 400 samples used" in ran.stderr and "bearing-sim recover" in ran.stderr, ran.output
    assert (tmp_path / f"out{suffix}").stat().st_size > 0
    whole = CliRunner().invoke(main, [command, str(run), "-o", str(tmp_path / f"whole{suffix}")])
    assert whole.exit_code == 0, whole.output


def test_a_log_that_is_cut_short_is_used_and_its_replay_ends_with_code_3(tmp_path):
    whole = steady_log(tmp_path / "log.mcap", duration=1.0)
    cut = truncated(whole, tmp_path / "log.mcap.active", whole.stat().st_size - 20)
    ran = CliRunner().invoke(main, ["replay", str(cut), "--scene", "deng2017_table1"])
    assert ran.exit_code == 3 and "22 of 22 messages used; log.mcap.active: ends early" in ran.stderr and "bearing-sim recover" in ran.stderr


def test_the_documented_exit_codes_are_those_that_commands_end_with():
    found = {kind.exit_code: kind.__doc__ for kind in Ending.__subclasses__()}
    assert set(found) <= set(EXIT_CODES) and all(f"exit code {code}" in text for code, text in found.items())
    assert "3: success, but only a part of the input" in " ".join(CliRunner().invoke(main, ["--help"]).output.split())


def test_tallies_add_up_and_say_everything_once():
    total = Tally(there=3, used=2, refused=Counter(late=1), remedies=["wait"])
    other = Tally()
    other.use(4)
    other.refuse("late", 2)
    other.unread.append("ends early")
    other.remedies.append("wait")
    total.add([other])
    assert (total.there, total.used, total.refused) == (9, 6, {"late": 3}) and not total.is_whole
    assert total.text == "6 of 9 messages used (3 x late); ends early; wait"
