"""A linkage in Python: the reference for the C function, which gives bit-identical results."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.kernel.linkage import PRISMATIC, REVOLUTE
from morse.physics.poses.rigid import quaternion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.kernel.linkage import LinkageArrays

_NOWHERE = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
_ALIKE = 1e-14


class Linkage:
    """See `morse.kernel.linkage.LinkageWork`."""

    def __init__(self, arrays: LinkageArrays) -> None:
        self._arrays = arrays

    def move(self) -> tuple[float, float]:
        """Fill the results, and place the shapes."""
        all_ = self._arrays
        for i in range(len(all_.parents)):
            all_.frames[i] = self._bone(i)
        for i, outer in enumerate(all_.outers.tolist()):
            hook, grasp = int(all_.hooks[i]), all_.held[i].tolist()
            local = grasp if hook < 0 else composed(all_.frames[hook].tolist(), grasp)
            pose = composed((all_.base if outer < 0 else all_.poses[outer]).tolist(), local)
            # a pose equal to that of the body within rounding errors is replaced by it
            is_apart = any(not -_ALIKE <= a - b <= _ALIKE for a, b in zip(pose, _NOWHERE, strict=True))
            all_.locals[i], all_.poses[i] = local, pose if is_apart else _NOWHERE
        return self._place_shapes()

    def _bone(self, i: int) -> list[float]:
        all_ = self._arrays
        parent, axis, kind = int(all_.parents[i]), int(all_.axes[i]), int(all_.kinds[i])
        outer = _NOWHERE if parent < 0 else all_.frames[parent].tolist()
        frame = composed(outer, [*all_.places[i].tolist(), *all_.turns[i].tolist()])
        c, s = all_.moves[i].tolist()
        r = frame[3:]
        if kind == PRISMATIC:
            frame[:3] = [place + c * r[axis + 3 * k] for k, place in enumerate(frame[:3])]
        elif kind == REVOLUTE:
            one, other = (axis + 1) % 3, (axis + 2) % 3
            for row in (0, 3, 6):
                a, b = r[row + one], r[row + other]
                frame[3 + row + one], frame[3 + row + other] = c * a + s * b, c * b - s * a
        return frame

    def _place_shapes(self) -> tuple[float, float]:
        all_ = self._arrays
        lowest, reach = math.inf, 0.0
        up = all_.up.tolist()
        for geom, owner, mount in zip(all_.geoms.tolist(), all_.owners.tolist(), all_.mounts.tolist(), strict=True):
            pose = composed(all_.poses[owner].tolist(), mount)
            (x, y, z), r = pose[:3], pose[3:]
            all_.geom_positions[geom], all_.geom_quaternions[geom] = (x, y, z), quaternion(r)
            height, box = up[0] * x + up[1] * y + up[2] * z, all_.geom_boxes[geom].tolist()
            for k in range(3):
                along = up[0] * r[k] + up[1] * r[k + 3] + up[2] * r[k + 6]
                height = height + along * box[k] - abs(along) * box[k + 3]
            lowest = min(lowest, height)
        for geom in all_.all_geoms.tolist():
            x, y, z = all_.geom_positions[geom].tolist()
            reach = max(reach, math.sqrt(x * x + y * y + z * z) + float(all_.geom_radii[geom]))
        return reach, lowest


def composed(outer: Sequence[float], inner: Sequence[float]) -> list[float]:
    """The pose ``inner`` in the frame ``outer``: 12 numbers each."""
    r, (x, y, z), b = outer[3:], inner[:3], inner[3:]
    place = [outer[k] + (r[3 * k] * x + r[3 * k + 1] * y + r[3 * k + 2] * z) for k in range(3)]
    return place + [
        r[row] * b[column] + r[row + 1] * b[column + 3] + r[row + 2] * b[column + 6]
        for row in (0, 3, 6)
        for column in range(3)
    ]
