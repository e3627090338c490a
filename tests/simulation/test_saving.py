"""A run outlives its disk: where that is full, or a process killed, the old file or the new one is whole."""

import os
import resource
import shutil
import subprocess
import sys

import numpy as np
import pytest

import parflex as pf
from parflex.simulation.simulate import simulate

TIMES = 20

PRELUDE = """
import os, random, resource, signal, sys, time
from pathlib import Path
import numpy as np, xarray as xr
import parflex as pf
from parflex.fe.modal_file import load_body, save_body

folder, times, limit = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
path = os.path.join(folder, "run.nc")

def run(value, count=20_000):
    data = xr.Dataset({"a": ("x", np.full(count, value) + np.random.default_rng(0).random(count))})
    return pf.Result(lambda: data.assign_attrs(format="parflex-result-1", stopped=""), "")

def refused(save):
    try:
        save()
    except pf.InputError as error:
        return "was not written" in str(error) and "untouched" in str(error)
    return False
"""

# The disk holds one result, not a second beside it; what is the user's is then saved elsewhere
FULL = """
pf.robots.gough_stewart(3).to_file(os.path.join(folder, "robot.toml"))
body, platform = pf.robots.gough_stewart(3).platform, os.path.join(folder, "robot.platform.nc")
small, large = run(0.0, 100), run(1.0, 200_000)
small.save(path)
before = {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder))}
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
else:
    with open(os.path.join(folder, "filler"), "wb", buffering=0) as filler:
        try:
            while True:
                filler.write(bytes(1000))
        except OSError:
            pass
kept = sorted(os.listdir(folder))
saves = (lambda: large.save(path), lambda: save_body(body, Path(platform)),
         lambda: pf.View(1_000_000 * "x").save(os.path.join(folder, "robot.html")))
said = [refused(save) for _ in range(times) for save in saves]
whole = all(open(os.path.join(folder, name), "rb").read() == data for name, data in before.items())
print(all(said), len(said), whole, sorted(os.listdir(folder)) == kept, large.dataset.sizes["x"])
"""

# A child saves two results by turns, until it is killed at a random moment
KILLED = """
old, new = run(0.0), run(1.0)
old.save(path)
random.seed(5)
whole, left = 0, 0
for _ in range(times):
    child = os.fork()
    if child == 0:
        while True:
            new.save(path)
            old.save(path)
    time.sleep(0.02 + 0.05 * random.random())
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    left += len(os.listdir(folder)) > 1
    first = float(xr.load_dataset(path, engine="h5netcdf")["a"][0])
    whole += int(first) in (0, 1)
    old.save(path)
    assert os.listdir(folder) == ["run.nc"], os.listdir(folder)
print(whole, times, left > 0)
"""


def told(code: str, folder, limit: int = 0, before: tuple[str, ...] = ()) -> list[str]:
    """The words that a process prints at its end, which it must live to see."""
    done = subprocess.run(
        [*before, sys.executable, "-c", PRELUDE + code, str(folder), str(TIMES), str(limit)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_limit_of_file_sizes(tmp_path):
    assert told(FULL, tmp_path, limit=1) == ["True", str(3 * TIMES), "True", "True", "200000"]


def on_small_disk(folder) -> tuple[str, ...]:
    """A command before another: it sees a disk of 1 MB there, which ends with it."""
    mount = f"mount -t tmpfs -o size=1m tmpfs '{folder}' && exec \"$@\""
    found = ("unshare", "--mount", "--map-root-user", "sh", "-c", mount, "sh")
    if shutil.which("unshare") is None or subprocess.run([*found, "true"], capture_output=True).returncode:
        pytest.skip("this machine lets nobody mount a small disk")
    return found


def test_a_full_disk(tmp_path):
    found = told(FULL, tmp_path, before=on_small_disk(tmp_path))
    assert found == ["True", str(3 * TIMES), "True", "True", "200000"]
    assert os.listdir(tmp_path) == []  # it was the other disk


def test_processes_killed_while_they_save(tmp_path):
    """Whole each time, and the next save leaves nothing else; the kills did hit the writing."""
    assert told(KILLED, tmp_path) == [str(TIMES), str(TIMES), "True"]


def test_a_run_is_kept_for_another_disk(model_of, tmp_path):
    """What could not be saved is still there, and saved where there is room."""
    model = model_of(0)
    state, forces = model.equilibrium(*model.robot.home_pose)
    result = simulate(model, forces, state, np.linspace(0, 0.01, 3))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(pf.InputError, match="was not written: File too large; what was there"):
            result.save(tmp_path / "run.nc")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    again = pf.load_result(result.save(tmp_path / "run.nc"))
    assert again.dataset.identical(result.dataset)
