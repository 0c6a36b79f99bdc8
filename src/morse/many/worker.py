"""A process that does runs, one after the other, for a driver at the other end of a socket."""

from __future__ import annotations

import contextlib
import faulthandler
import json
import os
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from morse.core.reports.printing import echo
from morse.many.run import Run, run_once
from morse.many.stock import Stock

if TYPE_CHECKING:
    import socket

    from morse.many.run import Runs

#: wall-clock time after which a worker is killed: one that is stopped, or whose code never lets its threads run, s
_GRACE = 2.0
#: wall-clock time beyond the limit of a run after which its process ends, s
_STUCK = 30.0


def serve(study: Runs, connection: socket.socket, lifeline: int) -> None:
    """Do runs until the driver closes the connection; messages are lines of JSON.

    Args:
        lifeline: descriptor of a pipe whose other end only the driver has: when it dies, this process ends.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the driver ends the workers
    threading.Thread(target=_end_with_driver, args=(lifeline,), daemon=True).start()
    stock = Stock()
    with contextlib.suppress(ConnectionError), connection, connection.makefile("rwb") as lines:
        for line in lines:
            name, parameters, seed, record = json.loads(line)
            if study.timeout is not None:  # code that never returns to Python
                faulthandler.dump_traceback_later(study.timeout + _STUCK, exit=True)
            row = run_once(study, Run(name, parameters, seed), record, stock)
            faulthandler.cancel_dump_traceback_later()
            lines.write(json.dumps(row).encode() + b"\n")
            lines.flush()


def _end_with_driver(lifeline: int) -> None:
    with contextlib.suppress(OSError):
        os.read(lifeline, 1)
    os._exit(1)


def end_child(pid: int) -> None:
    """Wait until a worker whose driver has closed its connection or its pipe ends; kill it if it does not."""
    until = time.monotonic() + _GRACE
    while not has_ended(pid):
        if time.monotonic() > until:
            os.kill(pid, signal.SIGKILL)
        time.sleep(0.005)


def has_ended(pid: int) -> bool:
    """Whether a worker that this process has started has ended."""
    try:
        return os.waitpid(pid, os.WNOHANG)[0] != 0
    except ChildProcessError:  # code of the user ignores or collects the ends of processes
        return True


def fork_worker(study: Runs, connection: socket.socket, lifeline: int, close: list[Any]) -> int:
    """Start a worker as a copy of this process; return its process id.

    Args:
        close: sockets and files of this process that the worker has to close.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid:
        return pid
    status = 1
    try:
        for one in close:
            one.close()
        serve(study, connection, lifeline)
        status = 0
    except BaseException as error:
        with contextlib.suppress(Exception):
            echo(f"a worker has ended: {error!r}", err=True)
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(status)
