# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""SIMD over rollers: a value that is a vector of doubles, with one lane for each of ``LANES`` rollers.

The compiler vectorises loops by itself only where it can prove that arrays do not overlap, and gives up after a few rows.
With a vector as a type there is nothing to prove: a law that is written for a number computes ``LANES`` rollers per instruction.
Without compilation (NUMBA_DISABLE_JIT=1, for a debugger) a vector is a NumPy array of ``LANES`` numbers.

Arrays of lanes have the shape (blocks, rows, LANES), see `new_rows`; a state holds each quantity of all rollers as one run of
numbers, see `spread_runs` and `collect_runs`.
"""

import operator

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import PrimitiveModel, register_default
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import intrinsic, lower_builtin

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.vector_width import LANES

_CACHE_LINE = 8  # doubles

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_INTEGERS = ir.VectorType(ir.IntType(64), LANES)


class _LanesType(types.Type):
    def __init__(self, name, llvm):
        super().__init__(name)
        self.llvm = llvm


lanes_type = _LanesType("lanes", _VECTOR)
_bits_type = _LanesType("lane_bits", _INTEGERS)


@register_default(_LanesType)
class _LanesModel(PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, numba_type.llvm)


def _spread(builder, value, llvm):
    """Return a vector with a number in every lane."""
    single = builder.insert_element(ir.Constant(llvm, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(single, ir.Constant(llvm, ir.Undefined), ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES))


def _as_lanes(context, builder, value, numba_type, lanes):
    if isinstance(numba_type, _LanesType):
        return value
    scalar = types.float64 if lanes is lanes_type else types.int64
    return _spread(builder, context.cast(builder, value, numba_type, scalar), lanes.llvm)


def _define_operator(function, lanes, instruction):
    class Typing(AbstractTemplate):
        def generic(self, arguments, keywords):
            if len(arguments) == 2 and lanes in arguments and all(a is lanes or isinstance(a, types.Number) for a in arguments):
                return lanes(*arguments)

    infer_global(function)(Typing)

    def lower(context, builder, signature, arguments):
        left, right = (_as_lanes(context, builder, a, t, lanes) for a, t in zip(arguments, signature.args))
        return getattr(builder, instruction)(left, right)

    for pair in ((lanes, lanes), (lanes, types.Number), (types.Number, lanes)):
        lower_builtin(function, *pair)(lower)


for _function, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _define_operator(_function, lanes_type, _instruction)
    _define_operator(getattr(operator, "i" + _function.__name__), lanes_type, _instruction)
for _function, _instruction in ((operator.add, "add"), (operator.sub, "sub"), (operator.lshift, "shl"), (operator.rshift, "lshr")):
    _define_operator(_function, _bits_type, _instruction)


@infer_global(operator.neg)
class _Negation(AbstractTemplate):
    def generic(self, arguments, keywords):
        if arguments == (lanes_type,):
            return lanes_type(lanes_type)


@lower_builtin(operator.neg, lanes_type)
def _negate(context, builder, signature, arguments):
    return builder.fsub(ir.Constant(_VECTOR, [-0.0] * LANES), arguments[0])


def _row(context, builder, array_type, array, block, row):
    """Return a pointer to a row of a block; within a block all rows are a constant away from each other."""
    array = context.make_array(array_type)(context, builder, array)
    rows = cgutils.unpack_tuple(builder, array.shape, 3)[1]
    first = builder.add(builder.mul(block, rows), row)
    return builder.gep(builder.bitcast(array.data, _VECTOR.as_pointer()), [first])


def _index(context, builder, value, numba_type):
    return context.cast(builder, value, numba_type, types.intp)


@intrinsic
def _load(context, array, block, row):
    def generate(context, builder, signature, arguments):
        block, row = (_index(context, builder, v, t) for v, t in zip(arguments[1:], signature.args[1:]))
        return builder.load(_row(context, builder, signature.args[0], arguments[0], block, row), align=8)

    return lanes_type(array, block, row), generate


@intrinsic
def _store(context, array, block, row, value):
    def generate(context, builder, signature, arguments):
        block, row = (_index(context, builder, v, t) for v, t in zip(arguments[1:3], signature.args[1:3]))
        vector = _as_lanes(context, builder, arguments[3], signature.args[3], lanes_type)
        builder.store(vector, _row(context, builder, signature.args[0], arguments[0], block, row), align=8)
        return context.get_dummy_value()

    return types.void(array, block, row, value), generate


def _run(context, builder, signature, arguments):
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    pointer = builder.gep(array.data, [_index(context, builder, arguments[1], signature.args[1])])
    return builder.bitcast(pointer, _VECTOR.as_pointer())


@intrinsic
def _load_run(context, x, first):
    def generate(context, builder, signature, arguments):
        return builder.load(_run(context, builder, signature, arguments), align=8)

    return lanes_type(x, first), generate


@intrinsic
def _store_run(context, x, first, value):
    def generate(context, builder, signature, arguments):
        builder.store(arguments[2], _run(context, builder, signature, arguments), align=8)
        return context.get_dummy_value()

    return types.void(x, first, value), generate


@intrinsic
def _gather(context, table, index, column):
    def generate(context, builder, signature, arguments):
        table = context.make_array(signature.args[0])(context, builder, arguments[0])
        columns = cgutils.unpack_tuple(builder, table.shape, 2)[1]
        column = _index(context, builder, arguments[2], signature.args[2])
        value = ir.Constant(_VECTOR, ir.Undefined)
        for lane in range(LANES):
            position = ir.Constant(ir.IntType(32), lane)
            row = builder.fptosi(builder.extract_element(arguments[1], position), ir.IntType(64))
            pointer = builder.gep(table.data, [builder.add(builder.mul(row, columns), column)])
            value = builder.insert_element(value, builder.load(pointer), position)
        return value

    return lanes_type(table, index, column), generate


@intrinsic
def _broadcast(context, value):
    return lanes_type(value), lambda context, builder, signature, arguments: _as_lanes(context, builder, arguments[0], signature.args[0], lanes_type)


@intrinsic
def _sum(context, value):
    def generate(context, builder, signature, arguments):
        value, width = arguments[0], LANES
        while width > 1:
            width //= 2
            low, high = (ir.Constant(ir.VectorType(ir.IntType(32), width), list(range(k, k + width))) for k in (0, width))
            nothing = ir.Constant(value.type, ir.Undefined)
            value = builder.fadd(builder.shuffle_vector(value, nothing, low), builder.shuffle_vector(value, nothing, high))
        return builder.extract_element(value, ir.Constant(ir.IntType(32), 0))

    return types.float64(value), generate


@intrinsic
def _highest(context, value):
    def generate(context, builder, signature, arguments):
        best = builder.extract_element(arguments[0], ir.Constant(ir.IntType(32), 0))
        for lane in range(1, LANES):
            other = builder.extract_element(arguments[0], ir.Constant(ir.IntType(32), lane))
            best = builder.select(builder.fcmp_ordered(">", other, best), other, best)
        return best

    return types.float64(value), generate


def _unary(name):
    @intrinsic
    def law(context, value):
        def generate(context, builder, signature, arguments):
            function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), f"llvm.{name}.v{LANES}f64")
            return builder.call(function, [arguments[0]])

        return lanes_type(value), generate

    return law


def _choice(predicate):
    @intrinsic
    def law(context, left, right):
        number = lanes_type if lanes_type in (left, right) else types.float64

        def generate(context, builder, signature, arguments):
            pairs = zip(arguments, signature.args)
            if number is lanes_type:
                left, right = (_as_lanes(context, builder, a, t, lanes_type) for a, t in pairs)
            else:
                left, right = (context.cast(builder, a, t, types.float64) for a, t in pairs)
            return builder.select(builder.fcmp_ordered(predicate, left, right), left, right)

        return number(left, right), generate

    return law


@intrinsic
def _where_positive(context, condition, positive, otherwise):
    def generate(context, builder, signature, arguments):
        positive, otherwise = (_as_lanes(context, builder, a, t, lanes_type) for a, t in zip(arguments[1:], signature.args[1:]))
        return builder.select(builder.fcmp_ordered(">", arguments[0], ir.Constant(_VECTOR, [0.0] * LANES)), positive, otherwise)

    return lanes_type(condition, positive, otherwise), generate


@intrinsic
def bits(context, value):
    """Return the bits of a double, or of each lane, as integers."""
    number, llvm = (_bits_type, _INTEGERS) if value is lanes_type else (types.int64, ir.IntType(64))
    return number(value), lambda context, builder, signature, arguments: builder.bitcast(arguments[0], llvm)


@intrinsic
def double(context, value):
    """Return the double, or lanes of them, with these bits."""
    number, llvm = (lanes_type, _VECTOR) if value is _bits_type else (types.float64, ir.DoubleType())
    return number(value), lambda context, builder, signature, arguments: builder.bitcast(arguments[0], llvm)


if numba.config.DISABLE_JIT:

    def load(array, block, row):
        return array[block, row].copy()

    def store(array, block, row, value):
        array[block, row] = value

    def load_run(x, first):
        return x[first : first + LANES].copy()

    def store_run(x, first, value):
        x[first : first + LANES] = value

    def gather(table, index, column):
        return table[index.astype(int), column]

    def spread(value):
        return np.full(LANES, value)

    def total(value):
        return value.sum()

    def highest(value):
        return value.max()

    def where_positive(condition, positive, otherwise):
        return np.where(condition > 0.0, positive, otherwise)

    square_root, floor, magnitude, larger, smaller = np.sqrt, np.floor, np.abs, np.maximum, np.minimum
else:
    load, store, gather, load_run, store_run = _load, _store, _gather, _load_run, _store_run
    spread, total, highest, where_positive = _broadcast, _sum, _highest, _where_positive
    square_root, floor, magnitude = _unary("sqrt"), _unary("floor"), _unary("fabs")
    larger, smaller = _choice(">"), _choice("<")


@kernel
def add(array, block, row, value):
    """Add a value (lanes) to a row of a block, see `new_rows`."""
    store(array, block, row, load(array, block, row) + value)


def blocks_of(count):
    """Return how many blocks of lanes hold ``count`` rollers."""
    return -(-count // LANES)


def new_rows(rows, count):
    """Return zeroed rows for ``count`` rollers, shape (blocks, rows, LANES); `by_roller` shows one row."""
    return new_blocks(blocks_of(count), rows)


def new_blocks(blocks, rows):
    """Return zeros of shape (blocks, rows, LANES) that begin at a cache line, so that no vector lies across two of them."""
    size = blocks * rows * LANES
    memory = np.zeros(size + _CACHE_LINE - 1)
    first = -memory.ctypes.data // memory.itemsize % _CACHE_LINE
    return memory[first : first + size].reshape(blocks, rows, LANES)


def by_roller(array, row, count):
    """Return one row of an array of `new_rows` as numbers by roller, shape (count,)."""
    return array[:, row].reshape(-1)[:count]


@kernel
def spread_runs(x, first, runs, count, rows):
    """Copy runs of ``count`` numbers into the first rows of all blocks; lanes without a roller keep their values.

    Parameters
    ----------
    x : numbers, the runs one after the other, starting at ``first``.
    runs, count : how many runs, and numbers in each.
    rows : see `new_rows`.
    """
    whole = count // LANES
    for k in range(runs):
        start = first + k * count
        for block in range(whole):
            store(rows, block, k, load_run(x, start + block * LANES))
        for lane in range(count - whole * LANES):
            rows[whole, k, lane] = x[start + whole * LANES + lane]


@kernel
def spread_run(x, first, count, rows, row):
    """Copy one run into a row of all blocks; lanes without a roller take the last one's value.  Parameters as of `spread_runs`."""
    whole = count // LANES
    for block in range(whole):
        store(rows, block, row, load_run(x, first + block * LANES))
    if whole * LANES < count:
        for lane in range(LANES):
            rows[whole, row, lane] = x[first + min(whole * LANES + lane, count - 1)]


@kernel
def fill_lanes(rows, runs, count):
    """Fill lanes without a roller with the last roller's values in the first ``runs`` rows, so that they stay finite."""
    last = count - 1
    for k in range(runs):
        for j in range(count, rows.shape[0] * LANES):
            rows[j // LANES, k, j % LANES] = rows[last // LANES, k, last % LANES]


@kernel
def collect_runs(rows, row, runs, count, x, first):
    """Copy rows, starting at ``row``, back into runs, starting at ``first``; parameters as of `spread_runs`."""
    whole = count // LANES
    for k in range(runs):
        start = first + k * count
        for block in range(whole):
            store_run(x, start + block * LANES, load(rows, block, row + k))
        for lane in range(count - whole * LANES):
            x[start + whole * LANES + lane] = rows[whole, row + k, lane]
