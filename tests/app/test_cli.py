"""The command: what it writes, what it says, how it fails."""

import subprocess
import sys

import numpy as np
import pytest

import parflex as pf


def test_paper_leaves_result_and_pictures(parflex, tmp_path):
    code, out, err = parflex("paper", "--modes", "2", "--out", "here", "--format", "svg")
    assert code == 0, err
    assert "largest position error" in out
    saved = pf.load_result(tmp_path / "here" / "result.nc")
    assert saved.dataset.sizes["mode"] == 2
    assert len(list((tmp_path / "here").glob("*.svg"))) == 8


def test_rigid_paper(parflex, tmp_path):
    code, _, err = parflex("paper", "--rigid", "--out", ".")
    assert code == 0, err
    assert pf.load_result("result.nc").dataset.sizes["mode"] == 0
    assert not (tmp_path / "modes.png").exists()


def test_modes_of_a_rectangle(parflex, tmp_path):
    corners = [word for corner in ("0,0", "0.6,0", "0.6,0.4", "0,0.4") for word in ("-c", corner)]
    code, out, err = parflex("modes", *corners, "--thickness", "10 mm", "--young", "70 GPa",
                             "--poisson", "0.33", "--density", "2.7 g/cm^3", "--modes", "4")  # fmt: skip
    assert code == 0, err
    words = " ".join(out.split())
    assert "mass │ 6.48 kg" in words
    assert "centre of mass │ (0.3, 0.2, 0) m" in words
    assert "Table 2" not in out
    assert (tmp_path / "parflex-modes" / "modes.png").stat().st_size > 10_000


def test_modes_of_the_paper_are_compared(parflex):
    _, out, _ = parflex("modes", "--modes", "10")
    assert "Table 2" in out
    assert "-8.84 %" in out
    assert "cut a degenerate pair" in out


def test_modes_of_a_step_file(parflex, tmp_path):
    """Report, picture, and a modal file that holds what the report says."""
    occ = pytest.importorskip("netgen.occ")
    occ.Box((0, 0, 0), (400, 300, 20)).WriteStep("plate.step")
    joints = [word for at in ("0.04,0.04,0", "0.36,0.04,0", "0.2,0.26,0") for word in ("-a", at)]
    code, out, err = parflex("modes", "plate.step", *joints, "--tool", "0.2,0.15,0.02", "--radius", "0.04",
                             "--size", "0.08", "--material", "aluminium", "--damping", "0.01")  # fmt: skip
    assert code == 0, err
    words = " ".join(out.split())
    assert "mass │ 6.48 kg" in words
    assert "rigid modes │ 6, their stiffness" in words
    assert "static compliance │ right to" in words
    found = pf.fe.read_modes(tmp_path / "parflex-modes" / "modes.h5")
    assert f"{found.frequencies[0]:.3f}" in words
    assert np.all(found.frequency_error[:3] < 0.05)
    assert found.corners == tuple(range(found.tool - 3, found.tool))
    assert (tmp_path / "parflex-modes" / "modes.png").stat().st_size > 10_000


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


def test_help_names_the_importers_and_their_files(parflex):
    _, out, _ = parflex("modes", "--help")
    words = " ".join(out.replace("│", " ").split())
    for importer in pf.fe.IMPORTERS:
        assert importer.takes in words
    assert "mm-tonne-s" in words


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("paper", "--frequencies", "measured"), "frequencies is 'measured'"),
        (("paper", "--modes", "-2"), "modes is -2"),
        (("paper", "--backend", "fortran"), "backend is 'fortran'"),
        (("paper", "--format", "bmp"), "--format is 'bmp'"),
        (("modes", "-c", "0;0"), "--corner is '0;0'"),
        (("modes", "-c", "0,0", "-c", "1,0", "--thickness", "1 cm", "-m", "steel"), "polygon has 2 corners"),
        (("modes", "plate.step"), "--material is not given; name one of"),
        (("modes", "plate.step", "-m", "steel"), "--attach is not given"),
        (("modes", "plate.vtu", "-a", "0,0,0", "-m", "steel"), "unit is not given"),
        (("modes", "plate.step", "-a", "0,0"), "--attach is '0,0'; write it as \"x,y,z\""),
        (("modes", "none.step", "-a", "0,0,0", "-m", "steel"), "none.step: there is no such file"),
    ],
)
def test_errors_are_one_sentence(parflex, tmp_path, words, message):
    for name in ("plate.step", "plate.vtu"):
        (tmp_path / name).touch()
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


def test_from_a_template_to_a_run(parflex, tmp_path):
    code, out, err = parflex("init", "mine.toml")
    assert code == 0, err
    assert "parflex simulate mine.toml --trajectory mine.trajectory.toml" in out
    assert (tmp_path / "mine.toml").read_text().startswith("#:schema ./robot.schema.json\n")
    code, out, err = parflex("check", "mine.toml", "--out", "seen")
    assert code == 0, err
    for words in ("Gough-Stewart robot", "RRP*", "73.07 kg", "403.9 476.6", "101.3 deg", "kept"):
        assert words in out
    assert (tmp_path / "seen" / "mine.png").stat().st_size > 10_000
    way = tmp_path / "mine.trajectory.toml"
    way.write_text(way.read_text().replace("1.2 s", "0.3 s").replace("100 mm", "10 mm"))
    code, out, err = parflex("simulate", "mine.toml", "--trajectory", way.name, "--out", "run")
    assert code == 0, err
    assert "largest position error" in out
    saved = pf.load_result(tmp_path / "run" / "result.nc")
    assert saved.dataset.attrs["robot"] == "Gough-Stewart robot"
    assert [saved.dataset.sizes[dim] for dim in ("time", "mode", "leg")] == [201, 7, 6]
    pictures = {path.stem for path in (tmp_path / "run").glob("*.png")}
    assert pictures == {"robot", "forces", "energy", "deformation", "accelerations"}


