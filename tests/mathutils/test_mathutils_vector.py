import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mathutils_strategies import close, numbers, quaternions, vectors

from morse.mathutils import Euler, Matrix, Quaternion, Vector


def test_default_is_a_null_3_vector():
    assert Vector().to_tuple() == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "source", [[1, 2, 3], (1, 2, 3), range(1, 4), np.array([1, 2, 3], np.float32), (i for i in (1, 2, 3))]
)
def test_takes_any_iterable_of_numbers(source):
    assert Vector(source).to_tuple() == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("source", "error", "said"),
    [
        ((1,), ValueError, "given 1"),
        ((1, 2, 3, 4, 5), ValueError, "given 5"),
        ("abc", TypeError, "abc"),
        (3, TypeError, "given 3"),
        ((1, None, 2), TypeError, "None"),
        (None, TypeError, "None"),
    ],
)
def test_refuses_what_is_no_vector(source, error, said):
    with pytest.raises(error, match="2 to 4 numbers") as caught:
        Vector(source)
    assert said in str(caught.value)


def test_components_read_and_write():
    v = Vector((1, 2, 3, 4))
    v.x, v.y, v.z, v.w = 5, 6, 7, 8
    assert (v.x, v.y, v.z, v.w) == (5.0, 6.0, 7.0, 8.0)
    v[1] = 0.5
    v[2:] = (9, 10)
    assert v[:] == (5.0, 0.5, 9.0, 10.0)
    assert v[-1] == 10.0


def test_swizzles():
    v = Vector((1, 2, 3))
    assert v.xy == Vector((1, 2))
    assert v.zyx == Vector((3, 2, 1))
    assert v.xxyy == Vector((1, 1, 2, 2))
    v.xy = (8, 9)
    assert v == Vector((8, 9, 3))
    with pytest.raises(AttributeError, match="'w'"):
        _ = v.xw
    with pytest.raises(AttributeError, match="frobnicate"):
        _ = v.frobnicate
    with pytest.raises(AttributeError, match="'z'"):
        _ = Vector((1, 2)).z


def test_slices_keep_the_length():
    v = Vector((1, 2, 3))
    for wrong in ((1,), (1, 2, 3)):
        with pytest.raises(ValueError, match="slice"):
            v[:2] = wrong
    with pytest.raises(TypeError, match="numbers"):
        v[0] = "far"
    with pytest.raises(IndexError):
        v[3] = 1.0
    assert v == Vector((1, 2, 3))


def test_products_of_the_old_and_of_the_new_kind():
    a, b = Vector((1, 2, 3)), Vector((4, -5, 6))
    assert a * b == a @ b == a.dot(b) == 12.0
    assert a * 2 == 2 * a == Vector((2, 4, 6))
    assert a * np.float32(2.0) == Vector((2, 4, 6))
    assert a / 2 == Vector((0.5, 1, 1.5))
    assert a.cross(b) == Vector((27, 6, -13))
    assert a.dot((1, 1, 1)) == 6.0


def test_row_vector_times_matrix_is_the_transposed_product():
    m = Matrix(((1, 2, 3), (4, 5, 6), (7, 8, 10)))
    v = Vector((1, -1, 2))
    assert v * m == v @ m == m.transposed() * v == Vector((11, 13, 17))
    v *= m
    assert v == Vector((11, 13, 17))


def test_in_place_arithmetic_keeps_the_object():
    v = alias = Vector((1, 2, 3))
    v += Vector((1, 1, 1))
    v -= Vector((0, 0, 1))
    v *= 4
    v /= 2
    assert alias is v
    assert v == Vector((4, 6, 6))


def test_wrong_operands_are_refused():
    a = Vector((1, 2, 3))
    for wrong in ((1, 2, 3), 1, "2", None):
        with pytest.raises(TypeError):
            a + wrong
        with pytest.raises(TypeError):
            a - wrong
    with pytest.raises(TypeError):
        a * "2"
    with pytest.raises(TypeError, match="dot"):
        a *= Vector((1, 2, 3))
    for operation in (lambda: a + Vector((1, 2)), lambda: a.dot((1, 2)), lambda: a - Vector((1, 2, 3, 4))):
        with pytest.raises(ValueError, match="same number of components, given 3"):
            operation()
    with pytest.raises(ValueError, match="3 components"):
        Vector((1, 2)).cross((3, 4))
    with pytest.raises(ZeroDivisionError):
        a / 0


def test_length():
    v = Vector((2, 3, 6))
    assert v.length == v.magnitude == 7.0
    assert v.length_squared == 49.0
    v.length = 14
    assert close(v, (4, 6, 12))
    with pytest.raises(ValueError, match="negative"):
        v.length = -1
    v.normalize()
    assert math.isclose(v.length, 1.0)
    assert Vector().normalized() == Vector()


