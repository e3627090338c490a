"""Ask all questions, or those that are named: `python -m benchmarks [agreement] [models] …`."""

import argparse
import time

from rich.console import Console

from benchmarks.questions import ALL
from benchmarks.report import machine, save, show


def main() -> None:
    """Agreement comes first: what does not agree is not timed."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    parser.add_argument("questions", nargs="*", help=", ".join(ALL))
    chosen = parser.parse_args().questions or list(ALL)
    unknown = sorted(set(chosen) - set(ALL))
    if unknown:
        parser.error(f"there is no question {unknown[0]!r}; choose from {', '.join(ALL)}")
    console, where, sections = Console(), machine(), []
    console.width = max(console.width, 120)
    console.print(where)
    for name in chosen:
        found = ALL[name]()
        for section in found if isinstance(found, list) else [found]:
            show(section, console)
            sections.append(section)
    for path in save(where, sections, time.strftime("%Y%m%d-%H%M%S")):
        console.print(f"written: {path}", highlight=False)


if __name__ == "__main__":
    main()
