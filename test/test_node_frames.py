# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A bearing in a machine of frames, over real topics: its own transform is published, and loads of other frames are turned.

tf2_msgs is in no wheel.  A package of this name stands in for it, whose TFMessage is some other message: the node reads and writes the bytes of
transforms itself, so that only the name of the type on the wire differs.
"""

import importlib.util
import os
import signal
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402
from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402
from std_msgs.msg import String  # noqa: E402

from bearing_sim.inputs.static_transforms import Transform  # noqa: E402
from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.messages.cdr import message_type  # noqa: E402
from bearing_sim.recording.reader import Received, Recording  # noqa: E402
from bearing_sim.recording.writer import McapSink  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402
from bearing_sim.ros.parameters import DECLARATIONS, SettingsError, checked  # noqa: E402
from bearing_sim.ros.transforms import TransformInterface  # noqa: E402
from bearing_sim.runtime.reproduction import reproduce  # noqa: E402

pytestmark = pytest.mark.timeout(240)
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
TF = "tf2_msgs/msg/TFMessage"
STORE = get_typestore(Stores.ROS2_JAZZY)
QUARTER = np.sqrt(0.5)


@pytest.fixture(scope="module")
def stand_in(tmp_path_factory):
    """Return a folder with a package tf2_msgs."""
    folder = tmp_path_factory.mktemp("tf2")
    (folder / "tf2_msgs" / "msg").mkdir(parents=True)
    (folder / "tf2_msgs" / "__init__.py").touch()
    (folder / "tf2_msgs" / "msg" / "__init__.py").write_text("from std_msgs.msg import String as TFMessage\n")
    return folder


@pytest.fixture
def installed(stand_in, monkeypatch):
    """Let this process find the stand-in."""
    message_class.cache_clear()
    monkeypatch.syspath_prepend(stand_in)
    yield
    message_class.cache_clear()
    for name in ("tf2_msgs", "tf2_msgs.msg"):
        sys.modules.pop(name, None)


def wrench(frame, **force):
    fields = topics.INPUTS["radial_load"].message(time.time_ns(), GOOD)
    fields["header"]["frame_id"], fields["wrench"]["force"] = frame, dict.fromkeys("xyz", 0.0) | force
    return message(topics.INPUTS["radial_load"].ros_type, fields)


@pytest.mark.long
def test_a_bearing_in_a_machine_publishes_where_it_is_and_takes_loads_from_other_frames(stand_in, tmp_path):
    """The bearing is rolled by a quarter in its gearbox, so that a load down the gearbox's z is one along its own -y."""
    domain, path = fresh_domain(), tmp_path / "run.mcap"
    pose = ["frame_position:=[0.5, 0.0, 0.0]", f"frame_orientation:=[{np.pi / 2}, 0.0, 0.0]"]
    words = ["governor:=false", "frame_id:=rear", "parent_frame:=gearbox", *pose]
    pairs = [word for parameter in (*words, f"record:={path}") for word in ("-p", parameter)]
    paths = os.pathsep.join(filter(None, (str(stand_in), os.environ.get("PYTHONPATH"))))
    process = NodeProcess(tmp_path, domain, "--ros-args", *pairs, limit=230, PYTHONPATH=paths)
    client, heard = Client(domain), []
    # Not by the client's ears, which deserialise.
    client.node.create_subscription(String, "/tf_static", heard.append, LATCHED, raw=True)
    try:
        client.wait_until_matched(process)
        client.spin_until(lambda: heard, "the transform of the bearing comes, also after it was sent", process)
        (pose,) = STORE.deserialize_cdr(heard[0], TF).transforms
        assert (pose.header.frame_id, pose.child_frame_id, pose.transform.translation.x) == ("gearbox", "rear", 0.5)
        turn = pose.transform.rotation
        assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx((QUARTER, 0.0, 0.0, QUARTER))
        client.drive_until(lambda: client.received["rollers"], "the node runs", process)
        send = client.publishers["radial_load"].publish

        def driven(**force):
            client.send("shaft_speed")
            send(wrench("gearbox", **force))

        def loaded(expected):
            driven(x=7.0, z=-640.0)
            return client.values().get("radial load [N]") == expected

        client.drive = lambda seconds, *_, **__: (client.send("shaft_speed"), client.spin(0.05))
        client.drive_until(lambda: loaded("640"), "a load in the gearbox counts", process)
        seen = len(client.received["diagnostics"])
        unknown = ["'dyno', expected 'rear' (parameter frame_id)", "no static transforms join 'dyno' and 'rear'; /tf_static has 'gearbox', 'rear'"]

        def refused():
            send(wrench("dyno", y=123.0))
            return [text for _, name, text in client.statuses(seen) if "input.frame" in name and all(part in text for part in unknown)]

        client.drive_until(refused, "a load in a frame that nothing joins is refused by name", process)
        others = client.node.create_publisher(String, "/tf_static", LATCHED)
        pose = [("gearbox", "dyno", (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))]
        others.publish(message_type(TF).serialize(topics.transforms(1, pose)))

        def turned():
            client.send("shaft_speed")
            send(wrench("dyno", z=-1230.0))
            return client.values().get("radial load [N]") == "1230"

        client.drive_until(turned, "a load counts once its frame is known", process)
        frames = {client.received[name][-1].header.frame_id for name in ("rollers", "bearing_joints", "bearing_state", "characteristic_frequencies")}
        assert frames == {"rear"}
        assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text, process.text
    finally:
        client.close()
        process.end(signal.SIGKILL)
    recording = Recording(path)
    loads = [STORE.deserialize_cdr(item.data, item.ros_type) for item in recording.with_received() if item_is_load(item)]
    found = {(load.header.frame_id, round(load.wrench.force.y, 9), round(load.wrench.force.z, 9)) for load in loads}
    assert {("rear", -640.0, 0.0), ("rear", -1230.0, 0.0)} <= found, "recorded as the model had them, in the bearing's frame"
    samples = [item for item in recording if isinstance(item, np.ndarray)]
    with McapSink(tmp_path / "again.mcap", recording.scene, recording.start_ns) as sink:
        reproduce(recording, sink)
    again = Recording(tmp_path / "again.mcap")
    repeated = [item.data for item in again.with_received() if item_is_load(item)]
    assert repeated == [item.data for item in recording.with_received() if item_is_load(item)], "the log of inputs repeats to the byte"
    assert {-640.0, -1230.0} <= set(np.round(np.concatenate(samples)["load_y"], 9))


