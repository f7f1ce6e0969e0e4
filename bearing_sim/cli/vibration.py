# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim vibration``: cage speed, and what is damaged, out of the record of an accelerometer."""

import math

import click
import numpy as np
from click import IntRange

from bearing_sim.cli.options import (
    PATH,
    SECONDS,
    Amount,
    AmountRange,
    allow_outside_option,
    csv_option,
    flag,
    gathered,
    json_option,
    option,
    picture_option,
)
from bearing_sim.cli.reporting import UsageError, announce_compilation, print_rows, print_table, tell_use
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.loader import load_bearing, load_scene

_LARGEST_PARTS = 100_000
_LENGTH = Amount("m", 1e-9)
_MARGIN = 1.5  # times the largest slip of the model and of draws of its uncertain fields (assumption: draws are few)
_CAGE = "the cage, or a roller at each turn of the cage"
_SOURCES = {"lines": "by its own lines", "recorded": "as recorded", "given": "as given; it has no clear lines of its own"}


def _geometry(bearing, scene_name, rollers, roller_diameter, pitch_diameter, measured):
    """Return the geometry by the options, and the name of the scene."""
    from bearing_sim.watchers.vibration.analysis import Geometry

    if sum(each is not None for each in (bearing, scene_name, rollers)) != 1:
        raise UsageError("the number of rollers must be known: give one of --bearing, --scene and --rollers")
    if rollers is not None:
        if measured:
            raise UsageError("--measured-geometry goes with --bearing or --scene; with --rollers give --roller-diameter and --pitch-diameter")
        if (roller_diameter is None) != (pitch_diameter is None):
            raise UsageError("--roller-diameter and --pitch-diameter go together")
        if roller_diameter is None:
            return Geometry(rollers, name=f"{rollers} rollers"), scene_name
        size = roller_diameter / pitch_diameter
        if not 0.02 <= size <= 0.5 or rollers * math.asin(min(size, 1.0)) > 1.001 * math.pi:
            raise UsageError(
                f"{rollers} rollers of {1e3 * roller_diameter:g} mm do not fit on a circle of {1e3 * pitch_diameter:g} mm; check the diameters"
            )
        return Geometry(rollers, size, True, f"{rollers} rollers"), scene_name
    if roller_diameter is not None or pitch_diameter is not None:
        raise UsageError("--roller-diameter and --pitch-diameter go with --rollers")
    chosen = load_bearing(bearing) if bearing is not None else load_scene(scene_name).bearing
    return Geometry(chosen.roller.count, chosen.roller.diameter / chosen.pitch_diameter, measured, chosen.designation or chosen.name), scene_name


_bearing_options = gathered(
    "bearing",
    _geometry,
    option("--bearing", "Designation such as 'NU 205', or a bundled bearing; its rollers and diameters are used.", metavar="BEARING"),
    option("--scene", "scene_name", "Scene whose bearing it is, instead.", metavar="SCENE"),
    option("--rollers", "Number of rollers, where the bearing is not known otherwise.", IntRange(3, 400), metavar="Z"),
    option("--roller-diameter", "Diameter of the rollers as measured, such as 7.5mm.", _LENGTH),
    option("--pitch-diameter", "Diameter of their pitch circle as measured, such as 38.5mm.", _LENGTH),
    flag("--measured-geometry", "measured", "The diameters of --bearing or --scene were measured on this bearing."),
)


