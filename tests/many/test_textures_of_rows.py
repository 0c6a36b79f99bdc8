"""Textures that are changed while a simulation runs."""

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from PIL import Image

import morse
import morse.gym
from morse.many import choice

COLORS = {"red": (255, 0, 0), "green": (0, 255, 0), "blue": (0, 0, 255)}


def scene():
    from morse.builder import ATRV, Cube, Environment, MotionVW, VideoCamera

    robot = ATRV("robot")
    camera = VideoCamera("camera")
    camera.properties(cam_width=40, cam_height=40)
    camera.translate(0.6, 0.0, 0.5)
    robot.append(camera)
    robot.append(MotionVW("motion"))
    wall = Cube("Wall")
    wall.scale, wall.location = (0.1, 3.0, 3.0), (2.0, 0.0, 1.0)
    wall._bpy_object.game.physics_type = "STATIC"
    Environment("empty")


@pytest.fixture
def pictures(tmp_path, monkeypatch):
    """Files of one colour each, and one whose upper half is red and whose lower half is green."""
    for name, color in COLORS.items():
        Image.new("RGB", (8, 8), color).save(tmp_path / f"{name}.png")
    halves = np.zeros((8, 8, 3), np.uint8)
    halves[:4, :, 0] = halves[4:, :, 1] = 255
    Image.fromarray(halves).save(tmp_path / "halves.png")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def strongest(image, rows=slice(None)):
    """The channel that is strongest in the middle of an image."""
    return int(image[rows, 10:30, :3].reshape(-1, 3).astype(float).mean(axis=0).argmax())


def image_of(sim):
    sim.measure()
    return sim.robot.camera.data["image"]


def test_a_texture_is_seen_and_covers_each_side_once(pictures):
    with morse.load(scene) as sim:
        plain = image_of(sim)
        sim.set_texture("Wall", "halves.png")
        image = image_of(sim)
        assert strongest(image, slice(0, 8)) == 0
        assert strongest(image, slice(32, 40)) == 1
        sim.set_texture("Wall", pictures / "blue.png")
        assert strongest(image_of(sim)) == 2
        sim.restart()
        assert np.array_equal(image_of(sim), plain)


def test_a_file_that_has_changed_is_read_again(pictures):
    with morse.load(scene) as sim:
        sim.set_texture("Wall", "red.png")
        assert strongest(image_of(sim)) == 0
        Image.new("RGB", (16, 16), COLORS["green"]).save(pictures / "red.png")
        sim.set_texture("Wall", "red.png")
        assert strongest(image_of(sim)) == 1


def test_states_contain_it_also_for_other_simulations_and_files(pictures, tmp_path):
    with morse.load(scene) as sim, morse.load(scene) as other:
        fresh = sim.state_hash()
        sim.set_texture("Wall", "green.png")
        image = image_of(sim)
        state = sim.save(tmp_path / "green.state")
        assert state.hash() != fresh
        (pictures / "green.png").unlink()
        for source in (state, tmp_path / "green.state"):
            other.restart()
            other.restore(source)
            assert other.state_hash() == state.hash()
            assert np.array_equal(image_of(other), image)


def test_it_is_an_input_that_a_replay_contains(pictures):
    with morse.load(scene) as sim:
        recording = sim.record_inputs()
        sim.step(3)
        sim.robot.set_texture("blue.png")
        sim.step(3)
        end, stopped = sim.state_hash(), recording.stop()
    with morse.load(scene) as sim:
        sim.replay(stopped)
        assert sim.state_hash() == end


def test_one_texture_for_each_row(pictures):
    with morse.batch(scene, 3) as many:
        image = many.read("robot.camera", "image")
        many.vary("Wall", texture=["red.png", "green.png", "blue.png"])
        many.measure()
        assert [strongest(one) for one in image] == [0, 1, 2]
        many.vary("Wall", rows=[0], texture="blue.png")
        with pytest.raises(ValueError, match=r"no picture 'grey\.png'"):
            many.vary("Wall", texture=["red.png", "red.png", "grey.png"])
        with pytest.raises(ValueError, match="one for each of 3 rows"):
            many.vary("Wall", texture=["red.png"])
        many.measure()
        assert [strongest(one) for one in image] == [2, 1, 2]


@pytest.mark.parametrize(
    ("name", "picture", "message"),
    [
        ("Wall", "gray.png", "there is no picture 'gray.png' in "),
        ("Wal", "red.png", "no object 'Wal'; did you mean 'Wall'"),
        ("Sun", "red.png", "'Sun' has no surface: it has no texture to set"),
        ("Wall", "notes.txt", "notes.txt cannot be"),
        ("Wall", "/etc/hostname", "MORSE_RESOURCE_PATH"),
        ("Wall", "../red.png", "MORSE_RESOURCE_PATH"),
    ],
)
def test_mistakes_are_named(pictures, name, picture, message):
    (pictures / "notes.txt").write_text("no picture")
    with morse.load(scene) as sim, pytest.raises((ValueError, KeyError), match=message):
        sim.set_texture(name, picture)


class Paint(morse.gym.Task):
    """Each episode draws a texture."""

    scene, ticks, limit = scene, 1, 2
    action = morse.gym.Command("robot.motion", v=(-1.0, 1.0))
    observation = morse.gym.Read("robot.camera", "image")
    vary = {"Wall": {"texture": choice("red.png", "green.png", "blue.png")}}  # noqa: RUF012

    def reward(self, before, now):
        return 0.0, False, {}


def test_a_task_draws_textures_which_are_in_the_infos(pictures):
    env = morse.gym.vector(Paint, 8)
    images, infos = env.reset(seed=2)
    assert len({*infos["Wall.texture"]}) > 1
    order = list(COLORS)
    assert [order[strongest(image)] for image in images] == [
        name.removesuffix(".png") for name in infos["Wall.texture"]
    ]
    env.close()


def test_the_page_describes_the_new_texture(pictures):
    from morse.viewer.describe import describe
    from morse.viewer.site import AssetStore

    with morse.load(scene) as sim:
        sim.set_texture("Wall", "red.png")
        described = describe(sim.scene, [], 1, AssetStore())
        wall = next(node for node in described.nodes if node.name == "Wall")
        assert described.materials[wall.materials[0]].image is not None
