# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Digests of what the program answers, to compare two versions: samples of many scenes at all levels, replays of logs, ``--json`` of commands.

``python test/benchmarks/answers.py inputs FOLDER`` writes scenes and logs once, by the version that is installed; ``... digest FOLDER OUT.json``
runs all of them by the version on PYTHONPATH, and ``... compare A.json B.json`` lists what differs.  A digest of samples covers every bit.
"""

import hashlib
import json
import re
import subprocess
import sys
from pathlib import Path

import click

LEVELS = ("steady", "slip", "planar", "spatial")
BUNDLED = ("deng2017_table1", "deng2017_table1_cold", "deng2017_table2", "nu215_rig", "nu232_wind_gearbox")
_SECONDS, _SAMPLES = 3e-3, 6
_NOT_COMPARED = re.compile(r"second|wall|cpu|time_factor|commit|hash|version|path|file|folder|megabytes|command|started|built|real")
_COMMANDS = {
    **{
        f"run {scene} {level}": ("run", scene, "--set", f"level={level}", "--duration", "0.02")
        for scene in BUNDLED[:3]
        for level in ("slip", "steady")
    },
    **{f"loads {scene}": ("loads", scene) for scene in BUNDLED},
    "catalog": ("catalog",),
    "catalog NU 210": ("catalog", "NU 210"),
    "machine": ("machine",),
    "fields": ("fields",),
    "scenes": ("scenes",),
    "sweep": ("sweep", "deng2017_table1", "--set", "level=steady", "--vary", "operating.radial_load=500N:2kN:4", "--workers", "1"),
    "uncertainty": ("uncertainty", "deng2017_table1", "--set", "level=steady", "--samples", "8", "--workers", "1"),
    "clearance": ("study", "clearance", "deng2017_table1_cold", "--speed", "15000rpm:30000rpm:2", "--load", "800N:800N:1"),
    "friction": ("study", "friction", "nu215_rig"),
}


def _mappings() -> list[dict]:
    """Return random scenes of catalogue bearings as mappings."""
    import random

    import random_scenes

    from bearing_sim.scene.designation import designations
    from bearing_sim.scene.loader import SceneError, scene_from_mapping

    generator, found = random.Random(47), []
    known = [each for each in designations() if each.boundary.bore <= 0.5 and not each.designation.is_full_complement]
    while len(found) < 60 - len(BUNDLED):
        mapping = random_scenes._draw(generator, generator.choice(known), "slip", False)
        try:
            scene_from_mapping(mapping, mapping["name"])
        except SceneError:
            continue
        found.append(mapping)
    return found


def _run(*words) -> str:
    done = subprocess.run([sys.executable, "-m", "bearing_sim.cli", *map(str, words)], capture_output=True, text=True)
    return done.stdout if done.returncode in (0, 3) else f"exit code {done.returncode}: {done.stderr[-300:]}"


def _without_costs(value):
    """Return a result without what differs from run to run."""
    if isinstance(value, dict):
        return {name: _without_costs(each) for name, each in value.items() if not _NOT_COMPARED.search(name)}
    return [_without_costs(each) for each in value] if isinstance(value, list) else value


def _answer(text: str):
    try:
        return _without_costs(json.loads(text))
    except ValueError:
        return text


@click.group()
def main():
    """Compare what two versions answer."""


@main.command()
@click.argument("folder", type=click.Path(path_type=Path))
def inputs(folder):
    """Write scenes and logs into FOLDER."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scenes.json").write_text(json.dumps(_mappings(), indent=1))
    for number, (scene, seconds) in enumerate(zip(BUNDLED, (20, 30, 10, 15, 25))):
        _run("mission", "-o", folder / f"log{number}.mcap", "--duration", str(seconds), "--cage", scene, "--force")


@main.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("out", type=click.Path(path_type=Path))
def digest(folder, out):
    """Run everything and write digests to OUT."""
    from bearing_sim import Simulation, load_scene
    from bearing_sim.scene.loader import scene_from_mapping

    answers = {}
    scenes = [(name, lambda level, name=name: load_scene(name, [f"level={level}"])) for name in BUNDLED]
    scenes += [
        (f"{k} {each['name']}", lambda level, each=each: scene_from_mapping(each | {"level": level}, each["name"]))
        for k, each in enumerate(json.loads((folder / "scenes.json").read_text()))
    ]
    for name, make in scenes:
        for level in LEVELS:
            try:
                block = Simulation(make(level)).advance(_SECONDS, samples=_SAMPLES)
                answers[f"{name} at {level}"] = [hashlib.sha256(block.tobytes()).hexdigest()[:16], float(block["cage_slip"][-1])]
            except Exception as error:  # what is refused is an answer, too
                answers[f"{name} at {level}"] = f"{type(error).__name__}: {error}"
        print(name, flush=True)
    for number, scene in enumerate(BUNDLED):
        words = ("replay", folder / f"log{number}.mcap", "--scene", scene, "--set", "level=slip" if number else "level=steady", "--json")
        answers[f"replay {number}"] = _answer(_run(*words))
    for name, words in _COMMANDS.items():
        answers[name] = _answer(_run(*words, "--json"))
        print(name, flush=True)
    out.write_text(json.dumps(answers, indent=1))


@main.command()
@click.argument("before", type=click.Path(path_type=Path))
@click.argument("after", type=click.Path(path_type=Path))
def compare(before, after):
    """List what differs between two files of digests."""
    old, new = (json.loads(path.read_text()) for path in (before, after))
    different = [name for name in old if old[name] != new.get(name)]
    for name in different:
        was, now = old[name], new.get(name)
        if isinstance(was, dict) and isinstance(now, dict):
            for key in was.keys() | now.keys():
                if was.get(key) != now.get(key):
                    print(f"{name}: {key}: {str(was.get(key))[:120]} -> {str(now.get(key))[:120]}")
        else:
            print(f"{name}: {str(was)[:200]} -> {str(now)[:200]}")
    print(f"{len(old) - len(different)} of {len(old)} answers are equal, {len(new.keys() - old.keys())} are new")


if __name__ == "__main__":
    main()
