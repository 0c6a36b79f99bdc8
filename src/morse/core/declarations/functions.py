"""Functions for declarations in the body of a component class."""

from __future__ import annotations

import sys
from pathlib import PurePath
from typing import TYPE_CHECKING

from morse.core.declarations.fields import DataField, KindUse, Level, OptionFields, Property, StateVariable
from morse.core.declarations.refused import check_field, check_option, check_property, check_state
from morse.core.exceptions import MorseDeclarationError

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, UnionType

    from numpy import ndarray

    from morse.core.declarations.fields import Shape


def _class_body(function: str) -> FrameType:
    frame = sys._getframe(2)
    if "__module__" not in frame.f_locals or "__qualname__" not in frame.f_locals:
        raise SyntaxError(f"{function}() is a declaration: call it in the body of a component class")
    return frame


def _where(frame: FrameType) -> str:
    return f"{PurePath(frame.f_code.co_filename).name}:{frame.f_lineno} {frame.f_locals['__qualname__']}"


def _refused(frame: FrameType, what: str, error: Exception) -> MorseDeclarationError:
    return MorseDeclarationError(f"{_where(frame)}: {what}: {error}")


def add_data(
    name: str,
    default_value: object,
    type: str = "",
    doc: str = "",
    level: str | list[str] | tuple[str, ...] = "all",
    *,
    unit: str = "",
    frame: str = "",
    shape: Shape | int | None = None,
    dtype: str = "",
    low: float | None = None,
    high: float | None = None,
    angle: bool = False,
    quaternion: bool = False,
    allow: tuple[str, ...] = (),
    follows: str | tuple[str, ...] = (),
) -> None:
    """Declare a field of ``local_data``.

    Args:
        name: name of the field, as clients see it.
        default_value: value before the first measurement or command. As in MORSE 1.4, a string may describe the
            initial value of a field of another type, e.g. ``"position of the robot"``: the component then sets it.
        type: type shown in the documentation: ``float``, ``vec3<float>``.
        doc: description of the field.
        level: the abstraction level or levels that have the field, or ``"all"``.
        unit: unit of the value, e.g. ``m/s``, ``rad``, ``°C`` (see `morse.core.units`).
        frame: frame of the value: ``own``, ``robot``, ``world`` ... (see `FRAMES`).
        shape: shape of a list or array of numbers: ``3``, ``(3, 3)``, ``(None, 3)`` for any number of rows.
        dtype: dtype, if the field contains a numpy array.
        low: smallest value of each item; noise is clipped to it, and commands below it are refused.
        high: largest value of each item, likewise.
        angle: whether it is kept in (-pi, pi]; noise wraps around.
        quaternion: whether it is w, x, y, z; noise keeps its length at 1.
        allow: special values that are accepted in spite of the range: ``inf``, ``-inf``, ``nan``, ``none``.
        follows: fields from which `Sensor.report` computes this field; no noise is added to it.

    Raises:
        MorseDeclarationError: the declaration contradicts itself, or names an unknown unit, frame or dtype.
    """
    body = _class_body("add_data")
    if isinstance(shape, int):
        shape = (shape,)
    elif isinstance(shape, list):
        shape = tuple(shape)
    field = DataField(
        default_value,
        type,
        doc,
        level if isinstance(level, str) else tuple(level),
        unit,
        frame,
        (4,) if quaternion and shape is None else shape,
        dtype,
        low,
        high,
        angle,
        quaternion,
        allow,
        (follows,) if isinstance(follows, str) else tuple(follows),
    )
    try:
        if dtype and shape is not None and isinstance(default_value, (list, tuple)):
            field = field._replace(default=_array(default_value, dtype, shape))
        check_field(field)
    except (MorseDeclarationError, TypeError, ValueError) as error:
        raise _refused(body, f"data field {name!r}", error) from None
    body.f_locals.setdefault("_data_fields", {})[name] = field


def _array(default: object, dtype: str, shape: Shape) -> ndarray:
    import numpy as np

    array = np.array(default, dtype)
    return array.reshape([size or 0 for size in shape]) if array.size == 0 and None in shape else array


