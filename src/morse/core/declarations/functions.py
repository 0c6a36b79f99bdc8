"""The functions that component classes declare themselves with."""

from __future__ import annotations

import sys
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from morse.core.declarations.fields import DataField, KindUse, Level, Property
from morse.core.declarations.refused import check_field, check_property
from morse.core.exceptions import MorseDeclarationError

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from morse.core.declarations.fields import Shape


def _class_body(function: str) -> FrameType:
    frame = sys._getframe(2)
    if "__module__" not in frame.f_locals or "__qualname__" not in frame.f_locals:
        raise SyntaxError(f"{function}() declares a part of a component: call it in the body of the class")
    return frame


def _where(frame: FrameType) -> str:
    return f"{PurePath(frame.f_code.co_filename).name}:{frame.f_lineno} {frame.f_locals['__qualname__']}"


def _refused(frame: FrameType, what: str, error: Exception) -> MorseDeclarationError:
    return MorseDeclarationError(f"{_where(frame)}: {what}: {error}")


def add_data(
    name: str,
    default_value: Any,
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
        name: of the field, as clients see it.
        default_value: before the first measurement or command.
        type: a word for people: ``float``, ``vec3<float>``.
        doc: what it is.
        level: the abstraction level or levels that have the field, or ``"all"``.
        unit: e.g. ``m/s``, ``rad``, ``°C`` (see `morse.core.units`).
        frame: what it is given in: ``own``, ``robot``, ``world`` ... (see `FRAMES`).
        shape: of a list or array of numbers: ``3``, ``(3, 3)``, ``(None, 3)`` for any number of rows.
        dtype: the field holds a numpy array of this dtype.
        low: smallest number, of each item; noise does not lead below, and commands below are refused.
        high: largest number, likewise.
        angle: kept in (-pi, pi]: noise wraps around.
        quaternion: w, x, y, z; noise keeps it of unit length.
        allow: what may occur although it is in no range: ``inf``, ``-inf``, ``nan``, ``none``.
        follows: fields that `Sensor.report` works this one out from; it has no noise of its own.

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


def _array(default: Any, dtype: str, shape: Shape) -> Any:
    import numpy as np

    array = np.array(default, dtype)
    return array.reshape([size or 0 for size in shape]) if array.size == 0 and None in shape else array


def add_property(
    python_name: str,
    default_value: Any,
    name: str,
    type: str = "",
    doc: str = "",
    *,
    low: float | None = None,
    high: float | None = None,
    choices: tuple[Any, ...] = (),
    unit: str = "",
    allow: tuple[str, ...] = (),
) -> None:
    """Declare a parameter; its value is the attribute ``python_name`` of the component.

    Args:
        python_name: name of the attribute.
        default_value: where the script sets none; it says by its type what is accepted.
        name: as scripts and clients write it.
        type: a word for people; ``int`` takes no fractions.
        doc: what it does.
        low: smallest number.
        high: largest number.
        choices: the only values.
        unit: e.g. ``m``, ``deg``.
        allow: ``inf``, ``-inf``, ``nan``, ``none``.

    Raises:
        MorseDeclarationError: the declaration contradicts itself.
    """
    body = _class_body("add_property")
    prop = Property(default_value, name, type, doc, low, high, tuple(choices), unit, allow)
    try:
        check_property(prop)
    except MorseDeclarationError as error:
        raise _refused(body, f"property {name!r}", error) from None
    body.f_locals.setdefault("_properties", {})[python_name] = prop


def add_level(name: str, classpath: str | None, doc: str = "", default: bool = False) -> None:
    """Declare an abstraction level."""
    _class_body("add_level").f_locals.setdefault("_levels", {})[name] = Level(classpath, doc, default)


def add_kind(
    kind: str | None,
    *,
    level: str | list[str] | tuple[str, ...] = "all",
    when: Callable[[Any], bool] | None = None,
    topic: str = "",
    on_request: bool = False,
    **slots: Any,
) -> None:
    """Declare a message kind that the component speaks, and where its slots come from.

    A slot is given as the name of a field; as a tuple of names, of which None means "none: 0, and a command for it
    is dropped"; as ``euler("roll", "pitch", "yaw")``; as ``prop("_range")``; as ``mapped("status", full="Charged")``;
    as a constant (a word that is not a field, a number, a list of numbers); or, for sensors, as a function that takes
    the component and returns the value in the unit of the slot. Units are converted. All but constants, properties and
    functions work both ways, so that the same declaration serves commands.

    A class that declares kinds does not inherit those of its bases; ``add_kind(None)`` declares that there are none.

    Args:
        kind: see `morse.core.kinds`.
        level: the abstraction level or levels that speak it.
        when: tells of a component, by its properties, whether it does.
        topic: sub-topic; needed if the component speaks several kinds at once.
        on_request: it is spoken only if the script asks for it.

    Raises:
        MorseDeclarationError: unknown kind or slot, or a slot is missing.
    """
    body = _class_body("add_kind")
    uses: list[KindUse] = body.f_locals.setdefault("_kinds", [])
    if kind is None:
        return
    use = KindUse(kind, slots, level if isinstance(level, str) else tuple(level), when, topic, on_request, _where(body))
    from morse.core.kinds.uses import check_use

    check_use(use)
    uses.append(use)
