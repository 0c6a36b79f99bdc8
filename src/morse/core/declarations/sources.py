"""Where the slots of a message come from, beside plain fields: for `add_kind`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping


class Euler(NamedTuple):
    """A quaternion from Euler angles (R = Rz·Ry·Rx), and back.

    Attributes:
        fields: roll, pitch and yaw; or the one field that holds all three.
    """

    fields: tuple[str | None, ...]


class Prop(NamedTuple):
    """A property of the component, by its name in Python.

    Attributes:
        name: e.g. ``_range``.
        scale: a factor, e.g. -0.5 for the first angle of a fan.
    """

    name: str
    scale: float = 1.0


class Scaled(NamedTuple):
    """A field times a factor, and back: colours of 0..1 in a message of 0..255.

    Attributes:
        field: the field.
        factor: number of the message divided by that of the field.
    """

    field: str
    factor: float


class Mapped(NamedTuple):
    """A word of the component in the words of the kind, and back.

    Attributes:
        field: the field that holds the word.
        words: word of the field to word of the slot.
    """

    field: str
    words: Mapping[str, str]


def euler(*fields: str | None) -> Euler:
    """A quaternion from the fields roll, pitch and yaw, or from one field that holds an Euler or three numbers.

    None stands for an angle that the component has not: 0.
    """
    if len(fields) not in (1, 3):
        raise TypeError(f"euler() takes roll, pitch and yaw, or one field that holds all three, not {len(fields)}")
    return Euler(fields)


def prop(name: str, scale: float = 1.0) -> Prop:
    """The value of a property, by the name of its attribute in Python, times ``scale``."""
    return Prop(name, scale)


def scaled(field: str, factor: float) -> Scaled:
    """A field times a factor: ``scaled("colours", 255.0)`` sends 0..1 as 0..255, and takes it back."""
    return Scaled(field, factor)


def mapped(field: str, **words: str) -> Mapped:
    """The word in a field, in other words: ``mapped("status", full="Charged")`` shows ``Charged`` as ``full``."""
    return Mapped(field, {own: of_kind for of_kind, own in words.items()})
