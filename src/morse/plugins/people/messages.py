"""People in messages: their kind (entry point ``morse.kinds``) and their topics of ROS 2 (``morse.ros_messages``).

The types are ``people_msgs/People``, and ``hunav_msgs/Agents`` on the sub-topic ``agents``. A backend that does not
have these packages sends the people as JSON, in a ``std_msgs/String``, and no agents.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.kinds import Kind, Slot
from morse.rosmsgs.names import MAP
from morse.rosmsgs.parts import as_json, header, xyz
from morse.rosmsgs.table import Outlet, RosExtension, TopicTable, topics

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.table import Carrier

KINDS = (
    Kind(
        "people",
        {
            "records": Slot(
                "records",
                (None,),
                "object",
                doc="dictionaries with name, id, group_id, position (m) and velocity (m/s) in the world, yaw (rad), "
                "radius (m), desired_velocity (m/s), state",
            )
        },
        True,
        False,
        1,
        "People and how they walk.",
    ),
)

_MESSAGES = """
people_msgs/Person: string name, geometry_msgs/Point position, geometry_msgs/Point velocity, float64 reliability,
    string[] tagnames, string[] tags
people_msgs/People: std_msgs/Header header, people_msgs/Person[] people
hunav_msgs/AgentBehavior: uint8 type, uint8 state, uint8 configuration, float32 duration, bool once, float32 vel,
    float32 dist, float32 social_force_factor, float32 goal_force_factor, float32 obstacle_force_factor,
    float32 other_force_factor
hunav_msgs/Agent: int32 id, uint8 type, int8 skin, string name, int16 group_id, geometry_msgs/Pose position,
    float64 yaw, geometry_msgs/Twist velocity, float64 desired_velocity, float64 linear_vel, float64 angular_vel,
    float64 radius, hunav_msgs/AgentBehavior behavior, geometry_msgs/Pose[] goals, bool cyclic_goals,
    float64 goal_radius, geometry_msgs/Point[] closest_obs
hunav_msgs/Agents: std_msgs/Header header, hunav_msgs/Agent[] agents
"""


class PeopleTopics(TopicTable):
    """The topics of people."""

    @topics("people")
    def people(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """People, and the same people as agents."""
        text = Outlet("std_msgs/msg/String", lambda m, f: {"data": as_json(list(m.records))})
        return [
            Outlet("people_msgs/msg/People", _people, instead=text),
            Outlet("hunav_msgs/msg/Agents", _agents, "agents", or_none=True),
        ]


def _people(message: Message, frame: str) -> RosMessage:
    return {"header": header(message, MAP), "people": [_person(one) for one in message.records]}


def _person(one: dict[str, Any]) -> RosMessage:
    # what has no field of its own stands in the tags, as in social navigation
    tags = {"id": one["id"], "group_id": one["group_id"], "yaw": one["yaw"], "state": one["state"]}
    return {
        "name": one["name"],
        "position": xyz(one["position"]),
        "velocity": xyz(one["velocity"]),
        "reliability": 1.0,
        "tagnames": list(tags),
        "tags": [str(value) for value in tags.values()],
    }


def _agents(message: Message, frame: str) -> RosMessage:
    return {"header": header(message, MAP), "agents": [_agent(one) for one in message.records]}


#: ``hunav_msgs/Agent.PERSON``
_PERSON = 1


def _agent(one: dict[str, Any]) -> RosMessage:
    half = 0.5 * one["yaw"]
    turn = {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}
    return {
        "id": one["id"],
        "type": _PERSON,
        "name": one["name"],
        "group_id": one["group_id"],
        "position": {"position": xyz(one["position"]), "orientation": turn},
        "yaw": one["yaw"],
        "velocity": {"linear": xyz(one["velocity"])},
        "desired_velocity": one["desired_velocity"],
        "linear_vel": math.hypot(*one["velocity"]),
        "radius": one["radius"],
    }


MESSAGES = RosExtension(PeopleTopics(), _MESSAGES)
