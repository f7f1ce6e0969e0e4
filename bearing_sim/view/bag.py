# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What can be shown of a recording that others wrote: its speeds, loads and further numbers, and what is missing."""

import math
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bearing_sim.events import Event, Level
from bearing_sim.sinks import colours
from bearing_sim.sinks.overview import Lines, Overview, Thinned, bucket_for
from bearing_sim.sinks.rerun_lines import LINES, dim, plottable, range_path
from bearing_sim.sinks.rerun_series import LOG_LEVELS, TIMELINE
from bearing_sim.sinks.rerun_view import APPLICATION

_ROLES = {  # where the same quantity stands in views of our own runs, and the title of its plot
    "speed": ("/speed/shaft", "Speeds [rpm] (blue: shaft, white: cage, measured)"),
    "cage_speed": ("/speed/cage_measured", "Speeds [rpm] (blue: shaft, white: cage, measured)"),
    "load": ("/load/radial", "Radial load [N]"),
    "temperature": ("/oil/temperature", "Oil [°C]"),
}
_AROUND = (colours.BLUE, colours.ORANGE, colours.GREEN, colours.YELLOW, colours.VERMILION, colours.PURPLE, colours.WHITE, colours.GREY)
_MOST_PLOTS = 9


def write_bag_view(
    path: str | Path,
    name: str,
    start_ns: int,
    series: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]],
    events: list[Event],
    left_out: list[str],
) -> None:
    """Write an .rrd file.

    Parameters
    ----------
    path : of the file.
    name : of the recording.
    start_ns : time 0 [ns since the epoch].
    series, events, left_out : as of `bearing_sim.bag_series.BagSeries`.
    """
    recording = rr.RecordingStream(APPLICATION)
    recording.set_log_time_enabled(False)
    recording.set_sinks(rr.FileSink(str(path)))
    recording.send_recording_name(name)
    recording.send_recording_start_time_nanos(start_ns)
    plots: dict[str, list[str]] = {}
    for (role, line, unit), (times, values) in series.items():
        entity, title = _ROLES[role] if role else (_entity(line), f"{line.split(' ')[0]} [{unit}]")
        paths = plots.setdefault(title, [])
        if entity in paths:  # a second topic of the same role
            entity = _entity(line)
        style = LINES[entity][:2] if entity in LINES else (line, _AROUND[len(paths) % len(_AROUND)])
        _write_line(recording, entity, style, times, plottable(values))
        paths.append(entity)
    for event in events:
        recording.set_time(TIMELINE, duration=event.time)
        recording.log("/log", rr.TextLog(f"{event.text}  [{event.code}]", level=LOG_LEVELS[Level(event.level)]))
    text = "\n".join([f"## {name}", "", "Not written by bearing_sim. Not shown:", "", *(f"- {line}" for line in left_out)])
    recording.log("/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
    recording.send_blueprint(_blueprint(plots))
    recording.flush(timeout_sec=30.0)
    recording.disconnect()


def _entity(line: str) -> str:
    return "/bag/" + "/".join(rr.escape_entity_path_part(part) for part in line.replace(" ", "/").split("/") if part)


def _write_line(recording: rr.RecordingStream, entity: str, style, times: np.ndarray, values: np.ndarray) -> None:
    name, colour = style
    recording.log(entity, rr.SeriesLines(names=[name], colors=[colour], widths=[2.0]), static=True)
    thinned = Thinned(Lines(times, {entity: values}), Lines(times[:0], {}))
    interval = (times[-1] - times[0]) / max(len(times) - 1, 1)
    bucket = bucket_for(interval, float(times[-1] - times[0])) if interval > 0.0 else None
    if bucket is not None:
        overview = Overview(bucket)
        parts = [part for part in (overview.add(thinned.lines), overview.finish()) if part is not None]
        recording.log(range_path(entity), rr.SeriesLines(names=[f"{name}, lowest", f"{name}, highest"], colors=[dim(colour)] * 2), static=True)
    else:
        parts = [thinned]
    for part in parts:
        for lines, path in ((part.lines, entity), (part.ranges, range_path(entity))):
            if len(lines.times):
                index = [rr.TimeColumn(TIMELINE, duration=lines.times)]
                recording.send_columns(path, indexes=index, columns=rr.Scalars.columns(scalars=lines.values[entity].astype(np.float32)))


def _blueprint(plots: dict[str, list[str]]) -> rrb.Blueprint:
    axis = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    known = [title for _, title in _ROLES.values() if title in plots]
    titles = list(dict.fromkeys([*known, *plots]))
    views = [rrb.TimeSeriesView(origin="/", contents=[*map(range_path, plots[title]), *plots[title]], name=title, axis_x=axis) for title in titles]
    shown, hidden = views[:_MOST_PLOTS], views[_MOST_PLOTS:]
    columns = 1 if len(shown) <= 4 else 2
    rows = math.ceil(len(shown) / columns)
    grid = rrb.Horizontal(*(rrb.Vertical(*shown[k * rows : (k + 1) * rows]) for k in range(columns)))
    about = rrb.TextDocumentView(origin="/about", name="What is not shown")
    log = rrb.TextLogView(origin="/log", name="Log", columns=rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["loglevel", "body"]))
    beside = rrb.Vertical(about, *([rrb.Tabs(*hidden)] if hidden else []), log)
    return rrb.Blueprint(
        rrb.Horizontal(grid, beside, column_shares=[0.68, 0.32]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following"),
        auto_views=False,
        auto_layout=False,
    )
