"""Robots that are not in any book, each with states on its closure: random trees, many legs, spare actuators,
rods that repeat what others say, legs with a mind of their own."""

from dataclasses import replace
from functools import cache

import numpy as np
from scipy.linalg import block_diag, qr
from scipy.spatial.transform import Rotation

import cases
import oracle
import parflex as pf
from paper_robot import PLATE, corners, links
from sample import Sample

STATES = 4


# --- platforms ---


def random_body(
    rng: np.random.Generator, points: np.ndarray, modes: int, size: float = 0.5
) -> tuple[pf.FlexibleBody, oracle.NodalPlatform]:
    """A nodal body without symmetry, held at `points` (k, 3), and the same for the oracle."""
    nodes = max(40, modes)
    positions = np.concatenate([points, rng.uniform(-size, size, (nodes, 3))])
    masses = rng.uniform(0.2, 1.0, len(positions))
    orthogonal = np.linalg.qr(rng.standard_normal((masses.size * 3, modes)))[0]
    shapes = orthogonal.T.reshape(modes, len(masses), 3) / np.sqrt(masses)[:, None]  # ΦᵀMΦ = 1
    frequencies, damping_ratio = np.sort(rng.uniform(60.0, 600.0, modes)), rng.uniform(0.01, 0.1, modes)
    given = positions, masses, shapes, frequencies, damping_ratio, range(len(points))
    return pf.FlexibleBody.from_nodes(*given), oracle.nodal_platform(*given)


def stiff(cloud: oracle.NodalPlatform) -> oracle.NodalPlatform:
    """The cloud as if it could not bend."""
    none = cloud.stiffness[:0]
    held = cloud.attachment_shapes[..., :0]
    return replace(cloud, shapes=cloud.shapes[:0], stiffness=none, damping=none, attachment_shapes=held)


# --- states on the closure ---


def on_closure(legs, cloud, state: pf.State, q: list, qd: list) -> tuple[pf.State, list, list]:
    """The state nearest to a guess whose tips meet: Newton for the places, a projection for the rates."""
    held = [tip.attachment for leg in legs for tip in leg.tips]
    points = cloud.attachments[held], cloud.attachment_shapes[held]
    size = [3, 3, len(cloud.stiffness), *map(len, q)]
    weight = np.repeat([1.0, 1.0, 1e-2, *np.ones(len(q))], size)  # the platform bends reluctantly

    def closure():
        trees = [oracle.tree(leg, q_i) for leg, q_i in zip(legs, q, strict=True)]
        places, _, W, _ = cloud.point_motion(state, *points)
        J = block_diag(*(oracle.tip_rows(leg, J) for leg, (_, _, J) in zip(legs, trees, strict=True)))
        tips = np.concatenate([tips for _, tips, _ in trees])
        return (places - tips).ravel(), np.hstack([-W.reshape(W.shape[0] * 3, -1), J]) * weight

    for _ in range(30):
        gap, G = closure()
        step = weight * np.linalg.lstsq(G, gap, rcond=1e-9)[0]
        dp, turn, bend, *dq = np.split(step, np.cumsum(size)[:-1])
        rotation = Rotation.from_rotvec(turn).as_matrix() @ state.rotation
        state = replace(state, position=state.position + dp, rotation=rotation, elastic=state.elastic + bend)
        q = [a + b for a, b in zip(q, dq, strict=True)]
        if np.max(np.abs(step)) < 1e-15:
            break
    gap, G = closure()
    assert np.max(np.abs(gap)) < 1e-13, "this guess leads to no state of the robot"
    R = np.asarray(state.rotation)
    world = (np.reshape(state.twist, (2, 3)) @ R.T).ravel()
    rates = np.concatenate([world, state.elastic_rate, *qd]) / weight
    rates = weight * (rates - np.linalg.lstsq(G, G @ rates, rcond=1e-9)[0])
    twist, bending, *qd = np.split(rates, np.cumsum([6, *size[2:]])[:-1])
    twist = (twist.reshape(2, 3) @ R).ravel()
    return replace(state, twist=twist, elastic_rate=bending), q, qd


