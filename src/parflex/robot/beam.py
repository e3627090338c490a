"""Beams: round tubes and bars that bend, stretch and twist, clamped at a joint, by closed shapes."""

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import fields as parts
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from parflex.base import kinds
from parflex.base.array import Array, skew, transpose, without_roundoff
from parflex.base.check import NOT_NEGATIVE, POSITIVE
from parflex.base.errors import InputError
from parflex.base.held import Given
from parflex.base.plausible import doubt
from parflex.robot.beam_shapes import POINTS, WEIGHTS, Family, clamped, held, orthonormal, sampled
from parflex.robot.body import FlexibleBody
from parflex.robot.fields import check_fields, count, flag, given, ratios
from parflex.robot.material import Material
from parflex.robot.modal import modal_diagonals
from parflex.robot.moments import Moments
from parflex.robot.words import told

NODES = 33  # along a beam, for drawing and to be held at
MOST = (NODES - 1) // 2  # half-waves that they carry, two spaces between nodes for each


@dataclass(frozen=True, eq=False, kw_only=True)
class Beam:
    """A round tube or bar from the origin of a joint's frame to `end` (3,) m, clamped at the origin; SI.

    Its diameters `outer` and `inner`, and its material. `bending` are the shapes in each of two planes, sines
    less their tangents at the origin, of which one gives a strut between joints its first frequency, and so
    on; `static` adds those of a force and a moment at the end. `axial` and `torsion` are the linear shape,
    and sines. `damping_ratio` is one or one for each mode. `foreshortening` is what an end that bends aside
    comes nearer by: without it a compressed strut stiffens where it should soften.

    Raises InputError for no body's dimensions or material, and for more shapes than its nodes carry.
    """

    end: Given = given(kinds.LENGTH, "the other end, in the joint's frame", shape=(3,))
    outer: float = given(kinds.LENGTH, "outer diameter", POSITIVE)
    inner: float = given(kinds.LENGTH, "inner diameter of a tube", NOT_NEGATIVE, default=0.0)
    young: float = given(kinds.PRESSURE, "Young's modulus", POSITIVE)
    poisson: float = given(kinds.NUMBER, "Poisson's ratio")
    density: float = given(kinds.DENSITY, "density of the material", POSITIVE)
    bending: int = count("shapes in each of two planes", default=1)
    axial: int = count("shapes along the beam")
    torsion: int = count("shapes about the beam")
    static: bool = flag("add the bending shapes of a force and a moment at the end", default=False)
    damping_ratio: Given = ratios("one for all modes, or one for each")
    foreshortening: bool = flag("the end that bends aside comes nearer", default=True)

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.inner < self.outer:
            raise InputError(f"Beam.inner is {self.inner}; it must be less than outer, which is {self.outer}")
        if self.length == 0:
            raise InputError(f"Beam.end is {self.end.tolist()}, where the beam begins; give its other end")
        if self.outer > self.length:
            doubt(
                f"outer is {self.outer:.4g} m, of a beam that is {self.length:.4g} m long; if it is in mm, "
                f'give {self.outer / 1000:.4g} m, in files "{self.outer:.4g} mm"'
            )
        sizes = {"outer": self.outer, "end": self.length, "young": self.young, "density": self.density}
        for name, value in sizes.items():
            if not 1e-20 < value < 1e20:  # products of a few stay numbers
                raise InputError(f"Beam.{name} is {value}, of no body there is; give it in SI units")
        _ = self.material  # raises
        given, modes = self.damping_ratio.size, self.modes
        if self.damping_ratio.ndim and given != modes:
            raise InputError(
                f"Beam.damping_ratio has {given} entries; give one for all modes, or one for each of {modes}"
            )
        for name in ("bending", "axial", "torsion"):
            if getattr(self, name) > MOST:
                raise InputError(
                    f"Beam.{name} is {getattr(self, name)}, but the {NODES} nodes of a beam carry {MOST} "
                    f"shapes of a kind, two spaces for each half-wave; give {MOST} or fewer"
                )

    __repr__ = told

    @property
    def modes(self) -> int:
        """N, the number of modes."""
        return 2 * (self.bending + 2 * self.static) + self.axial + self.torsion

    @cached_property
    def material(self) -> Material:
        """Its material; raises InputError for one that cannot be."""
        return Material(self.young, self.poisson, self.density)

    @cached_property
    def length(self) -> float:
        """ℓ, m."""
        return float(np.linalg.norm(self.end))

    @cached_property
    def section(self) -> tuple[float, float]:
        """The area A (m²) and the second moment I (m⁴) about a diameter; the polar one is 2 I."""
        squares = self.outer**2 - self.inner**2
        return np.pi / 4 * squares, np.pi / 64 * squares * (self.outer**2 + self.inner**2)

    @cached_property
    def axes(self) -> tuple[Array, Array, Array]:
        """Unit vectors (3,): t along the beam, u and v across it, u in the plane of t and that axis of the
        frame which is most across."""
        t = np.asarray(self.end) / self.length
        across = np.eye(3)[int(np.argmin(np.abs(t)))]
        u = across - (across @ t) * t
        u = u / np.linalg.norm(u)
        return t, u, np.cross(t, u)

    @property
    def body(self) -> "BeamBody":
        """The flexible body."""
        modes = modes_of(self)
        phi, psi = fields(self, modes, POINTS)
        at = np.linspace(0.0, 1.0, NODES)
        moments = moments_of(self, phi, psi)
        stiffness, damping = modal_diagonals(moments, modes.omega, self.damping_ratio)
        shapes, turns = fields(self, modes, at)
        return BeamBody(
            moments,
            without_roundoff(at[:, None] * self.end),
            shapes,
            turns,
            stiffness,
            damping,
            (NODES - 1,),
            foreshortening=shortening_of(self, psi)[None] if self.foreshortening else None,
            beam=self,
        )


