"""Files are whole or as they were: links, permissions, devices, and what killed processes leave."""

import os
import stat
import subprocess
import sys
import threading

import pytest

import parflex as pf
from parflex.base.writing import PART, replacing


def write(path, data: bytes = b"new") -> None:
    with replacing(path) as part:
        part.write(data)


def test_folders_are_made_and_nothing_else_is_left(tmp_path):
    write(tmp_path / "a" / "b" / "file")
    assert (tmp_path / "a" / "b" / "file").read_bytes() == b"new"
    assert os.listdir(tmp_path / "a" / "b") == ["file"]


def test_links_are_followed(tmp_path):
    """As when the file is opened and written: to the place that the user has for large files."""
    (tmp_path / "disk").mkdir()
    (tmp_path / "disk" / "run.nc").write_bytes(b"old")
    for link, place in (("there", "run.nc"), ("not yet", "next.nc")):
        (tmp_path / link).symlink_to(os.path.join("disk", place))
        write(tmp_path / link)
        assert (tmp_path / link).is_symlink()
        assert (tmp_path / "disk" / place).read_bytes() == b"new"
    assert sorted(os.listdir(tmp_path / "disk")) == ["next.nc", "run.nc"]


def test_a_link_to_itself_is_refused(tmp_path):
    (tmp_path / "ring").symlink_to("ring")
    with pytest.raises(pf.InputError, match="ring was not written"):
        write(tmp_path / "ring")
    assert os.listdir(tmp_path) == ["ring"]


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o666, 0o755])
def test_permissions_are_kept(tmp_path, mode):
    """Private files stay private, and are so while they are written."""
    path = tmp_path / "file"
    path.write_bytes(b"old")
    path.chmod(mode)
    with replacing(path) as part:
        assert stat.S_IMODE(os.fstat(part.fileno()).st_mode) & ~mode == 0
        part.write(b"new")
    assert stat.S_IMODE(path.stat().st_mode) == mode


def test_new_files_have_the_users_permissions(tmp_path):
    mask = os.umask(0o027)
    try:
        write(tmp_path / "file")
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == 0o640


@pytest.mark.skipif(os.name == "nt" or os.getuid() == 0, reason="root may write to all files")
def test_what_is_protected_is_not_replaced(tmp_path):
    (tmp_path / "file").write_bytes(b"old")
    (tmp_path / "file").chmod(0o444)
    with pytest.raises(pf.InputError, match="may not be written to"):
        write(tmp_path / "file")


@pytest.mark.parametrize(("kind", "words"), [("/dev/null", "device"), ("pipe", "pipe"), ("folder", "folder")])
def test_what_is_no_file_is_refused(tmp_path, kind, words):
    path = tmp_path / kind  # an absolute path as it is
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    before = os.lstat(path)
    with pytest.raises(pf.InputError, match=f"was not written: it is a {words}; what was there is untouched"):
        write(path)
    assert os.lstat(path).st_mode == before.st_mode
    assert [each for each in os.listdir(tmp_path) if each.endswith(PART)] == []


@pytest.mark.parametrize("name", ["nul\0.nc", "half\ud800.nc", "x" * 300])
def test_names_that_no_disk_takes_are_refused(tmp_path, name):
    with pytest.raises(pf.InputError, match="was not written"):
        write(tmp_path / name)
    assert os.listdir(tmp_path) == []


def test_an_error_of_the_block_leaves_the_old_file(tmp_path):
    write(tmp_path / "file", b"old")

    def failing() -> None:
        with replacing(tmp_path / "file") as part:
            part.write(b"half")
            raise KeyError

    with pytest.raises(KeyError):
        failing()
    assert (tmp_path / "file").read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["file"]


def test_parts_of_killed_processes_are_swept_and_others_are_not(tmp_path):
    """A part is left when nobody holds it: another process amid its writing is not disturbed."""
    code = (
        "import sys; from pathlib import Path; from parflex.base.writing import replacing\n"
        "with replacing(Path(sys.argv[1])) as part:\n"
        "    part.write(b'theirs'); print('ready', flush=True); input()"
    )
    child = [sys.executable, "-c", code, str(tmp_path / "run.nc")]
    killed, alive = (
        subprocess.Popen(child, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for _ in range(2)
    )
    assert [each.stdout.readline() for each in (killed, alive)] == ["ready\n"] * 2
    killed.kill()
    killed.communicate()
    assert len([name for name in os.listdir(tmp_path) if name.endswith(PART)]) == 2
    (tmp_path / ".other.nc.0.part").write_bytes(b"of another file")
    write(tmp_path / "run.nc", b"ours")
    parts = [name for name in os.listdir(tmp_path) if name.endswith(PART)]
    assert len(parts) == 2
    alive.communicate("\n")
    assert alive.returncode == 0
    assert (tmp_path / "run.nc").read_bytes() == b"theirs"
    assert sorted(os.listdir(tmp_path)) == [".other.nc.0.part", "run.nc"]


def test_threads_write_the_same_file(tmp_path):
    """Each is whole, whoever is last; none takes another's part for a left one."""
    failed = []

    def work(letter: bytes) -> None:
        for _ in range(50):
            try:
                write(tmp_path / "file", 10_000 * letter)
            except pf.InputError as error:
                failed.append(error)

    threads = [threading.Thread(target=work, args=(letter,)) for letter in (b"a", b"b", b"c")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    data = (tmp_path / "file").read_bytes()
    assert (len(data), len(set(data))) == (10_000, 1)
    assert os.listdir(tmp_path) == ["file"]
