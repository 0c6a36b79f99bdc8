"""The services ``/rosapi/...`` for introspection by clients."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.rosmsgs.definitions import PRIMITIVES, definition, fields_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import JsonObject
    from morse.middleware.web.hub import Hub


#: the only node
_NODE = "/morse"


def _types(hub: Hub) -> dict[str, str]:
    if hub.topics is None:
        return {}
    subscriptions = {name: topic.type for name, topic in hub.topics.heard.items()}
    return {**subscriptions, **{name: topic.type for name, topic in hub.topics.offered.items()}}


def _services(hub: Hub) -> list[str]:
    return sorted(hub.requests.paths) if hub.requests is not None else []


def _topics(hub: Hub, _: str) -> JsonObject:
    types = sorted(_types(hub).items())
    return {"topics": [name for name, _ in types], "types": [kind for _, kind in types]}


def _time(hub: Hub, _: str) -> JsonObject:
    stamp = hub.context.clock.stamp()
    seconds, rest = stamp // 10**9, stamp % 10**9
    # the second pair has the names of ROS 1, which roslibpy reads
    return {"time": {"sec": seconds, "nanosec": rest, "secs": seconds, "nsecs": rest}}


def _node_details(hub: Hub, node: str) -> JsonObject:
    if node != _NODE or hub.topics is None:
        return {"publishing": [], "subscribing": [], "services": _services(hub) if node == _NODE else []}
    return {
        "publishing": sorted(hub.topics.offered),
        "subscribing": sorted(hub.topics.heard),
        "services": _services(hub),
    }


def _raw_types(hub: Hub, _: str) -> JsonObject:
    definitions = [definition(kind) for _, kind in sorted(_types(hub).items())]
    return {**_topics(hub, ""), "typedefs_full_text": definitions}


def _message_details(hub: Hub, kind: str) -> JsonObject:
    """Describe a message and all messages in it."""
    remaining, details = [kind.replace("/", "/msg/") if kind.count("/") == 1 else kind], []
    for name in remaining:
        try:
            fields = fields_of(name)
        except MorseMiddlewareError:
            continue
        inner = dict.fromkeys(field.type for field in fields if field.type not in (*PRIMITIVES, "string"))
        remaining += [one for one in inner if one not in remaining]
        details.append(
            {
                "type": name,
                "fieldnames": [field.name for field in fields],
                "fieldtypes": [field.type for field in fields],
                # -1: a single value, 0: any number of values
                "fieldarraylen": [field.size for field in fields],
                "examples": [],
                "constnames": [],
                "constvalues": [],
            }
        )
    return {"typedefs": details}


#: services, and the response for their argument
_ANSWERS: dict[str, tuple[str, Callable[[Hub, str], JsonObject]]] = {
    "/rosapi/topics": ("", _topics),
    "/rosapi/topic_type": ("topic", lambda hub, topic: {"type": _types(hub).get(topic, "")}),
    "/rosapi/topics_for_type": (
        "type",
        lambda hub, kind: {"topics": sorted(name for name, type_name in _types(hub).items() if type_name == kind)},
    ),
    "/rosapi/services": ("", lambda hub, _: {"services": _services(hub)}),
    "/rosapi/nodes": ("", lambda hub, _: {"nodes": [_NODE]}),
    "/rosapi/node_details": ("node", _node_details),
    "/rosapi/publishers": (
        "topic",
        lambda hub, topic: {"publishers": [_NODE] if hub.topics is not None and topic in hub.topics.offered else []},
    ),
    "/rosapi/subscribers": (
        "topic",
        lambda hub, topic: {"subscribers": [_NODE] if hub.topics is not None and topic in hub.topics.heard else []},
    ),
    "/rosapi/topics_and_raw_types": ("", _raw_types),
    "/rosapi/message_details": ("type", _message_details),
    "/rosapi/get_time": ("", _time),
    # arguments of services are JSON: services have no types of ROS
    "/rosapi/service_type": ("service", lambda hub, _: {"type": ""}),
    "/rosapi/services_for_type": ("type", lambda hub, _: {"services": []}),
    "/rosapi/service_node": (
        "service",
        lambda hub, service: {"node": _NODE if service in _services(hub) else ""},
    ),
    # there are neither actions nor parameters
    "/rosapi/action_servers": ("", lambda hub, _: {"action_servers": []}),
    "/rosapi/get_param_names": ("", lambda hub, _: {"names": []}),
}

SERVICES = tuple(_ANSWERS)


def answer(hub: Hub, service: str, args: object) -> JsonObject | None:
    """The response of a service; None if there is no such service.

    Args:
        hub: the hub with the topics and services.
        service: its name, including ``/rosapi/``.
        args: a list, an object, or None.
    """
    function = _ANSWERS.get(service)
    if function is None:
        return None
    name, ask = function
    argument = args.get(name) if isinstance(args, dict) else args[0] if isinstance(args, list) and args else ""
    return ask(hub, argument if isinstance(argument, str) else "")
