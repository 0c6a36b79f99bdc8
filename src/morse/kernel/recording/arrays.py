"""Arrays that describe the records of many ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Bytes = NDArray[np.uint8]
    Integers = NDArray[np.int64]
    Floats = NDArray[np.float64]


class Rows(NamedTuple):
    """The records of R ticks, which differ only in their times and numbers.

    Attributes:
        begins: (R,) offset of the first record of each tick in the chunk, bytes.
        moments: (R, 3) number of the tick, log time (ns), simulated time (ns).
        templates: (size,) the concatenated records of one tick.
        heads: (H,) offset of each record in the templates.
        stamps: (S,) offset of each time stamp (seconds and nanoseconds, 4 bytes each) in the templates.
        chunk: receives the records.
    """

    begins: Integers
    moments: Integers
    templates: Bytes
    heads: Integers
    stamps: Integers
    chunk: Bytes


class Poses(NamedTuple):
    """The poses of N objects in R ticks.

    Attributes:
        positions, rotations: (R,) addresses of arrays (K, 3), m, and (K, 9) of all rigid groups, world frame.
        slots: (N,) rigid group of each object.
        offsets, turned: (N, 3) m and (N, 9), pose of each object in its group.
        apart: (N,) 0 for an object with the pose of its group, 1 for one that is moved, 2 for one that is also rotated.
        places: (N,) offset of the seven numbers x, y, z and quaternion x, y, z, w in the templates.
    """

    positions: Integers
    rotations: Integers
    slots: Integers
    offsets: Floats
    turned: Floats
    apart: Bytes
    places: Integers


class Scans(NamedTuple):
    """The distances of N scanners in R ticks.

    Attributes:
        distances: (R,) addresses of arrays (B, rays), m.
        members: (N,) row of each scanner in these arrays.
        rays: number of rays of a scan.
        kept: number of rays of each scan that are written; the first rays.
        reaches: (N,) m.
        places: (N,) offset of the distances in the templates.
    """

    distances: Integers
    members: Integers
    rays: int
    kept: int
    reaches: Floats
    places: Integers


#: forms of a number of a message: double precision; the same plus zero, which removes the sign of zero; single
#: precision; four numbers, a quaternion w, x, y, z that becomes a unit quaternion x, y, z, w
DOUBLE, SUM, SINGLE, TURN = range(4)


class Numbers(NamedTuple):
    """Numbers of messages that are those of the data in R ticks.

    Attributes:
        data: (R, F).
        which: (M, 3) form, offset in the templates, column in the data, of a quaternion the first of four.
    """

    data: Floats
    which: Integers


class Similar(NamedTuple):
    """Where the records of R ticks resemble others. Each tick has one of L layouts, which consist of spans.

    Attributes:
        begins: (R,) offset of the first record of each tick, ascending, bytes.
        layouts: (R,) layout of each tick.
        firsts: (L + 1,) first span of each layout, and the number of all spans.
        spans: (S, 4) offset in the tick, length, distance of the bytes that it resembles, and column; the distance 0
            refers to the same column in the tick before. The spans of a tick are in order and do not overlap.
        columns: number of columns.
    """

    begins: Integers
    layouts: Integers
    firsts: Integers
    spans: Integers
    columns: int
