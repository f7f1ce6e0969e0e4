# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Block arrows: many alike parts that touch a few bodies, as the rollers of a bearing its rings and cage; ``LANES`` parts at a time (a block).

All positions and speeds of the bodies are the *border*.  The state is y = (positions of the border, speeds of the border, a run of each state of
the parts: positions, their speeds, and speeds whose positions do not matter, such as a spin).  A part depends on its own states and on the border;
an acceleration of a body depends on the border, by itself and through each part.  Bodies meet only in the parts: through a part, an acceleration
depends on the positions and speeds of its own body and on the part's own states.

**Derivatives** through the parts are rows of an array of `bearing_sim.numerics.simd.new_rows`: first those of the accelerations of a part, each by
its own states, then body by body by positions and speeds; then those of the accelerations of the border, each by the part's own states and by
positions and speeds of its own body.

**Linear algebra.** (I - s J) x = b for the whole first-order state is reduced to speeds, because every position is x = b + s v: J becomes
s (d/dv + s d/dq).  What is left is a small block for each part and one for the border; the parts are eliminated one by one into the border's Schur
complement.  Cost O(Z).
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.linear_algebra import back_substitute, decompose
from bearing_sim.numerics.simd import (
    LANES,
    add,
    collect_runs,
    fill_lanes,
    load,
    magnitude,
    new_blocks,
    new_rows,
    spread_runs,
    store,
    total,
    where_positive,
)


class Layout(NamedTuple):
    """Where everything stands in the state and among the derivatives of a block arrow.  It is a constant to the compiler."""

    positions: int  # of a part
    speeds: int  # of a part; the first are those of its positions
    block: int  # states of a part
    border: int  # positions of the border, and as many speeds
    local: int  # what a part depends on
    rows: int  # of derivatives in all
    right: int  # rows of a factorisation: where the coupling of a part to the border begins
    below: int  # and that of the border to a part
    row: np.ndarray  # where the derivatives of each acceleration of the border begin, shape (border,), as all that follow
    column: np.ndarray  # of each of the border's positions among what a part depends on
    own_column: np.ndarray  # and among what an acceleration of the border depends on through a part
    size: np.ndarray  # positions of the body that it belongs to: its speed stands so many columns further on
    body: np.ndarray  # the body
    load_positions: Callable  # kernels for as many rows as a part has positions, see `_load_tuple` and `_products`
    add_positions: Callable
    load_speeds: Callable  # and as it has speeds
    load_shifted: Callable  # see `_shifted`
    add_products: Callable


@kernel
def _shifted(jacobian, block, position, speed, s):
    """Return s (d/d(speed) + s d/d(position)): what a speed does within an implicit step."""
    return s * (load(jacobian, block, speed) + s * load(jacobian, block, position))


def block_arrow(positions: int, speeds: int, bodies: tuple[int, ...]) -> Layout:
    """Return the layout of parts with so many positions and speeds that touch bodies with so many positions each."""
    block, border, sizes = positions + speeds, sum(bodies), np.array(bodies)
    before = np.cumsum(sizes) - sizes  # positions of the bodies before
    body = np.repeat(np.arange(len(bodies)), sizes)
    local, within = block + 2 * border, np.arange(border) - before[body]
    columns = block + 2 * sizes[body]  # of each acceleration of the border
    row = speeds * local + np.cumsum(columns) - columns
    right = speeds * speeds
    return Layout(
        positions,
        speeds,
        block,
        border,
        local,
        int(row[-1] + columns[-1]),
        right,
        right + speeds * border,
        row,
        block + 2 * before[body] + within,
        block + within,
        sizes[body],
        body,
        _load_tuple(positions),
        _products(positions),
        _load_tuple(speeds),
        _load_shifted(speeds),
        _products(speeds),
    )


@functools.cache
def _load_tuple(count: int) -> Callable:
    """Return a kernel that loads ``count`` rows of a block of an array, from ``first`` on with a ``step``, into a tuple of lanes."""
    last, before = count - 1, _load_tuple(count - 1) if count > 1 else None

    @kernel
    def load_one(array, block, first, step):
        return (load(array, block, first),)

    @kernel
    def load_more(array, block, first, step):
        return before(array, block, first, step) + (load(array, block, first + last * step),)

    return load_more if last else load_one


