"""The surface of a mesh, as triangles."""

from collections.abc import Iterable

import numpy as np

from parflex.base.array import Array
from parflex.fe.body.elements import ELEMENTS


def surface(parts: Iterable[tuple[str, Array, *tuple[Array, ...]]]) -> Array:
    """Triangles (T, 3) of shells, and of the faces of solids that have no neighbour.

    Each part is the kind of its elements and their nodes (E, n), whatever follows.
    """
    found, faces = [np.zeros((0, 3), dtype=int)], []
    for kind, nodes, *_ in parts:
        element = ELEMENTS[kind]
        for corners, middles in zip(element.faces, element.sides, strict=True):
            face = nodes[:, [*corners, *middles]]
            if len(element.faces) == 1:
                found.append(cut_in_triangles(face, len(corners)))
            else:
                faces.append((face, len(corners)))
    lone = without_neighbour([face[:, :count] for face, count in faces])
    found += [cut_in_triangles(face[alone], count) for (face, count), alone in zip(faces, lone, strict=True)]
    return np.concatenate(found)


def without_neighbour(faces: list[Array]) -> list[Array]:
    """The faces (F, 3 or 4) of each group that share their corners with no other; (F,) bool each."""
    if not faces:
        return []
    keys = [np.sort(np.pad(face, ((0, 0), (0, 4 - face.shape[1])), constant_values=-1)) for face in faces]
    _, inverse, count = np.unique(np.concatenate(keys), axis=0, return_inverse=True, return_counts=True)
    return np.split((count == 1)[inverse.ravel()], np.cumsum([len(face) for face in faces])[:-1])


def cut_in_triangles(face: Array, corners: int) -> Array:
    """The triangles of faces (F, 3 or 4 corners, then as many middles or none), those of a face together."""
    middles = np.arange(corners, face.shape[1])
    if len(middles) == 0:
        return face[:, [(0, k, k + 1) for k in range(1, corners - 1)]].reshape(-1, 3)
    tips = [(middles[k - 1], k, middles[k]) for k in range(corners)]
    tips += [(middles[0], middles[k], middles[k + 1]) for k in range(1, corners - 1)]
    return face[:, tips].reshape(-1, 3)
