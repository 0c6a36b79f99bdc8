"""Errors of saved states."""

from morse.core.exceptions import MorseError


class StateError(MorseError):
    """A saved state is damaged, or belongs to another scene."""
