"""A car in a town: the distance that MORSE 1.4 measured, and a start inside the ground."""

import pytest

SCENE = """
robot = Hummer()
robot.translate(z={height})
motion = SteerForce()
robot.append(motion)
robot.append(Pose("pose"))
env = Environment("{world}")
{setting}
"""
CALIBRATED = "env.use_physics_of_1_4()"
#: of the model: distance from the origin to the bottom, m
BOTTOM = 0.98


@pytest.mark.parametrize("brake", [2.0, 10.0, 50.0])
def test_the_distance_for_a_force_and_a_brake(simulate, brake):
    made = simulate(SCENE.format(height=0.0, world="land-1/rosace_1", setting=CALIBRATED), sockets=False)
    made.sleep(0.5)
    made.robot.motion.publish({"steer": 0.0, "force": -20.0, "brake": 0.0})
    made.sleep(3.0)
    made.robot.motion.publish({"steer": 0.0, "force": 0.0, "brake": brake})
    made.sleep(3.0)
    data = made.context.component("robot.pose").local_data
    assert data["x"] == pytest.approx(8.5, abs=1.0)
    assert data["y"] == pytest.approx(0.0, abs=0.1)


def test_two_ways_forward_and_one_back(simulate):
    made = simulate(SCENE.format(height=0.0, world="land-1/rosace_1", setting=CALIBRATED), sockets=False)
    made.sleep(0.5)
    places = []
    for force, brake, seconds in ((-20.0, 0.0, 3.0), (0.0, 10.0, 2.5), (-20.0, 0.0, 5.0), (0.0, 10.0, 2.5)):
        made.robot.motion.publish({"steer": 0.0, "force": force, "brake": brake})
        made.sleep(seconds + 1 / 60)
        places.append(made.context.component("robot.pose").local_data["x"])
    made.robot.motion.publish({"steer": 0.0, "force": 10.0, "brake": 0.0})
    made.sleep(11.0)
    places.append(made.context.component("robot.pose").local_data["x"])
    assert places[1] == pytest.approx(8.5, abs=1.0)
    assert places[3] == pytest.approx(28.0, abs=1.0)
    assert places[4] == pytest.approx(0.0, abs=1.5)


@pytest.mark.parametrize("setting", ["", CALIBRATED], ids=["default", "of_1_4"])
@pytest.mark.parametrize("world", ["empty", "land-1/rosace_1"])
@pytest.mark.parametrize("height", [0.0, 0.3, 0.6])
def test_a_robot_that_starts_inside_the_ground_stands_on_it(simulate, world, height, setting):
    made = simulate(SCENE.format(height=height, world=world, setting=setting), sockets=False)
    made.sleep(1.0)
    data = made.context.component("robot.pose").local_data
    # the ground of the town is not quite level, so that the car rolls slowly
    assert (data["x"], data["y"]) == pytest.approx((0.0, 0.0), abs=0.3)
    assert data["z"] == pytest.approx(BOTTOM, abs=0.05)
