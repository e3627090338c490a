"""`parflex modes`: materials, units, discs and joints anywhere."""

import numpy as np
import pytest

import parflex as pf
from parflex.app.measures import coordinates, measured
from parflex.base import kinds

PLATE = [word for corner in ("0,0", "0.6,0", "0.6,0.4", "0,0.4") for word in ("-c", corner)]
ALL_NAMES = ", ".join(pf.fe.MATERIALS)


@pytest.fixture
def step_file(tmp_path):
    occ = pytest.importorskip("netgen.occ")
    occ.Box((0, 0, 0), (400, 300, 20)).WriteStep(str(tmp_path / "part.step"))


JOINTS = [word for at in ("0.04,0.04,0", "0.36,0.04,0", "0.2,0.26,0") for word in ("-a", at)]


def test_a_file_without_a_material_is_refused(parflex, tmp_path, step_file):
    """With the names it knows, before anything is meshed or written."""
    code, out, err = parflex("modes", "part.step", *JOINTS)
    assert code == 2
    words = " ".join(err.split())
    assert words == (
        f"error --material is not given; name one of {ALL_NAMES}, or give its --young, --poisson and "
        "--density"
    )
    assert "meshing" not in out
    assert not list(tmp_path.rglob("*.h5"))


def test_neither_material_nor_joints(parflex, tmp_path, step_file):
    """The material is missed first, with the names it knows, then the joints; a file that is not there before
    either."""
    for body in (["part.step"], ["--disc", "340 mm", "--thickness", "20 mm"]):
        code, _, err = parflex("modes", *body)
        assert code == 2
        assert " ".join(err.split()).startswith(f"error --material is not given; name one of {ALL_NAMES}, or")
    code, _, err = parflex("modes", "part.step", "-m", "steel")
    assert (code, err.split()[1:5]) == (2, ["--attach", "is", "not", "given;"])
    code, _, err = parflex("modes", "parts.step")
    assert code == 2
    assert " ".join(err.split()) == "error parts.step: there is no such file; did you mean part.step?"


def test_the_robot_file_that_is_told_finds_the_modes(parflex, tmp_path):
    """The line as it is printed, in a file beside the folder."""
    held = [word for at in ("0.1,0.1", "0.5,0.2", "0.2,0.3") for word in ("-a", f"{at},0")]
    code, out, err = parflex("modes", *PLATE, "--thickness", "10 mm", "-m", "steel", "--modes", "1", *held)
    assert code == 0, err
    [line] = [line for line in out.splitlines() if "platform = {" in line]
    words = line[line.index("platform = {") :]
    assert words == 'platform = { kind = "modal", file = "parflex-modes/modes.h5" }'
    strut = "{ mass = 1, length = 0.4 }"
    legs = "".join(
        f"[[leg]]\nchain = 'a'\norigin = [{x}, {y}, -0.5]\nattachments = [{k}]\n"
        for k, (x, y) in enumerate([(0.3, 0), (-0.3, 0), (0, 0.3)])
    )
    home = "home = { position = [0, 0, 0] }"
    chain = f"[chain.a]\ntype = 'UPS'\ncylinder = {strut}\nrod = {strut}\n"
    text = f'format = "parflex-robot-1"\n{home}\n{words}\n{chain}{legs}'
    (tmp_path / "robot.toml").write_text(text, encoding="utf-8")
    assert len(pf.load_robot("robot.toml").platform.attachments) == 3


def test_the_material_is_printed_and_kept(parflex, step_file):
    code, out, err = parflex(
        "modes", "part.step", *JOINTS, "-m", "Cast-Iron", "--size", "80 mm", "--radius", "4 cm"
    )
    assert code == 0, err
    words = " ".join(out.replace("│", " ").split())
    assert "material cast iron: E = 1.1e+11 N/m², ν = 0.26, ρ = 7200 kg/m³ (EN-GJL-250: EN 1561" in words
    assert "mass 17.28 kg" in words
    assert pf.fe.read_modes("parflex-modes/modes.h5").materials == (pf.fe.material("cast iron"),)


def test_numbers_are_kept_too(parflex):
    numbers = ("--young", "70 GPa", "--poisson", "0.33", "--density", "2.7 g/cm^3")
    code, out, err = parflex("modes", *PLATE, "--thickness", "1 cm", *numbers, "--modes", "3")
    assert code == 0, err
    assert "E = 7e+10 N/m², ν = 0.33, ρ = 2700 kg/m³" in " ".join(out.split())
    (made,) = pf.fe.read_modes("parflex-modes/modes.h5").materials
    assert (made.young, made.poisson, made.density) == pytest.approx((70e9, 0.33, 2700.0), rel=1e-15)
    assert made.name == ""


def test_the_papers_plate_has_its_own(parflex):
    code, out, err = parflex("modes", "--modes", "1")
    assert code == 0, err
    assert "E = 2e+10 N/m², ν = 0.3, ρ = 7500 kg/m³" in " ".join(out.split())


