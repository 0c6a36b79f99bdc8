"""The attributes that are the state of an object, and their values and order when a saved state is restored.

The state of a class of MORSE is what it declares (`add_state`, `add_property`). That of a class of a user is all of its
attributes but those of ``not_state``; those that its base classes of MORSE assign belong to it only if declared.
Which ones these are, `assigned_by` reads from the code of the base classes: no other file does, and nothing is read for
the objects of MORSE's own classes.
"""

from __future__ import annotations

import dis
import inspect
import sys
from collections import deque
from functools import cache, cached_property, lru_cache
from types import (
    BuiltinFunctionType,
    ClassMethodDescriptorType,
    FunctionType,
    MethodDescriptorType,
    MethodType,
    MethodWrapperType,
    WrapperDescriptorType,
)
from typing import TYPE_CHECKING, Final, get_args

import numpy as np

from morse.core.declarations import properties, state_variables
from morse.core.reports.faults import class_name, is_a
from morse.core.state.values import TAKEN_APART, StateError
from morse.helpers.transformation import Transformation3d
from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.core.values import StateData


#: no value
MISSING: Final = object()
_KINDS: tuple[tuple[str, tuple[type, ...]], ...] = (
    ("nothing", (type(None),)),
    ("a number", (bool, int, float, complex, np.number, np.bool_)),
    ("a text", (str,)),
    ("bytes", (bytes, bytearray)),
    ("a list", (list, tuple, deque, np.ndarray)),
    ("a set", (set, frozenset)),
    ("a dictionary", (dict,)),
    ("a pose", (Transformation3d,)),
)
_ROUTINES = (
    *(BuiltinFunctionType, FunctionType, MethodType, MethodWrapperType),
    *(ClassMethodDescriptorType, MethodDescriptorType, WrapperDescriptorType),
)
_DATA = (
    *(cls for _, classes in _KINDS for cls in classes),
    *(Vector, Quaternion, Euler, Color, Matrix, *TAKEN_APART),
    *(np.generic, np.random.Generator, np.random.RandomState),
)


def kind_of(value: object) -> str | type:
    """The kind of a value: words for data, the class of other objects."""
    if value is MISSING:
        return "nothing"
    word = next((word for word, classes in _KINDS if is_a(value, classes)), None)
    return word or ("a function" if is_routine(value) else type(value))


def is_routine(value: object) -> bool:
    """Whether a value is a function or a method; the class of an object of the user may raise."""
    return issubclass(type(value), _ROUTINES)


def word_of(value: object) -> str:
    """The kind of a value in words, for messages."""
    kind = kind_of(value)
    return kind if isinstance(kind, str) else f"an object of the class {class_name(kind)}"


def misfit(value: object, present: object) -> StateError:
    """The error for a value of another kind than the present value."""
    return StateError(f"the saved state contains {word_of(value)}, and this simulation has {word_of(present)}")


def is_data(value: object) -> bool:
    """Whether a value is data: its methods do nothing but compute."""
    return is_a(value, _DATA)


def fits(value: object, present: object, new_types: frozenset[type] = frozenset()) -> bool:
    """Whether a value may replace the present value of an attribute that MORSE has set.

    Args:
        new_types: the classes of objects that may take the place of None.
    """
    kind, before = kind_of(value), kind_of(present)
    if kind == before:
        return kind != "a function" or value == present or _names(value) == _names(present)
    return kind == "nothing" or (before == "nothing" and (is_data(value) or kind in new_types))


def fits_roughly(value: object, present: object) -> bool:
    """Whether a value may replace the present value of an attribute that a class of the user has set.

    Such an attribute may get data instead of an object, another component, an object of a related class; and anything
    that cannot be called if it holds nothing at present.
    """
    kind, before = kind_of(value), kind_of(present)
    if is_data(value) or kind == before:
        return True
    if before == "nothing":
        # methods and functions were checked when they were read
        return is_routine(value) or not callable(value)
    if isinstance(kind, str) or isinstance(before, str):
        return False
    return any(base.__module__.partition(".")[0] not in sys.stdlib_module_names for base in _common(kind, before))


