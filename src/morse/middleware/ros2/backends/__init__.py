"""Backends that transport messages: `morse.middleware.ros2.domain` lists them."""

from __future__ import annotations

import os
import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


_LOOPBACK = b"lo\0"
_DESCRIPTORS = "/proc/self/fd"


def _udp_sockets() -> dict[str, int]:
    """The UDP sockets of this process: their inode and their file descriptors; Linux only."""
    sockets = {}
    for name in os.listdir(_DESCRIPTORS) if os.path.isdir(_DESCRIPTORS) else ():
        try:
            target = os.readlink(f"{_DESCRIPTORS}/{name}")
            if target.startswith("socket:"):
                with socket.socket(fileno=os.dup(int(name))) as one:
                    if one.type == socket.SOCK_DGRAM and one.family in (socket.AF_INET, socket.AF_INET6):
                        sockets[target] = int(name)
        except OSError:  # closed in the meantime
            continue
    return sockets


class Confined:
    """The result.

    Attributes:
        is_certain: whether nothing from other machines is received.
    """

    is_certain = False


@contextmanager
def confined() -> Iterator[Confined]:
    """UDP sockets that are opened in the block accept only packets of this machine, if the system supports it."""
    before = _udp_sockets()
    result = Confined()
    yield result
    after = _udp_sockets()
    result.is_certain = bool(after) and all(_confine(after[name]) for name in after.keys() - before.keys())


def _confine(descriptor: int) -> bool:
    try:
        with socket.socket(fileno=os.dup(descriptor)) as one:
            one.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, _LOOPBACK)
    except (OSError, AttributeError):  # before Linux 5.7 for root only; other systems have no such option
        return False
    return True


def described(result: Confined) -> str:
    """The text for the log."""
    if result.is_certain:
        return "on 127.0.0.1, packets of this machine only"
    return "on 127.0.0.1; this system cannot block packets of other machines: use a firewall"
