"""The odometry sensor at its three levels."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.builder import Environment, Robot
from morse.simulation.simulation import Simulation
from tests.kit.effort import examples

SCENE = """
robot = Morsy()
robot.translate(5, 2, 0)
robot.rotate(0, 0, math.pi / 2)
motion = MotionVW()
robot.append(motion)
odometry = Odometry()
robot.append(odometry)
odometry.level("{level}")
env = Environment("empty")
"""


def moved(simulate, level, v=0.5, w=0.3, seconds=2.0):
    made = simulate(SCENE.format(level=level), sockets=False)
    made.robot.motion.publish({"v": v, "w": w})
    total = 0.0
    for _ in range(round(seconds * 60)):
        made.step()
        total += made.context.component("robot.odometry").local_data.get("dS", 0.0)
    return made.context.component("robot.odometry").local_data, total


def test_integrated_starts_at_zero_whatever_the_pose(simulate):
    data, _ = moved(simulate, "integrated", v=0.0, w=0.0)
    # it settles by 14 mm onto the ground
    assert [data[f] for f in ("x", "y", "yaw")] == pytest.approx([0, 0, 0], abs=1e-3)


def test_integrated_gives_pose_and_speeds_in_the_start_frame(simulate):
    data, _ = moved(simulate, "integrated")
    radius = 0.5 / 0.3
    expected = [radius * math.sin(0.6), radius * (1 - math.cos(0.6)), 0.6]
    assert [data[f] for f in ("x", "y", "yaw")] == pytest.approx(expected, abs=5e-3)
    assert data["vx"] == pytest.approx(0.5, abs=2e-3)
    assert data["wz"] == pytest.approx(0.3, abs=2e-3)
    assert [data["vz"], data["wx"], data["wy"]] == pytest.approx([0, 0, 0], abs=1e-2)


def test_differential_adds_up_to_the_displacement(simulate):
    made = simulate(SCENE.format(level="differential"), sockets=False)
    made.robot.motion.publish({"v": 1.0, "w": 0.5})
    x = y = yaw = 0.0
    for _ in range(120):
        made.step()
        data = made.context.component("robot.odometry").local_data
        x, y, yaw = x + data["dx"], y + data["dy"], yaw + data["dyaw"]
    assert (x, y, yaw) == pytest.approx((2 * math.sin(1.0), 2 * (1 - math.cos(1.0)), 1.0), abs=0.01)


def test_raw_measures_the_length_of_the_way(simulate):
    _, total = moved(simulate, "raw", v=0.5, w=0.3, seconds=4.0)
    assert total == pytest.approx(2.0, abs=0.03)


@pytest.mark.parametrize(
    ("level", "fields"),
    [
        ("raw", {"dS"}),
        ("differential", {"dx", "dy", "dz", "dyaw", "dpitch", "droll"}),
        ("integrated", {"x", "y", "z", "yaw", "pitch", "roll", "vx", "vy", "vz", "wx", "wy", "wz"}),
    ],
)
def test_each_level_has_its_fields_only(simulate, level, fields):
    data, _ = moved(simulate, level, seconds=0.1)
    assert set(data) - {"timestamp"} == fields


# -- sensors that measure when they are read have the data of sensors that are read in each tick ---

#: a body that falls and rolls, with a leg on a hinge that swings and touches the floor
_TUMBLER = """
<mujoco model="tumbler">
  <option cone="{cone}"/>
  <worldbody>
    <body name="trunk" pos="0 0 0.6" euler="0 20 10">
      <freejoint/>
      <geom type="box" size="0.2 0.15 0.1" mass="3"/>
      <site name="inside"/>
      <body name="leg" pos="0.15 0 -0.1">
        <joint name="hip" type="hinge" axis="0 1 0" range="-60 60" damping="0.05"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="0.4"/>
        <site name="foot" pos="0 0 -0.3" size="0.05"/>
      </body>
    </body>
  </worldbody>
  <sensor>
    <accelerometer name="imu" site="inside"/>
    <velocimeter name="speed" site="inside"/>
    <force name="load" site="foot"/>
    <touch name="contact" site="foot"/>
  </sensor>
</mujoco>
"""


def _load(folder: Path, cone: str) -> Simulation:
    path = folder / f"{cone}.xml"
    path.write_text(_TUMBLER.format(cone=cone))

    def scene() -> None:
        robot = Robot(str(path), name="robot")
        robot.translate(z=0.3)
        Environment("empty")

    return morse.load(scene)


def _data(simulation: Simulation) -> dict[str, dict[str, Any]]:
    return {name: dict(sensor.local_data) for name, sensor in simulation.context.components.items()}


@pytest.mark.parametrize("cone", ["elliptic", "pyramidal"])
def test_what_is_read_late_is_what_was_measured(tmp_path: Path, cone: str) -> None:
    with _load(tmp_path, cone) as often, _load(tmp_path, cone) as seldom:
        touches = 0
        for tick in range(240):
            often.step()
            now = _data(often)
            touches += any(data.get("touching") for data in now.values())
            seldom.step()
            if tick % 37 == 36:
                assert _data(seldom) == now
                assert seldom.state_hash() == often.state_hash()
        assert 0 < touches < 240


@settings(max_examples=examples(5), deadline=None)
@given(steps=st.lists(st.integers(1, 90), min_size=1, max_size=4))
def test_several_ticks_at_once_give_the_data_of_single_ticks(
    tmp_path_factory: pytest.TempPathFactory, steps: list[int]
) -> None:
    folder = tmp_path_factory.mktemp("models")
    with _load(folder, "elliptic") as single, _load(folder, "elliptic") as together:
        for count in steps:
            for _ in range(count):
                single.step()
                _data(single)
            together.step(count)
            assert together.state_hash() == single.state_hash()
            assert _data(together) == _data(single)


def test_unread_forces_cost_no_call_for_each_sensor(tmp_path: Path) -> None:
    with _load(tmp_path, "elliptic") as simulation:
        simulation.step(60)
        sensors = simulation.context.components.values()
        unread = {type(sensor).__name__ for sensor in sensors if sensor._in_rows is not None}
        assert unread >= {"IMU", "Velocity", "ForceTorqueSensor", "ContactForce"}
