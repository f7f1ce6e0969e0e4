# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tables on disk, each under a hash of all that its numbers depend on; a file that cannot be read is as good as none."""

import hashlib
import io
import math
import os
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import platformdirs

from bearing_sim.kernels.compilation import sources_hash
from bearing_sim.levels.inputs import Drive
from bearing_sim.levels.slip import Model
from bearing_sim.levels.steady import new_work, solve_conditions
from bearing_sim.levels.steady_point import ANSWER
from bearing_sim.levels.steady_table import Table
from bearing_sim.params import lubricate, pack
from bearing_sim.rating_life import load_rating
from bearing_sim.scene import Scene
from bearing_sim.tables import grid
from bearing_sim.tables.grid import Quality, Span, assembled, build_table

FOLDER = Path(platformdirs.user_cache_dir("bearing_sim")) / "tables"
_LOAD_SHARE = 0.5  # of the dynamic load rating: what ISO/TS 16281 is for
_SPEED_SHARE = 1.2  # of the operating speed
_OILS = 9  # temperatures at which the oil goes into the hash


def span_of(scene: Scene, temperatures: tuple[float, float] | None = None) -> Span:
    """Return what the table of a scene spans.

    Parameters
    ----------
    scene : its block ``table`` says it, or leaves it to operating speed and load rating.
    temperatures : lowest and highest oil temperature [K], instead of the scene's.
    """
    wanted, bearing, limits = scene.table, scene.bearing, scene.input_limits
    roller = bearing.roller
    speed = wanted.maximum_speed or min(_SPEED_SHARE * abs(scene.operating.shaft_speed) or limits.maximum_speed, limits.maximum_speed)
    rating = load_rating(roller.count, roller.diameter, roller.length, bearing.diameter_ratio)
    low, high = temperatures or (wanted.minimum_temperature, wanted.maximum_temperature)
    reverse = limits.reverse_rotation or scene.operating.shaft_speed < 0.0
    return Span(float(speed), float(wanted.maximum_load or _LOAD_SHARE * rating), float(low), float(high), bool(reverse))


def table_hash(scene: Scene, span: Span) -> str:
    """Return a hash of what a table's numbers depend on: bearing, oil at the temperatures of the span, tolerance and this program."""
    params = pack(scene)
    digest = hashlib.sha256(sources_hash().encode() + Path(grid.__file__).read_bytes())
    oils = [lubricate(scene.lubricant, params, float(kelvin)) for kelvin in np.linspace(span.minimum_temperature, span.maximum_temperature, _OILS)]
    for number in _numbers((params.rollers, params.raceways, params.cage, params.growth, oils, span, scene.table.tolerance)):
        digest.update(number)
    return digest.hexdigest()[:24]


def _numbers(value) -> Iterable[bytes]:
    if isinstance(value, (tuple, list)):
        for item in value:
            yield from _numbers(item)
    else:
        yield np.asarray(value, float).tobytes()


def table_path(scene: Scene, span: Span) -> Path:
    """Return where the table of a scene is kept."""
    return FOLDER / f"{table_hash(scene, span)}.npz"


def read_table(path: Path) -> tuple[Table, Quality] | None:
    """Return a table from disk, or None where there is none, or none that is whole."""
    try:
        data = path.read_bytes()
        with np.load(io.BytesIO(data[:-32]), allow_pickle=False) as file:
            if hashlib.sha256(data[:-32]).digest() != data[-32:]:
                return None
            period, mirror = (float(number) for number in file["symmetry"])
            quality = Quality(*(kind(number) for kind, number in zip(Quality.__annotations__.values(), file["quality"].tolist())))
            knots = [np.ascontiguousarray(file[name], float) for name in ("speeds", "loads", "temperatures", "angles")]
            values = file["values"]
            if values.shape[1:] != (*map(len, knots), len(ANSWER)):
                return None
            return assembled(knots, period, mirror, values), quality
    except Exception:  # whatever a broken file makes its reader raise, the table is built anew
        return None


