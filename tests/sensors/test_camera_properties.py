"""Properties of cameras that change while the simulation runs, and values without an effect."""

import math

import numpy as np
import pytest

from morse.core.exceptions import MorseRPCTypeError

SCRIPT = """
robot = FakeRobot("robot"); robot.translate(z=1.0)
small = {"cam_width": 16, "cam_height": 12}
depth = DepthCamera("depth"); depth.properties(cam_far=100.0, cam_fov=90.0, **small); robot.append(depth)
ids = SegmentationCamera("ids"); ids.properties(**small); robot.append(ids)
heat = ThermalCamera("heat"); heat.properties(**small); robot.append(heat)
both = DepthCameraAggregator("both")
for name, y in (("left", 0.5), ("right", -0.5)):
    one = DepthCamera(name); one.translate(y=y); one.properties(**small); both.append(one)
both.properties(master_camera="rigth"); robot.append(both)
noisy = VideoCamera("noisy"); noisy.properties(**small); noisy.noise(gaussian=5.0); robot.append(noisy)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (6.1, 0, 0)
wall.properties(Part=True, Kind="wall", Temperature="warm")
env = Environment("empty")
"""


@pytest.fixture
def world(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.2)
    return simulation


def at_start(caplog):
    return "\n".join(record.getMessage() for record in caplog.get_records("setup"))


def test_the_rows_of_a_cloud(world, caplog):
    eye = world.context.component("robot.depth")
    eye.set_property("keep_list", "[1, 2, 99]")
    world.sleep(0.1)
    assert eye.local_data["nb_points"] == 2 * 16
    assert "keep_list contains the row 99; the image has the rows 0 to 11" in caplog.text
    with pytest.raises(MorseRPCTypeError, match=r"keep_list lists rows of the image, such as '\[1, 17, 34\]'"):
        eye.set_property("keep_list", "[top]")
    eye.set_property("keep_list", None)
    world.sleep(0.1)
    assert eye.local_data["nb_points"] == 12 * 16


def test_the_objects_and_classes_of_an_image_of_ids(world):
    eye = world.context.component("robot.ids")

    def classes():
        world.sleep(0.1)
        return {row["name"]: (row["class"], row["class_id"]) for row in eye.local_data["labels"]}

    assert classes()["robot"] == ("robot", 1)
    eye.set_property("class_names", "crate, robot")
    assert classes()["robot"] == ("robot", 2)
    eye.set_property("class_tag", "Kind")
    assert classes()["Wall"] == ("wall", 3)
    # the wall covers the middle
    assert eye.local_data["classes"][6, 8] == 3


def test_the_master_of_a_cloud(world, caplog):
    both = world.context.component("robot.both")
    assert "it has no depth camera 'rigth', which 'master_camera' names; did you mean 'right'?" in at_start(caplog)
    with pytest.raises(MorseRPCTypeError, match="did you mean 'left'"):
        both.set_property("master_camera", "lefft")
    middles = {}
    for name in ("left", "right"):
        both.set_property("master_camera", name)
        world.sleep(0.1)
        middles[name] = both.local_data["points"][:, 0].mean()
    # X is to the right: seen from the left camera, all points are a metre farther to the right
    assert middles["left"] - middles["right"] == pytest.approx(1.0, abs=1e-3)


def test_values_without_an_effect_are_named(world, caplog):
    assert "robot.noisy: noise() without a field has no effect" in at_start(caplog)
    assert "Wall: the property 'Temperature' is a number of degrees Celsius, not 'warm'" in at_start(caplog)
    assert np.unique(world.context.component("robot.heat").local_data["image"]).tolist() == [15.0]


# -- noise of arrays whose size changes, and of arrays of integers ---------------------------------

NOISE_OF_IMAGES_SCRIPT = """
robot = FakeRobot("robot"); robot.translate(z=1.0)
small = {"cam_width": 32, "cam_height": 24}
cloud = DepthCamera("cloud"); cloud.properties(**small); cloud.noise(bias_walk=0.1, field="points"); robot.append(cloud)
truth = DepthCamera("truth"); truth.properties(**small); robot.append(truth)
heat = ThermalCamera("heat"); heat.properties(**small); heat.noise(bias_walk=1.0, field="image"); robot.append(heat)
for name in ("clean", "codes"):
    eye = VideoCamera(name); eye.properties(**small); robot.append(eye)
eye.noise(gaussian=4.0, field="image")
wall = Cube("Wall"); wall.scale = (0.1, 1, 20); wall.location = (6.1, 0, 0)
env = Environment("empty")
"""


