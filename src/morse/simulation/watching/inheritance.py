"""Transfers the state of a component to the component of the edited class that replaces it."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any

from morse.assets.merging import same
from morse.core.declarations import data_fields, properties
from morse.core.state import Reader, References, StateError, Writer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import DataField
    from morse.core.object import Object
    from morse.core.values import Fields

_MISSING: object = object()
_COMPONENT = "component "


class _Replaced:
    """The parts of a simulation in which some components have been replaced; see `References`."""

    def __init__(self, parts: References, components: Mapping[str, Object]) -> None:
        self._parts = parts
        self._components = components

    def name_of(self, value: object) -> str | None:
        return self._parts.name_of(value)

    def find(self, name: str) -> object:
        if name.startswith(_COMPONENT) and name.removeprefix(_COMPONENT) in self._components:
            return self._components[name.removeprefix(_COMPONENT)]
        return self._parts.find(name)

    def find_class(self, path: str) -> type | None:
        return self._parts.find_class(path)

    def met_class(self, cls: type) -> None:
        self._parts.met_class(cls)

    def global_name(self, value: object) -> str | None:
        return self._parts.global_name(value)

    def find_global(self, name: str) -> object:
        return self._parts.find_global(name)


class Inheritance:
    """Transfers the state of objects to the objects that replace them.

    Args:
        parts: parts of the simulation by name.
        components: new components by name.
    """

    def __init__(self, parts: References, components: Mapping[str, Object]) -> None:
        references = _Replaced(parts, components)
        self._writer = Writer(references)
        self._reader = Reader(references, trusted=True)

    def component(self, name: str, old: Object, new: Object) -> None:
        """Transfer the state of a component.

        Properties and data fields with default values get the defaults of the new class, and so do attributes that the
        old component did not have.

        Raises:
            StateError: the state does not match the new class.
        """
        fields = dict.copy(new.local_data)
        values = {python_name: deepcopy(getattr(new, python_name)) for python_name in properties(type(new))}
        requests = list(new.requests)
        state = self._state(name, old, new)
        if isinstance(state, dict):
            if isinstance(state.get("local_data"), dict):
                _adapt_fields(state["local_data"], fields, data_fields(type(old)), data_fields(type(new)))
            for python_name in _new_defaults(old, new):
                state[python_name] = values[python_name]
        new.set_state(state)
        new.requests = requests
        new.on_completion = old.on_completion
        if name in new.context.failed:
            new.active = True

    def modifier(self, name: str, old: Any, new: Any) -> None:
        """Transfer the state of a modifier.

        Raises:
            StateError: the state does not match the new class.
        """
        new.set_state(self._state(name, old, new))

    def _state(self, name: str, old: Any, new: Any) -> Any:
        before, own = old.get_state(), new.get_state()
        state = self._reader.part(name, self._writer.part(name, before), new.get_state())
        if not isinstance(own, dict):
            return state
        if not isinstance(state, dict):
            raise StateError(
                f"{name}: the state of the old class is not a dictionary, but the state of the new class is"
            )
        # threads and open files cannot be transferred
        values = {key: value for key, value in state.items() if key in own or not (value is None and before[key])}
        return {**own, **values}


def _adapt_fields(data: Fields, fresh: Fields, before: Mapping[str, DataField], after: Mapping[str, DataField]) -> None:
    """Arrange data by the fields of the new class, in order; fields that were added by others are kept."""
    values = {name: value for name, value in dict.items(data) if name not in before or name in after}
    for name in fresh:
        if name in before and name in after and _kind(before[name]) != _kind(after[name]):
            values.pop(name, None)
    data.clear()
    data.update({**fresh, **values})


def _kind(field: DataField) -> tuple[object, ...]:
    return field.type, field.shape, field.dtype, field.angle, field.quaternion


def _new_defaults(old: Object, new: Object) -> list[str]:
    """Return the properties that get the values of the new class."""
    before = properties(type(old))
    names = []
    for python_name, prop in properties(type(new)).items():
        default = before.get(python_name)
        unset = default is not None and same(getattr(old, python_name, _MISSING), default.default)
        if default is None or default.type != prop.type or (unset and not same(default.default, prop.default)):
            names.append(python_name)
    return names
