"""The borders of the code: what the mechanics may import, and what must be documented."""

import ast
import importlib
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import parflex as pf

MECHANICS = ("base", "robot", "mechanics", "kernels")


def modules(folders):
    """The names of all modules of folders."""
    root = Path(pf.__file__).parent
    for folder in folders:
        for path in sorted((root / folder).rglob("*.py")):
            yield ".".join(["parflex", *path.relative_to(root).with_suffix("").parts]).removesuffix(
                ".__init__"
            )


def test_mechanics_imports_numpy_alone():
    """Importing it in a fresh interpreter loads no other package than NumPy."""
    code = (
        "import sys; before = set(sys.modules)\n"
        + "".join(f"import {name}\n" for name in modules(MECHANICS))
        + "print(*sorted({m.split('.')[0] for m in set(sys.modules) - before}))"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    third_party = set(loaded.stdout.split()) - set(sys.stdlib_module_names) - {"numpy", "parflex"}
    third_party = {name for name in third_party if not name.startswith("_")}
    assert third_party == set()


def test_heavy_tools_stay_at_the_rim():
    """Each is imported in its own folder or modules only."""
    homes = {
        "casadi": ("compiled", "export"),
        "llvmlite": ("compiled", "simulation"),
        "skfem": ("fe",),
        "pyyeti": ("fe",),
        "matplotlib": ("views",),
        "typer": ("app",),
        "k3d": ("views",),
        "jinja2": ("views",),
        "netgen": ("fe",),
        "meshio": ("fe",),
        "pydantic": ("files", "app"),
        "pint": ("files",),
        "tomli_w": ("files",),
    }
    root = Path(pf.__file__).parent
    for path in root.rglob("*.py"):
        inside = path.relative_to(root).parts[0]
        for tool, allowed in homes.items():
            if any(f"{word}{tool}" in path.read_text() for word in ("import ", "from ", 'extra("')):
                assert inside in allowed, f"{path.name} imports {tool}"


def public_objects():
    """Every name of the public face, and the public methods of its classes."""
    for name in pf.__all__:
        thing = getattr(pf, name)
        if inspect.ismodule(thing):
            continue
        yield name, thing
        if inspect.isclass(thing):
            for method, value in inspect.getmembers(thing, inspect.isfunction):
                if not method.startswith("_") and value.__qualname__.startswith(thing.__name__):
                    yield f"{name}.{method}", value
    for module in (pf.fe, pf.robots):
        for name in module.__all__:
            if callable(getattr(module, name)):
                yield f"{module.__name__}.{name}", getattr(module, name)


@pytest.mark.parametrize(("name", "thing"), list(public_objects()))
def test_public_names_are_documented(name, thing):
    text = inspect.getdoc(thing)
    assert text, f"{name} has no docstring"
    source = inspect.getsource(thing)
    if "raise InputError" in source and not inspect.isclass(thing):
        assert "Raises" in text or "raises" in text, f"{name} raises InputError and does not say so"


def test_every_module_says_what_it_is():
    for module in pkgutil.walk_packages(pf.__path__, "parflex."):
        if module.name != "parflex.__main__":
            assert importlib.import_module(module.name).__doc__, module.name


def test_docstrings_name_their_subject_first():
    """A sentence that begins with one of these has no subject at first reading."""
    broken = []
    for path in sorted(Path(pf.__file__).parent.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
                words = (ast.get_docstring(node) or "").split()
                if words[:1] and words[0] in ("Of", "What", "Whether", "Those", "How"):
                    broken.append((path.name, getattr(node, "name", "module"), words[0]))
    assert broken == []


def test_import_is_light():
    """`import parflex` alone loads nothing heavy: what is needed comes at first use."""
    code = "import sys, parflex; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"casadi", "matplotlib", "xarray", "skfem", "scipy", "numpy", "pydantic", "pint"}
    assert not heavy & set(loaded.stdout.split())


def test_unknown_names_are_attribute_errors():
    with pytest.raises(AttributeError, match="no attribute 'Modell'"):
        _ = pf.Modell
