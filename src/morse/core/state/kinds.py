"""The kinds of values: an attribute that MORSE has set keeps its kind when a state is restored.

Without this rule, a state could put an object with other methods in the place of a pose, and the next tick would call
them.
"""

from __future__ import annotations

import dis
import inspect
import sys
from collections import deque
from functools import cache, cached_property
from types import (
    BuiltinFunctionType,
    ClassMethodDescriptorType,
    FunctionType,
    MethodDescriptorType,
    MethodType,
    MethodWrapperType,
    WrapperDescriptorType,
)
from typing import Final

import numpy as np

from morse.core.declarations import properties
from morse.core.reports.faults import class_name, is_a
from morse.core.state.errors import StateError
from morse.core.state.simple import TAKEN_APART
from morse.helpers.transformation import Transformation3d
from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

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
