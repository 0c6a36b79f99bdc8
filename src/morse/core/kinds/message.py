"""The message object that middlewares receive."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.kinds.kind import Kind


class Message:
    """The data of a component at one time.

    Every slot of the kind can be read as an attribute: ``message.position``. Arrays are C-contiguous numpy arrays
    of the dtype of the slot, read-only; single values are Python objects. A slot that the component does not fill is
    None.

    Attributes:
        kind: see `morse.core.kinds.KINDS`.
        stamp: simulated time of the measurement, whole ns.
        frame: frame of the first slot, see `morse.core.declarations.FRAMES`.
        slots: values by slot name; in a ``general`` message the data fields, in the order of their declaration.
    """

    __slots__ = ("frame", "kind", "slots", "stamp")

    def __init__(self, kind: Kind, stamp: int, frame: str, slots: Mapping[str, Any]) -> None:
        self.kind, self.stamp, self.frame, self.slots = kind, stamp, frame, slots

    @property
    def fields(self) -> Mapping[str, Any]:
        """The data fields of a ``general`` message, by name."""
        return self.slots

    def __getattr__(self, name: str) -> Any:
        try:
            return self.slots[name]
        except KeyError:
            if name in self.kind.slots:
                return None
            raise AttributeError(f"a message of kind '{self.kind.name}' has no slot '{name}'") from None

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.slots.items())
        return f"{self.kind.name}(stamp={self.stamp}, frame={self.frame!r}, {inside})"
