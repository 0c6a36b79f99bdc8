"""Who publishes, reads and serves what: the connection graph of Foxglove."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.values import JsonObject

    #: name to the ids of nodes
    Table = Mapping[str, frozenset[str]]

#: key of a table in messages to the key of ids in its entries
_KEYS = {
    "publishedTopics": "publisherIds",
    "subscribedTopics": "subscriberIds",
    "advertisedServices": "providerIds",
}
NOTHING: dict[str, list[object]] = {key: [] for key in (*_KEYS, "removedTopics", "removedServices")}
"""An update without changes."""
EMPTY: dict[str, Table] = {key: {} for key in _KEYS}
"""The graph that a client has before the first update."""
SIMULATION = "morse"
"""Id of the simulation; clients have the ids ``client 127.0.0.1:4711``."""


def graph_of(hub: Any) -> dict[str, Table]:
    """The graph of a hub, in the network thread."""
    publishers: dict[str, set[str]] = {}
    readers: dict[str, set[str]] = {}
    topics = hub.topics
    for name, topic in topics.offered.items() if topics is not None else ():
        publishers.setdefault(name, set()).add(SIMULATION)
        for client in topic.readers:
            readers.setdefault(name, set()).add(f"client {client.peer}")
    for name in topics.heard if topics is not None else ():
        readers.setdefault(name, set()).add(SIMULATION)
    for client in hub.server.clients:
        for name in client.published():
            publishers.setdefault(name, set()).add(f"client {client.peer}")
    services = {path: {SIMULATION} for path in hub.services().values()}
    tables = zip(_KEYS, (publishers, readers, services), strict=True)
    return {key: {name: frozenset(ids) for name, ids in table.items()} for key, table in tables}


def update(before: Mapping[str, Table], now: Mapping[str, Table]) -> JsonObject | None:
    """The message with the changes of a graph, or None if there are none."""
    message: JsonObject = {}
    for key, ids in _KEYS.items():
        changes = {name: now[key].get(name, frozenset()) for name in before[key].keys() | now[key].keys()}
        message[key] = [
            {"name": name, ids: sorted(nodes)}
            for name, nodes in sorted(changes.items())
            if nodes != before[key].get(name, frozenset())
        ]
    names = [before[key].keys() - now[key].keys() for key in _KEYS]
    present = now["publishedTopics"].keys() | now["subscribedTopics"].keys()
    message["removedTopics"] = sorted((names[0] | names[1]) - present)
    message["removedServices"] = sorted(names[2])
    return message if any(message.values()) else None