@command("vibration")
@click.argument("data", type=PATH, metavar="FILE")
@allow_outside_option
@_bearing_options
@option("--speed", "Shaft speed, about, such as 600rpm; it is taken from the shaft's own lines.", Amount("rad/s"))
@option("--tolerance", "Within which the speed is known.", Amount("", 1e-6, 0.2, "%"), default="2%")
@option(
    "--largest-slip",
    "Of the cage that is possible: no other lines are looked for [default: with --scene what level steady finds, with its uncertain fields;"
    " otherwise 10%].",
    Amount("", 0.0, 0.95, "%"),
)
@flag("--no-shaft-lines", "Take the speed as it is given, without looking for the shaft's own lines.")
@option("--channel", "The vibration in FILE: a column, variable, data set, matrix column as NAME[k], or /topic.field.", metavar="NAME")
@option("--rate", "Sampling rate, such as 50kHz [default: as FILE says].", Amount("Hz", 1e-6))
@option("--time-channel", "Column of times in seconds, from which the rate follows [default: one that is called so].", metavar="NAME")
@option("--speed-channel", "Shaft speed in FILE, one value a sample.", metavar="NAME")
@option("--speed-unit", "Of --speed-channel.", default="rpm", metavar="UNIT")
@option(
    "--band",
    "Band of the envelope, such as 6kHz:12kHz [default: chosen by kurtogram].",
    AmountRange("Hz", "LOW:HIGH, such as 6kHz:12kHz"),
    metavar="LOW:HIGH",
)
@option("--from", "begin", "Leave out what is before this time of the record, such as 2s.", Amount("s"))
@option("--to", "end", "Leave out what is after this time of the record.", Amount("s"))
@option("--every", "Cage speed in parts of this length [default: quarters of the record].", SECONDS)
@csv_option("Write the cage speed in parts of the record to a table.")
@picture_option("Draw the envelope spectrum with the lines that were found")
@json_option
def vibration(
    data,
    bearing,
    speed,
    tolerance,
    largest_slip,
    no_shaft_lines,
    channel,
    rate,
    time_channel,
    speed_channel,
    speed_unit,
    band,
    begin,
    end,
    every,
):
    """Find the cage speed in the vibration that FILE holds, and which ring or roller shows; or that there is no line.

    FILE is CSV or other text, Parquet, MAT, NPZ, NPY, WAV, HDF5, MCAP or another bag.  The number of rollers must be known: by --bearing,
    --scene or --rollers.  The answer is the ratio of cage to shaft speed with its standard error.  Lines that cannot be distinguished from those of
    something else, such as an exactly periodic train of a gear or of another machine, are no claim.  Slip against the drawing is claimed only
    where the lines are, the shaft's speed is measured, and it exceeds 3 % or the diameters were measured, because a roller of another size of the
    same designation moves it by 3 %.
    """
    from bearing_sim.files.limits import VIBRATION_ANALYSED
    from bearing_sim.watchers.vibration.analysis import analyse
    from bearing_sim.watchers.vibration.reading import read_vibration

    if speed is not None and speed_channel is not None:
        raise UsageError("--speed and --speed-channel both give the shaft speed; give one")
    geometry, scene_name = bearing
    record = read_vibration(data, channel, rate, time_channel, speed_channel, speed_unit)
    if record.tally is not None:
        tell_use(record.tally, data)
    record = _cut(record, begin, end)
    VIBRATION_ANALYSED.check(len(record.samples), f"{record.name}, which --from and --to cut")
    parts = _parts(record, every)
    if largest_slip is None:
        largest_slip = _largest_slip(scene_name, speed, record)
    geometry = geometry._replace(largest_slip=largest_slip)
    found = analyse(record, geometry, speed, tolerance, _band(band, record.rate), not no_shaft_lines, parts)
    rows = [_row(part) for part in found.parts]

    def plot(draft):
        from bearing_sim.watchers.vibration.picture import plot_vibration

        plot_vibration(draft, record, geometry, found)

    report = {"file": data.name, **_report(found, record, geometry), "parts": rows}
    return Result(report, lambda: _print(data.name, record, geometry, found), plot, rows)


def _largest_slip(scene_name, shaft_speed, record) -> float:
    """Return the largest possible slip: by the model of a scene, or the usual assumption."""
    from bearing_sim.watchers.vibration.analysis import LARGEST_SLIP

    if scene_name is None:
        return LARGEST_SLIP
    from bearing_sim.simulation import IntegrationError, scene_inputs
    from bearing_sim.studies.uncertainty_propagation import UncertaintyError, largest_slip

    scene = load_scene(scene_name)
    speed = shaft_speed if shaft_speed is not None else scene.operating.shaft_speed
    if record.shaft_speed is not None:
        speed = float(np.mean(record.shaft_speed))
    try:
        announce_compilation(scene.at_level("steady"))
        found = largest_slip(scene, scene_inputs(scene)._replace(shaft_speed=speed))
    except (IntegrationError, UncertaintyError) as error:
        raise UsageError(f"--scene {scene_name}: {error}; give --largest-slip, such as --largest-slip 10%") from None
    return min(max(_MARGIN * found, LARGEST_SLIP), 0.95)


def _cut(record, begin, end):
    """Return the part of a record between two times."""
    first, last = begin or 0.0, record.duration if end is None else end
    if not 0.0 <= first < last <= record.duration * (1.0 + 1e-9):
        raise UsageError(f"--from {first:g} s and --to {last:g} s: expected times in order within the {record.duration:.6g} s of the record")
    return record if begin is None and end is None else record.part(round(first * record.rate), round(last * record.rate))


def _parts(record, every) -> int:
    if every is None:
        return 4
    count = int(record.duration / every + 1e-9)
    if not 1 <= count <= _LARGEST_PARTS:
        raise UsageError(
            f"--every {every:g} s: expected at most the {record.duration:.6g} s of the record, and at least {record.duration / 1e5:.2g} s"
        )
    return count


def _band(ends, rate):
    if ends is None:
        return None
    from bearing_sim.watchers.vibration.signal import Band

    band = Band(*ends)
    if not 0.0 <= band.low < band.high <= rate / 2.0:
        text = f"--band {band.low:g} Hz:{band.high:g} Hz"
        raise UsageError(f"{text}: expected frequencies in order up to half the sampling rate, {rate / 2.0:g} Hz")
    return band