def _common(one: type, other: type) -> list[type]:
    return [base for base in one.__mro__ if base in other.__mro__]


def _names(routine: object) -> tuple[str, type]:
    return getattr(routine, "__name__", ""), type(getattr(routine, "__self__", None))


def is_of_morse(cls: type) -> bool:
    """Whether MORSE defines a class."""
    return cls.__module__.partition(".")[0] == "morse"


def own_attributes(cls: type) -> set[str] | None:
    """The attributes that MORSE's classes among the bases of a class set; None for all, if the class is MORSE's."""
    if is_of_morse(cls):
        return None
    return set(properties(cls)).union(*(assigned_by(base) for base in cls.__mro__ if is_of_morse(base)))


@lru_cache(4096)
def new_types(cls: type, name: str) -> frozenset[type]:
    """The classes of MORSE whose objects may take the place of None in an attribute: those that are declared."""
    variable = state_variables(cls).get(name)
    if variable is None or variable.type is object:
        return created_by(cls)
    return frozenset(kind for kind in get_args(variable.type) or (variable.type,) if is_of_morse(kind))


@cache
def created_by(cls: type) -> frozenset[type]:
    """The classes of MORSE that the functions of MORSE's classes among the bases of a class refer to.

    They may create objects of these classes while the simulation runs, such as the trajectory of an arm.
    """
    functions = [function for base in cls.__mro__ if is_of_morse(base) for function in _functions(base)]
    values = [function.__globals__.get(name) for function in functions for name in function.__code__.co_names]
    return frozenset(value for value in values if isinstance(value, type) and is_of_morse(value))


@cache
def assigned_by(cls: type) -> frozenset[str]:
    """The names of the attributes of ``self`` to which a class assigns values, in methods or as cached properties."""
    names = {name for name, value in vars(cls).items() if isinstance(value, cached_property)}
    for function in _functions(cls):
        owner = function.__code__.co_varnames[:1]
        last = None
        for step in dis.get_instructions(function.__code__):
            if step.opname == "STORE_ATTR" and last is not None and (last.argval,) == owner:
                names.add(str(step.argval))
            last = step
    return frozenset(names)


def _functions(cls: type) -> list[FunctionType]:
    functions = [
        inspect.unwrap(getattr(one, "fget", None) or getattr(one, "__func__", one)) for one in vars(cls).values()
    ]
    return [function for function in functions if isinstance(function, FunctionType)]


@cache
def declared(cls: type) -> frozenset[str] | None:
    """The names of the attributes that are the state of a class of MORSE; None for a class of a user."""
    if not is_of_morse(cls) or not any("_state_variables" in vars(base) for base in cls.__mro__):
        return None
    return frozenset(state_variables(cls).keys() | properties(cls).keys()) - _not_state(cls)


@cache
def left_out(cls: type) -> frozenset[str]:
    """The names of the attributes of a class of a user that are not part of its state."""
    ours = [base for base in cls.__mro__ if is_of_morse(base)]
    if not any("_state_variables" in vars(base) for base in ours):
        return _not_state(cls)
    names_of_ours = set().union(*(assigned_by(base) for base in ours))
    users = set().union(*(assigned_by(base) for base in cls.__mro__ if base not in ours))
    return _not_state(cls) | (names_of_ours - users - state_variables(cls).keys() - properties(cls).keys())


def _not_state(cls: type) -> frozenset[str]:
    return frozenset(name for base in cls.__mro__ for name in vars(base).get("not_state", ()))


def is_state(cls: type, name: str) -> bool:
    """Whether an attribute is part of the state of the objects of a class."""
    names = declared(cls)
    return name not in left_out(cls) if names is None else name in names


def state_of(owner: object) -> StateData:
    """The attributes of an object that are part of its state."""
    cls: type = type(owner)
    return {name: value for name, value in vars(owner).items() if is_state(cls, name)}


def check_name(cls: type, name: object) -> None:
    """Raise `StateError` if a state must not set an attribute of that name of objects of a class."""
    if not isinstance(name, str) or (name.startswith("__") and name.endswith("__")):
        raise StateError(f"the saved state is damaged: an attribute has the name {name!r:.40}")
    if not is_state(cls, name):
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
