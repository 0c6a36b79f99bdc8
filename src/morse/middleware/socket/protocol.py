"""The wire format of service calls.

A request is ``id component service [arguments]`` or ``id cancel``, a reply ``id STATUS [value]``, one per
line. Arguments are a JSON list. A value that is false in Python is omitted from a reply.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core import status
from morse.core.reports.quoting import short
from morse.wire.encoding import from_json, to_json

if TYPE_CHECKING:
    from morse.core.values import Value


_LONGEST_ID = 256
_FALSE = frozenset((b"null", b"false", b"0", b"0.0", b"-0.0", b"[]", b"{}", b'""'))


class MalformedRequest(ValueError):
    """A line that is not a request.

    Attributes:
        request: the id of the reply.
    """

    def __init__(self, request: str, message: str) -> None:
        super().__init__(f"Malformed request! {message}")
        self.request = request


class Request(NamedTuple):
    """A service call; ``service`` is None for a cancellation."""

    id: str
    component: str
    service: str | None
    arguments: list[Value]


def parse_request(line: bytes) -> Request | None:
    """Parse a line; None if it is blank.

    Raises:
        MalformedRequest: the line is not a request.
    """
    words = line.decode("utf-8", "replace").split(maxsplit=3)
    if not words:
        return None
    request = words[0]
    if len(request) > _LONGEST_ID:
        raise MalformedRequest(short(request), f"the id of a request has at most {_LONGEST_ID} characters")
    if len(words) == 2 and words[1] == "cancel":
        return Request(request, "", None, [])
    if len(words) < 3:
        raise MalformedRequest(request, "expected: id component service [arguments as a JSON list]")
    arguments: Any = []
    if len(words) == 4:
        try:
            arguments = from_json(words[3].rstrip().encode())
        except ValueError as error:
            raise MalformedRequest(request, f"the arguments are no JSON ({error}): {short(words[3])}") from None
        if not isinstance(arguments, list):
            raise MalformedRequest(request, f"the arguments have to be a JSON list: {short(words[3])}")
    return Request(request, words[1], words[2], arguments)


def format_reply(request: str, outcome: str, value: object) -> bytes:
    """Format a reply, with the line end.

    If the value cannot be encoded, the reply is a failure with the reason.
    """
    if value is None:
        return f"{request} {outcome}\n".encode()
    try:
        text = to_json(value)
    except (TypeError, ValueError) as error:
        outcome, text = status.FAILED, to_json(f"the result cannot be sent: {error}")
    head = f"{request} {outcome}".encode()
    return head + b"\n" if text in _FALSE else b"%b %b\n" % (head, text)


def format_failure(request: str, message: str) -> bytes:
    """Format a reply with an error message."""
    return format_reply(request, status.FAILED, message)
