"""The program of a worker on this machine: ``python -m morse.rendering.workers.main``.

It reads messages from its standard input and writes answers to its standard output, each after its length. It ends with
its input: the process that has started it closes the pipe, or has died.
"""

from __future__ import annotations

import os
import signal
import sys

from morse.rendering.workers.easel import Easel
from morse.rendering.workers.pipes import receive, send


def main() -> None:
    """Answer messages until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the simulation ends the workers
    answers = os.fdopen(os.dup(1), "wb", 0)
    # what a library prints must not get between the answers
    os.dup2(2, 1)
    easel = Easel()
    messages = sys.stdin.buffer
    try:
        while True:
            send(answers, easel.answer(receive(messages)))
    except (EOFError, BrokenPipeError):
        # without the finalisation of Python, which would flush a closed pipe
        os._exit(0)


if __name__ == "__main__":
    main()
