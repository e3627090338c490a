"""Every public callable of robots, models and simulations that takes numbers, and what it must not take."""

from functools import partial

import numpy as np

import parflex as pf
from arguments import (
    BAD,
    INF,
    NAN,
    NONE,
    UP,
    Argument,
    Door,
    array,
    flag,
    number,
    other,
    positive,
    rotation,
    thing,
    things,
    vector,
    whole,
)

ANGLES = np.pi / 3 * np.arange(6)
NODES = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(6)])
SHAPES = np.zeros((1, 6, 3))
SHAPES[0, :, 2] = np.array([1, -1, 1, -1, 1, -1]) / np.sqrt(6)
BODY = pf.FlexibleBody.from_nodes(NODES, np.ones(6), SHAPES, [60.0], 0.1, range(6), 0 * SHAPES)
MODEL = pf.Model(pf.robots.gough_stewart(platform=BODY), "numpy", ["gravity"])
ROBOT, HOME, LEG = MODEL.robot, MODEL.robot.home, MODEL.robot.legs[0]
FLAT = MODEL.compiled()
GAMMA = np.full(6, 10.0)
WAY = pf.Trajectory.through(HOME, [((0.0, 0, 0.01), (0, 0, 0))], 1.0)
BAR = pf.Bar(mass=1.0, length=0.5)
STANDING, HELD = MODEL.equilibrium(*ROBOT.home_pose)
LIN = MODEL.linearise(STANDING, HELD, controller="locked")
TOOL = pf.compliance(LIN, 0)(np.linspace(10.0, 1e4, 50))
BATCH = pf.State(np.zeros((2, 3)), UP, elastic=[0.0])
ANOTHER = pf.State(HOME.position, UP, elastic=np.zeros(9))  # of a robot of nine modes

STATE = thing(HOME, another=ANOTHER, word="state|State.elastic")
ONE = thing(HOME, another=ANOTHER, batch=BATCH, word="state|reference|State.elastic")
START = thing(HOME, batch=BATCH)
GUESS = thing(None, none=True, another=ANOTHER, batch=BATCH, word="guess|state|State.elastic")
MAYBE = thing(None, none=True)
FLOOR = {"base": thing(None, none=True)}
FLAT_FLOOR = {"base": vector(19)._replace(bad={n: v for n, v in vector(19).bad.items() if n != "None"})}
LOAD = {"wrenches": things([pf.Wrench(0)], nowhere=[pf.Wrench(99)])}
VALUES = other(
    {"gravity": [0, 0, -9.0]},
    word="values|parameters|gravity",
    text="abc",
    number=1.0,
    list=[1.0],
    another={"mass": 1.0},
    nan={"gravity": [0, 0, NAN]},
    shape={"gravity": [1.0, 2.0]},
    nothing={"gravity": None},
    complex={"gravity": [1j, 0, 0]},
)
OUTPUT = {"output": thing(None, none=True, nowhere=pf.PointOutput(99), word="output|PointOutput")}
LEGS_WORD = other("static", number=1, nothing=None, word_of_none="stiff", list=["static"])
ROWS = other(
    (0,), text="abc", number=1, halves=[0.5], nothing=None, far=[9], nan=[NAN], twice=[1, 1], empty=[]
)
SOME_JOINTS = ROWS._replace(
    bad={name: bad for name, bad in ROWS.bad.items() if name not in ("nothing", "far")}
)
SOME = ROWS._replace(bad={name: bad for name, bad in ROWS.bad.items() if name != "empty"})
AT_NODE = {"node": whole(0), "offset": array(np.zeros(3))}
OMEGA = array([10.0, 20.0])
DRIVEN = {"state": STATE, "forces": array(GAMMA)} | LOAD
WANTED = {"state": STATE, "target": array(np.zeros(6))} | OUTPUT | LOAD
JOINTED = {"joints": array([q[2] for q in MODEL.joints(HOME).q]), "guess": GUESS}
RATIO = {"damping_ratio": array(0.0)}
GAINS = {name: array(np.ones(6)) for name in ("kp", "kd")}
SERVOS = {name: array(np.ones(6), none=True) for name in ("kp", "kd")}
MODELLED, ALONG = {"model": thing(MODEL)}, {"trajectory": thing(WAY)}
SIZES = dict(base_radius=1.5, platform_radius=1.0, height=1.5)
SPREADS = dict(base_spread=0.5, platform_spread=0.6, base_offset=0.0, platform_offset=0.0)
POSES = dict(
    good=(np.zeros(3), UP), mirrored=(np.zeros(3), -UP), stretched=(np.zeros(3), np.diag([1.0, 1, 2]))
)

