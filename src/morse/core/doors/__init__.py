"""Where clients come in: every server of a simulation accepts its connections through a `Door`."""

from morse.core.doors.descriptors import DESCRIPTORS, Descriptors
from morse.core.doors.door import Door, Guest, Lobby, lobby_of

__all__ = ["DESCRIPTORS", "Descriptors", "Door", "Guest", "Lobby", "lobby_of"]
