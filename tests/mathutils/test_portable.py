"""Functions of numpy with the same bits on every processor, compared with numpy's own."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from morse.mathutils import portable

_NUMBERS = st.floats(-1e3, 1e3).map(lambda number: round(number, 6))


def _array(*shape: int) -> st.SearchStrategy[np.ndarray]:
    return arrays.arrays(np.float64, shape, elements=_NUMBERS)


@st.composite
def _factors(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    stack = draw(st.sampled_from([(), (3,), (2, 3)]))
    rows, inner, columns = (draw(st.integers(0, 20)) for _ in range(3))
    left, right = draw(st.sampled_from([(rows, inner), (inner,)])), draw(st.sampled_from([(inner, columns), (inner,)]))
    if len(left) == 2 and draw(st.booleans()):
        left = (*stack, *left)
    if len(right) == 2 and draw(st.booleans()):
        right = (*stack, *right)
    return draw(_array(*left)), draw(_array(*right))


@given(_factors())
@example((np.ones((2, 17)), np.ones((3, 17, 4))))
@example((np.ones((3, 2, 17)), np.ones((17, 4))))
@example((np.zeros((0, 0)), np.zeros((3, 0, 0))))
def test_products_are_those_of_numpy(factors: tuple[np.ndarray, np.ndarray]) -> None:
    left, right = factors
    expected = np.matmul(left, right)
    product = portable.matmul(left, right)
    assert np.shape(product) == expected.shape
    scale = max(1.0, float(np.abs(left).max(initial=0.0)) * float(np.abs(right).max(initial=0.0)))
    assert np.abs(product - expected).max(initial=0.0) <= 1e-13 * scale * left.shape[-1]


@pytest.mark.parametrize("count", [1, 3, 16, 17, 1000])
def test_the_terms_of_a_product_are_added_in_the_order_of_the_index(count: int) -> None:
    left, right = np.random.default_rng(count).normal(size=(2, count))
    total = 0.0
    for one, other in zip(left.tolist(), right.tolist(), strict=True):
        total += one * other
    assert portable.matmul(left, right) == total
    assert portable.matmul(left[None], right[:, None])[0, 0] == total
    assert portable.matmul(np.tile(left, (2, 1)), right)[1] == total
    assert portable.matmul(left, np.tile(right[:, None], (1, 2)))[1] == total


def test_shapes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"\(2, 3\) and \(2, 3\)"):
        portable.matmul(np.zeros((2, 3)), np.zeros((2, 3)))


@given(_array(3, 3))
def test_determinants_are_those_of_numpy(matrix: np.ndarray) -> None:
    assert portable.det(matrix) == pytest.approx(np.linalg.det(matrix), abs=1e-12 * max(1.0, np.abs(matrix).max()) ** 3)


@given(st.integers(2, 5).flatmap(lambda size: _array(size, size)))
def test_eigenvectors_diagonalise_a_symmetric_matrix(square: np.ndarray) -> None:
    matrix = square + square.T
    values, axes = portable.eigh(matrix)
    scale = max(1.0, float(np.abs(matrix).max()))
    assert values == pytest.approx(np.linalg.eigh(matrix)[0], abs=1e-11 * scale)
    assert (np.diff(values) >= 0.0).all()
    assert axes.T @ axes == pytest.approx(np.eye(len(matrix)), abs=1e-12)
    assert axes @ np.diag(values) @ axes.T == pytest.approx(matrix, abs=1e-11 * scale)


def test_the_eigenvalues_of_numbers_that_are_not_finite_are_refused() -> None:
    with pytest.raises(ValueError, match="not finite"):
        portable.eigh([[1.0, math.nan], [math.nan, 1.0]])


@given(_array(3, 3))
def test_the_nearest_rotation_is_that_of_the_singular_value_decomposition(matrix: np.ndarray) -> None:
    rotation = portable.nearest_rotation(matrix)
    assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-9)
    u, sizes, v = np.linalg.svd(matrix)
    if sizes[2] > 1e-3 * sizes[0]:
        assert rotation == pytest.approx(u @ v, abs=1e-6)


@given(st.integers(1, 8).flatmap(lambda size: st.tuples(_array(size, size), _array(size))))
def test_solutions_of_systems(system: tuple[np.ndarray, np.ndarray]) -> None:
    square, vector = system
    matrix = square.T @ square + np.eye(len(vector))
    solution = portable.solve(matrix, vector)
    assert solution is not None
    assert solution == pytest.approx(np.linalg.solve(matrix, vector), rel=1e-5, abs=1e-5)


def test_a_system_without_full_rank_has_no_solution() -> None:
    assert portable.solve([[1.0, 1.0], [1.0, 1.0]], [1.0, 2.0]) is None
    assert portable.solve([[math.nan]], [1.0]) is None


@given(_array(4), _array(4))
def test_functions_of_each_number(x: np.ndarray, y: np.ndarray) -> None:
    assert portable.sin(x).tolist() == [math.sin(number) for number in x.tolist()]
    assert portable.cos(x[:, None]).shape == (4, 1)
    assert portable.arctan2(x, y).tolist() == [math.atan2(*pair) for pair in zip(x.tolist(), y.tolist(), strict=True)]
