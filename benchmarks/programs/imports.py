"""Time of an import in a fresh interpreter, or of reading a model: ``imports MODULE``, ``imports NAME.blend``."""

from __future__ import annotations

import sys
import time
from importlib import import_module

from benchmarks import stopwatch


def main() -> None:
    """Run once."""
    what = sys.argv[1]
    if what.endswith(".blend"):
        from morse.assets import find
        from morse.assets.loader import load

        path = find(what.removesuffix(".blend"), "environments")
        load(find("empty", "environments"))  # measure reading, not the imports of the reader
        begin = time.perf_counter()
        load(path)
    else:
        begin = time.perf_counter()
        import_module(what)
    stopwatch.report(seconds=time.perf_counter() - begin)


if __name__ == "__main__":
    main()
