# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One self-contained HTML page of any result: a design, a sweep or other table, a recorded run or replay, a folder of these.

A page has the scene and its bearing, tables, pictures, warnings, where the result comes from, and the command that made it.
"""

import io
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.provenance import versions
from bearing_sim.files.tally import Tally
from bearing_sim.inputs.profile import gaps_of
from bearing_sim.messages.events import Event, Level
from bearing_sim.model.characteristic_frequencies import frequencies_text, mean_frequencies
from bearing_sim.model.plausibility import left_out, plausibility
from bearing_sim.model.sample import OBSERVABLES, joined
from bearing_sim.model.turning import DIVIDED, slip_statistics, stands_text, turns, use_of
from bearing_sim.model.validity import counted
from bearing_sim.recording.bag import ACTIVE
from bearing_sim.recording.reader import Recording
from bearing_sim.scene.display import hours, number
from bearing_sim.scene.loader import SceneError, scene_from_yaml
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities, value_at
from bearing_sim.studies import design as studied
from bearing_sim.studies import spectrum as spectra
from bearing_sim.studies.page import NoResults, command, document, folded, pairs, paragraph, picture, rows_table, warnings
from bearing_sim.studies.run_plot import DEFAULT_PANELS, course_of, plot_over_time
from bearing_sim.studies.sheet import results, sheet
from bearing_sim.sweep.pictures import COLOURS, NotDrawable, new_figure, plot_table, save
from bearing_sim.sweep.point import OK, Column
from bearing_sim.sweep.settling import mean_life
from bearing_sim.sweep.table import Table, read_any_table, written_by_us

_RECORDINGS, _TABLES = (".mcap", ACTIVE), (".parquet", ".csv")
_MOST_ROWS = 1000  # of a table on a page; the files have all
_MOST_POINTS = 4000  # of a line in a picture
_LAST = 0.2  # of a recording, over which its final results are averaged
_POINTS = (
    Column("share", "", "of the time"),
    Column("shaft_speed_rpm", "rpm", "shaft speed"),
    Column("radial_load", "N", "radial load"),
    Column("oil_temperature_degC", "degC", "oil temperature"),
)  # of a design
_SECTORS = 72  # of the circle, for the load distribution


_Tell = Callable[[Tally, Path], None]


class _Part(NamedTuple):
    """One result: its title, and HTML by heading."""

    title: str
    opening: str
    sections: dict[str, str]


def page_of(source: Path, tell: _Tell = lambda tally, path: None) -> str:
    """Return the HTML page of a result.

    Parameters
    ----------
    source : a table (Parquet, or CSV beside it), a recording (MCAP file or bag's folder), or a folder of such files.
    tell : called with what was used of each recording, and its path.

    Raises
    ------
    NoResults
        There is nothing of which a page could be made, or it cannot be read; the message says what to do.
    OSError
        A file cannot be opened.
    """
    if not source.exists():
        raise NoResults(f"{source}: does not exist; expected a table of sweep or design, a recording of run or replay, or a folder of them")
    return document(*_part(source, tell)) if _is_result(source) else _folder_page(source, tell)


def _is_result(source: Path) -> bool:
    return source.is_file() or (source / "metadata.yaml").is_file()


def _results_in(folder: Path) -> list[Path]:
    """Return the results in a folder: tables that do not belong to a design, and recordings."""
    tables = [path for path in sorted(folder.glob("*.parquet")) if not (_is_of_design(path) or path.name.startswith("."))]
    recordings = [path for suffix in _RECORDINGS for path in sorted(folder.glob(f"*{suffix}"))]
    bags = [path.parent for path in sorted(folder.glob("*/metadata.yaml"))]
    if not (found := [*tables, *recordings, *bags]):
        raise NoResults(f"{folder}: no results; expected tables (.parquet) or recordings (.mcap)")
    return found


def _is_of_design(path: Path) -> bool:
    """Return whether a file is one of the further tables of a design, which is shown with it."""
    return any(path.stem.endswith(suffix) and path.with_name(path.name.replace(suffix, "")).is_file() for suffix in ("_borders", "_checks"))


def _folder_page(folder: Path, tell: _Tell) -> str:
    """Return the page of all results in a folder, one after the other; files without results are listed with the reason."""
    parts, skipped = [], []
    for path in _results_in(folder):
        try:
            parts.append(_part(path, tell))
        except NoResults as error:
            skipped.append(f"not shown: {error}")
    if not parts:
        raise NoResults("\n".join(skipped))
    if len(parts) == 1:
        return document(parts[0].title, parts[0].opening + warnings(skipped), parts[0].sections)
    sections = {}
    for place, part in enumerate(parts, 1):
        inner = "".join(f"<h3>{escape(heading)}</h3>{text}" for heading, text in part.sections.items() if text)
        sections[f"{place}. {part.title}"] = part.opening + inner
    return document(f"{len(parts)} results in {folder.name}", warnings(skipped), sections)


def _part(path: Path, tell: _Tell) -> _Part:
    """Return the part of a page on one result."""
    kept = path.with_suffix(".parquet")
    try:
        if path.is_dir() or path.suffix in _RECORDINGS:
            recording = Recording(path, allow_partial=True)
            part = _recording_part(recording)
            tell(recording.tally, path)
            return part
        if path.suffix not in _TABLES:
            raise NoResults(f"{path}: expected a table ({', '.join(_TABLES)}), a recording (.mcap), or a folder")
        table = read_any_table(path)
        with written_by_us(path):
            return _design_part(kept, studied.read_design(kept)) if table.about.get("kind") == "design" else _table_part(path, table)
    except (ValueError, FileNotFoundError) as error:
        raise NoResults(str(error)) from None


def _picture(title: str, plot: Callable, *arguments, caption: str = "") -> str:
    """Return an embedded picture that a function draws into a stream."""
    stream = io.BytesIO()
    plot(stream, *arguments)
    return picture(stream.getvalue(), title, caption)


# Sweeps and other tables


def _table_part(path: Path, table: Table) -> _Part:
    about, remarks = table.about, []
    if not about:
        remarks.append("the origin of these numbers is not known: there is no Parquet file beside the CSV")
    remarks += _reasons(table.rows)
    results = rows_table(table.columns, table.rows[:_MOST_ROWS])
    if len(table.rows) > _MOST_ROWS:
        results += paragraph(f"The first {_MOST_ROWS} of {len(table.rows)} rows; {path.name} has all.")
    kind = about.get("kind", "table")
    where = f" of {about['scene']} at level {about['level']}" if "scene" in about else ""
    return _Part(
        f"{kind.capitalize()}{where}",
        _opening(about, remarks),
        {
            "Summary": pairs({"rows": len(table.rows), **_statuses(table), **_varied(about), **about.get("summary", {})}),
            "Pictures": _table_pictures(table),
            "Results": results,
            **_origin(about),
        },
    )


def _reasons(rows: Sequence[Mapping]) -> list[str]:
    """Return how many rows have each status other than ok, and why, and which laws are used outside of their ranges."""
    found = Counter(f"{row['status']}: {row.get('reason', '')}" for row in rows if row.get("status", OK) != OK)
    limits = counted((row.get("warnings") or "" for row in rows), with_assumptions=True)
    return [f"{count} of {len(rows)} rows {text}" for text, count in found.most_common(10)] + limits


def _statuses(table: Table) -> dict:
    if not any(column.name == "status" for column in table.columns):
        return {}
    return {"status": ", ".join(f"{count} {status}" for status, count in Counter(table.values("status")).most_common())}


def _varied(about: Mapping) -> dict:
    shown = {}
    for axis in about.get("axes", ()):
        values = axis["values"]
        span = ", ".join(_text(value) for value in values) if len(values) <= 8 else f"{_text(values[0])} to {_text(values[-1])}, {len(values)} values"
        shown[axis["field"]] = f"{span} {axis['unit']}".strip()
    return shown


def _text(value) -> str:
    return number(value, 8) if isinstance(value, float) else str(value)


def _table_pictures(table: Table) -> str:
    if table.about.get("kind") == "spectrum":
        return _picture("Shares of time and damage by point", spectra.plot_spectrum, table)
    if table.about.get("kind") != "sweep":
        return ""
    try:
        return _picture("Results over what was varied", plot_table, table)
    except NotDrawable as error:
        return paragraph(f"No picture: {error}.")


# Designs


def _design_part(path: Path, designed: studied.Designed) -> _Part:
    about = designed.grid.about
    wanted, verify_level = about["wanted"], about["verify_level"]
    remarks = []
    if verify_level is None:
        remarks.append("nothing was verified at a level of higher fidelity")
    if (about["level"], verify_level) in studied.ALIKE:
        remarks.append(studied.ALIKE[about["level"], verify_level])
    counts = Counter(key for band in designed.bands for key in ((band.verdict, band.found.kind), band.found.kind))
    remarks += [
        f"{counts[verdict, kind]} of {counts[kind]} intervals ({kind}) {verdict} at level {verify_level}"
        for verdict, kind in product((studied.WITHDRAWN, studied.NARROWED), studied.KINDS)
        if counts[verdict, kind]
    ]
    for kind in studied.KINDS:
        if ends := designed.open_ends(kind):
            remarks.append(f"{studied.condition_name(kind, wanted)} {ends}")
    remarks += _reasons(designed.grid.rows)
    remarks += [f"verification: {text}" for text in _reasons([check._asdict() for check in designed.checks])]
    widest = designed.widest
    nowhere = [studied.condition_name(kind, wanted) for kind in studied.KINDS if not designed.recommended(kind)]
    answer = f"No raceway of the map meets both limits {', nor '.join(nowhere)}."
    if widest is not None:
        where = "in the worst case" if widest.kind == studied.WORST else "at nominal conditions, none in the worst case"
        answer = f"Widest interval ({where}): D = {widest.d_value:.4f} mm, R_low = {widest.low_from:.5f} to {widest.low_to:.5f} mm."
    points = [column for column in _POINTS if any(column.name in point for point in wanted["points"])]
    rows = [{column.name: point.get(column.name) for column in points} for point in wanted["points"]]
    summary = {
        "limits": f"slip below {wanted['slip_below']:g} %, life above {wanted['life_above']:g} h",
        "life": about["life"],
        "tolerances": wanted["spread"],
        "level": about["level"],
        "state": studied.STATE,
        "verified at level": verify_level or "none",
        "raceways of the map": len(designed.grid.rows),
        **_varied(about),
    }
    check_columns = [_at_level(column, about) for column in studied.CHECK_COLUMNS]
    return _Part(
        f"Design of {about['name']} at level {about['level']}",
        _opening(about, remarks) + f"<p><b>{escape(answer)}</b></p>",
        {
            "Summary": pairs(summary),
            "Operating points": rows_table(points, rows) if rows else "",
            "Picture": _picture("Raceways that meet the limits", studied.plot_design, designed),
            "Intervals of radii": rows_table(studied.BORDER_COLUMNS, designed.border_table.rows),
            "Both levels": rows_table(check_columns, designed.check_table.rows) if designed.checks else "",
            "Map": rows_table(studied.COLUMNS, designed.grid.rows, f"all {len(designed.grid.rows)} raceways"),
            **_origin(about),
        },
    )


def _at_level(column: Column, about: Mapping) -> Column:
    """Return a column of checks whose unit names the level at which it was computed."""
    quantity = column.name.removeprefix("verified_")
    level = about["level" if quantity == column.name else "verify_level"]
    return column._replace(unit=f"{column.unit} at {level}") if quantity in ("slip", "life") else column


# Recordings


def _recording_part(recording: Recording) -> _Part:
    scene, metadata = recording.scene, recording.metadata
    blocks, events = [], []
    for item in recording:
        (events if isinstance(item, Event) else blocks).append(item)
    block = joined([_thinned(each, recording.samples) for each in blocks])
    course = course_of(blocks, scene, recording.path.name, recording.samples, (*DEFAULT_PANELS, "roller_load"))
    remarks = [] if recording.tally.is_whole else [f"the recording is used in part only: {recording.tally.text}"]
    remarks += [scene.level_reason] if scene.level_reason else []
    remarks += [each.warning for each in _grouped(event for event in events if event.level > Level.OK)]
    last = float(blocks[-1]["time"][-1])  # that could be read
    duration = last - recording.first_time
    settled = block[block["time"] >= last - _LAST * duration]
    about = {
        "scene": scene.name,
        "level": scene.level,
        "scene_yaml": metadata["scene"],
        "command": recording.command,
        "reproduced by": f"bearing-sim replay --from-recording {recording.path.name}",
        "version": metadata.get("package_version", ""),
        "commit": metadata.get("git_hash", ""),
    } | {name.removeprefix("version_"): text for name, text in metadata.items() if name.startswith("version_")}
    slips, speeds, times, load_y, load_z = (
        np.concatenate([each[name] for each in blocks]) for name in ("cage_slip", "shaft_speed", "time", "load_y", "load_z")
    )
    weights = _weights(times, scene)
    slip = slip_statistics(slips, speeds, weights, scene.thresholds.slip_from_speed)
    used = float(blocks[-1]["damage"][-1] - blocks[0]["damage"][0])
    use = use_of(slips, speeds, np.hypot(load_y, load_z), weights, used, scene.thresholds)
    at_end = _while_turning(settled, scene) if _turns(block[-1:], scene).all() else settled[:0]
    none, over = f"none: {stands_text(scene.thresholds.slip_from_speed)}", f"over the last {100 * _LAST:g} %"
    summary = {
        "recording": ", ".join(file.name for file in recording.files),
        "simulated": f"{number(use.seconds, 6)} s of {number(duration, 6)} s, {recording.tally.counts}",
        "level": scene.level,
        "cage slip while turning": none if math.isnan(slip["mean"]) else f"mean {100 * slip['mean']:.2f} %, largest {100 * slip['maximum']:.2f} %",
        "cage slip at the end": f"{100 * np.nanmean(at_end['cage_slip']):.2f} %" if np.isfinite(at_end["cage_slip"]).any() else f"{none} there",
        "characteristic frequencies at the end": frequencies_text(mean_frequencies(at_end)) if len(at_end) else f"{none} there",
        "skid": use.skid_text(scene.thresholds),
        "life used": f"{100 * used:.4g} %",
        f"life under these conditions ({studied.life_name(scene)})": hours(use.life_hours) if used > 0.0 else "not used",
        "events": ", ".join(f"{count} x {kind}" for kind, count in Counter(event.kind for event in events).most_common()) or "none",
    }
    return _Part(
        f"{scene.name} at level {scene.level}: {recording.path.name}",
        _opening(about, remarks),
        {
            "Summary": pairs(summary),
            f"Answer sheet, mean {over}": _sheet(scene, at_end),
            "Pictures": _picture("Conditions and results over time", plot_over_time, [course])
            + _picture("Load distribution", _draw_loads, settled, caption=f"Roller loads over the azimuth from +y, mean {over} of the recording."),
            "Observables": _observables(blocks, settled, scene),
            "Events": _events_table(events),
            **_origin(about),
        },
    )


def _sheet(scene: Scene, samples: np.ndarray) -> str:
    """Return the answer sheet of the end of a recording; empty where the shaft stands there."""
    if not len(samples):
        return ""
    return pairs({name: text for group in sheet(scene, results(scene, samples)) for name, text in group})


def _thinned(block: np.ndarray, samples: int) -> np.ndarray:
    """Return every n-th sample of a block, and its last, so that a long recording fits into memory and a picture."""
    every = max(1, samples // (4 * _MOST_POINTS))
    kept = np.arange(0, len(block), every)
    return np.ascontiguousarray(block[np.union1d(kept, [len(block) - 1])])


class _Trouble(NamedTuple):
    """All events of one kind about one subject: the first one's text and time, how often it was, and when last."""

    first: Event
    count: int
    last: float

    @property
    def warning(self) -> str:
        """The text of the first one with its time, so that a number stands beside the instant of which it is, and how often it came again."""
        again = f"; {self.count} times until {self.last:.6g} s" if self.count > 1 else ""
        return f"{self.first.text} (at {self.first.time:.6g} s{again})"


def _grouped(events: Iterable[Event]) -> list[_Trouble]:
    """Return each kind of event once for each of its subjects and levels, in the order in which they came first."""
    found: dict[tuple, list[Event]] = {}
    for event in events:
        found.setdefault((event.key, event.level), []).append(event)
    return [_Trouble(each[0], sum(event.count for event in each), max(event.time for event in each)) for each in found.values()]


def _events_table(events: Sequence[Event]) -> str:
    """Return the table of events, one row for each kind about one subject; the recording has all."""
    columns = (
        Column("first", "s", "time of the first one since the start"),
        Column("last", "s", "of the last one"),
        Column("count", "", "how often"),
        Column("level", "", "severity"),
        Column("kind", "", "identifier"),
        Column("text", "", "of the first one"),
    )
    rows = [(each.first.time, each.last, each.count, each.first.level.name, each.first.kind, each.first.text) for each in _grouped(events)]
    return _folded_table(columns, rows, f"{len(events)} events") if rows else ""


def _folded_table(columns: Sequence[Column], rows: Iterable[Sequence], summary: str) -> str:
    """Return a table that opens at a click, from rows of values in the order of the columns."""
    return rows_table(columns, [dict(zip([column.name for column in columns], row)) for row in rows], summary)


def _weights(times: np.ndarray, scene: Scene) -> np.ndarray:
    """Return the simulated time that each sample of a recording stands for [s], shape (n,): that since the sample before.

    Gaps are not simulated, and not recorded as such: an interval counts as one where a replay would see a gap in a log with these stamps
    (`bearing_sim.inputs.profile.is_gap`), and the sample after it stands for a usual interval.
    """
    if len(times) < 2:
        return np.ones(len(times))
    weights = np.diff(times, prepend=times[0])
    stamps = np.round(1e9 * times).astype(np.int64)
    ends = [end for _, end in gaps_of(stamps, scene.accepted_inputs)]
    weights[np.searchsorted(stamps, ends)] = np.median(weights[1:])
    return weights


def _turns(samples: np.ndarray, scene: Scene) -> np.ndarray:
    return turns(samples["shaft_speed"], scene.thresholds.slip_from_speed)


def _while_turning(samples: np.ndarray, scene: Scene) -> np.ndarray:
    return samples[_turns(samples, scene)]


def _observables(blocks: Sequence[np.ndarray], settled: np.ndarray, scene: Scene) -> str:
    """Return a table of all observables that are single numbers and not always 0: the mean at the end, and the range.

    Lives are averaged by their damage rates, because damage adds up.  What is divided by the speed of the shaft counts while that turns.
    """
    columns = (
        Column("observable", "", "name"),
        Column("unit", "", "unit"),
        Column("mean at the end", "", f"over the last {100 * _LAST:g} %"),
        Column("smallest", "", "of the whole recording"),
        Column("largest", "", "of the whole recording"),
        Column("meaning", "", "what it is"),
    )
    rows = []
    for one in OBSERVABLES:
        if one.per_roller or one.name == "time":
            continue
        is_divided = one.name in DIVIDED
        values = np.concatenate([each[one.name][_turns(each, scene)] if is_divided else each[one.name] for each in blocks])
        finite = values[np.isfinite(values)]
        if finite.any():
            last = _while_turning(settled, scene) if is_divided and one.unit != "h" else settled  # lives: no damage at rest is part of their mean
            end = last[one.name][~np.isnan(last[one.name])]
            mean = mean_life(end) if one.unit == "h" else end.mean()
            numbers = (float(mean) if len(end) else math.nan, float(finite.min()), float(finite.max()))
            rows.append((one.name, one.unit, *numbers, one.meaning))
    return _folded_table(columns, rows, f"{len(rows)} observables")


def _draw_loads(stream, settled: np.ndarray) -> None:
    """Draw the mean load of a roller over its azimuth."""
    sector = np.floor(np.mod(settled["roller_angle"], 2 * math.pi) / (2 * math.pi) * _SECTORS).astype(int).ravel() % _SECTORS
    azimuths = (np.arange(_SECTORS) + 0.5) * 360.0 / _SECTORS
    figure = new_figure(8, 3.6)
    axes = figure.subplots()
    for ring, colour in zip(("inner", "outer"), COLOURS):
        sums, counts = (np.bincount(sector, weights, _SECTORS) for weights in (settled[f"{ring}_load"].ravel(), None))
        axes.plot(azimuths, np.where(counts > 0, sums / np.maximum(counts, 1), np.nan), color=colour, marker=".", ms=3, label=f"{ring} raceway")
    axes.set(xlabel="azimuth [deg]", ylabel="roller load [N]", xlim=(0, 360), xticks=range(0, 361, 45))
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)
    save(figure, stream, dpi=110)


