"""A lake in a hollow between hills; its surface is 4.2 m above the deepest point."""

from __future__ import annotations

from common.land import GROUND_AT, ground
from common.objects import exact, viewpoint
from common.sky import sky, sunshine
from common.water import water

DEPTH = 4.2


def build() -> None:
    sky("#a9d4e8")
    sunshine(3.2, (0.7, 0.3, 0.6))
    island = [(26.0, 22.0, 6.0), (30.0, 26.0, 5.6), (22.0, 18.0, 5.4), (30.0, 18.0, 4.8), (22.0, 26.0, 4.9)]
    shallow = [(-22.0, -18.0, 3.2), (-28.0, -12.0, 2.6)]
    ground([*island, *shallow], dip=-0.16, rise=11.14, seed=5)
    surface = water(126, 126)
    exact("Water", [surface], (126, 126, 0), (0, 0, 0), (GROUND_AT[0] - 0.02, 0.014, DEPTH), physics_type="STATIC")
    viewpoint((14.0, -17.0, 13.5), (0.0, 2.0, 4.2))
