# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Fill ROS message objects from the plain dicts of `bearing_sim.topics`."""

import array
import importlib
from functools import cache

import numpy as np


@cache
def message_class(ros_type: str):
    """Return the class of ``"package/msg/Type"`` (``"package/Type"`` will do).

    Raises
    ------
    ModuleNotFoundError
        The package of messages is not installed.
    """
    package, _, name = ros_type.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), name.rpartition("/")[2])


def message(ros_type: str, fields: dict):
    """Return a message of that type with those fields."""
    filled = message_class(ros_type)()
    fill(filled, fields)
    return filled


def fill(target, fields: dict) -> None:
    """Set the fields of a message object, nested ones too.

    Raises
    ------
    AttributeError
        The message has no such field.
    """
    kinds = target.get_fields_and_field_types()
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(target, name), value)
        elif isinstance(value, np.ndarray):
            setattr(target, name, array.array("d", value.tolist()))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            item_type = kinds[name].removeprefix("sequence<").partition(">")[0]
            setattr(target, name, [message(item_type, item) for item in value])
        else:
            setattr(target, name, value)
