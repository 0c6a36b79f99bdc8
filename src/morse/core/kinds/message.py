"""The message object that middlewares receive."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.kinds.kind import Kind
    from morse.core.values import Value


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
