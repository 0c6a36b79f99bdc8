"""Simplified meshes at a distance: their errors, borders between materials, and pictures without them."""

import numpy as np
import pytest
from studio import Studio, Tripod, body

from morse.assets import solids
from morse.rendering import Lens
from morse.rendering.meshes import levels_of

LENS = Lens.of_focal_length(120, 120, 32.0, 0.1, 200.0)
RADIUS, AWAY = 2.0, 25.0
TRIPOD = Tripod((-AWAY, 0, 0), (0, 0, 0))


@pytest.fixture(scope="module")
def ball():
    return solids.ico_sphere(4)


@pytest.fixture(scope="module")
def studio(ball):
    """A ball that is 15 pixels wide."""
    return Studio(body("Ball", ball, scale=[RADIUS] * 3))


def seen(studio, error):
    request = studio.renderer.request(TRIPOD, LENS)
    request.screen_space_error = error
    studio.renderer.serve([request])
    return request.picture


def radii(picture):
    """The distances of the surfaces in the pixels from the centre of the ball."""
    v, u = np.nonzero(picture.ids >= 0)
    depth = picture.depth[v, u].astype(float)
    x, y = (u + 0.5 - LENS.cx) / LENS.fx * depth, (v + 0.5 - LENS.cy) / LENS.fy * depth
    return np.sqrt(x**2 + y**2 + (depth - AWAY) ** 2)


def test_the_error_is_below_the_bound(studio):
    # AWAY is farther than the nearest point of the ball, for which the level is chosen
    allowed = 1.5 * AWAY / LENS.fx
    full, coarse = radii(seen(studio, 0.0)), radii(seen(studio, 1.5))
    assert (abs(coarse - RADIUS) < allowed + RADIUS - full.min()).all()
    # a coarser mesh was drawn
    assert RADIUS - coarse.min() > 4 * (RADIUS - full.min())


def test_pictures_in_full_detail_do_not_depend_on_other_cameras(ball):
    studio = Studio(body("Ball", ball, scale=[RADIUS] * 3))
    alone = seen(studio, 0.0)
    seen(studio, 1.0)
    after = seen(studio, 0.0)
    for name in ("rgba", "depth", "ids"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(after, name))


def rows_of(points, index):
    """The corners of flat triangles."""
    corners = np.asarray(points, float)[index]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rows = np.zeros((len(index), 3, 8), np.float32)
    rows[..., :3], rows[..., 3:6] = corners, normal[:, None]
    return rows


def slab(count):
    """A closed slab of 1 m with a grid of triangles on both sides, and the squares of each triangle."""
    side = np.linspace(0, 1, count + 1)
    x, y = (a.ravel() for a in np.meshgrid(side, side, indexing="ij"))
    each = len(x)
    points = np.concatenate([np.column_stack([x, y, np.full(each, z)]) for z in (0.0, 0.1)])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    a = i * (count + 1) + j
    b, c, d = a + count + 1, a + count + 2, a + 1
    top = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]) + each
    bottom = top[:, ::-1] - each
    edge = np.concatenate([np.arange(count) * (count + 1), count * (count + 1) + np.arange(count),
                           np.arange(count, 0, -1) * (count + 1) + count, np.arange(count, 0, -1)])  # fmt: skip
    after = np.roll(edge, -1)
    walls = [np.column_stack([edge, after, after + each]), np.column_stack([edge, after + each, edge + each])]
    return points, np.concatenate([top, bottom, *walls])


def area_of(rows):
    corners = rows[..., :3].astype(float)
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2


def test_the_squares_of_a_chessboard_remain():
    points, index = slab(16)
    rows = rows_of(points, index)
    square = (rows[..., :2].mean(axis=1) * 4).astype(int)
    is_top = rows[..., 2].min(axis=1) > 0.05
    slot = np.where(is_top, square.sum(axis=1) % 2, 0)
    levels = levels_of(rows, slot, textured=False)
    assert levels
    assert len(levels[-1].rows) < 0.4 * len(rows)
    for level in levels:
        black = area_of(level.rows)[slot[level.origin] == 1].sum()
        # eight black squares, with a perimeter of 1 m each
        assert abs(black - 0.5) <= 8 * level.error + 1e-6


def test_a_flat_mesh_is_simplified_without_an_error():
    points, index = slab(12)
    (first, *_) = levels_of(rows_of(points, index), np.zeros(len(index), int), textured=False)
    assert first.error < 1e-7
    assert len(first.rows) < 0.3 * len(index)
    np.testing.assert_allclose(area_of(first.rows).sum(), 2.4, rtol=1e-5)


def test_edges_remain_closed(ball):
    points = np.asarray(ball.vertices, float).reshape(-1, 3)
    index = np.asarray(ball.triangles).reshape(-1, 3)
    for level in levels_of(rows_of(points, index), np.zeros(len(index), int), textured=False):
        places, number = np.unique(level.rows[..., :3].reshape(-1, 3), axis=0, return_inverse=True)
        number = number.reshape(-1, 3)
        start, end = number.ravel(), number[:, [1, 2, 0]].ravel()
        edges = set(zip(start.tolist(), end.tolist(), strict=True))
        # each edge has one triangle on each side; Euler's formula for a ball
        assert len(edges) == len(start)
        assert all((b, a) in edges for a, b in edges)
        assert len(places) - len(edges) // 2 + len(number) == 2
        # no point of the ball is farther from its centre, and no triangle deeper than the error
        assert (np.linalg.norm(places, axis=1) < 1.0 + 1e-6).all()
        deep = 1.0 - np.linalg.norm(level.rows[..., :3].mean(axis=1), axis=1)
        assert deep.max() <= level.error + 0.01


def test_small_meshes_are_not_simplified():
    cube = solids.cube()
    rows = rows_of(np.asarray(cube.vertices).reshape(-1, 3), np.asarray(cube.triangles).reshape(-1, 3))
    assert levels_of(rows, np.zeros(len(rows), int), textured=False) == []
