"""Functions of numpy with the same bits on every processor.

numpy passes products of matrices to BLAS, decompositions to LAPACK, and sines of arrays to vector code. Each of them
chooses its instructions, and so the rounding, by the processor. The functions here use sums in the order of the index,
and the functions of `math` for each number. They are meant for small matrices.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

#: longer sums are made by one call of numpy, in the same order
_LONG = 16
#: sweeps of the Jacobi method; a matrix of 3 x 3 needs at most six
_SWEEPS = 12
#: a pivot is zero if it is smaller than this share of the diagonal
_SINGULAR = 1e-12


def matmul(a: ArrayLike, b: ArrayLike) -> Any:
    """Return the product ``a @ b`` of vectors, matrices or stacks of matrices, as `numpy.matmul` defines it."""
    left, right = np.asarray(a), np.asarray(b)
    if left.ndim == 0 or right.ndim == 0 or left.shape[-1] != right.shape[-2 if right.ndim > 1 else 0]:
        raise ValueError(f"arrays of the shapes {left.shape} and {right.shape} have no product")
    # the views of `numpy.moveaxis`, which takes longer than small products
    columns = left if left.ndim == 1 else left.transpose(-1, *range(left.ndim - 1))[..., None]
    rows = right if right.ndim == 1 else right.transpose(-2, *range(right.ndim - 2), -1)
    if left.ndim == 1:
        columns = columns.reshape(-1, *(1,) * (right.ndim - 1))
    elif right.ndim == 1:
        columns = columns[..., 0]
    else:
        rows = rows[..., None, :]
    if right.ndim == 1:
        rows = right.reshape(-1, *(1,) * (left.ndim - 1))
    if not 0 < len(columns) <= _LONG:
        # stacks of different depth: the axis of the sum is the first of both
        missing = rows.ndim - columns.ndim
        columns = columns.reshape(len(columns), *(1,) * missing, *columns.shape[1:])
        rows = rows.reshape(len(rows), *(1,) * -missing, *rows.shape[1:])
        products = columns * rows
        return np.add.accumulate(products, axis=0)[-1] if len(products) else np.add.reduce(products, axis=0)
    result = columns[0] * rows[0]
    for column, row in zip(columns[1:], rows[1:], strict=True):
        result = result + column * row
    return result


def norm(vector: ArrayLike) -> float:
    """Return the length of a vector."""
    array = np.asarray(vector, dtype=np.float64)
    return math.sqrt(matmul(array, array))


def det(matrix: ArrayLike) -> float:
    """Return the determinant of a matrix (3, 3)."""
    (a, b, c), (d, e, f), (g, h, i) = np.asarray(matrix, dtype=np.float64).tolist()
    return float(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))


def eigh(matrix: ArrayLike) -> tuple[Floats, Floats]:
    """Return the eigenvalues (N,) of a symmetric matrix (N, N), ascending, and the eigenvectors as columns (N, N).

    The cyclic Jacobi method, in the form of G. Golub, C. Van Loan, "Matrix Computations", section 8.5.
    """
    diagonal = np.array(matrix, dtype=np.float64)
    if not np.isfinite(diagonal).all():
        raise ValueError("the matrix contains numbers that are not finite")
    size = len(diagonal)
    vectors = np.eye(size)
    for _ in range(_SWEEPS):
        if not np.triu(diagonal, 1).any():
            break
        for p in range(size - 1):
            for q in range(p + 1, size):
                _rotate(diagonal, vectors, p, q)
    values = np.diag(diagonal)
    order = np.argsort(values, kind="stable")
    return values[order], vectors[:, order]


def _rotate(diagonal: Floats, vectors: Floats, p: int, q: int) -> None:
    """Make an element beside the diagonal zero by a rotation in the plane of two axes."""
    aside, one, other = float(diagonal[p, q]), float(diagonal[p, p]), float(diagonal[q, q])
    if abs(aside) <= 1e-17 * math.sqrt(abs(one) * abs(other)):
        diagonal[p, q] = diagonal[q, p] = 0.0
        return
    slope = (other - one) / (2.0 * aside)
    tangent = math.copysign(1.0, slope) / (abs(slope) + math.hypot(1.0, slope))
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    sine = tangent * cosine
    for array in (diagonal.T, diagonal, vectors.T):
        row, next_row = array[p].copy(), array[q].copy()
        array[p], array[q] = cosine * row - sine * next_row, sine * row + cosine * next_row
    diagonal[p, q] = diagonal[q, p] = 0.0


def nearest_rotation(matrix: ArrayLike) -> Floats:
    """Return the orthogonal matrix (3, 3) nearest to a matrix: ``u @ v`` of its singular value decomposition."""
    array = np.asarray(matrix, dtype=np.float64)
    values, right = eigh(matmul(array.T, array))
    left = np.zeros((3, 3))
    for column in (2, 1, 0):
        axis = matmul(array, right[:, column]) if values[column] > _SINGULAR * values[2] else _across(left, column)
        left[:, column] = axis / norm(axis)
    return np.asarray(matmul(left, right.T))


def _across(axes: Floats, column: int) -> Floats:
    """Return a vector perpendicular to the columns after one of them."""
    if column == 0:
        return np.cross(axes[:, 1], axes[:, 2])
    if column == 1:
        return np.cross(axes[:, 2], np.eye(3)[int(np.abs(axes[:, 2]).argmin())])
    return np.array([0.0, 0.0, 1.0])


def solve(matrix: ArrayLike, vector: ArrayLike) -> Floats | None:
    """Return the solution (N,) of a symmetric positive definite system; None if its rank is below N."""
    rows = np.column_stack([np.asarray(matrix, dtype=np.float64), np.asarray(vector, dtype=np.float64)])
    size = len(rows)
    least = _SINGULAR * float(np.abs(np.diag(rows)).max(initial=0.0))
    for pivot in range(size):
        if not float(rows[pivot, pivot]) > least:
            return None
        rows[pivot, pivot:] /= rows[pivot, pivot]
        below = rows[pivot + 1 :, pivot:]
        below -= below[:, :1].copy() * rows[pivot, pivot:]
    result = rows[:, size].copy()
    for pivot in range(size - 1, 0, -1):
        result[:pivot] -= rows[:pivot, pivot] * result[pivot]
    return result


def _each(function: Callable[..., float], inputs: int) -> Callable[..., Floats]:
    apply = np.frompyfunc(function, inputs, 1)

    def elementwise(*arrays: ArrayLike) -> Floats:
        return np.asarray(apply(*(np.asarray(array, dtype=np.float64) for array in arrays)), dtype=np.float64)

    return elementwise


cos, sin, arccos, arcsin = (_each(function, 1) for function in (math.cos, math.sin, math.acos, math.asin))
exp, log, log10 = (_each(function, 1) for function in (math.exp, math.log, math.log10))
arctan2, power = _each(math.atan2, 2), _each(math.pow, 2)


def linear_light(codes: ArrayLike) -> NDArray[np.float64]:
    """Return the linear light, 0 to 1, of sRGB values, 0 to 1 (IEC 61966-2-1)."""
    values = np.asarray(codes, dtype=np.float64)
    return np.asarray(
        np.where(values <= 0.04045, values / 12.92, power((np.maximum(values, 0.0) + 0.055) / 1.055, 2.4))
    )


def linear_color(color: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the linear light and the opacity of a colour whose numbers programs show as they are, sRGB."""
    red, green, blue = linear_light(color[:3]).tolist()
    return red, green, blue, float(color[3])
