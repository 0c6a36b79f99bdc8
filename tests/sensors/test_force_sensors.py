"""Forces on feet and in joints: weights, whatever the engine does with bodies at rest."""

from pathlib import Path

import pytest

import morse

GRAVITY, MASS = 9.81, 12.0
WALKER = Path(morse.__file__).parent / "data" / "examples" / "legs" / "walker.urdf"
FEET = ("front_left", "front_right", "rear_left", "rear_right")
SCENE = f"""
walker = Robot(r"{WALKER}")
walker.translate(z=0.5)
for leg in {FEET}:
    walker.append(ContactForce(leg), leg + "_shin")
walker.append(ContactForce("total"))
walker.append(ForceTorqueSensor("hip"), "front_left_thigh")
load = Cube("load")
load.scale = (0.05, 0.05, 0.05)
load.translate(0.0, 0.0, 0.65)
load._bpy_object.game.physics_type = "RIGID_BODY"
load._bpy_object.game.mass = 2.0
"""


def test_the_forces_on_the_feet_are_the_weight(simulate):
    sim = simulate(SCENE, sockets=False)
    for seconds in (2, 10):  # later on, the bodies at rest sleep
        sim.step(60 * seconds)
        feet = {leg: getattr(sim.walker, leg).get() for leg in FEET}
        forces = [foot["force"] for foot in feet.values()]
        assert [sum(axis) for axis in zip(*forces, strict=True)] == pytest.approx(
            [0.0, 0.0, (MASS + 2.0) * GRAVITY], abs=0.01
        )
        assert all(foot["touching"] and foot["objects"].endswith("Ground") for foot in feet.values())
        # the floor below, and the load above
        assert sim.walker.total.get()["force"][2] == pytest.approx(MASS * GRAVITY, rel=1e-3)
        assert "load" in sim.walker.total.get()["objects"]
        # thigh and shin hang in the hip and are carried by the foot: what the leg does to the trunk
        hip = sim.walker.hip.get()["force"]
        assert sum(value**2 for value in hip) ** 0.5 == pytest.approx(forces[0][2] - 1.0 * GRAVITY, abs=0.02)


def test_nothing_presses_on_feet_in_the_air(simulate):
    sim = simulate(SCENE.replace("z=0.5", "z=3.0").replace("0.65)", "9.0)"), sockets=False)
    sim.step(12)
    assert [getattr(sim.walker, leg).get()["force"] for leg in FEET] == [[0.0, 0.0, 0.0]] * 4
    assert not sim.walker.total.get()["touching"]
    # all parts fall together
    assert sim.walker.hip.get()["force"] == pytest.approx([0.0, 0.0, 0.0], abs=1.0)


def test_forces_are_measured_after_an_object_was_added(simulate):
    sim = simulate(SCENE, sockets=False)
    sim.step(120)
    sim.spawn("other", "ATRV", position=[5.0, 0.0, 0.1])
    sim.step(120)
    assert sum(getattr(sim.walker, leg).get()["force"][2] for leg in FEET) == pytest.approx(14.0 * GRAVITY, rel=1e-3)


def test_a_sensor_of_torques_without_a_joint_says_so(simulate, caplog):
    sim = simulate("robot = FakeRobot()\nrobot.append(ForceTorqueSensor('load'))", sockets=False)
    sim.step(2)
    assert "robot.load: no joint of the physics carries it, and it measures 0" in caplog.text
    assert sim.robot.load.get()["force"] == [0.0, 0.0, 0.0]
