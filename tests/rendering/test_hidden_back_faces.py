"""Closed parts of meshes, whose back faces are left out."""

import numpy as np
import pytest
from studio import Studio, Tripod, body, triangles

from morse.assets import solids
from morse.kernel.drawing.arrays import CLOSED, MIXED
from morse.rendering import Lens
from morse.rendering.meshes import closed_parts
from morse.scene import Material

POINTS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
FACES = np.array(
    [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
        (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
    ]
)  # fmt: skip
NO_SLOTS = np.zeros(len(FACES), int)


def parts(points, faces, slots=None):
    return closed_parts(points, faces, np.zeros(len(faces), int) if slots is None else slots)


def test_a_cube():
    found = parts(POINTS, FACES)
    assert (found.part == 0).all()
    np.testing.assert_allclose(found.spheres, [[0, 0, 0, np.sqrt(3)]])


def test_corners_of_flat_faces_are_welded():
    """Every triangle has its own vertices, as with normals of its own."""
    found = parts(POINTS[FACES].reshape(-1, 3), np.arange(36).reshape(12, 3))
    assert (found.part == 0).all()


def test_a_ball_far_from_the_origin():
    ball = solids.ico_sphere(3)
    points = np.asarray(ball.vertices, np.float32).reshape(-1, 3) * np.float32(0.1) + np.float32(20)
    assert (parts(points, np.asarray(ball.triangles).reshape(-1, 3)).part == 0).all()


def dented():
    points = np.concatenate([POINTS, [(0, 0, 0.5)]]).astype(np.float32)
    roof = [(1, 5, 8), (5, 7, 8), (7, 3, 8), (3, 1, 8)]
    return points, np.concatenate([FACES[:10], roof])


@pytest.mark.parametrize(
    ("points", "faces", "slots"),
    [
        (POINTS, FACES[1:], NO_SLOTS[1:]),
        (POINTS, FACES[:, ::-1], NO_SLOTS),
        (POINTS, np.concatenate([FACES[:1, ::-1], FACES[1:]]), NO_SLOTS),
        (POINTS, np.concatenate([FACES, FACES[:1]]), np.zeros(13, int)),
        (POINTS[:0], FACES[:0], NO_SLOTS[:0]),
    ],
    ids=["open", "inside out", "one face inside out", "a face twice", "nothing"],
)
def test_parts_that_are_not_closed(points, faces, slots):
    found = parts(points, faces, slots)
    assert (found.part == -1).all()
    assert len(found.spheres) == 0


def test_a_dented_cube():
    points, faces = dented()
    assert (parts(points, faces).kind == CLOSED).all()


def test_a_cube_of_two_materials():
    assert (parts(POINTS, FACES, np.arange(12) // 6).kind == MIXED).all()


def test_parts_are_told_apart():
    points, dent = dented()
    both = np.concatenate([POINTS, points + np.float32(0.5), POINTS * 2 + np.float32(7)])
    found = parts(both, np.concatenate([FACES, dent[1:] + 8, FACES + 8 + len(points)]))
    assert found.part.tolist() == [0] * 12 + [-1] * 13 + [1] * 12
    np.testing.assert_allclose(found.spheres, [[0, 0, 0, np.sqrt(3)], [7, 7, 7, 2 * np.sqrt(3)]], rtol=1e-6)


@pytest.mark.parametrize(("place", "seen"), [(0.0, 1.0), (0.85, 1.0), (5.0, 0.0)], ids=["in", "by the wall", "away"])
def test_walls_are_visible_from_inside(place, seen):
    """A camera in a closed room, at its wall, and one that looks away from it."""
    studio = Studio(body("Room", triangles(POINTS, FACES)))
    picture = studio.look(Tripod((place, 0, 0), (place + 1, 0, 0.1)), Lens.of_focal_length(40, 30, 32.0, 0.1, 50.0))
    assert (picture.ids >= 0).mean() == seen
    if seen:
        # the wall is at 1 m, and the axis of the camera is inclined
        assert picture.depth.max() < 1.2 * (1 - place)


@pytest.mark.parametrize(("opacity", "seen"), [(1.0, 0.0), (0.5, 0.5)], ids=["opaque", "translucent"])
def test_inner_walls_are_visible_through_a_translucent_wall(opacity, seen):
    """The wall in front of the camera has a material of its own, and half of its pixels let the camera see inside."""
    # the triangles of the face at X = -1
    front = np.isin(np.arange(12), (0, 1)).astype(np.int32)
    node = body("Box", triangles(POINTS, FACES, index=front))
    node.materials = [
        Material("Sides", double_sided=True),
        Material("Front", color=(1, 1, 1, opacity), double_sided=True),
    ]
    picture = Studio(node).look(Tripod((-5, 0, 0), (0, 0, 0)), Lens.of_focal_length(40, 40, 64.0, 0.1, 50.0))
    assert (picture.ids >= 0).mean() > 0.2
    # the wall at X = 1 is at a distance of 6 m
    assert (picture.depth[15:25, 15:25] > 5).mean() == seen
