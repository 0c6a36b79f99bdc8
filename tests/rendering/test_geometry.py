"""Positions and depths of objects in images: against formulas, and against rays."""

import itertools

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, ball, box, floor

from morse.assets import solids
from morse.kernel.rays import MESH, Fan, Poses, SolidArrays, TriangleMesh
from morse.rendering import Lens
from morse.scene import PhysicsType
from tests.kernel.twins.rays import ReferenceRays

LENS = Lens(400, 300, 380.0, 350.0, 190.0, 160.0, 0.1, FAR)


@pytest.mark.parametrize("position", [(4, -3, 2), (-3, -4, 1.5), (0.5, 6, 3), (3, 1, -2)])
def test_the_corners_of_a_box_are_where_the_pinhole_formula_has_them(position):
    half = (0.5, 0.8, 0.3)
    made = Studio(box("Box", (0, 0, 0), half))
    tripod = Tripod(position, (0.1, 0, 0))
    picture = made.look(tripod, LENS)
    corners = np.array(list(itertools.product(*((-h, h) for h in half))))
    pixels, _ = tripod.project(corners, LENS)
    rows, columns = np.nonzero(picture.ids >= 0)
    # the centre of a pixel is at 0.5; a corner can be up to one pixel outside the last covered pixel
    for axis, found in ((0, columns), (1, rows)):
        assert found.min() == pytest.approx(pixels[:, axis].min() - 0.5, abs=1.0)
        assert found.max() == pytest.approx(pixels[:, axis].max() - 0.5, abs=1.0)
    # a pixel is covered if its centre is in the hull of the corners
    inside = _in_hull(pixels, np.column_stack([columns, rows]) + 0.5)
    assert inside.all()
    outside = np.argwhere(picture.ids < 0)[:, ::-1] + 0.5
    assert not _in_hull(pixels, outside, slack=1e-3).any()


def _in_hull(corners, points, slack=-1e-3):
    """Whether points are in the convex hull of corners, with a margin in pixels."""
    inside = np.ones(len(points), bool)
    for a, b in itertools.permutations(corners, 2):
        normal = np.array([a[1] - b[1], b[0] - a[0]])
        if np.linalg.norm(normal) < 1e-9 or ((corners - a) @ normal < -1e-6).any():
            continue
        inside &= (points - a) @ (normal / np.linalg.norm(normal)) >= slack
    return inside


def test_the_depth_of_a_plane_in_closed_form():
    made = Studio(floor(0.0, half=200.0))
    tripod = Tripod((0, 0, 2.0), (5, 1, 0.5))
    picture = made.look(tripod, LENS)
    rays = LENS.rays() @ tripod.axes.T.astype(np.float64)
    expected = np.where(rays[..., 2] < 0, -2.0 / rays[..., 2], np.inf)
    seen = expected < FAR * 0.999
    assert seen.mean() > 0.3
    np.testing.assert_allclose(picture.depth[seen], expected[seen], rtol=1e-5)
    assert (picture.depth[expected > FAR * 1.001] == 0).all()
    assert (picture.ids[picture.depth == 0] == -1).all()


def test_the_depth_of_a_sphere_in_closed_form():
    made = Studio(ball("Ball", (0, 0, 0), 1.0, kind=PhysicsType.NO_COLLISION))
    picture = made.look(Tripod((4, 0, 0), (0, 0, 0)), LENS)
    ray = LENS.rays().astype(np.float64)
    a, b, c = (ray**2).sum(axis=2), ray[..., 2] * 4.0, 15.0
    square = b**2 - a * c
    depth = (b - np.sqrt(np.maximum(square, 0))) / a
    # triangles are within the sphere, by at most their sagitta
    inner = square > 0.3
    assert inner.sum() > 1000
    assert np.abs(picture.depth - depth)[inner].max() < 4e-3
    # the silhouette: an ellipse with semi-axes f / sqrt(4^2 - 1)
    columns = np.nonzero((picture.ids >= 0).any(axis=0))[0]
    assert columns[-1] - columns[0] + 1 == pytest.approx(2 * LENS.fx / np.sqrt(15.0), abs=2)


