"""Driven robots that do not glide, in Python: the reference for ``c/push.c``, which gives bit-identical results."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.driving.turns import SHIFTS, TURNS, arc

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.kernel.driving.arrays import Floats, GliderArrays, StanceArrays

#: changes of height (m) and tilt per tick below which a robot has settled
_SETTLED = 1e-9

Six = tuple[float, float, float, float, float, float]


def body_velocity(
    r: Sequence[float],
    old: Sequence[float],
    linear: Sequence[float],
    angular: Sequence[float],
    ground: bool,
    shift: bool,
) -> Six:
    """The velocity of a driven body.

    Args:
        r: (9,) its rotation, row by row.
        old: (6,) its present velocity: linear in the axes of the world, angular in its own axes.
        linear, angular: the command in its own axes, m/s and rad/s.
        ground: keep the vertical speed, and the roll and pitch rates.
        shift: leave axes without a command to gravity and contacts.
    """
    x, y, z = linear
    wx, wy, wz = angular
    a, b, c, d, e, f, g, h, i = r
    vx, vy, vz = a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z
    if ground:
        # the yaw rate about the world Z axis changes; roll and pitch rates do not: w' = w + R^T z (target - z.R w)
        _, _, up, roll, pitch, yaw = old
        change = g * wx + h * wy + i * wz - (g * roll + h * pitch + i * yaw)
        return vx, vy, up, roll + g * change, pitch + h * change, yaw + i * change
    if shift:
        return vx, vy, vz or old[2], wx or old[3], wy or old[4], wz
    return vx, vy, vz, wx, wy, wz


def stands_still(stances: StanceArrays, slot: int, tick: int, height: float, up: Sequence[float]) -> bool:
    """Record the stance of a robot; return whether it has settled since the last tick and may glide."""
    ticks, heights, ups, until = stances.views
    first, (x, y, z) = 3 * slot, up
    still = (
        ticks[slot] == tick - 1
        and abs(height - heights[slot]) < _SETTLED
        and abs(x - ups[first]) < _SETTLED
        and abs(y - ups[first + 1]) < _SETTLED
        and abs(z - ups[first + 2]) < _SETTLED
    )
    ticks[slot], heights[slot] = tick, height
    ups[first], ups[first + 1], ups[first + 2] = x, y, z
    return bool(still and tick >= until[slot])


def push(all_: GliderArrays, positions: Floats, rotations: Floats, count: int, tick: int) -> tuple[int, int]:
    """See `morse.kernel.driving.arrays.GliderWork.push`."""
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
