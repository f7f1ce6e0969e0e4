# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How compiled code is made, where its machine code is kept, and how it is called without looking at types each time.

``@kernel`` compiles a function; ``@fused`` does the same, and its callers absorb it.  A function may take others as arguments: each combination is a
version of its own.  What compiled code calls is compiled with the function that Python calls (`bearing_sim.numerics.linking`).

Machine code depends on the sources of everything that it calls.  The folder that keeps it is therefore named by a hash of every source that
compiled code comes from, by the machine's architecture and by the number of lanes of its vectors (`bearing_sim.numerics.vector_width`).
"""

import hashlib
import platform
from collections.abc import Callable, Sequence
from pathlib import Path

import numba

from bearing_sim.files.kept import cache_folder
from bearing_sim.numerics.linking import LinkingDispatcher
from bearing_sim.numerics.vector_width import LANES

_PACKAGE = Path(__file__).resolve().parents[1]
_SOURCES = ("numerics/*.py", "physics/*.py", "levels/**/*.py", "model/params.py", "model/sample.py")


def sources_hash(with_compiler: bool = True) -> str:
    """Return a hash of all sources that compiled code comes from, and of the compiler's version.

    Parameters
    ----------
    with_compiler : False: of the sources alone.
    """
    digest = hashlib.sha256(numba.__version__.encode() if with_compiler else b"")
    for pattern in _SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


CACHE_FOLDER = cache_folder() / "compiled" / f"{sources_hash()}_{platform.machine()}_{LANES}"


def _compiled(function, **options):
    # Compiled code allocates nothing: without reference counting (_nrt) a step takes a sixth less time.
    # No C code calls any function: without wrappers for it (no_cfunc_wrapper) compiling takes a tenth less time.
    # Fused multiply-add is the only liberty with arithmetic: the rest of fastmath would delete the checks for NaN.
    if numba.config.DISABLE_JIT:
        return function
    common = dict(nopython=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False, no_cfunc_wrapper=True)
    return LinkingDispatcher(function, CACHE_FOLDER, {**common, **options})


def kernel(function):
    """Compile a function, into its callers where the compiler finds that worth while."""
    return _compiled(function, forceinline=False)


def fused(function):
    """Compile a function into every compiled function that calls it, for laws that are computed for each roller in each step."""
    return _compiled(function, forceinline=True)


def prune_no_references() -> None:
    """Let numba compile without its search for superfluous counts of references, for all of the process.

    Compiled code of this package has no such counts, and the search takes an eighth of the time; other users of numba may need it.
    """
    numba.config.LLVM_REFPRUNE_PASS = 0


def is_cached(function: Callable, complete: bool = False) -> bool:
    """Return whether a function needs no compiling: some version of it is in the cache of this machine, or numba is switched off.

    Parameters
    ----------
    complete : whether no part of its arguments is None, as where an outer ring bends.
    """
    return not hasattr(function, "is_kept") or function.is_kept(complete)


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
