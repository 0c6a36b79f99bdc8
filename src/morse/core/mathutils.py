"""Vectors and rotations under the import path of MORSE 1.4; see `morse.mathutils`."""

from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

__all__ = ["Color", "Euler", "Matrix", "Quaternion", "Vector"]
