"""Keeps the sockets of DDS on the loopback interface.

DDS libraries send through the interface that they are told, but receive on all of them: a stranger could find the
ports. Linux lets a socket take packets of one interface alone.
"""

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
    """The UDP sockets of this process: what the system calls them, and their file descriptors; Linux only."""
    found = {}
    for name in os.listdir(_DESCRIPTORS) if os.path.isdir(_DESCRIPTORS) else ():
        try:
            target = os.readlink(f"{_DESCRIPTORS}/{name}")
            if target.startswith("socket:"):
                with socket.socket(fileno=os.dup(int(name))) as one:
                    if one.type == socket.SOCK_DGRAM and one.family in (socket.AF_INET, socket.AF_INET6):
                        found[target] = int(name)
        except OSError:  # it was closed meanwhile
            continue
    return found


class Confined:
    """What came of it.

    Attributes:
        is_certain: nothing from other machines is received.
    """

    is_certain = False


@contextmanager
def confined() -> Iterator[Confined]:
    """UDP sockets that are opened in the block take packets of this machine alone, where the system can do that."""
    before = _udp_sockets()
    result = Confined()
    yield result
    after = _udp_sockets()
    result.is_certain = bool(after) and all(_confine(after[name]) for name in after.keys() - before.keys())


def _confine(descriptor: int) -> bool:
    try:
        with socket.socket(fileno=os.dup(descriptor)) as one:
            one.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, _LOOPBACK)
    except (OSError, AttributeError):  # before Linux 5.7 for the administrator alone; other systems have no such option
        return False
    return True


def described(result: Confined) -> str:
    """What the log says."""
    if result.is_certain:
        return "on 127.0.0.1, packets of this machine alone"
    return "on 127.0.0.1; this system cannot keep packets of other machines out: use a firewall"
