"""The peer: a node of rclpy that reads and sets parameters with the client of rclpy. It prints the answers as JSON."""

from __future__ import annotations

import json
import os
import sys
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient

_LIMIT = 60.0


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("tuner")
    client = AsyncParameterClient(node, "morse")
    assert client.wait_for_services(_LIMIT)

    def wait(future: Any) -> Any:
        rclpy.spin_until_future_complete(node, future, timeout_sec=_LIMIT)
        assert future.result() is not None
        return future.result()

    def get(*names: str) -> list[Any]:
        return [parameter_value_to_python(value) for value in wait(client.get_parameters(list(names))).values]

    def put(**values: Any) -> list[Any]:
        parameters = [Parameter(name.replace("__", "."), value=value) for name, value in values.items()]
        return [[one.successful, one.reason] for one in wait(client.set_parameters(parameters)).results]

    speed, kind, time = "robot.goal.Speed", "robot.goal.ControlType", "use_sim_time"
    before = get(time, speed, kind, "robot.goal.Sped")
    answers = put(
        robot__goal__Speed=2.5, robot__goal__ControlType="Velocity", robot__goal__Sped=1.0, use_sim_time=False
    )
    wrong = put(robot__goal__Speed="fast") + put(robot__goal__ControlType="Jump") + put(use_sim_time=True)
    together = wait(
        client.set_parameters_atomically([Parameter(speed, value=1.0), Parameter(kind, value="Jump")])
    ).result
    described = {
        one.name: [one.type, one.description, one.additional_constraints, one.read_only]
        for one in wait(client.describe_parameters([time, speed, kind])).descriptors
    }
    said = {
        "before": before,
        "answers": answers,
        "wrong": wrong,
        "together": [together.successful, together.reason],
        "after": get(speed, kind),
        "whole": put(robot__goal__Speed=3),
        "types": list(wait(client.get_parameter_types([time, speed, kind])).types),
        "described": described,
        "all": wait(client.list_parameters()).result.names,
        "of_goal": wait(client.list_parameters(prefixes=["robot.goal"], depth=1)).result.names,
        "parents": wait(client.list_parameters(prefixes=["robot.goal"])).result.prefixes,
        "top": wait(client.list_parameters(depth=1)).result.names,
    }
    print(json.dumps(said))
    node.destroy_node()
    rclpy.shutdown()


main()