@functools.cache
def _load_shifted(count: int) -> Callable:
    """Return a kernel that loads what a speed does to ``count`` rows within an implicit step, as `_load_tuple`."""
    last, before = count - 1, _load_shifted(count - 1) if count > 1 else None

    @kernel
    def load_one(jacobian, block, position, speed, step, s):
        return (_shifted(jacobian, block, position, speed, s),)

    @kernel
    def load_more(jacobian, block, position, speed, step, s):
        end = last * step
        return before(jacobian, block, position, speed, step, s) + (_shifted(jacobian, block, position + end, speed + end, s),)

    return load_more if last else load_one


@functools.cache
def _products(count: int) -> Callable:
    """Return a kernel that sums the products of two tuples of ``count`` lanes, from the first to the last."""
    last, before = count - 1, _products(count - 1) if count > 1 else None

    @kernel
    def first_product(left, right):
        return left[0] * right[0]

    @kernel
    def products(left, right):
        return before(left, right) + left[last] * right[last]

    return products if last else first_product


class Factored(NamedTuple):
    """A factorisation of I - s J."""

    shift: np.ndarray  # s, shape (1,)
    rows: np.ndarray  # by part: inverse block, that times its coupling to the border's speeds, the border's to it
    right: np.ndarray  # right sides by part: positions and speeds
    positions: np.ndarray  # d(border accelerations)/d(border positions), all parts together, shape (border, border)
    schur: np.ndarray  # factors of the Schur complement, shape (border, border)
    order: np.ndarray  # its pivots, int64, shape (border,)
    block: np.ndarray  # scratch of one block, shape (1, speeds^2, LANES)
    sums: np.ndarray  # scratch, sums over blocks, see `_reduce`, shape (1, 2 border^2, LANES)


def new_factored(layout: Layout, count: int) -> Factored:
    """Return a zeroed factorisation for ``count`` parts."""
    square = (layout.border, layout.border)
    return Factored(
        np.zeros(1),
        new_rows(layout.below + layout.border * layout.speeds, count),
        new_rows(layout.block, count),
        np.zeros(square),
        np.zeros(square),
        np.zeros(layout.border, np.int64),
        new_blocks(1, layout.speeds * layout.speeds),
        new_blocks(1, 2 * layout.border * layout.border),
    )


@fused
def spread_state(layout, y, count, rows):
    """Copy the states of ``count`` parts from ``y`` into the first rows of their lanes."""
    spread_runs(y, 2 * layout.border, layout.block, count, rows)
    fill_lanes(rows, layout.block, count)


@fused
def collect_rates(layout, y, count, rows, rate):
    """Copy the parts' speeds, and their accelerations, which stand behind the states of `spread_state`, into ``rate``."""
    first = 2 * layout.border
    for j in range(layout.positions * count):
        rate[first + j] = y[first + layout.positions * count + j]
    collect_runs(rows, layout.block, layout.speeds, count, rate, first + layout.positions * count)


@kernel
def _by_speed(layout, jacobian, block, first, k, s):
    """Return what the k-th speed of a part does to a row that begins at ``first`` within an implicit step."""
    speed = first + layout.positions + k
    return _shifted(jacobian, block, first + k, speed, s) if k < layout.positions else s * load(jacobian, block, speed)


