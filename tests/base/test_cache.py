"""The cache of machine code: nothing is taken from it that somebody else could have put there."""

import os
import stat
import threading
from pathlib import Path

import numpy as np
import pytest

from parflex.base import cache

pytestmark = pytest.mark.skipif(not hasattr(os, "getuid"), reason="there are no owners of files here")

KEY, GOOD = "0" * 64, cache.Entry(b"good", [np.eye(2)], [np.ones(3)])
EVIL = GOOD._replace(code=b"evil")
OTHERS = 12345  # a user


@pytest.fixture
def place(tmp_path, monkeypatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv(cache.VARIABLE, str(folder))
    cache.save(KEY, GOOD)
    return folder


@pytest.fixture
def evil(tmp_path, monkeypatch) -> Path:
    """A whole entry of the same key, with other code."""
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "elsewhere"))
    cache.save(KEY, EVIL)
    return tmp_path / "elsewhere" / f"{KEY}.bin"


def given_away(path: Path) -> None:
    if os.getuid():
        pytest.skip("only root gives files to others")
    os.chown(path, OTHERS, -1)


def test_the_folder_is_the_users_alone(place):
    assert stat.S_IMODE(place.stat().st_mode) == 0o700
    assert cache.load(KEY).code == b"good"


CHANGES = {
    "group may write": lambda path: path.chmod(0o620),
    "all may write": lambda path: path.chmod(0o602),
    "another's": given_away,
}


@pytest.mark.parametrize("change", CHANGES)
def test_entries_of_others_are_not_read(place, change):
    CHANGES[change](place / f"{KEY}.bin")
    assert cache.load(KEY) is None


@pytest.mark.parametrize("change", CHANGES)
def test_folders_of_others_are_neither_read_nor_used(place, change):
    CHANGES[change](place)
    assert cache.load(KEY) is None
    before = set(place.iterdir())
    with pytest.warns(UserWarning, match="no code is kept there; chmod 700"):
        cache.save("1" * 64, GOOD)
    assert set(place.iterdir()) == before


def test_links_are_not_followed(evil, place):
    entry = place / f"{KEY}.bin"
    entry.unlink()
    entry.symlink_to(evil)
    assert cache.load(KEY) is None


def test_a_folder_that_is_a_link_is_not_used(evil, place, tmp_path, monkeypatch):
    (tmp_path / "link").symlink_to(evil.parent)
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "link"))
    assert cache.load(KEY) is None


def test_an_entry_tells_its_key(place):
    """One that is renamed is none: code for another robot or processor."""
    os.rename(place / f"{KEY}.bin", place / f"{'1' * 64}.bin")
    assert cache.load("1" * 64) is None


@pytest.mark.parametrize("name", ["PARFLEX_CACHE", "XDG_CACHE_HOME"])
def test_paths_are_absolute(place, tmp_path, monkeypatch, name):
    """A folder's own `cache` is not the user's, whoever made it."""
    monkeypatch.delenv(cache.VARIABLE)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv(name, "cache")
    monkeypatch.chdir(tmp_path)
    if name == cache.VARIABLE:
        with pytest.warns(UserWarning, match="give an absolute path"):
            assert cache.folder() is None
    else:
        assert cache.folder() == tmp_path / "home" / ".cache" / "parflex"


def swaps(entry: Path, evil: Path, kind: str) -> list:
    """Two ways to put a file in the entry's place by turns: the user's own, and the attacker's."""
    own = entry.read_bytes()

    def put(make) -> None:
        beside = entry.with_suffix(".swap")
        beside.unlink(missing_ok=True)
        make(beside)
        os.replace(beside, entry)

    def good(path: Path) -> None:
        path.write_bytes(own)
        path.chmod(0o600)

    def bad(path: Path) -> None:
        if kind == "link":
            path.symlink_to(evil)
            return
        path.write_bytes(evil.read_bytes())
        path.chmod(0o602) if kind == "open" else os.chown(path, OTHERS, -1)

    return [lambda: put(good), lambda: put(bad)]


@pytest.mark.parametrize("tries", [1000, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["link", "open", "another's"])
def test_a_swap_between_check_and_read(evil, place, kind, tries):
    """An attacker who may write to the folder exchanges entries all the time."""
    if kind == "another's" and os.getuid():
        pytest.skip("only root gives files to others")
    good, bad = swaps(place / f"{KEY}.bin", evil, kind)
    over = threading.Event()

    def attack() -> None:
        while not over.is_set():
            good()
            bad()

    attacker = threading.Thread(target=attack)
    attacker.start()
    try:
        found = [cache.load(KEY) for _ in range(tries)]
    finally:
        over.set()
        attacker.join()
    codes = [entry.code for entry in found if entry is not None]
    assert set(codes) == {b"good"}
    assert 0 < len(codes) < tries  # both were met
