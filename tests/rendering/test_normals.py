"""Normals of surfaces, compared with the normals of a plane and of a sphere."""

import math

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, ball, body, box, floor, triangles

from morse.rendering import DistortedLens, Lens

EYE, TARGET = (-4.0, 1.0, 2.5), (0.0, 0.0, 0.4)
PINHOLE = Lens.of_focal_length(120, 90, 32.0, 0.1, FAR)


def normals_of(studio, tripod, lens=PINHOLE):
    return studio.look(tripod, lens, color=False, normals=True)


def test_normals_of_a_plane_point_up():
    tripod = Tripod(EYE, TARGET)
    picture = normals_of(Studio(floor(half=3.0)), tripod)
    above = picture.ids >= 0
    assert 0.3 < above.mean() < 0.9
    np.testing.assert_allclose(picture.normals[above] @ tripod.axes.T, np.full((above.sum(), 3), (0, 0, 1)), atol=1e-6)
    assert (picture.normals[~above] == 0).all()


@pytest.mark.parametrize(
    "lens",
    [
        PINHOLE,
        DistortedLens(120, 90, 120.0, 120.0, 60, 45, 0.1, FAR, "plumb_bob", (-0.2, 0.05, 0.001, 0, 0)),
        DistortedLens.of_fisheye_angle(120, 90, math.radians(190), (0.01, 0, 0, 0), 0.1, FAR),
    ],
    ids=["pinhole", "plumb_bob", "equidistant"],
)
def test_normals_of_a_sphere_are_radial(lens):
    centre, tripod = np.array([0.0, 0.0, 0.4]), Tripod(EYE, TARGET)
    studio = Studio(ball("Ball", centre, 1.5))
    picture = normals_of(studio, tripod, lens)
    found = picture.ids == studio.number(picture, "Ball")
    assert found.sum() > 200
    points = (lens.rays() * picture.depth[..., None])[found] @ tripod.axes.T + EYE
    wanted = (points - centre) / np.linalg.norm(points - centre, axis=1)[:, None]
    cosine = ((picture.normals[found] @ tripod.axes.T) * wanted).sum(axis=1)
    # the facets of the sphere are up to 2 degrees wide; distorted images take the nearest pixel
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean() < 2.5
    np.testing.assert_allclose(np.linalg.norm(picture.normals[found], axis=1), 1.0, atol=1e-5)


def test_both_sides_of_a_surface_face_the_camera():
    sheet = triangles([(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)], [(0, 1, 2), (0, 2, 3)])
    for side in (-3.0, 3.0):
        tripod = Tripod((side, 0.0, 0.0), (0, 0, 0))
        picture = normals_of(Studio(body("Sheet", sheet)), tripod)
        np.testing.assert_allclose(picture.normals[45, 60], (0, 0, -1), atol=1e-6)


def test_stretched_and_mirrored_boxes_keep_their_normals():
    tripod = Tripod((-4, 0, 0), (0, 0, 0))
    picture = normals_of(Studio(box("Box", (0, 0, 0), (-0.3, 1.0, 2.0))), tripod)
    np.testing.assert_allclose(picture.normals[45, 60], (0, 0, -1), atol=1e-6)


def test_pictures_have_normals_only_on_request():
    assert Studio(floor()).look(Tripod(EYE, TARGET), PINHOLE).normals is None
