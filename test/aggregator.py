# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What diagnostic_aggregator makes of /diagnostics, by its published rules (ros/diagnostics, branch ros2-jazzy, README and class documents).

The rules used here, in the words of those documents or close to them:

- A status is known by its name alone: the newest status of a name is the item.
- An item that is not updated within the ``timeout`` of its analyzer (5 s unless set) is stale; with ``discard_stale`` it is forgotten.
- An analyzer has the level of the highest of its items.  One stale item among others makes it an error; if all are stale it is stale, or OK
  with ``discard_stale``.  An analyzer without items counts as one whose items are all stale.
- ``num_items`` is the number of items that an analyzer expects; any other number is an error.
- A group has the highest level of its analyzers, and is an error if some of them, but not all, are stale.
- Items that no analyzer wants appear under "Other", where stale items are forgotten.
- In the paths of items, slashes of their names become blanks.
"""

import re
from dataclasses import dataclass

OK, WARN, ERROR, STALE = range(4)
_TIMEOUT = 5.0  # [s]


@dataclass
class Item:
    """The newest status of a name."""

    level: int
    message: str
    at: float  # [s] when it came


class GenericAnalyzer:
    """Items whose names fit any of ``startswith``, ``contains``, ``name``, ``expected`` and ``regex``."""

    def __init__(self, path, timeout=_TIMEOUT, num_items=-1, discard_stale=False, **wanted):
        self.path, self._timeout, self._count, self._discards = path, timeout, num_items, discard_stale and timeout > 0.0
        self._wanted = {key: [values] if isinstance(values, str) else values for key, values in wanted.items()}
        assert wanted.keys() <= {"startswith", "contains", "name", "expected", "regex"}, wanted
        self._items: dict[str, Item] = {name: Item(STALE, "Missing", 0.0) for name in self._wanted.get("expected", ())}

    def wants(self, name):
        fits = {
            "startswith": name.startswith,
            "contains": name.__contains__,
            "name": name.__eq__,
            "expected": name.__eq__,
            "regex": lambda pattern: re.fullmatch(pattern, name),
        }
        return any(fits[key](value) for key, values in self._wanted.items() for value in values)

    def receive(self, name, item):
        self._items[name] = item

    def report(self, now):
        """Return levels by path, that of the analyzer first."""
        is_stale = {name: item.level == STALE or 0.0 < self._timeout < now - item.at for name, item in self._items.items()}
        if self._discards:
            self._items = {name: item for name, item in self._items.items() if now - item.at <= self._timeout}
        levels = {name: STALE if is_stale[name] else item.level for name, item in self._items.items()}
        if all(level == STALE for level in levels.values()):
            own = OK if self._discards else STALE
        else:
            own = ERROR if STALE in levels.values() else max(levels.values())
        if self._count == 0 and not self._items:
            own = OK
        elif self._count > 0 and len(self._items) != self._count:
            own = max(own, ERROR)
        return {self.path: own} | {f"{self.path}/{name.replace('/', ' ')}": level for name, level in levels.items()}


class AnalyzerGroup:
    """Analyzers, some of them groups again; ``settings`` as the YAML file has them below the group."""

    def __init__(self, path, settings):
        self.path, self._analyzers = path, []
        for values in settings.values():
            if not isinstance(values, dict) or "type" not in values:
                continue
            kind, name, own = values["type"], values["path"], {key: value for key, value in values.items() if key not in ("type", "path")}
            if kind == "diagnostic_aggregator/AnalyzerGroup":
                self._analyzers.append(AnalyzerGroup(f"{path}/{name}", own.get("analyzers", own)))
            else:
                assert kind == "diagnostic_aggregator/GenericAnalyzer", kind
                self._analyzers.append(GenericAnalyzer(f"{path}/{name}", **own))

    def wants(self, name):
        return any(analyzer.wants(name) for analyzer in self._analyzers)

    def receive(self, name, item):
        for analyzer in self._analyzers:
            if analyzer.wants(name):
                analyzer.receive(name, item)

    def report(self, now):
        """Return levels by path, that of the group first."""
        levels, heads = {}, []
        for analyzer in self._analyzers:
            found = analyzer.report(now)
            heads.append(found[analyzer.path])
            levels |= found
        if not heads:
            return {self.path: ERROR}
        mixed = STALE in heads and set(heads) != {STALE}
        return {self.path: ERROR if mixed else max(heads)} | levels


class Aggregator:
    """The whole: the analyzers of a file of parameters, and "Other".

    Parameters
    ----------
    parameters : what the YAML file has below ``ros__parameters``.
    """

    def __init__(self, parameters):
        self.path = f"/{parameters['path']}" if parameters.get("path") else ""
        self._group = AnalyzerGroup(self.path, parameters)
        self._other = GenericAnalyzer(f"{self.path}/Other", discard_stale=True)

    def receive(self, now, statuses):
        """Receive a diagnostic_msgs/DiagnosticArray at a time [s]: (name, level, message) of each status, in its order."""
        for name, level, message in statuses:
            receiver = self._group if self._group.wants(name) else self._other
            receiver.receive(name, Item(int(level), message, now))

    def report(self, now):
        """Return levels by path at a time [s], that of the whole first."""
        other = self._other.report(now)
        return self._group.report(now) | (other if len(other) > 1 else {})


def statuses_of(array):
    """Return (name, level, message) of the statuses of a message, or of the dict that it is made from."""
    if isinstance(array, dict):
        return [(status["name"], status["level"][0], status["message"]) for status in array["status"]]
    return [(status.name, status.level[0], status.message) for status in array.status]
