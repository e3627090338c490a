"""Every example runs, in a folder of its own, and leaves its picture; so does the README's snippet."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from places import DOCS, ROOT

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(source: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "ignore:.*cut a degenerate pair", "-c", source],
        cwd=folder,
        capture_output=True,
        text=True,
        env=os.environ | {"MPLBACKEND": "Agg"},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example, tmp_path):
    run(example.read_text(), tmp_path)
    (picture,) = tmp_path.glob("*.png")
    assert picture.stat().st_size > 10_000


def test_there_are_examples():
    assert len(EXAMPLES) >= 3


@pytest.mark.slow
def test_snippet_on_parameters(tmp_path):
    (snippet,) = re.findall(r"```python\n(.*?)```", (DOCS / "parameters.md").read_text(), re.DOTALL)
    run(snippet + "assert acc.platform.shape == (10_000, 6) and not run.partial", tmp_path)


def test_snippet_of_the_readme(tmp_path):
    (snippet,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert len(snippet.strip().splitlines()) <= 15
    run(snippet, tmp_path)
    assert (tmp_path / "push.nc").exists()


def test_snippet_on_drives(tmp_path):
    snippets = re.findall(r"```python\n(.*?)```", (DOCS / "flexible-legs.md").read_text(), re.DOTALL)
    (snippet,) = [each for each in snippets if "drive_stiffness" in each]
    run(snippet + "assert np.allclose(np.array(squeezed) * 80, -forces), motors", tmp_path)


def test_snippets_on_vibration(tmp_path):
    """One after the other, as the page has them, python-control's apart."""
    snippets = re.findall(r"```python\n(.*?)```", (DOCS / "vibration.md").read_text(), re.DOTALL)
    run("".join(each for each in snippets if "import control" not in each), tmp_path)
    assert {path.stem for path in tmp_path.glob("*.png")} == {"bode", "nyquist", "poles", "six_by_six"}
