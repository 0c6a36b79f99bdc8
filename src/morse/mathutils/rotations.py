"""Conversions between rotation matrices (nine floats, row by row), quaternions (w, x, y, z) and Euler angles.

Angles are in radians. Euler angles follow K. Shoemake, "Euler Angle Conversion", Graphics Gems IV (1994): with order
``abc`` the rotation about `a` is the first, and all axes are fixed, so that ``XYZ`` is ``Rz @ Ry @ Rx``.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, pi, sin, sqrt
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Sequence


Rotation9: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
Quaternion4: TypeAlias = tuple[float, float, float, float]
Angles: TypeAlias = tuple[float, float, float]
Triple: TypeAlias = tuple[float, float, float]

ORDERS: dict[str, tuple[int, int, int, float]] = {
    "XYZ": (0, 1, 2, 1.0),
    "XZY": (0, 2, 1, -1.0),
    "YXZ": (1, 0, 2, -1.0),
    "YZX": (1, 2, 0, 1.0),
    "ZXY": (2, 0, 1, 1.0),
    "ZYX": (2, 1, 0, -1.0),
}
"""For each order: first, second and third axis, and the sign of their permutation."""

_GIMBAL = 1e-12  # if the cosine of the middle angle is smaller, the first and third axes are treated as equal


def product(a: Sequence[float], b: Sequence[float]) -> Rotation9:
    """Return the product of two 3x3 matrices, each nine floats, row by row."""
    a0, a1, a2, a3, a4, a5, a6, a7, a8 = a
    b0, b1, b2, b3, b4, b5, b6, b7, b8 = b
    return (
        a0 * b0 + a1 * b3 + a2 * b6, a0 * b1 + a1 * b4 + a2 * b7, a0 * b2 + a1 * b5 + a2 * b8,
        a3 * b0 + a4 * b3 + a5 * b6, a3 * b1 + a4 * b4 + a5 * b7, a3 * b2 + a4 * b5 + a5 * b8,
        a6 * b0 + a7 * b3 + a8 * b6, a6 * b1 + a7 * b4 + a8 * b7, a6 * b2 + a7 * b5 + a8 * b8,
    )  # fmt: skip


def turn(m: Sequence[float], v: Sequence[float]) -> Triple:
    """Return ``M v``."""
    x, y, z = v
    return (m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z)


def turn_back(m: Sequence[float], v: Sequence[float]) -> Triple:
    """Return ``M^T v``: for a rotation, the inverse of `turn`."""
    x, y, z = v
    return (m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z)


def cross(a: Sequence[float], b: Sequence[float]) -> Triple:
    """Return ``a x b``."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def rotation_of(numbers: Sequence[float]) -> Rotation9:
    """Return the nine numbers of a rotation, row by row, as a tuple."""
    a, b, c, d, e, f, g, h, i = numbers
    return a, b, c, d, e, f, g, h, i


