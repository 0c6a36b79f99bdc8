"""The motion of points in the image, in closed form."""

import math

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, ball, box, floor

from morse.rendering import DistortedLens, Lens
from morse.rendering.flow import moment_of, optical_flow
from morse.rendering.picture import Chip, exposed
from morse.rendering.textures import LIGHT, encoded

LENS = Lens(160, 120, 120.0, 120.0, 80.0, 60.0, 0.1, FAR)


def flow_between(studio, one, other, lens=LENS, between=lambda: None):
    before = studio.look(one, lens, color=False)
    between()
    after = studio.look(other, lens, color=False)
    return optical_flow(after, lens, moment_of(before)), after


def wall():
    return Studio(box("Wall", (5.5, 0, 0), (0.5, 30, 30)))


def test_nothing_moves():
    tripod = Tripod((0, 0, 0), (1, 0, 0))
    flow, _ = flow_between(wall(), tripod, tripod)
    assert np.abs(flow).max() < 1e-4


def test_a_step_to_the_side_moves_a_wall_by_the_pinhole_formula():
    # half a metre to the left, along a wall 5 m ahead: everything moves to the right by f / z
    flow, _ = flow_between(wall(), Tripod((0, 0, 0), (1, 0, 0)), Tripod((0, 0.5, 0), (1, 0.5, 0)))
    np.testing.assert_allclose(flow[..., 0], 120 * 0.5 / 5, atol=2e-3)
    np.testing.assert_allclose(flow[..., 1], 0.0, atol=2e-3)


def test_a_step_ahead_lets_the_picture_grow_from_its_middle():
    flow, _ = flow_between(wall(), Tripod((-1, 0, 0), (1, 0, 0)), Tripod((0, 0, 0), (1, 0, 0)))
    y, x = np.mgrid[0:120, 0:160] + 0.5
    # at 5 m now, at 6 m before: x - cx was 5 / 6 of what it is
    np.testing.assert_allclose(flow[..., 0], (x - 80) / 6, atol=2e-3)
    np.testing.assert_allclose(flow[..., 1], (y - 60) / 6, atol=2e-3)


def test_what_is_infinitely_far_moves_by_turning_alone():
    angle = 0.05
    studio = Studio(ball("Ball", (0, -20, 0), 0.1))
    flow, picture = flow_between(
        studio, Tripod((0, 0, 0), (1, 0, 0)), Tripod((3, 1, 0), (3 + math.cos(angle), 1 + math.sin(angle), 0))
    )
    assert (picture.ids == -1).all()
    # rotated to the left: the centre of the image was to the left of it by f tan(angle), and moved to the right
    assert flow[60, 80, 0] == pytest.approx(120 * math.tan(angle), abs=0.01)
    assert flow[60, 80, 1] == pytest.approx(0.0, abs=0.01)


def test_what_moves_by_itself_moves_in_the_picture():
    mover, still = box("Mover", (5, 0, 0), (0.5, 0.5, 0.5)), box("Wall", (9.5, 0, 0), (0.5, 30, 30))
    studio = Studio(mover, still)
    tripod = Tripod((0, 0, 0), (1, 0, 0))
    obj = studio.world.object_of(mover)

    def move():
        obj.worldPosition = (5.0, 0.25, 0.0)

    flow, picture = flow_between(studio, tripod, tripod, between=move)
    on = picture.ids == studio.number(picture, "Mover")
    assert on.sum() > 100
    # 0.25 m to the left, its front at 4.5 m
    np.testing.assert_allclose(flow[on][:, 0], -120 * 0.25 / 4.5, atol=0.01)
    assert np.nanmax(np.abs(flow[picture.ids == studio.number(picture, "Wall")])) < 1e-3


def test_what_was_behind_the_camera_has_no_flow():
    flow, picture = flow_between(
        Studio(floor(), box("Box", (4, 0, 1), (0.5, 0.5, 0.5))),
        Tripod((6, 0, 1), (7, 0, 1)),
        Tripod((0, 0, 1), (1, 0, 1)),
    )
    assert np.isnan(flow[picture.ids == 1]).all()


