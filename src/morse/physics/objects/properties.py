"""The properties of objects, from the scene and in saved states."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from morse.physics.state.plain import NotPlainError, plain_copy

if TYPE_CHECKING:
    from morse.core.values import Properties, Value
    from morse.scene import Node

logger = logging.getLogger(__name__)

#: objects and properties for which a warning was logged because they cannot be saved
_said: set[tuple[str, str]] = set()


def scene_properties(node: Node) -> Properties:
    """Return a deep copy of the properties of a node."""
    return {name: _copy(value) for name, value in node.properties.items()}


def are_changed(properties: Properties, node: Node) -> bool:
    """Whether properties differ from those of the scene, in value or type."""
    original = node.properties
    return properties.keys() != original.keys() or not all(map(_are_equal, properties.values(), original.values()))


def _are_equal(one: Value, other: Value) -> bool:
    """Whether two values are equal in all types and bits; of objects that are not plain data, only the same one is."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(_are_equal, one, other))
    if isinstance(one, dict):
        return list(one) == list(other) and all(map(_are_equal, one.values(), other.values()))
    if isinstance(one, np.ndarray):
        alike: bool = one.dtype == other.dtype and one.shape == other.shape
        return alike and one.tobytes() == other.tobytes()
    return isinstance(one, (bool, int, float, str, bytes)) and repr(one) == repr(other)


def plain_properties(owner: str, properties: Properties) -> Properties:
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


def keep_unsaved(present: Properties, target: Properties) -> None:
    """Add the present properties that cannot be saved to restored properties."""
    for name, value in present.items():
        if name not in target and not _is_plain(value):
            target[name] = value


def _is_plain(value: object) -> bool:
    try:
        plain_copy(value)
    except NotPlainError:
        return False
    return True


def _copy(value: object) -> object:
    try:
        return plain_copy(value)
    except NotPlainError:
        return value
