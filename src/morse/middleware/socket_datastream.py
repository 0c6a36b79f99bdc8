"""The class paths under which clients and scene scripts know the streams of the socket."""

from morse.middleware.socket.datastream import SocketDatastreamManager
from morse.middleware.socket.streams import SocketPublisher, SocketReader

__all__ = ["SocketDatastreamManager", "SocketPublisher", "SocketReader"]
