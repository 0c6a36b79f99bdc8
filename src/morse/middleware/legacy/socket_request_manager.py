"""The class path of the socket request manager for clients and scene scripts."""

from morse.middleware.socket.request_manager import SocketRequestManager

__all__ = ["SocketRequestManager"]
