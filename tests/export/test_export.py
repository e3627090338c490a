"""Models as C99: they compile without a warning, pass their own test, and agree with the library."""

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import cases
import flexlegs
import parflex as pf
import rewriting
from gives import everything
from measures import relative
from parflex.export.cases import leg_sag, magnitudes, sag
from parflex.export.interface import routines
from parflex.kernels import models as kernels
from parflex.kernels.motion import derivative
from parflex.kernels.projection import projection
from parflex.mechanics.redundancy import solvable
from parflex.model.core import core_of

CC, CXX = shutil.which("cc"), shutil.which("c++")
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
LIBRARY = "libmodel.so"
SAME = 1e-12
compiled_here = pytest.mark.skipif(CC is None, reason="there is no C compiler (cc) on this machine")


@cache
def carried() -> cases.Sample:
    """A robot whose legs have no closed form: their joints are in the state, with sin and cos."""
    return rewriting.reframed(cases.case("rps3", "flex"))


@cache
def mixed() -> pf.Robot:
    """Legs of two types in turns, so that the order of the groups is not that of the legs."""
    sample = cases.case("rus6", "rigid")
    other = rewriting.reframed(sample).legs
    legs = tuple(other[i] if i in (0, 3) else leg for i, leg in enumerate(sample.legs))
    return pf.Robot(legs, sample.body, sample.gravity, sample.home_pose)


@cache
def table() -> pf.Robot:
    """Of one freedom: posts and a slide; of one output, where CasADi takes the root of a square for |x|."""
    posts = [pf.Leg(np.eye(3), (0, y, 0), (), (pf.Tip(0, attachment=i),)) for i, y in enumerate((0.1, -0.1))]
    hinge = pf.Joint(0, 0, M=0.1, I=np.eye(3) * 1e-3, alpha=np.pi / 2)
    slide = pf.Joint(1, 1, 1, M=0.5, MS=(0, 0, -0.1), I=np.diag([0.02, 0.02, 0]), alpha=np.pi / 2)
    jack = pf.Leg(np.eye(3), (0.5, 0, -0.6), (hinge, slide), (pf.Tip(2, attachment=2),))
    body = pf.FlexibleBody.rigid(10.0, (0.25, 0, 0), np.eye(3), [(0, 0.1, 0), (0, -0.1, 0), (0.5, 0, 0)])
    return pf.Robot((*posts, jack), body)


@cache
def bent() -> pf.Robot:
    """Struts that bend and twist, with flexures at their tips, under a rigid platform: without stretching,
    the inverse model is a good one."""
    robot = flexlegs.robot("gs_flexlegs")

    def unstretched(leg: pf.Leg) -> pf.Leg:
        *others, rod = leg.joints
        return replace(leg, joints=(*others, replace(rod, body=rod.body.with_modes((0, 1, 2)))))

    legs = [unstretched(leg) for leg in robot.legs]
    return pf.Robot(legs, robot.platform.with_modes(()), robot.gravity, robot.home_pose)


ROBOTS = {
    "gough_stewart": (cache(lambda: pf.robots.gough_stewart(modes=3)), pf.FrameOutput()),
    "delta": (cache(lambda: pf.robots.delta(modes=0)), pf.FrameOutput((0, 1, 2))),
    "carried": (lambda: carried().robot, carried().output),
    "mixed": (mixed, pf.FrameOutput()),
    "table": (table, pf.FrameOutput((4,))),
    "bent": (bent, pf.FrameOutput()),
}
SLOWER = [pytest.param(name, marks=pytest.mark.slow) for name in ("gough_stewart", "mixed", "bent")]


@pytest.fixture(scope="module")
def folder_of(tmp_path_factory):
    """The exported folder of a robot, written once."""
    known: dict[str, Path] = {}

    def get(name: str) -> Path:
        if name not in known:
            build, output = ROBOTS[name]
            known[name] = tmp_path_factory.mktemp(name)
            pf.export_c(build(), known[name], output)
        return known[name]

    return get


