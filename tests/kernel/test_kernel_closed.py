"""The closed parts of meshes: those of the C function are those of numpy."""

import numpy as np
import pytest

from morse.assets import solids
from morse.kernel.drawing import meshes
from tests.kernel.twins import closed


def some_mesh(seed):
    """Boxes and balls, moved, stretched and turned; some with a hole, a face inside out, or a dent."""
    rng = np.random.default_rng(seed)
    points, faces, first = [], [], 0
    for _ in range(12):
        shape = [solids.cube, lambda: solids.ico_sphere(1)][rng.integers(2)]()
        place = np.asarray(shape.vertices, float).reshape(-1, 3) @ rng.normal(size=(3, 3)) + rng.normal(size=3) * 5
        face = np.asarray(shape.triangles).reshape(-1, 3).copy()
        fault = rng.integers(5)
        if fault == 0:
            face = face[1:]
        elif fault == 1:
            face[0] = face[0, ::-1]
        elif fault == 2:
            place[0] = place.mean(axis=0)
        points.append(place), faces.append(face + first)
        first += len(place)
    faces = np.concatenate(faces)
    order = rng.permutation(len(faces))
    # some triangles twice, and some without an area
    faces[order[:2]] = faces[order[2:4]]
    faces[order[4], 1] = faces[order[4], 0]
    return np.concatenate(points).astype(np.float32), faces[order].astype(np.int32)


@pytest.mark.parametrize("seed", range(20))
def test_random_meshes_alike(build, seed):
    mesh = some_mesh(seed)
    labels = meshes.closed_labels(*mesh, build)
    np.testing.assert_array_equal(labels, closed.closed_labels(*mesh))


def test_random_meshes_have_parts_of_both_kinds(build):
    shares = [(meshes.closed_labels(*some_mesh(seed), build) >= 0).mean() for seed in range(20)]
    assert 0.05 < np.mean(shares) < 0.8