# What all pages have


def _opening(about: Mapping, remarks: Sequence[str]) -> str:
    """Return the command and the warnings of a result."""
    made = command(about["command"]) if about.get("command") else ""
    again = f"<p>Reproduced by <code>{escape(about['reproduced by'])}</code></p>" if about.get("reproduced by") else ""
    scene = _scene(about)
    if isinstance(scene, SceneError):
        remarks = [
            *remarks,
            f"the scene was written by another version of bearing_sim ({about.get('version') or 'unknown'}) and is shown as text only: {scene}",
        ]
    elif scene is not None:
        remarks = [*remarks, *plausibility(scene), *left_out(scene)]
    return made + again + warnings(remarks)


def _scene_text(about: Mapping) -> str:
    """Return the scene of a result as YAML; empty if it is not known."""
    return about.get("scene_yaml") or about.get("scene_of_first_point") or ""


def _scene(about: Mapping) -> Scene | SceneError | None:
    """Return the scene of a result; the error if this version cannot read it, None if it is not known."""
    try:
        return scene_from_yaml(_scene_text(about)) if _scene_text(about) else None
    except SceneError as error:
        return error


def _origin(about: Mapping) -> dict[str, str]:
    """Return the sections on the scene, and on where the result comes from."""
    scene, text = _scene(about), _scene_text(about)
    named = {name: about[name] for name in ("scene", "overrides", "level", "duration", "version", "commit") if about.get(name)}
    if "overrides" in named:
        named["overrides"] = " ".join(f"--set {each}" for each in about["overrides"])
    if "duration" in named:
        named["duration"] = f"{about['duration']:g} s a run, longer until it has settled"
    sections = {"Provenance": pairs(named | {name: about[name] for name in versions() if about.get(name)})} if named else {}
    if text:
        table = _scene_table(scene) if isinstance(scene, Scene) else ""
        sections = {"Bearing and conditions": table + folded("the scene as YAML, all values in SI", text)} | sections
    return sections


def _scene_table(scene: Scene) -> str:
    """Return a table of what a scene says of bearing, lubricant and operation."""
    bearing = scene.bearing
    named = {
        "bearing": bearing.designation or bearing.name,
        "rollers": bearing.roller.count,
        "lobes of the outer raceway": bearing.outer_raceway.lobes,
        "cage guided by": bearing.cage.guidance.replace("_", " "),
        "life": studied.life_name(scene),
        "estimated, because no source prints them": ", ".join(each.field for each in bearing.estimated),
    }
    columns = Column("quantity", "", "dotted path in the scene"), Column("value", "", "with its unit"), Column("meaning", "", "what it is")
    rows, estimated = [], {f"bearing.{each.field}": f"; estimated: {each.by}" for each in bearing.estimated}
    for path, declared in quantities(Scene).items():
        value = value_at(scene, path)
        if isinstance(value, float):
            rows.append((path, declared.show(value), declared.meaning + estimated.get(path, "")))
    return pairs({name: value for name, value in named.items() if value}) + _folded_table(columns, rows, f"{len(rows)} quantities of the scene")
