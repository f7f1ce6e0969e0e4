# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# What type checkers see instead of the names that __init__.py loads at first use.
from bearing_sim.model.labelled import to_pandas as to_pandas
from bearing_sim.model.labelled import to_xarray as to_xarray
from bearing_sim.scene.errors import SceneError as SceneError
from bearing_sim.scene.loader import load_scene as load_scene
from bearing_sim.scene.scene import Scene as Scene
from bearing_sim.simulation import Inputs as Inputs
from bearing_sim.simulation import IntegrationError as IntegrationError
from bearing_sim.simulation import Simulation as Simulation
from bearing_sim.studies.settle import Settled as Settled
from bearing_sim.studies.settle import settle as settle
from bearing_sim.sweep.grid import run_sweep as run_sweep
