"""Vectors and rotations with the names and rules of Blender's `mathutils`, in plain Python floats.

Products are written ``*`` (as in scripts for Blender before 2.80) or ``@`` (as in later scripts).
"""

from morse.mathutils.color import Color
from morse.mathutils.matrix import Matrix
from morse.mathutils.orientation import Euler, Quaternion, Vector

__all__ = ["Color", "Euler", "Matrix", "Quaternion", "Vector"]
