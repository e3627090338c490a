"""Timings of parflex beside the programs that can do the same; `make bench`.

The robots are those of the tests, with their states on the closure and the tests' independent oracle.
"""

import sys
import warnings
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path.append(str(ROOT / "tests" / "support"))
sys.exudynFast = True  # Exudyn without range checks, chosen before its first import
warnings.filterwarnings("ignore", message=".*cut a degenerate pair.*")
