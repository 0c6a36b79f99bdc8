"""Driven robots that do not glide, in Python: the twin of ``c/push.c``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.driving import SHIFTS, TURNS, arc
from morse.physics.driving.drives import body_velocity
from morse.physics.gliding.stances import stands_still

if TYPE_CHECKING:
    from morse.kernel.driving import Floats, GliderArrays


def push(all_: GliderArrays, positions: Floats, rotations: Floats, count: int, tick: int) -> tuple[int, int]:
    """See `morse.kernel.driving.GliderWork.push`."""
    remaining = settled = 0
    for i in all_.others[:count].tolist():
        slot = int(all_.slots[i])
        x, y, rate = float(all_.forward[i]), float(all_.aside[i]), float(all_.rate[i])
        moves = x != 0.0 or y != 0.0 or rate != 0.0
        if not all_.plain[slot] or not all_.free[slot] or all_.speeds[slot] >= 0.0 or moves != all_.sliding[slot]:
            all_.others[remaining] = i
            remaining += 1
            continue
        ground, shift = bool(all_.ground[i]), bool(all_.shifts[i])
        x, y, all_.cosines[i], all_.sines[i] = arc(x, y, 0.5 * rate * all_.period)
        dof = int(all_.dofs[slot])
        r = rotations[slot].tolist()
        own = all_.velocities[dof : dof + 6]
        own[:] = body_velocity(r, own.tolist(), (x, y, 0.0), (0.0, 0.0, rate), ground, shift)
        all_.done[i] = (TURNS if rate != 0.0 else 0) | (SHIFTS if shift else 0)
        stands = moves and ground and all_.stances.able[slot]
        if stands and stands_still(all_.stances, slot, tick, float(positions[slot, 2]), r[6:]):
            all_.settled[settled] = i
            settled += 1
    return remaining, settled
