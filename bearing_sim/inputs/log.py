# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Input logs: shaft speed, radial load, temperatures, measured cage speed and clearance from recordings of any origin, complete or cut short.

Files are read record by record, which works without their end.

Reading takes what is there.  Judging (`bearing_sim.inputs.profile.judge`) passes every message through the same gate as a live run
(`bearing_sim.inputs.gate`): bad messages are refused and counted, never repaired.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from bearing_sim.files.limits import LOG_MESSAGES, FileError, printable
from bearing_sim.files.tally import Tally
from bearing_sim.inputs.gate import REQUIRED, UNITS, shown
from bearing_sim.messages import topics
from bearing_sim.recording.bag import LATEST, RecordingError
from bearing_sim.recording.bag_reader import BagReader, BagTopic
from bearing_sim.recording.message_fields import numbers, suggestion
from bearing_sim.scene.loader import did_you_mean
from bearing_sim.scene.quantity import conversion, to_si

_CHANNELS = (*topics.INPUTS, *topics.MEASURED_CHANNELS)
_WITH_UNIT = {"rad/s": "{}rpm", "N": "{}N or {}kN", "K": "{}degC", "m": "{}um"}
_LONGEST_REASON = 500  # characters
_MOST_LISTED = 50  # topics in a message
_STEP = re.compile(r"\.?([A-Za-z_]\w*)|\[(-?\d+)\]")


class InputLogError(ValueError):
    """A recording that cannot serve as an input log; the message says what it contains instead."""


class ReadError(NamedTuple):
    """A message that could not be read."""

    log_ns: int  # [ns since the epoch]
    kind: str  # of its event
    reason: str


@dataclass
class Series:
    """The messages of one channel in the order of their log times.

    Attributes
    ----------
    topic, ros_type : where they were found; topic ``""`` for a value that nobody measured (``constants`` of `read_input_log`).
    stamped_by : ``"header"`` or ``"log time"``: the clock of ``stamps``.
    stamps, log_times : [ns since the epoch], one for each message read.
    values : values of each message in SI (see `bearing_sim.messages.topics.input_values`).
    errors : the messages that could not be read.
    """

    topic: str
    ros_type: str
    stamped_by: str = "log time"
    stamps: list[int] = field(default_factory=list)
    log_times: list[int] = field(default_factory=list)
    values: list[tuple[float, ...]] = field(default_factory=list)
    errors: list[ReadError] = field(default_factory=list)


@dataclass(frozen=True)
class InputLog:
    """The inputs that a recording contains.

    Attributes
    ----------
    path : the recording; several of them are joined with ``+``.
    series : by channel (see `bearing_sim.inputs.gate.CHANNELS`): ``shaft_speed``, ``radial_load`` and the others where recorded.
    lost : what was there besides the messages in ``series`` and their errors and could not be read, with the reasons; where reading stopped.
    """

    path: Path
    series: Mapping[str, Series]
    lost: Tally = field(default_factory=Tally)

    @property
    def unfinished(self) -> str:
        """Where and why reading stopped before the end of a file, or ``""``."""
        return self.lost.unfinished


class Source(NamedTuple):
    """Where a recording holds a channel: topic, fields of its messages, unit.

    Attributes
    ----------
    topic : full topic name.
    fields : path of each number in the message (``"velocity[0]"``); empty for the standard types of `bearing_sim.messages.topics.input_types`.
    scale, offset : value in SI = ``scale`` times the number in the message + ``offset``.
    """

    topic: str
    fields: tuple[str, ...] = ()
    scale: float = 1.0
    offset: float = 0.0


