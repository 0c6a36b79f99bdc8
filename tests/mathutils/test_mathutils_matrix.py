import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mathutils_strategies import close, eulers, numbers, vectors

from morse.mathutils import Euler, Matrix, Quaternion, Vector


def square(size):
    return st.lists(st.lists(numbers, min_size=size, max_size=size), min_size=size, max_size=size).map(Matrix)


def test_default_is_the_identity():
    assert np.array(Matrix()).tolist() == np.eye(4).tolist()
    assert Matrix.Identity(3) == Matrix(((1, 0, 0), (0, 1, 0), (0, 0, 1)))


@pytest.mark.parametrize(
    ("rows", "error"),
    [
        (((1, 2), (1, 2, 3)), ValueError),
        (((1, 2),), ValueError),
        ([[1] * 5] * 5, ValueError),
        ((), ValueError),
        (3, TypeError),
        ((1, 2, 3), TypeError),
        ((("a", 2), (1, 2)), TypeError),
    ],
)
def test_refuses_what_is_no_matrix(rows, error):
    with pytest.raises(error, match="row"):
        Matrix(rows)


def test_rows_and_columns_write_through():
    m = Matrix()
    m[0][3] = 5
    m[1].z = 6
    m.row[2][0] = 7
    m.col[1][0] = 8
    m.translation.y = 9
    m.col[3].z = 10
    row = m[0]
    row += Vector((1, 1, 1, 1))
    assert m == Matrix(((2, 9, 1, 6), (0, 1, 6, 9), (7, 0, 1, 10), (0, 0, 0, 1)))
    m[3] = (1, 2, 3, 4)
    m.col[0] = (4, 3, 2, 1)
    m.translation = (0.1, 0.2, 0.3)
    assert m == Matrix(((4, 9, 1, 0.1), (3, 1, 6, 0.2), (2, 0, 1, 0.3), (1, 2, 3, 4)))


def test_a_translation_follows_its_matrix_until_copied():
    m = Matrix.Translation((1, 2, 3))
    live, kept = m.translation, m.to_translation()
    m.invert()
    assert close(live, (-1, -2, -3))
    assert kept == Vector((1, 2, 3))
    live *= 2.0
    assert close(m.translation, (-2, -4, -6))


def test_wrong_rows_are_refused():
    m = Matrix.Identity(3)
    with pytest.raises(ValueError, match="3 numbers, given 2"):
        m[0] = (1, 2)
    with pytest.raises(IndexError):
        m[3]
    with pytest.raises(IndexError, match="index 3"):
        m.col[3]
    with pytest.raises(AttributeError, match="3x3"):
        _ = m.translation
    with pytest.raises(ValueError, match="slice"):
        m.col[0][:2] = (1,)


def test_4x4_moves_and_turns_a_point():
    m = Matrix.Translation((10, 20, 30)) * Matrix.Rotation(math.pi / 2, 4, "Z")
    assert close(m * Vector((1, 2, 3)), (8, 21, 33))
    assert m @ Vector((1, 2, 3)) == m * Vector((1, 2, 3))
    assert close(m * Vector((1, 2, 3, 0)), (-2, 1, 3, 0))


def test_rotation_about_the_axes():
    c, s = math.cos(0.3), math.sin(0.3)
    assert close(Matrix.Rotation(0.3, 3, "X"), ((1, 0, 0), (0, c, -s), (0, s, c)))
    assert close(Matrix.Rotation(0.3, 3, "Y"), ((c, 0, s), (0, 1, 0), (-s, 0, c)))
    assert close(Matrix.Rotation(0.3, 3, "Z"), ((c, -s, 0), (s, c, 0), (0, 0, 1)))
    assert close(Matrix.Rotation(0.3, 2), ((c, -s), (s, c)))
    assert close(Matrix.Rotation(0.3, 3, (0, 0, 9)), Matrix.Rotation(0.3, 3, "Z"))
    assert close(Matrix.Rotation(0.3, 4, "Z"), ((c, -s, 0, 0), (s, c, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)))


@pytest.mark.parametrize("arguments", [(1.0, 5, "Z"), (1.0, 3, "W"), (1.0, 3), (1.0, 4, (1, 2))])
def test_wrong_rotations_are_refused(arguments):
    with pytest.raises(ValueError, match=r"Rotation|axis"):
        Matrix.Rotation(*arguments)


def test_scale():
    assert Matrix.Scale(2, 3) == Matrix.Diagonal((2, 2, 2))
    assert close(Matrix.Scale(3, 4, (0, 5, 0)), np.diag((1, 3, 1, 1)))
    along = Vector((1, 1, 0))
    m = Matrix.Scale(5, 3, along)
    assert close(m * along, along * 5)
    assert close(m * Vector((1, -1, 0)), (1, -1, 0))
    assert Matrix.Scale(2, 2) == Matrix.Diagonal((2, 2))


def test_loc_rot_scale_is_undone_by_decompose():
    place, turn, scale = Vector((1, 2, 3)), Euler((0.3, -0.2, 1.0)), Vector((2, 3, 4))
    m = Matrix.LocRotScale(place, turn, scale)
    p, q, s = m.decompose()
    assert p == place
    assert close(q, turn.to_quaternion())
    assert close(s, scale)
    assert Matrix.LocRotScale(None, None, None) == Matrix()


