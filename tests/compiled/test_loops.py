"""Rows that are treated alike: traced once, run several per instruction, the same numbers as row by row."""

import numpy as np
import pytest

from parflex.base.array import join, merged, transpose
from parflex.base.unroll import for_each, looping, solve_definite
from parflex.compiled.native import ir, native
from parflex.compiled.native.loops import program
from parflex.compiled.reference import NumpyFunction
from parflex.kernels.kernel import Kernel

WIDTH = 6
RNG = np.random.default_rng(5)


def twice(robot, rows: int) -> Kernel:
    """Two loops, the second on the results of the first; half of these are used by nobody."""
    table = RNG.normal(size=(rows, WIDTH))

    def first(own, table, shared):
        turned = own * table + np.sqrt(1.0 + shared * shared)
        return join([turned / (2.0 + own * own), turned * turned * own])

    def second(own, shared):
        return np.sum(own * shared, axis=-1, keepdims=True) / (1.0 + own * own)

    def function(x, a):
        own = a.reshape(a.shape[:-1] + (rows, WIDTH))
        made = for_each(first, [own, table], [x[..., None, :WIDTH]])[..., :WIDTH]
        found = for_each(second, [made], [made[..., :1, :]])
        return (merged(found),)

    return Kernel("twice", function, (robot.layout.size, rows * WIDTH), (rows * WIDTH,), (robot, rows))


@pytest.mark.parametrize("rows", [2, 3, 6, 8, 11, 16])
@pytest.mark.parametrize("lanes", [2, 4, 8])
def test_any_number_of_rows_on_any_processor(model_of, rows, lanes):
    """Against NumPy; the width is that of the instructions asked for, LLVM splits what is too wide."""
    kernel = twice(model_of(0).robot, rows)
    found = program(kernel, lanes)
    text = ir.module(found, 1, lanes)
    code = native.machine().emit_object(native.llvm.parse_assembly(text))
    engine = native.engine(code)
    probe = kernel.probe(1)
    result = np.full((1, rows * WIDTH), np.nan)
    native.Run(engine.get_function_address("run"))(native.addresses([*probe, result]).ctypes.data, 0, 1)
    assert np.max(np.abs(result - NumpyFunction(kernel)(*probe)[0])) <= 1e-13


def test_a_loop_reads_what_another_has_left_and_leaves_what_is_read(model_of):
    """No copies between loops, and no results that nobody reads."""
    loops = program(twice(model_of(0).robot, 8), 8).loops
    assert [loop.outputs for loop in loops] == [WIDTH, WIDTH]
    assert [(loop.own_shared, loop.own_columns) for loop in loops] == [(WIDTH, WIDTH), (0, 0)]
    assert {source.loop for source in loops[1].columns + loops[1].shared} == {0}


def test_a_loop_that_nobody_reads_is_none(model_of):
    robot = model_of(0).robot

    def function(x, a):
        rows = a.reshape(a.shape[:-1] + (8, WIDTH))
        for_each(lambda own: np.sqrt(own * own + 1.0) / (2.0 + own), [rows])
        return (a[..., :1] * a[..., :1],)

    kernel = Kernel("none", function, (robot.layout.size, 8 * WIDTH), (1,), (robot, "none"))
    assert program(kernel, 8).loops == []


@pytest.mark.parametrize("size", [6, 18, 24])
def test_definite_systems_in_blocks(model_of, size):
    """Block by block and row by row, against LAPACK."""
    robot = model_of(0).robot

    def function(x, a):
        rows = a.reshape(a.shape[:-1] + (size, size + 1))
        matrix = rows[..., :size] @ transpose(rows[..., :size]) + size * np.eye(size)
        return (solve_definite(matrix, rows[..., size:], 3)[..., 0],)

    kernel = Kernel(
        "solve", function, (robot.layout.size, size * (size + 1)), (size,), (robot, "definite", size)
    )
    assert looping.get() is None
    probe = kernel.probe(4)
    expected = NumpyFunction(kernel)(*probe)[0]
    for lanes in (1, 4):
        code = native.code(kernel, lanes)
        found = np.full_like(expected, np.nan)
        code.run(native.addresses([*probe, found]).ctypes.data, 0, 4 // lanes)
        assert np.max(np.abs(found - expected)) <= 1e-12
