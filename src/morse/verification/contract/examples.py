"""Commands and values for checks: some valid ones, and many invalid ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.declarations import fields_of_component

if TYPE_CHECKING:
    from morse.core.declarations import DataField
    from morse.core.object import Object
    from morse.core.values import Fields

#: a number that is valid for most quantities
_SOME = 0.3
_deep: list[object] = []
for _ in range(100):
    _deep = [_deep]
_endless: Fields = {}
_endless["again"] = _endless

#: invalid or malicious values of clients
BAD_VALUES: tuple[object, ...] = (
    None, True, "nonsense", "", "\ud800", b"bytes", math.nan, math.inf, -math.inf, 1e308, -1e308, 1e30, -1e30, 5e-324,
    -1, 0, 10**400, 2**63, [], {}, [[]], [math.nan] * 3, [1e308] * 3, ["a", "b", "c"], [1.0] * 1000, {"x": None}, _deep,
    _endless, object(),
)  # fmt: skip


def example(component: Object) -> Fields:
    """A valid command for an actuator."""
    declarations = fields_of_component(component)
    values = {
        name: _example(declarations[name], initial)
        for name, initial in component.local_data.items()
        if name in declarations
    }
    return {name: value for name, value in values.items() if value is not None}


def _example(field: DataField, value: Any) -> object:
    if isinstance(value, bool):
        return not value
    if isinstance(value, (int, float)):
        return _inside(type(value)(value + _SOME), field)
    if field.shape is not None and not field.quaternion and None not in field.shape and len(field.shape) == 1:
        return [_inside(float(number) + _SOME, field) for number in value]
    return None


def _inside(number: Any, field: DataField) -> object:
    if field.low is not None and number < field.low:
        return field.low
    return field.high if field.high is not None and number > field.high else number
