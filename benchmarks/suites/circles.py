"""W1: N robots drive in circles with a pose at 60 Hz and a scan at 10 Hz; compared with other simulators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks import work
from benchmarks.result import Result, at_least, at_most, failure
from benchmarks.trial import Program, Trial, TrialFailed, beyond, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.result import Wanted
    from benchmarks.trial import Record

#: minimum ratio to the bare loop, by the number of robots
_WANTED = {1: 1.3, 10: 2.5, 100: 5.0}
_WANTED_WHEELS = {1: 0.5, 10: 1.2, 100: 2.5}
_WANTED_POSE = {1000: 4.0}
#: simulated seconds: about the same time for each number of robots
_SECONDS = {1: 100.0, 3: 60.0, 10: 40.0, 30: 10.0, 100: 4.0, 300: 1.5, 1000: 1.0}
#: packages and programs of simulators that may be installed
PEERS = {
    "pybullet": "pybullet_loop",
    "robox3d": "robox3d_loop",
    "sapien": "sapien_loop",
    "irsim": "irsim_loop",
    "pyrobosim": "pyrobosim_loop",
}
#: maximum number of robots of slow simulators, which would take minutes for more
_MOST = {"irsim": 10, "pyrobosim": 1}
_PLANAR_ERROR = 0.02  # m
_WHEEL_ERROR = 0.02  # share of the distance, and
_WHEEL_START = 0.06  # m while the wheels begin to turn
_SCAN_ERROR = 1e-3  # m, in the median
_SCAN_BAD = 0.02  # share of beams near an edge


def check_planar(record: Record) -> str | None:
    """Errors of a run of robots that are moved by their velocity."""
    wrong = beyond(record, "position_error_m", _PLANAR_ERROR)
    if wrong is None and record["scan_error_m"] is not None:
        wrong = beyond(record, "scan_error_m", _SCAN_ERROR) or beyond(record, "scan_bad_share", _SCAN_BAD)
    return wrong


def check_wheels(record: Record) -> str | None:
    """Errors of a run of wheeled robots, which slip a little."""
    return beyond(record, "position_error_m", _WHEEL_START + _WHEEL_ERROR * work.SPEED * record["seconds"])


def circles(plan: Plan) -> Iterator[Result]:
    """W1: robots moved by their velocity, and wheeled robots."""
    for count in plan.counts(1, 10, 100):
        yield _compare(plan, "W1", count, "planar", "scan", at_least(_WANTED[count]))
    for count in plan.counts(1, 10, 100):
        yield _compare(plan, "W1 wheels", count, "wheels", "scan", at_least(_WANTED_WHEELS[count]))


def growth(plan: Plan) -> Iterator[Result]:
    """Speed and memory from one robot to a thousand."""
    memory: dict[int, float] = {}
    for count in plan.counts(1, 3, 10, 30, 100, 300, 1000):
        wanted = at_least(_WANTED_POSE[count]) if count in _WANTED_POSE else None
        found = _compare(plan, "growth", count, "planar", "scan" if count < 1000 else "pose", wanted)
        if "memory_mb" in found.details:
            memory[count] = found.details["memory_mb"]
        yield found
    if len(memory) > 1:
        few, many = min(memory), max(memory)
        each = (memory[many] - memory[few]) / (many - few)
        yield Result("growth", "memory of a robot", each * 1e3, "kB", details={"memory_mb": memory})


def _compare(plan: Plan, name: str, count: int, drive: str, sensors: str, wanted: Wanted | None) -> Result:
    words = ("--n", str(count), "--secs", str(plan.seconds(_SECONDS[count])), "--drive", drive, "--sensors", sensors)
    programs = [
        Program("morse", "benchmarks.programs.circles", words),
        Program("mujoco", "benchmarks.peers.mujoco_loop", ("circles", *words)),
    ]
    if name == "W1":
        programs += [p for p in _peers(words) if p.is_installed and count <= _MOST.get(p.name, count)]
    case = f"{count} robot{'s' * (count > 1)}, {sensors}"
    try:
        trials = interleave(programs, plan.repeats, check_planar if drive == "planar" else check_wheels)
    except TrialFailed as error:
        return failure(name, case, str(error))
    left_out = {name: trial.trouble for name, trial in trials.items() if trial.trouble}
    factors = {name: trial.median(plan.clock("factor")) for name, trial in trials.items() if name not in left_out}
    own = factors.pop("morse")
    memory = trials["morse"].median("memory_mb")
    details = {"morse": own, "count": count, "sensors": sensors, "memory_mb": memory, **_spread(trials, plan)}
    return Result(name, case, own / factors["mujoco"], "x bare loop", wanted, factors, details, left_out=left_out)


def _peers(words: tuple[str, ...]) -> list[Program]:
    return [
        Program(name, f"benchmarks.peers.{module}", ("circles", *words), needs=name, is_optional=True)
        for name, module in PEERS.items()
    ]


def _spread(trials: dict[str, Trial], plan: Plan) -> dict[str, object]:
    key = plan.clock("factor")
    return {"runs": {name: [record[key] for record in trial.records] for name, trial in trials.items()}}


def readers(plan: Plan) -> Iterator[Result]:
    """The cost of clients that read every stream, of pages that show the view, and of recordings, with ten robots.

    As fast as possible, every tick sends all data: the result is the slowdown. In real time, the result is the share of
    a processor.
    """
    for case, words, seconds in (("as fast as possible", (), 100.0), ("in real time", ("--paced",), 3.0)):
        every = ("--n", "10", "--secs", str(plan.seconds(seconds)), *words)
        options = [("alone", ())]
        options += [(f"{n} client{'s' * (n > 1)}", ("--readers", str(n))) for n in plan.counts(1, 10)]
        options += [
            (f"{n} binary client{'s' * (n > 1)}", ("--readers", str(n), "--binary")) for n in plan.counts(1, 10)
        ]
        options += [(f"{n} page{'s' * (n > 1)}", ("--pages", str(n))) for n in plan.counts(1, 3)]
        options += [("a recording", ("--record", "all")), ("a recording of the inputs", ("--record", "inputs"))]
        programs = [Program(name, "benchmarks.programs.circles", (*every, *more)) for name, more in options]
        try:
            trials = interleave(programs, plan.repeats, check_planar)
        except TrialFailed as error:
            yield failure("readers", case, str(error))
            continue
        key = "processor_factor" if words else plan.clock("factor")
        alone = trials.pop("alone").median(key)
        count = plan.counts(1, 10)[-1]
        lines, frames = (trials[f"{count} {kind}client{'s' * (count > 1)}"].median(key) for kind in ("", "binary "))
        if not words and lines < alone:
            share = (1 / frames - 1 / alone) / (1 / lines - 1 / alone)
            yield Result("readers", f"{count} binary, {case}", share, "x cost of lines", at_most(1 / 3))
        for name, trial in trials.items():
            factor = trial.median(key)
            value, unit = (1 / factor - 1 / alone, "% of a core") if words else (1 - factor / alone, "% slower")
            yield Result("readers", f"{name}, {case}", 100 * value, unit, at_most(5.0), details={"alone": alone})
