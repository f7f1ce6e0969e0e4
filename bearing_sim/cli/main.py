# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The command line ``bearing-sim``: its commands and groups.  A command's module is imported only when the command is called."""

import importlib
import warnings
from collections.abc import Mapping
from typing import NamedTuple

import click

from bearing_sim.cli.reporting import ARGUMENTS, EXIT_CODES, UsageError, as_ending, require_whole
from bearing_sim.files.extras import what_is_missing
from bearing_sim.files.standard_streams import standard_streams
from bearing_sim.files.tally import PartlyUsedWarning


class Entry(NamedTuple):
    """A command in a group: where it is, as ``module:function`` below `bearing_sim.cli`, and what it does in one line."""

    place: str
    help: str


def _listed(table: str) -> dict[str, Entry]:
    """Return the commands of a table: name, place and help of one on a line."""
    rows = (line.split(maxsplit=2) for line in table.strip().splitlines())
    return {name: Entry(place, text) for name, place, text in rows}


_BENCHMARKS = _listed("""
fleet  bench:fleet  How many bearings one core holds in real time.
""")
_STUDIES = _listed("""
damage        study:damage           Compare the damage of a measured run between levels.
clearance     study:clearance        Running clearance over speed and load, thermal runaway, and what is lost at which speed.
housing       study:housing          What the housing does when the outer ring bends: slip, life and seat over play, and the largest play.
friction      study:friction         Friction of a scene against makers' models.
cold-oil      study:cold_oil         Slip and skid load over load, temperature and supply of oil, from rolling and from a skid.
cold-start    study:cold_start       A cold start over time: slip, films, temperatures and sliding power while idling and as the load comes.
extremes      study:extremes         Which variants of a scene, at its extremes, finish, are step-limited, are refused or fail.
""")
_STATES = _listed("""
show    state:show    Show the stored state of a bearing: life used, hours, starts, regimes.
export  state:export  Write a stored state as JSON, or its totals by day as a table.
merge   state:merge   Fill gaps of a stored state by recordings, each instant once.
adopt   state:adopt   Let a stored state belong to a corrected scene.
""")
_COMMANDS = _listed("""
run           run:run                  Run a scene under constant conditions.
replay        replay:replay            Run the model on a recorded log of shaft speed and radial load.
replay-fleet  fleet:replay_fleet       Run the model on many logs at once, one bearing each, into a table.
spectrum      spectrum:spectrum        Compute the life under a load spectrum: a table of shares of time, or a long log in classes.
import-csv    logs:import_csv          Convert a measured table to an MCAP log.
loads         bearings:loads           Show a scene's load distribution over rollers and slices, and the lives.
catalog       bearings:catalog         List the bearings of the catalogue, or show one by its designation.
new           bearings:new             Write the scene of a bearing by designation in an oil, commented.
machine       bearings:machine         Compute the raceway that pre-deformation machining produces.
table         table:table              Build or inspect the table of operating points of level steady.
uncertainty   uncertainty:uncertainty  Compute ranges of slip and life from uncertain fields, and each field's share.
calibrate     calibrate:calibrate      Fit fields of a scene to the measured cage speed in a recording.
vibration     vibration:vibration      Find cage speed and damage in the vibration that an accelerometer recorded.
sweep         sweep:sweep              Run a scene at all combinations of field values, into a table.
plot          plot:plot                Draw recorded runs over time or load, or the table of a sweep.
design        design:design            Map which outer raceways keep slip and life within limits, and verify them.
report        plot:report              Make one HTML page of a sweep, a design or a recorded run.
trade         trade:trade              Measure speed against accuracy on a scene, and recommend a setting.
bench         main:bench               Measure how fast the model is on this machine.
compile       bench:compile_levels     Compile levels before their first run.
study         main:study               Study a bearing: damage, clearance, housing, friction, cold oil, cold start, extremes.
info          recordings:info          Show what a recording holds, where it comes from, and whether it is complete.
compare       recordings:compare       Compare two recordings topic by topic.
recover       recordings:recover       Recover the recording of a killed writer.
to-csv        recordings:to_csv        Export a recording as a CSV table.
to-parquet    recordings:to_parquet    Export a recording as a Parquet table.
state         main:state               Show, export and fill the stored states of bearings in service.
view          view:view                Show a recording in rerun.
mission       logs:mission             Write the bundled synthetic mission as an MCAP log.
fields        bearings:fields          Show the fields of a scene: unit, range, default and meaning.
observables   bearings:observables     List what a sample holds: name, unit and meaning.
scenes        bearings:scenes          List the bundled scenes, bearings and oils.
""")


