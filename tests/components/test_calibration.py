"""Values that old scripts rely on: the rest poses of robots, and their distances. The values are those of MORSE 1.4."""

import math

import pytest

WHEELED = """
robot = {robot}()
robot.rotate(z={yaw})
robot.translate(z=0.05)
motion = MotionVWDiff()
robot.append(motion)
pose = Pose()
robot.append(pose)
env = Environment("{world}")
"""
RAMP = 30  # ticks
WHEELED_ROBOTS = ("Pioneer3DX", "SegwayRMP400", "PatrolBot")


def pose_of(made):
    return dict(made.context.component("robot.pose").local_data)


@pytest.mark.parametrize("world", ["empty", "indoors-1/boxes", "sandbox"])
@pytest.mark.parametrize(
    ("robot", "height", "tolerance"),
    [("Pioneer3DX", 0.15, 0.04), ("SegwayRMP400", 0.20, 0.02), ("Morsy", 0.0, 0.003), ("ATRV", 0.10, 0.01)],
)
def test_robots_come_to_rest_where_they_did(simulate, robot, height, tolerance, world):
    made = simulate(
        f'''
robot = {robot}()
robot.translate(1, -2, 0.05)
pose = Pose()
robot.append(pose)
env = Environment("{world}")
''',
        sockets=False,
    )
    made.sleep(3.0)
    pose = pose_of(made)
    assert pose["z"] == pytest.approx(height, abs=tolerance)
    for name, expected in (("x", 1.0), ("y", -2.0), ("yaw", 0.0), ("pitch", 0.0), ("roll", 0.0)):
        assert pose[name] == pytest.approx(expected, abs=0.02)


def test_the_red_box_ends_where_it_did(simulate):
    made = simulate('robot = ATRV()\nenv = Environment("indoors-1/boxes")', sockets=False)
    made.sleep(3.0)
    robot = made.context.world.game_object("robot")
    hit, point, _ = robot.rayCast((-7.5, 0, 0), (-7.5, 0, 4.0), 0.0)
    assert hit.name == "RedBox"
    assert point.z == pytest.approx(1.86, abs=0.01)


@pytest.mark.parametrize(("friction", "distance"), [(0.0, 2.0), (5.0, 1.4)])
def test_friction_is_felt_within_each_tick(simulate, friction, distance):
    made = simulate(
        f"""
robot = ATRV()
robot.set_friction({friction})
motion = MotionVW()
robot.append(motion)
pose = Pose()
robot.append(pose)
env = Environment("empty")
""",
        sockets=False,
    )
    made.sleep(1.0)
    start = pose_of(made)["x"]
    made.robot.motion.publish({"v": 1.0, "w": 0.0})
    made.sleep(2.0)
    assert pose_of(made)["x"] - start == pytest.approx(distance, abs=0.1)


class Course:
    """Drives a wheeled robot, and integrates the ideal twist in parallel."""

    def __init__(self, simulate, robot, yaw=0.0, world="empty"):
        self.made = simulate(WHEELED.format(robot=robot, yaw=yaw, world=world), sockets=False)
        self.made.sleep(1.0)
        pose = pose_of(self.made)
        self.start = self.x, self.y, self.yaw = pose["x"], pose["y"], pose["yaw"]
        self.v = self.w = 0.0

    def drive(self, v, w, ticks=1):
        for _ in range(ticks):
            self.made.robot.motion.publish({"v": v, "w": w})
            self.made.step(1)
            middle = self.yaw + w / 120
            self.x, self.y, self.yaw = (
                self.x + v / 60 * math.cos(middle),
                self.y + v / 60 * math.sin(middle),
                self.yaw + w / 60,
            )
        self.v, self.w = v, w

    def change_to(self, v, w):
        before = self.v, self.w
        for step in range(1, RAMP + 1):
            share = step / RAMP
            self.drive(*(a + share * (b - a) for a, b in zip(before, (v, w), strict=True)))

    def errors(self):
        """Distance (m) and angle (rad) to the ideal twist."""
        pose = pose_of(self.made)
        return math.hypot(pose["x"] - self.x, pose["y"] - self.y), abs(
            math.remainder(pose["yaw"] - self.yaw, 2 * math.pi)
        )


@pytest.mark.parametrize("yaw", [0.0, 2.0, -math.pi / 2])
@pytest.mark.parametrize("robot", WHEELED_ROBOTS)
@pytest.mark.parametrize(("v", "w"), [(1.0, -math.pi / 4), (1.0, 0.0), (0.0, math.pi / 4), (-0.5, 0.5)])
def test_wheeled_robots_follow_the_twist(simulate, robot, yaw, v, w):
    course = Course(simulate, robot, yaw)
    course.change_to(v, w)
    course.drive(v, w, 120)
    course.change_to(0.0, 0.0)
    distance, angle = course.errors()
    assert distance < 0.15
    assert angle < 0.15


@pytest.mark.parametrize("robot", WHEELED_ROBOTS)
def test_a_sudden_command_is_followed_as_well_as_friction_allows(simulate, robot):
    course = Course(simulate, robot)
    course.drive(1.0, -math.pi / 4, 120)
    distance, angle = course.errors()
    assert distance < 0.15
    assert angle < 0.15


@pytest.mark.parametrize("robot", WHEELED_ROBOTS)
@pytest.mark.parametrize("w", [0.0, math.pi / 4])
def test_forward_and_backward_ends_at_the_start(simulate, robot, w):
    course = Course(simulate, robot, yaw=1.0)
    for sign in (1, -1):
        course.change_to(sign * 1.0, sign * w)
        course.drive(sign * 1.0, sign * w, 120)
        course.change_to(0.0, 0.0)
    course.drive(0.0, 0.0, 30)
    pose = pose_of(course.made)
    x, y, yaw = course.start
    assert math.hypot(pose["x"] - x, pose["y"] - y) < 0.15
    assert math.remainder(pose["yaw"] - yaw, 2 * math.pi) == pytest.approx(0.0, abs=0.15)


@pytest.mark.parametrize("robot", WHEELED_ROBOTS)
def test_a_robot_on_wheels_stops_at_a_wall_and_gets_away_from_it(simulate, robot):
    course = Course(simulate, robot, yaw=math.pi / 2, world="indoors-1/boxes")
    course.made.context.world.game_object("robot").worldPosition = (2.0, 12.0, 0.25)
    course.drive(1.0, 0.0, 240)
    # the wall is at y = 14
    front = pose_of(course.made)["y"]
    assert 13.0 < front < 14.0
    course.drive(-1.0, 0.0, 120)
    assert pose_of(course.made)["y"] < front - 1.5
    assert pose_of(course.made)["z"] < 0.25
