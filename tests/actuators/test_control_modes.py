"""The control mode of motors, changed while the simulation runs."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import morse
from morse.builder import Armature, ArmaturePose, Robot
from morse.core.kinds import bind
from pymorse import MorseServicePreempted

#: a wheel about the vertical axis: no weight acts on it
INERTIA = 0.2
ROBOT = f"""<robot name="table">
  <link name="world"/>
  <link name="disc"><inertial><mass value="4"/>
    <inertia ixx="0.1" iyy="0.1" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="slider"><inertial><origin xyz="0.2 0 0"/><mass value="0.5"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="world"/><child link="disc"/><origin xyz="0 0 1"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="slide" type="prismatic"><parent link="world"/><child link="slider"/><origin xyz="0 3 1"/>
    <axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="0" velocity="0"/></joint>
</robot>"""
SCENE = """
from morse.builder import *
table = Robot({file!r})
arm = Armature(armature_name='table_joints')
{more}
table.append(arm)
joints = ArmaturePose()
arm.append(joints)
env = Environment('empty')
"""


@pytest.fixture
def script(tmp_path: Path) -> Path:
    (tmp_path / "table.urdf").write_text(ROBOT)
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "table.urdf"), more=""))
    return script


@pytest.fixture
def sim(script: Path) -> Iterator[morse.Simulation]:
    with morse.load(script) as loaded:
        yield loaded


def speed(sim) -> float:
    return sim.table.arm.joints.get_velocities().result()["turn"]


def test_a_motor_that_gets_a_torque_accelerates_its_load(sim) -> None:
    arm = sim.table.arm
    arm.set_control("effort", ["turn"]).result()
    arm.publish({"turn": 0.1})
    sim.step(2)
    before = speed(sim)
    sim.step(60)
    # T = I a, without the rotor of the motor that held a position
    assert speed(sim) - before == pytest.approx(0.1 / INERTIA, rel=1e-3)
    assert arm.get_controls().result() == {"turn": "effort", "slide": "position"}


def test_modes_follow_each_other(sim) -> None:
    arm = sim.table.arm
    arm.set_control("velocity").result()
    arm.publish({"turn": 0.8})
    sim.step(60)
    assert speed(sim) == pytest.approx(0.8, abs=1e-3)
    arm.set_control("effort", ["turn"]).result()
    sim.step(30)
    assert speed(sim) == pytest.approx(0.8, abs=1e-3), "without a torque it goes on"
    here = arm.joints.get()["turn"]
    arm.set_control("position", ["turn"]).result()
    sim.step(120)
    # the disc is stopped near the place where its motor began to hold it
    assert speed(sim) == pytest.approx(0.0, abs=1e-6)
    assert arm.joints.get()["turn"] == pytest.approx(here, abs=0.02)
    arm.rotate("turn", 1.5).result(5.0)
    assert arm.get_controls().result() == {"turn": "position", "slide": "velocity"}


def test_the_property_changes_all_motors(sim) -> None:
    arm = sim.table.arm
    arm.set_property("Control", "effort").result()
    assert set(arm.get_controls().result().values()) == {"effort"}
    arm.set_property("Control", "").result()
    assert set(arm.get_controls().result().values()) == {"position"}
    arm.set_control("velocity").result()
    assert arm.get_properties().result()["properties"]["Control"][0] == "velocity"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["torque"], "position.*velocity.*effort"),
        (["effort", ["trun"]], "no joint 'trun'.*'turn'"),
        (["effort", "turn"], "a list"),
        (["effort", [["turn"]]], "no joint"),
    ],
)
def test_mistakes_are_named_and_change_nothing(sim, arguments, words) -> None:
    with pytest.raises(Exception, match=words):
        sim.table.arm.set_control(*arguments).result()
    assert set(sim.table.arm.get_controls().result().values()) == {"position"}


def test_motions_need_a_position(sim) -> None:
    arm = sim.table.arm
    turning = arm.rotate("turn", 2.0, 0.1)
    sim.step(5)
    arm.set_control("velocity", ["turn"]).result()
    with pytest.raises(MorseServicePreempted):
        turning.result(1.0)
    for call in (
        lambda: arm.rotate("turn", 1.0),
        lambda: arm.trajectory({"points": [{"positions": [0.0, 0.0], "time_from_start": 1.0}]}),
    ):
        with pytest.raises(Exception, match="controlled by velocity, not by position"):
            call().result(1.0)


def test_an_armature_without_motors_refuses(script: Path) -> None:
    script.write_text(
        script.read_text().replace("table.append(arm)", "arm.properties(Dynamic=False)\ntable.append(arm)")
    )
    with morse.load(script) as sim, pytest.raises(Exception, match="Dynamic to True"):
        sim.table.arm.set_control("effort").result()


def test_modes_are_saved_restored_reset_and_repeated(script: Path) -> None:
    with morse.load(script) as one, morse.load(script) as other:
        with one.record_inputs() as journal:
            one.table.arm.set_control("velocity", ["turn"]).result()
            one.table.arm.publish({"turn": 0.5})
            one.step(20)
        state = one.save()
        one.step(40)
        wanted = one.state_hash()
        other.replay(journal)
        other.step(40)
        assert other.state_hash() == wanted
        other.table.arm.set_control("effort").result()
        other.step(10)
        other.restore(state)
        other.step(40)
        assert other.state_hash() == wanted
        assert other.table.arm.get_controls().result() == {"turn": "velocity", "slide": "position"}


def test_a_reset_moves_the_joints_and_keeps_the_modes(sim) -> None:
    arm = sim.table.arm
    arm.set_control("velocity", ["turn"]).result()
    arm.publish({"turn": 0.5})
    sim.step(60)
    sim.reset()
    sim.step(2)
    assert arm.get_controls().result() == {"turn": "velocity", "slide": "position"}
    assert arm.joints.get()["turn"] == pytest.approx(0.0, abs=0.02)
    arm.publish({"turn": 0.6})
    sim.step(60)
    assert speed(sim) == pytest.approx(0.6, abs=1e-3)


def test_modes_stay_when_other_robots_come_and_go(sim, script: Path) -> None:
    def second() -> Robot:
        robot = Robot(str(script.parent / "table.urdf"))
        motors = Armature("motors", armature_name="table_joints")
        robot.append(motors)
        motors.append(ArmaturePose("state"))
        return robot

    sim.table.arm.set_control("velocity", ["turn"]).result()
    sim.table.arm.publish({"turn": 0.5})
    sim.step(30)
    sim.spawn("second", second, position=(0.0, 9.0, 0.0))
    sim.step(30)
    assert speed(sim) == pytest.approx(0.5, abs=1e-3)
    assert set(sim.second.motors.get_controls().result().values()) == {"position"}
    sim.delete("second")
    sim.step(30)
    assert speed(sim) == pytest.approx(0.5, abs=1e-3)


def test_messages_set_what_the_motor_controls(sim) -> None:
    arm = sim.context.component("table.arm")
    (bound,) = bind(arm)
    sim.table.arm.set_control("velocity", ["turn"]).result()
    fields, remark = bound.scatter({"position": [0.3, 0.4], "velocity": [0.5, 0.0]})
    assert fields == {"turn": 0.5, "slide": 0.4}
    assert "turn" in remark, "the position of that joint has no effect"
    fields, remark = bound.scatter({"velocity": [float("nan"), 0.0]})
    assert (fields, remark) == ({}, None)
