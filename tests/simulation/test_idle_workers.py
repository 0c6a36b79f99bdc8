"""Threads of executors that have nothing to do do not hold up the end of a process, and are not reported."""

import time

from tests.kit.programs import python

PROGRAM = """
import logging, sys
from concurrent.futures import ThreadPoolExecutor
logging.basicConfig(stream=sys.stdout, format="%(message)s")
from morse.simulation.ending import threads_left
pool = ThreadPoolExecutor(2, thread_name_prefix="idle")
pool.submit(print, "worked").result()
threads_left(7, sys.exit, limit=60.0)
print("ended")
"""


def test_idle_workers_end() -> None:
    begin = time.monotonic()
    ran = python("-c", PROGRAM)
    assert (ran.returncode, ran.stdout.split()) == (0, ["worked", "ended"]), ran.stdout + ran.stderr
    # the limit, for which a thread that does not end is waited for
    assert time.monotonic() - begin < 60.0
