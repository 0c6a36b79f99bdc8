"""Errors of recordings."""

from morse.core.exceptions import MorseError


class RecordingError(MorseError):
    """A recording cannot be written, or a file is not a readable recording."""