def test_angle():
    assert math.isclose(Vector((1, 0, 0)).angle((0, 5, 0)), math.pi / 2)
    assert math.isclose(Vector((1, 0, 0)).angle((-2, 0, 0)), math.pi)
    assert math.isclose(Vector((1, 0, 0)).angle((1, 1e-9, 0)), 1e-9)
    assert Vector().angle((1, 0, 0), None) is None
    with pytest.raises(ValueError, match="zero vector"):
        Vector().angle((1, 0, 0))


def test_lerp_slerp_project_and_reflect():
    assert Vector((0, 0)).lerp((10, -10), 0.25) == Vector((2.5, -2.5))
    half = math.sqrt(0.5)
    assert close(Vector((2, 0, 0)).slerp((0, 3, 0), 0.5), (half, half, 0))
    with pytest.raises(ValueError, match="opposite"):
        Vector((1, 0, 0)).slerp((-1, 0, 0), 0.5)
    assert Vector((3, 4, 0)).project((10, 0, 0)) == Vector((3, 0, 0))
    assert Vector((3, 4, 0)).project((0, 0, 0)) == Vector((0, 0, 0))
    assert Vector((1, -1, 0)).reflect((0, 5, 0)) == Vector((1, 1, 0))


def test_sizes():
    v = Vector((1, 2))
    assert v.to_3d() == Vector((1, 2, 0))
    assert v.to_4d() == Vector((1, 2, 0, 1))
    assert Vector((1, 2, 3, 4)).to_2d() == v
    v.resize_4d()
    v.resize_3d()
    assert v == Vector((1, 2, 0))
    v.resize_2d()
    assert v == Vector((1, 2))
    with pytest.raises(ValueError, match="asked for 5"):
        v.resize(5)
    assert Vector((0.123, 0.456)).to_tuple(1) == (0.1, 0.5)
    assert Vector.Fill(3, 2.0) == Vector((2, 2, 2))


def test_rotate_turns_in_place_by_every_kind_of_rotation():
    quarter = Euler((0, 0, math.pi / 2))
    for rotation in (quarter, quarter.to_quaternion(), quarter.to_matrix(), quarter.to_matrix().to_4x4()):
        v = Vector((1, 2, 3))
        v.rotate(rotation)
        assert close(v, (-2, 1, 3))


@pytest.mark.parametrize("track", ["X", "Y", "Z", "-X", "-Y", "-Z"])
@pytest.mark.parametrize("up", ["X", "Y", "Z"])
@pytest.mark.parametrize("direction", [(1, 2, 3), (-4, 0.1, -2), (0, 0, 1), (0, 0, -2)])
def test_to_track_quat(track, up, direction):
    v = Vector(direction)
    if track[-1] == up:
        with pytest.raises(ValueError, match="to_track_quat"):
            v.to_track_quat(track, up)
        return
    columns = np.array(v.to_track_quat(track, up).to_matrix())
    sign = -1.0 if track[0] == "-" else 1.0
    assert close(sign * columns[:, "XYZ".index(track[-1])], v.normalized())
    if v.xy.length:
        sideways = np.cross(direction, (0, 0, 1))
        assert abs(sideways @ columns[:, "XYZ".index(up)]) < 1e-9  # the up axis lies in the vertical plane …
        assert columns[2, "XYZ".index(up)] > 0  # … and points upward


def test_a_null_vector_tracks_nothing():
    assert Vector().to_track_quat("X", "Z") == Quaternion()


@given(vectors, vectors)
def test_rotation_difference_turns_one_direction_into_the_other(a, b):
    if a.length and b.length:
        assert close(a.rotation_difference(b) * a.normalized(), b.normalized(), 1e-6)


@given(vectors, vectors, vectors)
def test_vector_space(a, b, c):
    assert close((a + b) + c, a + (b + c))
    assert a + b == b + a
    assert a - a == Vector()
    assert -a == a * -1
    assert close((a + b) * 3.0, a * 3.0 + b * 3.0)
    assert a + Vector() == a


@given(vectors, vectors)
def test_products_agree_with_numpy(a, b):
    assert close([a.dot(b)], [np.dot(a, b)])
    assert close(a.cross(b), np.cross(a, b))
    assert close([a.length], [np.linalg.norm(np.array(a))])


@given(vectors)
def test_orthogonal_is_at_right_angles(v):
    assert abs(v.orthogonal().dot(v)) <= 1e-9 * v.length_squared
    assert v.length == 0.0 or v.orthogonal().length > 0.0


@given(quaternions, vectors)
def test_rotations_keep_lengths(q, v):
    assert close([(q * v).length], [v.length])


@given(st.lists(numbers, min_size=2, max_size=4))
def test_every_size_round_trips_as_a_sequence(items):
    v = Vector(items)
    assert list(v) == items
    assert np.array(v).tolist() == items
    assert Vector(v) == v
    assert len(v) == len(items)
