# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The command line ``bearing-sim``; each command lives in its own module."""

import click

from bearing_sim.commands.lazy_group import LazyGroup

_COMMANDS = {
    "run": "Run a scene under its constant conditions.",
    "replay": "Run the model on a recorded log of shaft speed and radial load.",
    "import-csv": "Turn a measured table into an MCAP log.",
    "loads": "Show how a scene's load spreads over rollers and slices, and the lives.",
    "machine": "Compute the raceway that pre-deformation machining makes.",
    "table": "Build or look into the table of operating points of level steady.",
    "uncertainty": "Tell what slip and life may be where nobody knows some fields, and which it comes from.",
    "calibrate": "Fit fields of a scene to the measured cage speed of a recording.",
    "sweep": "Run a scene at all combinations of values of its fields, as a table.",
    "plot": "Draw the table of a sweep.",
    "design": "Map which outer raceways keep slip and life within limits.",
    "report": "Make one HTML page of a study.",
    "trade": "Measure what speed costs in accuracy on a scene, and recommend a setting.",
    "bench": "Measure how fast the model is, and what recordings, views and many bearings cost.",
    "compile": "Compile levels ahead of their first run.",
    "study": "Study the model itself, and the results of Deng 2017.",
    "info": "Say what a recording holds, where it comes from and whether it is whole.",
    "compare": "Compare two recordings topic by topic.",
    "recover": "Complete the recording of a killed writer.",
    "to-csv": "Write a recording as a CSV table.",
    "to-parquet": "Write a recording as a Parquet table.",
    "view": "Show a recording in rerun.",
    "mission": "Write the bundled synthetic mission as an MCAP log.",
    "scenes": "List the bundled scenes, bearings and oils.",
}


@click.group(
    cls=LazyGroup, told=_COMMANDS, within="bearing_sim.commands.", heading="Commands", context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(package_name="bearing_sim")
def main():
    """Cage slip and rating life of high-speed roller bearings with lobed raceways."""


if __name__ == "__main__":
    main()
