# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where an input is found in a recording that others wrote: topic, field of its messages, unit."""

import re
from typing import NamedTuple

from bearing_sim import topics
from bearing_sim.quantity import to_si

UNITS = {"shaft_speed": "rad/s", "radial_load": "N", "oil_temperature": "K", topics.MEASURED: "rad/s"}
_STEP = re.compile(r"\.?([A-Za-z_]\w*)|\[(-?\d+)\]")


class Source(NamedTuple):
    """Where a channel's numbers are.

    Attributes
    ----------
    topic : full topic name.
    fields : path of each number in the message (``"velocity[0]"``); none for the standard types of `bearing_sim.topics.input_types`.
    scale, offset : SI number = ``scale`` times the message's + ``offset``.
    """

    topic: str
    fields: tuple[str, ...] = ()
    scale: float = 1.0
    offset: float = 0.0


def source(channel: str, text: str | None = None, unit: str | None = None) -> Source:
    """Return where a channel is.

    Parameters
    ----------
    channel : ``shaft_speed``, ``radial_load``, ``oil_temperature`` or ``cage_speed_measured``.
    text : ``/topic`` (its slash may be left out), or ``/topic.path.to[0].number``; a load may have two, ``/topic.force.y,force.z``. The
        channel's own name where absent.
    unit : of the numbers, such as ``rpm``; rad/s, N or degC where absent.  With standard types too.

    Raises
    ------
    ValueError
        A path or a unit cannot be read, or there are too many paths.
    """
    topic, _, path = (text or channel).partition(".")
    fields = tuple(part.strip().lstrip(".") for part in path.split(",")) if path else ()
    if any(not field or _STEP.sub("", field) for field in fields):
        raise ValueError(f"{text}: cannot read the path of a field; expected something like /servo/state.velocity[0]")
    if len(fields) > (2 if channel == "radial_load" else 1):
        raise ValueError(f"{text}: {channel} has {len(fields)} fields, expected one{', or y and z' if channel == 'radial_load' else ''}")
    scale, offset = _conversion(channel, unit or ("degC" if channel == "oil_temperature" and fields else None))
    return Source(topic if topic.startswith("/") else f"/{topic}", fields, scale, offset)


def _conversion(channel: str, unit: str | None) -> tuple[float, float]:
    if not unit:
        return 1.0, 0.0
    offset, one = (to_si(f"{number} {unit}", UNITS[channel]) for number in (0, 1))
    return one - offset, offset


def source_values(channel: str, where: Source, ros_type: str, message, joint: str) -> tuple[float, ...]:
    """Return the SI numbers of a message, as `bearing_sim.topics.input_values` does for the standard types.

    Raises
    ------
    ValueError
        The message has no such field, or it is no number.
    """
    if not where.fields:
        numbers = topics.input_values(channel, ros_type, message, joint)
        if where.scale == 1.0 and not where.offset:
            return numbers
        if channel == "oil_temperature":  # the type says degC, its sender says otherwise
            numbers = tuple(number - topics.ZERO_CELSIUS for number in numbers)
    else:
        numbers = tuple(_number(message, field) for field in where.fields)
    return tuple(where.scale * number + where.offset for number in numbers)


def _number(message, path: str) -> float:
    found = message
    for name, place in _STEP.findall(path):
        try:
            found = found[int(place)] if place else getattr(found, name)
        except AttributeError:
            there = [field for field in getattr(found, "__slots__", None) or getattr(found, "__dict__", ()) if not field.startswith("_")]
            raise ValueError(f"no field {name!r} in the message ({path}); it has {', '.join(there) or 'none'}") from None
        except IndexError:
            raise ValueError(f"the message has {len(found)} numbers at {path}, no number {place}") from None
        except TypeError:
            raise ValueError(f"{path}: what stands before {name or f'[{place}]'} has no such part") from None
    try:
        return float(found)
    except (TypeError, ValueError):
        raise ValueError(f"{path} is no number but {type(found).__name__}") from None
