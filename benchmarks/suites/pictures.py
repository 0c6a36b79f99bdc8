"""W2: images of the sandbox, compared with OpenGL."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks import work
from benchmarks.result import Result, at_least, at_most, failure
from benchmarks.trial import Program, TrialFailed, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.trial import Trial

_OWN, _PEER = "benchmarks.programs.pictures", "benchmarks.peers.mujoco_pictures"
#: the cases, their arguments, and the wanted speed relative to OpenGL
_CASES = (
    ("320 x 240, 1 sample", ("--width", "320", "--samples", "1"), 4.0),
    ("640 x 480, 1 sample", ("--samples", "1"), 3.0),
    ("640 x 480, 5 samples", (), 1.7),
    ("640 x 480, depth and ids alone", ("--no-color",), 8.0),
)
#: allowed share of different depths: at edges, renderers may differ
_MOST_APART = 0.02


def pictures(plan: Plan) -> Iterator[Result]:
    """RGB, depth and ids; four cameras; a camera at 30 Hz; the first picture."""
    key = plan.clock("ms")
    with tempfile.TemporaryDirectory() as folder:
        triangles = str(Path(folder) / "triangles.npz")
        try:
            Program("morse", _OWN, ("export", triangles)).run()
        except TrialFailed as error:
            yield failure("W2", "pictures", str(error))
            return
        for case, words, wanted in _CASES[:1] if plan.quick else _CASES:
            yield _beside_opengl(plan, case, words, wanted, triangles)
        yield _beside_opengl(plan, "640 x 480, 5 samples, OpenGL without shadows", (), 0.5, triangles, "--no-shadows")
    try:
        one, four = (_own(plan, "draw", "--width", "320", "--cameras", n).median(key) for n in ("1", "4"))
        yield Result("W2", "four cameras, of four times one", four / one / 4, "x", at_most(1.0), {}, {"morse": four})
        for what in ("standing", "turning"):
            share = _own(plan, what, "--secs", str(plan.seconds(2.0))).median(plan.clock("share"))
            case = f"a camera at 30 Hz, 320 x 240, on a {what} robot, of real time"
            yield Result("W2", case, 100 * share, "% of a core", at_most(15.0))
        for others in (0,) if plan.quick else (0, 12):
            yield _beside_time(plan, others)
        trial = _own(plan, "workers", "--secs", str(plan.seconds(5.0)))
        details = {"two workers, of the thread": trial.median("two_of_none")}
        yield Result("W2", "two workers, of one", trial.median("two_of_one"), "x", at_least(1.7), details=details)
        first = _own(plan, "first").median(plan.clock("s"))
        yield Result("W2", "first picture after loading the sandbox", first, "s", at_most(0.5))
    except TrialFailed as error:
        yield failure("W2", "pictures", str(error))


def _beside_time(plan: Plan, others: int) -> Result:
    trial = _own(plan, "beside", "--secs", str(plan.seconds(5.0)), "--others", str(others))
    ticks = f"ticks with {others} scanners" if others else "ticks"
    details = {key: trial.median(key) for key in ("thread_share", "processor_ratio")}
    return Result("W2", f"{ticks}, delay of one frame, of no delay", trial.median("faster"), "x", details=details)


def _own(plan: Plan, *words: str) -> Trial:
    return interleave([Program("morse", _OWN, words)], plan.repeats)["morse"]


def _beside_opengl(plan: Plan, case: str, words: tuple[str, ...], wanted: float, triangles: str, *more: str) -> Result:
    key = plan.clock("ms")
    own = Program("morse", _OWN, ("draw", *words))
    peer = Program("opengl", _PEER, (triangles, *words, *more), needs="OpenGL", is_optional=True)
    try:
        trials = interleave([own, peer] if peer.is_installed else [own], plan.repeats)
    except TrialFailed as error:
        return failure("W2", case, str(error))
    if "opengl" not in trials:
        why = "PyOpenGL is not installed: pip install pyopengl"
        return Result("W2", case, trials["morse"].median(key), "ms", left_out={"opengl": why})
    mine, theirs = trials["morse"], trials["opengl"]
    if theirs.trouble:
        return Result("W2", case, mine.median(key), "ms", left_out={"opengl": theirs.trouble})
    apart = work.depth_disagreement(mine.records[0]["depths"], theirs.records[0]["depths"])
    if apart > _MOST_APART:
        return failure("W2", case, f"{apart:.1%} of the depths differ from those of OpenGL")
    ours, others = mine.median(key), theirs.median(key)
    return Result("W2", case, others / ours, "x OpenGL", at_least(wanted), {"opengl": others}, {"morse": ours})
