"""Moves: the stretches that trajectories are composed of, one file each."""

from parflex.simulation.moves.circle import Circle as Circle
from parflex.simulation.moves.hold import Hold as Hold
from parflex.simulation.moves.move import Move as Move
from parflex.simulation.moves.move import Pose as Pose
from parflex.simulation.moves.move_to import MoveTo as MoveTo

ALL_MOVES: tuple[type[Move], ...] = (MoveTo, Hold, Circle)