def source(channel: str, text: str | None = None, unit: str | None = None) -> Source:
    """Return the source that a text describes.

    Parameters
    ----------
    channel : one of `bearing_sim.inputs.gate.CHANNELS`.
    text : ``/topic`` (the slash is optional), or ``/topic.path.to[0].number``; a load may have two paths, ``/topic.force.y,force.z``.  By
        default the channel's own name.
    unit : of the numbers, such as ``rpm``, also for standard types; by default rad/s, N or degC.

    Raises
    ------
    ValueError
        A path or a unit cannot be parsed, or there are too many paths.
    """
    topic, _, path = (text or channel).partition(".")
    fields = tuple(part.strip().lstrip(".") for part in path.split(",")) if path else ()
    if any(not field or _STEP.sub("", field) for field in fields):
        raise ValueError(f"{text}: cannot parse the path of a field; expected for example /servo/state.velocity[0]")
    if len(fields) > (2 if channel == "radial_load" else 1):
        raise ValueError(f"{text}: {channel} has {len(fields)} fields, expected one{', or y and z' if channel == 'radial_load' else ''}")
    unit = unit or ("degC" if channel in topics.TEMPERATURES and fields else None)
    scale, offset = conversion(unit, UNITS[channel]) if unit else (1.0, 0.0)
    return Source(topic if topic.startswith("/") else f"/{topic}", fields, scale, offset)


def is_constant(text: str | None) -> bool:
    """Return whether a text is a number with a unit, not the name of a topic, which never begins with a digit."""
    return bool(text) and re.match(r"\s*[-+]?\.?\d", text) is not None


def constant(channel: str, text: str, unit: str | None = None) -> float:
    """Return the value [SI] of a channel that a text such as ``800N`` or ``1500 rpm`` gives.

    Parameters
    ----------
    channel : one of `bearing_sim.inputs.gate.CHANNELS`.
    text : a number with a unit.
    unit : of a number without one.

    Raises
    ------
    ValueError
        The text is no such quantity, or it is no finite number; it names the channel and what was expected.
    """
    bare = re.fullmatch(r"\s*[-+]?[\d.]+([eE][-+]?\d+)?\s*", text) is not None
    if bare and not unit:
        raise ValueError(
            f"{channel} = {text.strip()}: a number without a unit; write for example {_WITH_UNIT[UNITS[channel]].replace('{}', text.strip())}"
        )
    try:
        value = to_si(f"{text} {unit}" if bare else text, UNITS[channel])
    except ValueError as error:
        raise ValueError(f"{channel} = {text}: {error}") from None
    if channel == "radial_load" and value < 0.0:
        raise ValueError(f"{channel} = {text}: expected zero or more; the load acts along +y")
    return value


def source_values(channel: str, where: Source, ros_type: str, message, joint: str) -> tuple[float, ...]:
    """Return the values of a message in SI, as `bearing_sim.messages.topics.input_values` does for the standard types.

    Raises
    ------
    ValueError
        The message has no such field, or the field is not a number.
    """
    if not where.fields:
        numbers = topics.input_values(channel, ros_type, message, joint)
        if where.scale == 1.0 and not where.offset:
            return numbers
        if channel in topics.TEMPERATURES:  # in degC by its type, but the user has named another unit
            numbers = tuple(number - topics.ZERO_CELSIUS for number in numbers)
    else:
        numbers = tuple(_number(message, field) for field in where.fields)
    return tuple(where.scale * number + where.offset for number in numbers)


def _number(message, path: str) -> float:
    found = message
    for name, index in _STEP.findall(path):
        try:
            found = found[int(index)] if index else getattr(found, name)
        except AttributeError:
            there = [field for field in getattr(found, "__slots__", None) or getattr(found, "__dict__", ()) if not field.startswith("_")]
            hint = suggestion(message, path)
            raise ValueError(f"no field {name!r} in the message ({path}); it has {', '.join(there) or 'none'}{hint}") from None
        except IndexError:
            raise ValueError(f"the message has {len(found)} numbers at {path}, none with index {index}") from None
        except TypeError:
            raise ValueError(f"{path}: the part before {name or f'[{index}]'} has no fields or items") from None
    try:
        return float(found)
    except (TypeError, ValueError):
        raise ValueError(f"{path} is not a number but {type(found).__name__}{suggestion(message, path)}") from None


