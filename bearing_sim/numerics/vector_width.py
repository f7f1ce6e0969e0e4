# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How many rollers one vector instruction of this machine computes.

Results differ between widths in their last digits, because sums over rollers add in a different order.
"""

import os

from numba import config
from numba.core.codegen import get_host_cpu_features

VARIABLE = "BEARING_SIM_LANES"  # environment variable that replaces the width of this machine
_WIDTHS = 1, 2, 4, 8


def lanes_for(features: str) -> int:
    """Return how many doubles a vector register holds, for which code with so many lanes is compiled.

    Registers of 512 bits (AVX-512) get four lanes, too: eight gave no gain there.  Machines without AVX, and all of arm64 (NEON), have
    registers of 128 bits; a scalable register (SVE) is used as one of these.

    Parameters
    ----------
    features : of the processor, in LLVM's notation, such as ``+avx,-avx512f``.
    """
    return 4 if "+avx" in features.split(",") else 2


def _lanes() -> int:
    if wanted := os.environ.get(VARIABLE):
        if wanted not in map(str, _WIDTHS):
            raise ValueError(f"{VARIABLE}={wanted}: expected {', '.join(map(str, _WIDTHS[:-1]))} or {_WIDTHS[-1]} rollers per vector")
        return int(wanted)
    # Numba compiles for the features that its own variable names, else for those of the machine.
    return lanes_for(get_host_cpu_features() if config.CPU_FEATURES is None else config.CPU_FEATURES)


LANES = _lanes()
