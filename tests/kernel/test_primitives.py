"""The C formulas and those of numpy are bit-identical."""

import ctypes

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from morse.kernel.rays import BOX, CAPSULE, CYLINDER, ELLIPSOID, MESH, SPHERE
from tests.kernel.twins import primitives
from tests.kit.effort import examples

PRIMITIVES = (BOX, SPHERE, CYLINDER, CAPSULE, ELLIPSOID)
anything = st.floats(allow_nan=True, allow_infinity=True)
sane = st.floats(-1e3, 1e3)
either = settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def by_kernel(build, kinds, origins, directions, sizes):
    distances = np.empty(len(kinds))
    rows = [np.ascontiguousarray(array) for array in (kinds, origins, directions, sizes, distances)]
    build.morse_first_surfaces(ctypes.c_int64(len(kinds)), *(ctypes.c_void_p(row.ctypes.data) for row in rows))
    return rows[-1]


def by_numpy(kind, origins, directions, sizes):
    with np.errstate(all="ignore"):
        return primitives.first_surface(kind, origins.T.copy(), directions.T.copy(), sizes.T.copy())


def same_bits(one, other):
    return ((one.view(np.int64) == other.view(np.int64)) | (np.isnan(one) & np.isnan(other))).all()


@either
@given(kind=st.sampled_from(PRIMITIVES), count=st.integers(0, 300), seed=st.integers(0, 10**6))
def test_rays_in_and_around_primitives(build, kind, count, seed):
    rng = np.random.default_rng(seed)
    origins, directions = rng.normal(size=(count, 3)) * rng.choice([0.1, 1.0, 30.0]), rng.normal(size=(count, 3))
    directions[rng.random((count, 3)) < 0.2] = 0.0  # along axes and planes
    directions /= np.maximum(np.linalg.norm(directions, axis=1), 1e-9)[:, None]
    sizes = rng.uniform(0.05, 2.0, size=(count, 3))
    answers = by_kernel(build, np.full(count, kind, dtype=np.int32), origins, directions, sizes)
    assert same_bits(answers, by_numpy(kind, origins, directions, sizes))
    assert not np.isnan(answers).any()


@either
@given(kind=st.sampled_from(PRIMITIVES), rows=arrays(np.float64, (7, 9), elements=st.one_of(sane, anything)))
def test_numbers_that_make_no_sense(build, kind, rows):
    origins, directions, sizes = rows[:, :3], rows[:, 3:6], rows[:, 6:]
    answers = by_kernel(build, np.full(len(rows), kind, dtype=np.int32), origins, directions, sizes)
    assert same_bits(answers, by_numpy(kind, origins, directions, sizes))


def test_a_kind_that_does_not_exist_is_met_by_no_ray(build):
    ones = np.ones((3, 3))
    answers = by_kernel(build, np.array([MESH, -1, 10**6], dtype=np.int32), ones, ones, ones)
    assert np.isinf(answers).all()