def test_depth_and_ids_are_those_of_rays_pixel_by_pixel():
    rng = np.random.default_rng(4)
    nodes, meshes, places, turns = [], [], [], []
    for number in range(12):
        mesh = [solids.cube(), solids.cone(), solids.torus(), solids.cylinder()][number % 4]
        location, rotation = rng.uniform(-3, 3, 3), rng.uniform(-3, 3, 3)
        node = box(f"Thing{number}", location, (1, 1, 1), rotation=rotation, kind=PhysicsType.NO_COLLISION)
        node.mesh = mesh
        nodes.append(node)
        matrix = np.array([list(row) for row in node.world_matrix()])
        meshes.append(TriangleMesh(mesh.vertices.astype(np.float64), mesh.triangles))
        places.append(matrix[:3, 3])
        turns.append(matrix[:3, :3])
    made = Studio(*nodes)
    tripod = Tripod((9, -4, 5), (0, 0, 0))
    lens = Lens(120, 90, 90.0, 90.0, 60.0, 45.0, 0.1, FAR)
    picture = made.look(tripod, lens)
    count = len(nodes)
    caster = ReferenceRays(
        SolidArrays(
            np.full(count, MESH, np.int32), np.ones((count, 3)), np.zeros(count, np.int64),
            np.array(places), np.array(turns), np.zeros((count, 3)), np.full((count, 3), 3.0), meshes,
        )
    )  # fmt: skip
    poses = Poses(np.zeros((1, 3)), np.eye(3)[None], np.zeros(3))
    caster.gather(np.arange(count), moving=False)
    caster.gather(np.arange(0), moving=True)
    caster.place(poses, moving=False)
    caster.place(poses, moving=True)
    directions = lens.rays().reshape(-1, 3).astype(np.float64)
    lengths = np.linalg.norm(directions, axis=1)
    fan = Fan(
        np.zeros(1, np.int64), tripod.position[None], tripod.axes[None], directions / lengths[:, None], None, False,
        1e3, np.full(1, -5, np.int64),
    )  # fmt: skip
    hits = caster.cast(fan, poses, np.zeros(count, np.int64))
    found, depth = hits.solids[0], hits.distances[0] / lengths
    ids = picture.ids.ravel()
    assert (ids >= 0).mean() > 0.15
    agree = ids == found
    # a pixel whose centre is on an edge may show either side
    assert agree.mean() > 0.9995
    both = agree & (ids >= 0)
    np.testing.assert_allclose(picture.depth.ravel()[both], depth[both], rtol=2e-5)


def test_what_is_nearer_than_near_or_farther_than_far_is_not_seen():
    made = Studio(box("Wall", (3, 0, 0), (0.1, 5, 5)), box("Door", (1, 0, 0), (0.1, 0.1, 0.1)))
    tripod = Tripod((0, 0, 0), (1, 0, 0))
    whole = made.look(tripod, Lens.of_focal_length(64, 64, 32, 0.1, 10))
    assert whole.nodes[whole.ids[32, 32]].name == "Door"
    beyond = made.look(tripod, Lens.of_focal_length(64, 64, 32, 1.5, 10))
    assert beyond.nodes[beyond.ids[32, 32]].name == "Wall"
    nothing = made.look(tripod, Lens.of_focal_length(64, 64, 32, 0.1, 2.5))
    assert (nothing.ids[0] == -1).all()


def test_a_wall_that_reaches_behind_the_camera_fills_what_it_should():
    made = Studio(floor(0.0, half=500.0))
    picture = made.look(Tripod((0, 0, 1), (1, 0, 1)), Lens(64, 64, 32, 32, 32, 32, 0.01, 900))
    assert (picture.ids[33:] == 0).all()
    assert (picture.ids[:32] == -1).all()


@pytest.mark.parametrize("angle", [30.0, 90.0, 150.0])
def test_a_lens_sees_so_much(angle):
    lens = Lens.of_angle(200, 100, np.radians(angle))
    edge = (0 - lens.cx) / lens.fx
    assert 2 * np.degrees(np.arctan(-edge)) == pytest.approx(angle)
    assert lens.fx == lens.fy


def test_the_focal_length_is_that_of_a_sensor_32_mm_wide():
    assert Lens.of_focal_length(256, 128, 35.0).matrix == [[280.0, 0, 127.5], [0, 280.0, 63.5], [0, 0, 1]]
