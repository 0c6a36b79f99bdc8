"""A message as pymavlink decodes it."""

from __future__ import annotations

from typing import Any, Protocol


class MavlinkMessage(Protocol):
    """A message of the dialect; its fields are attributes by the names of the dialect.

    pymavlink makes the classes of messages at run time and has no types for them.
    """

    def get_type(self) -> str:
        """The name of the message, in upper case."""

    def __getattr__(self, field: str) -> Any:
        """A field: a number, a string, or a list of numbers."""
