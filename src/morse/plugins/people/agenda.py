"""What the people of a crowd do: their flow, their goal, and whether they walk, wait, stand in line, sit or follow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.plugins.people.errands import NEVER, Queue
from morse.plugins.people.walking import length

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.plugins.people.following import Trails

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: what a person does
WALKS, STOPPED, SENT, WAITS, ARRIVED, GONE, OUTSIDE, LEFT_OUT, RECORDED, QUEUES, SITS, FOLLOWS, DRIVEN = range(13)
WORDS = (
    "walks",
    "stopped",
    "sent",
    "waits",
    "arrived",
    "gone",
    "outside",
    "left out",
    "recorded",
    "queues",
    "sits",
    "follows",
    "driven",
)
_ABSENT = (GONE, OUTSIDE, LEFT_OUT, DRIVEN)
#: m: a person has arrived
ARRIVES = 0.4


class Agenda:
    """What people do.

    Args:
        count: N, number of people.

    Attributes:
        flow: (N,) number of the flow of the plan; -1 for none.
        stage: (N,) number of the goal of the flow.
        mode: (N,) what they do, from `WALKS`.
        until: (N,) s, when they go on who wait, sit, are served or enter.
        target: (N, 2) m, on the plane, where they go who were sent, stand in line or sit.
        came: (N, 2) m, on the plane, from where they came who sit.
        rank: (N,) order in a line, or behind a leader; it may have gaps.
        leader: (N,) number of the trail that they follow; -1 for none.
        alert: (N,) who sees a robot: those below its share.
    """

    def __init__(self, count: int) -> None:
        self.flow = np.full(count, -1, dtype=np.intp)
        self.stage = np.zeros(count, dtype=np.intp)
        self.mode = np.full(count, WALKS, dtype=np.intp)
        self.until = np.zeros(count)
        self.target = np.zeros((count, 2))
        self.came = np.zeros((count, 2))
        self.rank = np.zeros(count, dtype=np.intp)
        self.leader = np.full(count, -1, dtype=np.intp)
        self.alert = np.zeros(count)

    def present(self) -> NDArray[np.bool_]:
        """Return (N,) who is in the world."""
        return ~np.isin(self.mode, _ABSENT)

    def stands_up(self, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Whether (R,) people who sit stand up."""
        return np.asarray((self.target[rows] == self.came[rows]).all(axis=1))

    def change(self, rows: Indices, number: int, flow: dict[str, Any]) -> None:
        """Let people have the goals of another flow, the next one of their schedule, by its number."""
        self.flow[rows] = number
        seats = len(flow["goals"])
        self.stage[rows] = np.arange(len(rows)) % seats if flow["then"] == "sit" else 0
        free = rows[np.isin(self.mode[rows], (WAITS, ARRIVED, QUEUES, SITS))]
        self.mode[free] = WALKS

    def stand_in_line(
        self, queue: Queue, rows: Indices, left: Floats, mine: NDArray[np.bool_], position: Floats, now: float
    ) -> None:
        """Let people join a line, and move up in it; serve the first one.

        Args:
            queue: the line.
            rows: (R,) who walks to the counter.
            left: (R,) m, their ways to it.
            mine: (N,) who belongs to the flow.
            position: (N, 2) m, on the plane.
            now: s.
        """
        line = np.flatnonzero(mine & (self.mode == QUEUES))
        joining = queue.joining(rows, left, len(line))
        if len(joining):
            begin = int(self.rank[line].max()) + 1 if len(line) else 0
            self.rank[joining], self.mode[joining] = begin + np.arange(len(joining)), QUEUES
            self.until[joining] = NEVER
            line = np.flatnonzero(mine & (self.mode == QUEUES))
        if not len(line):
            return
        self.target[line] = queue.places(self.rank[line])
        first = int(line[self.rank[line].argmin()])
        if self.until[first] <= now:
            self.mode[first] = WALKS
            self.stage[first] += 1
        elif self.until[first] == NEVER and length((position - self.target)[[first]])[0] < ARRIVES:
            self.until[first] = now + queue.wait

    def forget_leaders(self, trails: Trails) -> Trails:
        """Return the trails that somebody follows; leaders are numbered in the order of these."""
        names, self.leader[self.mode != FOLLOWS] = list(trails), -1
        numbers = np.unique(self.leader[self.leader >= 0])
        self.leader[self.leader >= 0] = np.searchsorted(numbers, self.leader[self.leader >= 0])
        return {names[number]: trails[names[number]] for number in numbers.tolist()}
