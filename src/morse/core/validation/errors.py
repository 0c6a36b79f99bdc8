"""Errors of the validation."""

from __future__ import annotations

from morse.core.exceptions import MorseError, MorseRPCTypeError


class CommandError(MorseError, ValueError):
    """A message is not valid for a component.

    Attributes:
        field: name of the invalid field, shortened and escaped, or an empty string.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(message)
        self.field = field


class PropertyError(MorseRPCTypeError, ValueError, TypeError):
    """A property does not exist, or its value is not valid."""


class OptionError(MorseError, ValueError):
    """An option of a modifier or a stream does not exist, or its value is not valid."""
