"""Collision masks of the engine: two shapes touch only if their masks have a bit in common.

The bits of a shape from an MJCF file are those of the file, so that shapes of files touch as the files say. They touch
all other shapes, because these have the bits of `ALL_BITS`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    import mujoco


#: masks have 31 bits: one for all shapes that are not floors, others for floors and planes, then those of files
MOST_FLOORS, MOST_PLANES, _MOST_OF_FILES = 14, 4, 11
#: bits of shapes that touch everything except planes
ALL_BITS = (1 << (MOST_FLOORS + 1)) - 1
#: bit of the first plane; see `morse.physics.gliding.floor_planes`
FIRST_PLANE = 1 << (MOST_FLOORS + 1)
_FIRST_OF_FILES = MOST_FLOORS + 1 + MOST_PLANES
#: bit of all shapes from files
OF_FILE = 1 << 30


def file_bits(geoms: Iterable[mujoco.MjsGeom]) -> None:
    """Replace the masks of the geoms of a file."""
    used = 0
    for geom in geoms:
        used |= geom.contype | geom.conaffinity
    bits = [bit for bit in range(32) if used & (1 << bit)]
    # with more bits, the last ones are shared
    place = {bit: 1 << (_FIRST_OF_FILES + min(number, _MOST_OF_FILES - 1)) for number, bit in enumerate(bits)}
    for geom in geoms:
        kinds, partners = geom.contype, geom.conaffinity
        if kinds or partners:
            geom.contype = OF_FILE | sum({place[bit] for bit in bits if kinds & (1 << bit)})
            geom.conaffinity = ALL_BITS | sum({place[bit] for bit in bits if partners & (1 << bit)})
