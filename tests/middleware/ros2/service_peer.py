"""The peer: a node of rclpy that calls services. It prints the responses as JSON."""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParametersAtomically
from std_srvs.srv import Trigger

_LIMIT = 90.0


def number(name: str, value: float) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=3, double_value=value))


def word(name: str, value: str) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=4, string_value=value))


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("caller")

    def call(kind: Any, name: str, request: Any) -> Any:
        client = node.create_client(kind, name)
        assert client.wait_for_service(_LIMIT), name
        future = client.call_async(request)
        end = time.monotonic() + _LIMIT
        while not future.done() and time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.05)
        answer = future.result()
        assert answer is not None, name
        return (
            [answer.result.successful, answer.result.reason]
            if hasattr(answer, "result")
            else [
                answer.success,
                answer.message,
            ]
        )

    def named(name: str, *parameters: Parameter) -> Any:
        return call(SetParametersAtomically, name, SetParametersAtomically.Request(parameters=list(parameters)))

    said = {
        "robots": call(Trigger, "/simulation/list_robots", Trigger.Request()),
        "status": call(Trigger, "/robot/goal/get_status", Trigger.Request()),
        "arrived": named(
            "/robot/goal/goto", number("x", 2.0), number("y", 2.0), number("z", 0.0), number("speed", 2.0)
        ),
        "missing": named("/robot/goal/goto", number("x", 2.0)),
        "unknown": named("/robot/goal/goto", number("x", 2.0), number("yy", 2.0)),
        "wrong": named("/robot/goal/goto", word("x", "here"), number("y", 2.0), number("z", 0.0)),
        "put": named(
            "/simulation/set_object_position", word("object_name", "robot"), word("position", "[5.0, 6.0, 0.1]")
        ),
    }
    print(json.dumps(said))
    node.destroy_node()
    rclpy.shutdown()


main()
