"""The robots that files may start from, each a file in this folder, and a move that suits each."""

from typing import NamedTuple


class Start(NamedTuple):
    """A displacement and a rotation vector from home, as trajectory files have them."""

    position: str
    rotation: str


STARTS = {
    "gough-stewart": Start('["100 mm", "-80 mm", "60 mm"]', '["6 deg", "3 deg", "-5 deg"]'),
    "hexapod": Start('["20 mm", "-15 mm", "10 mm"]', '["3 deg", "2 deg", "-4 deg"]'),
    "rus6": Start('["40 mm", "-30 mm", "50 mm"]', '["6 deg", "3 deg", "-6 deg"]'),
    "pus6": Start('["150 mm", "-40 mm", "50 mm"]', '["6 deg", "3 deg", "-5 deg"]'),
    "rps3": Start('[0, 0, "60 mm"]', '["7 deg", 0, 0]'),
    "prs3": Start('[0, 0, "80 mm"]', '["7 deg", 0, 0]'),
    "delta": Start('["150 mm", "-100 mm", "50 mm"]', "[0, 0, 0]"),
    "nano-hexapod": Start('["50 um", "-40 um", "30 um"]', '["0.2 mrad", "0.1 mrad", "-0.3 mrad"]'),
    "octapod": Start('["40 mm", "-30 mm", "30 mm"]', '["3 deg", "2 deg", "-3 deg"]'),
}
