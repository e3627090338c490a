"""Machine code: the numbers of the virtual machine, one state or many; a cache that is never wrong."""

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import cases
import parflex as pf
import zoo
from measures import random_forces, random_states, relative
from parflex.base import cache
from parflex.compiled.native import instructions, ir, native
from parflex.compiled.native.loops import program
from parflex.compiled.vm import VmBackend, VmFunction
from parflex.kernels import models as kernels
from parflex.kernels import motion
from parflex.kernels.by_tips import by_tips
from parflex.kernels.projection import projection
from parflex.mechanics.legs.carried import Carried
from parflex.mechanics.mechanism import mechanism_of
from parflex.mechanics.redundancy import solvable, with_rows
from parflex.model.core import core_of

SAME = 1e-13  # fused multiplications round less often; relative to the largest entry
SOLVED = 1e-12  # of the inverse model, whose systems are less well conditioned


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """A cache of this test's own."""
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def alike(found, expected, tolerance):
    assert list(found) == list(expected)
    for name, b in expected.items():
        a = found[name]
        scale = np.max(np.abs(b), initial=1.0)
        assert relative(a / scale, b / scale) <= tolerance


@pytest.mark.parametrize("modes", [0, pytest.param(10, marks=pytest.mark.slow)])
def test_same_numbers_as_the_virtual_machine(model_of, modes):
    """One state and a batch of 67, whose last block overlaps; on all processors, too."""
    vm = model_of(modes, "vm")
    states, forces = random_states(vm.robot, 67, 1), random_forces(vm, 67, 2)
    x, mechanism = core_of(vm).flat(states), solvable(vm.robot)
    for build in (kernels.direct, motion.derivative):
        code, expected = (
            native.NativeFunction(build(mechanism)),
            core_of(vm).functions(build)(x=x, forces=forces),
        )
        alike(code(x=x, forces=forces), expected, SAME)
        alike(code(x=x[3], forces=forces[3]), {name: a[3] for name, a in expected.items()}, SAME)
        many = code(x=np.tile(x, (20, 1)), forces=np.tile(forces, (20, 1)))
        alike(many, {name: np.tile(a, (20, 1)) for name, a in expected.items()}, SAME)
    found = native.NativeFunction(kernels.inverse(mechanism, pf.FrameOutput()))
    given = {"x": x, "target": np.ones((67, 6))}
    alike(found(**given), core_of(vm).functions(kernels.inverse, pf.FrameOutput())(**given), SOLVED)


def test_functions_of_the_library_are_called(model_of):
    """Actuated angles need atan2; legs whose joints are carried need sin and cos."""
    sample = cases.case("rus6", "rigid")
    robot = sample.robot
    vm = pf.Model(robot, "vm")
    x = np.tile(core_of(vm).flat(sample.states), (6, 1))
    alike(
        native.NativeFunction(kernels.actuators(solvable(robot)))(x=x),
        core_of(vm).functions(kernels.actuators)(x=x),
        SAME,
    )


def test_single_states_are_the_batch(model_of):
    """What the wide code gives for a state is what the code for one gives."""
    model = pf.Model(model_of(10).robot, "native")
    states, forces = random_states(model.robot, 100, 5), random_forces(model, 100, 6)
    whole = model.direct(states, forces)
    for i in (0, 50, 99):
        one = model.direct(states[i], forces[i])._asdict()
        alike({name: a[i] for name, a in whole._asdict().items()}, one, SAME)


def test_code_is_kept(model_of, own_cache, monkeypatch):
    """The second model is not traced."""
    kernel = kernels.actuators(solvable(model_of(0).robot))
    x = kernel.probe(1)["x"]
    expected = native.NativeFunction(kernel)(x=x)
    assert len(list(own_cache.iterdir())) == 1
    monkeypatch.setattr(native, "program", None)
    alike(native.NativeFunction(kernel)(x=x), expected, 0.0)


