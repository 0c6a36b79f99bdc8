"""Collision masks of the engine: two shapes touch only if their masks have a bit in common."""

from __future__ import annotations

#: masks have 31 bits: one for all shapes that are not floors, the others for floors and planes
MOST_FLOORS, MOST_PLANES = 26, 4
#: bits of shapes that touch everything except planes
ALL_BITS = (1 << (MOST_FLOORS + 1)) - 1
#: bit of the first plane; see `morse.physics.gliding.floor_planes`
FIRST_PLANE = 1 << (MOST_FLOORS + 1)
