"""The ledger of energies and works, and the residual of their balance."""

from collections.abc import Callable

import numpy as np

from parflex.base.array import Array
from parflex.kernels.moved_base import BASE
from parflex.kernels.moved_rests import REST
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable

DISSIPATED = "dissipated"


def residual(run: Recorded) -> Array:
    """(T,) J: stored energy and dissipation, less the works of actuators, wrenches and surroundings."""
    kinetic, gravity, strain, springs = run.energies
    stored = kinetic + gravity + strain + springs
    done = [work for name, work in run.works.items() if name != DISSIPATED]
    return stored - stored[0] + run.works[DISSIPATED] - sum(done, np.zeros(len(run.t)))


def work(name: str) -> Callable[[Recorded], Array | None]:
    """The function of a run that gives a work; None where it has no such."""
    return lambda run: run.works.get(name)


def term(name: str, words: str, of: Callable[[Recorded], Array | None]) -> Variable:
    """One energy or work over time."""
    return Variable(f"energy_{name}", ("time",), "J", words, of)


LEDGER = (
    term("kinetic", "kinetic energy, rotors included", lambda run: run.energies.kinetic),
    term(
        "gravity",
        "potential energy of weight, zero at the world's origin",
        lambda run: run.energies.gravity,
    ),
    term("strain", "strain energy of the platform and of flexible links", lambda run: run.energies.strain),
    term(
        "springs",
        "energy of springs at joints and of flexures at tips",
        lambda run: run.energies.springs + 0.0 * run.t,
    ),
    term("dissipated", "energy dissipated by damping and friction", work(DISSIPATED)),
    term("actuators", "work of the actuators", work("actuators")),
    term("wrenches", "work of the external wrenches", work("wrenches")),
    term("base", "work of the base that moves", work(BASE)),
    term("rests", "work of the rests of springs that move", work(REST)),
)
RESIDUAL = term("residual", "residual of the energy balance", residual)
