"""How people come into the world: places by the seed, without overlaps; speeds and groups; entrances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.exceptions import MorseError
from morse.plugins.people.agenda import LEFT_OUT, OUTSIDE, STOPPED, WALKS
from morse.plugins.people.contacts import Places
from morse.plugins.people.wayfinding import inside

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.plugins.people.agenda import Agenda
    from morse.plugins.people.contacts import Surroundings
    from morse.plugins.people.gait import Gait
    from morse.plugins.people.plan import Plan
    from morse.plugins.people.walking import Walkers

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: tries for each person to find a free place; places to enter at, one after the other
_TRIES, _ENTRANCES = 400, 12


class Starts:
    """The places where people begin, or enter.

    Args:
        context: of the simulation.
        name: of the crowd, for messages.
        plan: of the crowd.
        around: what people meet.
        agenda: what people do; set for those who wait outside, or are left out.
        walkers: people, who get places, speeds and groups.
        random: generator of the crowd.
    """

    def __init__(
        self,
        context: Context,
        name: str,
        plan: Plan,
        around: Surroundings,
        agenda: Agenda,
        walkers: Walkers,
        random: np.random.Generator,
    ) -> None:
        self._context, self._name, self._plan, self._around = context, name, plan, around
        self._agenda, self._walkers, self._random = agenda, walkers, random

    def settle(self, speeds: Floats, groups: float, area: Indices) -> None:
        """Give everybody a place, a speed and a group.

        Args:
            speeds: (N,) m/s, free speeds.
            groups: share of the people who walk in groups.
            area: (N,) on which floor people are; set.

        Raises:
            MorseError: nobody can stand at a goal of the plan, or reach it.
        """
        agenda, random, count = self._agenda, self._random, len(speeds)
        self._walkers.free_speed = speeds
        agenda.alert = random.random(count)
        self._walkers.position[:] = self._plan.ground.origin
        begin = left_out = 0
        self._entrances = np.zeros((count, _ENTRANCES, 2))
        places = Places(self._plan.ground, self._plan.loose, self._around.crowds())
        for number, flow in enumerate(self._plan.flows):
            rows = np.arange(flow.get("begin", begin), flow.get("begin", begin) + flow["count"])
            begin += 0 if "begin" in flow else len(rows)
            self._agenda.flow[rows] = number
            area[rows] = flow["floor"]
            flow["ways"] = self._plan.ways_of(flow)
            if flow["then"] == "sit":
                self._agenda.stage[rows] = np.arange(len(rows)) % len(flow["goals"])
            corners = np.array(flow["area"])
            if "begin" in flow:
                self._walkers.position[rows] = corners
                continue
            self._make_groups(rows, groups)
            if flow["over"]:
                self._agenda.mode[rows] = OUTSIDE
                self._agenda.until[rows] = np.sort(random.random(len(rows))) * flow["over"]
                for row in rows:
                    points = self._candidates(places, corners, _ENTRANCES, float(self._walkers.radius[row]))
                    self._entrances[row] = points[np.arange(_ENTRANCES) % len(points)] if len(points) else np.nan
                    left_out += not len(points)
                self._agenda.mode[rows[np.isnan(self._entrances[rows, 0, 0])]] = LEFT_OUT
                continue
            for number_of_place, row in enumerate(rows):
                exact = corners[number_of_place : number_of_place + 1] if flow["exact"] else None
                place = self._free_place(places, corners, row, exact)
                if place is None:
                    self._agenda.mode[row] = LEFT_OUT
                    left_out += 1
                    continue
                self._walkers.position[row] = place
                places.take(place, float(self._walkers.radius[row]))
        self._agenda.mode[self._agenda.flow < 0] = LEFT_OUT
        if left_out:
            text = f"{self._name}: {left_out} of {count} people are left out: the rest of their area is occupied"
            self._context.complaints.warn(text, text)
        self._walkers.present = self._agenda.present()
        self._find_lost()

    def _make_groups(self, rows: Indices, share: float) -> None:
        """Let a share of people walk in groups of 2 to 4, with one speed (Moussaid et al. 2010, figure 1)."""
        row, last = 0, round(share * len(rows))
        while row + 2 <= last:
            size = int(min(self._random.choice([2, 3, 4], p=[0.7, 0.2, 0.1]), last - row))
            members = rows[row : row + size]
            self._walkers.group[members] = members[0]
            self._walkers.free_speed[members] = self._walkers.free_speed[members].mean()
            row += size

    def _candidates(self, places: Places, area: Floats, count: int, radius: float) -> Floats:
        """Return up to ``count`` random points (P, 2) of an area where a body has room."""
        low, high = area.min(axis=0), area.max(axis=0)
        found = np.zeros((0, 2))
        for _ in range(20):
            points = low + self._random.random((max(4 * count, 64), 2)) * (high - low)
            points = points[inside(area, points)]
            found = np.concatenate([found, points[places.are_open(points, radius)]])
            if len(found) >= count:
                break
        return found[:count]

    def _free_place(self, places: Places, area: Floats, row: int, exact: Floats | None) -> Floats | None:
        """Return a place for a person, the exact one (1, 2) if it is given; None if there is no room."""
        radius = float(self._walkers.radius[row])
        if exact is not None:
            # who begins at an exact place may touch a wall
            is_good = places.are_open(exact, self._plan.ground.radius) & places.are_free(exact, radius)
            return np.array(exact[0]) if is_good[0] else None
        points = self._candidates(places, area, _TRIES, radius)
        # a group begins together
        leader = int(self._walkers.group[row])
        if leader >= 0 and leader != row and self._agenda.mode[leader] == WALKS:
            apart = points - self._walkers.position[leader]
            points = points[np.argsort((apart * apart).sum(axis=1), kind="stable")]
        # most points are free: look at a few first
        for part in (points[:8], points[8:]):
            free = np.flatnonzero(places.are_free(part, radius, 0.02))
            if len(free):
                return np.array(part[free[0]])
        return None

    def _find_lost(self) -> None:
        """Tell who cannot reach a goal; they stay where they are."""
        lost = np.zeros(len(self._agenda.mode), dtype=bool)
        for number, flow in enumerate(self._plan.flows):
            rows = np.flatnonzero((self._agenda.flow == number) & self._walkers.present)
            for way in flow["ways"]:
                lost[rows] |= np.isinf(self._walkers.time_on(way, rows))
            if len(rows) and lost[rows].all() and not flow.get("is_own"):
                raise MorseError(
                    f"{self._name}: nobody can reach {flow['goals']!r:.120} from {flow['area']!r:.120}: walls are "
                    f"between, with no passage of {2 * self._plan.ground.radius:.2g} m"
                )
        if lost.any():
            self._agenda.mode[lost] = STOPPED
            text = f"{self._name}: {int(lost.sum())} people cannot reach a goal, and stay where they are"
            self._context.complaints.warn(text, text)

    def enter(self, now: float, gait: Gait) -> None:
        """Let those enter whose time has come and for whom there is room.

        Args:
            now: s.
            gait: of the people, which stand at first.
        """
        due = np.flatnonzero((self._agenda.mode == OUTSIDE) & (self._agenda.until <= now))
        if not len(due):
            return
        places = Places(self._plan.ground, self._around.outlines(), self._around.crowds(), self._walkers)
        for row in due.tolist():
            doors, radius = self._entrances[row], float(self._walkers.radius[row])
            free = np.flatnonzero(places.are_open(doors, radius) & places.are_free(doors, radius, 0.1))
            if len(free):
                self._agenda.mode[row] = WALKS
                self._walkers.position[row] = doors[free[0]]
                self._walkers.present[row] = True
                places.take(doors[free[0]], radius)
                gait.stand(np.array([row]), self._walkers.position)
