"""`morse render`: pictures and films of scenes."""

import shutil

import numpy as np
import pytest
from PIL import Image

SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
eye = VideoCamera("eye")
eye.properties(cam_width=80, cam_height=60)
robot.append(eye)
box = Cube("Box"); box.scale = (1, 1, 1); box.location = (6, 0, 1); box.color(1, 0, 0)
env = Environment("empty")
env.set_camera_location([6, 0, 20])
env.set_camera_rotation([0, 0, 0])
"""
SMALL = ("--size", "64x48", "--time", "0")


@pytest.fixture
def scene(morse):
    (morse.directory / "scene.py").write_text(SCENE)
    return "scene.py"


def pixels(morse, name="picture.png"):
    with Image.open(morse.directory / name) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


def reds(image):
    return (image[..., 0] > 100) & (image[..., 1] < 90) & (image[..., 2] < 90)


def test_a_picture_from_somewhere(morse, scene):
    answer = morse("render", scene, "--from", "0,0,1", "--to", "6,0,1", "--fov", "90", *SMALL)
    assert answer.status == 0, answer.err
    assert "picture.png" in answer.out
    image = pixels(morse)
    assert image.shape == (48, 64, 3)
    # the front of the box is 5 m ahead and 2 m wide; f = 32 px
    rows, columns = np.nonzero(reds(image))
    assert [columns.min(), columns.max() + 1] == pytest.approx([32 - 6.4, 32 + 6.4], abs=1)
    assert [rows.min(), rows.max() + 1] == pytest.approx([24 - 6.4, 24 + 6.4], abs=1)


def test_the_viewpoint_of_the_script_is_the_usual_one(morse, scene):
    assert morse("render", scene, "-o", "above.jpg", *SMALL).status == 0
    rows, columns = np.nonzero(reds(pixels(morse, "above.jpg")))
    # straight down from above the box
    assert columns.mean() == pytest.approx(31.5, abs=1.5)
    assert rows.mean() == pytest.approx(23.5, abs=1.5)


def test_fine_pictures_have_the_same_size(morse, scene):
    words = ("--from", "0,0,1", "--to", "6,0,1", *SMALL)
    morse("render", scene, *words)
    usual = pixels(morse)
    assert morse("render", scene, "--fine", *words).status == 0
    fine = pixels(morse)
    assert fine.shape == usual.shape
    assert np.abs(fine - usual).mean() < 3


def test_what_a_camera_sees(morse, scene):
    assert morse("render", scene, "--camera", "robot.eye", "--time", "0").status == 0
    assert pixels(morse).shape == (60, 80, 3)
    assert reds(pixels(morse)).any()


@pytest.mark.parametrize(("kind", "shown"), [("DepthCamera", "depth"), ("SegmentationCamera", "ids")])
def test_a_camera_shows_what_it_measures(morse, scene, kind, shown):
    (morse.directory / scene).write_text(SCENE.replace("VideoCamera", kind))
    words = (scene, "--camera", "robot.eye", "--time", "0", "-o")
    for name, more in (("usual.png", ()), ("same.png", ("--show", shown)), ("colour.png", ("--show", "color"))):
        assert morse("render", *words, name, *more).status == 0
    np.testing.assert_array_equal(pixels(morse, "usual.png"), pixels(morse, "same.png"))
    assert (pixels(morse, "usual.png") != pixels(morse, "colour.png")).any()


def test_depth_is_bright_where_it_is_near_and_ids_have_colours(morse, scene):
    words = ("--from", "0,0,1", "--to", "6,0,1", *SMALL)
    assert morse("render", scene, "--show", "depth", "-o", "depth.png", *words).status == 0
    depth = pixels(morse, "depth.png")
    assert depth[24, 32].tolist() == depth[24, 33].tolist()
    assert depth[47, 32, 0] > depth[24, 32, 0] > depth[0, 0, 0] == 0
    assert morse("render", scene, "--show", "ids", "-o", "ids.png", *words).status == 0
    ids = pixels(morse, "ids.png")
    assert ids[24, 32].any()
    assert not ids[0, 0].any()
    assert ids[24, 32].tolist() != ids[47, 32].tolist()


def test_the_same_file_again(morse, scene):
    for name in ("one.png", "two.png"):
        morse("render", scene, "-o", name, *SMALL)
    assert (morse.directory / "one.png").read_bytes() == (morse.directory / "two.png").read_bytes()


@pytest.mark.parametrize("name", ["film.gif", "film.webp"])
def test_a_film_in_one_file(morse, scene, name):
    # a moving object has different positions: identical frames are merged in such files
    (morse.directory / scene).write_text(SCENE + "box.properties(Object=True)\nrobot.translate(z=3)\n")
    falling = SCENE.replace("box.color(1, 0, 0)", "box.color(1, 0, 0); box.location = (6, 0, 4); box.mass = 1") + (
        "box._bpy_object.game.physics_type = 'RIGID_BODY'\n"
    )
    (morse.directory / scene).write_text(falling)
    answer = morse(
        "render", scene, "-o", name, "--film", "0.4", "--rate", "10", "--from", "0,0,2", "--to", "6,0,2", *SMALL
    )
    assert answer.status == 0, answer.err
    with Image.open(morse.directory / name) as film:
        assert film.n_frames == 4
        film.seek(0)
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(3)
        last = np.asarray(film.convert("RGB")).astype(int)
    # 0.3 s of free fall are 0.44 m
    assert np.nonzero(reds(last))[0].mean() > np.nonzero(reds(first))[0].mean() + 1


def test_a_film_as_frames(morse, scene):
    assert morse("render", scene, "-o", "f_%03d.png", "--film", "0.2", "--rate", "10", *SMALL).status == 0
    assert sorted(path.name for path in morse.directory.glob("f_*")) == ["f_000.png", "f_001.png"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--from", "1,2"), "--from is three numbers in metres"),
        (("--to", "a,b,c"), "--to is three numbers"),
        (("--from", "nan,0,0"), "--from is three numbers"),
        (("--from", "1,2,3", "--to", "1,2,3"), "both"),
        (("--size", "0x10"), "--size is width x height"),
        (("--size", "100000x10"), "--size is width x height"),
        (("--fov", "180"), "between 0 and 180 degrees"),
        (("--fov", "nan"), "between 0 and 180 degrees"),
        (("--show", "dpth"), "Did you mean 'depth'?"),
        (("--film", "0"), "--film is a number"),
        (("--film", "nan"), "--film is a number"),
        (("--film", "1", "--rate", "0"), "--rate is a number"),
        (("--time", "1e9"), "--time is 0 to"),
        (("-o", "picture.doc"), "ends in .png"),
        (("-o", "none/picture.png"), "there is no folder"),
        (("--film", "1", "-o", "picture.png"), "a film is a file that ends in .gif"),
        (("--film", "1", "-o", "f_%d_%d.png"), "one number"),
        (("--camera", "robot.eye", "--fov", "30"), "cannot be combined with"),
    ],
)
def test_mistakes_on_the_command_line(morse, scene, words, said):
    answer = morse("render", scene, *words)
    assert answer.status == 2
    assert said in " ".join(answer.err.split())
    assert "Traceback" not in answer.err
    assert not list(morse.directory.glob("*.png"))


def test_a_camera_that_is_not_there(morse, scene):
    answer = morse("render", scene, "--camera", "robot.eyes", "--time", "0")
    assert answer.status == 1
    assert "Did you mean 'robot.eye'?" in answer.err


def test_a_broken_scene_is_told_as_morse_run_does(morse):
    (morse.directory / "scene.py").write_text("from morse.builder import *\nrobot = ATVR()\n")
    answer = morse("render", "scene.py", "--time", "0")
    assert answer.status == 1
    assert "Traceback" not in answer.err
    assert "ATRV" in answer.err


def test_without_ffmpeg_it_is_said_what_there_is(morse, scene, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    answer = morse("render", scene, "--film", "1", "-o", "film.mp4")
    assert answer.status == 2
    assert "apt install ffmpeg" in answer.err
    assert "frame_%04d.png" in answer.err


MODEL = """<mujoco><visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual><worldbody>
<camera name="front" pos="0 -4 3" xyaxes="1 0 0 0 0 1"/><body pos="0 0 3"><freejoint/>
<geom type="sphere" size=".4" rgba="1 0 0 1"/></body></worldbody></mujoco>"""


def test_a_model_file_is_shown_by_its_own_camera(morse):
    (morse.directory / "ball.xml").write_text(MODEL)
    answer = morse("render", "ball.xml", "--camera", "front", *SMALL)
    assert answer.status == 0, answer.err
    image = pixels(morse)
    assert image.shape == (48, 64, 3)
    rows, columns = np.nonzero(reds(image))
    assert [rows.mean(), columns.mean()] == pytest.approx([23.5, 31.5], abs=0.6)
    for kind in ("depth", "ids"):
        assert morse("render", "ball.xml", "--camera", "front", "--show", kind, *SMALL).status == 0
        image = pixels(morse)
        assert not np.array_equal(image[24, 32], image[0, 0])
    answer = morse("render", "ball.xml", "--camera", "front", "-o", "b_%d.png", "--film", "0.4", "--rate", "10", *SMALL)
    assert answer.status == 0, answer.err
    # 0.3 s of free fall are 0.44 m; f = 58 px, at 4 m
    heights = [np.nonzero(reds(pixels(morse, f"b_{n}.png")))[0].mean() for n in (0, 3)]
    assert heights[1] - heights[0] == pytest.approx(0.44 * 58 / 4, abs=1)


@pytest.mark.parametrize(
    ("text", "words", "said"),
    [
        (MODEL, ("--camera", "frnt"), "Did you mean 'front'? There are: front."),
        (MODEL, ("--from", "1,2,3"), "--from is an option of scenes"),
        (MODEL, ("--fine",), "--fine is an option of scenes"),
        ("<mujoco><worldbody>", (), "ball.xml cannot be read by MuJoCo"),
        ("<robot name='r'/>", ("--camera", "c"), "There is no camera 'c'"),
    ],
)
def test_mistakes_with_model_files(morse, text, words, said):
    (morse.directory / "ball.xml").write_text(text)
    answer = morse("render", "ball.xml", *words, *SMALL)
    assert answer.status != 0
    assert said in answer.err
    assert "Traceback" not in answer.err