def test_joints_may_be_anywhere_on_a_plate(parflex):
    """Two inside, one on an edge, the tool in the middle of nowhere: places, and the same first frequency."""
    held = [word for at in ("100 mm,0.1 m,0", "0.5,0.1,0", "30 cm,40 cm,0") for word in ("-a", at)]
    words = ("modes", *PLATE, "--thickness", "10 mm", "-m", "steel")
    code, _, err = parflex(*words, *held, "--tool", "0.31,0.22,0", "--modes", "4")
    assert code == 0, err
    found = pf.fe.read_modes("parflex-modes/modes.h5")
    centre = np.array([0.3, 0.2, 0.0])
    assert np.allclose(
        found.nodes[list(found.corners)] + centre, [(0.1, 0.1, 0), (0.5, 0.1, 0), (0.3, 0.4, 0)]
    )
    assert np.allclose(found.nodes[found.tool] + centre, (0.31, 0.22, 0))
    corners = [(0, 0), (0.6, 0), (0.6, 0.4), (0, 0.4)]
    plain = pf.fe.plate_modes(corners, 0.01, n_modes=4, material="steel")
    assert np.isclose(found.frequencies[0], plain.frequencies[0], rtol=1e-5)


def test_a_ring(parflex):
    pytest.importorskip("netgen.occ")
    held = [word for at in ("150 mm,0,0", "-75 mm,130 mm,0", "-75 mm,-130 mm,0") for word in ("-a", at)]
    ring = (
        "--disc",
        "340 mm",
        "--bore",
        "60 mm",
        "--thickness",
        "20 mm",
        "--size",
        "40 mm",
        "--radius",
        "3 cm",
    )
    code, _, err = parflex("modes", *ring, *held, "-m", "aluminium", "--modes", "3")
    assert code == 0, err
    assert "warning" not in err
    found = pf.fe.read_modes("parflex-modes/modes.h5")
    assert np.isclose(found.moments.m, 2700 * 0.02 * np.pi * (0.17**2 - 0.03**2), rtol=2e-3)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*PLATE, "--thickness", "1 cm", "-m", "alumnium"), "did you mean 'aluminium'? It can be"),
        ((*PLATE, "--thickness", "1 cm", "-m", "steel", "--young", "70 GPa"), "--young is given, and"),
        ((*PLATE, "--thickness", "1 cm", "--young", "70 GPa"), "--poisson is not given, but --young is"),
        ((*PLATE, "--thickness", "1 cm", "--young", "70 GPa", "--poisson", "0.7", "--density", "2700"),
         "poisson is 0.7; it must lie between -1 and 0.5"),
        ((*PLATE, "-m", "steel"), "--thickness is not given"),
        (("-m", "steel"), "neither a file nor --corner or --disc is given"),
        (("--thickness", "1 cm"), "neither a file nor --corner or --disc is given"),
        ((*PLATE, "--thickness", "20 kg", "-m", "steel"), '--thickness is "20 kg", which is not a length'),
        ((*PLATE, "--thickness", "20 mmm", "-m", "steel"), '--thickness is "20 mmm", but "mmm" is no unit'),
        ((*PLATE, "--thickness", "thick", "-m", "steel"), '--thickness is "thick"; expected a length in m'),
        ((*PLATE, "--thickness", "1 cm", "-m", "steel", "-a", "0.7,0.1,0", "-a", "0.1,0.1,0"),
         "joint 1 at (0.7, 0.1, 0) is off the plate, 0.1 m from its edge"),
        ((*PLATE, "--thickness", "1 cm", "-m", "steel", "-a", "20,0,5 mm"), "of which 20 has no unit"),
        ((*PLATE, "--disc", "1 m", "--thickness", "1 cm", "-m", "steel"), "--corner and --disc are both"),
        ((*PLATE, "--bore", "1 cm", "--thickness", "1 cm", "-m", "steel"), "--bore is given without --disc"),
        (("--disc", "340 mm", "--thickness", "1 cm", "-m", "steel"), "--attach is not given"),
        (("part.step", "--disc", "340 mm", "-m", "steel", *JOINTS), "describe a plate; leave them"),
        (("--from", "nastran", "-m", "steel"), "--from imports modes"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_sentence(parflex, tmp_path, words, message):
    code, out, err = parflex("modes", *words)
    assert code == 2
    assert message in " ".join(err.split())
    assert "Traceback" not in out + err
    assert not list(tmp_path.rglob("*.h5"))


@pytest.mark.filterwarnings("always")
def test_absurd_values_are_warned_of_in_one_line(parflex):
    given = ("--young", "70", "--poisson", "0.33", "--density", "2.7")
    code, _, err = parflex("modes", *PLATE, "--thickness", "10 mm", *given, "--modes", "1")
    assert code == 0
    first, second = err.splitlines()
    assert first == 'warning young is 70 Pa, less than any material of machines has; did you mean "70 GPa"?'
    assert second.startswith("warning density is 2.7 kg/m^3")
    assert second.endswith('did you mean "2.7 g/cm^3"?')
    _, _, err = parflex("modes", *PLATE, "--thickness", "10", "-m", "steel", "--modes", "1")
    assert err.splitlines()[0] == 'warning thickness is 10 m on a plate of 0.6 m; did you mean "10 mm"?'


def test_measures_are_numbers_or_carry_units():
    assert measured("--thickness", "0.02", kinds.LENGTH) == 0.02
    assert measured("--thickness", "2 cm", kinds.LENGTH) == pytest.approx(0.02)
    assert measured("--young", "70e9", kinds.PRESSURE) == 70e9
    assert measured("--young", "10 Mpsi", kinds.PRESSURE) == pytest.approx(6.894757e10)
    assert coordinates("--attach", "0.1,-2e-1, 0") == (0.1, -0.2, 0.0)
    assert coordinates("--attach", "100 mm, -20cm,0") == pytest.approx((0.1, -0.2, 0.0))


def test_help_names_the_materials(parflex):
    _, out, _ = parflex("modes", "--help")
    assert ALL_NAMES in " ".join(out.replace("│", " ").split())