@fused
def _invert_three(layout, block, jacobian, s, rows):
    """Invert the matrices I - s (dv'/dv + s dv'/dq) of a block of parts with three speeds by cofactors; return whether all are regular."""
    second, third = layout.local, 2 * layout.local
    a, b = 1.0 - _by_speed(layout, jacobian, block, 0, 0, s), -_by_speed(layout, jacobian, block, 0, 1, s)
    d, e = -_by_speed(layout, jacobian, block, second, 0, s), 1.0 - _by_speed(layout, jacobian, block, second, 1, s)
    g, h = -_by_speed(layout, jacobian, block, third, 0, s), -_by_speed(layout, jacobian, block, third, 1, s)
    c, f = -_by_speed(layout, jacobian, block, 0, 2, s), -_by_speed(layout, jacobian, block, second, 2, s)
    i = 1.0 - _by_speed(layout, jacobian, block, third, 2, s)
    m_0, m_1, m_2 = e * i - f * h, f * g - d * i, d * h - e * g
    determinant = a * m_0 + b * m_1 + c * m_2
    scale = 1.0 / determinant
    store(rows, block, 0, m_0 * scale)
    store(rows, block, 1, (c * h - b * i) * scale)
    store(rows, block, 2, (b * f - c * e) * scale)
    store(rows, block, 3, m_1 * scale)
    store(rows, block, 4, (a * i - c * g) * scale)
    store(rows, block, 5, (c * d - a * f) * scale)
    store(rows, block, 6, m_2 * scale)
    store(rows, block, 7, (b * g - a * h) * scale)
    store(rows, block, 8, (a * e - b * d) * scale)
    return total(where_positive(magnitude(determinant), 1.0, 0.0)) == LANES


@fused
def _invert(layout, block, jacobian, s, rows, matrix):
    """Invert the matrices I - s (dv'/dv + s dv'/dq) of a block of parts; return whether all are regular.

    Gauss and Jordan without pivoting: springs, dampers and inertia keep the diagonal above what else is in the matrix.
    """
    n = layout.speeds
    for i in range(n):
        for j in range(n):
            store(matrix, 0, n * i + j, (1.0 if i == j else 0.0) - _by_speed(layout, jacobian, block, i * layout.local, j, s))
            store(rows, block, n * i + j, 1.0 if i == j else 0.0)
    regular = True
    for k in range(n):
        pivot = load(matrix, 0, n * k + k)
        regular = regular and total(where_positive(magnitude(pivot), 1.0, 0.0)) == LANES
        inverse = 1.0 / pivot
        for j in range(k + 1, n):
            store(matrix, 0, n * k + j, inverse * load(matrix, 0, n * k + j))
        for j in range(k + 1):
            store(rows, block, n * k + j, inverse * load(rows, block, n * k + j))
        for i in range(n):
            if i != k:
                factor = load(matrix, 0, n * i + k)
                for j in range(k + 1, n):
                    store(matrix, 0, n * i + j, load(matrix, 0, n * i + j) - factor * load(matrix, 0, n * k + j))
                for j in range(k + 1):
                    store(rows, block, n * i + j, load(rows, block, n * i + j) - factor * load(rows, block, n * k + j))
    return regular


@fused
def _couplings(layout, block, jacobian, s, rows):
    """Write how a block of parts and the border act on each other."""
    speeds, local = layout.speeds, layout.local
    for m in range(layout.border):
        given = layout.load_shifted(jacobian, block, layout.column[m], layout.column[m] + layout.size[m], local, s)
        for k in range(speeds):
            store(rows, block, layout.right + layout.border * k + m, layout.add_products(layout.load_speeds(rows, block, speeds * k, 1), given))
    for k in range(layout.border):
        for m in range(speeds):
            store(rows, block, layout.below + speeds * k + m, _by_speed(layout, jacobian, block, layout.row[k], m, s))


@fused
def _reduce(layout, block, jacobian, s, rows, sums):
    """Add what a block of parts does to the border's system, and to its derivatives by positions, behind that, where parts are held."""
    border, speeds = layout.border, layout.speeds
    for k in range(border):
        below = layout.load_speeds(rows, block, layout.below + speeds * k, 1)
        for m in range(border):
            through = layout.add_products(below, layout.load_speeds(rows, block, layout.right + m, border))
            if layout.body[k] == layout.body[m]:
                column = layout.row[k] + layout.own_column[m]
                d_position = load(jacobian, block, column)
                through += s * (load(jacobian, block, column + layout.size[m]) + s * d_position)
                add(sums, 0, border * (border + k) + m, d_position)
            add(sums, 0, border * k + m, through)


