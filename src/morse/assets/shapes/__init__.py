"""Collision shapes from triangle meshes.

The physics supports boxes, spheres, cylinders, capsules and convex hulls. A mesh with the shape of one of these solids
is represented by the solid. Any other mesh is divided into such solids, so that rooms, doorways and shelves stay
hollow.

CoACD (`morse.assets.shapes.coacd_parts`) is not used instead, because it approximates volumes and takes longer. Parts,
CPU time and volume, measured with CoACD 1 and its default threshold:

| mesh | volume, m³ | parts here | parts of CoACD |
|---|--:|---|---|
| room with a doorway, 76 triangles | 21.2 | 18, 0.01 s, 21.4 m³ | 14, 37 s, 31.6 m³ |
| bumpy ball that moves, 1,280 triangles | 4.18 | 17, 0.3 s, 4.17 m³ | 6, 2.9 s, 4.06 m³ |
| ring that moves, 2,304 triangles | 1.22 | 29, 0.2 s, 1.56 m³ | 11, 4.1 s, 1.24 m³ |

Those of CoACD fill 4 % of the doorway. For moving meshes with hollows, ``collision="decompose"`` is therefore the
closer choice where the time does not matter.
"""

from morse.assets.shapes.decompose import DEFAULT_LIMIT, convex_parts, few_parts
from morse.assets.shapes.detect import detect_primitive, fit_bounds
from morse.assets.shapes.parts import ConvexPart, Part, Primitive, thickened

__all__ = [
    "DEFAULT_LIMIT",
    "ConvexPart",
    "Part",
    "Primitive",
    "convex_parts",
    "detect_primitive",
    "few_parts",
    "fit_bounds",
    "thickened",
]
