# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Cage slip and rating life of high-speed cylindrical roller bearings, live or offline.

Start here: `load_scene` reads what to simulate, `settle` finds where it comes to rest, `run_sweep` does so at many points, `Simulation` advances it
in time, `Recording` reads what a run has recorded, `to_pandas` and `to_xarray` turn samples into tables.  `scene_fields` and `OBSERVABLES` list
what a scene has and what a sample holds.

===============  =====================================================================================================
room             purpose
===============  =====================================================================================================
``files``        files of users and the machine: outputs, limits of inputs, kept files, cores
``scene``        what a user writes: records with units and bounds, the loader, the catalogue, the bundled scenes
``numerics``     compiled helpers that know no bearing: linear algebra, integrators, compilation, lanes
``physics``      the laws, one file each: contact, traction, film, drag, cage, raceway, rating life
``model``        from a scene to numbers: parameters, oil, running clearance, the sample record and its tables
``levels``       the equations of motion at each level of fidelity: steady, slip, planar, spatial
``simulation``   the facade: `Simulation`, `Inputs`
``messages``     what topics and recordings carry: topics, events, the CDR layout of messages
``inputs``       everything that comes in: gate, profiles over time, logs, CSV import, the synthetic mission
``recording``    MCAP out and in: writer, recorder, reader, recovery, comparison, export
``watchers``     what watches a run: monitoring, estimation of bands and fields, vibration, the stored state of a bearing
``runtime``      running against a clock: wall time and sim time, solver thread, pacing, governor, health, sinks, replay
``view``         pictures in rerun
``sweep``        a scene at many points: tasks, journal, tables
``studies``      questions answered by many runs: bench, fleet, trade-off, uncertainty, calibration, design, extremes
``cli``          the command line ``bearing-sim``
``ros``          the ROS 2 node and player
===============  =====================================================================================================

``doc/architecture.md`` says which room may import which, and in which file to change what.
"""

import re
from importlib import import_module
from pathlib import Path

# The stub that type checkers read says which name is in which module.
_EXPORTS = {name: module for module, name in re.findall(r"^from (\S+) import (\w+)", Path(__file__).with_suffix(".pyi").read_text(), re.MULTILINE)}
__all__ = list(_EXPORTS)


def __getattr__(name):
    # Loaded at first use: the simulation brings its compiler with it, which a look at the version does not need.
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'bearing_sim' has no attribute {name!r}")
