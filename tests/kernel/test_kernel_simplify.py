"""Simplified meshes: those of the C function are those of Python, to the bit."""

import numpy as np
import pytest

from morse.assets import solids
from morse.kernel.drawing import meshes as drawing_meshes
from morse.kernel.drawing.meshes import Simplification
from tests.kernel.twins import simplify


def some_mesh(seed):
    """A stretched ball of two materials; smooth or flat, dented, with a hole, or with vertices that became one."""
    rng = np.random.default_rng(seed)
    ball = solids.ico_sphere(2)
    index = np.asarray(ball.triangles, np.int32).reshape(-1, 3)
    points = np.asarray(ball.vertices, float).reshape(-1, 3) @ rng.normal(size=(3, 3))
    points += rng.normal(size=points.shape) * rng.choice([0.0, 0.01, 0.05])
    index = index[rng.permutation(len(index))]
    if rng.integers(2):
        index = index[3:]
    if rng.integers(2):
        # two vertices become one
        index[index == index[0, 0]] = index[5, 1]
    corners = points[index]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    smooth = points / np.linalg.norm(points, axis=1)[:, None]
    textured = bool(rng.integers(2))
    uv = points[:, :2] if textured else np.zeros((len(points), 2))
    slots = (corners.mean(axis=1)[:, 0] > 0.3).astype(np.int32)
    rows = np.concatenate(
        [smooth[index] if rng.integers(2) else np.repeat(normal[:, None], 3, axis=1), uv[index]], axis=2
    )
    keyed = np.column_stack([rows.reshape(-1, 5), np.repeat(slots, 3)])
    looks, look = np.unique(keyed, axis=0, return_inverse=True)
    alive = (index != np.roll(index, 1, axis=1)).all(axis=1)
    return Simplification(
        points, np.ascontiguousarray(looks[:, :5]), looks[:, 5].astype(np.int32), index,
        look.reshape(-1, 3).astype(np.int32), np.zeros(len(index)), alive.astype(np.uint8), textured,
    )  # fmt: skip


def copied(mesh):
    return mesh._replace(**{name: getattr(mesh, name).copy() for name in ("vertices", "look", "errors", "alive")})


@pytest.mark.parametrize("seed", range(6))
def test_random_meshes_alike(build, seed):
    mine = some_mesh(seed)
    its = copied(mine)
    for limit in (0.03, 0.2):
        left = drawing_meshes.simplify(its, limit, build)
        assert left == simplify.simplify(mine, limit) == its.alive.sum()
        chosen = its.alive > 0
        np.testing.assert_array_equal(its.alive, mine.alive)
        for name in ("vertices", "look", "errors"):
            np.testing.assert_array_equal(getattr(its, name)[chosen], getattr(mine, name)[chosen])


def test_random_meshes_become_simpler(build):
    meshes = [some_mesh(seed) for seed in range(6)]
    left = [drawing_meshes.simplify(mesh, 0.2, build) for mesh in meshes]
    assert sum(left) < 0.7 * sum(len(mesh.alive) for mesh in meshes)
