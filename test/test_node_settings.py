# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A node whose bearing has a front falls to coarser tolerances of the same level first, and tells the errors that it runs at."""

import signal

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from test_governor_front import EVERYWHERE, NAMES  # noqa: E402
from test_node import FAST, ended_well  # noqa: E402

from bearing_sim import Simulation, load_scene  # noqa: E402
from bearing_sim.messages.events import Event  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.recording.writer import McapSink  # noqa: E402
from bearing_sim.runtime.governor import RECORD, recorded_settings  # noqa: E402
from bearing_sim.runtime.live import governor_of  # noqa: E402
from bearing_sim.runtime.reproduction import reproduce  # noqa: E402
from bearing_sim.scene.bundled import bundled_text  # noqa: E402
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, add_to_front, complete_overrides, keep, kept_path  # noqa: E402
from bearing_sim.scene.scene import tolerance_overrides  # noqa: E402

FINEST, OVERRIDES = 0.002, ["level=planar", *tolerance_overrides(0.002)]  # a tenth of real time or less


def measured(level, factor, times_real_time, slip, life):
    scene = load_scene("deng2017_table1", [f"level={level}", *tolerance_overrides(factor)])
    errors = dict.fromkeys(NAMES, np.nan) | {"slip": slip, "life": life}
    return Setting(level, f"tolerances x {factor:g}", complete_overrides(scene), times_real_time, errors)


@pytest.fixture(params=["kept", "named"])
def front(request, tmp_path):
    scene = load_scene("deng2017_table1", OVERRIDES)
    settings = measured("planar", FINEST, 0.05, 0.0001, 0.0001), measured("planar", 3.0, 6.9, 0.06, 0.012), measured("slip", 1.0, 15.0, 1.9, 0.12)
    course = MeasuredCourse("manoeuvre", "planar with tolerances x 0.001", dict.fromkeys(NAMES, 0.0), EVERYWHERE, settings)
    if request.param == "kept":
        yield settings, "deng2017_table1", keep(scene, course).name
        kept_path(scene).unlink()
        return
    (tmp_path / "rig.yaml").write_text(bundled_text("scenes", "deng2017_table1") + "front: rig.front.json\n")
    yield settings, tmp_path / "rig.yaml", add_to_front(tmp_path / "rig.front.json", scene, course).name


@pytest.mark.long
@pytest.mark.timeout(900)
def test_a_node_falls_along_the_front_and_its_recording_is_computed_again(front, tmp_path):
    settings, scene, name = front
    governor_of(Simulation(load_scene("deng2017_table1", OVERRIDES)))  # compiles what may not have been yet
    recording, domain = tmp_path / "run.mcap", fresh_domain()
    parameters = f"scene:={scene}", f"overrides:={OVERRIDES}", f"record:={recording}"
    process = NodeProcess(tmp_path, domain, "--ros-args", *(word for each in parameters for word in ("-p", each)))
    client = Client(domain)
    client.wait_until_matched(process)
    coarse, slip = settings[1].name, settings[2].name
    client.drive_until(lambda: client.values().get("setting") in (coarse, slip), "a faster setting runs", process, shaft_speed=FAST)
    values = client.values()
    errors = {coarse: (0.0006, 0.012), slip: (0.019, 0.12)}[values["setting"]]
    assert (float(values["measured slip error [fraction]"]), float(values["measured life error [fraction]"])) == pytest.approx(errors)
    assert f"the governor falls along measured settings of {name}: planar, tolerances x 0.002; planar, tolerances x 3" in process.text
    assert "level planar, tolerances x 0.002 reaches 0" in process.text and "(errors: slip 0.06 points, life 1.2 %) continues" in process.text
    assert ended_well(process, signal.SIGTERM)
    client.close()
    recorded = Recording(recording)
    known, running = recorded_settings(recorded.records[RECORD])
    changes = [item for item in recorded if isinstance(item, Event) and item.kind == "governor.change"]
    assert running == settings[0].name and changes[0].subject == coarse and set(known) >= {each.subject for each in changes}
    with McapSink(tmp_path / "again.mcap", recorded.scene, recorded.start_ns) as sink:
        result = reproduce(recorded, sink)
    assert result.level_changes >= 1
    first, second = (
        np.concatenate([item for item in Recording(file) if isinstance(item, np.ndarray)]) for file in (recording, tmp_path / "again.mcap")
    )
    assert np.nanmax(np.abs(first["cage_slip"] - second["cage_slip"])) < 0.002
