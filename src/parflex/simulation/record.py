"""From the rows of an integration to a labelled dataset: forces, geometry, energies, differences."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from parflex.base.array import Array, mtv, mv
from parflex.base.version import __version__
from parflex.mechanics.energy import energies
from parflex.mechanics.kinematics import position_in_world
from parflex.mechanics.ordering import by_attachment, joints_of
from parflex.mechanics.paths import leg_paths
from parflex.mechanics.system import System, assemble
from parflex.model.model import Model
from parflex.robot.joint_words import actuator_names, actuator_units, beyond_limits
from parflex.robot.layout import Layout, coordinates
from parflex.robot.robot import Robot
from parflex.simulation.integrate import Run
from parflex.simulation.laws.law import Replay
from parflex.simulation.result import FORMAT
from parflex.simulation.trajectory import Trajectory

Variables = dict[str, tuple[tuple[str, ...], Array, str, str]]  # dims, values, units, long name

TWIST_UNITS = "m s-1, rad s-1"
ACCELERATION_UNITS = "m s-2, rad s-2"


def record(
    model: Model,
    run: Run,
    motion: Replay,
    trajectory: Trajectory | None,
    settings: dict[str, Any],
) -> xr.Dataset:
    """The dataset of an integrated run and of what its law did."""
    robot = model.robot
    system = assemble(robot, coordinates(run.x, robot.layout))
    found: Variables = {}
    found |= motion_variables(run, robot.layout)
    found |= dynamic_variables(robot, run, motion)
    found |= geometry_variables(robot, run, system)
    found |= energy_variables(robot, run, system)
    if trajectory is not None:
        found |= wanted_variables(run, trajectory, found["acceleration"][1])
    found |= {"robot_file": ((), np.array(text_of(robot)), "1", "the robot as a robot file (TOML)")}
    attributes = {
        "format": FORMAT,
        "partial": int(bool(run.stopped)),
        "stopped": run.stopped,
        "parflex_version": __version__,
        "backend": model.backend.version(),
        "gravity": np.asarray(robot.gravity),
        "beyond_limits": beyond_limits(robot, found["joint"][1]),
        "units_note": "SI units and radians; Σp is the platform frame, Σ0 the world",
        **settings,
    }
    return dataset_of(found, run.t, robot, attributes)


def text_of(robot: Robot) -> str:
    """The robot file; a bending platform's is said to be beside it."""
    from parflex.files.platform_tables import rigid_table
    from parflex.files.robot_writing import modal_table, robot_text

    return robot_text(robot, rigid_table(robot.platform) or modal_table("robot.platform.nc"))


def dataset_of(found: Variables, t: Array, robot: Robot, attributes: dict[str, Any]) -> xr.Dataset:
    """Variables with their dimensions labelled."""
    coords: dict[str, Any] = {
        "time": ("time", t, {"units": "s", "long_name": "time"}),
        "axis": list("xyz"),
        "component": ["x", "y", "z", "rx", "ry", "rz"],
        "mode": np.arange(1, robot.platform.modes + 1),
        "actuator_name": ("actuator", actuator_names(robot)),
    }
    variables = {
        name: (dims, values, {"units": units, "long_name": words})
        for name, (dims, values, units, words) in found.items()
    }
    sizes = {
        dim: n for dims, values, _, _ in found.values() for dim, n in zip(dims, values.shape, strict=True)
    }
    coords |= {dim: np.arange(1, sizes[dim] + 1) for dim in ("leg", "actuator", "attachment") if dim in sizes}
    return xr.Dataset(variables, coords, attributes)


