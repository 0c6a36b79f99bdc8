"""Large scenes have two shadow maps; objects in the middle of the finer one are left out of the other."""

import numpy as np
import pytest
from studio import Studio, Tripod, box, floor

import morse.rendering.lights as shadows
from morse.rendering import Lens
from morse.scene import PhysicsType

LENS = Lens.of_focal_length(64, 48, 20.0, 0.1, 300)
#: in the finer map, at its border, and outside
PLACES = [(0.0, 0.0), (9.0, 0.0), (11.5, 0.0), (14.0, 0.0), (40.0, 0.0)]


def world():
    return Studio(floor(half=120.0), box("Box", (0, 0, 1), (0.5, 0.5, 0.5), kind=PhysicsType.RIGID_BODY))


def look_at(studio, x, y):
    crate = studio.world.game_object("Box")
    crate.set_pose((x, y, 1.0), crate.world_pose()[1])
    return studio.look(Tripod((x - 4, y - 4, 5), (x, y, 0)), LENS).rgb


def test_shadows_follow_an_object_from_one_map_to_the_other_and_back():
    moved = world()
    for x, y in PLACES[::2] + PLACES[:1]:
        np.testing.assert_array_equal(look_at(moved, x, y), look_at(world(), x, y))


@pytest.mark.parametrize("place", PLACES)
def test_what_is_left_out_is_not_seen(monkeypatch, place):
    with_less = look_at(world(), *place)
    covered = []

    def nothing(self, ratio):
        covered.append(covers(self, ratio))
        return np.zeros_like(covered[0])

    covers = shadows.ShadowMap.covers
    monkeypatch.setattr(shadows.ShadowMap, "covers", nothing)
    np.testing.assert_array_equal(with_less, look_at(world(), *place))
    # two maps are in use, and objects far from the border of the finer one are left out
    assert covered
    assert covered[0].all() == (place in PLACES[:2])
