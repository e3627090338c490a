"""Do all compute the same robot? Each is asked, by the very calls that are timed, what the oracle knows."""

import numpy as np

from benchmarks import robots
from benchmarks.report import Section
from benchmarks.rivals import flexible_rivals, rigid_rivals
from benchmarks.rivals.base import Rival


def ask() -> Section:
    """max |Δ| / max(1, max |x|) against the tests' oracle; raises where one is not the same robot."""
    head = "robot", "program and way", "direct", "inverse"
    section = Section("Agreement with an independent oracle", head)
    cases = {
        "rigid, four states in motion": (rigid_rivals, robots.moving(0)),
        "rigid, at rest": (rigid_rivals, robots.at_rest(0)),
        f"N = {robots.MODES}, four states in motion": (flexible_rivals, robots.moving(robots.MODES)),
        f"N = {robots.MODES}, released from q_e = 0": (flexible_rivals, robots.at_rest(robots.MODES)),
    }
    for robot, (kinds, sample) in cases.items():
        for kind in kinds():
            rival = kind(sample)
            direct, inverse = (errors(rival, question) for question in ("direct", "inverse"))
            for way in direct | inverse:
                found = [errors_of.get(way) for errors_of in (direct, inverse)]
                section.add(robot, f"{rival.name}, {way}", *("–" if e is None else f"{e:.1e}" for e in found))
                worst = max(e for e in found if e is not None)
                if worst > rival.tolerance:
                    raise SystemExit(f"{rival.name}, {way}: {robot} differs by {worst:.1e}; nothing is timed")
            note = f"{rival.name} {rival.remark}"
            if rival.remark and note not in section.notes:
                section.notes.append(note)
    return section


def errors(rival: Rival, question: str) -> dict[str, float]:
    """The largest error of each way over all states."""
    sample, worst = rival.sample, {}
    for s in range(len(sample.forces)):
        if question == "direct":
            wanted = np.concatenate([sample.direct.platform[s], sample.direct.elastic[s]])
        else:
            wanted = sample.inverse.forces[s]
        for way, task in getattr(rival, question)(s).items():
            task.call()
            error = np.max(np.abs(task.answer() - wanted)) / np.max(np.abs(wanted), initial=1.0)
            worst[way] = max(worst.get(way, 0.0), float(error))
    return worst
