# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Cage slip and rating life of high-speed cylindrical roller bearings, live or offline.

Start here: `load_scene` reads what to simulate, `settle` finds where it comes to rest, `run_sweep` does so at many points, `Simulation` advances it
in time, `to_pandas` and `to_xarray` turn its samples into tables.

===============  =====================================================================================================
room             purpose
===============  =====================================================================================================
``scene``        what a user writes: records with units and bounds, the loader, the catalogue, the bundled scenes
``numerics``     compiled helpers that know no bearing: linear algebra, integrators, compilation, lanes
``physics``      the laws, one file each: contact, traction, film, drag, cage, raceway, rating life
``model``        from a scene to numbers: parameters, oil, running clearance, the sample record and its tables
``levels``       the equations of motion at each level of fidelity: steady, slip, planar, spatial
``simulation``   the facade: `Simulation`, `Inputs`
``messages``     what topics and recordings carry: topics, events, the CDR layout of messages
``inputs``       everything that comes in: gate, profiles over time, logs, CSV import, the synthetic mission
``recording``    MCAP out and in: writer, writer process, reader, recovery, comparison, export
``monitoring``   thresholds, alarms, residual slip and its CUSUM, film ratio
``estimation``   bands of results by uncertain fields, and their calibration by measurements
``runtime``      running against a clock: wall time and sim time, solver thread, pacing, governor, health, sinks, replay
``view``         pictures in rerun
``sweep``        a scene at many points: tasks, journal, tables
``studies``      questions answered by many runs: bench, trade-off, uncertainty, calibration, design, the paper's results
``cli``          the command line ``bearing-sim``
``ros``          the ROS 2 node and player
``programs``     the installed programs
``extras``       packages that only some commands need, by the extra that installs them
===============  =====================================================================================================

``doc/architecture.md`` says which room may import which, and in which file to change what.
"""

from importlib import import_module

_EXPORTS = {
    "Scene": "scene.scene",
    "SceneError": "scene.errors",
    "load_scene": "scene.loader",
    "Simulation": "simulation",
    "Inputs": "simulation",
    "IntegrationError": "simulation",
    "settle": "studies.settle",
    "Settled": "studies.settle",
    "run_sweep": "sweep.grid",
    "to_pandas": "model.labelled",
    "to_xarray": "model.labelled",
}
__all__ = list(_EXPORTS)


def __getattr__(name):
    # Loaded at first use: the simulation brings its compiler with it, which a look at the version does not need.
    if name in _EXPORTS:
        return getattr(import_module(f"bearing_sim.{_EXPORTS[name]}"), name)
    raise AttributeError(f"module 'bearing_sim' has no attribute {name!r}")
