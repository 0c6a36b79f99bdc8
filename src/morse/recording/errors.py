"""What can be wrong with a recording."""

from morse.core.exceptions import MorseError


class RecordingError(MorseError):
    """A recording cannot be made, or a file is no recording that can be read."""
