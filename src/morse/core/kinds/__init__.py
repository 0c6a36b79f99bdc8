"""Message kinds: the messages that middlewares carry, independent of the component.

A component declares its kinds and the field for each slot (`morse.core.declarations.add_kind`). A middleware maps
kinds, never components: it gets the message kinds of a component from `bind`, and creates a message when there is a
reader.
"""

from morse.core.kinds.binding import BoundKind, KindError, bind, fields_of, findings_of
from morse.core.kinds.table import GENERAL, KINDS, Kind, Message, Slot

__all__ = [
    "GENERAL",
    "KINDS",
    "BoundKind",
    "Kind",
    "KindError",
    "Message",
    "Slot",
    "bind",
    "fields_of",
    "findings_of",
]
