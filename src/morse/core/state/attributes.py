"""Assign the values and the order of a saved state to the attributes of an object."""

from __future__ import annotations

import inspect
from functools import cache, lru_cache
from typing import TYPE_CHECKING

from morse.core.declarations import properties, state_variables
from morse.core.state.errors import StateError
from morse.core.state.kinds import assigned_by, is_of_morse, word_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.core.values import StateData


@cache
def left_out(cls: type) -> frozenset[str]:
    """The names of the attributes of a class that are not part of its state.

    Classes of MORSE declare their state (`add_state`, `add_property`): everything else that they assign follows from
    the scene. Classes of users name in ``not_state`` what does not belong to their state.
    """
    names = {name for base in cls.__mro__ for name in vars(base).get("not_state", ())}
    ours = [base for base in cls.__mro__ if is_of_morse(base)]
    if not any("_state_variables" in vars(base) for base in ours):
        return frozenset(names)
    names_of_ours = set().union(*(assigned_by(base) for base in ours))
    users = set().union(*(assigned_by(base) for base in cls.__mro__ if base not in ours))
    return frozenset(names | (names_of_ours - users - state_variables(cls).keys() - properties(cls).keys()))


def state_of(owner: object) -> StateData:
    """The attributes of an object that are part of its state."""
    cls: type = type(owner)
    without = left_out(cls)
    return {name: value for name, value in vars(owner).items() if name not in without}


def check_name(cls: type, name: object) -> None:
    """Raise `StateError` if a state must not set an attribute of that name of objects of a class."""
    if not isinstance(name, str) or (name.startswith("__") and name.endswith("__")):
        raise StateError(f"the saved state is damaged: an attribute has the name {name!r:.40}")
    if name in left_out(cls):
        raise StateError(f"the attribute '{name:.40}' is not part of a saved state")
    if _is_computed(cls, name):
        raise StateError(f"'{name:.40}' is computed by the class {cls.__name__}, and is not part of a saved state")


@lru_cache(4096)
def _is_computed(cls: type, name: str) -> bool:
    attribute = inspect.getattr_static(cls, name, None)
    return inspect.isdatadescriptor(attribute) and not inspect.ismemberdescriptor(attribute)


def replace(owner: object, present: Iterable[str], state: Mapping[str, object]) -> None:
    """Replace the attributes of an object with those of a state.

    Args:
        present: names of the attributes that belong to the present state; those that are not in ``state`` are deleted.
        state: name to value.

    Raises:
        StateError: an attribute is not part of a state, or would hide a method.
    """
    attributes, variables = vars(owner), state_variables(type(owner))
    for name, value in state.items():
        check_name(type(owner), name)
        hides = name not in attributes and callable(getattr(type(owner), name, None))
        if hides and getattr(value, "__self__", None) is not owner:
            raise StateError(f"'{name}' is a method of the class {type(owner).__name__}")
        variable = variables.get(name)
        if variable is not None and not variable.accepts(value):
            wider = f"; if it may be nothing, declare it as {variable.type_name} | None" if value is None else ""
            raise StateError(f"'{name}' is {word_of(value)}, and its type is {variable.type_name}{wider}")
    for name in [name for name in present if name not in state]:
        attributes.pop(name, None)
    attributes.update(state)
    reorder(attributes, state)


def reorder(attributes: StateData, order: Iterable[str]) -> None:
    """Reorder attributes as in a saved state, because the order is part of bitwise comparisons of states.

    Names that are not in the order come first.
    """
    names = [name for name in order if name in attributes]
    name_set = set(names)
    if [name for name in attributes if name in name_set] != names:
        for name in names:
            attributes[name] = attributes.pop(name)
