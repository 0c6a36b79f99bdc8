"""Lenses, exposure and noise of cameras on robots."""

import base64
import io
import json

import numpy as np
import pytest
from PIL import Image

from morse.core.exceptions import MorseRPCTypeError
from morse.rendering.textures import LIGHT
from morse.sensors.camera import CAMERA_INFO
from morse.wire.images import image_fields

pytestmark = pytest.mark.long

SCENE = """
robot = FakeRobot("robot")
eye = {kind}("eye")
eye.properties(cam_width=96, cam_height=72{more})
robot.append(eye)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (6.1, 0, 0); wall.color(0.2, 0.2, 0.2)
env = Environment("empty")
"""


@pytest.fixture
def look(simulate):
    def make(more="", kind="VideoCamera", **options):
        simulation = simulate(SCENE.format(kind=kind, more=more and f", {more}"), **options, sockets=False)
        simulation.sleep(0.1)
        return simulation.context.component("robot.eye"), simulation

    return make


def light(eye):
    return LIGHT[eye.local_data["image"][..., :3]].mean()


def test_a_stop_less_halves_the_light(look):
    plain, dark, bright = (light(look(more)[0]) for more in ("", "exposure=-1.0", "exposure=1.0"))
    assert dark < plain < bright
    # tone mapping is nearly linear in the dark: the ACES curve deviates by a third at most
    darker = light(look("exposure=-2.0")[0])
    assert 0.25 < darker / dark < 0.6


def test_the_exposure_may_change_while_it_runs(look):
    eye, simulation = look()
    before = light(eye)
    eye.set_property("exposure", -4.0)
    simulation.sleep(0.2)
    assert light(eye) < 0.3 * before


def test_noise_follows_from_the_seed(look):
    options = "full_well=500.0, read_noise=0.01, stuck_pixels=0.01"
    one, same, other = (look(options, seed=seed)[0].local_data["image"] for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert (one != other).any()
    assert one.std() > look()[0].local_data["image"].std()


def test_a_camera_says_how_its_lens_bends(look):
    eye, _ = look("distortion='-0.3, 0.1, 0.001', cam_focal=20.0")
    assert eye.lens.coefficients == (-0.3, 0.1, 0.001, 0.0, 0.0)
    assert CAMERA_INFO["d"](eye) == [-0.3, 0.1, 0.001, 0.0, 0.0]
    assert CAMERA_INFO["model"](eye) == "plumb_bob"
    assert CAMERA_INFO["d"](look()[0]) == [0.0] * 5


@pytest.mark.parametrize("kind", ["DepthVideoCamera", "SegmentationCamera", "SemanticCamera", "DepthCamera"])
def test_every_camera_may_have_a_fisheye_lens(look, kind):
    eye, _ = look("lens_model='equidistant', cam_fov=200.0, cam_near=0.2, cam_far=30.0", kind)
    if kind == "DepthVideoCamera":
        assert eye.local_data["image"][36, 48] == pytest.approx(6.0, rel=1e-3)
    elif kind == "SegmentationCamera":
        (wall,) = [row["id"] for row in eye.local_data["labels"] if row["name"] == "Wall"]
        assert eye.local_data["image"][36, 48] == wall
    elif kind == "DepthCamera":
        points = np.asarray(eye.local_data["points"])
        # the wall to the left and right of the axis, above the ground
        wall = points[(np.abs(points[:, 0]) < 5) & (points[:, 1] < -0.5) & (points[:, 1] > -5)]
        assert len(wall) > 20
        assert wall[:, 2] == pytest.approx(np.full(len(wall), 6.0), rel=1e-2)


def test_half_of_the_world_takes_a_fisheye_lens(look):
    eye, simulation = look()
    with pytest.raises(MorseRPCTypeError, match="180"):
        eye.set_property("cam_fov", 200.0)
    with pytest.raises(MorseRPCTypeError, match="k1, k2"):
        eye.set_property("distortion", "much")
    with pytest.raises(MorseRPCTypeError):
        eye.set_property("lens_model", "square")
    simulation.sleep(0.1)
    eye.set_property("lens_model", "equidistant")
    eye.set_property("cam_fov", 200.0)
    simulation.sleep(0.2)
    assert eye.local_data["image"].shape == (72, 96, 4)


def received(eye):
    message = json.loads(image_fields(eye, eye.local_data).line())
    return message, base64.b64decode(message["image"])


def test_without_compression_messages_are_those_of_morse_14(look):
    eye, _ = look()
    message, pixels = received(eye)
    assert list(message) == ["timestamp", "height", "width", "image", "intrinsic_matrix"]
    assert pixels == eye.local_data["image"].tobytes()


@pytest.mark.parametrize("form", ["jpeg", "png"])
def test_compressed_pictures_are_files(look, form):
    eye, _ = look(f"compression='{form}', full_well=500.0")
    message, file = received(eye)
    assert message["format"] == form
    with Image.open(io.BytesIO(file)) as picture:
        assert picture.format == form.upper()
        pixels = np.asarray(picture)
    original = eye.local_data["image"][..., :3]
    if form == "png":
        np.testing.assert_array_equal(pixels, original)
    else:
        assert np.abs(pixels.astype(int) - original).mean() < 12
        assert len(file) < original.size / 3


def test_ids_compressed_lose_nothing(look):
    eye, _ = look("compression='png'", "SegmentationCamera")
    message, file = received(eye)
    assert message["format"] == "png"
    with Image.open(io.BytesIO(file)) as picture:
        np.testing.assert_array_equal(np.asarray(picture), eye.local_data["image"])


def test_a_camera_that_took_no_picture_yet_compresses_nothing(look):
    eye, _ = look("compression='jpeg', capturing=False")
    eye.capturing = True
    message, file = received(eye)
    assert file == b""
    assert message["image"] == ""


@pytest.mark.parametrize("stops", [-5.0, 0.0, 4.0])
def test_the_automatic_exposure_makes_pictures_neither_dark_nor_bright(look, stops):
    eye, simulation = look(f"auto_exposure=True, exposure={stops}")
    simulation.sleep(2.0)
    assert eye.local_data["image"][..., :3].mean() == pytest.approx(118, abs=8)


def test_the_automatic_exposure_is_a_part_of_the_state(look):
    eye, simulation = look("auto_exposure=True, exposure=-5.0")
    state = simulation.save()
    simulation.sleep(0.5)
    first = eye.local_data["image"].copy()
    simulation.restore(state)
    simulation.sleep(0.5)
    np.testing.assert_array_equal(simulation.context.component("robot.eye").local_data["image"], first)


def test_the_noise_of_depth_grows_with_its_square(look):
    eye, _ = look("depth_noise=0.002, cam_near=0.5, cam_far=50.0, Vertical_Flip=True", "DepthVideoCamera")
    # the wall, 6 m ahead, above the ground
    depth = eye.local_data["image"][:30]
    assert depth.mean() == pytest.approx(6.0, abs=0.01)
    assert depth.std() == pytest.approx(0.002 * 36, rel=0.1)


@pytest.mark.parametrize("kind", ["DepthVideoCamera", "RawImage"])
def test_noise_leads_beyond_no_plane(look, kind):
    eye, _ = look("depth_noise=100.0, cam_near=0.5, cam_far=50.0", kind)
    depth = eye.local_data["image"]
    assert np.isfinite(depth[depth < 1e3]).all()
    if kind == "RawImage":
        assert depth.min() >= 0.0
        assert depth.max() <= 1.0
    else:
        assert depth.min() >= 0.5
        assert depth[np.isfinite(depth)].max() <= 50.0