def run(*words, at):
    done = subprocess.run([str(word) for word in words], cwd=at, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def compiled(at, level="-O0"):
    """The models as a shared object, compiled once."""
    if not (at / LIBRARY).exists():
        flags = ("-std=c99", level, *STRICT, "-fPIC", "-shared")
        run(CC, *flags, "-o", LIBRARY, "model.c", "-lm", at=at)
    return ctypes.CDLL(str(at / LIBRARY))


@compiled_here
@pytest.mark.parametrize("name", ["delta", "carried", "table", *SLOWER])
def test_self_test_passes_and_the_library_agrees(folder_of, name):
    at = folder_of(name)
    library = compiled(at, "-O1" if name == "gough_stewart" else "-O0")
    run(CC, "-std=c99", *STRICT, "test_model.c", "-o", "test_model", at / LIBRARY, "-lm", at=at)
    said = run("./test_model", at=at)
    assert "all passed" in said
    assert said.count("pass  ") >= 9
    compare(library, *ROBOTS[name])


@compiled_here
@pytest.mark.slow
@pytest.mark.parametrize("name", flexlegs.NAMES)
def test_where_everything_gives_the_self_test_knows_its_round_off(tmp_path, name):
    """Soft tips, drives, couplings, bent links; light ones under stiff couplings leave 5e-12 to chance."""
    pf.export_c(everything(name), tmp_path, pf.JointOutput())
    assert "all passed" in run("make", at=tmp_path)


def test_where_nothing_is_stiff_the_self_test_is_strict(folder_of):
    compared = re.findall(r"differs\(.*, (\S+)\);", (folder_of("delta") / "test_model.c").read_text())
    assert len(compared) >= 9
    assert set(compared) == {"1.0e-12"}


def compare(library, build, output):
    """All functions at random states on the closure, against the kernels themselves.

    Inputs are of the order of the platform's weight. Where forces cancel that are much larger than what
    they leave, C and NumPy are both further from the truth: in the V̇_p of the inverse model with modes bent
    up to a hundred times as far, by 2e-12 and 1e-12 (against the same C with long double).
    """
    robot = build()
    usual = magnitudes(solvable(robot))
    model, rng = pf.Model(robot, "numpy"), np.random.default_rng(7)
    found = states(model, rng)
    for routine in routines(solvable(robot), output):
        name = routine.kernel.name
        args = (output,) if name == "inverse" else ()
        build = {"derivative": derivative, "projection": projection}.get(name) or getattr(kernels, name)
        reference = core_of(model).functions(build, *args)
        for x in found:
            if name == "projection":
                x = x + 1e-6 * (np.arange(len(x)) > 12)
            sizes = routine.kernel.inputs.items()
            rest = {what: usual[what] * rng.normal(size=n) for what, n in sizes if what != "x"}
            expected = reference(x=x, **rest)
            status, given = call(library, routine, x, *rest.values())
            assert status == 0
            for what, a, b in zip(routine.outputs, given, expected.values(), strict=True):
                assert relative(a, b) <= SAME, (name, what)


def states(model, rng, count=4):
    """Flat states on the closure near home, in motion, with quaternions of any length."""
    robot, found = model.robot, []
    start = model.project(robot.home)
    for _ in range(count):
        moved = pf.State(
            start.position + rng.uniform(-0.01, 0.01, 3),
            start.rotation,
            rng.normal(0, 0.1, 6),
            sag(solvable(robot)) * rng.normal(size=robot.platform.modes),
            joints=start.joints,
            leg_elastic=bend(solvable(robot), rng),
            leg_elastic_rate=bend(solvable(robot), rng),
        )
        x = core_of(model).flat(model.project(moved))
        x[3:7] *= rng.uniform(0.5, 2.0)
        found.append(x)
    return found


def bend(mechanism, rng):
    """One array per leg, or None where all are rigid."""
    if not any(mechanism.layout.elastic):
        return None
    s = leg_sag(mechanism) * rng.normal(size=mechanism.layout.carried)
    return [s[place] for place in mechanism.layout.by_leg[1]]


@compiled_here
@pytest.mark.slow
def test_state_of_flexible_legs_is_told(folder_of):
    """Each entry of x once in the header; what is said to be of a leg is what the library has of it."""
    header = (folder_of("bent") / "model.h").read_text()
    rows = re.findall(r"^ \* x\[(\d+)(?: \.\. (\d+))?\] +(.*)$", header, re.MULTILINE)
    told = {int(a): (int(b or a) + 1, words) for a, b, words in rows}
    places = [(start, told[start][0]) for start in sorted(told)]
    assert [start for start, _ in places] == [0, *(end for _, end in places[:-1])]
    assert places[-1][1] == solvable(bent()).layout.size
    bends = 1e-4 * np.arange(36.0).reshape(6, 6)
    state = pf.State(*bent().home_pose, leg_elastic=list(bends))
    x = core_of(pf.Model(bent(), "numpy")).flat(state)
    for start, (end, words) in told.items():
        if found := re.match(r"modal coordinates of leg (\d), kg\^1/2 m: 3 of link 2, 3 of link 3", words):
            assert x[start:end].tolist() == bends[int(found[1]) - 1].tolist()
    assert sum("modal coordinates of leg" in words for _, words in told.values()) == 12
    library, direct = compiled(folder_of("bent")), routines(solvable(bent()), pf.FrameOutput())[0]
    assert call(library, direct, x, np.zeros(6), None)[0] == 0
    opening = solvable(bent()).health.open
    for angle in np.linspace(0, np.pi, 181):  # of the platform, about the vertical
        x[3:7] = np.cos(angle / 2), 0, 0, np.sin(angle / 2)
        status, (*_, health) = call(library, direct, x, np.zeros(6), None)
        assert status == (0 if np.min(health[opening]) > 1e-8 else 5)
    assert status == 5
    readme = (folder_of("bent") / "README.md").read_text()
    assert "a rigid platform, and 36 modes of the legs" in readme
    assert "Modes of the legs: 75.7 …" in readme


def call(library, routine, *inputs, outputs=None):
    """The status and the outputs of a function."""
    found = [np.full(n, np.nan) for n in routine.kernel.outputs.values()] if outputs is None else outputs
    pointers = [None if a is None else ctypes.c_void_p(a.ctypes.data) for a in (*inputs, *found)]
    return getattr(library, f"parflex_{routine.kernel.name}")(*pointers), found


@compiled_here
def test_forces_and_gaps_are_in_the_order_of_the_legs(folder_of):
    """Whatever the groups: against contact forces by attachment, the margins of the same robot with one
    group of legs, and a gap that one leg alone has."""
    library, robot = compiled(folder_of("mixed")), mixed()
    assert [group.legs for group in solvable(robot).groups] == [(0, 3), (1, 2, 4, 5)]
    model, direct = pf.Model(robot, "numpy"), routines(solvable(robot), pf.FrameOutput())[0]
    home = model.project(robot.home)  # which is symmetric
    state = model.project(pf.State(home.position + [0.02, 0.03, 0.01], home.rotation, joints=home.joints))
    u = np.arange(6.0)
    x = core_of(model).flat(state)
    _, (_, _, f, health) = call(library, direct, x, u, None)
    held = [leg.tips[0].attachment for leg in robot.legs]
    assert relative(f.reshape(6, 3), model.direct(state, u).contact_forces[held]) < SAME
    plain = pf.Model(cases.case("rus6", "rigid").robot, "numpy")
    margins = core_of(plain).functions(kernels.direct)(x=x[:13], forces=u)["health"]
    closed = [1, 2, 4, 5, 7, 8, 10, 11]
    assert np.min(np.abs(np.diff(margins[closed]))) > 1e-6  # else the order would not show
    assert relative(health[closed], margins[closed]) < SAME
    x[13 + 3] += 1e-3  # the first joint of leg 4, the second that is carried
    status, (*_, health) = call(library, direct, x, u, None)
    assert status == 3
    assert [bool(np.max(np.abs(gap)) > 1e-5) for gap in health[12:18].reshape(2, 3)] == [False, True]


@compiled_here
def test_null_and_shared_arrays(folder_of):
    """Inputs that are NULL are zero, outputs that are NULL are not written, an output may be an input."""
    at, (build, output) = folder_of("carried"), ROBOTS["carried"]
    library, robot = compiled(at), build()
    direct, inverse, derivative, projection = routines(solvable(robot), output)
    home = np.zeros(solvable(robot).layout.size)
    library.parflex_home(ctypes.c_void_p(home.ctypes.data))
    assert relative(home, core_of(pf.Model(robot)).flat(pf.Model(robot).project(robot.home))) < SAME
    u, w = np.ones(robot.n_forces), np.zeros(6 + robot.platform.modes)
    for routine, second in ((direct, u), (derivative, u), (inverse, np.ones(output.size))):
        more = [np.zeros(n) for n in list(routine.kernel.inputs.values())[3:]]
        _, full = call(library, routine, home, second, w, *more)
        bare = [np.full(next(iter(routine.kernel.outputs.values())), np.nan)] + [None] * (len(full) - 1)
        none = [None] * (len(routine.inputs) - 2)
        assert call(library, routine, home, second, *none, outputs=bare)[0] == 0
        assert np.array_equal(bare[0], full[0])
    off = home + 1e-5 * (np.arange(len(home)) > 6)
    status, (moved, health) = call(library, projection, off)
    assert call(library, projection, off, outputs=[off, None])[0] == status == 0
    assert np.array_equal(off, moved)
    gaps = [np.abs(h[6:]).max() for h in (health, call(library, projection, off)[1][1])]
    assert gaps[1] < 1e-3 * gaps[0]


@compiled_here
def test_states_that_are_none_are_told(folder_of):
    at, (build, output) = folder_of("delta"), ROBOTS["delta"]
    library, robot = compiled(at), build()
    direct, _, derivative, _ = routines(solvable(robot), output)
    header = (at / "model.h").read_text()
    code = {name: int(value) for name, value in re.findall(r"#define PARFLEX_([A-Z_]+) +(\d+)\b", header)}
    x, u = core_of(pf.Model(robot)).flat(pf.Model(robot).project(robot.home)), np.zeros(3)
    assert code["STATE"] == len(x)
    assert call(library, direct, x, u, None)[0] == code["OK"]
    turned = x + 1e-3 * (np.arange(len(x)) == 4)
    assert call(library, direct, turned, u, None)[0] == code["OFF_CLOSURE"]
    assert call(library, derivative, turned, u, None)[0] == code["OK"]
    far = x - 5.0 * (np.arange(len(x)) == 2)
    assert call(library, direct, far, u, None)[0] == code["OUT_OF_REACH"]
    assert call(library, direct, x, np.array([np.nan, 0, 0]), None)[0] == code["NOT_FINITE"]


@pytest.mark.skipif(CXX is None, reason="there is no C++ compiler (c++) on this machine")
def test_it_is_cpp_too(folder_of):
    at = folder_of("delta")
    for name in ("model.c", "test_model.c"):
        run(CXX, "-std=c++11", *STRICT, "-fsyntax-only", "-x", "c++", name, at=at)


@pytest.mark.parametrize("name", ROBOTS)
def test_nothing_is_allocated_or_kept(folder_of, name):
    """No heap, no static data but constants, no data outside of functions, nothing included but math."""
    code = (folder_of(name) / "model.c").read_text()
    code = re.sub(r"/\*.*?\*/", "", code, flags=re.DOTALL)
    assert not re.search(r"\b(malloc|calloc|realloc|free|alloca|extern|volatile)\b", code)
    assert set(re.findall(r"#include (\S+)", code)) == {'"model.h"', "<math.h>", "<stddef.h>"}
    assert {line.strip() for line in code.splitlines() if re.match(r"\s*static (?!const)", line)} == {
        "static int judged(const double health[], int gaps)"
    }
    assert not re.search(r"^(const )?double ", code, flags=re.MULTILINE)
    called = set(re.findall(r"\b(\w+)\(", code))
    known = {"sqrt", "sin", "cos", "atan2", "fabs", "isfinite", "judged", "if", "for", "parflex_home"}
    assert called - known == {
        f"parflex_{r.kernel.name}" for r in routines(solvable(ROBOTS[name][0]()), ROBOTS[name][1])
    }
    assert ("sin" in called) == (name in ("carried", "mixed"))
    assert ("atan2" in called) == (name == "bent")  # of springs on hinges


def test_the_same_export_twice_is_the_same(tmp_path, folder_of):
    build, output = ROBOTS["gough_stewart"]
    files = pf.export_c(pf.Model(build(), "numpy"), tmp_path / "new" / "folder", output, prefix="parflex")
    assert [path.name for path in files] == ["model.h", "model.c", "test_model.c", "Makefile", "README.md"]
    for path in files:
        assert path.read_bytes() == (folder_of("gough_stewart") / path.name).read_bytes()
        assert "@" not in path.read_text().replace("$@", "")
    pf.export_c(build(), tmp_path / "new" / "folder", output, prefix="picker")
    assert "int picker_direct(" in files[0].read_text()
    assert {path.name for path in files[0].parent.iterdir()} == {path.name for path in files}


def test_what_others_wrote_is_kept(tmp_path):
    robot = pf.robots.gough_stewart(modes=0)
    mine = tmp_path / "model.c"
    mine.write_text("int main(void) { return 0; }")
    with pytest.raises(pf.InputError, match=r"files that parflex did not write \(model.c\).*--force"):
        pf.export_c(robot, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["model.c"]
    (tmp_path / "notes.txt").write_text("mine")
    pf.export_c(robot, tmp_path, force=True)
    assert "Generated by parflex" in mine.read_text()
    assert (tmp_path / "notes.txt").read_text() == "mine"
    with pytest.raises(pf.InputError, match="is a file; name a folder"):
        pf.export_c(robot, mine)


def test_complaints_come_before_anything_is_written(tmp_path):
    delta, at = ROBOTS["delta"][0](), tmp_path / "new"
    for given, message in (
        (dict(model_or_robot=3), "model_or_robot is int; give a Model or a Robot"),
        (dict(model_or_robot=delta), r"the robot has 3 actuators; name as many with FrameOutput\(rows="),
        (dict(model_or_robot=delta, output=(0, 1, 2)), "output is tuple"),
        (dict(model_or_robot=delta, output=pf.FrameOutput((0, 1, 3))), "singular"),
        (dict(model_or_robot=delta, prefix="3x"), "prefix is '3x'"),
    ):
        with pytest.raises(pf.InputError, match=message):
            pf.export_c(directory=at, **given)
    assert not at.exists()


def test_command(parflex, tmp_path):
    ROBOTS["delta"][0]().to_file("delta.toml")
    code, out, err = parflex("export", "delta.toml", "--c", "here", "--rows", "0,1,2")
    assert code == 0, err
    assert "now: make -C here" in " ".join(out.split())
    assert (tmp_path / "here" / "model.c").exists()
    for words, message in (
        (("--rows", ""), "--rows is not given, and delta.toml has 3 motors"),
        (("--rows", "0,1,7"), "--rows is '0,1,7'; name rows"),
        (("--rows", "x"), "--rows is 'x'; name rows"),
    ):
        code, out, err = parflex("export", "delta.toml", "--c", "there", *words)
        assert code == 2, out
        assert message in " ".join(err.split())
    assert not (tmp_path / "there").exists()


def test_legs_that_bend_export_accelerations_of_joints(tmp_path):
    """Those of the platform, the default, are refused where they mean nothing, with advice that works."""
    robot = flexlegs.robot("gs_flexlegs")
    with pytest.raises(pf.InputError, match="take output=JointOutput"):
        pf.export_c(robot, tmp_path / "c")
    files = pf.export_c(robot, tmp_path / "c", pf.JointOutput())
    readme = next(path for path in files if path.name == "README.md").read_text()
    assert "accelerations of actuated joints, in the order of u" in readme
