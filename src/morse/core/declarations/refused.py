"""Validation of declarations when the class is created."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, get_args

from morse.core.exceptions import MorseDeclarationError
from morse.core.reports.quoting import nearest, shown
from morse.core.units import unit as known_unit

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.core.declarations.fields import DataField, OptionFields, Property, StateVariable
    from morse.core.values import Value

#: the frames of fields
FRAMES: dict[str, str] = {
    "own": "of the component: X forward, Y left, Z up",
    "robot": "of the robot: X forward, Y left, Z up",
    "world": "of the world",
    "start": "the pose of the component at the start",
    "optical": "of a camera: X right, Y down, Z forward",
    "enu": "of the world, X east, Y north, Z up",
    "ned": "of the world, X north, Y east, Z down",
    "ned_as_world": "of the component, if north, east and down were the axes X, Y and Z of the world",
    "frd": "of the component: X forward, Y right, Z down",
    "earth": "of the earth (ECEF): origin in its centre, X to 0° N 0° E, Z to the north pole",
    "utm": "UTM grid: X east, Y north, Z up",
    "wgs84": "longitude, latitude, altitude on the WGS84 ellipsoid",
    "geocentric": "longitude, geocentric latitude, distance from the centre of the earth",
    "joint": "along or about the axis of a joint",
    "none": "of no frame",
}
DTYPES = (
    "bool", "uint8", "uint16", "uint32", "uint64", "int8", "int16", "int32", "int64", "float32", "float64",
)  # fmt: skip
ALLOWED = ("inf", "-inf", "nan", "none")
_ANGLES = ("rad", "deg", "°")
_WORDS = ("string", "str", "text")
_NEAR_ONE = 1e-6


def check_field(field: DataField) -> None:
    """Raise an error for an invalid data field.

    Raises:
        MorseDeclarationError: the message contains the mistake and the known names.
    """
    _check_unit(field.unit)
    _check_name(field.frame, FRAMES, "frame")
    _check_name(field.dtype, DTYPES, "dtype")
    _check_range(field.low, field.high)
    _check_allow(field.allow)
    if field.angle and field.unit not in _ANGLES:
        raise MorseDeclarationError(f"an angle has the unit 'rad' or 'deg', not {field.unit!r}")
    shape = field.shape
    if shape is not None and not (
        isinstance(shape, tuple)
        and shape
        and all(n is None or (isinstance(n, int) and not isinstance(n, bool) and n > 0) for n in shape)
    ):
        raise MorseDeclarationError(f"shape is a tuple of lengths, None for any length, not {shown(shape)}")
    if field.quaternion and shape != (4,):
        raise MorseDeclarationError(f"a quaternion has the shape (4,), not {shape}")
    if field.default is None or (isinstance(field.default, str) and field.type not in _WORDS):
        return  # some defaults are strings that describe the initial value
    _check_default(field)


def _check_default(field: DataField) -> None:
    default, shape = field.default, field.shape
    if shape is not None and not _has_shape(default, shape):
        raise MorseDeclarationError(f"the default {shown(default)} does not have the shape {shape}")
    if shape is not None or field.low is not None or field.high is not None:
        _check_numbers(numbers_in(default), default, field.low, field.high, field.allow)
    if field.quaternion and abs(math.hypot(*numbers_in(default)) - 1.0) > _NEAR_ONE:
        raise MorseDeclarationError(f"the default {shown(default)} of a quaternion does not have the length 1")


def _has_shape(value: object, shape: tuple[int | None, ...]) -> bool:
    shape_of_value = shape_of(value)
    if shape_of_value == (0,) and shape[0] is None:  # an empty list has rows of any length
        return True
    return (
        shape_of_value is not None
        and len(shape_of_value) == len(shape)
        and all(
            expected_size is None or expected_size == size
            for expected_size, size in zip(shape, shape_of_value, strict=True)
        )
    )


def check_property(prop: Property) -> None:
    """Raise an error for an invalid property.

    Raises:
        MorseDeclarationError: the message contains the mistake.
    """
    if not isinstance(prop.name, str) or not prop.name:
        raise MorseDeclarationError(f"the name of a property is a string, not {shown(prop.name)}")
    _check_parameter(prop)


def check_state(variable: StateVariable) -> None:
    """Raise an error for an invalid declaration of state.

    Raises:
        MorseDeclarationError: the message contains the mistake.
    """
    types = get_args(variable.type) or (variable.type,)
    if not all(isinstance(one, type) for one in types):
        raise MorseDeclarationError(f"type is a class such as float, or several as float | None, not {variable.type!r}")
    _check_unit(variable.unit)


def check_option(option: OptionFields) -> None:
    """Raise an error for an invalid option.

    Raises:
        MorseDeclarationError: the message contains the mistake.
    """
    types = option.type if isinstance(option.type, tuple) else (option.type,)
    if not types or not all(isinstance(one, type) for one in types):
        raise MorseDeclarationError(f"type is a class such as float, or a tuple of classes, not {shown(option.type)}")
    _check_parameter(option)


def _check_parameter(parameter: Property | OptionFields) -> None:
    _check_unit(parameter.unit)
    _check_range(parameter.low, parameter.high)
    _check_allow(parameter.allow)
    if not isinstance(parameter.choices, tuple):
        raise MorseDeclarationError(f"choices are given in a tuple, not as {shown(parameter.choices)}")
    default = parameter.default
    if parameter.choices and default is not None and default not in parameter.choices:
        raise MorseDeclarationError(
            f"the default {shown(default)} is not one of the choices {shown(parameter.choices)}"
        )
    if default is not None and (parameter.low is not None or parameter.high is not None):
        _check_numbers(numbers_in(default), default, parameter.low, parameter.high, parameter.allow)


def _check_unit(unit: object) -> None:
    if not isinstance(unit, str):
        raise MorseDeclarationError(f"unit is a string, not {shown(unit)}")
    if unit:
        known_unit(unit)


def _check_name(name: Any, candidates: Iterable[str], what: str) -> None:
    if name and name not in candidates:
        raise MorseDeclarationError(f"the {what} {shown(name)} is unknown{nearest(name, candidates, limit=20)}")


def _check_range(low: float | None, high: float | None) -> None:
    for name, value in (("low", low), ("high", high)):
        if value is not None and (isinstance(value, bool) or not isinstance(value, (int, float)) or value != value):
            raise MorseDeclarationError(f"{name} is a number, not {shown(value)}")
    if low is not None and high is not None and low > high:
        raise MorseDeclarationError(f"low={low:g} is greater than high={high:g}")


def _check_allow(allow: object) -> None:
    if not isinstance(allow, tuple):
        raise MorseDeclarationError(f"allow is a tuple of some of {', '.join(ALLOWED)}, not {shown(allow)}")
    for name in allow:
        _check_name(name, ALLOWED, "value of allow")


def _check_numbers(
    numbers: Iterable[float], default: object, low: float | None, high: float | None, allow: tuple[str, ...]
) -> None:
    for number in numbers:
        inside = (low is None or number >= low) and (high is None or number <= high)
        if not inside and str(float(number)) not in allow:
            bounds = f"{'-inf' if low is None else f'{low:g}'}..{'inf' if high is None else f'{high:g}'}"
            raise MorseDeclarationError(f"the default {shown(default)} is outside {bounds}")


def shape_of(value: Value) -> tuple[int, ...] | None:
    """Return the shape of a number, a list of numbers, a vector or an array; None if the value has no shape."""
    if hasattr(value, "shape"):
        return tuple(value.shape)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return ()
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        return None
    shapes = {shape_of(item) for item in value}
    if not shapes:
        return (0,)
    first = shapes.pop()
    return None if shapes or first is None else (len(value), *first)


def numbers_in(value: Value) -> Iterator[float]:
    """Iterate over the numbers in a number, a list of numbers, a vector or an array."""
    if hasattr(value, "__iter__") and not isinstance(value, (str, bytes, dict)):
        for item in value:
            yield from numbers_in(item)
    elif isinstance(value, (int, float)) or hasattr(value, "dtype"):
        yield float(value)
