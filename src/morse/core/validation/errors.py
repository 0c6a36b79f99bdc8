"""The errors of checks."""

from __future__ import annotations

from morse.core.exceptions import MorseError, MorseRPCTypeError


class CommandError(MorseError, ValueError):
    """A message does not fit the component.

    Attributes:
        field: the field that does not fit, shortened and escaped, or an empty string.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(message)
        self.field = field


class PropertyError(MorseRPCTypeError, ValueError, TypeError):
    """A property does not exist, or takes another value."""


class OptionError(MorseError, ValueError):
    """An option of a modifier or a stream does not exist, or takes another value."""
