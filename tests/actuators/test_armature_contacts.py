"""An arm in the physics: it pushes obstacles, and does not affect other objects."""

import math

import pytest

SCENE = """
robot = {robot}
arm = KukaLWR()
arm.translate(z={height})
robot.append(arm)
pose = Pose()
robot.append(pose)
box = Cube('box')
box.scale = (0.2, 0.2, 0.15)
box.location = (0.75, {y}, 0.15)
box._bpy_object.game.physics_type = 'RIGID_BODY'
box._bpy_object.game.use_collision_bounds = True
box._bpy_object.game.collision_bounds_type = 'BOX'
{more}
"""
ROBOTS = {"FakeRobot()": 0.0, "ATRV()": -0.1}


def place(sim, name="box"):
    return list(sim.context.world.objects_by_name[name].worldPosition)


@pytest.mark.parametrize("robot", ROBOTS)
def test_an_arm_pushes_a_box_that_sleeps(simulate, robot):
    sim = simulate(SCENE.format(robot=robot, height=ROBOTS[robot], y=0.6, more=""), sockets=False)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.1).result()
    sim.step(120)
    assert place(sim) == pytest.approx([0.75, 0.6, 0.15], abs=0.01)
    # at 1.1 rad the arm has passed the initial position of the box: atan(0.6 / 0.75) = 0.67
    sim.robot.arm.rotate("kuka_1", 1.1, 0.4).result(10.0)
    x, y, _ = place(sim)
    # it was pushed to the left and out of reach of the arm, at a moderate speed
    assert math.atan2(y, x) > math.atan2(0.6, 0.75) + 0.1
    assert 0.15 < math.hypot(x - 0.75, y - 0.6) < 0.8


def test_a_robot_with_an_arm_at_rest_rests(simulate):
    sim = simulate(SCENE.format(robot="ATRV()", height=0.5, y=3.0, more=""), sockets=False)
    sim.robot.arm.set_rotations([0.3, -1.0, 0.0, 0.8]).result()
    sim.step(120)
    before = sim.robot.pose.get()
    sim.step(300)
    after = sim.robot.pose.get()
    for field in ("x", "y", "z", "yaw", "pitch", "roll"):
        assert after[field] == pytest.approx(before[field], abs=1e-6)


def test_an_arm_that_is_laid_down_shortens_the_reach_of_a_scanner_behind_it(simulate):
    scanner = "eye = FakeRobot()\neye.translate(x=-1.0, z=0.4)\nscan = Sick()\neye.append(scan)"
    sim = simulate(SCENE.format(robot="FakeRobot()", height=0.0, y=30.0, more=scanner), sockets=False)
    sim.step(10)
    ahead = sim.eye.scan.get()["range_list"][90]
    assert ahead == pytest.approx(1.0 - 0.06, abs=0.03), "the upright arm"
    sim.robot.arm.set_rotation("kuka_2", math.pi / 2).result()
    sim.step(10)
    # the arm is on the ray, 0.3105 m up and 0.12 m thick: the ray passes above its upper side
    assert sim.eye.scan.get()["range_list"][90] == pytest.approx(30.0)


def test_what_a_gripper_on_the_arm_holds_goes_along(simulate):
    more = """
box.properties(Graspable=True)
hand = Gripper()
hand.translate(z=1.31)
hand.properties(Distance=2.0, Angle=360.0)
arm.append(hand)
"""
    sim = simulate(SCENE.format(robot="FakeRobot()", height=0.0, y=0.0, more=more), sockets=False)
    sim.robot.arm.set_rotations([0.0, -1.2, 0.0, 0.7]).result()
    sim.step(120)
    assert sim.robot.arm.hand.grab().result() == "box"
    hand = sim.context.component("robot.arm.hand").bge_object
    offset = math.dist(hand.worldPosition, place(sim))
    before = place(sim)
    sim.robot.arm.rotate_joints({"kuka_1": 1.0, "kuka_2": -0.6}, 1.0).result(10.0)
    sim.step(2)
    x, y, z = place(sim)
    assert z > 0.4
    assert math.atan2(y, x) - math.atan2(before[1], before[0]) == pytest.approx(1.0, abs=1e-3)
    assert math.dist(hand.worldPosition, (x, y, z)) == pytest.approx(offset, abs=1e-3)


def test_a_saved_state_goes_on_with_the_same_contacts(simulate):
    sim = simulate(SCENE.format(robot="ATRV()", height=-0.1, y=0.6, more=""), sockets=False)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.1).result()
    sim.step(60)
    sim.robot.arm.publish({"kuka_1": 1.1})
    sim.step(50)
    state = sim.save()
    sim.step(60)
    there, code = place(sim), sim.state_hash()
    sim.restore(state)
    sim.step(60)
    assert place(sim) == there
    assert sim.state_hash() == code
    sim.restart()
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.1).result()
    sim.step(60)
    sim.robot.arm.publish({"kuka_1": 1.1})
    sim.step(110)
    assert place(sim) == there
