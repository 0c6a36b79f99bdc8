"""The class paths of the socket streams for clients and scene scripts."""

from morse.middleware.socket.datastream import SocketDatastreamManager
from morse.middleware.socket.streams import SocketPublisher, SocketReader

__all__ = ["SocketDatastreamManager", "SocketPublisher", "SocketReader"]
