"""Sources of slots other than plain fields, for `add_kind`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.values import Value


class Euler(NamedTuple):
    """A quaternion from Euler angles (R = Rz·Ry·Rx), and back.

    Attributes:
        fields: the fields roll, pitch and yaw; or one field with all three angles.
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
    """A field times a factor, in both directions: colours 0..1 in the field, 0..255 in the message.

    Attributes:
        field: the field.
        factor: value in the message divided by the value in the field.
    """

    field: str
    factor: float


class Computed(NamedTuple):
    """A function of the data of the component.

    Attributes:
        function: takes the data fields by name and the properties, and uses nothing else: it may be called later, in
            any thread.
        properties: names of attributes of the component, in Python.
        by_rows: whether the function also takes the data of many ticks, whose fields have a first axis of rows.
        axes: for covariances: the fields whose noise is that of the axes of the slot.
    """

    function: Callable[..., Value]
    properties: tuple[str, ...] = ()
    by_rows: bool = False
    axes: tuple[str, ...] = ()


class Each(NamedTuple):
    """The fields whose names an attribute of the component lists, e.g. one for each joint of its model.

    Attributes:
        attribute: the name of the attribute, which holds a sequence of names of fields.
        among: name of an attribute that lists those fields to which the slot applies at present; empty for all.
    """

    attribute: str
    among: str = ""


class Mapped(NamedTuple):
    """Translation between the words of a field and the words of a slot, in both directions.

    Attributes:
        field: the field that contains the word.
        words: word of the field to word of the slot.
    """

    field: str
    words: Mapping[str, str]


def euler(*fields: str | None) -> Euler:
    """Return a source for a quaternion from the fields roll, pitch and yaw, or from one field with three angles.

    None stands for an angle that the component does not have; the angle is 0.
    """
    if len(fields) not in (1, 3):
        raise TypeError(f"euler() takes roll, pitch and yaw, or one field that contains all three, not {len(fields)}")
    return Euler(fields)


def prop(name: str, scale: float = 1.0) -> Prop:
    """Return a source for the value of a property times ``scale``; ``name`` is its attribute in Python."""
    return Prop(name, scale)


def scaled(field: str, factor: float) -> Scaled:
    """Return a source for a field times a factor: ``scaled("colours", 255.0)`` maps 0..1 to 0..255 and back."""
    return Scaled(field, factor)


def computed(
    function: Callable[..., object], *properties: str, by_rows: bool = False, axes: tuple[str, ...] = ()
) -> Computed:
    """Return a source for a function of the data fields, which uses nothing else of the component.

    Args:
        function: takes the data fields by name, and the properties.
        properties: names of properties in Python, whose values are the other arguments.
        by_rows: whether the function also takes the data of many ticks, whose fields have a first axis of rows.
        axes: for covariances: the fields whose noise is that of the axes of the slot.
    """
    return Computed(function, properties, by_rows, axes)


def each(attribute: str, among: str = "") -> Each:
    """The fields whose names an attribute of the component lists, side by side; as words, these names.

    Args:
        attribute: name of the attribute.
        among: name of an attribute that lists those fields to which the slot applies at present. The other fields are
            NaN in messages, and commands do not set them.
    """
    return Each(attribute, among)


def mapped(field: str, **words: str) -> Mapped:
    """Return a source that translates words: ``mapped("status", full="Charged")`` sends ``Charged`` as ``full``."""
    return Mapped(field, {own: of_kind for of_kind, own in words.items()})
