"""A robot that is held at a pose, or moved to another one, shows the forces and accelerations of a real one."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import morse

GRAVITY, HAND = 9.81, 0.5
_INERTIA = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'
ROBOT = f"""<robot name="bot">
<link name="base"><inertial><mass value="20"/>{_INERTIA.format(1)}</inertial>
  <collision><geometry><box size=".6 .4 .2"/></geometry></collision></link>
<link name="arm"><inertial><origin xyz=".3 0 0"/><mass value="2"/>{_INERTIA.format(0.05)}</inertial></link>
<link name="hand"><inertial><mass value="{HAND}"/>{_INERTIA.format(0.001)}</inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 .3"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" effort="100" velocity="3"/></joint>
<joint name="wrist" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz=".6 0 0"/></joint>
<gazebo reference="wrist"><sensor name="ft" type="force_torque"><update_rate>60</update_rate></sensor></gazebo>
<gazebo reference="hand"><sensor name="imu" type="imu"><update_rate>60</update_rate></sensor></gazebo>
</robot>"""


@pytest.fixture
def scene(tmp_path: Path) -> Callable[[], None]:
    """A robot that an active Teleport holds, with an arm whose motor holds its position."""
    (tmp_path / "bot.urdf").write_text(ROBOT)

    def script() -> None:
        from morse.builder import Environment, Robot, Teleport

        robot = Robot(str(tmp_path / "bot.urdf"))
        robot.name = "robot"
        robot.translate(z=0.1)
        robot.append(Teleport("teleport"))
        Environment("empty", fastmode=True)

    return script


def test_the_weight_of_a_hand_is_that_of_a_robot_at_rest(scene: Callable[[], None]) -> None:
    with morse.load(scene) as sim:
        sim.step(60)
        assert sim["robot"].ft.get_local_data().result()["force"][2] == pytest.approx(-HAND * GRAVITY, abs=0.005)


# above the floor, on it, and pressed into it
@pytest.mark.parametrize("height", [1.0, 0.1, 0.05])
def test_a_teleport_shows_no_shock(scene: Callable[[], None], height: float) -> None:
    pitch = 0.3 if height == 1.0 else 0.0
    with morse.load(scene) as sim:
        sim.step(60)
        sim["robot"].teleport.publish({"x": 2.0, "y": 1.0, "z": height, "yaw": 0.5, "pitch": pitch, "roll": 0.0})
        for _ in range(6):
            sim.step(1)
            force = np.array(sim["robot"].ft.data["force"])
            imu = sim["robot"].imu.data
            # the arm sags by less than before, which moves the hand a little
            assert np.linalg.norm(force) == pytest.approx(HAND * GRAVITY, rel=0.02)
            assert np.linalg.norm(imu["linear_acceleration"]) == pytest.approx(GRAVITY, abs=0.2)
            assert np.abs(imu["angular_velocity"]).max() < 0.01
        sim.step(60)
        force = sim["robot"].ft.data["force"]
        weight = HAND * GRAVITY
        assert force == pytest.approx([weight * math.sin(pitch), 0.0, -weight * math.cos(pitch)], abs=0.02)


def test_a_released_robot_falls_freely(scene: Callable[[], None]) -> None:
    with morse.load(scene) as sim:
        sim["robot"].teleport.publish({"z": 3.0})
        sim.step(30)
        assert sim.world.game_object("robot").world_pose()[0][2] == pytest.approx(3.0, abs=1e-9)
        sim.rpc("simulation", "deactivate", "robot.teleport")
        sim.step(2)
        start, speed = (
            sim.world.game_object("robot").world_pose()[0][2],
            sim.world.game_object("robot").velocity()[0][2],
        )
        sim.step(12)
        fallen = speed * 0.2 - 0.5 * GRAVITY * 0.2**2
        assert sim.world.game_object("robot").world_pose()[0][2] - start == pytest.approx(fallen, abs=0.01)
