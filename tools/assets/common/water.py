"""Water, visible from above and from below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from common.images import packed
from common.materials import material
from common.shapes import rectangle
from common.textures import blend, noise

if TYPE_CHECKING:
    from common.parts import Part


def water(width: float, depth: float) -> Part:
    """A calm surface with small waves in its texture."""
    waves = 0.5 + 0.22 * noise(256, 7.0, 71, stretch=2.0) + 0.12 * noise(256, 20.0, 72)
    picture = packed("water.jpg", blend("#1f6f8f", "#59aec2", waves))
    return rectangle(width, depth).mapped(12.0).painted(material("Water", "#3a8fab", 0.1, image=picture))
