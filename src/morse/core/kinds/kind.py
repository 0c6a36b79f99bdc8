"""The declaration of a message kind: slots with shape, unit and frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from morse.core.declarations.fields import Shape  # noqa: TC001 - part of the annotations of a NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.values import Value


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


class Message:
    """The data of a component at one time.

    A message has two forms: `slots`, which have the names, units and frames of the kind, and `fields`, which are the
    data as the component declares them. A ``general`` message has the same names in both.

    Every slot of the kind can be read as an attribute: ``message.position``. Arrays are C-contiguous numpy arrays
    of the dtype of the slot, read-only; single values are Python objects. A slot that the component does not fill is
    None.

    Args:
        stamp: simulated time of the measurement, whole ns, or the function that computes it.
        slots: values by slot name, or the function that computes them when they are first read.
        fields: data of the component by name; default: the slots.

    Attributes:
        kind: see `morse.core.kinds.KINDS`.
        frame: frame of the first slot, see `morse.core.declarations.FRAMES`.
        topic: sub-topic of the topic of the component; empty for the topic itself.
    """

    __slots__ = ("_fields", "_slots", "_stamp", "frame", "kind", "topic")

    def __init__(
        self,
        kind: Kind,
        stamp: int | Callable[[], int],
        frame: str,
        slots: Mapping[str, object] | Callable[[], Mapping[str, object]],
        fields: Mapping[str, object] | None = None,
        topic: str = "",
    ) -> None:
        self.kind, self.frame, self.topic = kind, frame, topic
        self._stamp, self._slots, self._fields = stamp, slots, fields

    @property
    def stamp(self) -> int:
        """Simulated time of the measurement, whole ns, even if the data are delivered later."""
        stamp = self._stamp
        if callable(stamp):
            stamp = self._stamp = stamp()
        return stamp

    def complete(self) -> Message:
        """Compute everything now, so that the message can be read after its tick, in any thread."""
        _ = self.stamp, self.slots
        return self

    @property
    def slots(self) -> Mapping[str, Value]:
        """Values by slot name. They are computed when they are first read, which must be in the tick of the message."""
        slots = self._slots
        if callable(slots):
            slots = self._slots = slots()
        return slots

    @property
    def fields(self) -> Mapping[str, Value]:
        """The data of the component by field name, in the order of their declaration.

        They are those of the component itself: do not change them, and copy those that are needed after the tick.
        """
        return self.slots if self._fields is None else self._fields

    def __getattr__(self, name: str) -> Value:
        try:
            return self.slots[name]
        except KeyError:
            if name in self.kind.slots:
                return None
            raise AttributeError(f"a message of kind '{self.kind.name}' has no slot '{name}'") from None

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.slots.items())
        return f"{self.kind.name}(stamp={self.stamp}, frame={self.frame!r}, {inside})"
