"""How long does one direct or inverse model take?"""

from benchmarks import robots
from benchmarks.report import Section, race
from benchmarks.rivals import flexible_rivals, rigid_rivals
from benchmarks.rivals.base import Rival
from benchmarks.timing import alternate
from sample import Sample


def ask() -> list[Section]:
    """All programs in turn, in motion, and at rest, where some have less to do."""
    return [
        one(rigid_rivals(), 0, "Rigid platform"),
        one(flexible_rivals(), robots.MODES, f"Flexible platform, N = {robots.MODES}"),
    ]


def one(kinds: tuple[type[Rival], ...], modes: int, title: str) -> Section:
    """Direct and inverse model of one robot."""
    section = Section(f"{title}: one model", ("model, program and way", "µs", "quartiles", "ratio"))
    moving, resting = robots.moving(modes), robots.at_rest(modes)
    race(section, alternate(ways(kinds, moving, "direct", "in motion")))
    race(section, alternate(ways(kinds, resting, "direct", "at rest")))
    race(section, alternate(ways(kinds, moving, "inverse", "in motion")))
    return section


def ways(kinds: tuple[type[Rival], ...], sample: Sample, question: str, where: str) -> dict:
    """The calls of all programs for one model at the first state of the sample."""
    return {
        f"{question}, {where}: {rival.name}, {way}": task.call
        for rival in (kind(sample) for kind in kinds)
        for way, task in getattr(rival, question)(0).items()
    }
