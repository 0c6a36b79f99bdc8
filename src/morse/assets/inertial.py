"""Masses and inertias of links from model files."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import eigh, matmul
from morse.scene import Inertial

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.mathutils import Matrix

#: kg/m^3; density for the inertia of a link that has a mass but no inertia
_DENSITY = 1000.0
#: tolerance: a moment may exceed the sum of the others by this share of the sum, because files contain rounded numbers
_ROUNDING = 1e-3


def inertial_of(mass: float, origin: Matrix, moments: Sequence[float] | None) -> tuple[Inertial, str]:
    """Return the inertial of a link, and a warning if the file is wrong (else an empty string).

    An inertia that is not positive is replaced by that of a ball of water of the same mass. In a real body no principal
    moment is larger than the sum of the others. If one is larger, the others are enlarged.

    Args:
        mass: kg.
        origin: 4x4, centre of mass and principal axes in the frame of the link.
        moments: ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, kg m^2; None if the file does not contain them.
    """
    x, y, z = origin.translation
    rotation = np.array([list(row) for row in origin.to_3x3()])
    remark = ""
    ball = _ball(mass)
    if moments is None:
        inertia = ball * np.eye(3)
    else:
        xx, yy, zz, xy, xz, yz = moments
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        values, axes = eigh(inertia)
        if values[0] <= 0.0:
            if mass and (values != 0.0).any():
                remark = (
                    f"its inertia has the principal moments {_listed(values.tolist())} kg m^2, expected positive "
                    "numbers; it is replaced by that of a ball"
                )
            inertia = ball * np.eye(3)
        elif values[2] > (values[0] + values[1]) * (1.0 + _ROUNDING):
            remark = (
                f"its inertia has the principal moments {_listed(values.tolist())} kg m^2, and none can be larger "
                f"than the sum of "
                "the others; the smaller ones are enlarged"
            )
            values[:2] += 0.5 * (values[2] - values[0] - values[1])
            inertia = matmul(matmul(axes, np.diag(values)), axes.T)
    inertia = matmul(matmul(rotation, inertia), rotation.T)
    a, b, c, d, e, f, g, h, i = (float(value) for value in inertia.ravel())
    return Inertial(mass, (x, y, z), (a, b, c, d, e, f, g, h, i)), remark


def _ball(mass: float) -> float:
    """Return the moment of inertia of a ball of water, 2/5 m r^2."""
    return 0.4 * mass * math.cbrt(3.0 * mass / (4.0 * math.pi * _DENSITY)) ** 2


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
