"""How large things are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.scene.extent import visible_extent

if TYPE_CHECKING:
    from morse.scene import Node


def extent(root: Node) -> list[float] | None:
    """Length along X, Y and Z of all visible meshes of a node and those below it, m; None without any."""
    corners = visible_extent(root)
    return None if corners is None else [float(length) for length in corners[1] - corners[0]]
