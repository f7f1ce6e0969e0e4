# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Options and arguments that several commands have."""

import functools
import inspect
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import click
from click import Choice, FloatRange, IntRange

from bearing_sim.cli.outputs import OutputFile, OutputTable, option_name
from bearing_sim.cli.reporting import UsageError, as_usage_error
from bearing_sim.files.outside import OPTION, allowing_outside
from bearing_sim.scene.fidelity import LEVELS

PICTURES = (".png", ".svg", ".pdf")
PATH = click.Path(path_type=Path)


def option(*about, **settings) -> Callable:
    """Return a decorator that adds an option; its default is shown.

    Parameters
    ----------
    about : its names, its help and, unless it is text or follows from the default, its type, in this order.
    settings : further ones of `click.Option`.
    """
    *names, text = (each for each in about if isinstance(each, str))
    settings.setdefault("show_default", settings.get("default") not in (None, ""))
    return click.option(*names, help=text, type=next((each for each in about if not isinstance(each, str)), None), **settings)


def flag(*about: str, **settings) -> Callable:
    """Return a decorator that adds an option without a value, of names and help."""
    return option(*about, is_flag=True, **settings)


def together(*decorators: Callable) -> Callable:
    """Return a decorator that adds several options and arguments, in the order in which help lists them."""
    return lambda command: functools.reduce(lambda made, each: each(made), reversed(decorators), command)


def gathered(parameter: str, make: Callable, *options: Callable) -> Callable:
    """Return a decorator that adds several options, which the command gets as one parameter, made of them by ``make``."""
    names = inspect.signature(make).parameters

    def add(command: Callable) -> Callable:
        @functools.wraps(command)
        def gathering(**given):
            return command(**{parameter: make(**{name: given.pop(name) for name in names})}, **given)

        return together(*options)(gathering)

    return add


_KINDS = {"": "fraction", "s": "time", "h": "hours", "m": "length", "rad/s": "speed", "Hz": "rate", "N": "force", "K": "temperature"}
"""What help calls a quantity, by its SI unit."""


class Amount(click.ParamType):
    """The type of an option that is a quantity with a unit, or one of time, which may be a bare number of seconds; the command gets it in SI.

    Parameters
    ----------
    unit : SI unit, ``""`` for a pure number or a percentage.
    minimum, maximum : bounds, both included, in SI.
    shown_in : unit of the bounds in messages.
    """

    def __init__(self, unit: str, minimum: float = -math.inf, maximum: float = math.inf, shown_in: str = ""):
        self.name, self._declared = _KINDS.get(unit, "quantity"), (unit, "", minimum, maximum, shown_in)

    def convert(self, value, param, ctx):
        """Return the quantity in SI; `UsageError` if it is none of the unit's dimension and kind, a bare number, or out of bounds."""
        from pydantic_core import PydanticCustomError

        from bearing_sim.scene.quantity import Quantity

        if not isinstance(value, str):
            return value
        declared, option = Quantity(*self._declared), option_name(param)
        if declared.unit != "s" and (reason := declared.why_unit_is_needed(value)):
            raise UsageError(f"{option}: {reason}")
        try:
            return declared.read(value)
        except PydanticCustomError as error:
            raise UsageError(f"{option} {value}: {error.message()}") from None


class AmountRange(Amount):
    """The type of an option that is a range of quantities, ``LOW:HIGH``; the command gets both ends in SI.

    Parameters
    ----------
    unit : SI unit.
    expected : what may stand here, in messages.
    fewest : number of quantities, 2, or 1 if a single one will do, for both ends.
    """

    def __init__(self, unit: str, expected: str, fewest: int = 2):
        super().__init__(unit)
        self._expected, self._fewest = expected, fewest

    def convert(self, value, param, ctx):
        """Return the ends of the range in SI."""
        if not isinstance(value, str):
            return value
        ends = [super(AmountRange, self).convert(part, param, ctx) for part in value.split(":")]
        if not self._fewest <= len(ends) <= 2 or ends[0] > ends[-1]:
            raise UsageError(f"{option_name(param)} {value}: expected {self._expected}")
        return ends[0], ends[-1]


SECONDS = Amount("s", 1e-12, 1e6)
level_type = click.Choice(LEVELS)


def _with_units(context: click.Context, parameter: click.Parameter, overrides: Sequence[str]) -> Sequence[str]:
    """Return the overrides of a scene; a quantity without a unit is refused."""
    from bearing_sim.scene.overrides import require_units

    require_units(overrides)
    return overrides


set_option = option(
    "--set",
    "overrides",
    "Override a field of the scene, or its range (uncertainty.FIELD); can be repeated. See: bearing-sim fields.",
    multiple=True,
    metavar="FIELD=VALUE",
    callback=_with_units,
)
verbose_option = flag("--verbose", "Also print limits of validity that are passed without effect, and assumptions.")
json_option = flag("--json", "as_json", "Print one JSON object.")
quick_option = flag("--quick", "Measure almost nothing, to check that everything works.")


def _allow_outside(context: click.Context, parameter: click.Parameter, allowed: bool) -> None:
    """Allow files outside of a scene's folder until the command ends, if the option is given."""
    context.with_resource(allowing_outside(allowed))


allow_outside_option = flag(
    OPTION, "Read files that a scene names although they lie outside of its folder.", is_eager=True, expose_value=False, callback=_allow_outside
)


scene_argument = together(click.argument("scene_name", metavar="SCENE"), allow_outside_option)
"""The argument for a scene, ``scene_name``, and the option that allows it to name files outside of its folder."""
scene_options = together(scene_argument, set_option)
"""The scene, and overrides of its fields, ``overrides``."""


