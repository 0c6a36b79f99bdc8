"""Lenses with distortion, compared with the formulas of OpenCV's documentation."""

import math

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, ball, box, floor

from morse.rendering import DistortedLens, Lens, Motion
from morse.rendering.distortion import coefficients, lens_of
from morse.rendering.lens import moved
from morse.scene import Material

BARREL = (-0.28, 0.07, 0.001, -0.002, 0.0)
PINCUSHION = (0.15, 0.02, -0.001, 0.001, 0.01)
FISHEYE = (-0.02, 0.004, -0.001, 0.0002)


def plumb_bob(points, lens):
    """Pixels of points (N, 3): X right, Y down, Z forward."""
    k1, k2, p1, p2, k3 = lens.coefficients
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.column_stack([lens.fx * u + lens.cx, lens.fy * v + lens.cy])


def fisheye(points, lens):
    k1, k2, k3, k4 = lens.coefficients
    flat = np.hypot(points[:, 0], points[:, 1])
    angle = np.arctan2(flat, points[:, 2])
    bent = angle * (1 + k1 * angle**2 + k2 * angle**4 + k3 * angle**6 + k4 * angle**8)
    share = bent / np.maximum(flat, 1e-12)
    return np.column_stack([lens.fx * share * points[:, 0] + lens.cx, lens.fy * share * points[:, 1] + lens.cy])


@pytest.mark.parametrize(
    ("lens", "project"),
    [
        (DistortedLens(160, 120, 110.0, 105.0, 82.0, 58.0, 0.1, FAR, "plumb_bob", BARREL), plumb_bob),
        (DistortedLens(160, 120, 110.0, 105.0, 82.0, 58.0, 0.1, FAR, "plumb_bob", PINCUSHION), plumb_bob),
        (DistortedLens(160, 120, 40.0, 42.0, 79.0, 61.0, 0.1, FAR, "equidistant", FISHEYE), fisheye),
    ],
)
def test_each_pixel_looks_where_the_formula_says(lens, project):
    directions, shows = lens.directions
    assert shows.mean() > 0.7
    np.testing.assert_allclose(np.linalg.norm(directions[shows], axis=1), 1.0, atol=1e-12)
    y, x = np.nonzero(shows)
    np.testing.assert_allclose(project(directions[shows], lens), np.column_stack([x, y]) + 0.5, atol=1e-6)


@pytest.mark.parametrize(
    ("lens", "project"),
    [
        (DistortedLens(320, 240, 200.0, 200.0, 160.0, 120.0, 0.1, FAR, "plumb_bob", BARREL), plumb_bob),
        (DistortedLens.of_fisheye_angle(320, 240, math.radians(220), (0.0,) * 4, 0.1, FAR), fisheye),
    ],
)
def test_things_are_where_the_formula_puts_them(lens, project):
    places = np.array([(4, 0, 0), (4, 1.5, 1), (4, -2, -1.2), (3, -2, 1.5), (1, 4, 0.5), (-1, -4, 0.3), (0.2, 2, -3)])
    studio = Studio(*(ball(f"Ball{i}", place, 0.15) for i, place in enumerate(places)))
    picture = studio.look(Tripod((0, 0, 0), (1, 0, 0)), lens)
    # X forward, Y left, Z up in the world
    own = np.column_stack([-places[:, 1], -places[:, 2], places[:, 0]])
    expected = project(own, lens)
    found = 0
    for number, pixel in enumerate(expected):
        rows, columns = np.nonzero(picture.ids == studio.number(picture, f"Ball{number}"))
        inside = 8 < pixel[0] < 312 and 8 < pixel[1] < 232 and (lens.model == "equidistant" or own[number, 2] > 2)
        if inside:
            assert [columns.mean() + 0.5, rows.mean() + 0.5] == pytest.approx(pixel.tolist(), abs=0.6)
            found += 1
    assert found >= 4


def test_the_depth_of_a_wall_is_the_same_everywhere():
    studio = Studio(box("Wall", (5.5, 0, 0), (0.5, 30, 30)))
    lens = DistortedLens(160, 120, 100.0, 100.0, 80.0, 60.0, 0.1, FAR, "plumb_bob", BARREL)
    picture = studio.look(Tripod((0, 0, 0), (1, 0, 0)), lens, color=False)
    assert picture.rgb is None
    _, shows = lens.directions
    np.testing.assert_allclose(picture.depth[shows], 5.0, rtol=1e-4)
    # and its points make a plane
    points = lens.rays() * picture.depth[..., None]
    np.testing.assert_allclose(points[shows][:, 2], 5.0, rtol=1e-4)


def test_a_fisheye_sees_the_floor_all_around():
    studio = Studio(floor())
    lens = DistortedLens.of_fisheye_angle(200, 200, math.pi, (0.0,) * 4, 0.1, FAR)
    picture = studio.look(Tripod((0, 0, 1.5), (0, 0, 0), up=(1, 0, 0)), lens)
    directions, _ = lens.directions
    # down to 80 degrees from the axis: the floor ends at 30 m
    inside = directions[..., 2] > math.cos(math.radians(80))
    assert (picture.ids[inside] == 0).all()
    np.testing.assert_allclose(picture.depth[inside], 1.5, rtol=2e-3)


