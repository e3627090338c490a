"""Files to start from: a robot and a trajectory, with comments that explain them."""

from importlib.resources import files
from pathlib import Path

from parflex.app.json_schema import schema_text
from parflex.base.errors import InputError
from parflex.base.writing import replacing

ALL_ROBOTS = ("gough-stewart",)  # each a file in this folder


def write_templates(name: Path, robot: str = "gough-stewart", force: bool = False) -> tuple[Path, ...]:
    """Write a robot file, a trajectory file beside it, and their schemas for editors.

    Raises InputError for an unknown robot, and for files that are there already unless `force`.
    """
    if robot not in ALL_ROBOTS:
        raise InputError(f"--robot is {robot!r}; choose {' or '.join(ALL_ROBOTS)}")
    target = name if name.suffix == ".toml" else name.with_name(f"{name.name}.toml")
    trajectory = target.with_name(f"{target.stem}.trajectory.toml")
    for path in (target, trajectory):
        if path.exists() and not force:
            raise InputError(f"{path} is there already; choose another name, or replace it with --force")
    for path, template, schema in ((target, robot, "robot"), (trajectory, "trajectory", "trajectory")):
        text = (files(__name__) / f"{template}.toml").read_text(encoding="utf-8")
        words = text.replace("{robot}", target.name).replace("{trajectory}", trajectory.name)
        write(path, f"#:schema ./{schema}.schema.json\n{words}")
        write(path.with_name(f"{schema}.schema.json"), schema_text(schema))
    return target, trajectory


def write(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    with replacing(path) as part:
        part.write(text.encode())