def motion_variables(run: Run, layout: Layout) -> Variables:
    """The state over time."""
    c = coordinates(run.x, layout)
    return {
        "position": (("time", "axis"), c.position, "m", "position of the platform frame in the world"),
        "rotation": (
            ("time", "axis", "platform_axis"),
            c.rotation,
            "1",
            "rotation matrix, platform axes to world axes",
        ),
        "twist": (
            ("time", "component"),
            c.twist,
            TWIST_UNITS,
            "velocity and angular velocity of the platform frame, in platform axes",
        ),
        "elastic": (("time", "mode"), c.elastic, "kg0.5 m", "elastic coordinates"),
        "elastic_rate": (("time", "mode"), c.elastic_rate, "kg0.5 m s-1", "elastic rates"),
    }


def dynamic_variables(robot: Robot, run: Run, motion: Replay) -> Variables:
    """Forces, accelerations and contact forces at every output time."""
    N, twist = robot.platform.modes, run.x[:, 7:13]
    Vd = motion.rate[:, 7:13].copy()
    Vd[:, :3] += np.cross(twist[:, 3:], twist[:, :3])
    qdd_e = motion.rate[:, 13 + N : 13 + 2 * N]
    return {
        "forces": (("time", "actuator"), motion.forces, actuator_units(robot), "actuator forces"),
        "acceleration": (
            ("time", "component"),
            Vd,
            ACCELERATION_UNITS,
            "acceleration of the platform frame, resolved in platform axes",
        ),
        "elastic_acceleration": (("time", "mode"), qdd_e, "kg0.5 m s-2", "elastic accelerations"),
        "contact_forces": (
            ("time", "attachment", "axis"),
            by_attachment(robot, motion.contact),
            "N",
            "forces of the legs on the platform, in platform axes",
        ),
    }


def geometry_variables(robot: Robot, run: Run, system: System) -> Variables:
    """Legs, deformation, and what a picture of the robot needs."""
    body, c = robot.platform, system.x
    legs, paths = joints_of(robot, system), leg_paths(system)
    shapes = np.moveaxis(body.shapes, 0, -1)  # (K, 3, N)
    bent = mv(shapes[list(body.attachments)], c.elastic[:, None, :])
    place = position_in_world(body.attachment_points + bent, c)
    out: Variables = {
        "joint": (
            ("time", "leg", "joint_number"),
            side_by_side(legs.q, len(run.t)),
            "m, rad",
            "joint positions",
        ),
        "joint_rate": (
            ("time", "leg", "joint_number"),
            side_by_side(legs.qd, len(run.t)),
            "m s-1, rad s-1",
            "joint rates",
        ),
        "leg_path": (
            ("time", "path", "station", "axis"),
            paths.points,
            "m",
            "points of the legs in the world, from base through the joints to a tip",
        ),
        "leg_axis": (
            ("time", "path", "station", "axis"),
            paths.axes,
            "1",
            "axes of the joints in the world; zero at base and tip",
        ),
        "leg_station": (
            ("path", "station"),
            np.array(paths.stations, dtype=str).reshape(paths.points.shape[-3:-1]),
            "1",
            "base, R or P for a joint, with a star where there is a motor, or tip",
        ),
        "path_leg": (("path",), np.array(paths.legs, dtype=int) + 1, "1", "leg of the path"),
        "path_attachment": (
            ("path",),
            np.array(paths.attachments, dtype=int) + 1,
            "1",
            "attachment where the path ends",
        ),
        "motor_position": (
            ("time", "motor", "axis"),
            paths.motors,
            "m",
            "actuated joints in the world, those of equal legs side by side",
        ),
        "attachment_position": (
            ("time", "attachment", "axis"),
            place,
            "m",
            "position of the attachment points in the world",
        ),
        "attachment_deformation": (
            ("time", "attachment", "axis"),
            bent,
            "m",
            "deformation at the attachment points, in platform axes",
        ),
        "platform_node": (("node", "axis"), body.nodes, "m", "nodes of the platform, in platform axes"),
        "platform_shape": (
            ("mode", "node", "axis"),
            body.shapes,
            "kg-0.5",
            "displacement shapes at the nodes",
        ),
    }
    m = np.diagonal(body.m_ee)
    omega = np.sqrt(body.stiffness / m)
    out["frequency"] = (("mode",), omega, "rad s-1", "natural frequencies of the free platform")
    ratio = body.damping / np.maximum(2 * omega * m, 1e-300)
    out["damping_ratio"] = (("mode",), ratio, "1", "damping ratios")
    if body.triangles is not None:
        triangles = np.asarray(body.triangles, dtype=np.int64)
        out["platform_triangle"] = (("triangle", "corner"), triangles, "1", "surface, node numbers from 0")
    if body.origin_node is not None:
        node = body.origin_node
        rotations = np.zeros_like(body.shapes) if body.rotation_shapes is None else body.rotation_shapes
        both = np.concatenate([body.shapes[:, node], rotations[:, node]], axis=-1)
        out["origin_deformation"] = (
            ("time", "component"),
            c.elastic @ both,
            "m, rad",
            "deformation at the platform's origin, in platform axes",
        )
    return out


