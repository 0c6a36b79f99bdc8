"""Streams of users with message classes of their own, and the controller of arms, with a real node as the peer."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from master import master, need_ros, run, simulation

from morse.core.exceptions import MorseMiddlewareError
from morse.plugins.ros.own_classes import ROSPublisher

HERE = Path(__file__).parent
STREAMS = """
from geometry_msgs.msg import PointStamped, Twist
from std_msgs.msg import Float32, String

from morse.middleware.ros import ROSPublisher, ROSPublisherTF, ROSSubscriber


class Marked(ROSPublisher):
    ros_class = PointStamped
    default_frame_id = "/somewhere"

    def default(self, ci="unused"):
        point = PointStamped()
        point.header = self.get_ros_header()
        point.point.x, point.point.y, point.point.z = self.data["x"], self.data["y"], self.kwargs.get("height", 0.0)
        self.publish(point)


class Mounted(ROSPublisherTF):
    ros_class = PointStamped

    def default(self, ci="unused"):
        point = PointStamped()
        point.header = self.get_ros_header()
        self.publish_with_robot_transform(point)
        self.sendTransform((1.0, 2.0, 3.0), (0.0, 0.0, 1.0, 0.0), self.get_time(), "/child", "/parent")


class Steering(ROSSubscriber):
    ros_class = Twist

    def update(self, message):
        self.data["v"] = 2.0 * message.linear.x
        self.data["w"] = message.angular.z


class Broken(ROSPublisher):
    ros_class = String

    def default(self, ci="unused"):
        self.publish(Float32(1.0))
"""
#: no package of Debian has these messages
CONTROL_MSGS = """
from genpy.dynamic import generate_dynamic

LINE = "=" * 80 + "\\n"
HEADER = LINE + "MSG: std_msgs/Header\\nuint32 seq\\ntime stamp\\nstring frame_id\\n"
GOAL_ID = LINE + "MSG: actionlib_msgs/GoalID\\ntime stamp\\nstring id\\n"
STATUS = LINE + "MSG: actionlib_msgs/GoalStatus\\nGoalID goal_id\\nuint8 status\\nstring text\\n"
POINT = (
    LINE + "MSG: trajectory_msgs/JointTrajectoryPoint\\nfloat64[] positions\\nfloat64[] velocities\\n"
    "float64[] accelerations\\nfloat64[] effort\\nduration time_from_start\\n"
)
TRAJECTORY = LINE + "MSG: trajectory_msgs/JointTrajectory\\nHeader header\\nstring[] joint_names\\n"
TRAJECTORY += "JointTrajectoryPoint[] points\\n"
TOLERANCE = LINE + "MSG: control_msgs/JointTolerance\\nstring name\\nfloat64 position\\nfloat64 velocity\\n"
TOLERANCE += "float64 acceleration\\n"
STAMPED = "Header header\\nactionlib_msgs/GoalStatus status\\n"
POINTS = "trajectory_msgs/JointTrajectoryPoint"


def action(name, goal, result, feedback):
    text = f"{name}ActionGoal action_goal\\n{name}ActionResult action_result\\n{name}ActionFeedback action_feedback\\n"
    head = f"Header header\\nactionlib_msgs/GoalID goal_id\\n{name}Goal goal\\n"
    parts = {
        "ActionGoal": head, "ActionResult": STAMPED + f"{name}Result result\\n",
        "ActionFeedback": STAMPED + f"{name}Feedback feedback\\n", "Goal": goal, "Result": result, "Feedback": feedback,
    }
    text += "".join(LINE + f"MSG: control_msgs/{name}{part}\\n{content}" for part, content in parts.items())
    made = generate_dynamic(
        f"control_msgs/{name}Action", text + TOLERANCE + HEADER + GOAL_ID + STATUS + TRAJECTORY + POINT
    )
    globals().update((key.partition("/")[2], cls) for key, cls in made.items())


