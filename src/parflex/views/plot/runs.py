"""Pictures of runs over time."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from parflex.views.plot.canvas import COLOURS, STYLES, curves, figure, legend_right, require, time_label

if TYPE_CHECKING:
    from parflex.simulation.result import Result

RESIDUAL = "energy_residual"
CURVES = {  # of the energy balance; the joints' springs, which few robots have, are left to the report
    "energy_kinetic": "kinetic",
    "energy_gravity": "gravity (change)",
    "energy_strain": "strain",
    "energy_dissipated": "dissipated",
    "energy_actuators": "work of actuators",
    "energy_wrenches": "work of wrenches",
}

SURROUNDINGS = {"energy_base": "work of the base", "energy_rests": "work of moving rests"}  # where they move


def over_time(result: "Result") -> dict[str, Figure]:
    """The figures of a run over time that its result has the data for, by what they show."""
    made = {
        "Actuator forces": (actuator_forces, {"forces", "actuator_name"}),
        "Accelerations": (accelerations, {"acceleration", "acceleration_error"}),
        "Deformation at the origin": (origin_deformation, {"origin_deformation"}),
        "Deformation at the attachments": (attachment_deformation, {"attachment_deformation"}),
        "Bending of the legs": (leg_deformation, {"leg_deformation", "path_leg"}),
        "Base and platform": (base_motion, {"base_position", "relative_position"}),
        "Energy balance": (energy, {*CURVES, RESIDUAL}),
    }
    bends = result.dataset.sizes.get("mode", 0) > 0
    return {
        words: draw(result)
        for words, (draw, needed) in made.items()
        if needed <= set(result.dataset.variables) and (bends or "Deformation" not in words)
    }


def actuator_forces(result: "Result") -> Figure:
    """Actuator forces over time (the paper's Fig. 4)."""
    fig = figure(7.0, 3.4)
    ax = fig.subplots()
    data = result.dataset["forces"]
    curves(ax, data, "actuator", list(data["actuator_name"].values))
    ax.set_ylabel(f"actuator force ({data.attrs.get('units', 'N')})")
    time_label(ax)
    legend_right(ax)
    ax.set_title("Actuator forces")
    return fig


def accelerations(result: "Result") -> Figure:
    """Platform acceleration and its difference from the desired one (the paper's Fig. 5).

    Raises InputError for a run without a desired trajectory.
    """
    require(result, "acceleration_error")
    fig = figure(7.0, 7.2)
    panels = fig.subplots(4, 1, sharex=True)
    both = (("acceleration", "acceleration"), ("acceleration_error", "desired − calculated"))
    for row, (name, words) in enumerate(both):
        data = result.dataset[name]
        linear, angular = data.isel(component=slice(0, 3)), data.isel(component=slice(3, 6))
        curves(panels[2 * row], linear, "component", ["$\\dot v_x$", "$\\dot v_y$", "$\\dot v_z$"])
        panels[2 * row].set_ylabel(f"linear\n{words}\n(m/s²)")
        names = ["$\\dot\\omega_x$", "$\\dot\\omega_y$", "$\\dot\\omega_z$"]
        curves(panels[2 * row + 1], angular, "component", names)
        panels[2 * row + 1].set_ylabel(f"angular\n{words}\n(rad/s²)")
    for ax in panels:
        legend_right(ax)
    panels[0].set_title("Acceleration of the platform frame by the direct model, in platform axes")
    time_label(panels[-1])
    fig.align_ylabels(panels)
    return fig


def origin_deformation(result: "Result") -> Figure:
    """Linear and angular deformation at the platform's origin (the paper's Fig. 6).

    Raises InputError for a platform without a node at its origin.
    """
    require(result, "origin_deformation")
    data = result.dataset["origin_deformation"]
    fig = figure(7.0, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    curves(upper, data.isel(component=slice(0, 3)), "component", list("xyz"), 1e3)
    upper.set_ylabel("linear deformation\n(mm)")
    curves(lower, data.isel(component=slice(3, 6)), "component", list("xyz"), 1e3)
    lower.set_ylabel("angular deformation\n(mrad)")
    for ax in (upper, lower):
        legend_right(ax)
    upper.set_title("Deformation at the platform origin, in platform axes")
    time_label(lower)
    fig.align_ylabels([upper, lower])
    return fig


def attachment_deformation(result: "Result") -> Figure:
    """Deformation at the attachment points along each axis that moves (the paper's Fig. 7)."""
    data = result.dataset["attachment_deformation"]
    size = np.max(np.abs(data.values), initial=0.0)
    moving = [i for i in range(3) if np.max(np.abs(data.isel(axis=i).values), initial=0) > 1e-9 * size]
    shown = moving if size > 0 else [2]
    fig = figure(7.0, 1.2 + 2.4 * len(shown))
    panels = fig.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    labels = [f"$p_{{{i}}}$" for i in data["attachment"].values]
    for ax, axis in zip(panels, shown, strict=True):
        curves(ax, data.isel(axis=axis), "attachment", labels, 1e3)
        ax.set_ylabel(f"deformation along ${'xyz'[axis]}_p$\n(mm)")
        legend_right(ax)
    still = [f"${'xyz'[i]}_p$" for i in range(3) if i not in shown]
    note = f"; none along {' and '.join(still)}" if still else ""
    panels[0].set_title(f"Deformation at the attachment points, in platform axes{note}")
    time_label(panels[-1])
    return fig


def leg_deformation(result: "Result") -> Figure:
    """The largest displacement of each leg by the bending of links and platform.

    Raises InputError for a robot whose links are rigid.
    """
    require(result, "leg_deformation")
    data = result.dataset["leg_deformation"]
    legs = result.dataset["path_leg"].values
    every = np.linalg.norm(data.values, axis=-1).max(axis=-1)
    fig = figure(7.0, 3.4)
    ax = fig.subplots()
    each = [every[:, legs == leg].max(axis=1) for leg in np.unique(legs)]
    moved = data.isel(station=0, axis=0, drop=True).isel(path=slice(len(each))).copy(data=np.stack(each, -1))
    curves(ax, moved, "path", [f"leg {leg}" for leg in np.unique(legs)], 1e3)
    ax.set_ylabel("largest displacement (mm)")
    time_label(ax)
    legend_right(ax)
    ax.set_title("Bending of the legs")
    return fig


def base_motion(result: "Result") -> Figure:
    """Where the base is, and the displacement of the platform from where it stood to the base.

    Raises InputError for a run whose base does not move.
    """
    require(result, "base_position")
    require(result, "relative_position")
    fig = figure(7.0, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    curves(upper, result.dataset["base_position"], "axis", list("xyz"), 1e3)
    upper.set_ylabel("base, in the world\n(mm)")
    place = result.dataset["relative_position"]
    curves(lower, place - place[0], "axis", list("xyz"), 1e3)
    lower.set_ylabel("platform, seen from\nthe base (mm)")
    for ax in (upper, lower):
        legend_right(ax)
    upper.set_title("Position of the base, and displacement of the platform to it")
    time_label(lower)
    fig.align_ylabels([upper, lower])
    return fig


def energy(result: "Result") -> Figure:
    """The energy ledger and the residual of its balance."""
    fig = figure(7.0, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    moved = {name: words for name, words in SURROUNDINGS.items() if name in result.dataset}
    for i, (name, words) in enumerate((CURVES | moved).items()):
        data = result.dataset[name]
        values = data - data[0] if name == "energy_gravity" else data
        upper.plot(data["time"], values, color=COLOURS[i], linestyle=STYLES[i % len(STYLES)], label=words)
    upper.set_ylabel("energy (J)")
    legend_right(upper)
    residual = result.dataset[RESIDUAL]
    lower.plot(residual["time"], residual, color=COLOURS[6], lw=1.0)
    lower.set_ylabel("residual (J)")
    for ax in (upper, lower):
        ax.margins(x=0)
        ax.grid(alpha=0.3)
    upper.set_title("Energy balance")
    time_label(lower)
    fig.align_ylabels([upper, lower])
    return fig
