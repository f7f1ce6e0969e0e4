"""Exponential and logarithm that the compiler can vectorise.

The library calls of `math` stop vectorisation, and the vector library of other builds is not to be had here.
These two are branch-free, accurate to 1e-11 relative (exp, arguments within +-700) and 2e-11 absolute (log, positive
normal numbers), far more than any law that they serve, and run more than twice as fast in a loop over rollers.
"""

import math

import numba
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from bearing_sim.kernels.compilation import template

_ROUND = 6755399441055744.0  # 1.5 * 2^52: adding it rounds to an integer that stands in the low bits
_ROUND_BITS = 0x4338000000000000
_HALF_ROOT_BITS = 0x3FE6A09E667F3BCD  # 1/sqrt 2
_LN2_HIGH, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10


@intrinsic
def _bits(context, x):
    """Return the bits of a double as an integer."""
    return types.int64(types.float64), lambda context, builder, signature, args: builder.bitcast(args[0], ir.IntType(64))


@intrinsic
def _double(context, bits):
    """Return the double with these bits."""
    return types.float64(types.int64), lambda context, builder, signature, args: builder.bitcast(args[0], ir.DoubleType())


@template
def _vector_exponential(x):
    x = min(max(x, -700.0), 700.0)
    shifted = x * 1.4426950408889634 + _ROUND
    n = shifted - _ROUND
    r = x - n * _LN2_HIGH - n * _LN2_LOW
    p = 1.0 / 362880.0
    p = p * r + 1.0 / 40320.0
    p = p * r + 1.0 / 5040.0
    p = p * r + 1.0 / 720.0
    p = p * r + 1.0 / 120.0
    p = p * r + 1.0 / 24.0
    p = p * r + 1.0 / 6.0
    p = p * r + 0.5
    p = p * r + 1.0
    p = p * r + 1.0
    return _double(_bits(p) + (_bits(shifted) << 52))


@template
def _vector_logarithm(x):
    bits = _bits(x)
    exponent = (bits - _HALF_ROOT_BITS) >> 52
    mantissa = _double(bits - (exponent << 52))
    f = (mantissa - 1.0) / (mantissa + 1.0)
    g = f * f
    p = 2.0 / 11.0
    p = p * g + 2.0 / 9.0
    p = p * g + 2.0 / 7.0
    p = p * g + 2.0 / 5.0
    p = p * g + 2.0 / 3.0
    p = p * g + 2.0
    n = _double(exponent + _ROUND_BITS) - _ROUND
    return p * f + n * (_LN2_HIGH + _LN2_LOW)


# The debugger's mode (NUMBA_DISABLE_JIT=1) has no bits to look at.
exponential = math.exp if numba.config.DISABLE_JIT else _vector_exponential
logarithm = math.log if numba.config.DISABLE_JIT else _vector_logarithm
