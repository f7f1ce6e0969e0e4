"""Start bearing_node: ``ros2 launch bearing_sim live.launch.py scene:=deng2017_table1 record:=run.mcap``."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

# Name, default, type as the node declares it, and meaning.
ARGUMENTS = (
    ("scene", "deng2017_table1", str, "name of a bundled scene, or path of a scene file"),
    ("overrides", "['']", list[str], "scene fields to change, such as \"['lubricant.temperature=100degC']\""),
    ("joint", "shaft", str, "name of the shaft's joint in shaft_speed messages"),
    ("input_type", "stamped", str, "stamped: JointState and WrenchStamped; scalar: Float64 for both"),
    ("publish_rate", "50.0", float, "rate of the output topics [Hz]"),
    ("sample_rate", "100.0", float, "samples recorded for each simulated second [Hz]"),
    ("maximum_lag", "0.2", float, "lag behind real time that is caught up [s]; more is given up, counted and told"),
    ("record", "", str, "MCAP file to record from the start; empty for none"),
    ("rrd", "", str, "rerun recording to write from the start; empty for none"),
    ("rerun_port", "0", int, "port on 127.0.0.1 at which a rerun viewer can watch live; 0 for none"),
)


def generate_launch_description():
    """Return the launch description."""
    parameters = {name: ParameterValue(LaunchConfiguration(name), value_type=kind) for name, _, kind, _ in ARGUMENTS}
    return LaunchDescription(
        [DeclareLaunchArgument(name, default_value=default, description=meaning) for name, default, _, meaning in ARGUMENTS]
        + [
            DeclareLaunchArgument("namespace", default_value="", description="namespace of the node and its topics"),
            Node(
                package="bearing_sim",
                executable="bearing_node",
                name="bearing_node",
                namespace=LaunchConfiguration("namespace"),
                parameters=[parameters],
                output="screen",
            ),
        ]
    )
