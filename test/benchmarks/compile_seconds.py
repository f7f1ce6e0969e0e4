# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What compiling costs: seconds of a core by level and by function, and what is kept on the disk.

    python test/benchmarks/compile_seconds.py [LEVEL ...]

Each level is compiled in a process of its own with an empty cache.  Seconds of a function are without those of what it calls; those of one that
Python calls (``program``) contain the optimisation of all that it calls.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

LEVELS = ("slip", "planar", "spatial", "steady")
_SHOWN = 12  # of the functions of a level


def _measure(level: str) -> None:
    """Compile a level in this process and print what it took."""
    began = time.process_time()
    from bearing_sim import Simulation, load_scene
    from bearing_sim.numerics import linking

    imported, seconds, stack = time.process_time(), Counter(), []

    def timed(method, kind):
        def call(compiler, *arguments):
            start = time.process_time()
            stack.append(0.0)
            try:
                return method(compiler, *arguments)
            finally:
                took, inside = time.process_time() - start, stack.pop()
                seconds[f"{compiler.py_func.__module__.removeprefix('bearing_sim.')}.{compiler.py_func.__name__}{kind}"] += took - inside
                if stack:
                    stack[-1] += took

        return call

    linking._Compiler._compile_core = timed(linking._Compiler._compile_core, " (program)")
    linking._Compiler.translate = timed(linking._Compiler.translate, "")
    simulation = Simulation(load_scene("deng2017_table1", [f"level={level}"]))
    simulation.advance(1e-4, simulation.inputs, 1)
    total = time.process_time() - imported
    print(f"{level}: {total:.1f} s of a core, {len(seconds)} functions, after {imported - began:.1f} s of imports")
    for name, took in seconds.most_common(_SHOWN):
        print(f"    {took:6.2f} s  {name}")
    print(f"    {total - sum(took for _, took in seconds.most_common(_SHOWN)):6.2f} s  everything else")


def main(levels: list[str]) -> None:
    """Compile levels one after the other, each in a process of its own with an empty cache."""
    for level in levels or LEVELS:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, __file__, "--measure", level], env={**os.environ, "XDG_CACHE_HOME": folder}, check=True)
            files = [file for file in Path(folder).rglob("*") if file.is_file()]
            print(f"    kept: {len(files)} files, {1e-6 * sum(file.stat().st_size for file in files):.2f} MB", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        _measure(sys.argv[2])
    else:
        main(sys.argv[1:])