def read_input_log(
    path: str | Path | Sequence[str | Path],
    names: Mapping[str, str | Source | None] | None = None,
    joint: str = topics.SHAFT_JOINT,
    stamps: str = "header",
    cage_joint: str = topics.CAGE_JOINT,
    required: Iterable[str] = REQUIRED,
    constants: Mapping[str, float] = MappingProxyType({}),
) -> InputLog:
    """Read the inputs of a recording, or of several that belong together.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), an sqlite3 file or a bag's folder; or a sequence of them.
    names : by channel, topic or topic and field (see `source`), if it is not the channel's own name, such as ``/shaft_speed``.
    joint, cage_joint : names of the joints of shaft and cage in JointState messages.
    stamps : ``"header"`` takes header stamps if the type has them and they are set, otherwise log times; ``"log"`` takes log times only.
    required : channels that must be present.
    constants : by channel, a value in SI that stands for a channel that was not measured, at each stamp of the shaft speed or, where that is
        the constant, of the load; messages of the channel in the recording are not read.

    Raises
    ------
    InputLogError
        No such recording, or topics are missing; the message lists the topics in the recording.  Or both speed and load are constants.
    """
    measured = [channel for channel in REQUIRED if channel not in constants]
    if not measured:
        raise InputLogError("both speed and load are constants, so that nothing is left of the log; `bearing-sim run` takes them")
    paths = [Path(path)] if isinstance(path, (str, Path)) else [Path(each) for each in path]
    sources = {channel: where for channel, where in _sources(names).items() if channel not in constants}
    joints = dict.fromkeys(_CHANNELS, joint) | {topics.MEASURED: cage_joint, topics.MEASURED_CLEARANCE: topics.CLEARANCE_JOINT}
    wanted = _Wanted(sources, joints, stamps, {}, {}, {})
    lost = Tally()
    for each in paths:
        try:
            lost.add([_read(BagReader(each), wanted)])
        except FileError as error:
            raise InputLogError(str(error)) from None
    together = paths[0] if len(paths) == 1 else Path(" + ".join(map(str, paths)))
    try:
        _check_found(together, wanted, tuple(each for each in required if each not in constants), names or {})
    except InputLogError as error:
        raise InputLogError("; ".join([str(error), *lost.unread])) from None
    for series in wanted.found.values():
        _sort_by_log_time(series)
    for channel, value in constants.items():
        wanted.found[channel] = _constant_series(wanted.found[measured[0]], value)
    return InputLog(together, wanted.found, lost)


class LogReading(NamedTuple):
    """How recordings are read: where they hold what.

    Attributes
    ----------
    sources : by channel, where it is not called by its own name.
    constants : by channel, values in SI that were not measured.
    joint, stamps : as of `read_input_log`.
    longest_gap : between messages that is simulated [s]; None: as of `bearing_sim.inputs.profile.judge`.
    speed_unit : of speeds that are fields; None: rad/s.
    """

    sources: dict[str, Source]
    constants: dict[str, float]
    joint: str
    stamps: str
    longest_gap: float | None
    speed_unit: str | None

    @property
    def is_given(self) -> bool:
        """Whether something is said of a channel."""
        return bool(self.sources or self.constants)

    def read(self, *paths: Path, **more) -> InputLog:
        """Return the input log of recordings; further parameters and errors as of `read_input_log`."""
        return read_input_log(paths, self.sources, self.joint, self.stamps, constants=self.constants, **more)


class _Wanted(NamedTuple):
    """What to look for, and what was found; of topics that no channel has, the first message, from which fields are suggested."""

    sources: dict[str, Source]  # by channel
    joints: dict[str, str]  # by channel
    stamps: str
    found: dict[str, Series]
    present: dict[str, str]  # type by topic
    others: dict[str, object]  # decoded, by topic

    def reader(self, topic: str, ros_type: str, decode: Callable[[bytes], object], own_name: str) -> Callable[[int, bytes], None]:
        """Return a function that adds a topic's messages (log time, data) to the series of their channels."""
        self.present[topic] = ros_type or "?"
        asked = {own_name or topic, *({topic} if topic.removeprefix("/") not in _CHANNELS else ())}  # a channel's name stands for the channel
        named = {channel: where._replace(topic=topic) for channel, where in self.sources.items() if where.topic in asked}
        readers = [_message_reader(channel, where, ros_type, decode, self) for channel, where in named.items()]
        if len(readers) < 2:
            return readers[0] if readers else self._keeper(topic, decode)
        return lambda log_time, data: [read(log_time, data) for read in readers]

    def _keeper(self, topic: str, decode: Callable[[bytes], object]) -> Callable[[int, bytes], None]:
        """Return a function that keeps the first message of a topic."""

        def keep(log_time: int, data: bytes) -> None:
            if topic not in self.others:
                self.others[topic] = None
                with suppress(Exception):  # decoders raise exceptions of any kind; then nothing is suggested
                    self.others[topic] = decode(data)

        return keep


