"""Reader of Blender files, without Blender."""

from morse.assets.blend.errors import BlendError
from morse.assets.blend.reader import read_blend

__all__ = ["BlendError", "read_blend"]
