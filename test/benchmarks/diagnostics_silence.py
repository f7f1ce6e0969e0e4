# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How long a status of /diagnostics is silent from the start of a node through its lifecycle: diagnostic_aggregator takes 5 s for a fault.

Run it with ``python test/benchmarks/diagnostics_silence.py``, with ``--cold`` on an empty cache, so that the node compiles its model first, and
with ``--bearings 20`` for several bearings in one node.
"""

import argparse
import signal
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from aggregator import OK, STALE, Aggregator, statuses_of  # noqa: E402
from lifecycle_msgs.msg import Transition  # noqa: E402
from lifecycle_msgs.srv import ChangeState  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402

ANALYZER = {"type": "diagnostic_aggregator/GenericAnalyzer", "path": "Bearings", "contains": ["bearing_node"]}
LIFE = ("configure", "activate", "deactivate", "activate", "deactivate", "cleanup", "configure", "cleanup", "unconfigured_shutdown")


class Listener(Client):
    """Measures the silence of every status."""

    def __init__(self, domain):
        self.aggregator, self._last = Aggregator({"path": "Plant", "bearings": ANALYZER}), {}
        self.longest, self.worst, self.has_been_stale = 0.0, OK, False
        super().__init__(domain)

    def _hear_diagnostics(self, report):
        super()._hear_diagnostics(report)
        now = time.monotonic()
        if self._last:
            self.has_been_stale |= STALE in self.aggregator.report(now).values()
        for name, _, _ in statuses_of(report):
            self.longest = max(self.longest, now - self._last.get(name, now))
            self._last[name] = now
        self.aggregator.receive(now, statuses_of(report))
        self.worst = max(self.worst, self.aggregator.report(now)["/Plant"])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cold", action="store_true", help="with an empty cache of compiled code")
    parser.add_argument("--bearings", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        domain, folder = fresh_domain(), Path(name)
        names = ", ".join(f"b{number}" for number in range(options.bearings))
        words = ["autostart:=false", "governor:=false", f"bearings:=[{names}]"]
        arguments = ["--ros-args", *(word for pair in words for word in ("-p", pair))]
        cache = {"XDG_CACHE_HOME": str(folder / "cache")} if options.cold else {}
        process, client = NodeProcess(folder, domain, *arguments, limit=900, from_scratch=True, **cache), Listener(domain)
        try:
            client.spin_until(lambda: client.received["diagnostics"], "the node reports", process, 100.0)
            for label in LIFE:
                ready = process.text.count("ready: listening") + options.bearings
                call = ChangeState.Request(transition=Transition(label=label.removeprefix("unconfigured_")))
                client.call(ChangeState, "change_state", call, process)
                if label == "activate":
                    client.spin_until(lambda ready=ready: process.text.count("ready: listening") >= ready, "ready", process, 800.0)
                client.spin(3.0)
            reports, longest = len(client.received["diagnostics"]), client.longest
            stale = "some were stale" if client.has_been_stale else "none was stale"
            print(
                f"{reports} reports of {options.bearings} bearings, longest silence of a status {longest:.2f} s, {stale}, worst level {client.worst}"
            )
        finally:
            client.close()
            process.end(signal.SIGKILL)


if __name__ == "__main__":
    main()
