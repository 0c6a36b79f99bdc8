"""Motion blur and rolling shutter, compared with the displacements that follow from velocities."""

import math

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, box

from morse.rendering import DistortedLens, Lens, Motion
from morse.rendering.lens import moved
from morse.scene import Material

WIDTH, HEIGHT, FOCAL, AWAY = 160, 96, 120.0, 4.0
LENS = Lens(WIDTH, HEIGHT, FOCAL, FOCAL, WIDTH / 2, HEIGHT / 2, 0.1, FAR)


class Dolly(Tripod):
    """A tripod that looks along X and moves."""

    def __init__(self, linear=(0, 0, 0), angular=(0, 0, 0)):
        super().__init__((0, 0, 0), (1, 0, 0))
        self.speeds = linear, angular

    def velocity(self):
        return self.speeds


def pole(half=0.2):
    return box("Pole", (AWAY + 0.05, 0, 0), (0.05, half, 30.0), material=Material("White", shadeless=True))


def seen(motion, lens=LENS, *, half=0.2, **speeds):
    studio = Studio(pole(half))
    request = studio.renderer.request(Dolly(**speeds), lens)
    request.motion = motion
    studio.renderer.serve([request])
    return request.picture


def middles(ids):
    """The mean column of the pole in each row."""
    columns = np.arange(ids.shape[1]) + 0.5
    return np.array([columns[row >= 0].mean() for row in ids])


@pytest.mark.parametrize(
    "lens", [LENS, DistortedLens(WIDTH, HEIGHT, FOCAL, FOCAL, WIDTH / 2, HEIGHT / 2, 0.1, FAR)], ids=["flat", "bent"]
)
def test_rolling_shutter_slants_a_pole_by_the_motion_during_the_read_out(lens):
    picture = seen(Motion(readout=0.05, steps=48), lens, linear=(0.0, 8.0, 0.0))
    # the camera moves to the left, so that the pole moves to the right; the last row is that of the tick
    time = -0.05 * (1 - (np.arange(HEIGHT) + 0.5) / HEIGHT)
    wanted = WIDTH / 2 + FOCAL * 8.0 * time / AWAY
    np.testing.assert_allclose(middles(picture.ids), wanted, atol=1.1)
    assert wanted[-1] - wanted[0] > 11


def test_rolling_shutter_of_a_turning_camera():
    picture = seen(Motion(readout=0.04, steps=96), angular=(0.0, 0.0, 2.0))
    time = -0.04 * (1 - (np.arange(HEIGHT) + 0.5) / HEIGHT)
    # to the left
    np.testing.assert_allclose(middles(picture.ids), WIDTH / 2 + FOCAL * np.tan(2.0 * time), atol=0.8)


def test_motion_blur_widens_a_pole_by_the_motion_during_the_exposure():
    still, blurred = (seen(Motion(exposure=0.1, steps=32), linear=(0, speed, 0)) for speed in (0.0, 6.0))
    sky = Studio().look(Dolly(), LENS).rgb
    width = [(np.abs(one.rgb.astype(int) - sky).sum(axis=2) > 2).sum(axis=1).mean() for one in (still, blurred)]
    assert width[0] == pytest.approx(2 * 0.2 * FOCAL / AWAY, abs=2.1)
    assert width[1] - width[0] == pytest.approx(6.0 * 0.1 * FOCAL / AWAY * 31 / 32, abs=1.5)
    # depth and ids are those of the middle of the exposure
    assert middles(blurred.ids).mean() == pytest.approx(WIDTH / 2 - 6.0 * 0.05 * FOCAL / AWAY, abs=0.8)


def test_nothing_is_blurred_at_rest():
    sharp = seen(None)
    both = seen(Motion(exposure=0.02, readout=0.02, steps=4))
    np.testing.assert_array_equal(both.ids, sharp.ids)
    np.testing.assert_array_equal(both.depth, sharp.depth)
    # the mean of equal lights is encoded again
    assert np.abs(both.rgb.astype(int) - sharp.rgb).max() <= 1


def test_poses_turn_by_the_angle_of_the_velocity():
    angular = np.array([[0.0, 0.0, 1.5], [0.3, -0.4, 0.0]])
    place, turn = moved(np.zeros((2, 3)), np.stack([np.eye(3)] * 2), np.ones((2, 3)), angular, 0.2)
    np.testing.assert_allclose(place, 0.2)
    np.testing.assert_allclose(turn[0, 0, :2], (math.cos(0.3), -math.sin(0.3)), atol=1e-7)
    np.testing.assert_allclose(turn @ turn.transpose(0, 2, 1), np.stack([np.eye(3)] * 2), atol=1e-12)
    assert np.trace(turn[1]) == pytest.approx(1 + 2 * math.cos(0.1), abs=1e-9)
