"""The borders of the code: what may import what, how large files are, and what must be documented."""

import ast
import importlib
import inspect
import pkgutil
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import parflex as pf

STOREYS = (
    *("base", "robot", "mechanics", "kernels", "compiled", "analysis", "linear", "model"),
    *("fe", "robots", "files", "simulation", "export", "views", "app"),
)
NUMPY_ALONE = STOREYS[: STOREYS.index("kernels") + 1]
ROOT = Path(pf.__file__).parent
MODULES = {
    ".".join(["parflex", *path.relative_to(ROOT).with_suffix("").parts]).removesuffix(".__init__"): path
    for path in sorted(ROOT.rglob("*.py"))
}


def storey(name):
    """The height of a module; the root's files, which open the house, are above all others."""
    folder = name.split(".")[1:2]
    return STOREYS.index(*folder) if folder and folder != ["__main__"] else len(STOREYS)


def imported(name):
    """The modules that a module imports: at its head, inside functions, and for types alone."""
    for node in ast.walk(ast.parse(MODULES[name].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in MODULES)
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name} imports relatively"
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                yield from [each for each in (whole, node.module) if each in MODULES][:1]


def test_imports_go_down():
    """No module imports one of a higher storey."""
    upward = {(name, each) for name in MODULES for each in imported(name) if storey(each) > storey(name)}
    assert upward == set()


def test_no_circles_of_imports():
    """The modules can be put in an order where each imports earlier ones alone; a circle is named."""
    order = TopologicalSorter({name: set(imported(name)) for name in MODULES}).static_order()
    assert set(order) == MODULES.keys()


def test_files_are_short():
    """Three lie loose at the root; none has more than 300 lines."""
    loose = {path.name for path in ROOT.iterdir() if path.is_file()}
    assert loose == {"__init__.py", "__main__.py", "py.typed"}
    lines = {name: len(path.read_text(encoding="utf-8").splitlines()) for name, path in MODULES.items()}
    assert {name: count for name, count in lines.items() if count > 300} == {}


def test_mechanics_imports_numpy_alone():
    """Importing it in a fresh interpreter loads no other package than NumPy."""
    code = (
        "import sys; before = set(sys.modules)\n"
        + "".join(f"import {name}\n" for name in MODULES if storey(name) < len(NUMPY_ALONE))
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
    for path in MODULES.values():
        inside = path.relative_to(ROOT).parts[0]
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
