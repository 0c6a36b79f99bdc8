"""What a message kind is: slots with shape, unit and frame."""

from __future__ import annotations

from typing import NamedTuple

from morse.core.declarations.fields import Shape  # noqa: TC001 - part of the annotations of a NamedTuple

#: how a slot changes when it is brought into another frame
POINT, VECTOR, ORIENTATION, FREE = "point", "vector", "orientation", ""


class Slot(NamedTuple):
    """A part of a message.

    Attributes:
        name: of the slot.
        shape: ``()`` for a single value, None in it for any length.
        dtype: of numpy; ``str`` for words, ``bool``.
        unit: see `morse.core.units`; empty for none.
        frame: the frame that it is in unless the field says otherwise; empty for none.
        optional: a message may lack it.
        moves: how it changes with the frame: ``point``, ``vector``, ``orientation``, or not at all.
        choices: the words it can be; empty for any.
        covariance_of: the slots whose covariance it is, in the order of its axes.
        shapes: other shapes that it may have.
        dtypes: other dtypes that it may have.
        doc: what it is.
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
        name: as components and middlewares call it.
        slots: by name, in order.
        published: sensors speak it.
        commanded: actuators understand it.
        version: changes when a slot changes its unit, frame, shape or meaning.
        doc: one sentence.
    """

    name: str
    slots: dict[str, Slot]
    published: bool
    commanded: bool
    version: int
    doc: str
