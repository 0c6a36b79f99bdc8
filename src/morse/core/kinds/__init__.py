"""Message kinds: what middlewares carry, whatever the component.

A component names its kinds and says which field is which slot (`morse.core.declarations.add_kind`). A middleware maps
kinds, never components: it asks for the messages of a component by `bind`, and gathers one when there is a reader.
"""

from morse.core.kinds.binding import BoundKind, KindError, bind, fields_of, findings_of
from morse.core.kinds.kind import Kind, Slot
from morse.core.kinds.message import Message
from morse.core.kinds.table import GENERAL, KINDS

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
