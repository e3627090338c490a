"""Ctrl-C at random instants: the command says that it was interrupted, and what is kept."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import parflex as pf
from parflex.app.templates import write_templates

pytestmark = pytest.mark.skipif(os.name == "nt", reason="there are no signals here")

INSTANTS = int(os.environ.get("PARFLEX_INSTANTS", "5"))  # of each command; 30 for the whole


def begun(folder: Path, *words: str) -> subprocess.Popen:
    """The command, which says when Ctrl-C is heard; what a shell runs in the background would ignore it."""
    code = (
        "import signal; from parflex.app import start\n"
        "signal.signal(signal.SIGINT, start.heard); print('heard', flush=True); start.run()"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("interrupted")
    _, trajectory = write_templates(folder / "robot.toml")
    trajectory.write_text(trajectory.read_text().replace("100 mm", "10 mm"))
    return folder


COMMANDS = {
    "simulate": ("simulate", "robot.toml", "--trajectory", "robot.trajectory.toml"),
    "modes": ("modes", "--modes", "12", "--refine", "3"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_at_any_instant_it_says_so_and_what_is_kept(folder, name):
    """What it says that it keeps is there and whole; nothing half written lies about."""
    rng = np.random.default_rng(2)
    whole, started = begun(folder, *COMMANDS[name]), time.monotonic()
    _, said = whole.communicate()
    assert whole.returncode == 0, said
    lasting = time.monotonic() - started
    for k in range(INSTANTS):
        out = folder / f"{name}-{k}"
        process = begun(folder, *COMMANDS[name], "--out", str(out))
        assert process.stdout.readline() == "heard\n"
        time.sleep(0.01 + 0.9 * lasting * (k + rng.random()) / INSTANTS)
        early = process.poll() is None
        process.send_signal(signal.SIGINT)
        told, said = process.communicate()
        if not early:  # it was quicker this time
            continue
        if process.returncode == 0:  # Ctrl-C came when all was done
            assert "see it move" in told or "holds the platform" in told, said
            continue
        assert process.returncode == 130, said
        assert "Traceback" not in said
        last = said.strip().splitlines()[-1]
        assert last.startswith("interrupted; "), said
        files = [] if "nothing" in last else last.split("kept: ")[1].split(", ")
        assert {str(each) for each in out.glob("*")} == {str(folder / each) for each in files}
        for each in files:
            if each.endswith("result.nc"):
                assert pf.load_result(folder / each).partial == ("stopped at" in told)


def test_before_anything_is_loaded(folder):
    process = begun(folder, "doctor")
    assert process.stdout.readline() == "heard\n"
    time.sleep(0.1)  # it is importing
    process.send_signal(signal.SIGINT)
    _, said = process.communicate()
    assert (process.returncode, said) == (130, "interrupted; there was nothing to keep yet\n")


def test_usage_errors_and_endings_are_as_before(folder):
    for words, code in ((("--version",), 0), (("nonsense",), 2), (("check", "no.toml"), 2)):
        process = begun(folder, *words)
        process.communicate()
        assert process.returncode == code