def item_is_load(item):
    return isinstance(item, Received) and item.topic == "/radial_load"


@pytest.mark.parametrize(
    "name, value, reason",
    [
        ("frame_orientation", [1, 2], r"frame_orientation = \[1.0, 2.0\]: expected roll, pitch, yaw \[rad\], or a quaternion"),
        ("frame_orientation", [0.0, 0.0, 0.0, 3.0], "a quaternion of length 3, expected 1"),
        ("frame_position", [1.0, 2.0], "frame_position = .*expected 3 finite numbers"),
        ("frame_position", [1.0, 2.0, float("nan")], "expected 3 finite numbers"),
        ("frame_position", "here", "frame_position = 'here': expected numbers, such as"),
        ("frame_position", 5.0, "frame_position = 5.0: expected numbers, such as"),
        ("frame_position", ["a", "b", "c"], "frame_position = "),
    ],
)
def test_a_pose_that_is_none_is_refused_by_the_name_of_its_parameter(name, value, reason):
    (declaration,) = [row for row in DECLARATIONS if row.name == name]
    with pytest.raises(ValueError, match=reason):
        checked(declaration, name, value)


def test_integers_are_a_position_and_three_angles_or_a_quaternion_are_an_orientation():
    position, orientation = ([row for row in DECLARATIONS if row.name == name][0] for name in ("frame_position", "frame_orientation"))
    assert checked(position, "rear.frame_position", [1, 0, 2]) == [1.0, 0.0, 2.0]
    assert checked(orientation, "frame_orientation", (0, 0, 0, 1)) == [0.0, 0.0, 0.0, 1.0]


def settings(parent, frame):
    return SimpleNamespace(parent_frame=parent, frame=frame, transform=Transform(parent, frame))


@pytest.mark.parametrize(
    "bearings, texts",
    [
        ([settings("bearing", "bearing")], ["parent_frame = 'bearing'", "its own parent"]),
        ([settings("a", "bearing"), settings("b", "bearing")], ["frame_id = 'bearing'", "2 bearings", "NAME.frame_id"]),
    ],
)
def test_frames_that_make_no_tree_are_refused(bearings, texts, installed):
    with pytest.raises(SettingsError) as told:
        TransformInterface(None, bearings)
    assert all(text in str(told.value) for text in texts), told.value


@pytest.mark.skipif(importlib.util.find_spec("tf2_msgs") is not None, reason="tf2_msgs is installed")
def test_without_tf2_msgs_a_parent_frame_is_refused_and_everything_else_works():
    with pytest.raises(SettingsError, match="parent_frame = 'gearbox': .*tf2_msgs, which is not installed"):
        TransformInterface(None, [settings("gearbox", "bearing")])
    with pytest.raises(LookupError, match="tf2_msgs"):
        TransformInterface(None, []).transforms.rotation("dyno", "bearing")
