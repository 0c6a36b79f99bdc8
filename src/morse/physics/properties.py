"""The properties of objects, from the scene and in saved states."""

from __future__ import annotations

import logging
from operator import is_
from typing import TYPE_CHECKING, Any

from morse.physics.plain import NotPlainError, plain_copy

if TYPE_CHECKING:
    from morse.scene import Node

logger = logging.getLogger(__name__)

#: objects and properties for which a warning was logged because they cannot be saved
_said: set[tuple[str, str]] = set()


def scene_properties(node: Node) -> dict[str, Any]:
    """Return a deep copy of the properties of a node."""
    return {name: _copy(value) for name, value in node.properties.items()}


def are_changed(properties: dict[str, Any], node: Node) -> bool:
    """Whether properties differ from those of the scene; mutable values count as changed."""
    original = node.properties
    return (
        len(properties) != len(original)
        or not all(map(is_, properties.values(), original.values()))
        or properties.keys() != original.keys()
    )


def plain_properties(owner: str, properties: dict[str, Any]) -> dict[str, Any]:
    """Return a copy of the properties that are plain data, and log a warning once for each other property."""
    result = {}
    for name, value in properties.items():
        try:
            result[name] = plain_copy(value)
        except NotPlainError as error:
            if (owner, name) not in _said:
                _said.add((owner, name))
                logger.warning(
                    "the property '%s' of '%s' is of type %s, which a saved state cannot contain; only numbers, "
                    "strings, lists and dictionaries are saved",
                    name,
                    owner,
                    error,
                )
    return result


def keep_unsaved(present: dict[str, Any], restored: dict[str, Any]) -> None:
    """Add the present properties that cannot be saved to restored properties."""
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
