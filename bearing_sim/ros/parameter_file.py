# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Write a file of all parameters with their defaults and meanings: ``python -m bearing_sim.ros.parameter_file > my_node.yaml``."""

import json

from bearing_sim.ros.parameters import DECLARATIONS, SCENE_DECLARATIONS, Declaration

_HEAD = """# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Every parameter of bearing_node at its default: bearing_node --ros-args --params-file THIS_FILE
# Made by python -m bearing_sim.ros.parameter_file; * marks what can be changed while the node runs, all else needs a re-configure.
# Several bearings in one node: bearings: [front, rear], and below that front: {scene: a.yaml, joint: front_shaft} and so on.
# What a scene file says about its oil's temperature and its thresholds is replaced by what stands here: leave out what shall be the scene's.
"""


def parameter_file() -> str:
    """Return the text of the file."""
    lines = [_HEAD + "/**:", "  ros__parameters:"]
    blocks: list[str] = []
    for row in (*DECLARATIONS, *SCENE_DECLARATIONS):
        *path, name = row.name.split(".")
        shared = next((depth for depth, pair in enumerate(zip(path, blocks)) if pair[0] != pair[1]), min(len(path), len(blocks)))
        lines += [f"{'  ' * (2 + depth)}{path[depth]}:" for depth in range(shared, len(path))]
        blocks = path
        lines += [f"{'  ' * (2 + len(path))}{text}" for text in (_comment(row), f"{name}: {_value(row.default)}")]
    return "\n".join(lines) + "\n"


def _comment(row: Declaration) -> str:
    choices = f" ({', '.join(row.choices)})" if row.choices else ""
    return f"# {'* ' if row.running else ''}{row.meaning}{choices}"


def _value(default: object) -> str:
    return repr(default) if isinstance(default, float) else json.dumps(default)  # ROS takes a number without a point for a whole one


if __name__ == "__main__":
    print(parameter_file(), end="")
