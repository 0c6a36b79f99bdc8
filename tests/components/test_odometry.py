"""The odometry sensor at its three levels."""

import math

import pytest

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
