# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How compiled code is made: two decorators and where their machine code is cached.

``@kernel`` is a leaf law or a concrete entry point.  ``@template`` takes kernels as leading positional
arguments, is small and never recursive; binding it inside a one-line kernel gives a full specialisation
that the on-disk cache can serve to the next process.  A kernel handed over at run time never could.

numba's own cache looks only at the file of the function that it compiles, so a changed law in another file
would be served stale.  The cache folder is therefore named by a hash of every source that compiled code
comes from.
"""

import hashlib
from pathlib import Path

import numba
import platformdirs

_PACKAGE = Path(__file__).resolve().parents[1]
_SOURCES = ("kernels/*.py", "integrators/*.py", "levels/*.py", "params.py", "rating_life.py", "sample.py")


def sources_hash() -> str:
    """Return a hash of all sources that compiled code comes from, and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for pattern in _SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


CACHE_FOLDER = Path(platformdirs.user_cache_dir("bearing_sim")) / "compiled" / sources_hash()


def _compiled(function, **options):
    # Compiled code here allocates nothing: without reference counting (_nrt) a step takes a sixth less time.
    # Fused multiply-add is the one liberty with arithmetic: the rest of fastmath would delete the checks for NaN.
    # numba reads the folder when it decorates: set it just here, so that other users of numba keep theirs.
    theirs = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(CACHE_FOLDER)
    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False, **options)(function)
    finally:
        numba.config.CACHE_DIR = theirs


def kernel(function):
    """Compile a law, or an entry point with all its laws bound."""
    return _compiled(function)


def template(function):
    """Compile a function whose leading arguments are kernels, or that wants to know constant arguments; it is inlined where it is called."""
    return _compiled(function, inline="always")
