"""Reader of the files of Blender, without Blender."""

from morse.assets.formats import ModelFormat
from morse.plugins.blend.container import BlendError
from morse.plugins.blend.reader import object_names, read_blend

__all__ = ["FORMAT", "BlendError", "object_names", "read_blend"]

FORMAT = ModelFormat(read_blend, object_names, purpose="scenes and models of Blender 2.5 to 5")
