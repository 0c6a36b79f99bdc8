"""What servers of lines of text share: JSON, TCP connections, limits of clients, messages that wait for the tick."""

from morse.wire.encoding import from_json, to_json

__all__ = ["from_json", "to_json"]
