"""Meshes that are processed in parts."""

import tracemalloc

import numpy as np
import pytest
from studio import triangles

from morse.rendering.meshes import clusters_of

SIDE = 100


@pytest.fixture(scope="module")
def hills():
    """20,000 triangles, some of them without corners that exist."""
    x, y = np.meshgrid(np.linspace(-1, 1, SIDE + 1), np.linspace(-1, 1, SIDE + 1))
    points = np.column_stack([x.ravel(), y.ravel(), np.sin(5 * x * y).ravel()])
    first = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).ravel()
    faces = np.concatenate([first[:, None] + (0, 1, SIDE + 2), first[:, None] + (0, SIDE + 2, SIDE + 1)])
    faces[[5, 700], 1] = -1, len(points)
    uvs = np.random.default_rng(1).normal(size=(len(faces), 3, 2)).astype(np.float32)
    return triangles(points, faces, uvs, index=np.arange(len(faces)) % 3)


def peak(mesh, at_once):
    """Bytes that are allocated at most while the mesh is processed."""
    tracemalloc.start()
    try:
        clusters_of(mesh, 3, at_once)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_clusters_do_not_depend_on_the_size_of_the_parts(hills):
    whole = clusters_of(hills, 3, 1 << 17)
    assert len(whole.triangles) == 2 * SIDE * SIDE - 2
    for at_once in (256, 1024, 4096):
        for one, other in zip(whole, clusters_of(hills, 3, at_once), strict=True):
            np.testing.assert_array_equal(one, other)


def test_temporary_memory_is_bounded_by_the_size_of_the_parts(hills):
    count = 2 * SIDE * SIDE
    # results and order, twice while they are joined; a whole mesh takes several hundred bytes per triangle more
    assert peak(hills, 1024) < 200 * count + 1024 * 1000
    assert peak(hills, 1 << 17) > 400 * count
