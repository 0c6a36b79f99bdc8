"""Moved, hidden, added and removed objects are rendered correctly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from studio import Studio, Tripod, box, floor

import morse
from morse.rendering import Lens, Renderer
from morse.scene import PhysicsType
from tests.kit.effort import examples

LENS = Lens.of_focal_length(64, 64, 32.0, 0.1, 50)
AHEAD = Tripod((0, 0, 1), (1, 0, 1))


@pytest.fixture
def made():
    return Studio(floor(), box("Box", (4, 0, 1), (0.5, 0.5, 0.5)))


def middle(made):
    picture = made.look(AHEAD, LENS)
    number = int(picture.ids[32, 32])
    return None if number < 0 else picture.nodes[number].name, float(picture.depth[32, 32])


def test_what_is_put_elsewhere(made):
    assert middle(made) == ("Box", pytest.approx(3.5, rel=1e-5))
    box = made.world.game_object("Box")
    box.set_pose((6.0, 0.0, 1.0), box.world_pose()[1])
    assert middle(made) == ("Box", pytest.approx(5.5, rel=1e-5))
    made.world.reset()
    assert middle(made) == ("Box", pytest.approx(3.5, rel=1e-5))


def test_what_falls(made):
    made = Studio(floor(), box("Box", (4, 0, 6), (0.5, 0.5, 0.5), kind=PhysicsType.RIGID_BODY))
    assert middle(made) == (None, 0.0) or middle(made)[0] == "Floor"
    for _ in range(240):
        made.world.step()
    made_box = made.world.game_object("Box").world_pose()[0]
    assert made_box[2] == pytest.approx(0.5, abs=0.02)
    low = made.look(Tripod((0, 0, 0.5), (1, 0, 0.5)), LENS)
    assert low.nodes[low.ids[32, 32]].name == "Box"


def test_what_is_hidden_and_shown(made):
    made.world.game_object("Box").setVisible(False)
    assert middle(made)[0] != "Box"
    made.world.game_object("Box").setVisible(True)
    assert middle(made)[0] == "Box"


def test_what_is_hidden_from_the_start():
    hidden, switched = box("A", (4, 0, 1), (0.5, 0.5, 0.5)), box("B", (6, 0, 1), (0.5, 0.5, 0.5))
    hidden.visible = False
    switched.properties["visible"] = False
    assert middle(Studio(floor(), hidden, switched))[0] not in ("A", "B")


def test_what_comes_and_goes(made):
    from morse.assets.collision import resolve_shapes
    from morse.scene import Scene

    assert middle(made)[0] == "Box"
    new = box("New", (2, 0, 1), (0.2, 0.2, 0.2))
    resolve_shapes(Scene(roots=[new]))
    added = made.world.add([new])
    assert middle(made) == ("New", pytest.approx(1.8, rel=1e-5))
    made.world.remove(added)
    assert middle(made)[0] == "Box"
    made.world.remove([made.world.game_object("Box")])
    assert middle(made)[0] != "Box"


def test_a_part_that_turns_on_its_parent():
    mast, arm = box("Mast", (4, 0, 1), (0.1, 0.1, 1)), box("Arm", (0, 3, 0), (1, 0.5, 0.2))
    mast.attach(arm)
    made = Studio(floor(), mast)
    assert middle(made)[0] == "Mast"
    made.world.game_object("Arm").set_pose((2.0, 0.0, 1.0), (1, 0, 0, 0, 1, 0, 0, 0, 1))
    name, depth = middle(made)
    assert name == "Arm"
    assert depth == pytest.approx(2.0 - 0.1, rel=1e-4)


def test_the_same_picture_whenever_it_is_drawn(made):
    """A renderer that is created later, when objects have moved, renders the same image as the first one."""
    box = made.world.game_object("Box")
    made.look(AHEAD, LENS)
    box.set_pose((5.0, 0.4, 1.2), box.world_pose()[1])
    one = made.look(AHEAD, LENS)
    made.renderer = Renderer(made.world)
    other = made.look(AHEAD, LENS)
    np.testing.assert_array_equal(one.rgb, other.rgb)
    np.testing.assert_array_equal(one.depth, other.depth)


def test_all_cameras_of_a_tick_in_one_call(made):
    wide = Lens.of_angle(48, 20, 1.5)
    wanted = [True, False, True]
    requests = [
        made.renderer.request(AHEAD, LENS),
        made.renderer.request(AHEAD, LENS, wanted=lambda: wanted[1]),
        made.renderer.request(AHEAD, wide, color=False),
    ]
    made.renderer.serve(requests)
    assert requests[0].picture.rgb.shape == (64, 64, 3)
    assert requests[1].picture is None
    assert requests[2].picture.rgb is None
    assert requests[2].picture.depth.shape == (20, 48)
    np.testing.assert_array_equal(requests[0].picture.rgb, made.look(AHEAD, LENS).rgb)


def painted():
    from morse.builder import ATRV, Cube, Environment, MotionVW, VideoCamera

    robot = ATRV("robot")
    camera = VideoCamera("camera")
    camera.properties(cam_width=60, cam_height=60)
    camera.translate(0.6, 0.0, 1.0)
    camera.rotate(y=0.4)
    robot.append(camera)
    robot.append(MotionVW("motion"))
    for number in range(4):
        cube = Cube(f"Cube{number}")
        cube.scale, cube.location = (0.3, 0.3, 0.3), (3.0 + number, number - 1.5, 0.3 + number)
        cube._bpy_object.game.physics_type = "RIGID_BODY" if number % 2 else "STATIC"
    Environment("empty")


@given(
    changes=st.lists(
        st.tuples(st.integers(0, 3), st.lists(st.floats(0.0, 1.0), min_size=3, max_size=4), st.integers(0, 8)),
        min_size=1,
        max_size=5,
    )
)
@settings(max_examples=examples(12))
def test_images_after_changes_of_colour_are_those_of_another_simulation(changes):
    """Shadow maps are taken over, unless something becomes transparent."""
    with morse.load(painted) as sim:
        sim.robot.motion.publish({"v": 0.5, "w": 0.3})
        for number, color, ticks in changes:
            sim.measure()
            sim.set_color(f"Cube{number}", color)
            sim.step(ticks)
        sim.measure()
        image = sim.robot.camera.data["image"]
        with morse.load(painted) as other:
            other.restore(sim.save())
            other.measure()
            assert np.array_equal(other.robot.camera.data["image"], image)
