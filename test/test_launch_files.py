# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The launch files: what they declare, start and hand over; loaded by launch where it is installed, else by a stand-in."""

import ast
import importlib.util
import re
import shlex
from pathlib import Path
from types import SimpleNamespace

import launch_stand_in as stand_in
import pytest
import yaml

pytest.importorskip("rclpy", reason="the launch files take their arguments from the node's parameters, which need rclpy of ROS 2")

from bearing_sim.recording.priority import in_idle_time  # noqa: E402
from bearing_sim.ros.parameters import DECLARATIONS, SCENE_DECLARATIONS  # noqa: E402
from bearing_sim.ros.player import command as player_command  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402
from bearing_sim.view.viewer import stream_url, viewer_command  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
FILES = sorted((ROOT / "launch_scripts").glob("*.launch.py"))
SMALL_CORE = ROOT / "bearing_sim" / "ros" / "profiles" / "small_core.yaml"
EVERY_FILE = pytest.mark.parametrize("path", FILES, ids=lambda path: path.name.partition(".")[0])
PARAMETERS = {row.name: row for row in DECLARATIONS}


def load(path):
    spec = importlib.util.spec_from_file_location(path.name.replace(".", "_"), path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.generate_launch_description()


@pytest.fixture
def launched(monkeypatch):
    """Return a function that launches a file with arguments; it returns the declarations, the actions and the context."""
    stand_in.install(monkeypatch)

    def launch(name, /, **arguments):
        context, declarations, actions = stand_in.LaunchContext(**arguments), [], []
        for entity in load(ROOT / "launch_scripts" / f"{name}.launch.py").entities:
            if isinstance(entity, stand_in.DeclareLaunchArgument):
                declarations.append(entity)
            actions += entity.execute(context) or []
        for action in [action for action in actions if isinstance(action, stand_in.SetEnvironmentVariable)]:
            action.execute(context)
            actions.remove(action)
        return SimpleNamespace(declarations=declarations, actions=actions, context=context)

    return launch


def nodes(run, executable="bearing_node"):
    return [action for action in run.actions if isinstance(action, stand_in.Node) and action.executable == executable]


def handed_over(node, context):
    """Return the parameters as the node gets them: as launch writes them into a YAML file."""
    values = {}
    for name, parameter in node.parameters[0].items():
        if name == "use_sim_time":
            continue
        text = parameter.value.perform(context)
        kind = parameter.value_type
        values[name] = text if kind is str else kind(text) if kind in (int, float) else yaml.safe_load(text)
    return values


def test_the_four_launch_files_are_there():
    assert [path.name for path in FILES] == ["fleet.launch.py", "live.launch.py", "record.launch.py", "replay.launch.py"]


@EVERY_FILE
def test_every_argument_has_a_description_and_a_default_and_one_name(launched, path):
    declarations = launched(path.name.partition(".")[0]).declarations
    for argument in declarations:
        assert isinstance(argument.default_value, str) and isinstance(argument.description, str) and len(argument.description) > 10, argument.name
    names = [argument.name for argument in declarations]
    assert len(set(names)) == len(names)


@EVERY_FILE
def test_the_nodes_get_every_parameter_that_they_declare_and_no_other(launched, path):
    run = launched(path.name.partition(".")[0])
    assert nodes(run)
    for node in nodes(run):
        values = handed_over(node, run.context)
        assert set(values) == set(PARAMETERS)
        for name, value in values.items():
            assert type(value) is type(PARAMETERS[name].default), f"{name} = {value!r}"


@EVERY_FILE
def test_defaults_are_the_nodes_own_but_for_what_the_file_is_for(launched, path):
    run = launched(path.name.partition(".")[0])
    own = {"fleet": {"scene"}, "live": set(), "record": {"record"}, "replay": set()}[path.name.partition(".")[0]]
    for node in nodes(run):
        differing = {name for name, value in handed_over(node, run.context).items() if value != PARAMETERS[name].default}
        assert differing <= own


@EVERY_FILE
def test_processes_keep_to_this_machine_unless_the_user_has_set_something_else(launched, path, monkeypatch):
    name = path.name.partition(".")[0]
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE")
    assert launched(name).context.environment == {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    assert launched(name, discovery_range="SUBNET").context.environment == {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    with pytest.raises(AssertionError, match="not one of"):
        launched(name, discovery_range="EVERYWHERE")
    for variable, setting in (("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"), ("ROS_LOCALHOST_ONLY", "1")):
        with monkeypatch.context() as users:
            users.setenv(variable, setting)
            assert launched(name).context.environment == {}, "the user's setting holds"


@EVERY_FILE
def test_what_the_node_can_be_told_can_be_told_to_launch(launched, path):
    run = launched(path.name.partition(".")[0])
    names = {argument.name for argument in run.declarations}
    own = {"use_sim_time"} if "replay" in path.name else set()
    own |= {"scene", "record", "rrd", "rerun_port", "rerun_web_port", "serial", "state_file", "name"} if path.name.startswith("fleet") else set()
    wanted = {row.name for row in (*DECLARATIONS, *SCENE_DECLARATIONS)} | {"name", "namespace", "remaps", "log_level", "use_sim_time"}
    assert wanted - own <= names


def test_name_level_of_the_log_remappings_and_fields_of_the_scene_reach_the_node(launched):
    given = {"thresholds.slip_warning": "0.05", "lubricant.temperature": "90 degC", "use_sim_time": "true"}
    (node,) = nodes(run := launched("live", name="monitor", log_level="debug", remaps="shaft_speed:=/motor/joints 'a:=b'", **given))
    assert node.name == "monitor" and node.ros_arguments == ["--log-level", "debug"] and node.parameters[0]["use_sim_time"] is True
    assert node.remappings == [("shaft_speed", "/motor/joints"), ("a", "b")]
    values = handed_over(node, run.context)
    assert values["thresholds.slip_warning"] == 0.05 and values["lubricant.temperature"] == pytest.approx(363.15)


@pytest.mark.parametrize(
    ("file", "given", "said"),
    [
        ("live", {"publish_rate": "abc"}, "publish_rate = 'abc': expected a number; rate of the output topics"),
        ("live", {"publish_rate": "900"}, "publish_rate = 900: outside 0.1 to 200"),
        ("live", {"bearings": "front"}, r"bearings = 'front': expected a list of strings, such as \[front, rear\]"),
        ("live", {"governor": "perhaps"}, "governor = 'perhaps': expected true or false"),
        ("live", {"sample_rate": "x", "maximum_lag": "y"}, "sample_rate = 'x'.*maximum_lag = 'y'"),
        ("live", {"thresholds.slip_warning": "much"}, "thresholds.slip_warning = 'much'"),
        ("live", {"remaps": "shaft_speed"}, "remaps:=shaft_speed: expected FROM:=TO"),
        ("live", {"parameters_file": "missing.yaml"}, "parameters_file:=missing.yaml: no such file"),
        ("live", {"view": "true", "rerun_port": "abc"}, "rerun_port:=abc: expected a whole number"),
        ("replay", {"rate": "fast"}, "rate:=fast: expected a number"),
        ("fleet", {"first_rerun_port": "abc"}, "first_rerun_port:=abc: expected a whole number"),
    ],
)
def test_an_argument_that_cannot_be_used_is_named_with_the_form_expected(launched, file, given, said):
    with pytest.raises(RuntimeError, match=said):
        launched(file, **given)


def test_a_misspelt_argument_is_pointed_out(launched):
    (warning,) = [action for action in launched("live", publsh_rate="5").actions if isinstance(action, stand_in.LogInfo)]
    assert "publsh_rate" in warning.msg and "publish_rate" in warning.msg


def ended(code, name="bearing_node-1"):
    return SimpleNamespace(returncode=code, process_name=name)


def test_a_node_that_ends_with_an_error_ends_the_launch_with_one(launched):
    for file in ("live", "record", "replay"):
        run = launched(file)
        (node,) = nodes(run)
        with pytest.raises(RuntimeError, match="bearing_node-1 has ended with exit code 2"):
            node.on_exit(ended(2), run.context)
        run.context.is_shutdown = True
        assert node.on_exit(ended(-15), run.context) is None, "the launch itself ends it"


def test_a_node_of_a_fleet_that_fails_does_not_stop_the_others_but_the_launch_ends_with_an_error(launched):
    run = launched("fleet")
    front, rear = nodes(run)
    assert front.on_exit(ended(2, "front"), run.context) is None
    run.context.is_shutdown = True
    with pytest.raises(RuntimeError, match=r"1 of 2 nodes .* front \(exit code 2\)"):
        rear.on_exit(ended(0, "rear"), run.context)


@EVERY_FILE
def test_what_is_started_is_what_setup_installs(launched, path):
    points = {name.split(" = ")[0] for name in _literal_of_setup("console_scripts")}
    for action in launched(path.name.partition(".")[0]).actions:
        if isinstance(action, stand_in.Node):
            assert action.package == "bearing_sim" and action.executable in points and action.output == "screen"


def _literal_of_setup(key):
    for node in ast.walk(ast.parse((ROOT / "setup.py").read_text())):
        if isinstance(node, ast.Dict):
            for name, value in zip(node.keys, node.values):
                if isinstance(name, ast.Constant) and name.value == key:
                    return ast.literal_eval(value)
    raise AssertionError(f"setup.py has no {key}")


@EVERY_FILE
def test_arguments_reach_the_node_in_their_own_types(launched, path):
    given = {"publish_rate": "20", "overrides": "['level=slip', 'lubricant.temperature=100degC']", "governor": "false", "joint": "17"}
    run = launched(path.name.partition(".")[0], **given)
    values = handed_over(nodes(run)[0], run.context)
    assert values["publish_rate"] == 20.0 and isinstance(values["publish_rate"], float)
    assert values["overrides"] == ["level=slip", "lubricant.temperature=100degC"]
    assert values["governor"] is False and values["joint"] == "17"


@EVERY_FILE
def test_a_file_of_parameters_comes_after_the_arguments_and_so_counts_more(launched, path, tmp_path):
    name, mine = path.name.partition(".")[0], tmp_path / "mine.yaml"
    mine.write_text("")
    assert not [one for one in nodes(launched(name))[0].parameters if isinstance(one, str)]
    assert nodes(launched(name, parameters_file=str(mine)))[0].parameters[-1] == str(mine)


@EVERY_FILE
def test_a_profile_replaces_defaults_and_what_is_given_replaces_the_profile(launched, path):
    name = path.name.partition(".")[0]
    profile = yaml.safe_load(SMALL_CORE.read_text())["/**"]["ros__parameters"]
    run, plain = launched(name, profile="small_core"), launched(name)
    for node, without in zip(nodes(run), nodes(plain)):
        found, usual = handed_over(node, run.context), handed_over(without, plain.context)
        assert {key: found[key] for key in profile} == profile and all(
            found[key] == usual[key] for key in usual if key not in profile | {"record": ""}
        )
    run = launched(name, profile="small_core", publish_rate="50.0", overrides="['lubricant.mixture_fraction=0.02']")
    found = handed_over(nodes(run)[0], run.context)
    assert found["publish_rate"] == 50.0, "although this is the default"
    assert found["overrides"] == ["level=steady", "lubricant.mixture_fraction=0.02"] and found["sample_rate"] == profile["sample_rate"]
    run = launched(name, profile="small_core", overrides="")
    assert handed_over(nodes(run)[0], run.context)["overrides"] == ["level=steady"]
    for wrong in ("5", "level=slip"):
        with pytest.raises(RuntimeError, match=f"overrides = '?{wrong}'?: expected a list"):
            launched(name, profile="small_core", overrides=wrong)


def test_a_profile_holds_parameters_of_the_node_in_their_types_and_a_scene_that_loads():
    profile = yaml.safe_load(SMALL_CORE.read_text())["/**"]["ros__parameters"]
    for key, given in profile.items():
        assert type(given) is type(PARAMETERS[key].default) and given != PARAMETERS[key].default
    assert load_scene("deng2017_table1", profile["overrides"]).level == "steady"
    assert not {"record", "rrd", "rerun_port", "rerun_web_port"} & set(profile), "off by default"


def test_a_live_launch_opens_a_viewer_once_when_the_node_is_ready(launched):
    assert [type(action) for action in launched("live", rerun_port="9900").actions] == [stand_in.Node], "no viewer unless wanted"
    run = launched("live", view="true")
    assert handed_over(nodes(run)[0], run.context)["rerun_port"] > 1024, "a free port"
    run = launched("live", view="true", rerun_port="9900")
    assert handed_over(nodes(run)[0], run.context)["rerun_port"] == 9900
    (handler,) = [action.event_handler for action in run.actions if isinstance(action, stand_in.RegisterEventHandler)]
    assert handler.target_action is nodes(run)[0]
    assert handler.on_stderr(SimpleNamespace(text=b"warming up")) is None
    viewer = handler.on_stderr(SimpleNamespace(text=b"[INFO] [bearing_node]: ready: listening to shaft_speed"))
    command = viewer_command(stream_url(9900))
    assert Path(command[0]).name == "rerun" and command[-1] == "rerun+http://127.0.0.1:9900/proxy"
    assert command[1:5] == ["--bind", "127.0.0.1", "--port", "auto"], "it listens to this machine only, and collides with no other viewer"
    assert viewer.cmd == in_idle_time(command), "drawing shall not hold up the solver"
    assert handler.on_stderr(SimpleNamespace(text=b"ready: listening")) is None, "one viewer only"


def test_the_words_that_open_the_viewer_are_logged_by_the_node(launched):
    launched("live")
    from bearing_sim.ros.launching import READY

    sources = "".join(path.read_text() for path in (ROOT / "bearing_sim" / "ros").glob("*.py") if path.name != "launching.py")
    assert f'"{READY.decode()}' in sources


def test_a_recording_launch_records_to_a_fresh_file_and_says_where(launched):
    run = launched("record")
    (said,) = [action for action in run.actions if isinstance(action, stand_in.LogInfo)]
    record = handed_over(nodes(run)[0], run.context)["record"]
    assert record.endswith(".mcap") and record in said.msg
    run = launched("record", record="mine.mcap")
    assert handed_over(nodes(run)[0], run.context)["record"] == "mine.mcap"
    with pytest.raises(RuntimeError, match="record is empty"):
        launched("record", record="")


def test_a_replay_plays_the_log_to_the_node_and_ends_when_either_has_ended(launched):
    run = launched("replay", log="flights/a 1.mcap", rate="2", input_type="scalar", joint="rotor", namespace="/m1")
    (node,), (player,) = nodes(run), nodes(run, "bearing_player")
    for process in (node, player):
        (end,) = process.on_exit(ended(0), run.context)
        assert isinstance(end, stand_in.Shutdown) and end.reason.endswith("has ended")
    assert node.namespace == player.namespace == "/m1"
    taken = player_command.make_context("bearing_player", list(player.arguments)).params
    assert str(taken["log"]) == "flights/a 1.mcap" and taken["rate"] == 2.0 and taken["wait_limit"] == 600.0
    assert taken["input_type"] == handed_over(node, run.context)["input_type"] == "scalar"
    assert taken["joint"] == handed_over(node, run.context)["joint"] == "rotor"


def test_a_replay_goes_by_the_clock_of_its_player_unless_none_is_wanted(launched):
    run = launched("replay", log="a.mcap", cage_joint="m1_cage", loop="true", start_paused="true")
    (node,), (player,) = nodes(run), nodes(run, "bearing_player")
    taken = player_command.make_context("bearing_player", list(player.arguments)).params
    assert taken["clock_rate"] == 100.0 and taken["use_limit"] == 3600.0 and taken["loop"] and taken["start_paused"]
    assert node.parameters[0]["use_sim_time"] is True and taken["cage_joint"] == "m1_cage"
    run = launched("replay", log="a.mcap", clock="0")
    taken = player_command.make_context("bearing_player", list(nodes(run, "bearing_player")[0].arguments)).params
    assert taken["clock_rate"] is None and "use_sim_time" not in nodes(run)[0].parameters[0] and not taken["loop"]


def test_a_fleet_gives_every_bearing_its_scene_namespace_name_recording_and_port(launched):
    run = launched("fleet", bearings="front=deng2017_table1 'rear=my scenes/b.yaml'", record_folder="out", first_rerun_port="9900", namespace="/ship")
    front, rear = nodes(run)
    assert (front.namespace, front.name) == ("/ship/front", "bearing_front") and (rear.namespace, rear.name) == ("/ship/rear", "bearing_rear")
    first, second = handed_over(front, run.context), handed_over(rear, run.context)
    assert (first["scene"], first["rerun_port"], second["scene"], second["rerun_port"]) == ("deng2017_table1", 9900, "my scenes/b.yaml", 9901)
    moment = r"\d{4}-\d\d-\d\d_\d{6}"
    assert re.fullmatch(rf"out/front_{moment}\.mcap", first["record"]) and re.fullmatch(rf"out/rear_{moment}\.mcap", second["record"])


def test_a_fleet_in_one_process_is_one_node_that_gets_each_bearings_own_parameters_by_its_name(launched):
    given = {"bearings": "front=deng2017_table1 'rear=my scenes/b.yaml'", "record_folder": "out", "first_rerun_port": "9900", "namespace": "/ship"}
    run = launched("fleet", one_process="true", publish_rate="20", **given)
    (node,) = nodes(run)
    assert (node.namespace, node.name) == ("/ship", "bearing_node")
    values = handed_over(node, run.context)
    assert values["bearings"] == ["front", "rear"] and values["publish_rate"] == 20.0
    assert set(values) == set(PARAMETERS) | {
        f"{name}.{key}" for name in ("front", "rear") for key in ("scene", "record", "rrd", "rerun_port", "rerun_web_port", "serial", "state_file")
    }
    assert (values["front.scene"], values["rear.scene"], values["rear.rerun_port"]) == ("deng2017_table1", "my scenes/b.yaml", 9901)
    assert values["front.record"] != values["rear.record"] and values["record"] == ""


def test_a_node_that_others_manage_is_told_so_by_an_argument(launched):
    assert handed_over(nodes(launched("live"))[0], launched("live").context)["autostart"] is True
    run = launched("live", autostart="false")
    assert handed_over(nodes(run)[0], run.context)["autostart"] is False


def test_a_fleets_default_bearings_are_bundled_scenes_without_recordings_and_viewers(launched):
    run = launched("fleet")
    for node in nodes(run):
        values = handed_over(node, run.context)
        assert load_scene(values["scene"]) and values["record"] == values["rrd"] == "" and values["rerun_port"] == 0
    assert [node.namespace for node in nodes(run)] == ["front", "rear"]


def test_bearings_of_a_fleet_have_serial_numbers_of_their_own(launched):
    run = launched("fleet", serials="rear=B2 front=A1")
    assert [handed_over(node, run.context)["serial"] for node in nodes(run)] == ["A1", "B2"]
    run = launched("fleet", serials="rear=B2", one_process="true")
    values = handed_over(nodes(run)[0], run.context)
    assert (values["serial"], values["front.serial"], values["rear.serial"]) == ("", "", "B2")
    with pytest.raises(RuntimeError, match="serials: middle: no such bearing; bearings has front, rear"):
        launched("fleet", serials="middle=C3")


@pytest.mark.parametrize(
    ("bearings", "reason"),
    [("", "is empty"), ("front", "not NAME=SCENE"), ("front=", "not NAME=SCENE"), ("2nd=a", "not NAME=SCENE"), ("a=x a=y", "is given twice")],
)
def test_bearings_that_cannot_be_a_fleet_are_refused_with_the_reason(launched, bearings, reason):
    with pytest.raises(RuntimeError, match=reason):
        launched("fleet", bearings=bearings)


@EVERY_FILE
def test_each_launch_file_tells_a_command_that_exists(path):
    text = ast.get_docstring(ast.parse(path.read_text()))
    words = shlex.split(text.split("``")[1])
    assert words[:4] == ["ros2", "launch", "bearing_sim", path.name]


@EVERY_FILE
def test_launch_itself_loads_each_file_where_it_is_installed(path):
    pytest.importorskip("launch_ros", reason="launch and launch_ros are no wheels; apt has them with ROS 2")
    from launch import LaunchContext
    from launch.actions import DeclareLaunchArgument, OpaqueFunction
    from launch_ros.actions import Node

    context, started = LaunchContext(), []
    for entity in load(path).entities:
        if isinstance(entity, DeclareLaunchArgument):
            assert entity.description and entity.default_value is not None
        found = entity.execute(context) or []
        started += found if isinstance(entity, OpaqueFunction) else []
    assert any(isinstance(action, Node) for action in started)
