"""The proximity sensor."""

import math

import pytest

from morse.core.exceptions import MorseRPCTypeError
from morse.core.validation import Arguments

SCRIPT = """
lamp = Cube("Lamp")
lamp.location = (3, 4, 0)
lamp.properties(Shining=True)
for i, x in enumerate((0, 10, 29, 31)):
    robot = FakeRobot(f"r{i}")
    robot.translate(x, 0, 1)
    if i == 0:
        near = Proximity("near")
        near.translate(0, 0, 5)
        robot.append(near)
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def near(simulate):
    simulation = simulate(SCRIPT, sockets=False)

    def measured():
        simulation.sleep(0.2)
        return simulation.context.component("r0.near")

    return measured


def test_robots_within_30_metres_of_the_own_robot(near):
    data = near().local_data
    assert data["near_objects"] == pytest.approx({"r1": 10.0, "r2": 29.0})
    assert data["near_robots"] == data["near_objects"]


def test_reach_and_tag_may_be_changed(near):
    sensor = near()
    sensor.set_range(100)
    assert set(near().local_data["near_objects"]) == {"r1", "r2", "r3"}
    sensor.set_tracked_tag("Shining")
    assert near().local_data["near_objects"] == pytest.approx({"Lamp": math.hypot(3, 4, 1)})
    sensor.set_range(5.0)
    assert near().local_data["near_objects"] == {}


@pytest.mark.parametrize("bad", [-1.0, math.nan, "far", None, True])
def test_a_reach_that_is_none_is_refused(near, bad):
    sensor = near()
    with pytest.raises(MorseRPCTypeError, match=r"'range' is a number from 0 to .* m"):
        Arguments(sensor.set_range, "set_range").check([bad])
    assert set(near().local_data["near_objects"]) == {"r1", "r2"}


@pytest.mark.parametrize("bad", [None, 5])
def test_a_tag_that_is_none_is_refused(near, bad):
    with pytest.raises(MorseRPCTypeError, match="set_tracked_tag: 'tag' is a string"):
        Arguments(near().set_tracked_tag, "set_tracked_tag").check([bad])
    with pytest.raises(MorseRPCTypeError, match="set_tracked_tag: 'tag' is the name of a property"):
        near().set_tracked_tag("")


def test_twelve_measurements_a_second(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    times = set()
    for _ in range(60):
        simulation.step()
        times.add(simulation.context.component("r0.near").local_data["timestamp"])
    assert len(times - {0.0}) == 12
