"""Exceptions of clients."""

from __future__ import annotations


def printable(text: str) -> str:
    """Return a text of a server for a terminal: characters that control it are escaped, except for line ends."""
    return "".join(one if one in "\n\t" or one.isprintable() else one.encode("unicode_escape").decode() for one in text)


class MorseServiceError(Exception):
    """Base class for all answers other than success."""


class MorseServiceFailed(MorseServiceError):
    """The service could not be run, or failed; the message contains the reason."""


class MorseServicePreempted(MorseServiceError):
    """The service was cancelled, or interrupted by a newer call."""

    def __init__(self, value: object = None) -> None:
        super().__init__("the service was cancelled, or interrupted by a newer call" if value is None else value)


class MorseTimeoutError(RuntimeError, TimeoutError):
    """The simulation did not answer within the timeout."""


class NoSuchComponentError(KeyError, AttributeError):
    """The robot has no component or service of that name."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""
