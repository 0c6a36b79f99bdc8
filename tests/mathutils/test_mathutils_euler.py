import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mathutils_strategies import ORDERS, angles, close, eulers, quaternions

from morse.mathutils import Euler, Matrix


def axis_rotation(axis, angle):
    """The textbook matrix of a rotation about one axis."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array(
        {
            "X": ((1, 0, 0), (0, c, -s), (0, s, c)),
            "Y": ((c, 0, s), (0, 1, 0), (-s, 0, c)),
            "Z": ((c, -s, 0), (s, c, 0), (0, 0, 1)),
        }[axis]
    )


def test_known_matrix():
    a, b, c = 0.1, 0.2, 0.3
    ca, sa, cb, sb, cc, sc = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(c), math.sin(c)
    assert close(
        Euler((a, b, c)).to_matrix(),
        (
            (cb * cc, sa * sb * cc - ca * sc, ca * sb * cc + sa * sc),
            (cb * sc, sa * sb * sc + ca * cc, ca * sb * sc - sa * cc),
            (-sb, sa * cb, ca * cb),
        ),
        1e-15,
    )


@given(angles, angles, angles, st.sampled_from(ORDERS))
def test_every_order_is_a_product_of_three_rotations(x, y, z, order):
    by_axis = {"X": x, "Y": y, "Z": z}
    first, second, third = (axis_rotation(axis, by_axis[axis]) for axis in order)
    assert close(Euler((x, y, z), order).to_matrix(), third @ second @ first)


@given(eulers, st.sampled_from(ORDERS))
def test_every_order_round_trips_through_the_matrix(euler, order):
    matrix = euler.to_matrix()
    assert close(matrix.to_euler(order).to_matrix(), matrix, 1e-11)


@given(st.sampled_from(ORDERS), angles, angles, st.sampled_from([-1, 1]), st.floats(0.0, 1e-3))
def test_round_trip_in_and_near_gimbal_lock(order, first, last, side, off):
    three = [0.0, 0.0, 0.0]
    for axis, angle in zip(order, (first, side * (math.pi / 2 - off), last), strict=True):
        three["XYZ".index(axis)] = angle
    matrix = Euler(three, order).to_matrix()
    assert close(matrix.to_euler(order).to_matrix(), matrix, 1e-11)


def test_exact_gimbal_lock():
    down = Matrix(((0, 0, 1), (0, 1, 0), (-1, 0, 0)))
    euler = down.to_euler()
    assert close(euler, (0, math.pi / 2, 0))
    assert close(euler.to_matrix(), down)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.sampled_from(ORDERS))
def test_angles_below_a_quarter_turn_come_back_as_they_are(x, y, z, order):
    assert close(Euler((x, y, z), order).to_matrix().to_euler(order), (x, y, z), 1e-9)


@given(eulers)
def test_quaternion_and_matrix_say_the_same(euler):
    assert close(euler.to_quaternion().to_matrix(), euler.to_matrix(), 1e-11)
    assert close(euler.to_quaternion().to_euler(euler.order).to_matrix(), euler.to_matrix(), 1e-11)


@given(eulers, quaternions)
def test_rotate_multiplies_from_the_left(euler, turn):
    expected = turn.to_matrix() * euler.to_matrix()
    for other in (turn, turn.to_matrix(), turn.to_euler()):
        turned = euler.copy()
        turned.rotate(other)
        assert close(turned.to_matrix(), expected, 1e-9)
        assert turned.order == euler.order


@given(eulers, st.sampled_from("XYZ"), angles)
def test_rotate_axis_multiplies_from_the_right(euler, axis, angle):
    turned = euler.copy()
    turned.rotate_axis(axis, angle)
    assert close(turned.to_matrix(), np.array(euler.to_matrix()) @ axis_rotation(axis, angle), 1e-9)


def test_rotate_keeps_near_to_the_old_angles():
    euler = Euler((0, 0, 3.0))
    euler.rotate_axis("Z", 0.5)
    assert close(euler, (0, 0, 3.5))


def test_make_compatible_takes_out_whole_turns():
    euler = Euler((0.1, -3.0, 3.1 - 4 * math.pi))
    euler.make_compatible(Euler((0.2 + 2 * math.pi, 3.0, 3.2)))
    assert close(euler, (0.1 + 2 * math.pi, -3.0 + 2 * math.pi, 3.1))


def test_compatible_solution_is_the_nearest():
    matrix = Euler((0.2, 2.5, 0.3)).to_matrix()
    assert close(matrix.to_euler("XYZ", Euler((0.2, 2.4, 0.4))), (0.2, 2.5, 0.3))
    assert close(matrix.to_quaternion().to_euler("XYZ", (0.2, 2.4, 0.4)), (0.2, 2.5, 0.3))


def test_of_two_solutions_the_smaller_is_given():
    assert close(Euler((0.2, 2.9, 0.3)).to_matrix().to_euler(), (0.2, 2.9, 0.3))


@pytest.mark.parametrize("order", ["XYX", "xyz", "", None, 3])
def test_unknown_orders_are_refused(order):
    with pytest.raises(ValueError, match="XYZ, XZY, YXZ, YZX, ZXY, ZYX"):
        Euler((0, 0, 0), order)
    with pytest.raises(ValueError, match="Euler order"):
        Matrix().to_euler(order)


@pytest.mark.parametrize("wrong", [(1, 2), (1, 2, 3, 4), None, "abc"])
def test_wrong_angles_are_refused(wrong):
    with pytest.raises((TypeError, ValueError), match="3 numbers"):
        Euler(wrong)


def test_attributes():
    euler = Euler()
    euler.x, euler.y, euler.z = 1, 2, 3
    euler[1] = 4
    euler.order = "ZYX"
    assert euler == Euler((1, 4, 3), "ZYX")
    assert euler != Euler((1, 4, 3))
    euler.zero()
    assert tuple(euler) == (0.0, 0.0, 0.0)
    assert close(Euler((0.1, 0, 0)).to_quaternion(), (math.cos(0.05), math.sin(0.05), 0, 0), 1e-15)
    with pytest.raises(ValueError, match="axis"):
        euler.rotate_axis("W", 1.0)
