"""Where the repository keeps what the tests read."""

from pathlib import Path

DATA = Path(__file__).parent / "data"
TESTS = Path(__file__).parents[1]
ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
