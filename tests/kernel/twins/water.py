"""The forces of water in Python: the reference for the C function, which gives bit-identical results."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.kernel.water import WaterValues


def push(values: WaterValues) -> None:
    """Compute force and torque of the water on a box of eight cells."""
    (vx, vy, vz), (wx, wy, wz) = values.linear, values.angular
    (dx, dy, dz), (mx, my, mz), up = values.drag, values.centre, tuple(values.up)
    depth, half, most = values.depth, values.half, values.most
    fx = fy = fz = tx = ty = tz = 0.0
    for number, (x, y, z) in enumerate(values.cells):
        share = min(max((depth + values.swell[number // 2] - up[0] * x - up[1] * y - up[2] * z) / half + 0.5, 0.0), 1.0)
        u, v, w = vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x
        rise = up[0] * u + up[1] * v + up[2] * w - values.rise[number // 2]
        # a part at the surface makes waves
        part, lift = -share / 8.0, values.lift * share - (values.bob * rise if 0.0 < share < 1.0 else 0.0)
        a = part * u * min(abs(u) * dx, most) + lift * up[0]
        b = part * v * min(abs(v) * dy, most) + lift * up[1]
        c = part * w * min(abs(w) * dz, most) + lift * up[2]
        fx, fy, fz = fx + a, fy + b, fz + c
        # the force acts at the centre of mass, approximated by the centre of the box
        x, y, z = x - mx, y - my, z - mz
        tx, ty, tz = tx + y * c - z * b, ty + z * a - x * c, tz + x * b - y * a
    values.force[:] = fx, fy, fz
    values.torque[:] = tx, ty, tz
