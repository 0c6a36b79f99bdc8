"""Motion actuators, measured by the pose sensor."""

import math

import pytest

ROBOT = """
robot = Morsy()
robot.translate({x}, {y}, 0)
robot.rotate(0, 0, {yaw})
motion = {motion}
robot.append(motion)
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


def driven(simulate, motion, *, x=0.0, y=0.0, yaw=0.0):
    made = simulate(ROBOT.format(motion=motion, x=x, y=y, yaw=yaw), sockets=False)
    made.sleep(0.5)  # settle
    return made


@pytest.mark.parametrize("control", ["Velocity", "Position"])
@pytest.mark.parametrize(("v", "w"), [(1.0, 0.0), (0.5, 0.3), (-0.5, 0.4), (0.0, 1.0)])
def test_v_omega_drives_the_circle(simulate, control, v, w):
    made = driven(simulate, f"MotionVW(); motion.properties(ControlType='{control}')", x=2, y=-3, yaw=0.7)
    made.robot.motion.publish({"v": v, "w": w})
    made.sleep(3.0)
    data = made.context.component("robot.pose").local_data
    turned = w * 3.0
    ahead, left = (v * 3.0, 0.0) if w == 0 else (v / w * math.sin(turned), v / w * (1 - math.cos(turned)))
    c, s = math.cos(0.7), math.sin(0.7)
    assert (data["x"], data["y"]) == pytest.approx((2 + c * ahead - s * left, -3 + s * ahead + c * left), abs=5e-3)
    assert math.remainder(data["yaw"] - 0.7 - turned, 2 * math.pi) == pytest.approx(0, abs=5e-3)
    assert data["z"] == pytest.approx(0.0, abs=2e-3)


def test_v_omega_services(simulate):
    made = driven(simulate, "MotionVW()")
    made.context.component("robot.motion").set_speed(0.4, 0.2)
    assert made.context.component("robot.motion").local_data == {"v": 0.4, "w": 0.2}
    made.context.component("robot.motion").stop()
    assert made.context.component("robot.motion").local_data == {"v": 0.0, "w": 0.0}


def test_xy_omega_moves_sideways(simulate):
    made = driven(simulate, "MotionXYW()", yaw=math.pi / 2)
    made.robot.motion.publish({"x": 0.3, "y": 0.5, "w": 0.0})
    made.sleep(2.0)
    data = made.context.component("robot.pose").local_data
    assert (data["x"], data["y"]) == pytest.approx((-1.0, 0.6), abs=5e-3)


def test_the_last_command_is_applied_every_tick(simulate):
    made = driven(simulate, "MotionVW()")
    made.robot.motion.publish({"v": 1.0})
    made.sleep(1.0)
    made.robot.motion.publish({"v": 0.0})
    made.sleep(1.0)
    assert made.context.component("robot.pose").local_data["x"] == pytest.approx(1.0, abs=0.02)


def test_an_inactive_actuator_does_nothing(simulate):
    made = driven(simulate, "MotionVW()")
    made.context.component("robot.motion").active = False
    made.robot.motion.publish({"v": 1.0})
    made.sleep(1.0)
    assert made.context.component("robot.pose").local_data["x"] == pytest.approx(0.0, abs=1e-3)


WHEELED = """
robot = {robot}()
motion = MotionVWDiff()
robot.append(motion)
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


# the height of the origin above the ground, and the accuracy of the rotation
@pytest.mark.parametrize(
    ("robot", "height", "exactness"),
    [("Pioneer3DX", 0.15, 0.04), ("PatrolBot", 0.17, 0.04), ("SegwayRMP400", 0.2, 0.04)],
)
def test_wheels_drive_and_turn(simulate, robot, height, exactness):
    made = simulate(WHEELED.format(robot=robot), sockets=False)
    made.sleep(1.0)
    rest = dict(made.context.component("robot.pose").local_data)
    assert rest["z"] == pytest.approx(height, abs=5e-3)
    assert math.hypot(rest["x"], rest["y"]) < 5e-3
    made.robot.motion.publish({"v": 0.4, "w": 0.0})
    made.sleep(2.0)
    straight = dict(made.context.component("robot.pose").local_data)
    assert straight["x"] - rest["x"] == pytest.approx(0.8, abs=0.05)
    assert abs(straight["y"]) < 0.02
    assert abs(straight["yaw"]) < 0.01
    for rate in (0.5, -1.0):
        made.robot.motion.publish({"v": 0.0, "w": rate})
        made.sleep(0.5)
        before = made.context.component("robot.pose").local_data["yaw"]
        made.sleep(1.0)
        turned = math.remainder(made.context.component("robot.pose").local_data["yaw"] - before, 2 * math.pi)
        assert turned == pytest.approx(rate, rel=exactness)


def test_four_wheels_slide_steadily_in_a_turn_and_stop(simulate):
    made = simulate(WHEELED.format(robot="SegwayRMP400"), sockets=False)
    made.sleep(0.5)
    made.robot.motion.publish({"v": 0.0, "w": 0.5})
    made.sleep(1.0)
    rates, yaw = [], made.context.component("robot.pose").local_data["yaw"]
    for _ in range(60):
        made.step()
        now = made.context.component("robot.pose").local_data["yaw"]
        rates.append((now - yaw) * 60.0)
        yaw = now
    # without stick-slip
    assert max(rates) - min(rates) < 0.05
    made.robot.motion.publish({"v": 0.0, "w": 0.0})
    made.sleep(0.5)
    yaw = made.context.component("robot.pose").local_data["yaw"]
    made.sleep(0.5)
    assert made.context.component("robot.pose").local_data["yaw"] == pytest.approx(yaw, abs=1e-3)


def test_wheels_are_needed_for_wheel_speeds(simulate):
    with pytest.raises(Exception, match=r"robot\.motion.*no wheels.*MotionVW"):
        driven(simulate, "MotionVWDiff()")


def test_the_atrv_rests_at_a_tenth_of_a_metre(simulate):
    made = simulate(
        """
robot = ATRV()
pose = Pose()
robot.append(pose)
env = Environment("empty")
""",
        sockets=False,
    )
    made.sleep(2.0)
    data = made.context.component("robot.pose").local_data
    assert data["z"] == pytest.approx(0.10, abs=2e-3)
    assert (data["x"], data["y"], data["yaw"]) == pytest.approx((0, 0, 0), abs=2e-3)