@pytest.mark.parametrize(
    "lens",
    [
        DistortedLens(160, 120, 110.0, 110.0, 80.0, 60.0, 0.1, FAR, "plumb_bob", (-0.25, 0.06, 0.001, 0.001, 0.0)),
        DistortedLens.of_fisheye_angle(160, 120, math.radians(160), (0.01, 0.0, 0.0, 0.0), 0.1, FAR),
    ],
)
def test_with_lenses_that_bend_lines_nothing_moves_either(lens):
    """Directions and projection are each other's inverse."""
    tripod = Tripod((0, 0, 1.5), (3, 0, 0.5))
    flow, picture = flow_between(Studio(floor()), tripod, tripod, lens)
    seen = picture.ids >= 0
    assert np.nanmax(np.abs(flow[seen])) < 0.01
    assert np.isfinite(flow[seen]).all(axis=-1).mean() > 0.95


def test_opencv_finds_the_same_flow():
    cv2 = pytest.importorskip("cv2")
    rng = np.random.default_rng(5)
    spots = [
        box(f"Spot{i}", (4.9, *rng.uniform(-3.5, 3.5, 2)), (0.05, *rng.uniform(0.05, 0.25, 2))) for i in range(250)
    ]
    for spot in spots:
        spot.color = (*rng.uniform(0.05, 1.0, 3), 1.0)
    studio = Studio(box("Wall", (5.5, 0, 0), (0.5, 30, 30)), *spots)
    one, other = Tripod((0, 0, 0), (1, 0, 0)), Tripod((0.1, 0.08, 0.03), (1.1, 0.1, 0.02))
    grey = [cv2.cvtColor(studio.look(t, LENS).rgb, cv2.COLOR_RGB2GRAY) for t in (one, other)]
    flow, _ = flow_between(studio, one, other)
    # from the later image to the earlier one, with the opposite sign
    found = -cv2.calcOpticalFlowFarneback(grey[1], grey[0], None, 0.5, 4, 15, 8, 7, 1.5, 0)
    inner = (slice(20, 100), slice(20, 140))
    error = np.linalg.norm(found - flow, axis=2)[inner]
    assert np.nanmedian(error) < 0.25
    assert np.nanmedian(np.linalg.norm(flow, axis=2)[inner]) > 1.0


# -- sensor noise: mean, standard deviation and repetition, in linear light ------------------------


def generators(seed=1):
    return np.random.default_rng(seed), np.random.default_rng(99)


def flat(code, size=200):
    return np.full((size, size, 3), code, np.uint8)


@pytest.mark.parametrize("code", [120, 160, 200])
def test_shot_noise_is_the_square_root_of_the_electrons(code):
    electrons = 2000.0
    light = LIGHT[exposed(Chip(full_well=electrons), flat(code), *generators())]
    mean = float(LIGHT[code])
    assert light.mean() == pytest.approx(mean, rel=0.01)
    # sigma of n electrons is sqrt(n): in units of the full well sqrt(mean / electrons); quantization adds a little
    assert light.std() == pytest.approx(np.sqrt(mean / electrons), rel=0.05)


def test_read_noise_does_not_depend_on_the_light():
    for code in (140, 220):
        light = LIGHT[exposed(Chip(read_noise=0.02), flat(code), *generators())]
        assert light.std() == pytest.approx(0.02, rel=0.05)


def test_stuck_pixels_stay_where_they_are():
    chip, picture = Chip(stuck=0.02), flat(128)
    first, second = (exposed(chip, picture, np.random.default_rng(i), np.random.default_rng(99)) for i in (1, 2))
    np.testing.assert_array_equal(first, second)
    black, white = (first == 0).all(axis=2).mean(), (first == 255).all(axis=2).mean()
    assert black == pytest.approx(0.01, rel=0.3)
    assert white == pytest.approx(0.01, rel=0.3)
    assert (first == 128).all(axis=2).mean() == pytest.approx(0.98, abs=0.005)


def test_a_perfect_chip_changes_nothing():
    picture = flat(77, 20)
    assert exposed(Chip(), picture, *generators()) is picture


def test_codes_and_light_are_each_others_inverse():
    np.testing.assert_array_equal(encoded(LIGHT), np.arange(256))
    np.testing.assert_array_equal(encoded(np.float32([-1.0, 0.0, 1.0, 9.0])), [0, 0, 255, 255])
