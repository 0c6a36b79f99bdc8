"""Compares the data of a component with their declarations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.core.declarations import fields_of_component
from morse.core.declarations.refused import numbers_in
from morse.core.reports.hints import closest
from morse.core.sensor import Sensor
from morse.core.validation.fields import spec_of_field

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.declarations.fields import DataField
    from morse.core.object import Object


class Misfit(NamedTuple):
    """A data field that does not match its declaration.

    Attributes:
        field: name of the field.
        declared: whether the field is declared at all.
        text: what is wrong, for a message.
    """

    field: str
    declared: bool
    text: str


def misfits(component: Object, is_checked: Callable[[DataField], bool] = lambda field: True) -> Iterator[Misfit]:
    """Yield the fields of ``local_data`` that are not declared, and those of a sensor with another type or range.

    NaN and infinity are not reported.

    Args:
        is_checked: whether the values of a declared field are checked.
    """
    fields = fields_of_component(component)
    for name, value in component.local_data.items():
        if name not in fields:
            # the data of a compound sensor are those of its members
            if name not in component.context.components:
                near = closest(name, fields)
                hint = f"; did you mean '{near}'?" if near is not None else ""
                yield Misfit(name, False, f"it publishes '{name}' without declaring it: add_data('{name}', ...){hint}")
        elif isinstance(component, Sensor) and is_checked(fields[name]):
            try:
                text = _misfit(value, fields[name])
            except RecursionError:
                text = "is nested too deeply, or contains itself"
            except Exception as error:  # values are objects of any class of users, and their methods may fail
                text = f"cannot be read: {type(error).__name__}: {error!s:.80}"
            if text:
                yield Misfit(name, True, f"the data field '{name}' {text}")


def _misfit(value: object, field: DataField) -> str:
    """Return what is wrong with a value; empty if nothing is."""
    if hasattr(value, "__iter__") and not hasattr(value, "__len__"):
        return f"is {value!r:.80}, which can be read only once"
    if isinstance(value, np.ndarray) and value.dtype.kind in "fiub":
        is_finite = bool(np.isfinite(value).all())
    else:
        is_finite = all(map(math.isfinite, numbers_in(value)))
    if not is_finite:
        return ""
    try:
        spec_of_field(field, field.default).check()(value)
    except ValueError as error:
        return f"is {value!r:.80}, expected {error}"
    return ""
