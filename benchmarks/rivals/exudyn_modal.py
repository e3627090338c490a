"""Flexible bodies of Exudyn: floating frames with modes, whose integrals it makes itself of point masses."""

from typing import NamedTuple

import exudyn as exu
import numpy as np
from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface
from scipy.sparse import csr_matrix, diags


class Modal(NamedTuple):
    """The numbers of a body, of the node of its frame, and of the node of its modes."""

    body: int
    frame: int
    modes: int


class Cloud(NamedTuple):
    """Point masses of a body, some of them zero, and its modes, in the axes of its frame."""

    positions: np.ndarray  # (K, 3)
    masses: np.ndarray  # (K,)
    shapes: np.ndarray  # (K, 3, N)
    stiffness: np.ndarray  # (N,)
    damping: np.ndarray  # (N,)


def add_modal(mbs, cloud: Cloud, gravity) -> Modal:
    """An `ObjectFFRFreducedOrder` of a cloud; its mesh nodes are the cloud's points."""
    fem = FEMinterface()
    fem.nodes = {"Position": np.asarray(cloud.positions)}
    fem.modeBasis = {"matrix": cloud.shapes.reshape(-1, len(cloud.stiffness)), "type": "NormalModes"}
    masses = np.repeat(cloud.masses, 3)
    fem.massMatrix, fem.stiffnessMatrix = diags(masses).tocsr(), csr_matrix((len(masses),) * 2)
    fem.surface = []
    made = ObjectFFRFreducedOrderInterface(fem)
    made.stiffnessMatrixReduced = np.diag(cloud.stiffness)
    numbers = made.AddObjectFFRFreducedOrder(mbs, gravity=gravity)
    body = numbers["oFFRFreducedOrder"]
    damping = exu.MatrixContainer()
    damping.SetWithDenseMatrix(np.diag(cloud.damping), useDenseMatrix=False)
    mbs.SetObjectParameter(body, "dampingMatrixReduced", damping)
    return Modal(body, numbers["nRigidBody"], numbers["nGenericODE2"])
