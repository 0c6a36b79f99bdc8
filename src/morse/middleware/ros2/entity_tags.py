"""What clients of simulation_interfaces note about entities: category, description, tags.

Source: simulation_interfaces, version 1: EntityInfo.msg, EntityCategory.msg, TagsFilter.msg.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.core.values import RosMessage
    from morse.scene.node import Node

#: categories: object, robot, human, dynamic and static object
_CATEGORIES = range(5)
_ALL = 1
#: longest description and tag, letters, and the number of tags of an entity
_LONGEST_TEXT, _LONGEST_TAG, _MOST = 2000, 200, 100


class Notes:
    """Notes of clients; those about an entity end with it."""

    def __init__(self) -> None:
        self._notes: WeakKeyDictionary[Node, RosMessage] = WeakKeyDictionary()

    def of(self, root: Node) -> RosMessage | None:
        """The EntityInfo that a client has set."""
        return self._notes.get(root)

    def set(self, root: Node, info: RosMessage) -> str | None:
        """Replace the notes about an entity; returns what is wrong with them."""
        category, tags = info["category"]["category"], [str(tag) for tag in info["tags"]]
        if category not in _CATEGORIES:
            return f"info.category is 0 to {_CATEGORIES[-1]}, not {category}"
        if len(info["description"]) > _LONGEST_TEXT:
            return f"info.description has {len(info['description'])} letters; at most {_LONGEST_TEXT} are possible"
        if len(tags) > _MOST or any(len(tag) > _LONGEST_TAG for tag in tags):
            return f"info.tags has at most {_MOST} tags of up to {_LONGEST_TAG} letters"
        self._notes[root] = {**info, "tags": tags}
        return None


def chosen(tags: Collection[str], message: RosMessage) -> bool:
    """Whether something with some tags passes a TagsFilter; an empty filter passes everything."""
    wanted = {str(tag) for tag in message["tags"]}
    if message.get("filter_mode") == _ALL:
        return wanted <= set(tags)
    return not wanted or not wanted.isdisjoint(tags)
