"""A node that reads the joints of a PR2 and a scan, and waits for an action server."""

from __future__ import annotations

import json
import time
from typing import Any

import actionlib
import rospy
from morse.middleware.ros.tfMessage import tfMessage
from move_base_msgs.msg import MoveBaseAction
from sensor_msgs.msg import JointState, LaserScan


def main() -> None:
    rospy.init_node("peer", disable_signals=True)
    client = actionlib.SimpleActionClient("/robot/waypoint/move_base", MoveBaseAction)
    answers = client.wait_for_server(rospy.Duration(5.0))
    got: dict[str, Any] = {}
    rospy.Subscriber("/joint_states", JointState, lambda message: got.update(joints=message))
    rospy.Subscriber("/robot/scan", LaserScan, lambda message: got.update(scan=message))
    end = time.monotonic() + 60.0
    while len(got) < 2 and time.monotonic() < end:
        time.sleep(0.02)
    joints, scan = got["joints"], got["scan"]
    print(
        json.dumps(
            {
                "answers": answers,
                "names": list(joints.name),
                "positions": len(joints.position),
                "scan": [min(scan.ranges), max(scan.ranges), scan.range_max],
                "tf": tfMessage._type,
            }
        )
    )


main()
