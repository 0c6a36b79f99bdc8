"""A node that reads the joints of a PR2 and a scan, and waits for an action server."""

from __future__ import annotations

import json
import time
from typing import Any

import actionlib
import rospy
from morse.middleware.ros.tfMessage import tfMessage
from move_base_msgs.msg import MoveBaseAction
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, LaserScan


def _frame(one: Any) -> list[Any]:
    """Parent, child, translation and stamp of a transform."""
    place = one.transform.translation
    return [one.header.frame_id, one.child_frame_id, [place.x, place.y, place.z], one.header.stamp.to_sec()]


def main() -> None:
    rospy.init_node("peer", disable_signals=True)
    client = actionlib.SimpleActionClient("/robot/waypoint/move_base", MoveBaseAction)
    answers = client.wait_for_server(rospy.Duration(5.0))
    got: dict[str, Any] = {}
    rospy.Subscriber("/joint_states", JointState, lambda message: got.update(joints=message))
    rospy.Subscriber("/robot/scan", LaserScan, lambda message: got.update(scan=message))
    places: list[Any] = []
    fixed: list[Any] = []
    now, ahead = [0.0], [0.0]

    def note(message: tfMessage) -> None:
        for one in message.transforms:
            if one.child_frame_id == "/robot/place":
                places.append(_frame(one))
                ahead.append(places[-1][3] - now[-1])

    rospy.Subscriber("/tf", tfMessage, note)
    rospy.Subscriber("/tf_static", tfMessage, lambda m: fixed.extend(_frame(one)[:3] for one in m.transforms))
    rospy.Subscriber("/clock", Clock, lambda message: now.append(message.clock.to_sec()))
    end = time.monotonic() + 60.0
    while (len(got) < 2 or len(places) < 2 or not fixed or not 0.5 < ahead[-1] < 1.5) and time.monotonic() < end:
        time.sleep(0.02)
    joints, scan = got["joints"], got["scan"]
    print(
        json.dumps(
            {
                "answers": answers,
                "names": list(joints.name),
                "positions": list(joints.position),
                "place": places[:2],
                "mast": fixed,
                "ahead": ahead[-1],
                "scan": [min(scan.ranges), max(scan.ranges), scan.range_max],
                "tf": tfMessage._type,
            }
        )
    )


main()
