"""The radar altimeter: heights above the surface below."""

import math

import pytest

SCRIPT = """
table = Cube("Table")
table.scale = (1, 1, 0.5)
table.location = (3, 0, 0.5)
table._bpy_object.game.physics_type = "STATIC"
floor = Cube("Floor")
floor.scale = (9, 9, 0.5)
floor.location = (0, 0, -0.5)
floor._bpy_object.game.physics_type = "STATIC"
robot = FakeRobot()
robot.translate({x}, 0, {z})
robot.rotate(0.4, 1.0, 0.2)
radar = RadarAltimeter()
{setting}
robot.append(radar)
env = Environment("empty", fastmode=True)
"""


def height(simulate, x=0.0, z=5.0, setting=""):
    simulation = simulate(SCRIPT.format(x=x, z=z, setting=setting), sockets=False)
    simulation.sleep(0.1)
    return simulation.context.component("robot.radar").local_data["z"]


def test_height_above_floor_and_furniture_in_any_attitude(simulate):
    assert height(simulate, z=5.0) == pytest.approx(5.0, abs=1e-6)
    assert height(simulate, x=3.0, z=5.0) == pytest.approx(4.0, abs=1e-6)


def test_infinite_when_there_is_nothing_within_reach(simulate):
    assert height(simulate, z=31.0) == math.inf
    assert height(simulate, z=29.0) == pytest.approx(29.0, abs=1e-6)
    assert height(simulate, z=31.0, setting="radar.properties(MaxRange=50.0)") == pytest.approx(31.0, abs=1e-6)
    assert height(simulate, x=40.0) == math.inf


def test_a_reach_changed_while_it_runs(simulate):
    simulation = simulate(SCRIPT.format(x=0, z=5.0, setting=""), sockets=False)
    simulation.context.component("robot.radar").set_property("MaxRange", 4.0)
    simulation.sleep(0.1)
    assert simulation.context.component("robot.radar").local_data["z"] == math.inf


@pytest.mark.parametrize("reach", [0.0, -1.0])
def test_a_reach_of_nothing_is_refused(simulate, reach):
    with pytest.raises(Exception, match=r"'MaxRange' of RadarAltimeter is .*, expected a number from 0\.001 m upward"):
        height(simulate, setting=f"radar.properties(MaxRange={reach})")