# Where commands went that judged the code rather than a bearing, or that a script does as well: what to run instead.
_CHECKOUT = "from a checkout of the repository: "
_MOVED = {
    "study deng2017": f"{_CHECKOUT}python examples/deng2017 -o deng2017",
    "study situations": f"{_CHECKOUT}python examples/situations --out pictures",
    **{f"study {name}": f"{_CHECKOUT}python test/validation {name}" for name in ("slices", "scenes", "findings", "catalog", "estimator", "nightly")},
    **{f"study {name}": f"{_CHECKOUT}python examples/{name} SCENE" for name in ("misalignment", "resonances")},
    "study support": f"{_CHECKOUT}python examples/response_over_speed SCENE",
    "bench levels": f"bearing-sim trade SCENE measures speed and errors of a bearing; {_CHECKOUT}python test/benchmarks/level_speed.py",
}


class LazyGroup(click.Group):
    """A group that imports its commands when they are called, so that ``--help`` stays fast (click's lazy-group pattern).

    Parameters
    ----------
    entries : the commands by name, in the order in which they are listed.
    heading : of the list of commands.
    """

    def __init__(self, *args, entries: Mapping[str, Entry], heading: str, **options):
        super().__init__(*args, **options)
        self._entries, self._heading = entries, heading

    @standard_streams()
    def main(self, *args, **extra):
        """Run a command line; what becomes of it does not depend on whether somebody reads what it prints."""
        return super().main(*args, **extra)

    def make_context(self, info_name, args, parent=None, **extra):
        """Return the context of a call, which keeps the arguments as they were written, so that results can name their command."""
        context = super().make_context(info_name, [*args], parent, **extra)
        context.meta.setdefault(ARGUMENTS, list(args))
        return context

    def invoke(self, context):
        """Run a command, and end with its own exit code if it used only a part of what was there.

        A package that is not installed is named with the extra that installs it, a file that cannot be read with the reason.
        """
        try:
            with warnings.catch_warnings(), as_ending():
                warnings.simplefilter("ignore", PartlyUsedWarning)  # the exit code and the last message say it
                result = super().invoke(context)
        except ModuleNotFoundError as error:
            raise UsageError(what_is_missing(error)) from error
        require_whole(context)
        return result

    def list_commands(self, context):
        """Return the names in order."""
        return list(self._entries)

    def get_command(self, context, name):
        """Return a command by name; None if there is none."""
        if name not in self._entries:
            if instead := _MOVED.get(f"{self.name} {name}"):
                raise UsageError(f"{self.name} {name} is no longer part of the program; {instead}")
            return None
        module, _, function = self._entries[name].place.partition(":")
        return getattr(importlib.import_module(f"bearing_sim.cli.{module}"), function)

    def resolve_command(self, context, args):
        """Return the command that is called; an unknown one is refused with the nearest name."""
        if self.get_command(context, args[0]) is None:
            from bearing_sim.scene.errors import did_you_mean

            raise UsageError(f"no command {args[0]!r}{did_you_mean(args[0], self._entries)}; see {context.command_path} --help")
        return super().resolve_command(context, args)

    def format_commands(self, context, formatter):
        """Write the list of commands without importing any."""
        with formatter.section(self._heading):
            formatter.write_dl([(name, entry.help) for name, entry in self._entries.items()])


_CODES = "Exit codes: " + "; ".join(f"{code}: {meaning}" for code, meaning in EXIT_CODES.items()) + "."


@click.group(cls=LazyGroup, entries=_COMMANDS, heading="Commands", epilog=_CODES, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="bearing_sim")
def main():
    """Cage slip and rating life of high-speed roller bearings with lobed raceways."""


@click.group("bench", cls=LazyGroup, entries=_BENCHMARKS, heading="Benchmarks")
def bench():
    """Measure how fast the model is on this machine, and how many bearings it holds in real time."""


@click.group("study", cls=LazyGroup, entries=_STUDIES, heading="Studies")
def study():
    """Run a study of a bearing."""


@click.group("state", cls=LazyGroup, entries=_STATES, heading="Commands")
def state():
    """What is remembered of bearings in service: life used, hours, starts, what was learned (parameter serial of the node)."""
