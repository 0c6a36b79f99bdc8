import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mathutils_strategies import angles, close, quaternions, vectors

from morse.mathutils import Euler, Matrix, Quaternion, Vector

QI, QJ, QK = Quaternion((0, 1, 0, 0)), Quaternion((0, 0, 1, 0)), Quaternion((0, 0, 0, 1))


def same_rotation(a, b, tolerance=1e-9):
    return close(a, b, tolerance) or close(a, -b, tolerance)


def test_constructors():
    half = math.sqrt(0.5)
    assert tuple(Quaternion()) == (1.0, 0.0, 0.0, 0.0)
    assert close(Quaternion((0, 0, 7), math.pi / 2), (half, 0, 0, half))
    assert close(Quaternion((0, math.pi / 2, 0)), (half, 0, half, 0))
    assert Quaternion((0, 0, 0)) == Quaternion((0, 0, 0), 1.0) == Quaternion()


@pytest.mark.parametrize("arguments", [((1, 2),), ((1, 2, 3, 4, 5),), ("xyz",), ((1, 2, 3, 4), 0.5), (5,)])
def test_wrong_arguments_are_refused(arguments):
    with pytest.raises((TypeError, ValueError), match=r"3( to 4)? numbers"):
        Quaternion(*arguments)


def test_hamiltons_rules():
    one = Quaternion()
    assert QI * QI == QJ * QJ == QK * QK == -one
    assert QI * QJ == QK
    assert QJ * QK == QI
    assert QK * QI == QJ
    assert QJ * QI == -QK
    assert QI @ QJ == QI.cross(QJ) == QK


def test_arithmetic():
    q = Quaternion((1, 2, 3, 4))
    assert q + q == q * 2 == 2 * q
    assert q - q == Quaternion((0, 0, 0, 0))
    assert q / 2 == Quaternion((0.5, 1, 1.5, 2))
    assert q.dot(q) == 30.0
    assert math.isclose(q.magnitude, math.sqrt(30))
    assert q.conjugated() == Quaternion((1, -2, -3, -4))
    assert close(q * q.inverted(), Quaternion())
    for wrong in ("a", (1, 2, 3, 4), None):
        with pytest.raises(TypeError):
            q * wrong
    with pytest.raises(ValueError, match="3 components"):
        q * Vector((1, 2))


def test_in_place():
    q = Quaternion((1, 2, 3, 4))
    q.normalize()
    assert math.isclose(q.magnitude, 1.0)
    q.negate()
    q.conjugate()
    assert close(q * math.sqrt(30), (-1, 2, 3, 4))
    q.invert()
    assert close(q * math.sqrt(30), (-1, -2, -3, -4))
    q.identity()
    assert q == Quaternion()
    q.w, q.x, q.y, q.z = 4, 3, 2, 1
    assert tuple(q) == (4.0, 3.0, 2.0, 1.0)
    null = Quaternion((0, 0, 0, 0))
    assert null.normalized() == null.inverted() == null


def test_turning_a_vector():
    quarter = Quaternion((0, 0, 1), math.pi / 2)
    assert close(quarter * Vector((1, 2, 3)), (-2, 1, 3))
    assert quarter @ Vector((1, 2, 3)) == quarter * Vector((1, 2, 3))


def test_axis_and_angle():
    q = Quaternion((0, 3, 4), 1.2)
    axis, angle = q.to_axis_angle()
    assert close(axis, (0, 0.6, 0.8))
    assert math.isclose(angle, 1.2)
    assert close(q.axis, axis)
    assert math.isclose(q.angle, 1.2)
    q.angle = 0.4
    q.axis = (1, 0, 0)
    assert close(q, Quaternion((1, 0, 0), 0.4))
    assert Quaternion().to_axis_angle() == (Vector((1, 0, 0)), 0.0)


@given(angles, vectors)
def test_exponential_map_round_trips(angle, axis):
    if axis.length:
        rotation = axis.normalized() * angle
        assert close(Quaternion(rotation).to_exponential_map(), rotation, 1e-6) or math.isclose(abs(angle), math.pi)


@given(quaternions, quaternions, quaternions)
def test_group_axioms(a, b, c):
    assert close((a * b) * c, a * (b * c))
    assert close(a * a.inverted(), Quaternion())
    assert a * Quaternion() == a
    assert close((a * b).conjugated(), b.conjugated() * a.conjugated())


@given(quaternions, quaternions, vectors)
def test_products_compose_rotations(a, b, v):
    assert close((a * b) * v, a * (b * v))
    assert close((a * b).to_matrix(), a.to_matrix() * b.to_matrix())
    assert close(a.to_matrix() * v, a * v)


@given(quaternions)
def test_matrix_round_trip(q):
    back = q.to_matrix().to_quaternion()
    assert same_rotation(back, q)
    assert back.w >= 0.0
    assert math.isclose(back.magnitude, 1.0)


@pytest.mark.parametrize("q", [QI, QJ, QK, Quaternion((1, 1, 0), math.pi), Quaternion((1, 2, 3), math.pi - 1e-9)])
def test_half_turns_survive_the_matrix(q):
    assert same_rotation(q.to_matrix().to_quaternion(), q)


def test_scale_does_not_disturb_the_rotation_of_a_matrix():
    q = Quaternion((1, 2, 3), 0.7)
    assert close((q.to_matrix() * Matrix.Diagonal((2, 3, 0.1))).to_quaternion(), q)
    assert close((q * 5.0).to_matrix(), q.to_matrix())


@given(quaternions, quaternions)
def test_rotation_difference_and_rotate(a, b):
    assert close(a * a.rotation_difference(b), b)
    turned = b.copy()
    turned.rotate(a)
    assert close(turned, a * b)
    by_matrix = b.copy()
    by_matrix.rotate(a.to_matrix())
    assert same_rotation(by_matrix, a * b)


def test_slerp():
    a, b = Quaternion((0, 0, 1), 0.2), Quaternion((0, 0, 1), 1.0)
    assert close(a.slerp(b, 0.25), Quaternion((0, 0, 1), 0.4))
    assert close(a.slerp(-b, 0.25), Quaternion((0, 0, 1), 0.4))
    assert close(a.slerp(a, 0.7), a)
    for outside in (-0.1, 1.1, math.nan):
        with pytest.raises(ValueError, match="between 0 and 1"):
            a.slerp(b, outside)


@given(quaternions, quaternions, st.floats(0, 1))
def test_slerp_turns_evenly(a, b, factor):
    whole = a.rotation_difference(b if a.dot(b) >= 0 else -b).to_axis_angle()[1]
    part = a.rotation_difference(a.slerp(b, factor)).to_axis_angle()[1]
    assert abs(part - factor * whole) < 1e-6


def test_make_compatible_and_euler():
    q = Quaternion((0, 0, 1), 0.3)
    other = -q
    other.make_compatible(q)
    assert other == q
    assert close(q.to_euler(), (0, 0, 0.3))
    assert np.allclose(q.to_matrix(), Euler((0, 0, 0.3)).to_matrix())
