"""Arms of Blender files with masses, and arms of URDF files without: the script decides."""

import math

import pytest
from arms import SCENE, place, values

MASSES = "arm.properties(Dynamic=True)"


def test_an_arm_of_a_blender_file_holds_its_pose_by_its_motors(simulate) -> None:
    sim = simulate(SCENE.format(before="", more=MASSES), sockets=False)
    sim.step(60)
    assert values(sim) == pytest.approx([0.0] * 7, abs=5e-3)
    efforts = sim.robot.arm.joints.get_efforts().result()
    assert len(efforts) == 7
    upright = place(sim)
    sim.robot.arm.set_rotation("kuka_2", math.pi / 2).result()
    sim.step(180)
    assert values(sim)[1] == pytest.approx(math.pi / 2, abs=5e-3)
    # stretched out, gravity pulls at the second joint
    assert abs(sim.robot.arm.joints.get_efforts().result()["kuka_2"]) > 10.0
    assert math.dist(place(sim), upright) > 0.5


def test_an_arm_of_a_blender_file_has_no_masses_otherwise(simulate) -> None:
    sim = simulate(SCENE.format(before="", more=""), sockets=False)
    sim.step(2)
    assert sim.robot.arm.joints.get_efforts().result() == {}
    assert sim.robot.arm.get_controls().result() == {}


def test_a_free_arm_falls(simulate) -> None:
    sim = simulate(SCENE.format(before="", more="arm.properties(Dynamic=True, Control='effort')"), sockets=False)
    sim.robot.arm.publish({f"kuka_{i}": (0.5 if i == 2 else 0.0) for i in range(1, 8)})
    sim.step(10)
    sim.robot.arm.publish({f"kuka_{i}": 0.0 for i in range(1, 8)})
    sim.step(240)
    assert place(sim)[2] < 0.9, "it does not stay upright"
    assert set(sim.robot.arm.get_controls().result().values()) == {"effort"}


@pytest.mark.parametrize("line", ["arm.control('torque')", "arm.control('effort', ['kuka_99'])"])
def test_mistakes_are_named(simulate, line: str) -> None:
    with pytest.raises(Exception, match=r"torque|no joint 'kuka_99'"):
        simulate(SCENE.format(before="", more=line), sockets=False)