JOINT = {name: whole(0) for name in ("antecedent", "sigma", "mu")}
JOINT |= {name: number(0.1) for name in ("gamma", "b", "alpha", "d", "theta", "r", "q_0")}
JOINT |= {name: number(0.1, more={"negative": -1.0}) for name in ("M", "IA", "Fv", "Fs", "v_s", "k")}
JOINT |= {"MS": array(np.zeros(3)), "I": array(np.eye(3))}
COMPLIANCE = {
    "drive_stiffness": positive(1e5, none=True),
    "drive_damping": number(0.0, more={"negative": -1.0}),
}
LIMIT = {name: bad for name, bad in number().bad.items() if name != "inf"}
JOINT |= {"q_min": Argument(-1.0, LIMIT | {"inf": INF}), "q_max": Argument(1.0, LIMIT | {"minus inf": -INF})}
DRIVE = {"stroke": array([0.1, 0.9], none=True), "rest": number(0.5, none=True)}
DRIVE |= {name: number(1.0, more={"negative": -1.0}) for name in ("stiffness", "damping", "rotor_inertia")}
DRIVE |= COMPLIANCE
BARS = {n: positive(0.2, none=True) for n in ("mass", "outer", "inner", "length", "density", "young")}
SHAPE_COUNTS = {n: whole(1) for n in ("axial", "torsion")} | {"static": flag()}
BEAM = pf.beam((0, 0, 1.0), 0.1, young=2e11, poisson=0.3, density=7850.0)
FLEXURE = {
    name: number(0.1, none=name in ("axial", "shear"), more={"negative": -1.0})
    for name in ("bending", "torsion", "damping", "axial", "shear", "translation_damping")
}
LEGS = things([np.zeros(3)] * 6, none=True)
LEGS = LEGS._replace(bad={name: bad for name, bad in LEGS.bad.items() if name not in ("ragged", "nothings")})
RUN = pf.simulate(MODEL, GAMMA, HOME, [0.0, 1e-3])


def equilibrium(**given):
    """The equilibrium at home, or under the forces that hold it where forces or a guess are given."""
    own = (
        {"forces": AT_HOME}
        if {"forces", "guess"} & set(given)
        else {"position": HOME.position, "rotation": UP}
    )
    return MODEL.equilibrium(**own | given)


AT_HOME = MODEL.equilibrium(HOME.position, UP)[1]

