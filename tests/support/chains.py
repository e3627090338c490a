"""Every short leg there is: chains of up to three joints, turning or sliding, their axes arranged in several
ways, with one tip or two; and posts, which have no joints. Robots that stand on them, with states.
"""

from dataclasses import dataclass, replace
from functools import cache
from itertools import cycle, product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import oracle
import parflex as pf
import zoo
from sample import Sample

WORDS = tuple("".join(letters) for n in (1, 2, 3) for letters in product("RP", repeat=n))
QUARTER = np.pi / 2
AXES = {  # the angles between each axis and the next
    "any": None,
    "parallel": (0.0, 0.0, 0.0),
    "crossed": (QUARTER, QUARTER, -QUARTER),
    "skew": (0.3, -0.8, 1.1),
}


@dataclass(frozen=True)
class Kind:
    """The letters of the joints, the arrangement of their axes, and the links that bear the tips, from 0."""

    word: str
    axes: str
    tips: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.word or 'post'}-{self.axes}-{'+'.join(map(str, self.tips))}"


def kinds() -> list[Kind]:
    """All chains with a tip at their end, or two there, or one more on the first link or on the base."""
    found = [Kind("", "any", (0,)), Kind("", "any", (0, 0))]
    for word, axes in product(WORDS, AXES):
        n = len(word)
        ends = {(n,), (n, n), (1, n), (0, n)}
        found += [Kind(word, axes, tips) for tips in sorted(ends)]
    return found


def some() -> list[Kind]:
    """Every chain once, its arrangement and its tips in turn, and the posts."""
    every = kinds()
    found = every[:2]
    for number, word in enumerate(WORDS):
        mine = [kind for kind in every if kind.word == word]
        found.append(mine[5 * number % len(mine)])
    return found


def cases(first: list[Kind], *shapes: tuple[int, int]) -> list:
    """Parameters (kind, legs, modes): the first kinds in one shape each, in turn, and all others, marked."""
    chosen = dict(zip(first, cycle(shapes), strict=False))
    found = []
    for kind, shape in product(kinds(), shapes):
        marks = () if chosen.get(kind) == shape else pytest.mark.every
        name = "{}, {} legs, {} modes".format(kind, *shape)
        found.append(pytest.param(kind, *shape, marks=marks, id=name))
    return found


def joint(rng: np.random.Generator, kind: Kind, number: int) -> pf.Joint:
    """A joint with its link, friction and a spring; of a special arrangement without offsets."""
    found = zoo.random_joint(rng, number, "RP".index(kind.word[number]))
    alphas = AXES[kind.axes]
    if alphas is None:
        return found
    return replace(found, alpha=alphas[number], gamma=0.0, theta=0.0, b=0.0, d=0.1 * number)


def leg(rng: np.random.Generator, kind: Kind, first: int) -> tuple[pf.Leg, np.ndarray]:
    """A leg of a kind that holds attachments from `first` on, and a posture."""
    joints = [joint(rng, kind, i) for i in range(len(kind.word))]
    tips = [pf.Tip(frame, rng.uniform(-0.3, 0.3, 3), first + i) for i, frame in enumerate(kind.tips)]
    q = rng.uniform(-0.5, 0.5, len(joints))
    base = Rotation.random(random_state=rng).as_matrix(), rng.uniform(-1.0, 1.0, 3)
    return pf.Leg(*base, joints, tips, posture=q), q


@cache
def sample(kind: Kind, count: int, modes: int) -> Sample:
    """A platform on so many legs of a kind, and on nothing else, with states on its closure.

    As many joints are driven as move the platform, unbent, independently.
    """
    for seed in range(30):
        try:
            found = drawn(
                np.random.default_rng([seed, count, modes, *map(ord, str(kind))]), kind, count, modes
            )
        except AssertionError:  # no state near by
            continue
        if well_posed(found):
            return found
    raise AssertionError(f"no robot on {count} {kind} was found")


def well_posed(sample: Sample) -> bool:
    """True where no singularity is near: of closure and legs, what is not zero is of order 1."""
    matrices = []
    for s, at in enumerate(sample.systems):
        free = len(at.K) - at.sizes[-1]
        closure = at.K[free:, :free]
        matrices.append(closure / np.linalg.norm(closure, axis=1, keepdims=True))
        trees = [oracle.tree(leg, q[s]) for leg, q in zip(sample.legs, sample.q, strict=True)]
        matrices += [oracle.tip_rows(leg, found[2]) for leg, found in zip(sample.legs, trees, strict=True)]
    sizes = [np.linalg.svd(a, compute_uv=False) for a in matrices if a.size]
    return all(np.min(size[size > 1e-9]) > 0.005 * size[0] for size in sizes if size[0] > 1e-9)


def drawn(rng: np.random.Generator, kind: Kind, count: int, modes: int) -> Sample:
    """A robot at random."""
    found = [leg(rng, kind, i * len(kind.tips)) for i in range(count)]
    legs, q = ([part[i] for part in found] for i in (0, 1))
    pose = rng.uniform(-0.3, 0.3, 3), Rotation.random(random_state=rng).as_matrix()
    tips = np.concatenate([oracle.tree(each, q_i)[1] for each, q_i in found])
    body, cloud = zoo.random_body(rng, (tips - pose[0]) @ pose[1], modes)
    legs, rows = zoo.well_driven(legs, zoo.stiff(cloud), pose, q)
    return zoo.sample_of(rng, legs, body, cloud, pose, q, rows, wander=0.02)
