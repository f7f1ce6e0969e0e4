# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What watches a run: a watcher hears what is measured, sees every sample, and says what holds.  Nothing else in the run knows what it is.

Runs in wall time, runs in simulated time, replays and reproductions have the same watchers: those of `BUILT_IN` that the scene asks for, and those
that it names (``watchers: [loaded_rollers]``); each is imported only then.  ``doc/contributing/extend.md`` writes one.
"""

import dataclasses
import importlib
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Record
from bearing_sim.messages.topics import MEASURED_CLEARANCE
from bearing_sim.model.sample import joined
from bearing_sim.model.validity import Exceedance
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.scene.watchers import place_of

NOTHING: Mapping = MappingProxyType({})
MEMORY = "state"
"""Name of the watcher that remembers the bearing."""


class Run:
    """What a run tells its watchers beside what it shows them; base of all runs, and by itself the run of a watcher that stands alone.

    Attributes
    ----------
    acts_on_arrival : whether messages act as they arrive, so that a measurement belongs to the newest sample; otherwise they act at their stamps.
    is_reviewed : whether somebody asks from time to time what holds; otherwise (the clock is a log) samples are judged by themselves, and a watcher
        may take many together, see `Watcher.together`.
    start_ns : run time 0 [ns since the epoch].
    starts_ns : that by the clock now, and by the clock before it was set.
    interval : between two samples where no time was skipped [s].
    reset_at : when the run was reset to its start last [s]; minus infinity at the start of the run.
    published_until : time of the newest sample that is surely published [s].
    newest : the newest sample, which watchers may not have seen yet; None before the first.
    shaft_speed : the newest measured one [rad/s]; NaN before the first.
    is_predicted : whether the newest sample predicts what is measured now: not where the run has not begun or computes at another level.
    heard : input channels with good messages; None where that is not known.
    newest_bands : the newest bands of results; None before the first.
    watchers : all that watch the run.
    """

    acts_on_arrival = is_reviewed = False
    start_ns = 0
    interval = shaft_speed = math.nan
    reset_at = -math.inf
    published_until = math.inf
    newest: np.void | None = None
    is_predicted = True
    heard: Collection[str] | None = None
    newest_bands: Bands | None = None
    watchers: "Watchers"

    @property
    def starts_ns(self) -> tuple[int, ...]:
        """See the attribute."""
        return (self.start_ns,)

    def begins_at(self) -> int:
        """Return the instant at which its simulation begins [ns since the epoch]; may be called on a solver thread."""
        return self.start_ns

    def stamp(self, run_time: float) -> int:
        """Return the instant of the clock [ns since the epoch] of a run time [s]."""
        return self.start_ns + round(run_time * 1e9)


class Watcher:
    """Base of watchers; each act may be left out.  Times are those of the samples [s].

    The acts from `hear` to `close` are those of every watcher.  The others are for what few have: memory, learning, limits of its own, services.

    Parameters
    ----------
    scene : of the run.

    Attributes
    ----------
    run : what it watches; set before its first act.
    together : samples that it sees at once in a run that nobody reviews: what it says of them may come later.
    tells_changes : whether `see` returns the events that begin and end in a run that nobody reviews; otherwise the run finds them out by `events`.
    goes_by_wall : whether its events and values depend on wall time, so that a run that nobody reviews, which is the same each time, is without them.
    replaces : names of watchers whose events are none as long as this one has better ones.
    remark : what its status says while there is no event.
    learned : what is to be remembered until the next run of the bearing, as JSON has it; None where it learns nothing.
    estimates : value, 5 and 95 % quantile [SI] of fields of the scene that it has calibrated, by path.
    exceedances, worst_samples : limits of validity that the run has exceeded, each with its worst value; the sample of each by the law's name.
    """

    run = Run()
    together = 1
    tells_changes = False
    goes_by_wall = False
    replaces: Collection[str] = ()
    remark = ""
    learned: dict | None = None
    estimates: Mapping[str, tuple[float, float, float]] = NOTHING
    exceedances: Sequence[Exceedance] = ()
    worst_samples: Mapping[str, np.void] = NOTHING

    def __init__(self, scene: Scene):
        self.scene = scene

    def hear(self, channel: str, time: float, value, standard_error: float) -> Sequence[Record] | None:
        """Take a measurement of one of `bearing_sim.messages.topics.MEASURED_CHANNELS` [SI]; return what sinks are to keep.

        Other channels may have other values.
        """

    def see(self, block: np.ndarray) -> Sequence[Record]:
        """Take samples in order, none twice, shape (n,), n at least 1; return what sinks are to keep."""
        return ()

    def events(self, now: float) -> Sequence[Event]:
        """Return the events that hold."""
        return ()

    def values(self, now: float) -> Mapping[str, object]:
        """Return numbers for diagnostics, with the unit in each key."""
        return {}

    def restart(self, why: str) -> None:
        """Forget the run so far: state and damage have returned to the start, or another bearing runs."""

    def close(self) -> None:
        """End with the run."""

    def begin(self) -> None:
        """Get ready; all watchers of the run are there."""

    def adjust(self, thresholds: Thresholds) -> None:
        """Use other thresholds from now on; what was learned is kept."""
        self.scene = dataclasses.replace(self.scene, thresholds=thresholds)

    def follow(self, scene: Scene) -> None:
        """Take that samples are computed at another setting of the same bearing from now on, such as another level."""

    def is_calm(self, block: np.ndarray) -> bool:
        """Return whether seeing a block at once says the same as seeing each of its samples, and the last one in the end."""
        return False

    def correct(self, block: np.ndarray, seconds: np.ndarray) -> None:
        """Change samples before anybody sees or keeps them.

        Parameters
        ----------
        block : samples in order, shape (n,).
        seconds : simulated time that each stands for [s], shape (n,); 0 at the start of a run.
        """

    def recall(self, learned: Mapping, seconds: float) -> None:
        """Continue from what was learned some time ago [s]; from nothing where it is empty.

        Raises
        ------
        KeyError, TypeError, ValueError
            It is something else.
        """

    def news(self, now: float) -> Sequence[Event]:
        """Return what has happened since the last call.  A run that is reviewed asks at each review."""
        return ()

    def measured(self) -> Sequence[tuple[str, tuple[float, ...]]]:
        """Return what it has measured itself since the last call, channel and values, which the run takes as it takes messages."""
        return ()

    def serve(self, service: str) -> tuple[bool, str] | None:
        """Answer a service of the node: whether it was done, and what to say; None where it is not one of this watcher."""

    @classmethod
    def resource(cls, scene: Scene) -> object | None:
        """Return what it needs beside the scene, such as a table on disk, which may take a moment; None where that is not there."""
        return None


class Memory(Watcher):
    """A watcher that remembers a bearing from run to run; by itself one that remembers nothing.

    Attributes
    ----------
    life_used : fraction of its life that the bearing has used; None where it is not known.
    records : metadata records of a recording that begins now, by name.
    """

    life_used: float | None = None
    records: Mapping[str, Mapping[str, str]] = NOTHING

    def begin(self) -> None:
        """Let the other watchers continue from what they have learned about the bearing."""
        for name in BUILT_IN:
            if (watcher := self.run.watchers.get(name)) is not None:
                self.remind(name, watcher)

    def remind(self, name: str, watcher: Watcher) -> None:
        """Let another watcher continue from what is remembered of what it has learned."""

    def temperatures(self, now_ns: int) -> tuple[Sequence[float], Sequence[float]] | None:
        """Return those of thermal nodes and rings [K] to begin the run with at an instant [ns since the epoch]; None where they are not known.

        It is called on the thread that advances the simulation.
        """
        return None

    def continue_from(self, life_used: float) -> None:
        """Take the fraction of its life that the bearing had used where a recorded run was reset."""

    def contained(self, time_ns: int) -> bool:
        """Return whether the bearing was watched at an instant [ns since the epoch] in an earlier run, so that nothing of it counts again."""
        return False

    @classmethod
    def recorded(cls, scene: Scene, record: Mapping[str, str]) -> "Memory":
        """Return what takes its place where a recorded run is computed again, by its metadata record (`records`).

        Raises
        ------
        ValueError
            The record cannot be used.
        """
        raise NotImplementedError


class Kind(NamedTuple):
    """A watcher that is not named by the scene.

    Attributes
    ----------
    place : module and class.
    is_asked : whether a scene asks for it in a run; otherwise it is there only where the run is given it, or its resource.
    subject, otherwise : a subject of diagnostics, and what that says where the run does without the watcher.
    record : name of its metadata record in recordings, from which it is made again.
    services : of the node that it answers, by name: what each does, and what is said where there is nothing to do it with.
    absent : event of a run whose scene asks for it, and whose resource (`Watcher.resource`) is not there; without, it needs none.
    """

    place: str
    is_asked: Callable[[Scene, Run], bool] = lambda scene, run: True
    subject: str = ""
    otherwise: str = ""
    absent: Event | None = None
    record: str = ""
    services: Mapping[str, tuple[str, str]] = NOTHING


_NO_RESPONSE = Event(
    0.0,
    Level.WARN,
    "estimate.absent",
    "",
    "the scene asks for bands or a calibration, and no response of the bearing to its uncertain fields is kept here; nothing is estimated",
    "build it with bearing-sim table SCENE --bands, with the same --set",
)
BUILT_IN = {
    "monitor": Kind("bearing_sim.watchers.monitoring.monitor:Monitor"),
    "temperatures": Kind("bearing_sim.watchers.monitoring.residual:TemperatureResiduals", lambda scene, run: scene.heat.law == "network"),
    "validity": Kind("bearing_sim.watchers.monitoring.limits:LimitsMonitor"),
    "cage_slip": Kind("bearing_sim.watchers.monitoring.residual:SlipResidual"),
    "estimation": Kind(
        "bearing_sim.watchers.estimation.live:LiveEstimation",
        lambda scene, run: scene.estimation.is_asked,
        "estimate",
        "the scene does not ask for it",
        _NO_RESPONSE,
        services={
            "accept_change": (
                "Take the machine as it is since a change that the calibration has found for the new normal.",
                "there is no change to accept: no calibration.change is reported",
            )
        },
    ),
    "vibration": Kind(
        "bearing_sim.watchers.vibration.meter:CageSpeedMeter",
        lambda scene, run: scene.vibration.is_asked and run.acts_on_arrival,
        "vibration",
        "not listened to: the scene does not ask for it, or the run has simulated time",
    ),
    MEMORY: Kind(
        "bearing_sim.watchers.stored_state.keeper:StateKeeper",
        lambda scene, run: False,
        "state",
        "nothing is remembered",
        record="bearing_sim_state",
        services={
            "get_stored_state": (
                "Answer with the stored state of the bearing as JSON: totals, calibration, temperatures.",
                "nothing is remembered: set serial or state_file, and configure the node",
            )
        },
    ),
}
"""By name, under which what they have learned is remembered."""
SERVICES = {name: said for kind in BUILT_IN.values() for name, said in kind.services.items()}
"""Those of all, as `Kind.services`."""


def kind_of(name: str) -> type[Watcher]:
    """Return the class of a watcher, which is imported here.

    Raises
    ------
    Exception
        It cannot be imported.
    """
    module, _, kind = (BUILT_IN[name].place if name in BUILT_IN else place_of(name)).partition(":")
    return getattr(importlib.import_module(module), kind)


def resources(scene: Scene, run: Run | None = None) -> dict[str, object]:
    """Return the resources that are there of the watchers that a scene asks for (`Watcher.resource`), by their names, as `Watchers` takes them."""
    return {name: found for name in _needed(scene, run) if (found := kind_of(name).resource(scene)) is not None}


def are_missing(scene: Scene) -> bool:
    """Return whether a watcher that a scene asks for lacks its resource."""
    return len(resources(scene)) < len(_needed(scene))


def _needed(scene: Scene, run: Run | None = None) -> list[str]:
    """Return the names of the watchers that a scene asks for and that need a resource."""
    return [name for name, kind in BUILT_IN.items() if kind.absent is not None and kind.is_asked(scene, run or Run())]


def recorded(scene: Scene, records: Mapping[str, Mapping[str, str]]) -> dict[str, Watcher]:
    """Return the watchers of a recorded run that its metadata records tell of (`Memory.recorded`), by their names, as `Watchers` takes them.

    Raises
    ------
    ValueError
        A record cannot be used.
    """
    return {name: kind_of(name).recorded(scene, records[kind.record]) for name, kind in BUILT_IN.items() if kind.record in records}


class Watchers:
    """The watchers of a run.  One that the scene names and that raises is named in an event and sees nothing more; the run continues.

    Parameters
    ----------
    scene : says which.
    run : that is watched; without one there are only those that the scene names.
    given : by name a watcher of `BUILT_IN`, or its second argument, such as its resource.
    only_given : whether there are no others.
    """

    def __init__(self, scene: Scene, run: Run | None = None, given: Mapping[str, object] = NOTHING, only_given: bool = False):
        self._scene, self._run, self._optional = scene, run or Run(), set() if only_given else set(scene.watchers)
        self._watchers: dict[str, Watcher] = {}
        self._waiting: dict[str, list[np.ndarray]] = {}
        self._failed: list[Event] = []
        self._absent: dict[str, Event] = {}
        for name, kind in BUILT_IN.items() if run is not None else ():
            is_asked = kind.is_asked(scene, run)
            if name in given and (is_asked or isinstance(given[name], Watcher)):
                self._add(name, given[name])
            elif only_given:
                continue
            elif is_asked and kind.absent is not None:
                self._absent[name] = kind.absent
            elif is_asked:
                self._add(name)
        for name in () if only_given else scene.watchers:
            try:
                self._add(name)
            except Exception as error:  # of code that is not the run's, as in `_ask`
                self._fail(name, 0.0, error)

    def _add(self, name: str, given: object = None) -> None:
        watcher = given if isinstance(given, Watcher) else kind_of(name)(self._scene, *(() if given is None else (given,)))
        watcher.run = self._run
        self._watchers[name] = watcher

    def _fail(self, name: str, now: float, error: Exception) -> None:
        for of_watchers in (self._watchers, self._waiting):
            of_watchers.pop(name, None)
        reason = f"failed: {type(error).__name__}: {error}"
        self._failed.append(Event(now, Level.ERROR, f"watcher.{name}", name, reason, "it sees nothing more; the run continues"))

    def _ask(self, name: str, now: float, act: str, *arguments) -> object | None:
        """Return the answer of one watcher; None where it has none or fails."""
        try:
            return getattr(self._watchers[name], act)(*arguments)
        except Exception as error:
            if name not in self._optional:
                raise
            self._fail(name, now, error)
            return None

    def _each(self, now: float, act: str, *arguments) -> Iterator[tuple[str, object]]:
        """Ask all, and yield the names and answers of those that have one."""
        for name, watcher in list(self._watchers.items()):
            if watcher.goes_by_wall and act in ("events", "values") and not self._run.is_reviewed:
                continue
            if (answer := self._ask(name, now, act, *arguments)) is not None:
                yield name, answer

    def _all(self, act: str, *arguments) -> None:
        for _ in self._each(0.0, act, *arguments):
            pass

    def get(self, name: str) -> Watcher | None:
        """Return a watcher; None where the run has none of this name."""
        return self._watchers.get(name)

    def __iter__(self) -> Iterator[Watcher]:
        return iter(self._watchers.values())

    def replace(self, name: str, watcher: Watcher) -> None:
        """Let another one go on in place of the one of its name, which has ended."""
        self._add(name, watcher)

    def complete(self) -> dict[str, object]:
        """Add the watchers whose resources have appeared since the start; return these by their names."""
        found = resources(self._scene, self._run) if self._absent else {}
        for name, resource in found.items():
            del self._absent[name]
            self._add(name, resource)
            self.memory.remind(name, self._watchers[name])
        return found

    def absent(self, now: float) -> list[Event]:
        """Return an event for each that the scene asks for and whose resource is not there."""
        return [event._replace(time=now) for event in self._absent.values()]

    def begin(self) -> None:
        """Let all get ready."""
        self._all("begin")

    def hear(self, channel: str, time: float, value, standard_error: float = math.nan) -> list[Record]:
        """Pass a measurement on and return what sinks are to keep: a clearance itself, and what the watchers make of it."""
        own = [MeasuredClearance(time, value, standard_error)] if channel == MEASURED_CLEARANCE else []
        return own + [record for _, records in self._each(time, "hear", channel, time, value, standard_error) for record in records]

    def correct(self, block: np.ndarray, seconds: np.ndarray) -> None:
        """Let samples be changed before anybody sees or keeps them."""
        self._all("correct", block, seconds)

    def see(self, block: np.ndarray) -> list[Record]:
        """Pass samples on and return what sinks are to keep."""
        found: list[Record] = []
        for name, watcher in list(self._watchers.items()):
            if watcher.together > 1 and not self._run.is_reviewed:
                waiting = self._waiting.setdefault(name, [])
                waiting.append(block)
                if sum(map(len, waiting)) >= watcher.together:
                    found += self._show(name, joined(self._waiting.pop(name)))
            else:
                found += self._show(name, block)
        return found

    def _show(self, name: str, block: np.ndarray) -> Sequence[Record]:
        return self._ask(name, float(block["time"][-1]), "see", block) or ()

    def flush(self) -> list[Record]:
        """Show the samples that wait to be seen together, and return what sinks are to keep."""
        waiting, self._waiting = self._waiting, {}
        return [record for name, blocks in waiting.items() for record in self._show(name, joined(blocks))]

    def are_calm(self, block: np.ndarray) -> bool:
        """Return whether seeing a block at once says the same as seeing each of its samples."""
        return all(watcher.together > 1 or watcher.is_calm(block) for watcher in self)

    def events(self, now: float, told: bool = True) -> list[Event]:
        """Return the events that hold, those of watchers that have failed among them.

        Parameters
        ----------
        told : whether also those whose changes `see` returns.
        """
        replaced = {other for watcher in self for other in watcher.replaces}
        said = []
        for name, events in self._each(now, "events", now):
            if name in self._optional:
                said += [event._replace(kind=f"watcher.{name}") for event in events]
            elif name not in replaced and (told or not self._watchers[name].tells_changes):
                said += events
        return [*self._failed, *said]

    def values(self, now: float) -> dict[str, object]:
        """Return the numbers of all; the keys of those that the scene names begin with ``watcher`` and the name, so that one status shows them."""
        found: dict[str, object] = {}
        for name, values in self._each(now, "values", now):
            found |= {f"watcher {name}: {key}": value for key, value in values.items()} if name in self._optional else values
        return found

    @property
    def remarks(self) -> dict[str, str]:
        """What subjects of diagnostics say while there is no event of them, by subject."""
        return {kind.subject: self._watchers[name].remark for name, kind in BUILT_IN.items() if kind.subject and name in self._watchers}

    @property
    def unused(self) -> dict[str, str]:
        """Why subjects of diagnostics have nothing to say, because the run does without their watchers, by subject."""
        unused = {kind.subject: kind.otherwise for name, kind in BUILT_IN.items() if kind.subject and name not in self._watchers}
        return unused if self._optional else unused | {"watchers": "the scene names none"}

    def restart(self, why: str) -> None:
        """Let all begin again."""
        self._all("restart", why)

    def adjust(self, thresholds: Thresholds) -> None:
        """Let all use other thresholds."""
        self._all("adjust", thresholds)

    def follow(self, scene: Scene) -> None:
        """Let all know the setting that is computed."""
        self._all("follow", scene)

    @property
    def memory(self) -> Memory:
        """The one that remembers the bearing; one that remembers nothing where the run has none."""
        return next((watcher for watcher in self if isinstance(watcher, Memory)), Memory(self._scene))

    @property
    def exceedances(self) -> list[Exceedance]:
        """Limits of validity that the run has exceeded."""
        return [found for watcher in self for found in watcher.exceedances]

    @property
    def worst_samples(self) -> dict[str, np.void]:
        """The sample of each of them, by the law's name."""
        return {name: sample for watcher in self for name, sample in watcher.worst_samples.items()}

    def news(self, now: float) -> list[Event]:
        """Return what has happened since the last call."""
        return [event for _, events in self._each(now, "news", now) for event in events]

    def measured(self) -> list[tuple[str, tuple[float, ...]]]:
        """Return what they have measured themselves since the last call."""
        return [reading for _, readings in self._each(0.0, "measured") for reading in readings]

    def serve(self, service: str) -> tuple[bool, str]:
        """Return the answer of the one whose service it is: whether it was done, and what to say."""
        return next((answer for _, answer in self._each(0.0, "serve", service)), (False, SERVICES[service][1]))

    def close(self) -> None:
        """End all."""
        self._all("close")
