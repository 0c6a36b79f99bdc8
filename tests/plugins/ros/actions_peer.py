"""A node that calls services and actions of an overlay, with the clients of rospy and actionlib."""

from __future__ import annotations

import json
import time
from typing import Any

import actionlib
import rospy
from actionlib.msg import TestAction, TestGoal
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_srvs.srv import SetBool, Trigger

_LIMIT = 60.0


def main() -> None:
    rospy.init_node("peer", disable_signals=True)
    statuses: list[GoalStatusArray] = []
    rospy.Subscriber("/driver/go/status", GoalStatusArray, statuses.append)
    client = actionlib.SimpleActionClient("/driver/go", TestAction)
    # rospy measures timeouts by /clock, which may be faster than the wall clock
    while not client.wait_for_server(rospy.Duration(1.0)):
        pass

    def until(states: tuple[int, ...]) -> int:
        end = time.monotonic() + _LIMIT
        while time.monotonic() < end and client.get_state() not in states:
            time.sleep(0.01)
        return int(client.get_state())

    ended = (GoalStatus.SUCCEEDED, GoalStatus.PREEMPTED, GoalStatus.ABORTED, GoalStatus.REJECTED)
    client.send_goal(TestGoal(goal=2))
    reached = until(ended)
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end and client.get_result() is None:
        time.sleep(0.01)  # a status may come before the result
    result = client.get_result().result
    client.send_goal(TestGoal(goal=100))
    until((GoalStatus.ACTIVE,))
    client.cancel_goal()
    cancelled = until(ended)
    client.send_goal(TestGoal(goal=-1))
    refused, text = until(ended), client.get_goal_status_text()
    drive = actionlib.SimpleActionClient("/driver/drive", MoveBaseAction)
    while not drive.wait_for_server(rospy.Duration(1.0)):
        pass
    told: list[tuple[str, float]] = []
    there = MoveBaseGoal()
    there.target_pose.pose.position.x = 4.0

    def tell(message: Any) -> None:
        told.append((message.base_position.header.frame_id, message.base_position.pose.position.x))

    drive.send_goal(there, feedback_cb=tell)
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end and drive.get_state() not in ended:
        time.sleep(0.01)
    shipped = actionlib.SimpleActionClient("/robot/goal/move_base", MoveBaseAction)
    while not shipped.wait_for_server(rospy.Duration(1.0)):
        pass
    shipped.send_goal(there)
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end and shipped.get_state() not in ended:
        time.sleep(0.01)
    halt = rospy.ServiceProxy("/driver/halt", SetBool)(True)
    try:
        rospy.ServiceProxy("/driver/fail", Trigger)()
        failure = ""
    except rospy.ServiceException as error:
        failure = str(error)
    print(
        json.dumps(
            {
                "reached": [reached, result],
                "cancelled": cancelled,
                "move_base": shipped.get_state(),
                "refused": [refused, text],
                "halt": [halt.success, halt.message],
                "failure": failure,
                "feedback": told,
                "statuses": len(statuses),
            }
        )
    )


main()
