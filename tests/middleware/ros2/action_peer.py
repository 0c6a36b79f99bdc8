"""The peer: a node of rclpy with action clients. It prints the outcomes of its goals as JSON."""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from rclpy.action import ActionClient
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

_LIMIT = 90.0


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("caller")
    client = ActionClient(node, Fibonacci, "/driver/go")
    end = time.monotonic() + _LIMIT

    def wait(future: Any) -> Any:
        while not future.done() and time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.05)
        assert future.done()
        return future.result()

    assert client.wait_for_server(_LIMIT)
    told: list[tuple[bytes, int]] = []

    def tell(message: Any) -> None:
        told.append((bytes(message.goal_id.uuid), message.feedback.sequence[0]))

    first = wait(client.send_goal_async(Fibonacci.Goal(order=2), feedback_callback=tell))
    reached = wait(first.get_result_async())
    second = wait(client.send_goal_async(Fibonacci.Goal(order=100)))
    result = second.get_result_async()
    cancelling = wait(second.cancel_goal_async())
    cancelled = wait(result)
    third = wait(client.send_goal_async(Fibonacci.Goal(order=-1)))
    refused = wait(third.get_result_async())
    halt = node.create_client(SetBool, "/driver/halt")
    assert halt.wait_for_service(_LIMIT)
    halted = wait(halt.call_async(SetBool.Request(data=True)))
    print(
        json.dumps(
            {
                "reached": [first.accepted, reached.status, list(reached.result.sequence)],
                "cancelled": [len(cancelling.goals_canceling), cancelled.status],
                "refused": refused.status,
                "feedback": [rest for number, rest in told if number == bytes(first.goal_id.uuid)],
                "feedback of others": sum(number != bytes(first.goal_id.uuid) for number, _ in told),
                "halted": [halted.success, halted.message],
            }
        )
    )
    node.destroy_node()
    rclpy.shutdown()


main()
