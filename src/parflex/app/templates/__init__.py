"""Files to start from: a robot and a trajectory, with comments that explain them."""

from importlib.resources import files
from pathlib import Path

from parflex.app.templates.starts import STARTS, Start
from parflex.base.errors import InputError
from parflex.base.nearest import nearest
from parflex.base.writing import replacing


def write_templates(name: Path, robot: str = "gough-stewart", force: bool = False) -> tuple[Path, ...]:
    """Write a robot file, a trajectory file beside it, and their schemas for editors.

    Raises InputError for an unknown robot, and for files that are there already unless `force`.
    """
    from parflex.app.json_schema import schema_text

    if robot not in STARTS:
        close = nearest(robot, STARTS)
        hint = f"did you mean {close}? There are" if close else "there are"
        raise InputError(f"--robot is {robot!r}, which is not known; {hint} {', '.join(STARTS)}")
    target = name if name.suffix == ".toml" else name.with_name(f"{name.name}.toml")
    trajectory = target.with_name(f"{target.stem}.trajectory.toml")
    for path in (target, trajectory):
        if path.exists() and not force:
            raise InputError(f"{path} is there already; choose another name, or replace it with --force")
    for path, template, schema in ((target, robot, "robot"), (trajectory, "trajectory", "trajectory")):
        text = (files(__name__) / f"{template}.toml").read_text(encoding="utf-8")
        words = filled(text, STARTS[robot]).replace("{robot}", target.name)
        words = words.replace("{trajectory}", trajectory.name)
        write(path, f"#:schema ./{schema}.schema.json\n{words}")
        write(path.with_name(f"{schema}.schema.json"), schema_text(schema))
    return target, trajectory


def filled(text: str, start: Start) -> str:
    """The text of a trajectory file with a move that suits the robot."""
    return text.replace("{position}", start.position).replace("{rotation}", start.rotation)


def write(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    with replacing(path) as part:
        part.write(text.encode())
