"""How does the cost grow with modes and legs, and how far is it from what the processor can do?"""

import parflex as pf
import zoo
from benchmarks.peak import Peak
from benchmarks.report import Section, micro
from benchmarks.rows import direct_rows
from benchmarks.timing import alternate
from parflex.compiled.native.loops import program
from parflex.compiled.native.native import widest
from parflex.kernels import models as kernels
from parflex.kernels.by_tips import by_tips
from parflex.mechanics.redundancy import solvable
from parflex.robot.robot import Robot
from parflex.robots.delta import delta

ROWS = 1024


def ask() -> Section:
    """Operations of the direct model, its time on one thread, and that over what the operations need."""
    together = f"µs, {widest()} together"
    head = ("robot", "operations", "µs, one alone", "over scalar peak", together, "over vector peak")
    section = Section("Cost against modes and legs: one direct model", head)
    peaks, best = [Peak(1), Peak(widest())], {}
    for name, robot in robots().items():
        count, cells = program(kernels.direct(by_tips(solvable(robot)))).operations, []
        for peak in peaks:
            model = direct_rows(robot, peak.lanes, ROWS).one_thread()
            times = alternate({"model": model, "peak": peak.run})
            per_second = peak.operations / times["peak"].median
            took = times["model"].median / ROWS
            cells += [micro(took), f"{took * per_second / count:.2f}"]
            best[peak.lanes] = max(best.get(peak.lanes, 0.0), per_second)
        section.add(name, count, *cells)
    section.notes = [
        f"peak: {best[1] / 1e9:.1f} and {best[widest()] / 1e9:.1f} · 10⁹ operations per second, measured in "
        "turn with each model: independent fused multiply–adds, of which each counts as two",
        "machine code alone, on a thousand states; a flat call from Python costs a microsecond or two more",
        "random bodies have dense moment tensors, plates sparse ones",
    ]
    return section


def robots() -> dict[str, Robot]:
    """The paper's plate with more modes, and U-P-S robots with more legs."""
    plates = {f"paper, N = {modes}": pf.robots.gough_stewart(modes) for modes in (0, 10, 40)}
    others = {"flexible Delta, N = 9": delta(), "6 legs, random body, N = 40": zoo.ups(6, 40).robot}
    return (
        plates
        | others
        | {
            f"{legs} legs, random body, N = {modes}": zoo.ups(legs, modes).robot
            for modes in (0, 10)
            for legs in (6, 12, 24)
        }
    )
