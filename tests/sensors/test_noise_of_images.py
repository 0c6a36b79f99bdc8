"""Noise of arrays whose size changes, and of arrays of integers."""

import numpy as np
import pytest

SCRIPT = """
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
def world(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.3)
    return simulation


def test_a_cloud_drifts_as_a_whole_also_if_points_come_and_go(world):
    sizes = set()
    for _ in range(4):
        cloud, truth = (world.context.component(f"robot.{name}").local_data["points"] for name in ("cloud", "truth"))
        sizes.add(len(cloud))
        drift = cloud - truth
        assert np.abs(drift).max() > 1e-3
        np.testing.assert_allclose(drift, np.broadcast_to(drift[0], drift.shape), atol=1e-5)
        world.context.component("robot").bge_object.applyRotation((0, 0, 0.2), False)
        world.sleep(0.1)
    assert len(sizes) > 1


def test_a_thermal_image_drifts_as_a_whole_also_at_another_size(world):
    eye = world.context.component("robot.heat")
    eye.set_property("cam_width", 20)
    world.sleep(0.1)
    image = eye.local_data["image"]
    assert image.shape == (24, 20)
    assert np.ptp(image) == 0.0
    assert image[0, 0] != 15.0


def test_codes_of_an_image_have_no_bias_and_stay_opaque(world):
    clean, codes = (
        world.context.component(f"robot.{name}").local_data["image"].astype(float) for name in ("clean", "codes")
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