def _row(part) -> dict:
    return {
        "begin_s": part.begin,
        "end_s": part.end,
        "shaft_speed_rad_s": part.shaft_speed,
        "cage_speed_rad_s": part.cage_speed,
        "cage_speed_standard_error_rad_s": part.cage_speed_error,
        "cage_to_shaft": part.ratio,
        "cage_to_shaft_standard_error": part.ratio_error,
    }


def _report(found, record, geometry) -> dict:
    return {
        "found": found.found,
        "shows": found.shows,
        "reason": found.reason,
        "is_claim": found.is_claim,
        "cannot_be_told_apart_from": list(found.alternatives),
        "false_alarm_probability": found.false_alarm,
        "doubt": found.doubt,
        "jitter_percent": 100.0 * found.jitter if math.isfinite(found.jitter) else None,
        "largest_slip_percent": 100.0 * geometry.largest_slip,
        **({"read": record.tally.report()} if record.tally is not None else {}),
        "rate_hz": record.rate,
        "duration_s": record.duration,
        "rollers": geometry.rollers,
        "shaft_hz": found.shaft.frequency,
        "shaft_standard_error_hz": found.shaft.standard_error,
        "shaft_source": found.shaft.source,
        "line_to_shaft": found.line,
        "line_to_shaft_standard_error": found.line_error,
        "cage_to_shaft": found.ratio,
        "cage_to_shaft_standard_error": found.ratio_error,
        "cage_speed_rad_s": found.cage_speed,
        "cage_speed_standard_error_rad_s": found.cage_speed_error,
        "roller_passes_per_turn": found.passes,
        "cage_to_shaft_without_slip": geometry.ideal_ratio,
        "slip_percent": 100.0 * found.slip if found.claims_slip else None,
        "slip_standard_error_percent": 100.0 * found.slip_error if found.claims_slip else None,
        "slip_is_claimed": found.claims_slip,
        "band_hz": list(found.band) if found.band else None,
        "lines_to_shaft": list(found.lines),
    }


def _print(name, record, geometry, found) -> None:
    from bearing_sim.watchers.vibration.analysis import PARTS, rarity

    shaft = found.shaft
    turns = f"{60.0 * shaft.frequency:.6g} rpm ± {60.0 * shaft.standard_error:.2g}, {_SOURCES[shaft.source]}"
    rows = [("record", f"{record.duration:.4g} s at {record.rate:g} Hz: {record.name}"), ("bearing", geometry.name), ("shaft", turns)]
    rows.append(("slip looked for", f"up to {100.0 * geometry.largest_slip:.3g} %"))
    if not found.found:
        print_table(f"{name}: no line of this bearing", [*rows, ("result", found.reason.removeprefix("no line of this bearing: "))])
        return
    rows += [
        ("shows" if found.is_claim else "may show", _CAGE if found.shows == "cage" else PARTS[found.shows]),
        *(("cannot be told from", text) for text in found.alternatives),
        ("line", f"{found.line:.5f} of the shaft's frequency" + (f" ± {found.line_error:.5f}" if math.isfinite(found.line_error) else "")),
        ("cage over shaft", f"{found.ratio:.6f} ± {found.ratio_error:.6f}"),
        ("cage", f"{found.cage_speed * 30 / math.pi:.6g} rpm ± {found.cage_speed_error * 30 / math.pi:.2g}"),
    ]
    if math.isfinite(geometry.ideal_ratio):
        rows.append(("without slip", f"{geometry.ideal_ratio:.6f} by the drawing"))
    rows.append(("slip", f"{100.0 * found.slip:.2f} % ± {100.0 * found.slip_error:.2f}" if found.claims_slip else found.reason))
    rows.append(("band", f"{found.band.low:g} to {found.band.high:g} Hz"))
    rows.append(("lines", ", ".join(f"{order:.3f}" for order in found.lines)))
    if math.isfinite(found.jitter):
        rows.append(("impacts", f"scatter by {100.0 * found.jitter:.2g} % of their period" + (" or more" if found.is_claim else "")))
    rows.append(("false alarm", f"in one of {rarity(found.false_alarm)} records of noise, at most"))
    if found.is_claim:
        rows.append(("something else", f"with a probability of {100.0 * found.doubt:.2g} %, at most"))
    print_table(name, rows)
    if len(found.parts) <= 60:
        rpm = 30.0 / math.pi
        texts = [
            (
                f"{part.begin:.3f}",
                f"{part.end:.3f}",
                f"{rpm * part.shaft_speed:.2f}",
                f"{rpm * part.cage_speed:.3f}",
                f"{rpm * part.cage_speed_error:.3f}",
                f"{part.ratio:.6f}",
                f"{part.ratio_error:.6f}",
            )
            for part in found.parts
        ]
        columns = ("from [s]", "to [s]", "shaft [rpm]", "cage [rpm]", "±", "cage over shaft", "±")
        print_rows("in parts of the record", columns, texts)
