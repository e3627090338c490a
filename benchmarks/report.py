"""What was found: sections of rows, printed, and kept as JSON and Markdown."""

import json
import os
import platform
import time
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.timing import Time

RESULTS = Path(__file__).parent / "results"
PACKAGES = ("parflex", "numpy", "scipy", "casadi", "llvmlite", "pin", "mujoco", "exudyn")


@dataclass
class Section:
    """The answer to one question: rows below a head, and what a reader must know."""

    title: str
    head: tuple[str, ...]
    rows: list[tuple[Any, ...]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def add(self, *cells: Any) -> None:
        """One more row."""
        self.rows.append(cells)


def race(section: Section, times: dict[str, Time]) -> None:
    """A row per contender: µs, the quartiles, and its ratio to the first of them."""
    first = next(iter(times.values())).median
    for name, found in times.items():
        quartiles = f"{micro(found.low)} … {micro(found.high)}"
        section.add(name, micro(found.median), quartiles, f"{found.median / first:.3g}")


def micro(seconds: float) -> str:
    """Microseconds, three digits."""
    return f"{1e6 * seconds:.4g}" if seconds >= 1e-3 else f"{1e6 * seconds:.3g}"


def machine() -> dict[str, Any]:
    """Where and when it was measured."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "load at the start": f"{os.getloadavg()[0]:.2f}" if hasattr(os, "getloadavg") else "unknown",
        "date": time.strftime("%Y-%m-%d %H:%M"),
    } | {name: version(name) for name in PACKAGES}


def processor() -> str:
    """As the system calls it."""
    path = Path("/proc/cpuinfo")
    if path.exists():
        for line in path.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor()


def show(section: Section, console: Console) -> None:
    """Print a section."""
    table = Table(*section.head, title=section.title, title_justify="left")
    for row in section.rows:
        table.add_row(*map(str, row))
    console.print(table)
    for note in section.notes:
        console.print(f"  {note}", style="dim", highlight=False)


def save(where: dict[str, Any], sections: list[Section], name: str) -> list[Path]:
    """`results/<name>.json` and `.md`."""
    RESULTS.mkdir(exist_ok=True)
    paths = [RESULTS / f"{name}.json", RESULTS / f"{name}.md"]
    data = {"machine": where, "sections": [asdict(section) for section in sections]}
    paths[0].write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n")
    paths[1].write_text(markdown(where, sections))
    return paths


def markdown(where: dict[str, Any], sections: list[Section]) -> str:
    """The sections as Markdown."""
    lines = ["# Timings", "", "; ".join(f"{key} {value}" for key, value in where.items()), ""]
    for section in sections:
        lines += [f"## {section.title}", ""]
        lines += ["| " + " | ".join(section.head) + " |", "|---" * len(section.head) + "|"]
        lines += ["| " + " | ".join(map(str, row)) + " |" for row in section.rows]
        lines += ["", *(f"- {note}" for note in section.notes), ""]
    return "\n".join(lines)
