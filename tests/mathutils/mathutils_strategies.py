"""Strategies for the tests of vectors and rotations, and comparisons."""

from math import pi

import numpy as np
from hypothesis import strategies as st

from morse.mathutils import Euler, Quaternion, Vector

ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")

numbers = st.floats(-1e3, 1e3, allow_nan=False).map(lambda value: 0.0 if abs(value) < 1e-3 else value)
angles = st.floats(-pi, pi)
vectors = st.tuples(numbers, numbers, numbers).map(Vector)
eulers = st.builds(Euler, st.tuples(angles, angles, angles), st.sampled_from(ORDERS))
quaternions = (
    st.tuples(*[st.floats(-1.0, 1.0)] * 4)
    .filter(lambda four: sum(a * a for a in four) > 1e-2)
    .map(lambda four: Quaternion(four).normalized())
)


def close(a, b, tolerance=1e-9):
    """True if two (nested) sequences contain equal numbers, relative to their magnitude."""
    a, b = np.array(a, float), np.array(b, float)
    return a.shape == b.shape and bool(np.all(np.abs(a - b) <= tolerance * (1.0 + np.abs(b).max())))
