"""A process that has loaded the scene of a study, and starts workers as copies of itself.

It is a program of its own, so that a driver with threads, or without ``if __name__ == "__main__"``, can use it:
``python -m morse.many.forking CONTROL LIFELINE``, the descriptors of a socket and of a pipe. The socket first carries
the description of the study, then one descriptor for each worker that is wanted.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import sys

from morse.launch.load import load
from morse.many.study import Study
from morse.many.worker import end_child, fork_worker, has_ended

_MOST = 1 << 24


def main(control: int, lifeline: int) -> None:
    """Load a study, and fork until the driver closes the socket."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    children: set[int] = set()
    with socket.socket(fileno=control) as connection:
        description, paths = json.loads(_line(connection))
        sys.path[:] = paths
        study = Study.of(description)
        # a scene that cannot be loaded is a result of its runs
        with contextlib.suppress(Exception):
            run = next(study.runs())
            load(study.scene_of(run), seed=run.seed, arguments=study.arguments_of(run)).close()
        while True:
            word, descriptors, _, _ = socket.recv_fds(connection, 1, 1)
            children = {child for child in children if not has_ended(child)}
            if not word:
                for child in children:
                    end_child(child)
                return
            for descriptor in descriptors:
                theirs = socket.socket(fileno=descriptor)
                children.add(fork_worker(study, theirs, lifeline, [connection]))
                theirs.close()


def _line(connection: socket.socket) -> bytes:
    data = b""
    while not data.endswith(b"\n") and len(data) < _MOST:
        # byte for byte at the end would lose descriptors: the driver sends these only after an answer
        part = connection.recv(1 << 16)
        if not part:
            sys.exit(1)
        data += part
    connection.sendall(b"\n")
    return data


if __name__ == "__main__":
    os.environ["MORSE_THREADS"] = "1"
    main(int(sys.argv[1]), int(sys.argv[2]))
