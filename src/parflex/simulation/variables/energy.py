"""The ledger of energies and works, and the residual of their balance."""

from collections.abc import Callable

from parflex.base.array import Array
from parflex.simulation.variables.recorded import Recorded
from parflex.simulation.variables.variable import Variable


def residual(run: Recorded) -> Array:
    """(T,) J: stored energy and dissipation, less the works of actuators and wrenches."""
    actuators, wrenches, dissipated = run.run.works.T
    kinetic, gravity, strain, springs = run.energies
    stored = kinetic + gravity + strain + springs
    return stored - stored[0] + dissipated - actuators - wrenches


def term(name: str, words: str, of: Callable[[Recorded], Array]) -> Variable:
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
    term("dissipated", "energy dissipated by damping and friction", lambda run: run.run.works[:, 2]),
    term("actuators", "work of the actuators", lambda run: run.run.works[:, 0]),
    term("wrenches", "work of the external wrenches", lambda run: run.run.works[:, 1]),
)
RESIDUAL = term("residual", "residual of the energy balance", residual)
