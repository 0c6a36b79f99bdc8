"""Vectors and rotations where components look for them; see `morse.mathutils`."""

from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

__all__ = ["Color", "Euler", "Matrix", "Quaternion", "Vector"]
