"""The surface of the water of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.scene.extent import visible_extent

if TYPE_CHECKING:
    from morse.scene.scene import Scene

#: m: a surface is flat, and wider than a basin that only stands in the world
_FLAT, _WIDE = 0.1, 5.0


def water_level(scene: Scene) -> float | None:
    """Return the height of the water in the world, m; None without water.

    Water is a flat object of the world whose name begins with ``Water`` or ``Sea``.
    """
    for root in scene.roots:
        if root.mesh is None or not root.plain_name.lower().startswith(("water", "sea")):
            continue
        corners = visible_extent(root)
        if corners is None:
            continue
        low, high = corners
        if high[2] - low[2] < _FLAT and min(high[0] - low[0], high[1] - low[1]) > _WIDE:
            return float(high[2])
    return None
