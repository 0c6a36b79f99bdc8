"""The services ``/rosapi/...`` for introspection by clients."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.middleware.web.hub import Hub


def _types(hub: Hub) -> dict[str, str]:
    if hub.topics is None:
        return {}
    heard = {name: topic.type for name, topic in hub.topics.heard.items()}
    return {**heard, **{name: topic.type for name, topic in hub.topics.offered.items()}}


def _services(hub: Hub) -> list[str]:
    return sorted(hub.requests.paths) if hub.requests is not None else []


def _topics(hub: Hub, _: str) -> dict[str, Any]:
    types = sorted(_types(hub).items())
    return {"topics": [name for name, _ in types], "types": [kind for _, kind in types]}


def _time(hub: Hub, _: str) -> dict[str, Any]:
    stamp = hub.context.clock.stamp()
    return {"time": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}}


#: services, and the response for their argument
_ANSWERS: dict[str, tuple[str, Callable[[Hub, str], dict[str, Any]]]] = {
    "/rosapi/topics": ("", _topics),
    "/rosapi/topic_type": ("topic", lambda hub, topic: {"type": _types(hub).get(topic, "")}),
    "/rosapi/topics_for_type": (
        "type",
        lambda hub, kind: {"topics": sorted(name for name, known in _types(hub).items() if known == kind)},
    ),
    "/rosapi/services": ("", lambda hub, _: {"services": _services(hub)}),
    "/rosapi/nodes": ("", lambda hub, _: {"nodes": ["/morse"]}),
    "/rosapi/get_time": ("", _time),
}

SERVICES = tuple(_ANSWERS)


def answer(hub: Hub, service: str, args: Any) -> dict[str, Any] | None:
    """The response of a service; None if there is no such service.

    Args:
        hub: the hub with the topics and services.
        service: its name, including ``/rosapi/``.
        args: a list, an object, or None.
    """
    known = _ANSWERS.get(service)
    if known is None:
        return None
    name, ask = known
    given = args.get(name) if isinstance(args, dict) else args[0] if isinstance(args, list) and args else ""
    return ask(hub, given if isinstance(given, str) else "")
