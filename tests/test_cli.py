"""The command: what it writes, what it says, how it fails."""

import subprocess
import sys

import numpy as np
import pytest

import parflex as pf
from parflex import cli


@pytest.fixture
def parflex(monkeypatch, capsys, tmp_path):
    """Runs the command in an empty folder; gives exit code, output and errors."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["parflex", *words])
        code = 0
        try:
            cli.run()
        except SystemExit as stop:
            code = int(stop.code or 0)
        out, err = capsys.readouterr()
        return code, out, err

    return run


def test_paper_leaves_result_and_pictures(parflex, tmp_path):
    code, out, err = parflex("paper", "--modes", "3", "--out", "here", "--format", "svg")
    assert code == 0, err
    assert "largest position error" in out
    saved = pf.load_result(tmp_path / "here" / "result.nc")
    assert saved.dataset.sizes["mode"] == 3
    assert len(list((tmp_path / "here").glob("*.svg"))) == 8


def test_rigid_paper(parflex, tmp_path):
    code, _, err = parflex("paper", "--rigid", "--out", ".")
    assert code == 0, err
    assert pf.load_result("result.nc").dataset.sizes["mode"] == 0
    assert not (tmp_path / "modes.png").exists()


def test_modes_of_a_rectangle(parflex, tmp_path):
    corners = [word for corner in ("0,0", "0.6,0", "0.6,0.4", "0,0.4") for word in ("-c", corner)]
    code, out, err = parflex("modes", *corners, "--thickness", "0.01", "--young", "70e9", "--poisson",
                             "0.33", "--density", "2700", "--modes", "4")  # fmt: skip
    assert code == 0, err
    assert "mass 6.4800 kg, centre of mass (0.3, 0.2) m" in out
    assert "Table 2" not in out
    assert (tmp_path / "parflex-modes" / "modes.png").stat().st_size > 10_000


def test_modes_of_the_paper_are_compared(parflex):
    _, out, _ = parflex("modes", "--modes", "10")
    assert "Table 2" in out
    assert "-8.84 %" in out
    assert "cut a degenerate pair" in out


def test_doctor_passes(parflex):
    code, out, _ = parflex("doctor")
    assert code == 0
    assert f"numpy │ {np.__version__}" in " ".join(out.split())
    assert out.count("pass") >= 5
    assert "FAIL" not in out


def test_help_teaches(parflex):
    _, out, _ = parflex("--help")
    for word in ("paper", "modes", "doctor", "Start with"):
        assert word in out
    _, out, _ = parflex("paper", "--help")
    assert "parflex paper --modes 11" in out
    _, out, _ = parflex("--version")
    assert pf.__version__ in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("paper", "--frequencies", "measured"), "frequencies is 'measured'"),
        (("paper", "--modes", "-2"), "modes is -2"),
        (("paper", "--backend", "fortran"), "backend is 'fortran'"),
        (("paper", "--format", "bmp"), "--format is 'bmp'"),
        (("modes", "-c", "0;0"), "--corner is '0;0'"),
        (("modes", "-c", "0,0", "-c", "1,0"), "polygon has 2 corners"),
        (("modes", "--poisson", "0.7"), "poisson is 0.7"),
    ],
)
def test_errors_are_one_sentence(parflex, tmp_path, words, message):
    code, out, err = parflex(*words)
    assert code == 2
    assert message in err
    assert "Traceback" not in out + err
    assert not any(path.suffix == ".nc" for path in tmp_path.rglob("*"))


def test_unwritable_folder(parflex, tmp_path):
    (tmp_path / "taken").write_text("a file")
    code, _, err = parflex("paper", "--rigid", "--out", "taken")
    assert code == 2
    assert "taken" in err


def test_module_runs_as_a_program():
    done = subprocess.run(
        [sys.executable, "-m", "parflex", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == f"parflex {pf.__version__}"
