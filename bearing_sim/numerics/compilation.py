# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How compiled code is made, where its machine code is cached, and how it is called without looking at types each time.

``@kernel`` compiles a law, or a concrete entry point with everything bound; ``@fused`` does the same, but its callers absorb it.
``@template`` compiles a function that takes kernels as its leading arguments; it is inlined where it is called and never recursive.  A
one-line kernel that binds a template is a full specialisation, which the on-disk cache can serve to the next process.  A kernel passed
as an argument at run time never could be.

Numba's own cache looks only at the file of the function that it compiles, so it would serve stale code after a change of a law in
another file.  The cache folder is therefore named by a hash of every source that compiled code comes from, by the machine's architecture and by
the number of lanes of its vectors (`bearing_sim.numerics.vector_width`).
"""

import hashlib
import platform
from collections.abc import Callable, Sequence
from pathlib import Path

import numba
import platformdirs

from bearing_sim.numerics.vector_width import LANES

_PACKAGE = Path(__file__).resolve().parents[1]
_SOURCES = ("numerics/*.py", "physics/*.py", "levels/**/*.py", "model/params.py", "model/sample.py")


def sources_hash() -> str:
    """Return a hash of all sources that compiled code comes from, and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for pattern in _SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


CACHE_FOLDER = Path(platformdirs.user_cache_dir("bearing_sim")) / "compiled" / f"{sources_hash()}_{platform.machine()}_{LANES}"


def _compiled(function, **options):
    # Compiled code allocates nothing: without reference counting (_nrt) a step takes a sixth less time.
    # No C code calls any function: without wrappers for it (no_cfunc_wrapper) compiling takes a tenth less time.
    # Fused multiply-add is the only liberty with arithmetic: the rest of fastmath would delete the checks for NaN.
    # Numba reads the cache folder when it decorates: set it for this moment only, so that other users of numba keep theirs.
    theirs = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(CACHE_FOLDER)
    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False, no_cfunc_wrapper=True, **options)(function)
    finally:
        numba.config.CACHE_DIR = theirs


def kernel(function):
    """Compile a law, or an entry point with all its laws bound."""
    return _compiled(function, forceinline=False)


def fused(function):
    """Compile a law into every compiled function that calls it.

    For laws that take the parameters of a bearing: a call copies them, hundreds of numbers, which took a third of the time of a step.
    Rarely called laws stay kernels, so that the code of a step fits the cache of a processor.
    """
    return _compiled(function, forceinline=True)


def template(function):
    """Compile a function that takes kernels or compile-time constants as arguments; it is inlined where it is called."""
    return _compiled(function, inline="always")


def prune_no_references() -> None:
    """Let numba compile without its search for superfluous counts of references, for all of the process.

    Compiled code of this package has no such counts, and the search takes an eighth of the time; other users of numba may need it.
    """
    numba.config.LLVM_REFPRUNE_PASS = 0


def is_cached(function: Callable) -> bool:
    """Return whether a function needs no compiling: some version of it is in the cache of this machine, or numba is switched off."""
    if not hasattr(function, "stats"):
        return True
    name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
    return any(Path(function.stats.cache_path).glob(f"{name}-*.nbi"))


def compiled_for(function: Callable, arguments: Sequence) -> Callable:
    """Return the compiled version of a function for arguments of such types; the function itself where there is none.

    At every call numba determines the types of all arguments, number by number through nested tuples.  For the parameters of a
    bearing this takes longer than a tick of level ``slip``.  The function returned takes arguments of exactly these types and does
    not check them.
    """
    versions = getattr(function, "overloads", None)
    if not versions:  # not compiled at all, as when numba is switched off
        return function
    version = versions.get(tuple(numba.typeof(argument) for argument in arguments))
    return function if version is None else version.entry_point
