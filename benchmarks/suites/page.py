"""The size of the page and its time to the first frame."""

from __future__ import annotations

import gzip
import os
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.result import Result, at_most, failure, skipped
from benchmarks.trial import Program, TrialFailed, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan


def page(plan: Plan) -> Iterator[Result]:
    """The live view in a browser."""
    yield _size()
    chromium = os.environ.get("MORSE_CHROMIUM", "/usr/bin/chromium")
    if find_spec("playwright") is None or not Path(chromium).exists():
        yield skipped("page", "first picture", "needs playwright and Chromium (MORSE_CHROMIUM is its path)")
        return
    program = Program("morse", "benchmarks.programs.first_picture", (chromium,))
    try:
        trial = interleave([program], plan.repeats)["morse"]
    except TrialFailed as error:
        yield failure("page", "first picture", str(error))
        return
    yield Result("page", "first picture, software GL", trial.median("first_s"), "s", at_most(1.5))
    yield Result("page", "first picture, files known", trial.median("again_s"), "s", at_most(1.5))


def _size() -> Result:
    import morse.viewer

    files = [path for path in (Path(morse.viewer.__file__).parent / "static").rglob("*") if path.is_file()]
    if not files:
        return skipped("page", "all files, gzipped", "the page is not built: pip install . builds it")
    size = sum(len(gzip.compress(path.read_bytes())) for path in files)
    return Result("page", "all files, gzipped", size / 1e3, "kB", at_most(350.0))