def test_a_mirroring_matrix_has_negative_scale():
    m = Matrix.Diagonal((-1, 2, 3, 1))
    assert m.is_negative
    p, q, s = m.decompose()
    assert close(Matrix.LocRotScale(p, q, s), m)
    assert close(s, (-1, -2, -3))


def test_shape_changes():
    m = Matrix(((1, 2, 3), (4, 5, 6), (7, 8, 9)))
    assert m.to_4x4() == Matrix(((1, 2, 3, 0), (4, 5, 6, 0), (7, 8, 9, 0), (0, 0, 0, 1)))
    assert m.to_4x4().to_3x3() == m
    assert m.to_2x2() == Matrix(((1, 2), (4, 5)))
    pose = Matrix(((1, 0, 0, 5), (0, 1, 0, 6), (0, 0, 1, 7)))
    assert pose.translation == Vector((5, 6, 7))
    assert pose * Vector((1, 1, 1)) == Vector((6, 7, 8))
    assert pose.transposed() == Matrix(((1, 0, 0), (0, 1, 0), (0, 0, 1), (5, 6, 7)))
    m.resize_4x4()
    assert len(m) == 4


def test_singular_matrices():
    m = Matrix(((1, 2, 3), (2, 4, 6), (0, 0, 1)))
    assert m.determinant() == 0.0
    with pytest.raises(ValueError, match="no inverse"):
        m.inverted()
    with pytest.raises(ValueError, match="no inverse"):
        m.invert()
    assert m.inverted(None) is None
    assert all(math.isfinite(value) for row in m.inverted_safe() for value in row)
    assert m == Matrix(((1, 2, 3), (2, 4, 6), (0, 0, 1)))


def test_small_matrices_are_not_singular():
    m = Matrix.Scale(1e-9, 3)
    assert close(m.inverted(), Matrix.Scale(1e9, 3))


def test_mismatched_shapes_are_refused():
    three, four = Matrix.Identity(3), Matrix()
    with pytest.raises(ValueError, match="3x3 cannot be multiplied by a 4x4"):
        three * four
    with pytest.raises(ValueError, match="3x3 and 4x4"):
        three + four
    with pytest.raises(ValueError, match="vector of 2"):
        three * Vector((1, 2))
    with pytest.raises(ValueError, match="vector of 2"):
        Vector((1, 2)) * three
    with pytest.raises(ValueError, match="2x2"):
        Matrix.Identity(2).to_euler()
    with pytest.raises(ValueError, match="3x4"):
        Matrix(((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))).inverted()
    with pytest.raises(ValueError, match="3x3"):
        three.decompose()
    with pytest.raises(TypeError):
        three * "x"


def test_median_scale_and_normalized():
    m = Matrix.LocRotScale((1, 2, 3), Euler((0.1, 0.2, 0.3)), (1, 2, 3))
    assert math.isclose(m.median_scale, 2.0)
    assert not m.is_orthogonal
    plain = m.normalized()
    assert plain.is_orthogonal
    assert close(plain, Matrix.LocRotScale((1, 2, 3), Euler((0.1, 0.2, 0.3)), None))


def test_lerp_meets_half_way():
    a, b = Matrix.Translation((2, 0, 0)), Matrix.Translation((4, 0, 0)) * Matrix.Rotation(1.0, 4, "Z")
    assert close(a.lerp(b, 0.5), Matrix.Translation((3, 0, 0)) * Matrix.Rotation(0.5, 4, "Z"))
    assert close(a.to_3x3().lerp(b.to_3x3(), 0.5), Matrix.Rotation(0.5, 3, "Z"))


def test_identity_zero_transpose_and_rotate_in_place():
    m = Matrix(((1, 2), (3, 4)))
    m.transpose()
    assert m == Matrix(((1, 3), (2, 4)))
    m.identity()
    assert m == Matrix.Identity(2)
    m.zero()
    assert m == Matrix(((0, 0), (0, 0)))
    r = Matrix.Rotation(0.2, 3, "Z")
    r.rotate(Quaternion((0, 0, 1), 0.3))
    assert close(r, Matrix.Rotation(0.5, 3, "Z"))


@given(square(3), square(3), square(3))
def test_products_are_associative_and_agree_with_numpy(a, b, c):
    assert close(a * b, np.array(a) @ np.array(b))
    assert a @ b == a * b
    assert close((a * b) * c, a * (b * c), 1e-6)
    assert close(2.5 * a + b - c, 2.5 * np.array(a) + np.array(b) - np.array(c))


@given(square(4), square(4))
def test_4x4_products_agree_with_numpy(a, b):
    assert close(a * b, np.array(a) @ np.array(b))


@given(st.sampled_from([2, 3, 4]).flatmap(square))
def test_determinant_and_inverse_agree_with_numpy(m):
    array = np.array(m)
    size = np.abs(array).max() or 1.0
    assert abs(m.determinant() - np.linalg.det(array)) <= 1e-9 * size ** len(m)
    if np.linalg.cond(array) < 1e6:
        assert close(m.inverted() * m, np.eye(len(m)), 1e-6)
        assert close(m * m.inverted(), np.eye(len(m)), 1e-6)


@given(eulers, vectors)
def test_rotations_are_orthogonal(euler, v):
    m = euler.to_matrix()
    assert m.is_orthogonal
    assert not m.is_negative
    assert close(m.transposed() * (m * v), v)
    assert close(m.inverted(), m.transposed())