def sample_of(rng, legs, body, cloud, pose, q, rows=None, wander=0.05, gravity=(1.0, -2.0, -9.0)) -> Sample:
    """A sample of states about (pose, q), at random rates, with random forces and targets."""
    modes = body.modes
    softer = 60.0 / np.sqrt(cloud.stiffness)
    found = []
    for _ in range(STATES):
        turn = Rotation.from_rotvec(rng.uniform(-wander, wander, 3)).as_matrix()
        guess = pf.State(
            pose[0] + rng.uniform(-wander, wander, 3),
            pose[1] @ turn,
            rng.normal(0.0, 0.5, 6),
            0.01 * softer**2 * rng.standard_normal(modes),
            0.1 * softer * rng.standard_normal(modes),
        )
        near = [q_i + rng.uniform(-wander, wander, len(q_i)) for q_i in q]
        found.append(on_closure(legs, cloud, guess, near, [rng.normal(0.0, 0.5, len(q_i)) for q_i in q]))
    states, joints, rates = zip(*found, strict=True)
    fields = ("position", "rotation", "twist", "elastic", "elastic_rate")
    m = sum(joint.mu for leg in legs for joint in leg.joints)
    rows = tuple(range(6)) if rows is None else rows
    return Sample(
        legs=tuple(legs),
        body=body,
        cloud=cloud,
        gravity=np.array(gravity),
        home_pose=pose,
        platform=pf.State(*(np.array([getattr(s, name) for s in states]) for name in fields)),
        q=[np.array(leg) for leg in zip(*joints, strict=True)],
        qd=[np.array(leg) for leg in zip(*rates, strict=True)],
        forces=rng.uniform(-100.0, 100.0, (STATES, m)),
        target=rng.uniform(-2.0, 2.0, (STATES, len(rows))),
        rows=rows,
    )


# --- legs ---


def random_joint(rng: np.random.Generator, antecedent: int, sigma: int, reach: float = 0.3) -> pf.Joint:
    """A row of any angles and lengths, a link of eight masses, a rotor, friction and a spring."""
    angles = dict(zip(("gamma", "alpha", "theta"), rng.uniform(-np.pi, np.pi, 3), strict=True))
    lengths = dict(zip(("b", "d", "r"), rng.uniform(-reach, reach, 3), strict=True))
    m, p = rng.uniform(0.05, 0.4, 8), rng.uniform(-reach, reach, (8, 3))
    second = np.einsum("p,pa,pb->ab", m, p, p)
    return pf.Joint(
        antecedent,
        sigma,
        **angles,
        **lengths,
        M=np.sum(m),
        MS=m @ p,
        I=np.trace(second) * np.eye(3) - second,
        IA=rng.uniform(0.0, 0.1),
        **joint_loads(rng),
    )


def joint_loads(rng: np.random.Generator) -> dict[str, float]:
    """Friction and a spring of a joint."""
    return {
        "Fv": rng.uniform(0.0, 3.0),
        "Fs": rng.uniform(0.0, 5.0),
        "v_s": rng.uniform(0.01, 0.1),
        "k": rng.uniform(0.0, 20.0),
        "q_0": rng.uniform(-0.3, 0.3),
    }


def random_tree(rng: np.random.Generator, joints: int, tips: int, first: int) -> tuple[pf.Leg, np.ndarray]:
    """A leg on random branches that its tips (attachments from `first` on) move with, and a good posture:
    no end without a tip, and the tips' places give the joints."""
    while True:
        antecedents = [int(rng.integers(0, j + 1)) for j in range(joints)]
        antecedents[0] = 0
        ends = sorted(set(range(1, joints + 1)) - set(antecedents))
        if len(ends) > tips:
            continue
        frames = ends + [int(rng.integers(1, joints + 1)) for _ in range(tips - len(ends))]
        rows = tuple(random_joint(rng, a, int(rng.random() < 0.25)) for a in antecedents)
        held = [pf.Tip(f, rng.uniform(-0.3, 0.3, 3), first + i) for i, f in enumerate(frames)]
        q = rng.uniform(-0.5, 0.5, joints)
        base = Rotation.random(random_state=rng).as_matrix(), rng.uniform(-1.0, 1.0, 3)
        leg = pf.Leg(*base, rows, tuple(held), posture=q)
        sizes = np.linalg.svd(oracle.tip_rows(leg, oracle.tree(leg, q)[2]), compute_uv=False)
        if sizes[-1] > 0.05 * sizes[0]:
            return leg, q


# --- robots ---


