"""Images of a world without a camera in the scene."""

import math

import numpy as np
import pytest

SCENE = """
from morse.builder import *
ball = Sphere("ball")
ball.location = (0.0, 0.0, 1.0)
ball.set_color(0.9, 0.0, 0.0)
env = Environment("empty")
env.set_camera_location([8.0, 0.0, 1.0])
env.set_camera_rotation([math.pi / 2, 0.0, math.pi / 2])
env.set_camera_focal_length(32.0)
"""


@pytest.fixture
def simulation(load):
    return load(SCENE)


def red(image):
    """Columns and rows of the red pixels."""
    pixels = image.astype(int)
    return np.nonzero((pixels[..., 0] > 60) & (pixels[..., 0] > 2 * pixels[..., 1]))[::-1]


def test_it_looks_where_the_live_view_looks(simulation):
    image = simulation.picture(320, 200)
    assert image.shape == (200, 320, 3)
    assert image.dtype == np.uint8
    columns, rows = red(image)
    # the outline of a ball of 1 m at 8 m: tan(asin(1/8)) times the focal length of 320 pixels
    radius = 320 * math.tan(math.asin(1.0 / 8.0))
    assert columns.mean() + 0.5 == pytest.approx(160.0, abs=1.0)
    assert columns.max() - columns.min() + 1 == pytest.approx(2 * radius, abs=3.0)
    assert rows.max() - rows.min() + 1 == pytest.approx(2 * radius, abs=3.0)


def test_it_may_stand_anywhere(simulation):
    # from above, 1 m beside the ball: it is on the left of the image, whose upper side is north
    columns, rows = red(simulation.picture(320, 200, location=(1.0, 0.0, 9.0), rotation=(0.0, 0.0, 0.0)))
    assert columns.mean() + 0.5 == pytest.approx(160.0 - 320.0 / 8.0, abs=1.5)
    assert rows.mean() + 0.5 == pytest.approx(100.0, abs=1.5)


def test_the_same_bits_again(simulation):
    assert np.array_equal(simulation.picture(64, 40), simulation.picture(64, 40))


@pytest.mark.parametrize("wrong", [{"width": 0}, {"height": 10**6}, {"focal_length": 0.0}, {"focal_length": math.nan}])
def test_what_makes_no_picture_is_refused(simulation, wrong):
    with pytest.raises(ValueError, match=r"picture|focal length"):
        simulation.picture(**wrong)
    with pytest.raises(ValueError, match="three finite numbers"):
        simulation.picture(location=(math.nan, 0.0, 0.0))
    with pytest.raises(ValueError, match="three finite numbers"):
        simulation.picture(rotation=(0.0, 0.0))
