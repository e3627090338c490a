"""The words of `parflex modes` about what it found."""

from math import isnan, pi
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table

from parflex.app.terminal import console

if TYPE_CHECKING:
    from parflex.fe import ComputedModes
    from parflex.robot.modes import Modes


def report(found: "ComputedModes", table_2: tuple[float, ...]) -> None:
    """Print frequencies, notes, and the check report with the materials."""
    from parflex.fe import check_rows

    console.print(frequency_table(found, table_2))
    for note in found.notes:
        console.print(f"[yellow]note[/] {escape(note)}")
    table = Table("check", "found", title=escape(found.source), title_justify="left")
    for row in check_rows(found):
        table.add_row(*map(escape, row))
    for material in found.materials:
        table.add_row("material", escape(str(material)))
    console.print(table)


def frequency_table(found: "Modes", table_2: tuple[float, ...]) -> Table:
    """Frequencies, their estimated error, and the published ones where there are any."""
    heads = ["mode", "rad/s", "Hz", "change from coarser mesh"]
    table = Table(*heads, *(["Table 2", "difference"] if table_2 else []), title="Elastic modes")
    for k, omega in enumerate(found.frequencies):
        error = found.frequency_error[k]
        change = "unknown" if isnan(error) else f"{100 * error:.3f} %"
        row = [f"{k + 1}", f"{omega:.3f}", f"{omega / (2 * pi):.3f}", change]
        if k < len(table_2):
            row += [f"{table_2[k]:.3f}", f"{100 * (omega / table_2[k] - 1):+.2f} %"]
        table.add_row(*row)
    return table