@cache
def odd(seed: int, modes: int) -> Sample:
    """Three to five legs, random trees of 3 to 7 joints with one to three tips, on a random platform.

    Together the legs leave the platform at least three freedoms; as many joints as there are freedoms are
    actuated, and as many rows of V̇_p prescribed, chosen so that the inverse model is well posed.
    """
    rng = np.random.default_rng(seed)
    legs, q, taken = [], [], 0
    for _ in range(rng.integers(3, 6)):
        joints = int(rng.choice([n for n in range(3, 8) if taken + -n % 3 <= 3]))
        taken += -joints % 3
        first = sum(len(leg.tips) for leg in legs)
        leg, posture = random_tree(rng, joints, -(-joints // 3), first)
        legs.append(leg)
        q.append(posture)
    pose = rng.uniform(-0.3, 0.3, 3), Rotation.random(random_state=rng).as_matrix()
    tips = np.concatenate([oracle.tree(leg, q_i)[1] for leg, q_i in zip(legs, q, strict=True)])
    body, cloud = random_body(rng, (tips - pose[0]) @ pose[1], modes)
    legs, rows = well_driven(legs, cloud, pose, q, freedoms=6 - taken)
    return sample_of(rng, legs, body, cloud, pose, q, rows)


def well_driven(legs, cloud, pose, q, freedoms=None):
    """The legs with as many actuators as freedoms, by default as many as move the platform well, and the rows
    of V̇_p that these move best (pivoted QR)."""
    all_driven = [replace(leg, joints=tuple(replace(j, mu=1) for j in leg.joints)) for leg in legs]
    everything = Sample(all_driven, None, None, np.zeros(3), pose, None, q, None, None, None)
    at = oracle.system(everything, cloud, pf.State(*pose), start=q)
    gain = np.linalg.lstsq(at.K, at.S, rcond=1e-12)[0][:6]
    gain = np.kron(np.eye(2), at.R.T) @ gain
    if freedoms is None:
        sizes = np.linalg.svd(gain, compute_uv=False)
        freedoms = int(np.sum(sizes > max(1e-6, 1e-2 * np.max(sizes, initial=0.0))))
    if not freedoms:
        return legs, ()
    chosen = qr(gain, pivoting=True)[2][:freedoms]
    rows = tuple(sorted(int(i) for i in qr(gain[:, chosen].T, pivoting=True)[2][:freedoms]))
    numbers = np.split(np.arange(gain.shape[1]), np.cumsum([len(leg.joints) for leg in legs])[:-1])
    driven = [
        replace(
            leg, joints=tuple(replace(j, mu=int(n in chosen)) for j, n in zip(leg.joints, mine, strict=True))
        )
        for leg, mine in zip(legs, numbers, strict=True)
    ]
    return driven, rows


@cache
def paper() -> Sample:
    """The paper's robot with a rigid plate, its links physical ones."""
    robot = pf.robots.gough_stewart(0)
    legs = [replace(leg, joints=physical(leg.joints)) for leg in robot.legs]
    place, axes = robot.home_pose
    q = [
        oracle.ups_start(leg, place + robot.platform.attachment_points[None, i]) for i, leg in enumerate(legs)
    ]
    cloud = oracle.plate_cloud(corners(), **PLATE, n_modes=0)
    return sample_of(np.random.default_rng(6), legs, robot.platform, cloud, (np.array(place), axes), q)


def physical(joints: tuple[pf.Joint, ...]) -> tuple[pf.Joint, ...]:
    """The paper's links as bodies that can be built, and that move as Table 3's grouped parameters do.

    Link 1 turns about a fixed axis, the origin of link 2 stands still, links 2 and 3 turn together: XX1, YY1
    and M2 are of no account, and 0.75 kg m² may move from XX2, ZZ2 to XX3, YY3 (y3 = z2).
    """
    first, second, third = joints
    moved = 0.75
    return (
        replace(first, I=first.I + np.diag([5.11, 5.11, 0.0])),
        replace(second, M=400.0, I=second.I - np.diag([moved, 0.0, moved])),
        replace(third, I=third.I + np.diag([moved, moved, 0.0])),
    )


@cache
def ups(count: int, modes: int, loads: bool = False, limber: bool = False) -> Sample:
    """So many of the paper's U-P-S legs under a random platform; more than six are spare actuators.

    `loads` gives every joint friction and a spring. A `limber` robot has two more joints, of a random kind,
    below its last leg: it can move while the platform stands still.
    """
    rng = np.random.default_rng(count + modes)
    around = 2 * np.pi * np.arange(count) / count + rng.uniform(-0.2, 0.2, count)
    below = np.stack([np.cos(around), np.sin(around), 0 * around], axis=-1)
    feet = below * rng.uniform(0.6, 1.0, (count, 1))
    ahead = around + 0.6 * (-1.0) ** np.arange(count)  # in pairs: a regular ring on another is singular
    points = np.stack([np.cos(ahead), np.sin(ahead), 0 * around], axis=-1)
    points = 0.5 * points + rng.uniform(-0.1, 0.1, (count, 3))
    pose = np.array([0.0, 0.0, 1.0]), np.eye(3)
    legs, q = [], []
    for i in range(count):
        joints = [replace(j, **joint_loads(rng)) if loads else j for j in physical(links())]
        turn = Rotation.from_euler("z", around[i]).as_matrix()
        leg = pf.Leg(turn, feet[i], joints, (pf.Tip(3, attachment=i),))
        start = oracle.ups_start(leg, pose[0] + points[None, i])
        if limber and i == count - 1:
            leg = on_two_more_joints(rng, leg)
            start = np.concatenate([np.zeros(2), start])
        legs.append(replace(leg, posture=start))
        q.append(start)
    return sample_of(rng, legs, *random_body(rng, points, modes), pose, q)


def on_two_more_joints(rng: np.random.Generator, leg: pf.Leg) -> pf.Leg:
    """The leg on two turning links whose frames, at q = 0, are that of its base."""
    below = [replace(random_joint(rng, a, 0), gamma=0, b=0, d=0, r=0, theta=0, alpha=0) for a in (0, 1)]
    below = [replace(below[0], alpha=0.5), replace(below[1], alpha=-0.5)]
    above = [replace(joint, antecedent=joint.antecedent + 2) for joint in leg.joints]
    tips = [replace(tip, frame=tip.frame + 2) for tip in leg.tips]
    return replace(leg, joints=(*below, *above), tips=tuple(tips))


@cache
def three_rods() -> Sample:
    """The rigid Delta with a third rod in the middle of each parallelogram: 27 closure rows, of rank 24.

    The third rod moves as the second one, so that the states of the Delta are its states.
    """
    delta = cases.case("delta3", "rigid")
    legs, points = [], []
    for i, leg in enumerate(delta.legs):
        first, second = leg.joints[3:]
        joints = (*leg.joints, replace(first, b=0.0), replace(second, antecedent=6))
        tips = [replace(tip, attachment=3 * i + n) for n, tip in enumerate(leg.tips)]
        tips.append(pf.Tip(7, leg.tips[1].offset, 3 * i + 2))
        outer = delta.cloud.attachments[[tip.attachment for tip in leg.tips]]
        points += [*outer, outer.mean(axis=0)]
        posture = np.concatenate([leg.posture, leg.posture[3:]])
        legs.append(replace(leg, joints=joints, tips=tips, posture=posture))
    body, cloud = random_body(np.random.default_rng(27), np.array(points), modes=0, size=0.1)
    return replace(
        delta,
        legs=tuple(legs),
        body=body,
        cloud=cloud,
        q=[np.concatenate([q, q[:, 3:]], axis=1) for q in delta.q],
        qd=[np.concatenate([qd, qd[:, 3:]], axis=1) for qd in delta.qd],
    )


def with_loads(sample: Sample, seed: int = 0) -> Sample:
    """The sample with friction and a spring on every joint."""
    rng = np.random.default_rng(seed)
    legs = [
        replace(leg, joints=tuple(replace(joint, **joint_loads(rng)) for joint in leg.joints))
        for leg in sample.legs
    ]
    return replace(sample, legs=tuple(legs))


# --- singular poses ---


def six_ups(base, platform, height, half_base, half_top, yaw):
    """A 6-UPS on circles of two radii, its points in pairs at 120°, turned by a yaw."""
    thirds = np.repeat(np.radians([0.0, 120.0, 240.0]), 2)
    signs = np.tile([-1.0, 1.0], 3)

    def ring(radius, half):
        angle = thirds + signs * half
        return radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)

    feet, points = ring(base, half_base), ring(platform, half_top)
    body = pf.FlexibleBody.rigid(50.0, (0, 0, 0), np.diag([3.0, 3.0, 5.0]), points)
    legs = tuple(pf.Leg(np.eye(3), foot, links(), (pf.Tip(3, attachment=i),)) for i, foot in enumerate(feet))
    turn = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    return pf.Model(pf.Robot(legs, body, home_pose=((0, 0, height), turn)), "numpy")