def nine(rows: Sequence[Sequence[float]]) -> Rotation9:
    """Return the upper left 3x3 of a matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rows[0][:3], rows[1][:3], rows[2][:3]
    return a, b, c, d, e, f, g, h, i


def rows_of(m: Sequence[float]) -> list[list[float]]:
    """Return nine floats as three rows."""
    a, b, c, d, e, f, g, h, i = m
    return [[a, b, c], [d, e, f], [g, h, i]]


def normalized_columns(m: Rotation9) -> Rotation9:
    """Return the matrix with columns of length 1, without scale; zero columns are not changed."""
    a, b, c, d, e, f, g, h, i = m
    s = sqrt(a * a + d * d + g * g) or 1.0
    t = sqrt(b * b + e * e + h * h) or 1.0
    u = sqrt(c * c + f * f + i * i) or 1.0
    return a / s, b / t, c / u, d / s, e / t, f / u, g / s, h / t, i / u


def determinant(m: Rotation9) -> float:
    """Return the determinant of a 3x3 matrix."""
    a, b, c, d, e, f, g, h, i = m
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def unscaled(m: Rotation9) -> Rotation9:
    """Return the rotation in a matrix that also scales or mirrors."""
    pure = normalized_columns(m)
    if determinant(pure) < 0.0:
        a, b, c, d, e, f, g, h, i = pure
        return -a, -b, -c, -d, -e, -f, -g, -h, -i
    return pure


def rotation_from_quaternion(w: float, x: float, y: float, z: float) -> Rotation9:
    """Return the rotation matrix of a unit quaternion."""
    xx, yy, zz = 2 * x * x, 2 * y * y, 2 * z * z
    xy, xz, yz = 2 * x * y, 2 * x * z, 2 * y * z
    wx, wy, wz = 2 * w * x, 2 * w * y, 2 * w * z
    return (1 - yy - zz, xy - wz, xz + wy, xy + wz, 1 - xx - zz, yz - wx, xz - wy, yz + wx, 1 - xx - yy)


def quaternion_from_rotation(m: Rotation9) -> Quaternion4:
    """Return the unit quaternion with w >= 0 of a rotation matrix.

    S. W. Shepperd, "Quaternion from rotation matrix" (1978): the largest component is computed first, so that the
    others are not divided by a small number.
    """
    a, b, c, d, e, f, g, h, i = m
    if a + e + i > 0.0:
        s = 2.0 * sqrt(1.0 + a + e + i)
        q = (s / 4, (h - f) / s, (c - g) / s, (d - b) / s)
    elif a >= e and a >= i:
        s = 2.0 * sqrt(max(1.0 + a - e - i, 0.0)) or 1.0
        q = ((h - f) / s, s / 4, (b + d) / s, (c + g) / s)
    elif e >= i:
        s = 2.0 * sqrt(max(1.0 + e - a - i, 0.0)) or 1.0
        q = ((c - g) / s, (b + d) / s, s / 4, (f + h) / s)
    else:
        s = 2.0 * sqrt(max(1.0 + i - a - e, 0.0)) or 1.0
        q = ((d - b) / s, (c + g) / s, (f + h) / s, s / 4)
    w, x, y, z = q
    scale = copysign(1.0 / (sqrt(w * w + x * x + y * y + z * z) or 1.0), w)
    return w * scale, x * scale, y * scale, z * scale


def rotation_vector(before: Sequence[float], after: Sequence[float]) -> Triple:
    """Return the shortest rotation from one rotation to another: axis times angle (rad), in the axes of both."""
    a, b, c, d, e, f, g, h, i = before
    w, x, y, z = quaternion_from_rotation(product((a, d, g, b, e, h, c, f, i), tuple(after)))
    sine = sqrt(x * x + y * y + z * z)
    # ratio of the angle to the sine of half the angle; for small angles it is 2
    scale = 2.0 * atan2(sine, w) / sine if sine > 0.0 else 2.0
    return x * scale, y * scale, z * scale


def rotation_from_euler(angles: Sequence[float], order: str) -> Rotation9:
    """Return the rotation matrix of three angles, given as x, y, z for any order."""
    if order == "XYZ":  # the usual one, in half the time
        x, y, z = angles
        ci, cj, ck, si, sj, sk = cos(x), cos(y), cos(z), sin(x), sin(y), sin(z)
        return (
            cj * ck, sj * si * ck - ci * sk, sj * ci * ck + si * sk,
            cj * sk, sj * si * sk + ci * ck, sj * ci * sk - si * ck,
            -sj, cj * si, cj * ci,
        )  # fmt: skip
    i, j, k, sign = ORDERS[order]
    ti, tj, tk = sign * angles[i], sign * angles[j], sign * angles[k]
    ci, cj, ck = cos(ti), cos(tj), cos(tk)
    si, sj, sk = sin(ti), sin(tj), sin(tk)
    m = [0.0] * 9
    i3, j3, k3 = 3 * i, 3 * j, 3 * k
    m[i3 + i], m[i3 + j], m[i3 + k] = cj * ck, sj * si * ck - ci * sk, sj * ci * ck + si * sk
    m[j3 + i], m[j3 + j], m[j3 + k] = cj * sk, sj * si * sk + ci * ck, sj * ci * sk - si * ck
    m[k3 + i], m[k3 + j], m[k3 + k] = -sj, cj * si, cj * ci
    a, b, c, d, e, f, g, h, n = m
    return a, b, c, d, e, f, g, h, n


def both_eulers(m: Rotation9, order: str) -> tuple[Angles, Angles]:
    """Return the two sets of angles x, y, z of a rotation matrix; in the first set, the middle angle is within ±90°.

    In gimbal lock the third angle is 0.
    """
    i, j, k, sign = ORDERS[order]
    i3, j3, k3 = 3 * i, 3 * j, 3 * k
    cj = hypot(m[i3 + i], m[j3 + i])
    if cj <= _GIMBAL:
        first = atan2(-m[j3 + k], m[j3 + j]), atan2(-m[k3 + i], cj), 0.0
        second = first
    else:
        ti, tj = atan2(m[k3 + j], m[k3 + k]), atan2(-m[k3 + i], cj)
        first = ti, tj, _third(m, ti, i, j, k)
        opposite = atan2(-m[k3 + j], -m[k3 + k])
        second = opposite, atan2(-m[k3 + i], -cj), _third(m, opposite, i, j, k)
    return _in_xyz(first, i, j, k, sign), _in_xyz(second, i, j, k, sign)


def _third(m: Rotation9, ti: float, i: int, j: int, k: int) -> float:
    # Computed from the first angle rather than from the vanishing first column, so that it is exact close to the lock.
    si, ci = sin(ti), cos(ti)
    return atan2(si * m[3 * i + k] - ci * m[3 * i + j], ci * m[3 * j + j] - si * m[3 * j + k])


def _in_xyz(angles: Angles, i: int, j: int, k: int, sign: float) -> Angles:
    out = [0.0, 0.0, 0.0]
    out[i], out[j], out[k] = sign * angles[0], sign * angles[1], sign * angles[2]
    return out[0], out[1], out[2]


def euler_from_rotation(m: Rotation9, order: str) -> Angles:
    """Return angles x, y, z of a rotation matrix: the solution with the smaller sum, as in Blender."""
    first, second = both_eulers(m, order)
    return first if _turn(first) <= _turn(second) else second


def compatible_euler(m: Rotation9, order: str, near: Sequence[float]) -> Angles:
    """Return the angles x, y, z of a rotation matrix that are closest to the given ones, including whole turns."""
    candidates = [unwrapped(angles, near) for angles in both_eulers(m, order)]
    return min(candidates, key=lambda angles: sum(abs(a - b) for a, b in zip(angles, near, strict=True)))


def unwrapped(angles: Sequence[float], near: Sequence[float]) -> Angles:
    """Return the same angles, with whole turns added so that they differ by at most half a turn from the given ones."""
    x, y, z = (a - 2 * pi * round((a - b) / (2 * pi)) for a, b in zip(angles, near, strict=True))
    return x, y, z


def _turn(angles: Angles) -> float:
    return abs(angles[0]) + abs(angles[1]) + abs(angles[2])


def checked_order(order: str) -> str:
    """Return the order if it is valid.

    Raises:
        ValueError: it is not one of the six orders.
    """
    if order not in ORDERS:
        raise ValueError(f"an Euler order is one of {', '.join(ORDERS)}, given {order!r}")
    return order
