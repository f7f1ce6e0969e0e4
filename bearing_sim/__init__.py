# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Cage slip and rating life of high-speed roller bearings with lobed raceways.

=====================  ==================================================================================
module                 responsibility
=====================  ==================================================================================
``scene``              what to simulate: frozen records, one declaration per quantity
``scene_monitoring``   from where on a condition is told
``scene_uncertainty``  what nobody knows for sure: ranges of fields, fields by their paths
``crown``              profiles of the rollers
``contour``            forms of the outer raceway; ``contour_file``, ``contour_scene``: measured ones
``methods``            by which integrators each level can be advanced
``effects``            which levels have what a scene may ask for
``scene_bounds``       bounds that no single field has
``scene_file``         YAML, presets, overrides; every fault of a file at once
``quantity``           units at the door
``params``             what compiled code sees; `pack` is the only bridge from a scene
``simulation``         owns time and state; ``advance`` returns a block of samples
``sample``             the sample record: names, units and meanings of all observables
``levels``             one complete model per file
``tables``             tables of operating points of level ``steady``: refined until they are good, kept on disk
``kernels``            scalar laws: contact, traction, cage, drag, raceway, load balance, linear algebra
``integrators``        stiff and explicit methods and their drive loops; they know no bearings
``rating_life``        roller loads to rating life: whole rollers, slices, oil and reliability
``oil``                oil properties at a temperature
``film_ratio``         lambda ratio: oil film over roughness
``ring_growth``        how far rings grow by rotation, fits and heat
``sweep``              a scene at many points: tasks on all cores or a Dask cluster, a journal of them, tables, pictures
``runtime``            pacing, the solver's thread, the gate for inputs, health, alarms, residual slip
``sinks``              MCAP and rerun
``studies``            the bench: speed and error of every level and method; statics: the load distribution by slices;
                       extremes: the stability map; uncertainty and sensitivity: bands of slip and life, and which field they
                       come from; calibration: fields fitted to a measured cage speed
``events``             what happens besides samples: what a person should be told, and measurements of the cage
``topics``             the messages that samples and inputs become
``ros``                the ROS 2 node and player, and what the launch files share
``commands``, ``cli``  the command line
=====================  ==================================================================================
"""

from importlib import import_module

_EXPORTS = {"Scene": "scene", "load_scene": "scene_file", "SceneError": "scene_file", "Simulation": "simulation", "Inputs": "simulation"}
__all__ = list(_EXPORTS)


def __getattr__(name):
    # Loaded at first use: the simulation brings its compiler with it, which a look at the version does not need.
    if name in _EXPORTS:
        return getattr(import_module(f"bearing_sim.{_EXPORTS[name]}"), name)
    raise AttributeError(f"module 'bearing_sim' has no attribute {name!r}")
