# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# The public names, each with its module: type checkers read them here, and __init__.py does when it looks one up.
from bearing_sim.model.labelled import to_pandas as to_pandas
from bearing_sim.model.labelled import to_xarray as to_xarray
from bearing_sim.model.sample import OBSERVABLES as OBSERVABLES
from bearing_sim.recording.bag import PartialRecording as PartialRecording
from bearing_sim.recording.bag import RecordingError as RecordingError
from bearing_sim.recording.reader import Recording as Recording
from bearing_sim.scene.errors import SceneError as SceneError
from bearing_sim.scene.fidelity import Level as Level
from bearing_sim.scene.loader import load_scene as load_scene
from bearing_sim.scene.loader import scene_fields as scene_fields
from bearing_sim.scene.scene import Scene as Scene
from bearing_sim.simulation import Inputs as Inputs
from bearing_sim.simulation import IntegrationError as IntegrationError
from bearing_sim.simulation import Simulation as Simulation
from bearing_sim.studies.settle import Settled as Settled
from bearing_sim.studies.settle import settle as settle
from bearing_sim.studies.uncertainty_propagation import UncertaintyError as UncertaintyError
from bearing_sim.sweep.grid import FieldError as FieldError
from bearing_sim.sweep.grid import run_sweep as run_sweep
from bearing_sim.sweep.table import Table as Table