def _log_reading(
    speed,
    load,
    temperature,
    inner_ring,
    outer_ring,
    speed_unit,
    load_unit,
    temperature_unit,
    joint,
    stamps,
    longest_gap,
):
    """Return what the texts of `log_options` say as a `bearing_sim.inputs.log.LogReading`."""
    from bearing_sim.inputs.log import LogReading, constant, is_constant, source

    given = (
        ("shaft_speed", speed, speed_unit),
        ("radial_load", load, load_unit),
        # A channel with a unit must be there: of the rings only one that is named, of the oil one that may be meant.
        ("oil_temperature", temperature, temperature_unit if temperature or not (inner_ring or outer_ring) else None),
        ("inner_ring_temperature", inner_ring, inner_ring and temperature_unit),
        ("outer_ring_temperature", outer_ring, outer_ring and temperature_unit),
    )
    with as_usage_error(ValueError):
        constants = {channel: constant(channel, text, unit) for channel, text, unit in given if is_constant(text)}
        sources = {channel: source(channel, text, unit) for channel, text, unit in given if (text or unit) and channel not in constants}
    return LogReading(sources, constants, joint, stamps, longest_gap, speed_unit)


log_options = gathered(
    "reading",
    _log_reading,
    option(
        "--speed",
        "--speed-topic",
        "speed",
        "Shaft speed: /topic, or /topic.field[0] of any type, or a constant such as 1500rpm [default: /shaft_speed].",
        metavar="TOPIC",
    ),
    option(
        "--load",
        "--load-topic",
        "load",
        "Radial load, likewise; /topic.y,z for both components, or a constant such as 800N [default: /radial_load].",
        metavar="TOPIC",
    ),
    option(
        "--oil-temperature",
        "--temperature",
        "--temperature-topic",
        "temperature",
        "Oil temperature, likewise, or a constant such as 60degC [default: /oil_temperature, if present, or the scene's].",
        metavar="TOPIC",
    ),
    option(
        "--inner-ring-temperature",
        "inner_ring",
        "Of the inner ring as measured, likewise [default: /inner_ring_temperature, if present].",
        metavar="TOPIC",
    ),
    option(
        "--outer-ring-temperature",
        "outer_ring",
        "Of the outer ring as measured, likewise [default: /outer_ring_temperature, if present].",
        metavar="TOPIC",
    ),
    option("--speed-unit", "Unit of the shaft speed in the log, such as rpm [default: rad/s].", metavar="UNIT"),
    option("--load-unit", "Unit of the load in the log, such as kN [default: N].", metavar="UNIT"),
    option("--temperature-unit", "Unit of the temperatures in the log [default: degC].", metavar="UNIT"),
    option("--joint", "Name of the shaft's joint in JointState messages.", default="shaft", metavar="NAME"),
    option("--stamps", "Use header stamps or log times.", Choice(["header", "log"]), default="header"),
    option(
        "--longest-gap",
        "Do not simulate longer gaps between messages [default: ten times the usual spacing, at least the scene's input_limits.stale_after].",
        FloatRange(min=0, min_open=True),
        metavar="S",
    ),
)
"""The options that say where a log holds what: topics, constants, stamps and gaps; the command gets a `bearing_sim.inputs.log.LogReading`."""


executor_options = together(
    option("--workers", "Number of processes [default: all cores].", IntRange(1, 1024), metavar="N"),
    option("--dask", "Compute on this Dask cluster, such as tcp://10.0.0.1:8786.", metavar="ADDRESS"),
)
"""The options that choose where points are computed."""


def table_option(default: str, beside: str, *parts: str) -> Callable:
    """Return the option for the output path of many points.

    Parameters
    ----------
    default : name of the table.
    beside : the part of its help that names the files.
    parts : what is added to the name for further tables.
    """
    text = f"{beside} PATH.journal, from which an interrupted run resumes."
    return option("-o", "--out", text, OutputTable(*parts), default=default, metavar="PATH.parquet")


def csv_option(written: str, kind: OutputFile | None = None) -> Callable:
    """Return the option for the path of a CSV table, ``table``; ``written`` is its help, ``kind`` its type unless it is simply a file."""
    table = option("-o", "--out", "table", written, kind or OutputFile(), metavar="PATH.csv")
    return together(table, removed_option("--csv", "-o, --out"))


def removed_option(name: str, successor: str) -> Callable:
    """Return an option that no longer exists, and whose use is refused with what it is called now."""

    def refuse(context: click.Context, parameter: click.Parameter, value: str | None) -> None:
        if value is not None:
            raise UsageError(f"{name} is no longer an option; give {successor} instead")

    return click.option(name, hidden=True, expose_value=False, callback=refuse)


def _read_size(context: click.Context, parameter: click.Parameter, text: str) -> tuple[int, int]:
    """Return width and height [px] of a text such as ``1600x1000``."""
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.isdigit() and 100 <= int(part) <= 8000 for part in parts):
        raise UsageError(f"--size {text}: expected WIDTHxHEIGHT in pixels, 100 to 8000 each, such as 1600x1000")
    return int(parts[0]), int(parts[1])


size_option = option("--size", "Size of a picture of the view [px].", default="1600x1000", metavar="WxH", callback=_read_size)


def picture_option(drawn: str, *names: str) -> Callable:
    """Return the option for the path of a picture with a known suffix, ``--picture`` after other names for it.

    Parameters
    ----------
    drawn : what it draws, as in "Draw the map".
    names : other names, such as ``-o``.
    """
    text = f"{drawn} ({', '.join(PICTURES[:-1])} or {PICTURES[-1]})."
    return click.option(*names, "--picture", "picture", type=OutputFile(*PICTURES), metavar="PATH.png", help=text)
