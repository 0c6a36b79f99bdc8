"""Driven robots in Python: the reference for the C functions, which give bit-identical results."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.kernel.driving import GLIDES, SHIFTS, TURNS, arc, turn_by
from tests.kernel.twins import pushing

if TYPE_CHECKING:
    from morse.kernel.driving import ChassisArrays, Floats, GliderArrays, PlaneArrays

_ROLLS, _HOLDS = 1, 3  # dimensions of a contact without and with friction


class Gliders:
    """See `morse.kernel.driving.GliderWork`."""

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
            all_.done[i] = GLIDES | (TURNS if rate != 0.0 else 0) | (SHIFTS if all_.shifts[i] else 0)
        return count

    def push(self, positions: Floats, rotations: Floats, count: int, tick: int) -> tuple[int, int]:
        """Drive robots that do not glide."""
        return pushing.push(self._arrays, positions, rotations, count, tick)

    def end(self) -> None:
        """After the tick: see `GliderWork.end`."""
        all_ = self._arrays
        v = all_.velocities
        for i, (slot, is_done) in enumerate(zip(all_.slots.tolist(), all_.done.tolist(), strict=True)):
            dof = int(all_.dofs[slot])
            if is_done & SHIFTS:
                v[dof] = v[dof + 1] = v[dof + 5] = 0.0
            elif is_done & TURNS:
                x, y, c, s = float(v[dof]), float(v[dof + 1]), float(all_.cosines[i]), float(all_.sines[i])
                v[dof], v[dof + 1] = c * x - s * y, s * x + c * y


class Chassis:
    """See `morse.kernel.driving.ChassisWork`."""

    def __init__(self, arrays: ChassisArrays) -> None:
        self._arrays = arrays

    def pull(self, rotations: Floats, pairs: int, gravity: float) -> None:
        """Move the velocities of the robots closer to those of their treads."""
        all_ = self._arrays
        all_.touched[all_.geoms] = 0
        touching = all_.touching[:pairs]
        all_.touched[touching[touching >= 0]] = 1
        for i, is_driven in enumerate(all_.driven.tolist()):
            if not is_driven:
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


class Planes:
    """See `morse.kernel.driving.PlaneWork`."""

    def __init__(self, arrays: PlaneArrays) -> None:
        self._arrays = arrays

    def select(self, positions: Floats) -> None:
        """Write the collision bits of the shapes of each robot."""
        all_ = self._arrays
        standing = [p for p in range(len(all_.boxes)) if self._stands(p)]
        for i, (slot, dof) in enumerate(zip(all_.slots.tolist(), all_.dofs.tolist(), strict=True)):
            x, y, z = positions[slot].tolist()
            vx, vy = all_.velocities[dof : dof + 2].tolist()
            shapes = slice(int(all_.first[i]), int(all_.first[i + 1]))
            margin = self._reach(shapes) + 2.0 * math.sqrt(vx * vx + vy * vy) * all_.period + all_.edge
            bits = all_.all_bits
            for p in standing:
                height, middle_x, middle_y, ax, ay, bx, by, long, wide = all_.tops[p].tolist()
                dx, dy = x - middle_x, y - middle_y
                along, across = long - abs(ax * dx + ay * dy), wide - abs(bx * dx + by * dy)
                if along > margin and across > margin and z > height - all_.deep:
                    bits = (bits & ~int(all_.box_bits[p])) | int(all_.plane_bits[p])
            geoms = all_.geoms[shapes]
            geoms = geoms[all_.types[geoms] != 0]
            all_.types[geoms] = all_.affinities[geoms] = bits

    def _reach(self, shapes: slice) -> float:
        """Return the distance from the origin of a robot to its outermost point, m."""
        all_ = self._arrays
        most = 0.0
        for geom, carrier in zip(all_.geoms[shapes].tolist(), all_.carriers[shapes].tolist(), strict=True):
            far = _length(*all_.shape_places[geom].tolist()) + float(all_.radii[geom])
            if carrier >= 0:
                far += _length(*all_.body_places[carrier].tolist())
            most = max(most, far)
        return most

    def _stands(self, p: int) -> bool:
        """Whether the box has its bit, and is at the place of its floor."""
        all_ = self._arrays
        box, place = int(all_.boxes[p]), all_.places[p]
        here = all_.types[box] == all_.box_bits[p] and (all_.box_places[box] == place[:3]).all()
        return bool(here and (all_.box_turns[box] == place[3:]).all())


def _length(x: float, y: float, z: float) -> float:
    return math.sqrt(x * x + y * y + z * z)
