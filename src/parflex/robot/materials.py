"""Materials that platforms and links are made of, by name: room temperature, rounded as their sources do."""

from parflex.base.errors import InputError
from parflex.base.nearest import nearest
from parflex.robot.material import Material

MATERIALS: dict[str, Material] = {
    name: Material(young, poisson, density, name, source)
    for name, young, poisson, density, source in (
        ("aluminium", 70e9, 0.33, 2700.0, "EN 1999-1-1, 3.2.5; ν of 6061: MIL-HDBK-5J, 3.6.2"),
        ("steel", 210e9, 0.3, 7850.0, "EN 1993-1-1, 3.2.6; ρ: EN 1991-1-1, A.4"),
        ("stainless steel", 200e9, 0.3, 7900.0, "EN 10088-1, 1.4301; ν: EN 1993-1-4, 2.1.3"),
        ("titanium", 110e9, 0.31, 4430.0, "Ti-6Al-4V: MIL-HDBK-5J, 5.4.1"),
        ("magnesium", 45e9, 0.35, 1770.0, "AZ31B: MIL-HDBK-5J, 4.2.1"),
        ("cast iron", 110e9, 0.26, 7200.0, "EN-GJL-250: EN 1561, annex A"),
        ("ductile iron", 169e9, 0.275, 7100.0, "EN-GJS-400-15: EN 1563, annex C"),
        (
            *("CFRP quasi-isotropic", 60e9, 0.3, 1550.0),
            "between AS4/3501-6 (Daniel and Ishai 2006) and T300/5208 (Tsai and Hahn 1980), laminated",
        ),
        ("granite", 70e9, 0.25, 2900.0, "makeitfrom.com, granite; stones differ, E 40 … 90 GPa"),
        ("mineral casting", 40e9, 0.25, 2400.0, "epoxy-bound; data sheets of makers, E 30 … 45 GPa"),
        ("invar", 141e9, 0.26, 8050.0, "Invar 36: Paquin, Handbook of Optics II, ch. 35"),
        ("silicon carbide", 415e9, 0.16, 3160.0, "sintered α-SiC: Munro, J. Phys. Chem. Ref. Data 26, 1997"),
        ("alumina", 416e9, 0.231, 3984.0, "sintered α-alumina: Munro, J. Am. Ceram. Soc. 80, 1997"),
        ("Zerodur", 90.3e9, 0.24, 2530.0, "Schott, Zerodur"),
    )
}


def named(name: str) -> Material:
    """The material of a name: "aluminium", "steel" … (`MATERIALS`); capitals and hyphens do not matter.

    Raises InputError for a name that it does not know, with the nearest one that it does.

    >>> named("cast-iron").density
    7200.0
    """
    known = {plain(each): each for each in MATERIALS}
    if not isinstance(name, str) or plain(name) not in known:
        hint = nearest(plain(str(name)), known)
        raise InputError(
            f"material is {name!r}, which is not known; "
            + (f"did you mean {known[hint]!r}? " if hint else "")
            + f"It can be {names()}, or numbers: young, poisson and density"
        )
    return MATERIALS[known[plain(name)]]


def plain(name: str) -> str:
    """A name without capitals and hyphens."""
    return " ".join(name.lower().replace("-", " ").replace("_", " ").split())


def names() -> str:
    """The names of all materials, as a list in a sentence."""
    return ", ".join(MATERIALS)


def chosen(
    material: Material | str | None = None,
    young: float | None = None,
    poisson: float | None = None,
    density: float | None = None,
    mark: str = "",
) -> Material:
    """The material of a name, or of its three numbers in SI units; mark begins the fields' names in errors.

    Raises InputError where both are given, or neither, or not all numbers.
    """
    numbers = {"young": young, "poisson": poisson, "density": density}
    given = [f"{mark}{field}" for field, value in numbers.items() if value is not None]
    lacking = [f"{mark}{field}" for field, value in numbers.items() if value is None]
    if material is not None:
        if given:
            raise InputError(f"{given[0]} is given, and {mark}material too; leave out one of the two")
        return material if isinstance(material, Material) else named(material)
    if young is None or poisson is None or density is None:
        words = f"{lacking[0]} is not given, but {given[0]} is: " if given else ""
        raise InputError(
            f"{words or f'{mark}material is not given; '}name one of {names()}"
            f", or give its {mark}young, {mark}poisson and {mark}density"
        )
    return Material(young, poisson, density)
