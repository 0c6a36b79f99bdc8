"""The properties and the looks of objects, which may change while the simulation runs."""

from __future__ import annotations

import logging
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from morse.scene import shared_image

if TYPE_CHECKING:
    from morse.core.values import Properties, StateData, Value
    from morse.physics.state.saved import SavedObject
    from morse.scene import Node

logger = logging.getLogger(__name__)


_SINGLE = (type(None), bool, int, float, str, bytes)


class NotPlainError(ValueError):
    """A saved state cannot contain values of this type; the message names the type."""


def plain_copy(value: object) -> object:
    """Return a copy that shares no mutable objects with the original.

    Raises:
        NotPlainError: the value contains an object other than None, booleans, numbers, strings, bytes, arrays of
            numbers, and lists, tuples and dictionaries with string keys of these.
    """
    if type(value) in _SINGLE:
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return value.copy()
    if isinstance(value, (list, tuple)):
        items = [plain_copy(item) for item in value]
        return items if isinstance(value, list) else tuple(items)
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {key: plain_copy(item) for key, item in value.items()}
    raise NotPlainError(type(value).__name__)


#: objects and properties for which a warning was logged because they cannot be saved
_said: set[tuple[str, str]] = set()


def scene_properties(node: Node) -> Properties:
    """Return a deep copy of the properties of a node."""
    properties = node.properties
    return {name: _copy(value) for name, value in properties.items()} if properties else {}


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


#: what may change of a lamp
_LAMP = ("color", "energy", "distance", "spot_size")


class Looks:
    """The looks that a node has in the scene."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._start = node.color, node.light, node.image

    def restore(self) -> bool:
        """Restore the looks of the scene; return whether they had changed."""
        node = self._node
        if (node.color, node.light, node.image) == self._start:
            return False
        node.color, node.light, node.image = self._start
        return True

    def get_state(self) -> StateData:
        """Return the lamp, and a colour that differs from the scene; see `morse.physics.state.saved.SavedObject`."""
        node = self._node
        state: StateData = {}
        if node.color != self._start[0] and node.color is not None:
            state["color"] = tuple(map(float, node.color))
        if node.image is not None and node.image is not self._start[2]:
            state["texture"] = {"name": node.image.name, "mime": node.image.mime, "data": node.image.data}
        # the whole lamp, because an actuator may have set it before the first tick, and in the scene
        if node.light is not None:
            state["lamp"] = {name: getattr(node.light, name) for name in _LAMP}
        return state

    def set_state(self, state: SavedObject) -> bool:
        """Restore a validated state of an object that has the looks of the scene; return whether it differs."""
        node = self._node
        before = node.color, node.light, node.image
        if state.color is not None:
            node.color = state.color
        if state.lamp is not None and node.light is not None:
            node.light = replace(node.light, **{name: getattr(state.lamp, name) for name in _LAMP})
        if state.texture is not None:
            node.image = shared_image(state.texture.name, state.texture.data, state.texture.mime)
        return (node.color, node.light, node.image) != before
