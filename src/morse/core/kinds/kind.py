"""The declaration of a message kind: slots with shape, unit and frame."""

from __future__ import annotations

from typing import NamedTuple

from morse.core.declarations.fields import Shape  # noqa: TC001 - part of the annotations of a NamedTuple

#: how a slot changes when it is converted into another frame
POINT, VECTOR, ORIENTATION, FREE = "point", "vector", "orientation", ""


class Slot(NamedTuple):
    """A part of a message.

    Attributes:
        name: name of the slot.
        shape: shape of the value; ``()`` for a single value, None for an axis of any length.
        dtype: numpy dtype; or ``str`` or ``bool``.
        unit: see `morse.core.units`; empty for none.
        frame: frame of the value unless the field declares another frame; empty for none.
        optional: whether a message may be without this slot.
        moves: how the value changes with the frame: ``point``, ``vector``, ``orientation``, or empty for not at all.
        choices: the allowed strings; empty for any.
        covariance_of: the slots whose covariance this slot contains, in the order of its axes.
        shapes: other shapes that are accepted.
        dtypes: other dtypes that are accepted.
        doc: description of the slot.
    """

    name: str
    shape: Shape = ()
    dtype: str = "float64"
    unit: str = ""
    frame: str = ""
    optional: bool = False
    moves: str = FREE
    choices: tuple[str, ...] = ()
    covariance_of: tuple[str, ...] = ()
    shapes: tuple[Shape, ...] = ()
    dtypes: tuple[str, ...] = ()
    doc: str = ""


class Kind(NamedTuple):
    """A message kind.

    Attributes:
        name: name for components and middlewares.
        slots: slots by name, in order.
        published: whether sensors send it.
        commanded: whether actuators receive it.
        version: changes when a slot changes its unit, frame, shape or meaning.
        doc: one sentence.
    """

    name: str
    slots: dict[str, Slot]
    published: bool
    commanded: bool
    version: int
    doc: str
