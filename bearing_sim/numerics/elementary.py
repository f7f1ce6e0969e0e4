# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Exponential, logarithm, ninth root, sine and cosine of numbers and of SIMD vectors.

The functions of `math` take one number at a time.  These are free of branches and accurate to 1e-11 relative (exp,
arguments within +-700; ninth root, positive normal numbers), 2e-11 absolute (log, the same) and 1e-15 (sine and cosine), far more
than any law needs.  Each takes a number or a vector of `bearing_sim.numerics.simd`.
"""

import math

import numba
import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import bits, double, floor, larger, smaller

_ROUND = 6755399441055744.0  # 1.5 * 2^52: adding it rounds to an integer that stands in the low bits
_ROUND_BITS = 0x4338000000000000
_ONE_BITS = 0x3FF0000000000000
_TO_ROOT = _ONE_BITS - 0x3FE6A09E667F3BCD  # from 1/sqrt 2 to 1
_LN2_HIGH, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10
_S = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in range(10))  # Taylor series, exact to rounding within a quarter turn
_C = tuple((-1.0) ** k / math.factorial(2 * k) for k in range(11))
_ROOT_BITS = _ROUND * (10.0 / 9.0) + ((10.0 / 9.0) * 1023 - 0.0584) * 2.0**32
_P = (1.22126583, -0.3775729, 0.20234812, -0.04606227)  # w^(-1/9) to 2e-5 over that range


@kernel
def _vector_exponential(x):
    x = smaller(larger(x, -700.0), 700.0)
    shifted = x * 1.4426950408889634 + _ROUND
    n = shifted - _ROUND
    r = x - n * _LN2_HIGH - n * _LN2_LOW
    p = r * (1.0 / 362880.0) + 1.0 / 40320.0
    p = p * r + 1.0 / 5040.0
    p = p * r + 1.0 / 720.0
    p = p * r + 1.0 / 120.0
    p = p * r + 1.0 / 24.0
    p = p * r + 1.0 / 6.0
    p = p * r + 0.5
    p = p * r + 1.0
    p = p * r + 1.0
    return double(bits(p) + (bits(shifted) << 52))


@kernel
def _vector_logarithm(x):
    pattern = bits(x)
    exponent = (pattern + _TO_ROOT) >> 52  # biased: never negative
    mantissa = double(pattern + _ONE_BITS - (exponent << 52))
    f = (mantissa - 1.0) / (mantissa + 1.0)
    g = f * f
    p = g * (2.0 / 11.0) + 2.0 / 9.0
    p = p * g + 2.0 / 7.0
    p = p * g + 2.0 / 5.0
    p = p * g + 2.0 / 3.0
    p = p * g + 2.0
    n = double(exponent + _ROUND_BITS) - (_ROUND + 1023.0)
    return p * f + n * (_LN2_HIGH + _LN2_LOW)


@kernel
def _vector_ninth_root(x):
    # A constant less a ninth of the bits of x is roughly the bits of z = x^(-1/9): x z^9 lies between 0.737 and 1.262.
    counted = double((bits(x) >> 20) + _ROUND_BITS)
    z = double(bits(_ROOT_BITS - counted * (1.0 / 9.0)) << 20)
    z_2 = z * z
    z_4 = z_2 * z_2
    w = x * z * (z_4 * z_4)
    p = w * _P[3] + _P[2]
    p = p * w + _P[1]
    p = p * w + _P[0]
    z = z * p
    z_2 = z * z
    z_4 = z_2 * z_2
    y = x * (z_4 * z_4)  # x^(1/9) (1 - e)^(8/9): Newton's step and the next term of the series remove the error
    e = 1.0 - y * z
    p = e * (68.0 / 81.0) + 8.0 / 9.0
    return y + y * (p * e)


@kernel
def cosine_sine(turn):
    """Return cosine and sine of an angle given in turns, from 0 to 1 (lanes)."""
    half = floor(2.0 * turn + 0.5)
    sign = 1.0 - 2.0 * half * (2.0 - half)
    x = (turn - 0.5 * half) * (2.0 * math.pi)
    g = x * x
    s = g * _S[9] + _S[8]
    s = s * g + _S[7]
    s = s * g + _S[6]
    s = s * g + _S[5]
    s = s * g + _S[4]
    s = s * g + _S[3]
    s = s * g + _S[2]
    s = s * g + _S[1]
    c = g * _C[10] + _C[9]
    c = c * g + _C[8]
    c = c * g + _C[7]
    c = c * g + _C[6]
    c = c * g + _C[5]
    c = c * g + _C[4]
    c = c * g + _C[3]
    c = c * g + _C[2]
    c = c * g + _C[1]
    return sign * (c * g + 1.0), sign * (x * (s * g + 1.0))


# Without compilation (NUMBA_DISABLE_JIT=1) the bits of a number are not at hand.
exponential = np.exp if numba.config.DISABLE_JIT else _vector_exponential
logarithm = np.log if numba.config.DISABLE_JIT else _vector_logarithm
ninth_root = (lambda x: x ** (1.0 / 9.0)) if numba.config.DISABLE_JIT else _vector_ninth_root


@kernel
def power(x, exponent):
    """Return x to a power, for positive x, accurate to 2e-11 times the exponent; without the call that the power of `math` takes."""
    return exponential(exponent * logarithm(x))
