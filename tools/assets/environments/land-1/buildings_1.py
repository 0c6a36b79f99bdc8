"""Three quarters of a town between hills."""

from __future__ import annotations

import numpy as np
from common.images import packed
from common.land import block, ground
from common.materials import material
from common.objects import exact, viewpoint
from common.parts import rotation
from common.shapes import rectangle
from common.sky import sky, sunshine
from common.textures import speckle
from common.town import Masonry

#: name, position, size and centre of the bounding box, angle about Z
BLOCKS = (
    ("City.1", (36.3, -46.5, 15.7), (37.4, 43.2, 31.2), (0, 0, 0), 0.0),
    ("City.2", (-34.4, 0.499, 6.38), (47.6, 15.4, 12.6), (0, 0, 0), 0.0),
    ("City.3", (18.3, 41.8, 13.6), (42.1, 67.9, 14.9), (0, 0, 0.612), -1.11),
)


def build() -> None:
    sky("#a9cfe8")
    sunshine(3.2, (0.7, 0.3, 0.6))
    level = [place for number, city in enumerate(BLOCKS) for place in below(*city[1:])]
    ground([*level, (0, -15, 0), (0, 0, 0), (-25, -30, 0), (-40, 30, 2.0)], dip=-0.16, rise=11.14, seed=6)
    far = material(
        "Plain", "#7fa65a", 1.0, image=packed("plain.jpg", speckle(256, "#77a052", "#8db566", 66, coarse=3.0))
    )
    plain = rectangle(600, 600).mapped(40.0).painted(far)
    exact("Plane", [plain], (600, 600, 0), (0, 0, 0), (0, 0, -0.5), physics_type="STATIC")
    masonry = Masonry.make()
    for number, (name, at, size, centre, turn) in enumerate(BLOCKS):
        block(name, at, size, centre, turn, number + 1, masonry)
    viewpoint((16.0, -18.0, 10.0), (1.0, 3.0, 0.5))


def below(at, size, centre, turn: float) -> list[tuple[float, float, float]]:
    """The constant height of the ground of a quarter."""
    foot = at[2] + centre[2] - size[2] / 2 + 0.1
    frame = rotation(0, 0, np.degrees(turn))[:2, :2]
    grid = [
        (x, y)
        for x in np.arange(-size[0] / 2, size[0] / 2 + 1, 6.5)
        for y in np.arange(-size[1] / 2, size[1] / 2 + 1, 6.5)
    ]
    return [(*(frame @ np.array(place) + np.array(at[:2])), max(foot, 0.0)) for place in grid]
