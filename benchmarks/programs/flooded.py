"""Whether one client of a simulation in real time can disturb another one.

A client reads a pose at 60 Hz, while others flood a port, and in turn with it while as many programs only use the
processor. Reports the longest gap between two poses, and simulated seconds per wall-clock second, of each phase.
"""

from __future__ import annotations

import argparse
import json
import socket
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from statistics import median
from typing import TYPE_CHECKING, Any

from benchmarks import stopwatch
from benchmarks.programs.flood import ATTACKS

if TYPE_CHECKING:
    from collections.abc import Iterator

#: wall-clock seconds that are not measured after the begin of a phase
_SETTLING = 1.0
_TIMEOUT = 120.0


@contextmanager
def _running(module: str, *words: str) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen([sys.executable, "-m", module, *words], stdout=subprocess.PIPE, text=True) as child:
        try:
            yield child
        finally:
            child.kill()


@contextmanager
def _simulation(middleware: str) -> Iterator[dict[str, Any]]:
    """The ports of a simulation."""
    words = [f"with={middleware}"]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        number = free.getsockname()[1]
    others = {"own": number, "domain": number % 200}
    words.append(f"port={others['domain' if middleware == 'ros2' else 'own']}")
    with _running("benchmarks.programs.open_ports", *words) as child:
        assert child.stdout is not None
        yield {**json.loads(child.stdout.readline()), **others}


class _Reader:
    """A client that reads the pose."""

    def __init__(self, port: int) -> None:
        self._lines = socket.create_connection(("127.0.0.1", port), timeout=_TIMEOUT).makefile("rb")
        self._lines.readline()

    def measure(self, seconds: float) -> tuple[float, float]:
        """The longest gap (s), and the real-time factor."""
        begin = last = time.perf_counter()
        first = last_stamp = json.loads(self._lines.readline())["timestamp"]
        longest = 0.0
        while last < begin + seconds:
            last_stamp = json.loads(self._lines.readline())["timestamp"]
            now = time.perf_counter()
            longest, last = max(longest, now - last), now
        return longest, (last_stamp - first) / (last - begin)


def main() -> None:
    """Run ``--rounds`` rounds, each with phases of ``--secs`` seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--attack", choices=ATTACKS, required=True)
    parser.add_argument("--clients", type=int, default=1)
    parser.add_argument("--secs", type=float, default=3.0)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    found: dict[str, list[tuple[float, float]]] = {"alone": [], "hog": [], arguments.attack: []}
    with _simulation(ATTACKS[arguments.attack][0]) as ports:
        reader = _Reader(ports["pose"])
        for name in list(found) * arguments.rounds:
            with ExitStack() as stack:
                if name != "alone":
                    for _ in range(arguments.clients):
                        child = stack.enter_context(_running("benchmarks.programs.flood", name, json.dumps(ports)))
                        assert child.stdout is not None
                        child.stdout.readline()
                reader.measure(_SETTLING)
                found[name].append(reader.measure(arguments.secs))
                if name == arguments.attack and child.poll() is not None:
                    raise SystemExit(f"the program that floods has ended with {child.returncode}")
    values = {}
    for name, key in (("alone", "alone"), ("hog", "hog"), (arguments.attack, "flood")):
        values[f"gap_{key}_s"] = median(gap for gap, _ in found[name])
        values[f"factor_{key}"] = median(factor for _, factor in found[name])
    stopwatch.report(**values)


if __name__ == "__main__":
    main()
