"""Vectors and rotations with the names and rules of Blender's `mathutils`, in plain Python floats.

Products are written ``*`` (as scripts for Blender before 2.80 do) or ``@`` (as later ones do); both work.
"""

from morse.mathutils.color import Color
from morse.mathutils.matrix import Matrix
from morse.mathutils.orientation import Euler, Quaternion, Vector

__all__ = ["Color", "Euler", "Matrix", "Quaternion", "Vector"]