PATH = "trajectory_msgs/JointTrajectory trajectory\\n"
action("JointTrajectory", PATH, "# no fields\\n", "# no fields\\n")
action(
    "FollowJointTrajectory",
    PATH + "JointTolerance[] path_tolerance\\nJointTolerance[] goal_tolerance\\nduration goal_time_tolerance\\n",
    "int32 error_code\\nstring error_string\\nint32 SUCCESSFUL=0\\nint32 INVALID_GOAL=-1\\nint32 INVALID_JOINTS=-2\\n"
    "int32 OLD_HEADER_TIMESTAMP=-3\\nint32 PATH_TOLERANCE_VIOLATED=-4\\nint32 GOAL_TOLERANCE_VIOLATED=-5\\n",
    f"Header header\\nstring[] joint_names\\n{POINTS} desired\\n{POINTS} actual\\n{POINTS} error\\n",
)
"""
SCENE = """
from morse.builder import *
robot = ATRV()
robot.translate(3.0, 1.0, 0.1)
pose = Pose(); pose.add_stream("ros", "lab.streams.Marked", height=7.0); robot.append(pose)
mast = Pose(); mast.translate(0.5, 0.0, 1.0); mast.rotate(z=1.5707963267948966); robot.append(mast)
mast.add_stream("ros", "lab.streams.Mounted", frame_id="/mast", parent_frame_id="/body", topic="/mast/place")
motion = MotionVW(); motion.add_stream("ros", "lab.streams.Steering", topic="/wheel"); robot.append(motion)
broken = Pose(); broken.add_stream("ros", "lab.streams.Broken"); robot.append(broken)
arm = KukaLWR(); arm.translate(z=0.9); robot.append(arm)
arm.add_overlay("ros", "morse.middleware.ros.overlays.armatures.ArmatureController")
second = KukaLWR(); second.translate(x=0.5, z=0.9); robot.append(second); second.add_service("ros")
second.add_stream("ros")
stand = ArmaturePose(); second.append(stand); stand.add_stream("ros")
posture = ArmaturePose(); arm.append(posture); posture.add_stream("ros")
env = Environment("empty", fastmode=True)
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    need_ros()
    folder = tmp_path_factory.mktemp("ros1_own")
    paths = "from control_msgs.msg import JointTrajectory, JointTrajectoryPoint\n"
    packages = {"lab/streams.py": STREAMS, "control_msgs/msg.py": CONTROL_MSGS, "trajectory_msgs/msg.py": paths}
    for name, text in packages.items():
        path = folder / "packages" / name
        path.parent.mkdir(parents=True)
        (path.parent / "__init__.py").touch()
        path.write_text(text)
    (folder / "scene.py").write_text(SCENE)
    folders = (folder / "packages",)
    with master() as uri, simulation(folder / "scene.py", uri, folders=folders) as log:
        answers = json.loads(run(HERE / "own_classes_peer.py", uri, folders=folders))
        yield {**answers, "log": log.read_text()}


def test_a_class_of_the_user_publishes_its_messages(said: Any) -> None:
    frame, x, height = said["marked"]
    assert frame == "/somewhere"
    assert height == 7.0
    assert x >= 3.0
    # the stamp is the simulated time of a tick
    tick = said["stamp"] * 60.0
    assert tick == pytest.approx(round(tick), abs=1e-5)


def test_its_transforms_are_on_tf(said: Any) -> None:
    place, turn = said["tf"]["/body /mast"]
    assert place == pytest.approx([0.5, 0.0, 1.0], abs=1e-3)
    assert turn == pytest.approx([0.0, 0.0, 0.5**0.5, 0.5**0.5], abs=1e-6)
    assert said["tf"]["/parent /child"] == [[1.0, 2.0, 3.0], [0.0, 0.0, 1.0, 0.0]]
    assert said["mast frame"] == "/mast"


def test_a_class_of_the_user_receives_commands(said: Any) -> None:
    # the class doubles the speed: 0.4 m/s
    assert said["speed"] == pytest.approx(0.4, abs=0.02)


def test_a_message_of_another_class_closes_the_stream_and_names_the_component(said: Any) -> None:
    assert re.search(r"the stream \w+ of robot\.broken failed and is closed", said["log"])


def test_the_controller_of_an_arm_moves_its_joints_along_a_trajectory(said: Any) -> None:
    succeeded = 3
    assert said["arm"]["state"] == succeeded
    assert said["arm"]["positions"] == pytest.approx([0.3, -0.2, 0.1, 0.4, 0.0, 0.2, -0.3], abs=1e-3)
    assert said["arm"]["parameter"] == [f"kuka_{number}" for number in range(1, 8)]


def test_a_trajectory_for_other_joints_is_refused_by_name(said: Any) -> None:
    aborted = 4
    state, text = said["refused"]
    assert state == aborted
    assert "elbow" in text
    assert "kuka_1" in text


def test_an_armature_is_a_controller_for_some_of_its_joints(said: Any) -> None:
    succeeded, rejected = 3, 5
    assert said["follow"] == [succeeded, 0]
    assert said["follow feedback"], "five times in a second"
    assert all(len(names) == 1 and 0.0 <= desired <= 0.5 for names, desired in said["follow feedback"])
    assert said["follow end"] == pytest.approx(0.5, abs=1e-3)
    assert said["follow unknown"][0] == rejected


def test_a_trajectory_of_a_topic_moves_some_of_the_joints(said: Any) -> None:
    assert said["topic"] == pytest.approx(0.4, abs=1e-3)


def test_a_stream_without_a_class_of_messages_is_refused() -> None:
    class Empty(ROSPublisher):
        def default(self, ci: Any = None) -> None:
            """Nothing."""

    component: Any = SimpleNamespace(name=lambda: "robot.pose")
    with pytest.raises(MorseMiddlewareError, match="ros_class is None, expected a class"):
        Empty(component, {}).initialize()
