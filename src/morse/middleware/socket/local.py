"""A Unix socket for clients of the same user on the same machine."""

from __future__ import annotations

import contextlib
import os
import socket
import stat

from morse.core.exceptions import MorseMiddlewareError
from morse.system import variables

#: the environment variable with its path; without it there is none
PATH_VARIABLE = "MORSE_SOCKET_PATH"
#: read and write for the owner only
_MODE = 0o600


def wanted_path() -> str | None:
    """The path in the environment variable, or None."""
    return variables.text(PATH_VARIABLE) or None


def listen_locally(path: str) -> socket.socket:
    """Listen on a Unix socket that only its owner may use; a socket that an ended program has left is replaced.

    Raises:
        MorseMiddlewareError: another program listens there, the path is that of another file, or cannot be used.
    """
    if not hasattr(socket, "AF_UNIX"):
        raise MorseMiddlewareError(f"{PATH_VARIABLE}: this system has no Unix sockets")
    _remove_left_over(path)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    # without the mask, others could connect before the mode is set
    mask = os.umask(0o777 & ~_MODE)
    try:
        listener.bind(path)
        os.chmod(path, _MODE)
        listener.listen()
        listener.setblocking(False)
    except OSError as error:
        listener.close()
        raise MorseMiddlewareError(f"{PATH_VARIABLE}: cannot listen on {path}: {error.strerror or error}") from None
    finally:
        os.umask(mask)
    return listener


def _remove_left_over(path: str) -> None:
    try:
        mode = os.lstat(path).st_mode
    except OSError:
        return
    if not stat.S_ISSOCK(mode):
        raise MorseMiddlewareError(f"{PATH_VARIABLE}: {path} exists and is no socket; set another path")
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(1.0)
        try:
            probe.connect(path)
        except ConnectionRefusedError:
            with contextlib.suppress(OSError):
                os.unlink(path)
            return
        except OSError as error:
            raise MorseMiddlewareError(f"{PATH_VARIABLE}: {path} cannot be used: {error.strerror}") from None
    raise MorseMiddlewareError(f"{PATH_VARIABLE}: another simulation listens on {path}; set another path")


def remove(path: str) -> None:
    """Remove the file of a socket that nobody listens on any more."""
    with contextlib.suppress(OSError, MorseMiddlewareError):
        _remove_left_over(path)
