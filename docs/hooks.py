"""What the documentation is built from beside its pages: snippets run, tables come from code and tests."""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import equations
from given import GIVEN
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = Path(__file__).parent.parent
MEASURED = ROOT / "build" / "verification.json"
SNIPPET = re.compile(r"^```(python|sh)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PRINTED = re.compile(r"<!-- printed: (.*) -->")
MADE = (".png", ".svg", ".html")

printed: dict[str, str] = {}  # by each page's snippets


def on_files(files: Any, config: Any) -> Any:
    """Run the snippets of all pages; the pictures and pages that they leave belong to the documentation."""
    pages = list(files.documentation_pages())
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for page, made in zip(pages, pool.map(made_by, pages), strict=True):
            for path, content in made.items():
                files.append(
                    File.generated(config, f"made/{Path(page.src_uri).stem}/{path}", content=content)
                )
    return files


def made_by(page: File) -> dict[str, bytes]:
    """The files that the snippets of a page leave, run in order, each language in one process."""
    name, snippets = page.src_uri, SNIPPET.findall(Path(page.abs_src_path).read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        for give in GIVEN.get(name, ()):
            give(Path(folder))
        for language in ("sh", "python"):
            code = "\n".join(body for kind, body in snippets if kind == language)
            if code:
                printed[name] = run(name, language, code, Path(folder))
        found = [path for path in Path(folder).rglob("*") if path.suffix in MADE]
        return {str(path.relative_to(folder)): path.read_bytes() for path in found}


def run(name: str, language: str, code: str, folder: Path) -> str:
    """What a page's code prints where its commands are found; an error ends the build."""
    shell = {"python": [sys.executable], "sh": ["bash", "-euo", "pipefail"]}[language]
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1", "PATH": path}  # a core each
    done = subprocess.run(
        [*shell, "-c", code], cwd=folder, capture_output=True, text=True, env=environment, timeout=600
    )
    if done.returncode:
        raise PluginError(f"a {language} snippet of docs/{name} fails:\n{done.stdout}{done.stderr}")
    return done.stdout


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Put what is generated in the place of its marks."""
    for mark, make in MARKS.items():
        if mark in markdown:
            markdown = markdown.replace(mark, make())
    return PRINTED.sub(lambda mark: paragraph(printed[page.file.src_uri], mark[1]), markdown)


def paragraph(text: str, start: str) -> str:
    """The line of a page's output that begins with a word, and what is indented below it."""
    found = re.search(rf"^{start}\b.*\n(?: .*\n)*", text, re.MULTILINE)
    if not found:
        raise PluginError(f"no snippet printed a line that begins with {start!r}")
    return f"```text\n{found[0]}```"


def paper() -> str:
    """Every equation of the paper beside the lines of code that it is."""
    wrong = equations.contradictions(equations.every_equation(), equations.lines())
    if wrong:
        raise PluginError("; ".join(wrong))
    return equations.beside_the_code()


def verification() -> str:
    """Tables of what the tests measured, a file of tests each."""
    if not MEASURED.is_file():
        raise PluginError(f"{MEASURED.relative_to(ROOT)} is missing; run the tests first: python -m pytest")
    by_file: dict[str, list[dict[str, Any]]] = {}
    for row in json.loads(MEASURED.read_text(encoding="utf-8")).values():
        by_file.setdefault(row["file"], []).append(row)
    parts = []
    for file, rows in by_file.items():
        lines = [
            (in_a_line(row["what"]), f"{row['bound']:.1e}", f"{row['measured']:.1e}", str(row["cases"]))
            for row in rows
        ]
        subject = in_a_line(rows[0]["subject"]).rstrip(".")
        heads = ("what, against what", "bound", "measured", "cases")
        parts.append(f"### {subject}\n\n`tests/{file}`\n\n{table(heads, lines)}")
    count = sum(len(rows) for rows in by_file.values())
    return f"{count} tests, the worst case of each.\n\n" + "\n\n".join(parts)


def in_a_line(words: str) -> str:
    """Without the breaks of a docstring."""
    return " ".join(words.split())


def reference() -> str:
    """A directive for every public name."""
    import parflex as pf

    def objects(module: Any, names: list[str]) -> list[str]:
        things = (getattr(module, name) for name in names)
        return [f"::: {thing.__module__}.{thing.__qualname__}" for thing in things if callable(thing)]

    chapters = {
        "parflex": objects(pf, pf.__all__),
        "parflex.fe: platforms": objects(pf.fe, pf.fe.__all__),
        "parflex.robots: the gallery": objects(pf.robots, pf.robots.__all__),
    }
    return "\n\n".join(f"# {title}\n\n" + "\n\n".join(found) for title, found in chapters.items())


def variables() -> str:
    """Every variable of a result."""
    from parflex.simulation.variables import ALL_VARIABLES

    def row(name: str, dims: tuple[str, ...], units: Any, words: str) -> tuple[str, ...]:
        return f"`{name}`", ", ".join(dims), units if isinstance(units, str) else "N, or N m", words

    rows = [row(each.name, each.dims, each.units, each.words) for each in ALL_VARIABLES]
    return table(("variable", "dimensions", "unit", ""), rows)


def table(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """Markdown; bars in cells are told apart from those of the table."""
    lines = [heads, ("---",) * len(heads), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "&#124;") for cell in line) + " |" for line in lines)


MARKS = {
    "<!-- equations -->": paper,
    "<!-- errata -->": lambda: table(("where", "what is wrong"), equations.errata()),
    "<!-- verification -->": verification,
    "<!-- reference -->": reference,
    "<!-- variables -->": variables,
}