def test_more_than_half_of_the_world_has_no_depth_behind_the_camera():
    studio = Studio(box("Behind", (-5, 0, 0), (1, 8, 8)), box("Before", (5, 0, 0), (1, 8, 8)))
    lens = DistortedLens.of_fisheye_angle(200, 200, math.radians(350), (0.0,) * 4, 0.1, FAR)
    picture = studio.look(Tripod((0, 0, 0), (1, 0, 0)), lens)
    behind = picture.ids == studio.number(picture, "Behind")
    assert behind.sum() > 100
    assert (picture.depth[behind] == 0).all()
    assert (picture.depth[picture.ids == studio.number(picture, "Before")] > 3).all()


def test_colours_do_not_depend_on_the_way_they_are_made():
    """A lens without distortion, rendered directly and by way of undistorted images."""
    studio = Studio(floor(), box("Box", (4, 0, 0.5), (0.5, 0.5, 0.5)))
    tripod = Tripod((0, 0, 1), (4, 0, 0.5))
    flat = studio.look(tripod, Lens(160, 120, 120.0, 120.0, 80.0, 60.0, 0.1, FAR))
    bent = studio.look(tripod, DistortedLens(160, 120, 120.0, 120.0, 80.0, 60.0, 0.1, FAR))
    assert (flat.ids == bent.ids).mean() > 0.99
    inner = np.abs(flat.rgb.astype(int) - bent.rgb).max(axis=2)
    # at edges they may differ
    assert np.percentile(inner, 95) <= 3
    same = flat.ids == bent.ids
    # except for the row along the horizon
    assert (np.abs(bent.depth[same] - flat.depth[same]) <= 0.002 * flat.depth[same]).mean() > 0.985


def test_what_folds_back_is_black():
    lens = DistortedLens(100, 100, 30.0, 30.0, 50.0, 50.0, 0.1, FAR, "plumb_bob", (-0.3, 0.0, 0.0, 0.0, 0.0))
    _, shows = lens.directions
    assert shows[50, 50]
    assert not shows[0, 0]
    picture = Studio(floor()).look(Tripod((0, 0, 1), (4, 0, 1)), lens)
    assert not picture.rgb[~shows].any()
    assert (picture.ids[~shows] == -1).all()


@pytest.mark.parametrize(
    ("text", "model", "expected"),
    [
        ("", "plumb_bob", (0.0,) * 5),
        ("[-0.3, 0.1]", "plumb_bob", (-0.3, 0.1, 0.0, 0.0, 0.0)),
        ("-0.3 0.1 1e-3", "equidistant", (-0.3, 0.1, 1e-3, 0.0)),
    ],
)
def test_coefficients_are_read(text, model, expected):
    assert coefficients(text, model) == expected


@pytest.mark.parametrize("text", ["a", "1,2,3,4,5,6", "nan", "inf", "1e9", "{}"])
def test_what_are_no_coefficients_is_told(text):
    with pytest.raises(ValueError, match="k1, k2, p1, p2, k3"):
        coefficients(text, "plumb_bob")


@pytest.mark.parametrize(
    ("degrees", "model", "text"),
    [(180.0, "plumb_bob", ""), (361.0, "equidistant", ""), (90.0, "square", ""), (200.0, "equidistant", "-9")],
)
def test_lenses_that_do_not_exist_are_refused(degrees, model, text):
    with pytest.raises(ValueError, match=r"between 0 and|is one of"):
        lens_of(64, 64, 35.0, degrees, 0.1, 10.0, model, text)


def test_large_images_with_distortion_are_refused_before_they_fill_the_memory():
    with pytest.raises(ValueError, match="at most 4194304 pixels, got 4096 x 4096"):
        lens_of(4096, 4096, 35.0, None, 0.1, 10.0, "plumb_bob", "-0.1")
    assert lens_of(4096, 4096, 35.0, None, 0.1, 10.0).width == 4096


@pytest.mark.parametrize("numbers", [(-1e6, 1e6, 1e6, -1e6, 1e6), (1e6,) * 5, (0.0, 0.0, 9.0, 9.0, 0.0)])
def test_coefficients_that_mean_nothing_harm_nothing(numbers):
    lens = DistortedLens(64, 48, 40.0, 40.0, 32.0, 24.0, 0.1, FAR, "plumb_bob", numbers)
    picture = Studio(floor()).look(Tripod((0, 0, 1), (4, 0, 1)), lens)
    assert picture.rgb.shape == (48, 64, 3)
    assert np.isfinite(picture.depth).all()


@pytest.mark.parametrize(
    ("lens", "flags"),
    [
        (
            DistortedLens(
                640, 480, 520.0, 500.0, 330.0, 228.0, 0.05, 50.0, "plumb_bob", (-0.25, 0.06, 0.001, -0.001, 0)
            ),
            0,
        ),
        (DistortedLens(640, 480, 300.0, 300.0, 320.0, 240.0, 0.05, 50.0, "equidistant", (-0.02, 0.003, 0, 0)), 1),
    ],
)
def test_opencv_undistorts_to_the_same_directions(lens, flags):
    cv2 = pytest.importorskip("cv2")
    x, y = np.meshgrid(np.linspace(40, 600, 8).round(), np.linspace(30, 450, 7).round())
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)[:, None]
    matrix, numbers = np.array(lens.matrix), np.array(lens.coefficients)
    if flags:
        found = cv2.fisheye.undistortPoints(pixels, matrix, numbers)
    else:
        criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-10)
        found = cv2.undistortPoints(pixels, matrix, numbers, criteria=criteria)
    rays = lens.rays()[y.ravel().astype(int), x.ravel().astype(int)]
    np.testing.assert_allclose(rays[:, :2], found[:, 0], atol=1e-5)


# -- motion blur and rolling shutter, compared with the displacements that follow from velocities --

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