@pytest.mark.parametrize("spoil", ["cut", "flip", "empty"])
def test_a_spoilt_cache_is_compiled_anew(model_of, own_cache, spoil):
    kernel = kernels.actuators(solvable(model_of(0).robot))
    x = kernel.probe(1)["x"]
    expected = native.NativeFunction(kernel)(x=x)
    (path,) = own_cache.iterdir()
    data = path.read_bytes()
    flipped = data[:5000] + bytes([data[5000] ^ 1]) + data[5001:]
    path.write_bytes({"cut": data[: len(data) // 2], "flip": flipped, "empty": b""}[spoil])
    alike(native.NativeFunction(kernel)(x=x), expected, 0.0)
    assert path.read_bytes()[:32] == data[:32]


def test_code_of_another_robot_is_noticed(model_of, own_cache):
    """An entry whose answers are not those of its code, as on a processor that computes otherwise."""
    kernel = kernels.actuators(solvable(model_of(0).robot))
    x = kernel.probe(1)["x"]
    expected = native.NativeFunction(kernel)(x=x)
    (path,) = own_cache.iterdir()
    entry = cache.load(path.stem)
    cache.save(path.stem, entry._replace(outputs=[a + 1e-3 for a in entry.outputs]))
    with pytest.warns(UserWarning, match="cached machine code does not give what it should"):
        alike(native.NativeFunction(kernel)(x=x), expected, 0.0)


def test_wrong_code_falls_back(model_of, monkeypatch):
    """A compiler that errs: the virtual machine is used, and said."""
    monkeypatch.setitem(instructions.ARITHMETIC, next(iter(instructions.ARITHMETIC)), "fsub")
    with pytest.warns(UserWarning, match="differs from the reference.*is used instead"):
        found = native.NativeBackend().compile(kernels.actuators(solvable(model_of(0).robot)))
    assert isinstance(found, VmFunction)


def test_code_of_another_user_is_not_run(model_of, own_cache, monkeypatch):
    kernel = kernels.actuators(solvable(model_of(0).robot))
    native.NativeFunction(kernel)
    (path,) = own_cache.iterdir()
    monkeypatch.setattr(cache.os, "getuid", lambda: 12345)
    assert cache.load(path.stem) is None


def test_what_was_not_used_for_longest_leaves_the_cache(model_of, own_cache, monkeypatch):
    native.code(kernels.actuators(solvable(model_of(0).robot)), 1)
    (path,) = own_cache.iterdir()
    entry = cache.load(path.stem)
    for age, name in ((3, path.stem), (2, "older"), (1, "newer")):
        cache.save(name, entry)
        os.utime(own_cache / f"{name}.bin", (1e9 - age, 1e9 - age))
    monkeypatch.setattr(cache, "LIMIT", 2.5 * path.stat().st_size)
    assert cache.load(path.stem) is not None  # and so it is the youngest again
    cache.save("newest", entry)
    assert {p.stem for p in own_cache.iterdir()} == {path.stem, "newest"}


def test_no_place_for_a_cache(model_of, own_cache, monkeypatch):
    kernel = kernels.actuators(solvable(model_of(0).robot))
    own_cache.write_text("a file where the folder should be")
    native.NativeFunction(kernel)
    monkeypatch.setenv(cache.VARIABLE, "")
    native.NativeFunction(kernel)
    assert own_cache.read_text() == "a file where the folder should be"


COMPILE = """
import parflex as pf
from parflex.compiled.native import native
from parflex.kernels import models as kernels
from parflex.mechanics.redundancy import solvable
robot = pf.robots.gough_stewart(0)
print("ready", flush=True)
input()
native.NativeFunction(kernels.actuators(solvable(robot)))
"""
CUT = """
import os
os.fsync = lambda handle: os._exit(9)  # when all is written but named
"""


@pytest.mark.slow
def test_two_at_once_and_one_that_died(own_cache):
    """Processes that keep the same kernel, after one that ended amid its writing, leave a whole cache."""

    def compiling(code: str) -> subprocess.Popen:
        return subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    dead = compiling(CUT + COMPILE)
    dead.communicate("\n")
    assert dead.returncode == 9
    assert [path.suffix for path in own_cache.iterdir()] == [".part"]
    two = [compiling(COMPILE) for _ in range(2)]
    assert [process.stdout.readline() for process in two] == ["ready\n"] * 2
    for process in two:
        process.stdin.write("\n")
        process.stdin.flush()
    for process in two:
        process.communicate()
    assert [process.returncode for process in two] == [0, 0]
    (path,) = own_cache.iterdir()
    assert cache.load(path.stem) is not None


def test_other_robots_have_other_keys(model_of):
    """What a robot is made of, to the last bit, names its code."""
    robot = model_of(0).robot
    lighter = solvable(replace(robot, gravity=(0, 0, np.nextafter(-9.81, 0))))
    carried = with_rows(mechanism_of(robot, (Carried(),)))
    robot = solvable(robot)
    keys = {cache.key_of(kernel.name, kernel.subject) for kernel in (
        kernels.direct(robot), kernels.direct(lighter), motion.derivative(robot),
        kernels.inverse(robot, pf.FrameOutput()), kernels.inverse(robot, pf.FrameOutput((0, 1, 2))),
        kernels.direct(by_tips(robot)), kernels.direct(carried),
    )}  # fmt: skip
    assert len(keys) == 7


def test_every_operation_has_a_translation():
    """The graphs of all kernels of a robot with carried legs, friction and springs."""
    robot = solvable(zoo.odd(0, 3).robot)
    for kernel in (kernels.direct(robot), motion.derivative(robot), projection(robot)):
        assert "define void @run" in ir.module(program(kernel), 2, 8)
    assert VmBackend().name == "vm"


@pytest.mark.parametrize("lanes", [1, 4])
def test_parts_hand_their_values_on(model_of, monkeypatch, lanes):
    """A graph cut into a dozen functions gives what the whole gives."""
    kernel = kernels.direct(solvable(model_of(0).robot))
    monkeypatch.setattr(ir, "PART", 400)
    assert ir.module(program(kernel), lanes, 8).count("define internal void @part") >= 10
    assert native.code(kernel, lanes).sound


PROCESSORS = {  # the format of its objects, and what they begin with
    "aarch64-unknown-linux-gnu": ("generic", b"\x7fELF", (18, 183)),
    "arm64-apple-macosx": ("apple-m1", b"\xcf\xfa\xed\xfe", (4, 12)),
    "x86_64-unknown-linux-gnu": ("x86-64", b"\x7fELF", (18, 62)),
}


@pytest.mark.parametrize("lanes", [1, 2])
@pytest.mark.parametrize("triple", PROCESSORS)
def test_code_for_other_processors_is_compiled(model_of, triple, lanes):
    """The same text, by LLVM's translators for ARM and for the least x86: two doubles in a register."""
    llvm = native.llvm
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    cpu, begins, (at, number) = PROCESSORS[triple]
    target = llvm.Target.from_triple(triple).create_target_machine(cpu=cpu, opt=2)
    text = ir.module(program(kernels.direct(solvable(model_of(1).robot)), 2 if lanes == 1 else 1), lanes, 2)
    code = target.emit_object(llvm.parse_assembly(text))
    assert code.startswith(begins)
    assert code[at] == number
    assert len(code) > 10_000


FORK = """
import os, warnings
import numpy as np
import parflex as pf
from parflex.compiled.native import native
from parflex.kernels import models as kernels
from parflex.mechanics.redundancy import solvable

robot = pf.robots.gough_stewart(0)
function = native.NativeFunction(kernels.actuators(solvable(robot)))
x = np.tile(function.kernel.probe(1)["x"], (2000, 1))
expected = function(x=x)["positions"]
warnings.simplefilter("ignore")
child = os.fork()
if child == 0:
    os._exit(0 if np.array_equal(function(x=x)["positions"], expected) else 1)
assert os.waitpid(child, 0)[1] == 0
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes do not fork here")
def test_batches_in_a_forked_process(own_cache):
    """The threads of the parent are not waited for in the child."""
    subprocess.run([sys.executable, "-c", FORK], check=True, timeout=600)


def test_bound_arrays_live_on(model_of):
    """What a flat call has seen is not moved or freed under it: NumPy refuses, dropped arrays are kept."""
    model = model_of(3, "native")
    state, forces = model.equilibrium(*model.robot.home_pose)
    c = model.compiled()
    x, u, out = c.pack(state), forces.copy(), np.zeros(9)
    c.direct(x, u, out)
    expected = out.copy()
    for array in (x, u, out):
        with pytest.raises(ValueError, match="resize"):
            array.resize(100)
    for _ in range(200):  # more than are remembered; each new array may lie where a dropped one lay
        shifted, there = u + 1.0, np.full(9, np.nan)
        c.direct(x, shifted, there)
        assert np.all(np.isfinite(there))
    u[:], out[:] = forces, np.nan
    c.direct(x, u, out)
    assert np.array_equal(out, expected)
