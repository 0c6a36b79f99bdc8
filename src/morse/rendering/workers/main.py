"""The program of a worker on this machine: ``python -m morse.rendering.workers.main``."""

from __future__ import annotations

from morse.rendering.workers.easel import Easel
from morse.system.worker_process import serve


def main() -> None:
    """Answer messages until the input ends."""
    serve(Easel().answer)


if __name__ == "__main__":
    main()
