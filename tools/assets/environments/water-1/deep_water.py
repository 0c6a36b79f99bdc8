"""Water only: for robots that swim and dive."""

from __future__ import annotations

from common.objects import exact, viewpoint
from common.sky import sky, sunshine
from common.water import water


def build() -> None:
    sky("#a9d4e8")
    sunshine(3.0, (0.7, 0.2, 0.5))
    exact("Water", [water(200, 200)], (200, 200, 0), (0, 0, 0), physics_type="NO_COLLISION")
    viewpoint((10.0, -12.0, 6.0), (0.0, 0.0, 0.0))