@fused
def factor(layout, jacobian, own, s, factored):
    """Factor I - s J.

    Parameters
    ----------
    layout : `Layout`.
    jacobian : derivatives through each part.
    own : derivatives of the border's accelerations by its own positions and speeds, shape (border, 2 border).
    s : gamma h [s].
    factored : takes the factorisation.

    Returns
    -------
    regular : False where a pivot is zero or not finite.
    """
    rows, positions, corner, sums, border = factored.rows, factored.positions, factored.schur, factored.sums, layout.border
    factored.shift[0] = s
    for m in range(2 * border * border):
        store(sums, 0, m, 0.0)
    regular = True
    for block in range(jacobian.shape[0]):
        if layout.speeds == 3:
            regular = _invert_three(layout, block, jacobian, s, rows) and regular
        else:
            regular = _invert(layout, block, jacobian, s, rows, factored.block) and regular
        _couplings(layout, block, jacobian, s, rows)
        _reduce(layout, block, jacobian, s, rows, sums)
    for k in range(border):
        for m in range(border):
            through = total(load(sums, 0, border * k + m))
            corner[k, m] = (1.0 if k == m else 0.0) - s * (own[k, border + m] + s * own[k, m]) - through
            positions[k, m] = own[k, m] + total(load(sums, 0, border * (border + k) + m))
    return decompose(border, corner, factored.order) and regular


@fused
def _eliminate(layout, block, jacobian, s, x, factored):
    """Reduce a block's right side to speeds, solve for them without the border, and take what they do to it from its own."""
    rows, right, reduced, border, speeds = factored.rows, factored.right, factored.block, layout.border, layout.speeds
    known = layout.load_positions(right, block, 0, 1)
    for k in range(speeds):
        first = k * layout.local
        value = layout.add_positions(layout.load_positions(jacobian, block, first, 1), known)
        for m in range(border):
            value += x[m] * load(jacobian, block, first + layout.column[m])
        store(reduced, 0, k, load(right, block, layout.positions + k) + s * value)
    given = layout.load_speeds(reduced, 0, 0, 1)
    for k in range(speeds):
        store(right, block, layout.positions + k, layout.add_products(layout.load_speeds(rows, block, speeds * k, 1), given))
    found = layout.load_speeds(right, block, layout.positions, 1)
    for k in range(border):
        passed = s * layout.add_positions(layout.load_positions(jacobian, block, layout.row[k], 1), known)
        x[border + k] += total(passed + layout.add_products(layout.load_speeds(rows, block, layout.below + speeds * k, 1), found))


@fused
def _substitute(layout, block, s, x, factored):
    """Complete a block's speeds by what the border does to them, and its positions."""
    rows, right, border, positions = factored.rows, factored.right, layout.border, layout.positions
    for k in range(layout.speeds):
        value = load(right, block, positions + k)
        for m in range(border):
            value += x[border + m] * load(rows, block, layout.right + border * k + m)
        store(right, block, positions + k, value)
        if k < positions:
            store(right, block, k, load(right, block, k) + s * value)


@fused
def solve(layout, jacobian, factored, x):
    """Replace the right side ``x``, a whole state, by the solution of (I - s J) x = b with the last factorisation."""
    s, border = factored.shift[0], layout.border
    count = (x.shape[0] - 2 * border) // layout.block
    spread_state(layout, x, count, factored.right)  # in all lanes: a NaN of an attempt that failed would stay there and reach the border
    for k in range(border):
        through = 0.0
        for m in range(border):
            through += factored.positions[k, m] * x[m]
        x[border + k] += s * through
    for block in range(jacobian.shape[0]):
        _eliminate(layout, block, jacobian, s, x, factored)
    back_substitute(border, factored.schur, factored.order, x[border : 2 * border])
    for block in range(jacobian.shape[0]):
        _substitute(layout, block, s, x, factored)
    for k in range(border):
        x[k] += s * x[border + k]
    collect_runs(factored.right, 0, layout.block, count, x, 2 * border)
