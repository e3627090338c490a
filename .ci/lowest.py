"""The lowest versions that pyproject.toml allows of the dependencies and of extras, as constraints."""

import re
import sys
import tomllib
from pathlib import Path

project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
rows = project["dependencies"] + [
    row for extra in sys.argv[1:] for row in project["optional-dependencies"][extra]
]
for row in rows:
    name, lowest = re.match(r"([\w.-]+)>=([\w.]+)", row).groups()
    print(f"{name}=={lowest}")
