"""The pan-tilt unit: the direction of an attached camera agrees with geometry."""

import math

import pytest

from pymorse import MorseServiceFailed, MorseServicePreempted

SCENE = """
robot = ATRV()
robot.translate(1.0, 2.0, 0.0)
robot.rotate(0, 0, {yaw})
ptu = PTU()
ptu.translate(0.2, 0.0, 0.9)
{more}
robot.append(ptu)
eye = Pose()
ptu.append(eye)
lamp = Sphere('lamp')
lamp.translate(4.0, 6.0, 2.0)
"""


def load(simulate, more="", yaw=0.0):
    sim = simulate(SCENE.format(more=more, yaw=yaw), sockets=False)
    sim.step(30)
    return sim


def eye(sim):
    return sim.robot.ptu.eye.get()


def test_each_joint_turns_at_the_speed(simulate):
    sim = load(simulate, "ptu.properties(Speed=0.5)")
    sim.robot.ptu.publish({"pan": 1.0, "tilt": -0.2})
    sim.step(60)
    assert sim.robot.ptu.get_pan_tilt().result() == pytest.approx([0.5, -0.2], abs=0.01)
    sim.step(90)
    assert sim.robot.ptu.get_pan_tilt().result() == pytest.approx([1.0, -0.2], abs=1e-6)


def test_what_rides_on_it_is_turned_and_moved(simulate):
    sim = load(simulate)
    sim.robot.ptu.set_pan_tilt(math.pi / 2, 0.3).result(10.0)
    sim.step(60)
    data = eye(sim)
    assert (data["yaw"], data["pitch"]) == pytest.approx((math.pi / 2, 0.3), abs=1e-3)
    # the tilting part is 1 cm in front of the pan axis
    foot = sim.context.component("robot.ptu").bge_object.worldPosition
    assert (data["x"], data["y"]) == pytest.approx((foot[0], foot[1] + 0.01), abs=1e-3)


@pytest.mark.parametrize("yaw", [0.0, 2.5])
def test_looking_at_a_point_is_geometry(simulate, yaw):
    sim = load(simulate, yaw=yaw)
    foot = sim.context.component("robot.ptu").bge_object.worldPosition
    target = (4.0, 6.0, 2.0)
    dx, dy, dz = (a - b for a, b in zip(target, foot, strict=True))
    sim.robot.ptu.look_at_point(*target).result(20.0)
    pan, tilt = sim.robot.ptu.get_pan_tilt().result()
    assert math.remainder(pan - math.atan2(dy, dx) + yaw, math.tau) == pytest.approx(0.0, abs=0.011)
    assert tilt == pytest.approx(-math.asin(dz / math.sqrt(dx * dx + dy * dy + dz * dz)), abs=0.011)


def test_on_a_slope_it_looks_there_all_the_same(simulate):
    scene = SCENE.replace("robot = ATRV()", "robot = RMax()\nrobot.rotate(0.3, 0.4, 0)\nrobot.translate(0, 0, 5)")
    sim = simulate(scene.format(more="", yaw=1.0), sockets=False)
    sim.robot.ptu.look_at_object("lamp").result(20.0)
    sim.step(30)
    ptu = sim.context.component("robot.ptu").bge_object
    head = sim.context.component("robot.ptu.eye").bge_object
    ahead = [row[0] for row in head.worldOrientation]
    wanted = ptu.getVectTo((4.0, 6.0, 2.0))[1]
    assert sum(a * b for a, b in zip(ahead, wanted, strict=True)) == pytest.approx(1.0, abs=1e-6)


def test_an_object_that_is_not_there_fails_with_the_nearest_name(simulate):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match=r"no object 'lamb'.*lamp"):
        sim.robot.ptu.look_at_object("lamb").result()
    with pytest.raises(MorseServiceFailed):
        sim.robot.ptu.look_at_point(math.nan, 0.0, 0.0).result()
    assert sim.robot.ptu.get_pan_tilt().result() == [0.0, 0.0]


def test_a_new_call_preempts_and_a_cancelled_one_stays(simulate):
    sim = load(simulate)
    first = sim.robot.ptu.set_pan_tilt(3.0, 0.0)
    sim.step(30)
    second = sim.robot.ptu.look_at_point(1.0, -20.0, 0.9)
    with pytest.raises(MorseServicePreempted):
        first.result(1.0)
    sim.step(15)
    second.cancel()
    with pytest.raises(MorseServicePreempted):
        second.result(1.0)
    here = sim.robot.ptu.get_pan_tilt().result()
    sim.step(60)
    assert sim.robot.ptu.get_pan_tilt().result() == pytest.approx(here, abs=0.02)


def test_it_takes_the_shorter_way(simulate):
    sim = load(simulate)
    sim.robot.ptu.set_pan_tilt(3.0, 0.0).result(10.0)
    begun = sim.time()
    sim.robot.ptu.set_pan_tilt(-3.0, 0.0).result(10.0)
    assert sim.time() - begun < 0.5


def test_manual_leaves_the_joints_alone(simulate):
    sim = load(simulate, "ptu.properties(Manual=True)")
    sim.robot.ptu.publish({"pan": 1.0})
    sim.step(60)
    assert sim.robot.ptu.get_pan_tilt().result() == [0.0, 0.0]


def test_saved_reset_and_restarted(simulate):
    sim = load(simulate)
    sim.robot.ptu.publish({"pan": 2.0, "tilt": 0.5})
    sim.step(30)
    state = sim.save()
    sim.step(30)
    later = eye(sim)
    sim.restore(state)
    sim.step(30)
    assert eye(sim) == later
    sim.restart()
    assert sim.robot.ptu.get_pan_tilt().result() == [0.0, 0.0]


def test_two_units_on_one_robot_turn_by_themselves(simulate):
    sim = load(simulate, "other = PTU('other')\nrobot.append(other)")
    sim.robot.other.set_pan_tilt(1.0, 0.0).result(5.0)
    assert sim.robot.ptu.get_pan_tilt().result() == [0.0, 0.0]
    assert sim.robot.other.get_pan_tilt().result() == pytest.approx([1.0, 0.0], abs=0.011)
