"""Satellites under the open sky, and among buildings."""

import math

import numpy as np
import pytest

from morse.plugins.senses.sensors.gnss_receiver import L1

SCENE = """
robot = FakeRobot()
robot.translate(2.0, 3.0, 1.5)
receiver = GNSSReceiver()
receiver.properties({properties})
robot.append(receiver)
{objects}
Environment("empty", fastmode=True)
"""
WALL = """
wall = Cube("wall"); wall.scale = (0.5, 60.0, 60.0); wall.translate(x={x}); wall.static()
"""


@pytest.fixture
def receiver(load):
    def make(objects="", **properties):
        given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
        simulation = load(SCENE.format(properties=given, objects=objects))
        simulation.step(3)
        assert simulation.failures == ()
        return simulation.context.components["robot.receiver"]

    return make


def test_the_open_sky_gives_the_position_and_the_dilution_of_its_geometry(receiver):
    sensor = receiver()
    data = sensor.local_data
    assert (data["x"], data["y"], data["z"]) == (pytest.approx(2.0), pytest.approx(3.0), pytest.approx(1.5))
    assert (data["satellites"], data["direct"]) == (12, 12)
    design = np.column_stack([-sensor.satellites(), np.ones(12)])
    covariance = np.linalg.inv(design.T @ design)
    assert data["hdop"] == pytest.approx(math.sqrt(covariance[0, 0] + covariance[1, 1]), rel=1e-9)
    assert 0.5 < data["hdop"] < 1.5


def test_a_wall_hides_satellites_and_its_reflections_are_longer(receiver):
    """2 d n·s, for a wall that is 8 m ahead."""
    sensor = receiver(WALL.format(x=10.5))
    ways = sensor.satellites()
    hidden = ways[:, 0] / np.hypot(ways[:, 0], ways[:, 1]) > 0.3
    assert sensor.local_data["direct"] < 12
    extra = sensor._reflections(ways)
    seen = [index for index, delays in enumerate(extra) if delays]
    assert seen
    for index in seen:
        assert ways[index, 0] < 0.0  # on the side of the receiver
        assert extra[index] == [pytest.approx(2.0 * 8.0 * -ways[index, 0], rel=1e-6)]
    assert hidden.any()


def test_the_error_of_a_range_is_that_of_van_nee(receiver):
    plain, mirrored = receiver(WALL.format(x=10.5), reflection=0.0), receiver(WALL.format(x=10.5), reflection=0.4)
    assert plain.local_data["x"] == pytest.approx(2.0, abs=1e-6)
    mirrored.measure()  # the phase changes while the satellites move
    ways = mirrored.satellites()
    mirrored._sky.turn_to(ways)
    mirrored._sky.refresh()
    direct = mirrored._sky.hit < 0
    errors = np.zeros(12)
    for index, delays in enumerate(mirrored._reflections(ways)):
        share = 0.4 * math.cos(2 * math.pi * delays[0] / L1) if delays else 0.0
        errors[index] = delays[0] * share / (1 + share) if delays else 0.0
    design = np.column_stack([-ways, np.ones(12)])[direct]
    shift = np.linalg.lstsq(design, errors[direct], rcond=None)[0]
    found = [mirrored.local_data[name] for name in "xyz"]
    assert found == pytest.approx(np.array([2.0, 3.0, 1.5]) + shift[:3], abs=1e-6)
    assert np.abs(shift[:3]).max() > 0.05


def test_a_satellite_that_is_hidden_and_mirrored_is_too_far_away(receiver):
    """A street between two walls: each hides one side and mirrors the other."""
    street = WALL.format(x=10.5) + WALL.format(x=-6.5).replace("wall", "other")
    sensor = receiver(street, reflection=0.0)
    data = sensor.local_data
    assert data["satellites"] > data["direct"]
    assert math.dist((data["x"], data["y"], data["z"]), (2.0, 3.0, 1.5)) > 0.5


def test_there_is_no_fix_indoors(receiver):
    roof = 'roof = Cube("roof"); roof.scale = (50, 50, 0.1); roof.translate(z=4.0); roof.static()'
    data = receiver(roof).local_data
    assert math.isnan(data["x"])
    assert (data["satellites"], data["hdop"]) == (0, math.inf)


def test_noise_is_that_of_the_ranges_times_the_dilution(load):
    simulation = load(SCENE.format(properties="errors=True, range_noise=2.0", objects=""))
    errors = []
    for _ in range(250):
        simulation.step(12)
        data = simulation.robot.receiver.data
        errors.append(math.hypot(data["x"] - 2.0, data["y"] - 3.0))
    assert math.sqrt(np.mean(np.square(errors))) == pytest.approx(2.0 * data["hdop"], rel=0.15)
