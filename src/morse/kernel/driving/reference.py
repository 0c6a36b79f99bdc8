"""Driven robots in Python: the reference for the C functions, which give bit-identical results."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.kernel.driving.arrays import ChassisArrays, Floats, GliderArrays

_GLIDES, _TURNS, _SHIFTS = 1, 2, 4
_ROLLS, _HOLDS = 1, 3  # dimensions of a contact without and with friction
#: pi/2 in three parts; the product of the first part and a number below 2^20 is exact
_HALF_PI = tuple(map(float.fromhex, ("0x1.921fb544p+0", "0x1.0b4611a6p-34", "0x1.3198a2e037073p-69")))
_TWO_OVER_PI = 0.63661977236758134308


@lru_cache(maxsize=1024)  # commands are often equal for many ticks
def turn_by(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle by sums and products only, bit-identical on all platforms."""
    if not math.isfinite(angle):
        return math.nan, math.nan
    angle += 0.0  # no negative zero
    quarters = float(round(angle * _TWO_OVER_PI))
    x = ((angle - quarters * _HALF_PI[0]) - quarters * _HALF_PI[1]) - quarters * _HALF_PI[2]
    z = x * x
    # Taylor series; within an eighth of a turn, the next terms are below the last bit
    s = 1.0 - z / 110.0 * (1.0 - z / 156.0 * (1.0 - z / 210.0 * (1.0 - z / 272.0)))
    s = 1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * s))
    s = x - x * (z / 6.0 * s)
    c = 1.0 - z / 132.0 * (1.0 - z / 182.0 * (1.0 - z / 240.0 * (1.0 - z / 306.0)))
    c = 1.0 - z / 12.0 * (1.0 - z / 30.0 * (1.0 - z / 56.0 * (1.0 - z / 90.0 * c)))
    c = 1.0 - z / 2.0 * c
    odd = quarters % 4.0
    if odd == 0.0:
        return c, s
    return (-s, c) if odd == 1.0 else (-c, -s) if odd == 2.0 else (s, -c)


def arc(x: float, y: float, half: float) -> tuple[float, float, float, float]:
    """The chord of an arc: the constant velocity that ends at the same position, in the initial axes.

    Args:
        x, y: velocity in the axes of the body.
        half: half the turning angle, rad.

    Returns:
        The velocity; cosine and sine of ``half``.
    """
    if not abs(half) > 1e-9:
        return x, y, 1.0, 0.0
    cosine, sine = turn_by(half)
    chord = sine / half
    return chord * (cosine * x - sine * y), chord * (sine * x + cosine * y), cosine, sine


class Gliders:
    """See `morse.kernel.driving.arrays.GliderWork`."""

    def __init__(self, arrays: GliderArrays) -> None:
        self._arrays = arrays

    def begin(self, rotations: Floats) -> int:
        """Write the velocities of a tick."""
        all_ = self._arrays
        count = 0
        for i, slot in enumerate(all_.slots.tolist()):
            x, y, rate = float(all_.forward[i]), float(all_.aside[i]), float(all_.rate[i])
            all_.done[i] = 0
            rests = x == 0.0 and y == 0.0 and rate == 0.0
            tree = int(all_.trees[slot])
            if rests and tree >= 0 and all_.asleep[tree] >= 0 and not all_.sliding[slot]:
                continue
            speed = math.sqrt(x * x + y * y)
            nearer = 2.0 * (speed + abs(rate) * float(all_.extents[slot])) * all_.period
            if rests or not all_.plain[slot] or not (speed <= all_.speeds[slot]) or not (nearer <= all_.margins[slot]):
                all_.others[count] = i
                count += 1
                continue
            r = rotations[slot].tolist()
            x, y, all_.cosines[i], all_.sines[i] = arc(x, y, 0.5 * rate * all_.period)
            about = rate * r[8]
            dof = all_.dofs[slot]
            all_.velocities[dof : dof + 6] = (
                r[0] * x + r[1] * y,
                r[3] * x + r[4] * y,
                0.0,
                r[6] * about,
                r[7] * about,
                r[8] * about,
            )
            all_.done[i] = _GLIDES | (_TURNS if rate != 0.0 else 0) | (_SHIFTS if all_.shifts[i] else 0)
        return count

    def end(self) -> None:
        """After the tick: see `GliderWork.end`."""
        all_ = self._arrays
        v = all_.velocities
        for i, (slot, done) in enumerate(zip(all_.slots.tolist(), all_.done.tolist(), strict=True)):
            dof = int(all_.dofs[slot])
            if done & _SHIFTS:
                v[dof] = v[dof + 1] = v[dof + 5] = 0.0
            elif done & _TURNS:
                x, y, c, s = float(v[dof]), float(v[dof + 1]), float(all_.cosines[i]), float(all_.sines[i])
                v[dof], v[dof + 1] = c * x - s * y, s * x + c * y


class Chassis:
    """See `morse.kernel.driving.arrays.ChassisWork`."""

    def __init__(self, arrays: ChassisArrays) -> None:
        self._arrays = arrays

    def pull(self, rotations: Floats, pairs: int, gravity: float) -> None:
        """Move the velocities of the robots closer to those of their treads."""
        all_ = self._arrays
        all_.touched[all_.geoms] = 0
        touching = all_.touching[:pairs]
        all_.touched[touching[touching >= 0]] = 1
        for i, driven in enumerate(all_.driven.tolist()):
            if not driven:
                self._pull(i, rotations[all_.slots[i]].tolist(), gravity)

    def _pull(self, i: int, r: list[float], gravity: float) -> None:
        all_ = self._arrays
        wheels = slice(int(all_.first[i]), int(all_.first[i + 1]))
        geoms = all_.geoms[wheels]
        speed = rate = 0.0
        treads = (all_.controls[all_.motors[wheels]] * all_.radii[wheels]).tolist()
        for tread, lever in zip(treads, all_.levers[wheels].tolist(), strict=True):
            speed += tread
            rate += tread * lever
        speed /= float(len(geoms))
        share = float(all_.touched[geoms].sum()) / float(len(geoms))
        dof, v = int(all_.dofs[i]), all_.velocities
        vx, vy, vz, _, _, turning = v[dof : dof + 6].tolist()
        ahead = r[0] * vx + r[3] * vy + r[6] * vz
        beside = r[1] * vx + r[4] * vy + r[7] * vz
        creep = all_.creep
        stands = speed == rate == 0.0 and math.sqrt(ahead * ahead + beside * beside) < creep and abs(turning) < creep
        all_.dimensions[geoms] = _HOLDS if stands else _ROLLS
        if stands or share == 0.0:
            return
        # the axle moves straight ahead, as seen along the heading in the middle of the tick
        c, s = turn_by(0.5 * rate * all_.period)
        side = -rate * float(all_.axles[i])
        # half of what the slope takes away within the tick is added in advance
        slope = 0.5 * all_.period * gravity
        along = c * speed - s * side - ahead + slope * r[6]
        across = s * speed + c * side - beside + slope * r[7]
        budget = float(all_.frictions[i]) * gravity * abs(r[8]) * share * all_.period
        needed = math.sqrt(along * along + across * across)
        if needed > budget:
            along, across = along * budget / needed, across * budget / needed
        limit = budget * float(all_.turnings[i])
        change = rate - turning
        if change < -limit:
            change = -limit
        if change > limit:
            change = limit
        v[dof] = vx + (r[0] * along + r[1] * across)
        v[dof + 1] = vy + (r[3] * along + r[4] * across)
        v[dof + 2] = vz + (r[6] * along + r[7] * across)
        v[dof + 5] = turning + change
