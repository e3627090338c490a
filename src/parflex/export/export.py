"""Export: the models of a robot as a folder of C99 that compiles by itself."""

import os
import re
from contextlib import ExitStack
from pathlib import Path

import casadi
import numpy as np

from parflex.analysis.posed import well_posed
from parflex.base.errors import InputError
from parflex.base.progress import waiting
from parflex.base.writing import replacing
from parflex.compiled.vm import trace
from parflex.export.cases import cases, home
from parflex.export.code import body
from parflex.export.interface import OPTIONAL, Routine, routines
from parflex.export.text import FILES, MARK, Export, texts
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output, PlatformOutput
from parflex.mechanics.redundancy import solvable
from parflex.model import inputs
from parflex.model.core import core_of
from parflex.model.model import Model
from parflex.robot.robot import Robot

BUILT = ("model.o", "test_model", "test_model.o", "test_model.exe")  # left by compilers


def export_c(
    model_or_robot: Model | Robot,
    directory: str | os.PathLike[str],
    output: Output | None = None,
    *,
    prefix: str = "parflex",
    force: bool = False,
) -> tuple[Path, ...]:
    """Write the models as C99, with a header, a self-test, a Makefile and a README; the files.

    The code holds the direct model, the inverse model for an output (all of V̇_p by default), the
    derivative of the state for simulation, and for robots whose state is bound to a closure the
    projection onto it. Its functions allocate nothing, keep nothing, and are named after the prefix.

    Raises InputError where the folder holds files that parflex did not write, unless force is set
    (then only files of the same names are replaced), for a prefix that is no name in C, and as
    `Model.inverse` at home for an output that the actuators cannot command there.
    """
    robot = robot_of(model_or_robot)
    folder = Path(directory)
    check_prefix(prefix)
    check_folder(folder, force)
    chosen = inputs.output_of(core_of(Model(robot, "numpy")), output)
    check_output(robot, chosen)
    return write(folder, texts(gathered(solvable(robot), chosen, prefix)))


def gathered(mechanism: Mechanism, output: Output, prefix: str) -> Export:
    """The functions, traced, and what the NumPy reference makes of some inputs."""
    every = routines(mechanism, output)
    graphs = tuple(traced(routine) for routine in every)
    pairs = tuple(zip(every, graphs, strict=True))
    bodies = tuple(body(graph, routine.inputs, OPTIONAL) for routine, graph in pairs)
    with waiting("computing the cases of the self-test"):
        compared = tuple(cases(mechanism, routine, graph) for routine, graph in pairs)
    return Export(mechanism, output, every, bodies, compared, home(mechanism), prefix)


def traced(routine: Routine) -> casadi.Function:
    """The graph of a function, of which its code is written."""
    with waiting(f"writing the {routine.kernel.name} model as C"):
        return trace(routine.kernel)


def robot_of(given: Model | Robot) -> Robot:
    """The robot of a model, or the robot itself."""
    if not isinstance(given, Model | Robot):
        raise InputError(f"model_or_robot is {type(given).__name__}; give a Model or a Robot")
    return given.robot if isinstance(given, Model) else given


def check_prefix(prefix: str) -> None:
    """Raise InputError where a prefix cannot begin names in C."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", prefix, re.ASCII):
        raise InputError(
            f"prefix is {prefix!r}; it begins the names of all functions: take a letter, then letters, "
            f"digits and underscores, like gripper"
        )


def check_folder(folder: Path, force: bool) -> None:
    """Raise InputError where a folder holds what parflex did not write."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; name a folder, or remove the file")
    if force or not folder.exists():
        return
    foreign = sorted(path.name for path in folder.iterdir() if not own(path))
    if foreign:
        more = f" and {len(foreign) - 3} more" if len(foreign) > 3 else ""
        raise InputError(
            f"{folder} holds files that parflex did not write ({', '.join(foreign[:3])}{more}); name a "
            f"new folder, or write beside them with --force (force=True): {', '.join(FILES)} are replaced"
        )


def own(path: Path) -> bool:
    """True where a file is from an earlier export, or made of one by a compiler."""
    if path.name in BUILT:
        return True
    if path.name not in FILES or not path.is_file():
        return False
    with path.open(encoding="utf-8", errors="replace") as file:
        return MARK in file.read(1000)


def check_output(robot: Robot, output: Output) -> None:
    """Raise InputError, SingularPose where the inverse model has no answer at home, or a meaningless one."""
    model = Model(robot, "numpy")
    state, core = model.project(robot.home), core_of(model)
    model.inverse(state, np.zeros(output.size), output, allow_ill_posed=True)
    if isinstance(output, PlatformOutput) and not well_posed(core.readable, output, core.flat(state)):
        raise InputError(
            "output is an acceleration of the platform, but the legs bend between it and the motors, so that "
            "what forces give it at once means nothing; take output=JointOutput(), --rows joints"
        )


def write(folder: Path, found: dict[str, str]) -> tuple[Path, ...]:
    """All files, or none where one of them cannot be written."""
    paths = tuple(folder / name for name in found)
    with ExitStack() as stack:
        parts = [stack.enter_context(replacing(path)) for path in paths]
        for part, text in zip(parts, found.values(), strict=True):
            part.write(text.encode())
            part.flush()
    return paths
