"""The robot at home as its motors hold it: on their springs, locked, or by the legs' servos."""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from parflex.linear.system import LinearModel
    from parflex.model.model import Model

MOTORS = ("auto", "locked", "springs", "servo")
WORDS = {
    "springs": "on its motors' springs",
    "locked": "on locked motors",
    "servo": "on its legs' servos",
}
SWINGS = 1e-3  # of the real part of a pole: an imaginary part that is more than round-off


def held(model: "Model", motors: str) -> tuple[str, "LinearModel"]:
    """The words for how the motors hold the robot, and its linear system about the equilibrium at home.

    "auto" takes the motors' springs where all have one, else locks them, and takes the servos where nothing
    can move then.
    """
    if motors == "auto":
        sprung = [joint.k > 0 for leg in model.robot.legs for joint in leg.joints if joint.mu]
        found = held(model, "springs" if sprung and all(sprung) else "locked")
        return found if len(found[1].A) else held(model, "servo")
    state, forces = model.equilibrium(*model.robot.home_pose)
    controller: Any = None if motors == "springs" else "locked"
    if motors == "servo":
        from parflex.simulation.laws.servo import Servo
        from parflex.simulation.moves.hold import Hold
        from parflex.simulation.trajectory import Trajectory

        controller = Servo(model, Trajectory.of(model.robot.home, [Hold(1.0)]))
    return WORDS[motors], model.linearise(state, forces, controller=controller)


def swinging(modes: Any) -> Any:
    """The numbers, from 0, of the modes that swing, of the Dataset of `LinearModel.modes`."""
    return np.flatnonzero(modes.pole_imag.values > SWINGS * np.abs(modes.pole_real.values))


def growth(modes: Any) -> float:
    """The largest rate of growth, 1/s; zero where none is more than round-off."""
    largest = float(np.max(modes.growth.values, initial=0.0))
    roundoff = 1e-6 * 2 * np.pi * float(np.max(modes.frequency.values, initial=0.0))
    return largest if largest > roundoff else 0.0


def row_of(modes: Any, i: int) -> tuple[str, ...]:
    """Number, frequency in Hz, damping in percent and shares of energy of a mode, in words."""
    mode = modes.isel(mode=i)
    shares = (f"{round(100 * share)} %" if np.isfinite(share) else "" for share in mode.share.values)
    return (str(int(mode.mode)), f"{float(mode.frequency):.5g}", f"{100 * float(mode.damping):.3g}", *shares)
