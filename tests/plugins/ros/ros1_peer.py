"""The peer: a node of rospy. It drives, subscribes and calls, and prints the received data as JSON."""

from __future__ import annotations

import json
import math
import struct
import time
from typing import Any

import rospy
from geometry_msgs.msg import Pose, PoseStamped, Twist, TwistStamped, Vector3
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import CameraInfo, Image, Imu, JointState, LaserScan, PointCloud2
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

_LIMIT = 60.0


def _xyz(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def main() -> None:
    rospy.init_node("peer", disable_signals=True)
    got: dict[str, list[Any]] = {}

    def listen(topic: str, kind: Any) -> None:
        messages = got.setdefault(topic, [])
        rospy.Subscriber(topic, kind, messages.append)

    for topic, kind in (
        ("/robot/pose", PoseStamped), ("/robot/odometry", Odometry), ("/robot/scan", LaserScan), ("/clock", Clock),
        ("/robot/imu", Imu), ("/robot/near", String), ("/robot/eye/image", Image),
        ("/robot/eye/camera_info", CameraInfo), ("/robot/ptu/posture", JointState), ("/tf", TFMessage),
        ("/tf_static", TFMessage), ("/where", Pose), ("/other/fan", PointCloud2), ("/other/pull", TwistStamped),
        ("/other/lens/image_raw", Image), ("/other/odom", Odometry),
    ):  # fmt: skip
        listen(topic, kind)
    logged: list[Any] = []
    log = rospy.Subscriber("/rosout", Log, logged.append)
    drive = rospy.Publisher("/robot/motion", Twist, queue_size=1)
    jump = rospy.Publisher("/other/jump", Pose, queue_size=1)
    head = rospy.Publisher("/robot/ptu", Vector3, queue_size=1)
    forward, place = Twist(), Pose()
    forward.linear.x = 0.5
    wrong = Twist()
    wrong.linear.x = math.nan
    place.position.x, place.position.y, place.position.z, place.orientation.w = 7.0, 8.0, 1.0, 1.0
    end = time.monotonic() + _LIMIT

    def moved() -> bool:
        seen = got["/robot/odometry"]
        turned = got["/robot/ptu/posture"]
        return bool(seen) and seen[-1].pose.pose.position.x > 0.3 and turned[-1].position[0] > 0.35

    def arrived() -> bool:
        """Whether everything that is told below has come; the order of topics, and of their connections, is open."""
        transforms = [t for m in got["/tf"][-100:] for t in m.transforms]
        jumped = [m.position.x for m in got["/where"][-1:]] + [
            t.transform.translation.x
            for t in transforms
            if (t.header.frame_id, t.child_frame_id) == ("/world", "/other")
        ][-1:]
        return (
            len(jumped) == 2
            and min(jumped) > 6.99
            and ("/map", "robot") in {(t.header.frame_id, t.child_frame_id) for m in got["/tf"] for t in m.transforms}
            and "other" in got["/robot/near"][-1].data
            and bool(got["/tf_static"])
            and any("refused" in one.msg for one in logged)
        )

    while time.monotonic() < end and not (
        all(len(m) > 3 for topic, m in got.items() if topic != "/tf_static") and moved() and arrived()
    ):
        if log.get_num_connections() > 1:  # this node and the simulation: the log has a line about this command
            drive.publish(wrong)
        drive.publish(forward)
        jump.publish(place)
        head.publish(Vector3(0.0, 0.4, -0.2))
        time.sleep(0.02)
    rospy.wait_for_service("/simulation/list_robots", 20.0)
    robots = rospy.ServiceProxy("/simulation/list_robots", Trigger)()
    last = {topic: messages[-1] for topic, messages in got.items() if messages}
    scan, image, info = last["/robot/scan"], last["/robot/eye/image"], last["/robot/eye/camera_info"]
    odometry = last["/robot/odometry"]
    transforms = [t for m in got["/tf"] for t in m.transforms]
    fixed = [t for m in got["/tf_static"] for t in m.transforms]
    moved_to = [
        t.transform.translation for t in transforms if (t.header.frame_id, t.child_frame_id) == ("/world", "/other")
    ]
    fan, pull = last["/other/fan"], last["/other/pull"]
    print(
        json.dumps(
            {
                "missing": [topic for topic, messages in got.items() if not messages],
                "frames": {topic: m.header.frame_id for topic, m in last.items() if hasattr(m, "header")},
                "child": odometry.child_frame_id,
                "x": odometry.pose.pose.position.x,
                "speed": odometry.twist.twist.linear.x,
                "stamps": [m.header.stamp.to_nsec() for m in got["/robot/pose"]],
                "scan": [len(scan.ranges), scan.angle_min, scan.angle_max, scan.angle_increment, scan.range_min],
                "image": [image.encoding, image.width, image.height, image.step, len(image.data)],
                "info": [info.K[0], info.width, list(info.D), info.distortion_model],
                "near": last["/robot/near"].data,
                "gravity": last["/robot/imu"].linear_acceleration.z,
                "joints": [list(last["/robot/ptu/posture"].name), list(last["/robot/ptu/posture"].position)],
                "tf": sorted({(t.header.frame_id, t.child_frame_id) for t in transforms}),
                "where": _xyz(last["/where"].position),
                "world to other": _xyz(moved_to[-1]),
                "mast": [fixed[0].header.frame_id, _xyz(fixed[0].transform.translation)],
                "points": [struct.unpack_from("<fff", fan.data, i * fan.point_step) for i in range(fan.width)],
                "pull": _xyz(pull.twist.linear),
                "recognised": sorted({t.child_frame_id for t in transforms if t.header.frame_id == "/map"}),
                "log": next(([one.level, one.name, one.msg] for one in logged if "refused" in one.msg), None),
                "robots": [robots.success, robots.message],
            }
        )
    )


main()
