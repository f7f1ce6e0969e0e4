# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Options and arguments that several commands have."""

from collections.abc import Callable, Sequence

import click

from bearing_sim.cli.outputs import OutputFile, OutputTable
from bearing_sim.cli.reporting import UsageError, as_usage_error
from bearing_sim.files.outside import OPTION, allowing_outside
from bearing_sim.scene.fidelity import LEVELS

PICTURES = (".png", ".svg", ".pdf")

level_type = click.Choice(LEVELS)


def _with_units(context: click.Context, parameter: click.Parameter, overrides: Sequence[str]) -> Sequence[str]:
    """Return the overrides of a scene; a quantity without a unit is refused."""
    from bearing_sim.scene.loader import SceneError, require_units

    with as_usage_error(SceneError):
        require_units(overrides)
    return overrides


set_option = click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="FIELD=VALUE",
    callback=_with_units,
    help="Override a field of the scene, or its range (uncertainty.FIELD); can be repeated. See: bearing-sim fields.",
)
verbose_option = click.option("--verbose", is_flag=True, help="Also print limits of validity that are passed without effect, and assumptions.")
json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
quick_option = click.option("--quick", is_flag=True, help="Measure almost nothing, to check that everything works.")


def _allow_outside(context: click.Context, parameter: click.Parameter, allowed: bool) -> None:
    """Allow files outside of a scene's folder until the command ends, if the option is given."""
    context.with_resource(allowing_outside(allowed))


allow_outside_option = click.option(
    OPTION,
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_allow_outside,
    help="Read files that a scene names although they lie outside of its folder.",
)


def scene_argument(command: Callable) -> Callable:
    """Add the argument for a scene, ``scene_name``, and the option that allows it to name files outside of its folder."""
    return click.argument("scene_name", metavar="SCENE")(allow_outside_option(command))


_LOG_OPTIONS = (
    click.option(
        "--speed",
        "--speed-topic",
        "speed",
        metavar="TOPIC",
        help="Shaft speed: /topic, or /topic.field[0] of any type, or a constant such as 1500rpm [default: /shaft_speed].",
    ),
    click.option(
        "--load",
        "--load-topic",
        "load",
        metavar="TOPIC",
        help="Radial load, likewise; /topic.y,z for both components, or a constant such as 800N [default: /radial_load].",
    ),
    click.option(
        "--oil-temperature",
        "--temperature",
        "--temperature-topic",
        "temperature",
        metavar="TOPIC",
        help="Oil temperature, likewise, or a constant such as 60degC [default: /oil_temperature, if present, or the scene's].",
    ),
    click.option(
        "--inner-ring-temperature", metavar="TOPIC", help="Of the inner ring as measured, likewise [default: /inner_ring_temperature, if present]."
    ),
    click.option(
        "--outer-ring-temperature", metavar="TOPIC", help="Of the outer ring as measured, likewise [default: /outer_ring_temperature, if present]."
    ),
    click.option("--speed-unit", metavar="UNIT", help="Unit of the shaft speed in the log, such as rpm [default: rad/s]."),
    click.option("--load-unit", metavar="UNIT", help="Unit of the load in the log, such as kN [default: N]."),
    click.option("--temperature-unit", metavar="UNIT", help="Unit of the temperatures in the log [default: degC]."),
    click.option("--joint", default="shaft", show_default=True, metavar="NAME", help="Name of the shaft's joint in JointState messages."),
    click.option("--stamps", type=click.Choice(["header", "log"]), default="header", show_default=True, help="Use header stamps or log times."),
    click.option(
        "--longest-gap",
        type=click.FloatRange(min=0, min_open=True),
        metavar="S",
        help="Do not simulate longer gaps between messages [default: ten times the usual spacing, at least the scene's input_limits.stale_after].",
    ),
)


def log_options(command: Callable) -> Callable:
    """Add the options that say where a log holds what: topics, units, constants, stamps and gaps (see `channel_sources`)."""
    for option in reversed(_LOG_OPTIONS):
        command = option(command)
    return command


def channel_sources(
    speed, load, temperature, inner_ring_temperature, outer_ring_temperature, speed_unit, load_unit, temperature_unit
) -> tuple[dict, dict[str, float]]:
    """Return the sources of channels in a recording, and the values [SI] of those that are constant, from the texts of `log_options`.

    Both are by channel; a channel that no option concerns is in neither.
    """
    from bearing_sim.inputs.log import constant, is_constant, source

    given = (
        ("shaft_speed", speed, speed_unit),
        ("radial_load", load, load_unit),
        # A channel with a unit must be there: of the rings only one that is named, of the oil one that may be meant.
        ("oil_temperature", temperature, temperature_unit if temperature or not (inner_ring_temperature or outer_ring_temperature) else None),
        ("inner_ring_temperature", inner_ring_temperature, temperature_unit if inner_ring_temperature else None),
        ("outer_ring_temperature", outer_ring_temperature, temperature_unit if outer_ring_temperature else None),
    )
    with as_usage_error(ValueError):
        constants = {channel: constant(channel, text, unit) for channel, text, unit in given if is_constant(text)}
        return {channel: source(channel, text, unit) for channel, text, unit in given if (text or unit) and channel not in constants}, constants


def executor_options(command: Callable) -> Callable:
    """Add the options that choose where points are computed."""
    command = click.option("--dask", metavar="ADDRESS", help="Compute on this Dask cluster, such as tcp://10.0.0.1:8786.")(command)
    return click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")(command)


def table_option(default: str, beside: str, *parts: str) -> Callable:
    """Return the option for the output path of many points.

    Parameters
    ----------
    default : name of the table.
    beside : the part of its help that names the files.
    parts : what is added to the name for further tables.
    """
    text = f"{beside} PATH.journal, from which an interrupted run resumes."
    return click.option("-o", "--out", type=OutputTable(*parts), default=default, show_default=True, metavar="PATH.parquet", help=text)


def csv_option(written: str) -> Callable:
    """Return the option for the path of a CSV table; ``written`` is its help."""
    return csv_option_of(OutputFile(), written)


def csv_option_of(kind: OutputFile, written: str) -> Callable:
    """Return the option for the path of a CSV table of a type of output; ``written`` is its help."""

    def add(command: Callable) -> Callable:
        return click.option("-o", "--out", "table", type=kind, metavar="PATH.csv", help=written)(removed_option("--csv", "-o, --out")(command))

    return add


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


size_option = click.option(
    "--size", default="1600x1000", show_default=True, metavar="WxH", callback=_read_size, help="Size of a picture of the view [px]."
)


def picture_option(drawn: str, *names: str) -> Callable:
    """Return the option for the path of a picture with a known suffix, ``--picture`` after other names for it.

    Parameters
    ----------
    drawn : what it draws, as in "Draw the map".
    names : other names, such as ``-o``.
    """
    text = f"{drawn} ({', '.join(PICTURES[:-1])} or {PICTURES[-1]})."
    return click.option(*names, "--picture", "picture", type=OutputFile(*PICTURES), metavar="PATH.png", help=text)
