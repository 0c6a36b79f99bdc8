"""The fingers of a gripper close around what is held, and open when it is released."""

import pytest

SCENE = """
robot = FakeRobot()
robot.translate(z=1.0)
gripper = Gripper()
robot.append(gripper)
{things}
"""
#: a box between the fingers, its half sizes in metres; the fingers reach along +Z
THING = """
thing = Cube('thing')
thing.scale = ({x}, {y}, {z})
thing.location = (0.0, {at}, 1.11)
thing.properties(Graspable=True)
thing._bpy_object.game.physics_type = 'RIGID_BODY'
"""


def pads(sim):
    """Y of the inner sides of the left and the right pad in the frame of the gripper, m."""
    objects = sim.context.world.objects_by_name
    names = {name.rpartition(".")[2]: name for name in objects}
    left, right = (objects[names[pad]].worldPosition[1] for pad in ("pad1", "pad2"))
    return left - 0.0025, right + 0.0025


def settle(sim, grab):
    sim.context.component("robot.gripper").local_data["grab"] = grab
    sim.step(60)


def test_fingers_close_without_anything_between_them_and_open_again(simulate):
    sim = simulate(SCENE.format(things=""), sockets=False)
    sim.step()
    opened = pads(sim)
    assert opened == pytest.approx((0.0205, -0.0205), abs=1e-3)
    settle(sim, True)
    assert pads(sim) == pytest.approx((0.0, 0.0), abs=1e-3)
    settle(sim, False)
    assert pads(sim) == pytest.approx(opened, abs=1e-9)


@pytest.mark.parametrize("half", [0.005, 0.012])
def test_fingers_stop_at_the_sides_of_what_is_held(simulate, half):
    sim = simulate(SCENE.format(things=THING.format(x=0.01, y=half, z=0.01, at=0.003)), sockets=False)
    assert sim.robot.gripper.grab().result() == "thing"
    sim.step(60)
    assert pads(sim) == pytest.approx((half + 0.003, 0.003 - half), abs=2e-3)
    assert sim.robot.gripper.release().result() is True
    sim.step(60)
    assert pads(sim) == pytest.approx((0.0205, -0.0205), abs=1e-3)


def test_fingers_stay_open_around_what_is_wide(simulate):
    sim = simulate(SCENE.format(things=THING.format(x=0.01, y=0.1, z=0.01, at=0.0)), sockets=False)
    settle(sim, True)
    assert sim.context.component("robot.gripper").held is not None
    assert pads(sim) == pytest.approx((0.0205, -0.0205), abs=1e-3)


def test_fingers_take_the_time_that_their_speed_says(simulate):
    sim = simulate(SCENE.format(things="gripper.properties(FingerSpeed=0.1)"), sockets=False)
    settle(sim, True)
    # 0.1 rad in a second, on a lever of 59 mm ahead of the hinge
    left, _ = pads(sim)
    assert 0.0205 - left == pytest.approx(0.1 * 0.059, rel=0.1)


def test_a_saved_state_holds_the_fingers(simulate):
    sim = simulate(SCENE.format(things=THING.format(x=0.01, y=0.01, z=0.01, at=0.0)), sockets=False)
    settle(sim, False)
    sim.context.component("robot.gripper").local_data["grab"] = True
    sim.step(8)
    state, now = sim.save(), pads(sim)
    sim.step(30)
    later = sim.state_hash()
    assert pads(sim) != now
    sim.restore(state)
    assert pads(sim) == pytest.approx(now, abs=1e-12)
    sim.step(30)
    assert sim.state_hash() == later