def _sources(names: Mapping[str, str | Source | None] | None) -> dict[str, Source]:
    given = {channel: (names or {}).get(channel) for channel in _CHANNELS}
    try:
        return {channel: named if isinstance(named, Source) else source(channel, named) for channel, named in given.items()}
    except ValueError as error:
        raise InputLogError(str(error)) from None


def _read(bag: BagReader, wanted: _Wanted) -> Tally:
    """Add a recording's messages; return what could not be read."""
    readers: dict[BagTopic, Callable[[int, bytes], None]] = {}
    for found in bag:
        if isinstance(found, BagTopic):
            readers[found] = wanted.reader(*found)
        else:
            readers[found[0]](*found[1:])
    return replace(bag.tally, used=0, there=bag.tally.refused.total())


def _message_reader(channel: str, where: Source, ros_type: str, decode: Callable, wanted: _Wanted) -> Callable[[int, bytes], None]:
    """Return a function that adds a topic's messages to a channel's series."""
    if not where.fields and ros_type not in topics.input_types(channel):
        return _refusal(channel, where, ros_type, decode)
    series = wanted.found.setdefault(channel, Series(where.topic, ros_type))
    if series.ros_type != ros_type:
        raise InputLogError(f"{where.topic} carries both {series.ros_type} and {ros_type}; expected one type")

    most = LOG_MESSAGES.value

    def read(log_time: int, data: bytes) -> None:
        if len(series.stamps) + len(series.errors) >= most:
            raise InputLogError(f"{where.topic} has {LOG_MESSAGES.refusal()}")
        try:
            decoded = decode(data)
        except RecordingError:
            raise
        except Exception as error:  # decoders raise exceptions of any kind on damaged data
            series.errors.append(ReadError(log_time, "input.unreadable", f"cannot be decoded ({printable(str(error), _LONGEST_REASON)})"))
            return
        try:
            values = source_values(channel, where, ros_type, decoded, wanted.joints[channel])
            stamp = topics.header_stamp_ns(decoded) if wanted.stamps == "header" else None
            if stamp is not None and not 0 < stamp < LATEST:
                raise ValueError("the header's stamp is before 1970 or after 2116")
        except (AttributeError, LookupError, TypeError, ValueError, ArithmeticError) as error:  # a definition may give a type any fields
            series.errors.append(ReadError(log_time, "input.malformed", printable(str(error), _LONGEST_REASON)))
            return
        if not series.stamps and stamp is not None:
            series.stamped_by = "header"
        if series.stamped_by == "header" and stamp is None:
            series.errors.append(ReadError(log_time, "input.not_stamped", "the header's stamp is not set, although it is in other messages"))
            return
        series.stamps.append(stamp if series.stamped_by == "header" else log_time)
        series.log_times.append(log_time)
        series.values.append(values)

    return read


def _refusal(channel: str, where: Source, ros_type: str, decode: Callable) -> Callable[[int, bytes], None]:
    """Return a function that refuses a topic whose type does not fit a channel, and names a field of its first message that may."""

    def refuse(log_time: int, data: bytes) -> None:
        example = "some.field"
        with suppress(Exception):  # decoders raise exceptions of any kind on damaged data
            example = next((path for path, _ in numbers(decode(data))), example)
        expected = " or ".join(topics.input_types(channel))
        named = f"name a field of it, such as {where.topic}.{example}"
        raise InputLogError(f"{where.topic} is of type {ros_type or 'unknown'}; {channel} needs {expected}, or {named}")

    return refuse