def side_by_side(values: Sequence[Array], count: int) -> Array:
    """One (T, n_i) per leg as (T, legs, n); not a number where a leg has fewer joints than others."""
    width = max((q.shape[-1] for q in values), default=0)
    padded = [np.pad(q, ((0, 0), (0, width - q.shape[-1])), constant_values=np.nan) for q in values]
    return np.stack(padded, axis=1) if padded else np.zeros((count, 0, 0))


def energy_variables(robot: Robot, run: Run, system: System) -> Variables:
    """The ledger: energies, works, and the residual of their balance."""
    kinetic, gravity, strain, springs = energies(robot, system)
    actuators, wrenches, dissipated = run.works.T
    stored = kinetic + gravity + strain + springs
    residual = stored - stored[0] + dissipated - actuators - wrenches
    named = {
        "kinetic": (kinetic, "kinetic energy, rotors included"),
        "gravity": (gravity, "potential energy of weight, zero at the world's origin"),
        "strain": (strain, "strain energy of the platform"),
        "springs": (springs + 0.0 * run.t, "energy of the joints' springs"),
        "dissipated": (dissipated, "energy dissipated by damping and friction"),
        "actuators": (actuators, "work of the actuators"),
        "wrenches": (wrenches, "work of the external wrenches"),
        "residual": (residual, "residual of the energy balance"),
    }
    return {f"energy_{name}": (("time",), value, "J", words) for name, (value, words) in named.items()}


def wanted_variables(run: Run, trajectory: Trajectory, acceleration: Array) -> Variables:
    """The trajectory that was to be followed, and the differences from it."""
    from scipy.spatial.transform import Rotation

    wanted, now = trajectory.sample(run.t), coordinates(run.x, Layout(0))
    R_pd = np.swapaxes(now.rotation, -1, -2) @ wanted.rotation
    turned = np.concatenate(
        [mv(R_pd, wanted.acceleration[:, :3]), mv(R_pd, wanted.acceleration[:, 3:])], axis=-1
    )
    place = mtv(now.rotation, wanted.position - now.position)
    attitude = Rotation.from_matrix(R_pd).as_rotvec()
    return {
        "desired_position": (("time", "axis"), wanted.position, "m", "desired position"),
        "desired_rotation": (("time", "axis", "platform_axis"), wanted.rotation, "1", "desired rotation"),
        "desired_acceleration": (
            ("time", "component"),
            turned,
            ACCELERATION_UNITS,
            "desired acceleration of the platform frame, in platform axes",
        ),
        "acceleration_error": (
            ("time", "component"),
            turned - acceleration,
            ACCELERATION_UNITS,
            "desired minus calculated acceleration, in platform axes",
        ),
        "pose_error": (
            ("time", "component"),
            np.concatenate([place, attitude], axis=-1),
            "m, rad",
            "desired minus actual pose, in platform axes",
        ),
    }
