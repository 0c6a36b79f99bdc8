"""The program that does runs for a driver: ``python -m morse.many.forking``.

It has loaded the scene of a study, and starts workers as copies of itself; on systems without copies it is the worker.
A program of its own, it serves a driver with threads, or without ``if __name__ == "__main__"``. The driver first sends
the description of the study, then one end of a connection for each worker that it wants.
"""

from __future__ import annotations

import contextlib
import json
import signal
import sys
from multiprocessing import reduction
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from morse.launch.load import load
from morse.many.executors import StudyServer
from morse.many.study import Study
from morse.system.workers import GRACE, end_all, program_connection, serve, start_copy

if TYPE_CHECKING:
    from multiprocessing.process import BaseProcess


def main() -> None:
    """Load a study, and serve until the driver closes the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection = program_connection()
    description, paths, copies_itself = json.loads(connection.recv_bytes())
    sys.path[:] = paths
    study = Study.of(description)
    # a scene that cannot be loaded is a result of its runs
    with contextlib.suppress(Exception):
        run = next(study.runs())
        load(study.scene_of(run), seed=run.seed, arguments=study.arguments_of(run)).close()
    connection.send_bytes(b"loaded")
    if not copies_itself:
        serve(connection, lambda: StudyServer(study))
        return
    copies: list[BaseProcess] = []
    with contextlib.suppress(EOFError, OSError):
        while True:
            with Connection(reduction.recv_handle(connection)) as theirs:
                copies = [copy for copy in copies if copy.is_alive()]
                copies.append(start_copy(theirs, StudyServer, study, daemon=False))
    # sooner than the driver kills this process
    end_all(copies, GRACE / 2.0)


if __name__ == "__main__":
    main()
