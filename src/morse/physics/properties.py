"""The properties of objects: what the scene gave them, and what a saved state holds of them."""

from __future__ import annotations

import logging
from operator import is_
from typing import TYPE_CHECKING, Any

from morse.physics.plain import NotPlainError, plain_copy

if TYPE_CHECKING:
    from morse.scene import Node

logger = logging.getLogger(__name__)

#: objects and properties that were named already because they cannot be saved
_said: set[tuple[str, str]] = set()


def scene_properties(node: Node) -> dict[str, Any]:
    """A copy of the properties of a node; lists in it are copies, too."""
    return {name: _copy(value) for name, value in node.properties.items()}


def are_changed(properties: dict[str, Any], node: Node) -> bool:
    """Whether properties differ from those of the scene; what can be changed in place counts as changed."""
    original = node.properties
    return (
        len(properties) != len(original)
        or not all(map(is_, properties.values(), original.values()))
        or properties.keys() != original.keys()
    )


def plain_properties(owner: str, properties: dict[str, Any]) -> dict[str, Any]:
    """A copy of the properties that are plain data. The log names every other property once."""
    result = {}
    for name, value in properties.items():
        try:
            result[name] = plain_copy(value)
        except NotPlainError as error:
            if (owner, name) not in _said:
                _said.add((owner, name))
                logger.warning(
                    "the property '%s' of '%s' holds a %s: a saved state leaves it out; give it numbers, strings, "
                    "lists or dictionaries to have it saved",
                    name,
                    owner,
                    error,
                )
    return result


def keep_unsaved(present: dict[str, Any], restored: dict[str, Any]) -> None:
    """Add to restored properties those of the present that no state can hold."""
    for name, value in present.items():
        if name not in restored and not _is_plain(value):
            restored[name] = value


def _is_plain(value: Any) -> bool:
    try:
        plain_copy(value)
    except NotPlainError:
        return False
    return True


def _copy(value: Any) -> Any:
    try:
        return plain_copy(value)
    except NotPlainError:
        return value