def test_init_keeps_what_is_there(parflex, tmp_path):
    (tmp_path / "robot.trajectory.toml").write_text("mine")
    code, _, err = parflex("init")
    assert code == 2
    assert "robot.trajectory.toml is there already" in err
    assert not (tmp_path / "robot.toml").exists()
    assert parflex("init", "--force")[0] == 0
    assert (tmp_path / "robot.trajectory.toml").read_text() != "mine"


def test_check_tells_limits_and_reach(parflex, tmp_path):
    parflex("init")
    path = tmp_path / "robot.toml"
    good = path.read_text()
    path.write_text(good.replace('"0.7 m"', '"1.03 m"'))
    code, out, err = parflex("check", "robot.toml")
    assert code == 0, err
    assert out.count("is beyond") == 2
    home = "position = [0.25, 0.4330127018922193, 1.0]"
    path.write_text(good.replace(home, "position = [0.35, 0.2330127018922193, 0]"))  # corner 0 on its base
    code, out, err = parflex("check", "robot.toml")
    assert code == 2
    assert "RRP*" in out
    assert "leg" in err
    assert "Traceback" not in out + err


def test_a_run_that_stops_is_kept(parflex, tmp_path):
    """Without forces the robot falls and never comes to its last output time."""
    parflex("init")
    (tmp_path / "fall.toml").write_text(
        'format = "parflex-trajectory-1"\nstart = "home"\n[[move]]\nduration = 9\n'
        '[controller]\nkind = "joint-pd"\nkp = 0\nkd = 0\n'
    )
    path = tmp_path / "robot.toml"
    path.write_text(path.read_text().replace("modes = 7", "modes = 0"))
    code, out, err = parflex("simulate", "robot.toml", "--trajectory", "fall.toml", "--out", "run")
    assert code == 1, err
    assert "the result is partial" in out
    assert "warning" not in err
    assert pf.load_result("run/result.nc").partial


def test_complaints_about_files_are_one_line_each(parflex, tmp_path):
    parflex("init")
    path = tmp_path / "robot.toml"
    path.write_text(path.read_text().replace("thickness", "thicknes").replace('"0.7 m"', '"0.7 kg"'))
    code, _, err = parflex("check", "robot.toml")
    assert code == 2
    first, second = err.splitlines()
    assert "platform.thicknes is not known; did you mean thickness?" in first
    assert second.startswith("robot.toml:")
    assert 'is "0.7 kg", which is not a length' in second


def test_newcomers_are_greeted_with_three_commands(parflex):
    code, out, err = parflex()
    assert code == 0, err
    for line in (
        "parflex paper",
        "parflex view parflex-paper/result.nc",
        "parflex init",
        "--install-completion",
    ):
        assert line in out
    assert len(out.splitlines()) <= 12


def test_nearest_names(parflex, tmp_path):
    _, _, err = parflex("papper")
    assert "Did you mean 'paper'?" in err
    (tmp_path / "result.nc").write_text("")
    code, _, err = parflex("view", "reslut.nc")
    assert code == 2
    assert "did you mean result.nc?" in err


@pytest.mark.slow
def test_paper_ends_with_what_to_do_next_and_that_works(parflex, tmp_path):
    code, out, err = parflex("paper", "--modes", "2", "--out", "here")
    assert code == 0, err
    assert "pictures in here" in out
    for verb, file in (("view", "robot.html"), ("report", "report.html")):
        assert f"parflex {verb} here/result.nc" in out
        option = "--export" if verb == "view" else "--out"
        code, said, err = parflex(verb, "here/result.nc", option, f"sent/{file}")
        assert code == 0, err
        assert file in said
        assert (tmp_path / "sent" / file).stat().st_size > 100_000


def test_what_cannot_be_shown_writes_nothing(parflex, tmp_path):
    (tmp_path / "result.nc").write_bytes(b"not a result")
    for words in (("view", "result.nc", "--export", "x.html"), ("report", "result.nc", "--out", "x.html")):
        code, _, err = parflex(*words)
        assert code == 2
        assert "is damaged or no NetCDF-4 file" in err
    assert parflex("view", "result.nc", "--port", "99999")[0] == 2
    assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]


def test_names_with_brackets_are_told_as_they_are(parflex, tmp_path):
    _, out, _ = parflex("init", "[bold]mine.toml")
    assert "parflex simulate [bold]mine.toml --trajectory [bold]mine.trajectory.toml" in out
    for words in (("check", "[bold]mine.toml"), ("modes", "--modes", "1", "--refine", "1")):
        code, out, err = parflex(*words, "--out", "[red]seen")
        assert code == 0, err
        assert "drawn in [red]seen/" in out
    seen = {path.name for path in (tmp_path / "[red]seen").iterdir()}
    assert seen == {"[bold]mine.png", "modes.png", "modes.h5"}


def test_pictures_replace_older_ones_or_leave_them(tmp_path):
    """A folder in the place of a picture: nothing is written beside it."""
    drawn = {name: pf.plot.figure(1.0, 1.0) for name in ("first", "second")}
    assert pf.plot.save(drawn, tmp_path / "new", "svg") == [tmp_path / "new" / f"{n}.svg" for n in drawn]
    before = (tmp_path / "new" / "first.svg").read_text()
    assert before.startswith("<?xml")
    (tmp_path / "new" / "second.png").mkdir()
    with pytest.raises(pf.InputError, match=r"second.png was not written"):
        pf.plot.save(drawn, tmp_path / "new")
    left = {path.name for path in (tmp_path / "new").iterdir()}
    assert left == {"first.svg", "second.svg", "first.png", "second.png"}