def _check_found(path: Path, wanted: _Wanted, required: tuple[str, ...], named: Mapping[str, str | Source | None]) -> None:
    found, present = wanted.found, wanted.present
    listing = ", ".join(f"{topic} ({kind})" for topic, kind in sorted(present.items())[:_MOST_LISTED]) or "no topics"
    listing += f" and {len(present) - _MOST_LISTED} more topics" if len(present) > _MOST_LISTED else ""
    absent = [where.topic for channel, where in wanted.sources.items() if channel not in found and (channel in required or named.get(channel))]
    if absent:
        hints = "; ".join(f"no message on {topic}" if topic in present else f"no {topic}{did_you_mean(topic, present)}" for topic in absent)
        fields = [f"{topic}.{field}" for topic, message in sorted(wanted.others.items()) for field, _ in islice(numbers(message), 1)]
        named = f"; name a number in a message by its field, such as {' or '.join(fields[:2])}" if fields else ""
        raise InputLogError(f"{path}: {hints}; the file has {listing}{named}")
    empty = [series.topic for channel, series in found.items() if channel in required and not series.stamps]
    if empty:
        first = [error.reason for series in found.values() for error in series.errors[:1]]
        first = [f"{reason}; --joint NAME chooses one" if "no joint" in reason else reason for reason in first]
        raise InputLogError(f"{path}: no usable message on {', '.join(empty)}{' (' + first[0] + ')' if first else ''}")


def _constant_series(timed: Series, value: float) -> Series:
    """Return a series with one value at the stamps of another series."""
    return Series("", "constant", timed.stamped_by, list(timed.stamps), list(timed.log_times), [(value,)] * len(timed.stamps))


def _sort_by_log_time(series: Series) -> None:
    """Sort messages into the order in which they were recorded: chunks may overlap."""
    order = sorted(range(len(series.stamps)), key=series.log_times.__getitem__)
    if order != list(range(len(order))):
        series.stamps = [series.stamps[k] for k in order]
        series.log_times = [series.log_times[k] for k in order]
        series.values = [series.values[k] for k in order]


def summary_lines(log: InputLog) -> Iterable[str]:
    """Yield one line of text for each channel: topic, type, clock, number of messages, and their anomalies."""
    for channel, series in log.series.items():
        if not series.topic:
            yield f"{channel}: {shown(channel, series.values[0][:1])} throughout, not measured"
            continue
        odd = [f"{len(series.errors)} not readable"] if series.errors else []
        odd += [f"{count} {name.replace('_', ' ')}" for name, count in anomalies(series)._asdict().items() if count]
        yield ", ".join([f"{channel}: {series.topic} ({series.ros_type}), {len(series.stamps)} messages timed by {series.stamped_by}", *odd])


class Anomalies(NamedTuple):
    """Anomalies in the times of a channel's messages, counted in the order of recording.

    Attributes
    ----------
    out_of_order : messages stamped before an earlier one.
    repeated : messages with the stamp of the one before.
    in_bursts : messages logged less than a tenth of the usual spacing of stamps after the one before.
    gaps : spacings of stamps above ten times the usual one.
    """

    out_of_order: int
    repeated: int
    in_bursts: int
    gaps: int


def usual_spacing(stamps: Sequence[int]) -> float:
    """Return the median spacing of rising stamps [ns]; 0 for fewer than two different ones."""
    risen = np.diff(np.maximum.accumulate(np.array(stamps, np.int64))) if len(stamps) else np.zeros(0)
    risen = risen[risen > 0]
    return float(np.median(risen)) if len(risen) else 0.0


def anomalies(series: Series) -> Anomalies:
    """Count the anomalies in the times of a channel's messages; the usual spacing is the median."""
    stamps, logged = np.array(series.stamps, np.int64), np.array(series.log_times, np.int64)
    if len(stamps) < 2:
        return Anomalies(0, 0, 0, 0)
    latest = np.maximum.accumulate(stamps)
    steps, risen, usual = np.diff(stamps), np.diff(latest), usual_spacing(series.stamps)
    return Anomalies(
        int((stamps[1:] < latest[:-1]).sum()),
        int((steps == 0).sum()),
        int((np.diff(logged) < 0.1 * usual).sum()) if series.stamped_by == "header" else int(((steps > 0) & (steps < 0.1 * usual)).sum()),
        int((risen > 10 * usual).sum()) if usual else 0,
    )
