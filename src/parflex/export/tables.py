"""The meaning of every entry of the exported arrays: rows (entries, words) for the header and the README."""

from parflex.export.interface import tips
from parflex.mechanics.mechanism import Mechanism
from parflex.mechanics.output import Output, PlatformOutput, PointOutput
from parflex.robot.joint_words import driven
from parflex.robot.leg import Joint

Rows = list[tuple[str, str]]

MACROS = {  # names of lengths, and the arrays that have them
    "STATE": ("x", "xd", "projected"),
    "FORCES": ("u", "preload"),
    "LOADS": ("w",),
    "TARGET": ("target",),
    "TWIST": ("Vd",),
    "MODES": ("qdd_e",),
    "CONTACTS": ("f",),
    "GAIN": ("gain",),
    "POWERS": ("powers",),
    "HEALTH": ("health",),
}
COMPONENTS = ("x", "y", "z", "about x", "about y", "about z")


def state_parts(mechanism: Mechanism) -> dict[str, tuple[int, int]]:
    """The parts of the state, with the place where each begins and its length."""
    at = mechanism.layout.at._asdict()
    return {name.upper(): (part.start, part.stop - part.start) for name, part in at.items()}


def state(mechanism: Mechanism) -> Rows:
    """The entries of x."""
    at = state_parts(mechanism)
    modes = at["ELASTIC"]
    rows = [
        span("x", 0, 3, "position of the platform's origin, in world axes, m"),
        span("x", 3, 4, "quaternion w x y z that turns platform into world components, of any length but 0"),
        span("x", 7, 3, "velocity of the platform's origin, m/s"),
        span("x", 10, 3, "angular velocity of the platform, rad/s"),
        span("x", *modes, "modal coordinates q_e of the platform, kg^1/2 m"),
        span("x", *at["ELASTIC_RATE"], "their rates, kg^1/2 m/s"),
    ]
    legs = zip(mechanism.robot.legs, *mechanism.layout.by_leg, strict=True)
    for number, (leg, joints, elastic) in enumerate(legs, start=1):
        units = ", ".join(unit(joint, "rad", "m") for joint in leg.joints)
        rows += carried(
            at, joints, f"joints of leg {number}: {units}", f"their rates, joints of leg {number}"
        )
        bodies = ", ".join(f"{count} of link {j}" for j, count in enumerate(leg.modes, start=1) if count)
        bent = slice(elastic.start, elastic.start + sum(leg.modes))
        rows += carried(
            at,
            bent,
            f"modal coordinates of leg {number}, kg^1/2 m: {bodies}",
            f"their rates, modal coordinates of leg {number}, kg^1/2 m/s",
        )
        units = ", ".join(f"joint {j + 1}, {unit(leg.joints[j], 'rad', 'm')}" for j in leg.drives)
        rows += carried(
            at,
            slice(bent.stop, elastic.stop),
            f"deflections of drives of leg {number}, link less motor: {units}",
            f"their rates, drives of leg {number}",
        )
    for i, number in enumerate(mechanism.layout.branched):
        rows.append((f"x[{at['BRANCHES'][0] + i}]", f"assembly branch of leg {number + 1}, +1 or -1"))
    return [row for row in rows if row[0]]


def carried(at: dict[str, tuple[int, int]], place: slice, words: str, of_rates: str) -> Rows:
    """Rows for coordinates of a leg at a place among all that are carried, and for their rates."""
    count = place.stop - place.start
    return [
        span("x", at["JOINTS"][0] + place.start, count, words),
        span("x", at["JOINT_RATES"][0] + place.start, count, of_rates),
    ]


def actuators(mechanism: Mechanism) -> Rows:
    """The entries of u."""
    return [
        (f"u[{k}]", f"leg {number}, joint {j}: {unit(joint, 'N m', 'N')}")
        for k, (number, j, joint) in enumerate(driven(mechanism.robot))
    ]


def inputs(mechanism: Mechanism, output: Output) -> Rows:
    """All inputs."""
    N = mechanism.platform.modes
    rows = [*state(mechanism), *actuators(mechanism)]
    rows += [
        span("w", 0, 3, "force of loads on the platform, N; w NULL: no loads"),
        span("w", 3, 3, "their moment about the platform's origin, N m"),
        span(
            "w", 6, N, "their modal forces, Phi^T F for a force F where the modes have the shapes Phi (3 x N)"
        ),
        span("target", 0, output.size, target(output)),
        span("preload", 0, mechanism.n_forces, "forces that u is to be near to, units as in u; NULL: zero"),
    ]
    return [row for row in rows if row[0]]


def target(output: Output) -> str:
    """The accelerations that the inverse model prescribes."""
    if not isinstance(output, PlatformOutput):
        return "accelerations of actuated joints, in the order of u, m/s^2 or rad/s^2"
    rows = ", ".join(COMPONENTS[row] for row in output.axes)
    where = "the platform's frame"
    if isinstance(output, PointOutput):
        where = f"the point at {tuple(output.offset)} m from node {output.node}"
    return f"acceleration of {where}, in platform axes, m/s^2 or rad/s^2: {rows}"


def outputs(mechanism: Mechanism, output: Output) -> Rows:
    """All outputs but those that are laid out as inputs."""
    m, parts = mechanism.n_forces, state_parts(mechanism)
    rows = [
        span("Vd", 0, 3, "acceleration of the platform's origin, m/s^2 (not the rate of x[7 .. 9])"),
        span("Vd", 3, 3, "angular acceleration, rad/s^2"),
        span("qdd_e", 0, parts["ELASTIC"][1], "modal accelerations, kg^1/2 m/s^2"),
    ]
    rows += [
        span("f", 3 * t, 3, f"force of leg {leg + 1} on the platform at attachment {held}, N")
        for t, (leg, held) in enumerate(tips(mechanism.robot))
    ]
    rows += [
        (f"gain[{m} i + j]", "change of target[i] with u[j]; singular where no forces give the target"),
        ("xd", "derivative of x in time, laid out as x"),
        span("powers", 0, 1, "power of the actuators, W"),
        span("powers", 1, 1, "power of the loads, W"),
        span("powers", 2, 1, "power lost by damping and friction, W"),
        *health(mechanism),
        ("projected", "state nearer to the closure, laid out as x"),
    ]
    return [row for row in rows if row[0]]


def health(mechanism: Mechanism) -> Rows:
    """The entries of health."""
    at = mechanism.health
    count, soft, gaps = len(mechanism.legs), len(at.open_legs), len(at.gap_legs)
    after = 2 * count + soft
    tip_gap = "gap between each tip of the legs and its attachment, x y z, m; small on the closure"
    rows = [
        span("health", 0, count, "reach of each leg: of order 1, not positive beyond it"),
        span("health", count, count, "regularity of each leg: of order 1, zero where it is singular"),
        span("health", 2 * count, soft, "of each flexure: not positive within 5 degrees of half a turn"),
        span("health", after, gaps, tip_gap),
        span("health", after + gaps, gaps, "rates of these gaps, m/s"),
    ]
    return [row for row in rows if row[0]]


def span(name: str, start: int, count: int, words: str) -> tuple[str, str]:
    """A row for consecutive entries; without a name where there are none."""
    if count == 0:
        return "", words
    last = "" if count == 1 else f" .. {start + count - 1}"
    return f"{name}[{start}{last}]", words


def unit(joint: Joint, turning: str, sliding: str) -> str:
    """The unit that goes with the kind of a joint."""
    return sliding if joint.sigma else turning
