"""Rows that are treated alike: traced once, run several per instruction, the same numbers as row by row."""

import numpy as np
import pytest

from parflex.base.array import join, merged, transpose
from parflex.base.unroll import each, looping, solve_definite
from parflex.compiled.native import ir, native
from parflex.compiled.native.loops import program
from parflex.compiled.reference import NumpyFunction
from parflex.kernels.kernel import Kernel, kernel
from parflex.mechanics.redundancy import solvable

WIDTH = 6
RNG = np.random.default_rng(5)


def twice(mechanism, rows: int) -> Kernel:
    """Two loops, the second on the results of the first; half of these are used by nobody."""
    table = RNG.normal(size=(rows, WIDTH))

    def first(own, table, shared):
        turned = own * table + np.sqrt(1.0 + shared * shared)
        return join([turned / (2.0 + own * own), turned * turned * own])

    def second(own, shared):
        return np.sum(own * shared, axis=-1, keepdims=True) / (1.0 + own * own)

    def function(x, a):
        own = a.reshape(a.shape[:-1] + (rows, WIDTH))
        made = each(first, [own, table], [x[..., None, :WIDTH]])[..., :WIDTH]
        found = each(second, [made], [made[..., :1, :]])
        return {"found": merged(found)}

    size = rows * WIDTH
    return kernel("twice", function, mechanism, ("found",), (rows,), a=size, found=size)


@pytest.mark.parametrize("rows", [2, 3, 6, 8, 11, 16])
@pytest.mark.parametrize("lanes", [2, 4, 8])
def test_any_number_of_rows_on_any_processor(model_of, rows, lanes):
    """Against NumPy; the width is that of the instructions asked for, LLVM splits what is too wide."""
    doubled = twice(solvable(model_of(0).robot), rows)
    found = program(doubled, lanes)
    text = ir.module(found, 1, lanes)
    code = native.machine().emit_object(native.llvm.parse_assembly(text))
    engine = native.engine(code)
    probe = doubled.probe(1)
    result = np.full((1, rows * WIDTH), np.nan)
    native.Run(engine.get_function_address("run"))(
        native.addresses([*probe.values(), result]).ctypes.data, 0, 1
    )
    assert np.max(np.abs(result - NumpyFunction(doubled)(**probe)["found"])) <= 1e-13


def test_a_loop_reads_what_another_has_left_and_leaves_what_is_read(model_of):
    """No copies between loops, and no results that nobody reads."""
    loops = program(twice(solvable(model_of(0).robot), 8), 8).loops
    assert [loop.outputs for loop in loops] == [WIDTH, WIDTH]
    assert [(loop.own_shared, loop.own_columns) for loop in loops] == [(WIDTH, WIDTH), (0, 0)]
    assert {source.loop for source in loops[1].columns + loops[1].shared} == {0}


def test_a_loop_that_nobody_reads_is_none(model_of):
    def function(x, a):
        rows = a.reshape(a.shape[:-1] + (8, WIDTH))
        each(lambda own: np.sqrt(own * own + 1.0) / (2.0 + own), [rows])
        return {"found": a[..., :1] * a[..., :1]}

    mechanism = solvable(model_of(0).robot)
    idle = kernel("none", function, mechanism, ("found",), a=8 * WIDTH, found=1)
    assert program(idle, 8).loops == []


@pytest.mark.parametrize("size", [6, 18, 24])
def test_definite_systems_in_blocks(model_of, size):
    """Block by block and row by row, against LAPACK."""

    def function(x, a):
        rows = a.reshape(a.shape[:-1] + (size, size + 1))
        matrix = rows[..., :size] @ transpose(rows[..., :size]) + size * np.eye(size)
        return {"found": solve_definite(matrix, rows[..., size:], 3)[..., 0]}

    mechanism, sizes = solvable(model_of(0).robot), {"a": size * (size + 1), "found": size}
    solved = kernel("solve", function, mechanism, ("found",), (size,), **sizes)
    assert looping.get() is None
    probe = solved.probe(4)
    expected = NumpyFunction(solved)(**probe)["found"]
    for lanes in (1, 4):
        code = native.code(solved, lanes)
        found = np.full_like(expected, np.nan)
        code.run(native.addresses([*probe.values(), found]).ctypes.data, 0, 4 // lanes)
        assert np.max(np.abs(found - expected)) <= 1e-12