@pytest.fixture
def noise_of_images_world(simulate):
    simulation = simulate(NOISE_OF_IMAGES_SCRIPT, sockets=False)
    simulation.sleep(0.3)
    return simulation


def test_a_cloud_drifts_as_a_whole_also_if_points_come_and_go(noise_of_images_world):
    sizes = set()
    for _ in range(4):
        cloud, truth = (
            noise_of_images_world.context.component(f"robot.{name}").local_data["points"] for name in ("cloud", "truth")
        )
        sizes.add(len(cloud))
        drift = cloud - truth
        assert np.abs(drift).max() > 1e-3
        np.testing.assert_allclose(drift, np.broadcast_to(drift[0], drift.shape), atol=1e-5)
        noise_of_images_world.context.component("robot").bge_object.applyRotation((0, 0, 0.2), False)
        noise_of_images_world.sleep(0.1)
    assert len(sizes) > 1


def test_a_thermal_image_drifts_as_a_whole_also_at_another_size(noise_of_images_world):
    eye = noise_of_images_world.context.component("robot.heat")
    eye.set_property("cam_width", 20)
    noise_of_images_world.sleep(0.1)
    image = eye.local_data["image"]
    assert image.shape == (24, 20)
    assert np.ptp(image) == 0.0
    assert image[0, 0] != 15.0


def test_codes_of_an_image_have_no_bias_and_stay_opaque(noise_of_images_world):
    clean, codes = (
        noise_of_images_world.context.component(f"robot.{name}").local_data["image"].astype(float)
        for name in ("clean", "codes")
    )
    assert (codes[..., 3] == 255).all()
    errors = (codes - clean)[..., :3][(clean[..., :3] > 20) & (clean[..., :3] < 235)]
    # the standard error of the mean of more than a thousand codes is below 0.13
    assert len(errors) > 1000
    assert abs(errors.mean()) < 0.4
    assert errors.std() == pytest.approx(4.0, abs=0.4)


def test_ids_have_no_noise(simulate):
    with pytest.raises(Exception, match=r"SegmentationCamera\.noise\(field\): 'image' is not a measured number"):
        simulate(
            'robot = FakeRobot()\neye = SegmentationCamera()\neye.noise(gaussian=1.0, field="image")\n', sockets=False
        )


# -- exposure and read-out times of cameras on robots that move ------------------------------------

SCENE = """
robot = FakeRobot("robot")
robot.translate(z=2)
motion = MotionXYW("motion"); motion.properties(ControlType="Position")
robot.append(motion)
for name, options in dict(sharp={}, blurred=dict(exposure_time=0.05), rolling=dict(readout_time=0.05)).items():
    eye = VideoCamera(name)
    eye.properties(cam_width=64, cam_height=48, cam_focal=32, cam_near=0.3, motion_steps=6, **options)
    eye.frequency(10)
    robot.append(eye)
post = Cube("Post"); post.scale = (0.1, 0.1, 20); post.location = (4, 0, 0)
env = Environment("empty")
"""


@pytest.fixture
def moving(simulate):
    return simulate(SCENE, sockets=False)


def images(simulation):
    return [
        simulation.context.component(f"robot.{name}").local_data["image"].astype(int)
        for name in ("sharp", "blurred", "rolling")
    ]


def test_only_images_of_moving_cameras_are_blurred(moving):
    moving.sleep(0.3)
    sharp, blurred, rolling = images(moving)
    assert np.abs(sharp - blurred).max() <= 1
    assert np.abs(sharp - rolling).max() <= 1
    moving.context.component("robot.motion").local_data["y"] = 2.0
    moving.sleep(0.5)
    sharp, blurred, rolling = images(moving)
    # the upper rows, which are read first, differ most
    assert np.abs(sharp - blurred)[5:20].max() > 20
    assert np.abs(sharp - rolling)[:8].max() > 20
    assert np.abs(sharp - rolling)[46:].mean() < np.abs(sharp - rolling)[:8].mean()


