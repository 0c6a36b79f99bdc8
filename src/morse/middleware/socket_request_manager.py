"""The class path under which clients and scene scripts know the request manager of the socket."""

from morse.middleware.socket.request_manager import SocketRequestManager

__all__ = ["SocketRequestManager"]
