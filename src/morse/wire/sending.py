"""Sends without a thread switch."""

from __future__ import annotations

import ctypes
import os
import socket
from typing import Any

#: size above which copying into the buffers of the system takes longer than a thread switch, bytes
_LARGE = 1 << 15


def _system_call() -> Any:
    """The ``send`` function of the system without releasing the GIL, or None.

    A send takes about 5 µs. `socket.socket.send` releases the GIL for that time. The simulation thread acquires it, so
    that the network thread has to wait for it after each send, and both threads are woken up and put to sleep.
    """
    if os.name != "posix":
        return None
    try:
        function = ctypes.PyDLL(None, use_errno=True).send
    except (OSError, AttributeError):
        return None
    function.argtypes = (ctypes.c_int, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_int)
    function.restype = ctypes.c_ssize_t
    return function


_send = _system_call()
#: a disconnected reader must not end the process by a signal
_FLAGS = getattr(socket, "MSG_DONTWAIT", 0) | getattr(socket, "MSG_NOSIGNAL", 0)


def send_now(sock: socket.socket, data: bytes) -> int:
    """Send the bytes that the system accepts now; returns their number.

    Raises:
        BlockingIOError: the system accepts no bytes now.
        OSError: the connection is closed.
    """
    if _send is None or len(data) >= _LARGE:
        return sock.send(data)
    count = int(_send(sock.fileno(), data, len(data), _FLAGS))
    if count < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return count