DOORS: dict[str, Door] = {
    "Bar": Door(
        partial(pf.Bar, mass=1.0, length=0.5),
        BARS
        | {"com": number(none=True), "inertia": array([0.1, 0.2], none=True)}
        | {"poisson": number(0.3, none=True), "bending": whole(1, none=True)}
        | SHAPE_COUNTS
        | RATIO,
    ),
    "Circle": Door(
        pf.Circle,
        {
            "radius": positive(),
            "frequency": positive(),
            "turns": positive(),
            "normal": array([0, 0, 1.0]),
            "centre": array([1.0, 0, 0], none=True),
            "ramp": positive(0.5, none=True),
        },
    ),
    "Compiled.pack": Door(FLAT.pack, {"state": ONE}),
    "Compiled.unpack": Door(FLAT.unpack, {"x": array(FLAT.pack(HOME))}),
    "Compiled.direct": Door(FLAT.direct, {"x": vector(15), "u": vector(6), "out": vector(7)} | FLAT_FLOOR),
    "Compiled.inverse": Door(
        FLAT.inverse, {"x": vector(15), "target": vector(6), "out": vector(7)} | FLAT_FLOOR
    ),
    "ComputedTorque": Door(
        partial(pf.ComputedTorque, trajectory=WAY),
        MODELLED
        | ALONG
        | GAINS
        | {"output": thing(pf.FrameOutput()), "preload": array(GAMMA), "legs": LEGS_WORD},
    ),
    "FlexibleBody.from_nodes": Door(
        pf.FlexibleBody.from_nodes,
        {
            "positions": array(NODES),
            "masses": array(np.ones(6)),
            "shapes": array(SHAPES),
            "frequencies": array([60.0]),
            "attachments": array(NODES),
            "rotation_shapes": array(SHAPES, none=True),
            "foreshortening": array(np.zeros((6, 3, 1, 1)), none=True),
        }
        | RATIO,
    ),
    "FlexibleBody.rigid": Door(
        pf.FlexibleBody.rigid,
        {
            "mass": positive(),
            "com": array(np.zeros(3)),
            "inertia_at_com": array(np.eye(3)),
            "attachments": array(NODES),
        },
    ),
    "FlexibleBody.shapes_at": Door(BODY.shapes_at, {"node": whole(), "offset": array(np.zeros(3))}),
    "FlexibleBody.with_modes": Door(BODY.with_modes, {"modes": SOME}),
    "FlexibleBody.with_payload": Door(BODY.with_payload, {"node": whole(), "mass": positive()}),
    "Flexure": Door(
        pf.Flexure,
        {n: array(np.eye(3)) for n in ("stiffness", "damping")}
        | {n: array(np.eye(3), none=True) for n in ("translation", "translation_damping")}
        | {"friction": number(more={"negative": -1.0}), "friction_speed": positive()}
        | {"rest": rotation(none=True)},
    ),
    "Flexure.about": Door(pf.Flexure.about, {"axis": array([0, 0, 1.0])} | FLEXURE),
    "Coupling": Door(
        pf.Coupling,
        {"joints": other((1, 2), **BAD, **NONE, zero=(0, 1), twice=(1, 1))}
        | {name: array(np.eye(2)) for name in ("stiffness", "damping")}
        | {"rest": array(np.zeros(2))},
    ),
    "FrameOutput": Door(pf.FrameOutput, {"rows": ROWS}),
    "Hold": Door(pf.Hold, {"duration": positive()}),
    "JointOutput": Door(pf.JointOutput, {"rows": SOME_JOINTS}),
    "Joint": Door(pf.Joint, JOINT | {"body": thing(BEAM, none=True)} | COMPLIANCE),
    "JointPD": Door(pf.JointPD, MODELLED | {"reference": ONE} | GAINS | {"forces": array(GAMMA)}),
    "Leg": Door(
        pf.Leg,
        {
            "rotation": rotation(),
            "origin": array(np.zeros(3)),
            "joints": things(LEG.joints),
            "tips": things(LEG.tips),
            "posture": array(np.zeros(3), none=True),
            "couplings": things([pf.Coupling((1, 2), np.eye(2))]),
        },
    ),
    "Model": Door(
        pf.Model,
        {
            "robot": thing(ROBOT),
            "parameters": other(
                ["gravity"], text="gravity", number=1, numbers=[1], nothing=None, another=["mass"]
            ),
        },
        "backend",
    ),
    "Model.cartesian": Door(MODEL.cartesian, {"state": STATE}),
    "Model.compiled": Door(MODEL.compiled, OUTPUT),
    "Model.direct": Door(MODEL.direct, DRIVEN | {"parameters": VALUES} | FLOOR),
    "Model.direct_jacobian": Door(MODEL.direct_jacobian, DRIVEN | {"parameters": VALUES} | FLOOR),
    "Model.energies": Door(MODEL.energies, {"state": STATE} | FLOOR),
    "Model.equilibrium": Door(
        equilibrium,
        {"position": array(HOME.position, none=True), "rotation": rotation(none=True)}
        | {"forces": array(AT_HOME, none=True), "guess": GUESS}
        | {"wrenches": DRIVEN["wrenches"], "parameters": VALUES}
        | FLOOR,
    ),
    "Model.forward": Door(MODEL.forward, JOINTED, "sag"),
    "Model.forward_all": Door(
        partial(MODEL.forward_all, starts=1), JOINTED | {"starts": whole(1), "seed": whole(0)}
    ),
    "Model.inverse": Door(
        MODEL.inverse,
        WANTED
        | {"preload": array(GAMMA, none=True), "parameters": VALUES}
        | {"legs": LEGS_WORD, "allow_ill_posed": flag()}
        | FLOOR,
    ),
    "Model.inverse_jacobian": Door(MODEL.inverse_jacobian, WANTED | {"parameters": VALUES} | FLOOR),
    "Model.joint_accelerations": Door(MODEL.joint_accelerations, DRIVEN | FLOOR),
    "Model.joints": Door(MODEL.joints, {"state": STATE} | FLOOR),
    "Model.mobility": Door(MODEL.mobility, {"state": ONE}),
    "Model.output_report": Door(MODEL.output_report, {"state": ONE} | OUTPUT),
    "Model.project": Door(MODEL.project, {"state": STATE} | FLOOR),
    "Model.reactions": Door(MODEL.reactions, DRIVEN | FLOOR),
    "Model.with_parameters": Door(MODEL.with_parameters, {"values": VALUES}),
    "MoveTo": Door(
        pf.MoveTo,
        {"position": array(np.zeros(3), none=True), "rotation": rotation(none=True), "duration": positive()},
    ),
    "Payload": Door(
        pf.Payload,
        {
            "mass": positive(),
            "com": array(np.zeros(3)),
            "inertia": array(np.eye(3)),
            "node": whole(none=True),
        },
    ),
    "Payload.on": Door(pf.Payload(1.0).on, {"body": thing(BODY)}),
    "PointOutput": Door(pf.PointOutput, {"node": whole(), "offset": array(np.zeros(3)), "rows": ROWS}),
    "Robot": Door(
        pf.Robot,
        {
            "legs": things(ROBOT.legs),
            "platform": thing(BODY),
            "gravity": array(np.zeros(3)),
            "home_pose": other(**POSES, **BAD, **NONE),
        },
    ),
    "Servo": Door(
        partial(pf.Servo, trajectory=WAY),
        MODELLED | ALONG | SERVOS | {"ki": array(np.zeros(6)), "rate": positive(1000.0)},
    ),
    "BaseMotion": Door(
        pf.BaseMotion,
        {"position": array(np.zeros(3)), "rotation": rotation()}
        | {"twist": array(np.zeros(6)), "acceleration": array(np.zeros(6))},
    ),
    "BaseMotion.carried": Door(pf.BaseMotion().carried, {"state": thing(HOME)}),
    "BaseMotion.seen": Door(pf.BaseMotion().seen, {"state": thing(HOME)}),
    "BaseSamples": Door(
        pf.BaseSamples,
        {"t": array(np.arange(6.0))}
        | {name: array(np.zeros((6, 3)), none=True) for name in ("position", "rotation", "velocity")}
        | {name: array(np.zeros((6, 3)), none=True) for name in ("acceleration", "angular_velocity")}
        | {"angular_acceleration": array(np.zeros((6, 3)), none=True)},
    ),
    "State": Door(
        pf.State,
        {
            "position": array(np.zeros(3)),
            "rotation": rotation(),
            "twist": array(np.zeros(6)),
            "elastic": array([0.0], shape=False),
            "elastic_rate": array([0.0], shape=False),
            "joints": LEGS,
            "joint_rates": LEGS,
            "leg_elastic": LEGS,
            "leg_elastic_rate": LEGS,
        },
    ),
    "Strut": Door(pf.Strut, {"cylinder": thing(BAR), "rod": thing(BAR)} | DRIVE),
    "Tip": Door(
        pf.Tip,
        {"frame": whole(1), "offset": array(np.zeros(3)), "attachment": whole()}
        | {"flexure": thing(pf.Flexure(), none=True)},
    ),
    "Trajectory": Door(
        pf.Trajectory,
        {
            "positions": array(np.zeros((2, 3))),
            "rotations": rotation(np.stack([UP] * 2)),
            "durations": array([1.0]),
            "rest": array([0.5, 0.5]),
            "moves": things([pf.Hold(1.0)]),
        },
    ),
    "Trajectory.of": Door(
        pf.Trajectory.of, {"start": START, "moves": things([pf.Hold(1.0)]), "rest": array([0.5, 0.5])}
    ),
    "Trajectory.sample": Door(WAY.sample, {"t": array([0.0], shape=False)}),
    "Trajectory.through": Door(
        pf.Trajectory.through,
        {
            "start": START,
            "moves": array([[[0, 0, 0.1], [0, 0, 0]]]),
            "duration": positive(),
            "rest": array([0.5, 0.5]),
        },
    ),
    "Wrench": Door(
        pf.Wrench, {"node": whole(), "force": array(np.zeros(3)), "moment": array(np.zeros(3))}, "frame"
    ),
    "beam": Door(
        pf.beam,
        {"end": array([0, 0, 1.0]), "outer": positive(0.1)}
        | {"inner": number(0.05, more={"negative": -1.0, "all": 0.1})}
        | {"young": positive(2e11), "poisson": number(0.3, more={"beyond": 0.5}), "density": positive(7850.0)}
        | {"bending": whole(1), "foreshortening": flag()}
        | SHAPE_COUNTS
        | RATIO,
    ),
    "export_c": Door(
        partial(pf.export_c, directory="nowhere"),
        {"model_or_robot": thing(MODEL), "output": OUTPUT["output"]},
        "directory prefix force",
    ),
    "leg_motion": Door(pf.leg_motion, MODELLED | ALONG | {"t": array([0.0], shape=False), "state": GUESS}),
    "simulate": Door(
        pf.simulate,
        MODELLED
        | {"forces_or_controller": array(GAMMA), "state": ONE, "t": array([0.0, 1e-3])}
        | LOAD
        | {"base": other(None, text="abc", number=1.0, list=[], motion=pf.BaseMotion())}
        | {"rest": other(None, text="abc", number=1.0, list=[], without=lambda t: ([], []))}
        | {"rtol": positive(1e-6), "atol": positive(1e-6), "max_step": positive(1.0, none=True)},
        "method on_stop",
    ),
    "Result.state": Door(
        RUN.state, {"index": other(0, text="abc", half=0.5, nothing=None, far=99, nan=NAN, object=object())}
    ),
    "Accelerometer": Door(pf.Accelerometer, AT_NODE),
    "Actuators": Door(pf.Actuators, {}),
    "FramePose": Door(pf.FramePose, {}),
    "JointMotion": Door(pf.JointMotion, {}),
    "NodeMotion": Door(
        pf.NodeMotion,
        AT_NODE
        | {"of": other("velocity", text="jerk", number=1, nothing=None, list=["velocity"])}
        | {"frame": other("platform", text="base", number=1, nothing=None, list=["world"])},
    ),
    "NodeWrench": Door(pf.NodeWrench, AT_NODE),
    "Reference": Door(pf.Reference, {}),
    "StrutForce": Door(pf.StrutForce, {}),
    "Model.linearise": Door(
        MODEL.linearise,
        {"state": thing(STANDING, another=ANOTHER, batch=BATCH, word="state|State.elastic")}
        | {"forces": array(HELD)}
        | {"inputs": things([pf.Actuators()], output=[pf.FramePose()])}
        | {"outputs": things([pf.FramePose()], input=[pf.Actuators()])}
        | LOAD
        | {"friction": other("smoothed", text="dry", number=1, nothing=None, list=["viscous"])}
        | {"controller": other(None, text="stiff", number=1, list=["locked"])}
        | FLOOR
        | {"parameters": VALUES},
    ),
    "LinearModel.frf": Door(LIN.frf, {"omega": OMEGA, "structural": number(0.0, more={"negative": -1.0})}),
    "LinearModel.to_control": Door(LIN.to_control, {"omega": array([10.0, 20.0], none=True)}),
    "BaseAcceleration": Door(pf.BaseAcceleration, {}),
    "ContactForces": Door(pf.ContactForces, {}),
    "natural_frequencies": Door(
        pf.natural_frequencies,
        {"model": thing(MODEL), "state": thing(STANDING, another=ANOTHER, word="state|State.elastic")}
        | {"forces": array(HELD), "count": other(6, zero=0, **BAD, **NONE), "damped": flag()}
        | {"controller": other(None, text="stiff", number=1, list=["locked"])},
    ),
    "Strain": Door(
        pf.Strain,
        {
            "shapes": array([[1.0, 2.0]], shape=False),
            "unit": other("MPa", number=1, nothing=None, list=["Pa"]),
        },
    ),
    "compliance": Door(pf.compliance, {"lin": thing(LIN)} | AT_NODE),
    "transmissibility": Door(pf.transmissibility, {"lin": thing(LIN)} | AT_NODE),
    "dynamic_stiffness": Door(pf.dynamic_stiffness, {"lin": thing(LIN)} | AT_NODE),
    "power_spectrum": Door(
        pf.power_spectrum,
        {"frf": thing(TOOL), "psd": array(np.ones((6, 50)), shape=False)},
    ),
    "sag": Door(
        pf.sag,
        {"model": thing(MODEL), "elevations": array([0.0, 0.0])}
        | AT_NODE
        | {"axis": array([0.0, 1.0, 0.0]), "home": number(0.0)}
        | {"motors": other("auto", text="loose", number=1, nothing=None, list=["locked"])},
    ),
    "stability_lobes": Door(
        partial(pf.stability_lobes),
        {"frf": thing(TOOL)}
        | {"stiffness": positive(1e9), "teeth": other(4, zero=0, **BAD, **NONE)}
        | {"direction": array([0.0, 1.0, 0.0]), "speeds": array([1e3, 2e3])},
    ),
    "robots.hexapod": Door(
        partial(pf.robots.hexapod, **SIZES, **SPREADS),
        {n: positive(v) for n, v in SIZES.items()}
        | {n: number(v) for n, v in SPREADS.items()}
        | {"strut": MAYBE, "platform": MAYBE, "payload": MAYBE},
    ),
    "robots.gough_stewart": Door(
        pf.robots.gough_stewart, {"modes": whole(0), "platform": MAYBE} | RATIO, "frequencies"
    ),
}
DOORS |= {
    f"robots.{name}": Door(getattr(pf.robots, name), {"modes": whole(0), "platform": MAYBE} | RATIO)
    for name in ("delta", "octapod", "prs3", "pus6", "rps3", "rus6", "nano_hexapod")
}
DOORS |= {
    f"{type(law).__name__}.verdict": Door(law.verdict, {"state": thing(None, none=True, batch=BATCH)})
    for law in (pf.ComputedTorque(MODEL, WAY), pf.JointPD(MODEL, HOME, 1e5, 1e3), pf.Servo(MODEL, WAY))
}