def write_table(path: Path, table: Table, quality: Quality) -> None:
    """Write a table; a reader finds the old file or the new one, never a part."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        speeds=table.speeds,
        loads=table.loads,
        temperatures=table.temperatures,
        angles=table.angles,
        symmetry=np.array([table.period, table.mirror]),
        values=np.ascontiguousarray(table.nodes[..., 0, :]),
        quality=np.array(quality, float),
    )
    data = buffer.getvalue()
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=path.stem, delete=False) as file:
        file.write(data + hashlib.sha256(data).digest())
    os.replace(file.name, path)


def cached_table(scene: Scene, temperatures: tuple[float, float] | None = None) -> tuple[Table, Quality] | None:
    """Return the table of a scene that is on disk, or None."""
    return read_table(table_path(scene, span_of(scene, temperatures)))


def obtain_table(
    scene: Scene,
    temperatures: tuple[float, float] | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda solved: None,
    rebuild: bool = False,
) -> tuple[Table, Quality]:
    """Return the table of a scene, from disk or built and kept there.

    Parameters
    ----------
    scene : its level does not matter.
    temperatures : as in `span_of`.
    workers : threads; as many as the machine has cores where absent.
    progress : called now and then with the number of operating points solved for.
    rebuild : whether to build it even if there is one.
    """
    span = span_of(scene, temperatures)
    path = table_path(scene, span)
    found = None if rebuild else read_table(path)
    if found is None:
        params = pack(scene)
        found = build_table(params, lambda kelvin: lubricate(scene.lubricant, params, kelvin), span, float(scene.table.tolerance), workers, progress)
        try:
            write_table(path, *found)
        except OSError:  # a table that cannot be kept is as good for this run
            pass
    return found


def holds(table: Table, shaft_speed: float, load: float, oil_temperature: float) -> bool:
    """Return whether a table answers for magnitudes of speed [rad/s] and load [N] and an oil temperature [K]."""
    if not len(table.speeds) or not math.isfinite(shaft_speed + load + oil_temperature):
        return False
    return (
        abs(shaft_speed) <= table.speeds[-1]
        and load <= table.loads[-1]
        and table.temperatures[0] <= oil_temperature <= table.temperatures[-1]
        and (shaft_speed >= 0.0 or not math.isnan(table.mirror) or table.nodes.shape[0] == 2)
    )


def solve_scene(scene: Scene, shaft_speed: float, load: float, oil_temperature: float, load_angle: float) -> np.ndarray:
    """Return the answer to one operating point of a scene's bearing, solved for; NaN where none was found, shape (len(ANSWER),).

    Parameters
    ----------
    scene : its level does not matter.
    shaft_speed, load, oil_temperature, load_angle : [rad/s, N, K, rad].
    """
    return solve_points(scene, np.array([[shaft_speed, load, oil_temperature, load_angle]], float))[0]


def solve_points(scene: Scene, conditions: np.ndarray) -> np.ndarray:
    """Return the answers to operating points of a scene's bearing, solved for; NaN where none was found, shape (n, len(ANSWER)).

    Parameters
    ----------
    scene : its level does not matter.
    conditions : shaft speed [rad/s], load [N], oil temperature [K] and direction of the load [rad] of each, shape (n, 4).
    """
    params, answers = pack(scene), np.empty((len(conditions), len(ANSWER)))
    work = new_work(params)
    for temperature in np.unique(conditions[:, 2]):
        same = np.flatnonzero(conditions[:, 2] == temperature)
        model = Model(params, lubricate(scene.lubricant, params, float(temperature)), Drive(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1e-2)
        found = np.empty((len(same), len(ANSWER)))
        solve_conditions(np.ascontiguousarray(conditions[same][:, [0, 1, 3]], float), model, work, found)
        answers[same] = found
    return answers
