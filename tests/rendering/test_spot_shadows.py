"""Shadows of a spot lamp, at the positions that follow from the geometry."""

from dataclasses import replace

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, box, floor, lamp

from morse.rendering import Lens
from morse.scene import Light

TRIPOD, LENS = Tripod((-7.0, 0.5, 5.0), (0.0, 0.0, 0.0)), Lens.of_focal_length(320, 240, 40.0, 0.1, FAR)
HEIGHT, PLATE, HALF = 4.0, 2.0, 0.4


def spot(position=(0.0, 0.0, HEIGHT), towards=(0.0, 0.0, 1.0), **more):
    node = lamp("SPOT", towards, 3.0, position)
    node.light = replace(node.light or Light(), distance=5.0, spot_size=1.2, **more)
    return node


def plate(position=(0.0, 0.0, PLATE)):
    return box("Plate", position, (HALF, HALF, 0.02))


def dark(*nodes, **more):
    """The points of the floor (N, 3), and whether each is darker than with a lamp that casts no shadow."""
    pictures = [Studio(floor(), *nodes, spot(**more, casts_shadow=casts)).look(TRIPOD, LENS) for casts in (True, False)]
    shown = (pictures[0].ids == 0) & (pictures[0].ids == pictures[1].ids)
    assert pictures[0].nodes[0].name == "Floor"
    points = (LENS.rays() * pictures[0].depth[..., None])[shown] @ TRIPOD.axes.T + TRIPOD.position
    light = [picture.rgb[shown].sum(axis=1).astype(int) for picture in pictures]
    assert (light[0] <= light[1]).all()
    return points, light[0] < light[1] - 6


def test_the_edges_of_a_shadow_are_on_the_lines_through_the_edges_of_a_plate():
    points, shaded = dark(plate())
    # the upper side of the plate decides: similar triangles from the lamp to the floor
    edge = HALF * HEIGHT / (HEIGHT - PLATE - 0.02)
    away = np.abs(points[:, :2]).max(axis=1)
    assert shaded[away < edge - 0.05].all()
    assert not shaded[away > edge + 0.05].any()
    assert shaded.sum() > 300


def test_a_shadow_follows_the_lamp():
    lean = np.array([0.5, -0.5, HEIGHT])
    points, shaded = dark(plate(), position=tuple(lean), towards=tuple(lean))
    # the centre of the plate is projected from the lamp to the floor
    centre = lean + (np.array([0, 0, PLATE]) - lean) * HEIGHT / (HEIGHT - PLATE)
    middle = (points[shaded].min(axis=0) + points[shaded].max(axis=0)) / 2
    np.testing.assert_allclose(middle[:2], centre[:2], atol=0.06)


def test_surfaces_do_not_shadow_themselves():
    _, shaded = dark(position=(2.0, 1.0, HEIGHT), towards=(0.4, 0.2, 1.0))
    assert not shaded.any()


def test_a_shadow_moves_with_what_casts_it():
    studio = Studio(floor(), plate(), spot())
    before = studio.look(TRIPOD, LENS).rgb
    assert (studio.look(TRIPOD, LENS).rgb == before).all()
    studio.world.object_of(studio.scene.roots[1]).visible = False
    after = studio.look(TRIPOD, LENS)
    bare = Studio(floor(), spot()).look(TRIPOD, LENS)
    np.testing.assert_array_equal(after.rgb, bare.rgb)
    assert (after.rgb != before).any()


@pytest.mark.parametrize("angle", [2.2, 3.1])
def test_wide_spots_cast_no_shadow(angle):
    nodes = [spot(casts_shadow=casts) for casts in (True, False)]
    for node in nodes:
        node.light = replace(node.light, spot_size=angle)
    one, other = (Studio(floor(), plate(), node).look(TRIPOD, LENS).rgb for node in nodes)
    np.testing.assert_array_equal(one, other)