def test_a_restored_run_blurs_the_same(moving):
    moving.context.component("robot.motion").local_data["y"] = 1.0
    moving.sleep(0.3)
    state = moving.save()
    moving.sleep(0.3)
    first = images(moving)
    moving.restore(state)
    moving.sleep(0.3)
    for one, other in zip(first, images(moving), strict=True):
        np.testing.assert_array_equal(one, other)


# -- normals of a wall that a robot looks at -------------------------------------------------------

NORMAL_CAMERA_SCENE = """
robot = FakeRobot("robot")
robot.translate(z=2)
robot.rotate(z=0.3)
eye = NormalCamera("eye")
eye.properties(cam_width=32, cam_height=24, cam_focal=32, cam_near=0.3)
robot.append(eye)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (5.1, 0, 0)
env = Environment("empty")
"""


def test_normals_are_given_in_the_frame_of_the_camera(simulate):
    simulation = simulate(NORMAL_CAMERA_SCENE, sockets=False)
    simulation.sleep(0.1)
    image = simulation.context.component("robot.eye").local_data["image"]
    assert image.shape == (24, 32, 3)
    # the robot is turned to the left by 0.3 rad; the normal of the wall points along -X of the world
    np.testing.assert_allclose(image[2, 16], (-math.sin(0.3), 0.0, -math.cos(0.3)), atol=1e-5)


# -- rotating depth cameras, and aggregated ones: walls at known distances -------------------------

#: walls whose near faces are 3 m ahead of the origin and 5 m to the left of it
TURNING_CAMERAS_SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(z=4.0)
{body}
for name, place, half in (("ahead", (3.5, 0, 1), (0.5, 9, 9)), ("left", (0, 5.5, 1), (9, 0.5, 9))):
    wall = Cube(name)
    wall.location, wall.scale = place, half
env = Environment("empty")
"""
CAMERA = """
camera = {name}()
camera.properties(cam_width=32, cam_height=24, cam_near=0.1, cam_far=20.0{more})
camera.frequency(60)
robot.append(camera)
"""


@pytest.fixture
def load(load):
    return lambda body: load(TURNING_CAMERAS_SCENE.format(body=body))


def test_a_camera_that_turns_a_quarter_sees_the_wall_on_the_left(load):
    simulation = load(CAMERA.format(name="DepthCameraRotationZ", more=f", rotation={math.pi / 2}"))
    simulation.step()
    assert np.median(simulation.robot.camera.data["points"][:, 2]) == pytest.approx(3.0, abs=1e-3)
    simulation.step()
    assert np.median(simulation.robot.camera.data["points"][:, 2]) == pytest.approx(5.0, abs=1e-3)


@pytest.mark.parametrize("name", ["Velodyne", "VelodyneZB"])
def test_velodynes_go_round_in_their_steps(load, name):
    simulation = load(CAMERA.format(name=name, more=""))
    camera = simulation.context.component("robot.camera")

    def heading():
        """Along the optical axis, which is Z of the camera."""
        rotation = camera.bge_object.world_pose()[1]
        return math.atan2(rotation[5], rotation[2])

    before = heading()
    simulation.step(3)
    # the step of the script of 1.4: 0.8578 rad after each image, to the left
    assert math.remainder(heading() - before - 3 * 0.8578, math.tau) == pytest.approx(0.0, abs=1e-6)


def test_clouds_are_joined_in_the_frame_of_the_master(load):
    cameras = "".join(
        f"""
{name} = DepthCamera()
{name}.properties(cam_width=32, cam_height=24, cam_near=0.1, cam_far=20.0)
{name}.frequency(60)
{name}.rotate(x={turn})
whole.append({name})
"""
        for name, turn in (("front", 0.0), ("side", math.pi / 2))
    )
    body = f"""
whole = DepthCameraAggregator()
whole.properties(master_camera="front")
whole.frequency(60)
robot.append(whole)
{cameras}
"""
    simulation = load(body)
    simulation.step(2)
    data = simulation.robot.whole.data
    points = np.asarray(data["points"]).reshape(-1, 3)
    assert data["nb_points"] == len(points) == 2 * 32 * 24
    ahead, left = points[:768], points[768:]
    # Z forward: the wall ahead; X to the right: the wall on the left
    assert ahead[:, 2] == pytest.approx(3.0, abs=1e-3)
    assert left[:, 0] == pytest.approx(-5.0, abs=1e-3)
