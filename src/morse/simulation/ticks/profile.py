"""Profile of the wall-clock time of ticks."""

from __future__ import annotations

import json
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

#: the phases of a tick in order
PHASES = (
    "input",
    "services",
    "actuators",
    "physics",
    "rays",
    "sensors",
    "output",
)

#: maximum number of events in the trace file; later events are only counted
_MAX_EVENTS = 1_000_000


@dataclass(slots=True)
class Cost:
    """Wall-clock time of one phase or component: total and maximum in seconds, and number of calls."""

    total: float = 0.0
    worst: float = 0.0
    count: int = 0

    def add(self, seconds: float) -> None:
        """Add one measurement."""
        self.total += seconds
        self.count += 1
        self.worst = max(self.worst, seconds)

    @property
    def mean(self) -> float:
        """Mean duration, s."""
        return self.total / self.count if self.count else 0.0


class Profile:
    """Measures the phases and components of ticks.

    Attributes:
        phases: cost by phase.
        components: cost by component name.
        ticks: number of measured ticks.
    """

    def __init__(self, *, trace: bool = False) -> None:
        self.phases: dict[str, Cost] = {phase: Cost() for phase in PHASES}
        self.components: dict[str, Cost] = {}
        self.ticks = 0
        self._events: list[tuple[str, str, float, float]] | None = [] if trace else None
        self._start = perf_counter()
        self._last = self._start

    def begin(self) -> None:
        """Called at the beginning of a tick."""
        self.ticks += 1
        self._last = perf_counter()

    def mark(self, phase: str) -> None:
        """Called at the end of a phase."""
        now = perf_counter()
        self.phases[phase].add(now - self._last)
        self._keep(phase, "phase", self._last, now)
        self._last = now

    def component(self, name: str, begin: float, end: float) -> None:
        """Record that a component acted from ``begin`` to ``end`` (`time.perf_counter`)."""
        cost = self.components.get(name)
        if cost is None:
            cost = self.components[name] = Cost()
        cost.add(end - begin)
        self._keep(name, "component", begin, end)

    def _keep(self, name: str, kind: str, begin: float, end: float) -> None:
        if self._events is not None and len(self._events) < _MAX_EVENTS:
            self._events.append((name, kind, begin, end))

    @property
    def total(self) -> float:
        """Total duration of all ticks, s."""
        return sum(phase.total for phase in self.phases.values())

    def costliest(self) -> tuple[str, float]:
        """Return the slowest component, or else the slowest phase: its name and seconds per tick."""
        everything = {**{f"the phase '{n}'": c for n, c in self.phases.items()}, **self.components}
        everything.pop("the phase 'actuators'", None)
        everything.pop("the phase 'sensors'", None)
        name, cost = max(everything.items(), key=lambda item: item[1].total)
        return name, cost.total / max(self.ticks, 1)

    def write_trace(self, path: Path) -> None:
        """Write a file for trace viewers (Trace Event Format: chrome://tracing, Perfetto, speedscope).

        Raises:
            OSError: the file cannot be written; an existing file of that name is unchanged.
        """
        threads = {"phase": 1, "component": 2}
        events = [
            {
                "name": name,
                "cat": kind,
                "ph": "X",
                "pid": 1,
                "tid": threads[kind],
                "ts": round((begin - self._start) * 1e6, 3),
                "dur": round((end - begin) * 1e6, 3),
            }
            for name, kind, begin, end in self._events or ()
        ]
        names = [
            {"name": "thread_name", "ph": "M", "pid": 1, "tid": tid, "args": {"name": f"{kind}s"}}
            for kind, tid in threads.items()
        ]
        text = json.dumps({"traceEvents": names + events, "displayTimeUnit": "ms"})
        write_whole(path, text)