def add_property(
    python_name: str,
    default_value: object,
    name: str,
    type: str = "",
    doc: str = "",
    *,
    low: float | None = None,
    high: float | None = None,
    choices: tuple[object, ...] = (),
    unit: str = "",
    allow: tuple[str, ...] = (),
    written_by: str = "",
) -> None:
    """Declare a parameter; its value is the attribute ``python_name`` of the component.

    Args:
        python_name: name of the attribute.
        default_value: value if the script sets none; its type determines which values are accepted.
        name: name for scripts and clients.
        type: type shown in the documentation; ``int`` accepts integers only.
        doc: description of the property.
        low: smallest value.
        high: largest value.
        choices: the only allowed values.
        unit: unit of the value, e.g. ``m``, ``deg``.
        allow: allowed special values: ``inf``, ``-inf``, ``nan``, ``none``.
        written_by: the call of the class of scripts that writes it, for messages: nothing else may set it then.

    Raises:
        MorseDeclarationError: the declaration contradicts itself.
    """
    body = _class_body("add_property")
    prop = Property(default_value, name, type, doc, low, high, tuple(choices), unit, allow, written_by)
    try:
        check_property(prop)
    except MorseDeclarationError as error:
        raise _refused(body, f"property {name!r}", error) from None
    body.f_locals.setdefault("_properties", {})[python_name] = prop


def add_state(python_name: str, type: type | UnionType, doc: str, *, unit: str = "") -> None:
    """Declare an attribute that the component keeps from tick to tick, besides fields and properties.

    Saved states and their hashes contain the declared attributes. They contain no other attribute that a class of MORSE
    assigns, because it follows from the scene. Classes of users need no declaration: all of their attributes are saved.

    Args:
        python_name: name of the attribute.
        type: class of its values, or several as ``tuple | None``; ``float`` includes integers.
        doc: description of the value.
        unit: unit of the value.

    Raises:
        MorseDeclarationError: unknown unit, or a type that is not a class.
    """
    body = _class_body("add_state")
    variable = StateVariable(type, doc, unit)
    try:
        check_state(variable)
    except MorseDeclarationError as error:
        raise _refused(body, f"state {python_name!r}", error) from None
    body.f_locals.setdefault("_state_variables", {})[python_name] = variable


def add_level(name: str, classpath: str | None, doc: str = "", default: bool = False) -> None:
    """Declare an abstraction level."""
    _class_body("add_level").f_locals.setdefault("_levels", {})[name] = Level(classpath, doc, default)


def add_kind(
    kind: str | None,
    *,
    level: str | list[str] | tuple[str, ...] = "all",
    when: Callable[..., bool] | None = None,
    topic: str = "",
    on_request: bool = False,
    **slots: object,
) -> None:
    """Declare a message kind of the component, and the sources of the values of its slots.

    The source of a slot is the name of a field; a tuple of names, in which None stands for the constant 0 whose
    commands are ignored; ``euler("roll", "pitch", "yaw")``; ``prop("_range")``; ``mapped("status", full="Charged")``; a
    constant (a string that is not a field, a number, a list of numbers); or, for sensors, a function that takes the
    component and returns the value in the unit of the slot. Units are converted. All sources except constants,
    properties and functions work in both directions, so that the same declaration serves commands.

    A class that declares kinds does not inherit the kinds of its bases; ``add_kind(None)`` declares that the class has
    no kinds.

    Args:
        kind: see `morse.core.kinds`.
        level: the abstraction level or levels that use the kind.
        when: function of the component that returns whether it uses the kind, depending on its properties.
        topic: sub-topic; required if the component uses several kinds at once.
        on_request: whether the kind is used only if the script asks for it.

    Raises:
        MorseDeclarationError: unknown kind or slot, or a slot is missing.
    """
    body = _class_body("add_kind")
    uses: list[KindUse] = body.f_locals.setdefault("_kinds", [])
    if kind is None:
        return
    use = KindUse(kind, slots, level if isinstance(level, str) else tuple(level), when, topic, on_request, _where(body))
    from morse.core.kinds.table import check_use

    check_use(use)
    uses.append(use)


class Option(OptionFields):
    """An option of a modifier, a stream or a middleware; scripts pass it as a keyword argument.

    Attributes:
        type: ``float``, ``int``, ``bool``, ``str``, ``list``, ``dict``, or several in a tuple; ``object`` for anything.
        default: the value if the script gives none.
        shape: shape of a list of numbers.

    Raises:
        MorseDeclarationError: the option contradicts itself; the message contains file and line.
    """

    __slots__ = ()

    if not TYPE_CHECKING:  # type checkers shall see the parameters of the tuple

        def __new__(cls, *args: object, **kwargs: object) -> Option:
            """Check the option, because a class with an option that no value fits must not be created."""
            option = super().__new__(cls, *args, **kwargs)
            try:
                check_option(option)
            except MorseDeclarationError as error:
                caller = sys._getframe(1)
                where = f"{caller.f_code.co_filename}:{caller.f_lineno}"
                raise MorseDeclarationError(f"{where}: option {option.doc!r:.80}: {error}") from None
            return option