@dataclass(frozen=True, eq=False, repr=False)
class BeamBody(FlexibleBody):
    """The body that a beam is, and the beam whose body it was when it was made.

    The shapes are those of the beam `basis`, by default the same: parameters that change a section keep them.
    """

    beam: Beam | None = None
    basis: Beam | None = None

    def with_payload(self, node: int, mass: float) -> FlexibleBody:
        return self.plain.with_payload(node, mass)

    def with_modes(self, modes: Sequence[int]) -> FlexibleBody:
        return self.plain.with_modes(modes)

    @property
    def plain(self) -> FlexibleBody:
        """The same body as one that is no beam, of which a mode or a mass may differ."""
        return FlexibleBody(**{each.name: getattr(self, each.name) for each in parts(FlexibleBody)})


def beam(
    end: ArrayLike,
    outer: float,
    inner: float = 0.0,
    *,
    young: float,
    poisson: float,
    density: float,
    bending: int = 1,
    axial: int = 0,
    torsion: int = 0,
    static: bool = False,
    damping_ratio: ArrayLike = 0.0,
    foreshortening: bool = True,
) -> FlexibleBody:
    """A round tube or bar from the origin of a joint's frame to `end`, as a flexible link: a `Joint`'s body.

    It is clamped at the origin and has one attachment, at its end. Its modes are `bending` ones in each of
    two planes across it, one by one in both, with `static` two more in each, then the `axial` ones, then
    those of `torsion`; `Beam` says what they are. Its integrals are exact, with those of the section, which
    turns.

    end (3,) m, diameters outer and inner m, young Pa, density kg/m³, damping_ratio one or one for each mode.

    Raises InputError as `Beam`.

    >>> rod = beam((0, 0, 0.62), 0.032, young=205e9, poisson=0.29, density=7850, bending=1, axial=1)
    >>> rod
    FlexibleBody: 3.914 kg, 3 modes, 88.2 … 2.27e+03 Hz, 1 attachment
    """
    made = Beam(
        end=end,
        outer=outer,
        inner=inner,
        young=young,
        poisson=poisson,
        density=density,
        bending=bending,
        axial=axial,
        torsion=torsion,
        static=static,
        damping_ratio=damping_ratio,
        foreshortening=foreshortening,
    )
    return made.body


class BeamModes(NamedTuple):
    """Combinations (n, n) of the shapes of bending in a plane, along and about a beam, and the frequencies
    (N,) rad/s of all modes, clamped at the origin."""

    bending: Array
    axial: Array
    torsion: Array
    omega: Array


def families(beam: Beam, xi: Array) -> tuple[Family, Family, Family]:
    """The shapes of bending in a plane, along and about a beam, at ξ (P,)."""
    return clamped(xi, beam.bending, beam.static), held(xi, beam.axial), held(xi, beam.torsion)


