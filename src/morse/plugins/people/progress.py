"""How people go on in a tick: who has arrived waits, sits, walks on or leaves; where all want to go."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.plugins.people.agenda import ARRIVED, ARRIVES, FOLLOWS, GONE, QUEUES, SENT, SITS, STOPPED, WAITS, WALKS
from morse.plugins.people.errands import HERE, NEVER, STANDS_UP, steps_to
from morse.plugins.people.following import SEEKS, aims, note
from morse.plugins.people.walking import length

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.plugins.people.agenda import Agenda
    from morse.plugins.people.following import Trails
    from morse.plugins.people.plan import Plan
    from morse.plugins.people.walking import Walkers
    from morse.plugins.people.wayfinding import Way

#: m: people who are that near to a goal come there at the same time
_CROWDED = 1.5


def advance(plan: Plan, agenda: Agenda, walkers: Walkers, now: float) -> None:
    """Let those who have arrived wait, stand in line, sit, go on, or leave.

    Args:
        plan: of the crowd.
        agenda: what people do; set.
        walkers: people.
        now: s.
    """
    for number, flow in enumerate(plan.flows):
        if flow.get("next") and now >= flow["next"][0] and (agenda.flow == number).any():
            number_of_next = flow["next"][1]
            agenda.change(np.flatnonzero(agenda.flow == number), number_of_next, plan.flows[number_of_next])
    ways, which = _present_ways(plan, agenda, walkers)
    left_of_all = plan.ground.times(ways, which, walkers.position)
    # nobody arrives who is farther away than where all would stand side by side
    goes_on = np.isin(agenda.mode, (WAITS, SITS)) & (agenda.until <= now)
    goes_on |= left_of_all < ARRIVES + 0.35 * math.sqrt(len(which))
    busy = set(np.unique(agenda.flow[goes_on]).tolist())
    for number, flow in enumerate(plan.flows):
        if number not in busy and flow["then"] not in ("queue", "sit"):
            continue
        mine = agenda.flow == number
        count = len(flow["ways"])
        for stage in range(count):
            rows = np.flatnonzero(mine & (agenda.mode == WALKS) & (agenda.stage == stage))
            is_counter = flow["then"] == "queue" and stage == count - 2
            if is_counter:
                agenda.stand_in_line(flow["queue"], rows, left_of_all[rows], mine, walkers.position, now)
            is_seat = flow["then"] == "sit" and stage < count - 1
            if is_counter or not (len(rows) or is_seat):
                continue
            there = mine & (agenda.stage == stage) & np.isin(agenda.mode, (WAITS, ARRIVED, SITS))
            left = left_of_all[rows]
            # those who come and those who are there have room side by side: 2.6 people on a square metre
            crowded = int(there.sum()) + (0 if is_seat else int((left < _CROWDED).sum()) - 1)
            rows = rows[left < ARRIVES + 0.35 * math.sqrt(max(crowded, 0))]
            agenda.mode[rows] = WAITS
            agenda.until[rows] = now + (0.0 if flow["then"] in ("queue", "sit") else flow["wait"])
            if is_seat:
                # who finds the seat taken stands beside it until it is free
                agenda.mode[rows], agenda.until[rows] = ARRIVED, NEVER
                waiting = np.flatnonzero(mine & (agenda.mode == ARRIVED) & (agenda.stage == stage))[:1]
                if not (mine & (agenda.stage == stage) & (agenda.mode == SITS)).any():
                    agenda.mode[waiting], agenda.target[waiting] = SITS, flow["seats"][stage]
                    agenda.came[waiting] = walkers.position[waiting]
                    agenda.until[waiting] = now + flow["wait"] if flow["wait"] > 0.0 else NEVER
        # who stands up goes back to where he came from
        rows = np.flatnonzero(mine & (agenda.mode == SITS) & (agenda.until <= now))
        rows = rows[~agenda.stands_up(rows)]
        agenda.target[rows], agenda.until[rows] = agenda.came[rows], now + STANDS_UP
        rows = np.flatnonzero(mine & np.isin(agenda.mode, (WAITS, SITS)) & (agenda.until <= now))
        last = agenda.stage[rows] + 1 >= count
        agenda.mode[rows[~last]] = WALKS
        agenda.stage[rows[~last]] = count - 1 if flow["then"] == "sit" else agenda.stage[rows[~last]] + 1
        ends = rows[last]
        if flow["then"] == "repeat":
            agenda.mode[ends], agenda.stage[ends] = WALKS, 0
        else:
            agenda.mode[ends] = ARRIVED if flow["then"] == "stay" else GONE
    walkers.present = agenda.present()


def _present_ways(plan: Plan, agenda: Agenda, walkers: Walkers) -> tuple[list[Way], NDArray[np.intp]]:
    """Return the ways of a plan, and the number (N,) of that on which each person walks; -1 for those who do not."""
    ways, numbers, level = plan.routes
    which = np.where(agenda.mode == WALKS, numbers[agenda.flow, agenda.stage], -1)
    return ways, np.where(walkers.level, level[which], which)


def look_ahead(plan: Plan, agenda: Agenda, walkers: Walkers) -> None:
    """Set where everybody wants to go who follows nobody.

    Args:
        plan: of the crowd.
        agenda: what people do; those stop who cannot go where they were sent, or are there.
        walkers: people; their ``wanted`` is set.
    """
    wanted, position = walkers.wanted, walkers.position
    wanted[:] = plan.ground.headings(*_present_ways(plan, agenda, walkers), position)
    queues, sits = np.flatnonzero(agenda.mode == QUEUES), np.flatnonzero(agenda.mode == SITS)
    wanted[queues] = steps_to(position[queues], agenda.target[queues])
    # seated people look to where they came from
    away = agenda.came[sits] - np.where(agenda.stands_up(sits)[:, None], position[sits], agenda.target[sits])
    wanted[sits] = away / np.maximum(length(away), HERE)[:, None]
    sent = np.flatnonzero(agenda.mode == SENT)
    for target in np.unique(agenda.target[sent], axis=0):
        rows = sent[(agenda.target[sent] == target).all(axis=1)]
        found = plan.way_to(target.tolist())
        if found is None:
            agenda.mode[rows] = STOPPED
            continue
        arrived = walkers.time_on(found, rows) < ARRIVES + 0.35 * math.sqrt(len(rows) - 1.0)
        agenda.mode[rows[arrived]] = STOPPED
        wanted[rows[~arrived]] = walkers.heading_on(found, rows[~arrived])


def follow_leaders(
    plan: Plan,
    agenda: Agenda,
    walkers: Walkers,
    trails: Trails,
    sought: Trails,
    tick: int,
    place_of: Callable[[str], tuple[float, float] | None],
) -> None:
    """Set where those want to go who follow a leader.

    Args:
        plan: of the crowd.
        agenda: what people do.
        walkers: people; their ``wanted`` is set.
        trails: of the leaders; their present places are added.
        sought: one place of each leader, m, to which those go who are far from its trail; set.
        tick: number of the tick.
        place_of: returns the place of a leader on the plane, m; None if it is not there.
    """
    position, wanted = walkers.position, walkers.wanted
    # one search for a way in `SEEKS` ticks, for one leader after the other: a leader that jumps about costs no more
    turn = tick // SEEKS % max(len(trails), 1) if tick % SEEKS == 0 else -1
    for number, (name, trail) in enumerate(trails.items()):
        place = place_of(name)
        rows = np.flatnonzero((agenda.mode == FOLLOWS) & (agenda.leader == number))
        if place is None or not len(rows):
            continue
        note(trail, place)
        order = np.argsort(np.argsort(agenda.rank[rows], kind="stable"), kind="stable")
        targets = aims(trail, place, position[rows], order)
        near = np.isfinite(targets[:, 0])
        wanted[rows[near]] = steps_to(position[rows[near]], targets[near])
        far = rows[~near]
        if number == turn or name not in sought:
            sought[name] = [trail[0]]
        way = plan.way_to(list(sought[name][0])) if len(far) else None
        if way is not None:
            wanted[far] = walkers.heading_on(way, far)
