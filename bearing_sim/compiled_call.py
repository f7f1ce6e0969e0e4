# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Call compiled code without looking at its arguments' types each time.

At every call numba takes the types of all arguments, number by number through nested tuples, to choose among what it has compiled.  For the
parameters of a bearing that takes longer than a tick of a cheap level.  Where the types are the same at every call, one look is enough.
"""

from collections.abc import Callable, Sequence

from numba import typeof


def compiled_for(function: Callable, arguments: Sequence) -> Callable:
    """Return what numba has compiled a function to for arguments of such types; the function itself where it is not compiled for them.

    The result takes arguments of exactly these types, and does not check them.
    """
    versions = getattr(function, "overloads", None)
    if not versions:  # not compiled at all, as when numba is switched off
        return function
    version = versions.get(tuple(typeof(argument) for argument in arguments))
    return function if version is None else version.entry_point
