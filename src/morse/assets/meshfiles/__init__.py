"""Model files of other programs: glTF, OBJ, STL, PLY."""

from morse.assets.meshfiles.reader import read_meshes

__all__ = ["read_meshes"]
