"""TCP ports to listen on."""

from __future__ import annotations

import argparse
import contextlib
import errno
import os
import socket
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError

if TYPE_CHECKING:
    from collections.abc import Iterable

_TAKEN = (errno.EADDRINUSE, errno.EACCES, getattr(errno, "WSAEACCES", errno.EACCES))


def listen(host: str, ports: Iterable[int]) -> socket.socket:
    """Listen on the first free port of several.

    Args:
        host: address of this machine; ``0.0.0.0`` for all networks.
        ports: in order of preference; 0 for any free port.

    Returns:
        A listening socket.

    Raises:
        MorseMiddlewareError: all ports are in use, or ``host`` is not an address of this machine.
    """
    attempts = []
    for port in ports:
        try:
            return _bound(host, port)
        except OSError as error:
            if error.errno not in _TAKEN:
                raise MorseMiddlewareError(f"cannot listen on {host}:{port}: {error.strerror or error}") from None
            attempts.append(port)
    if not attempts:
        raise MorseMiddlewareError("no port to listen on")
    which = f"port {attempts[0]} is" if len(attempts) == 1 else f"ports {attempts[0]} to {attempts[-1]} are"
    raise MorseMiddlewareError(f"{which} in use on {host}: end the programs that use them, or take other ports")


def _bound(host: str, port: int) -> socket.socket:
    family, kind, protocol, _, address = socket.getaddrinfo(
        host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
    )[0]
    listener = socket.socket(family, kind, protocol)
    try:
        # a simulation that has just ended leaves its ports in TIME_WAIT, which this option ignores;
        # on Windows the same option would let two programs share a port
        if os.name == "posix":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen()
        listener.setblocking(False)
    except BaseException:
        listener.close()
        raise
    return listener


def port_number(text: str, least: int) -> int:
    """Return a TCP port.

    Args:
        text: the argument.
        least: 0 where it stands for any free port, else 1.

    Raises:
        ArgumentTypeError: it is not a port.
    """
    if not (text.isascii() and text.isdecimal() and len(text) <= 5 and least <= int(text) < 1 << 16):
        raise argparse.ArgumentTypeError(f"'{text:.40}' is not a TCP port from {least} to 65535")
    return int(text)


def port_of(listener: socket.socket) -> int:
    """The port of a listening socket."""
    return int(listener.getsockname()[1])


def allow_many_sockets() -> None:
    """Raise the limit of file descriptors to the maximum: every stream has its own port."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # not available on Windows, which has no such limit

        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        target = 1 << 16 if hard == resource.RLIM_INFINITY else min(hard, 1 << 16)
        if soft != resource.RLIM_INFINITY and soft < target:
            resource.setrlimit(resource.RLIMIT_NOFILE, (target, hard))
