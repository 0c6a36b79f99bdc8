"""What clients may set has a budget; pages show pictures; images of other processes give the same events."""

import contextlib

import numpy as np
import pytest

import morse
from morse.core.clients.budgets import MOST_PIXELS
from morse.viewer.feeds.components import component_tree
from morse.viewer.feeds.sensors import picture_of, shot_of
from pymorse import MorseServiceFailed

SCENE = """
ground = Cube("ground"); ground.scale = (30, 30, 0.5); ground.translate(z=-20.5); ground.static()
robot = Submarine()
robot.translate(z=-17.0)
{sensors}
Environment("empty", fastmode=True)
"""
LARGEST = {
    "Radar": {"ray_spacing": 0.2, "azimuth_fov": 180.0, "elevation_fov": 90.0, "range_bins": 1024, "doppler_bins": 512},
    "ImagingSonar": {"beams": 1024, "elevation_rays": 64, "bins": 1024},
    "SideScanSonar": {"rays_per_side": 2048, "samples": 2048, "pings": 2048},
    "MultibeamSonar": {"beams": 1024},
    "TactileArray": {"rows": 128, "columns": 128},
    "BumperStrip": {"segments": 64},
    "EventCamera": {"cam_width": 8192, "cam_height": 8192},
}


def scene(*names):
    return SCENE.format(
        sensors="\n".join(f"{n.lower()} = {n}('{n.lower()}'); robot.append({n.lower()})" for n in names)
    )


@pytest.mark.parametrize("name", sorted(LARGEST))
def test_a_client_cannot_make_a_sensor_larger_than_its_budget(load, name):
    simulation = load(scene(name))
    simulation.step(3)
    sensor = simulation.context.components[f"robot.{name.lower()}"]
    before = sensor.sensing_cost() * max(sensor.frequency, 10.0)
    for prop, value in LARGEST[name].items():
        # refused or not: the cost is what counts
        with contextlib.suppress(MorseServiceFailed):
            getattr(simulation.robot, name.lower()).set_property(prop, value).result()
    assert sensor.sensing_cost() * max(sensor.frequency, 10.0) <= before + MOST_PIXELS
    simulation.step(12)
    assert simulation.failures == ()


@pytest.mark.parametrize("name", sorted(LARGEST))
@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e300, 1e300, 0, "much", None])
def test_values_that_are_none_are_refused(load, name, value):
    simulation = load(scene(name))
    simulation.step(3)
    for prop in LARGEST[name]:
        with pytest.raises(Exception, match=rf"{prop}|{name.lower()}"):
            getattr(simulation.robot, name.lower()).set_property(prop, value).result()
    simulation.step(6)
    assert simulation.failures == ()


def test_pages_show_what_has_a_picture(load):
    names = ("Radar", "ImagingSonar", "SideScanSonar", "TactileArray", "EventCamera", "DVL", "EchoSounder")
    simulation = load(scene(*names).replace(", fastmode=True", ""))
    simulation.step(12)
    pictured = {one.name: one.pictured for one in component_tree(simulation.context)}
    for name in names:
        sensor = simulation.context.components[f"robot.{name.lower()}"]
        assert pictured[sensor.name()] is (name not in ("DVL", "EchoSounder"))
        if pictured[sensor.name()]:
            shot = shot_of(sensor, sensor.shown())
            assert shot is not None
            assert (shot.image.ndim, shot.image.dtype) == (3, np.uint8)
            picture = picture_of(sensor.name(), sensor, shot)
            assert picture.payload.startswith(b"\xff\xd8")


def events_scene():
    from morse.builder import ATRV, Environment, EventCamera, MotionVW

    robot = ATRV()
    motion, camera = MotionVW(), EventCamera()
    camera.properties(cam_width=48, cam_height=32, errors=True)
    camera.translate(x=0.6, z=1.2)
    robot.append(motion)
    robot.append(camera)
    Environment("indoors-1/boxes")


@pytest.mark.long
def test_images_of_another_process_give_the_same_events():
    found = []
    for workers in (0, 1):
        with morse.load(events_scene, seed=3, sockets=False, cameras_on=workers) as simulation:
            simulation.robot.motion.publish({"v": 0.5, "w": 0.5})
            simulation.step(30)
            found.append(simulation.robot.camera.data["events"].tobytes())
    assert found[0] == found[1]
    assert found[0]
