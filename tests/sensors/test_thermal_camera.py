"""Temperatures of surfaces in the images of a thermal camera."""

import numpy as np
import pytest

from morse.simulation.loader import LoadError

SCENE = """
robot = FakeRobot("robot")
robot.translate(z=1.0)
eye = ThermalCamera("eye")
eye.properties(cam_width=60, cam_height=20, cam_focal=16.0)
{eye}
robot.append(eye)
{objects}
env = Environment("empty")
{env}
"""


def cube(name, y, more):
    return f"{name} = Cube('{name}'); {name}.location = (4, {y}, 1); {name}.scale = (0.3, 0.3, 0.3); {more}\n"


THREE = (
    cube("Warm", 2.0, "Warm.properties(Temperature=36.5)")
    + cube("Burning", 0.0, "Burning.properties(Fire=True)")
    + cube("Plain", -2.0, "")
)


@pytest.fixture
def image(simulate):
    def make(objects=THREE, eye="", env="", seconds=0.1):
        simulation = simulate(SCENE.format(objects=objects, eye=eye, env=env), sockets=False)
        simulation.sleep(seconds)
        assert not simulation.context.failed
        return simulation.context.component("robot.eye").local_data["image"], simulation

    return make


#: columns of the three cubes, to the left, in the middle and to the right, and the row between floor and sky
LEFT, MIDDLE, RIGHT, ROW = 15, 30, 45, 10


def test_objects_have_their_temperatures(image):
    found, _ = image()
    assert found.shape == (20, 60)
    assert found.dtype == np.float32
    assert [float(found[ROW, column]) for column in (LEFT, MIDDLE, RIGHT)] == [36.5, 215.0, 15.0]
    assert float(found[0, 0]) == float(found[-1, 0]) == 15.0
    assert set(np.unique(found)) == {15.0, 36.5, 215.0}


def test_environment_and_sky(image):
    found, _ = image(env="env.properties(Temperature=-3.0)", eye="eye.properties(SkyTemperature=-40.0)")
    assert [float(found[ROW, column]) for column in (LEFT, MIDDLE, RIGHT)] == [36.5, 197.0, -3.0]
    assert float(found[0, 0]) == -40.0
    own, _ = image(env="env.properties(Temperature=-3.0)", eye="eye.properties(DefaultTemperature=20.0)")
    assert float(own[ROW, RIGHT]) == 20.0


def test_a_fire_has_its_own_heat_and_its_own_tag(image):
    hot = cube("Hot", 0.0, "Hot.properties(Blaze=600.0)") + cube("Fire", 2.0, "Fire.properties(Fire=True)")
    found, _ = image(hot, "eye.properties(FireTag='Blaze', FireTemperature=90.0)")
    assert float(found[ROW, MIDDLE]) == 615.0
    assert float(found[ROW, LEFT]) == 15.0


def test_parts_have_the_temperature_of_what_carries_them(image):
    robot = "other = B21('other'); other.translate(3, 0, 0.2); other.properties(Temperature=30.0)\n"
    found, simulation = image(robot)
    other = simulation.world.game_object("other")
    meshes = [node for node in other.node.walk() if node.mesh is not None]
    assert [node for node in meshes if node is not other.node]
    # the robot is 0.5 to 0.6 m wide; at a distance of 2.7 m, a metre is 30 / 2.7 px wide
    assert 5 <= (found == 30.0).any(axis=0).sum() <= 8
    assert float(found[ROW, MIDDLE]) == 30.0


def test_a_temperature_may_change_while_the_simulation_runs(image):
    found, simulation = image()
    warm = simulation.world.game_object("Warm")
    warm["Temperature"] = 40.0
    simulation.sleep(0.1)
    assert float(simulation.context.component("robot.eye").local_data["image"][ROW, LEFT]) == 40.0
    assert float(found[ROW, LEFT]) == 36.5
    for wrong in (float("nan"), "hot", None, True):
        warm["Temperature"] = wrong
        simulation.sleep(0.1)
        assert float(simulation.context.component("robot.eye").local_data["image"][ROW, LEFT]) == 15.0
    warm["Temperature"] = -1e30
    simulation.sleep(0.1)
    assert float(simulation.context.component("robot.eye").local_data["image"][ROW, LEFT]) == np.float32(-273.15)


def test_a_delayed_image_shows_the_temperatures_of_its_tick(image):
    _, simulation = image(eye="eye.delay(0.2)", seconds=1 / 60)
    simulation.world.game_object("Warm")["Temperature"] = 50.0
    simulation.sleep(0.2)
    found = simulation.context.component("robot.eye").local_data
    assert found["timestamp"] == pytest.approx(1 / 60)
    assert float(found["image"][ROW, LEFT]) == 36.5
    state = simulation.save()
    simulation.sleep(0.1)
    assert float(simulation.context.component("robot.eye").local_data["image"][ROW, LEFT]) == 50.0
    simulation.restore(state)
    simulation.sleep(0.1)
    assert float(simulation.context.component("robot.eye").local_data["image"][ROW, LEFT]) == 50.0


def test_noise_is_added_to_the_temperatures(image):
    found, _ = image(eye="eye.noise(gaussian=0.05)")
    background = found[:5]
    assert background.std() == pytest.approx(0.05, rel=0.25)
    assert background.mean() == pytest.approx(15.0, abs=0.02)


def test_a_wrong_temperature_of_the_environment_is_refused(image):
    with pytest.raises(LoadError, match=r"'robot.eye'.*Temperature='hot'.*degrees Celsius"):
        image(env="env.properties(Temperature='hot')")


# -- optical flow of cameras on robots that move ---------------------------------------------------

OPTICAL_FLOW_CAMERA_SCENE = """
robot = FakeRobot("robot")
robot.translate(z=2)
motion = MotionXYW("motion"); motion.properties(ControlType="Position")
robot.append(motion)
eye = OpticalFlowCamera("eye")
eye.properties(cam_width=96, cam_height=72, cam_focal=32, cam_near=0.3)
eye.frequency(10)
robot.append(eye)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (5.1, 0, 0)
env = Environment("empty")
"""


@pytest.fixture
def moving(simulate):
    simulation = simulate(OPTICAL_FLOW_CAMERA_SCENE, sockets=False)
    simulation.context.component("robot.motion").local_data["y"] = 1.0
    return simulation


def upper(eye):
    """Above the ground, away from the border."""
    return eye.local_data["image"][5:40, 10:86]


def test_the_wall_moves_as_the_robot_does(moving):
    eye = moving.context.component("robot.eye")
    moving.sleep(1.0)
    assert eye.local_data["image"].shape == (72, 96, 2)
    # 1 m/s to the left, ten images per second, 5 m to the wall, f = 96 px
    np.testing.assert_allclose(upper(eye)[..., 0], 96 * 0.1 / 5, rtol=0.02)
    np.testing.assert_allclose(upper(eye)[..., 1], 0.0, atol=0.02)


def test_the_first_picture_has_no_flow(simulate):
    simulation = simulate(OPTICAL_FLOW_CAMERA_SCENE, sockets=False)
    simulation.sleep(0.05)
    assert np.abs(upper(simulation.context.component("robot.eye"))).max() < 1e-3


def test_a_restored_run_measures_the_same(moving):
    moving.sleep(0.5)
    state = moving.save()
    moving.sleep(0.3)
    first = moving.context.component("robot.eye").local_data["image"].copy()
    moving.restore(state)
    moving.sleep(0.3)
    np.testing.assert_array_equal(first, moving.context.component("robot.eye").local_data["image"])
    assert np.abs(upper(moving.context.component("robot.eye"))[..., 0]).min() > 0.5
