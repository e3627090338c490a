"""The robots that files may start from, each a file in this folder, and a move that suits each."""

from typing import NamedTuple


class Start(NamedTuple):
    """A displacement and a rotation vector from home, as trajectory files have them, and the components of
    the pose that control follows, where a robot has fewer than six freedoms."""

    position: str
    rotation: str
    rows: str = ""


STARTS = {
    "gough-stewart": Start('["100 mm", "-80 mm", "60 mm"]', '["6 deg", "3 deg", "-5 deg"]'),
    "hexapod": Start('["20 mm", "-15 mm", "10 mm"]', '["3 deg", "2 deg", "-4 deg"]'),
    "rus6": Start('["40 mm", "-30 mm", "50 mm"]', '["6 deg", "3 deg", "-6 deg"]'),
    "pus6": Start('["150 mm", "-40 mm", "50 mm"]', '["6 deg", "3 deg", "-5 deg"]'),
    "rps3": Start('[0, 0, "60 mm"]', '["7 deg", 0, 0]', "[2, 3, 4]  # it rises, rolls and pitches"),
    "prs3": Start('[0, 0, "80 mm"]', '["7 deg", 0, 0]', "[2, 3, 4]  # it rises, rolls and pitches"),
    "delta": Start('["150 mm", "-100 mm", "50 mm"]', "[0, 0, 0]", "[0, 1, 2]  # it moves and does not turn"),
    "octapod": Start('["40 mm", "-30 mm", "30 mm"]', '["3 deg", "2 deg", "-3 deg"]'),
}