def modes_of(beam: Beam) -> BeamModes:
    """The modes, by the energies of bending ½∫ρA ẇ² + ρI ẇ'² and ½∫EI w''², of stretching ½∫ρA u̇² and
    ½∫EA u'², of twisting ½∫ρ 2I θ̇² and ½∫G 2I θ'²."""
    (A, second), length, rho, E = beam.section, beam.length, beam.density, beam.young
    polar, G = 2 * second, beam.material.lame[1]
    w, u, theta = families(beam, POINTS)
    bent = orthonormal(
        sampled((rho * A * length, w.value), (rho * second / length, w.first)),
        sampled((E * second / length**3, w.second)),
    )
    along = orthonormal(sampled((rho * A * length, u.value)), sampled((E * A / length, u.first)))
    about = orthonormal(
        sampled((rho * polar * length, theta.value)), sampled((G * polar / length, theta.first))
    )
    return BeamModes(bent[0], along[0], about[0], np.concatenate([np.repeat(bent[1], 2), along[1], about[1]]))


def fields(beam: Beam, modes: BeamModes, xi: Array) -> tuple[Array, Array]:
    """Displacements φ and rotations ψ (N, P, 3) of the sections at ξ (P,): ψ = w' t × d where they move by
    w along d."""
    t, u, v = beam.axes
    bent, along, about = families(beam, xi)
    w, slope = modes.bending.T @ bent.value, modes.bending.T @ bent.first / beam.length
    across = np.stack([u, v])
    turned = np.stack([v, -u])  # t × u, t × v
    phi = (w[:, None, :, None] * across[:, None]).reshape(-1, len(xi), 3)
    psi = (slope[:, None, :, None] * turned[:, None]).reshape(-1, len(xi), 3)
    pulled = (modes.axial.T @ along.value)[..., None] * t
    twisted = (modes.torsion.T @ about.value)[..., None] * t
    return np.concatenate([phi, pulled, 0 * twisted]), np.concatenate([psi, 0 * pulled, twisted])


def moments_of(beam: Beam, phi: Array, psi: Array) -> Moments:
    """The integrals of a body whose sections are displaced by φ and turned by ψ (N, P, 3) at the Gauss
    points, Φ = φ + ψ × ρ with ∫ ρ dA = 0 and ∫ ρ ρᵀ dA = I (1 − t tᵀ)."""
    A, second = beam.section
    by_area, by_second = moments_by_section(beam, phi, psi)
    return weighed(by_area, by_second, beam.density * A, beam.density * second)


def moments_by_section(beam: Beam, phi: Array, psi: Array) -> tuple[Moments, Moments]:
    """The integrals per ρ A and per ρ I, which do not depend on the section."""
    t, length = beam.axes[0], beam.length
    across = np.eye(3) - np.outer(t, t)
    ds, r, turns = length * WEIGHTS, length * POINTS[:, None] * t, skew(psi)
    by_area = Moments(
        m=length,
        MS0=length**2 / 2 * t,
        P0=length**3 / 3 * np.outer(t, t),
        S=np.einsum("p,npa->an", ds, phi),
        P1=np.einsum("p,npa,pb->nab", ds, phi, r),
        P2=np.einsum("p,npa,jpb->njab", ds, phi, phi, optimize=True),
    )
    by_second = Moments(
        m=0.0,
        MS0=np.zeros(3),
        P0=length * across,
        S=0.0 * by_area.S,
        P1=np.einsum("p,npab->nab", ds, turns) @ across,
        P2=np.einsum("p,npab,bc,jpdc->njad", ds, turns, across, turns, optimize=True),
    )
    return by_area, by_second


def weighed(by_area: Moments, by_second: Moments, line: Any, turning: Any) -> Moments:
    """The integrals of a beam of ρ A = line (kg/m) and ρ I = turning (kg m), numbers or symbols."""
    return Moments._make(line * a + turning * b for a, b in zip(by_area, by_second, strict=True))


def shortening_of(beam: Beam, psi: Array) -> Array:
    """H (3, N, N) of the end: −t ∫ φ_k'·φ_l' ds across the beam, whose slopes are as large as the turns ψ
    across it."""
    t = beam.axes[0]
    across = psi - (psi @ t)[..., None] * t
    drawn = np.einsum("p,kpa,lpa->kl", beam.length * WEIGHTS, across, across, optimize=True)
    return -t[:, None, None] * (0.5 * (drawn + transpose(drawn)))
