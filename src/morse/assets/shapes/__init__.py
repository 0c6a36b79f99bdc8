"""Collision shapes from triangle meshes.

The physics supports boxes, spheres, cylinders, capsules and convex hulls. A mesh with the shape of one of these solids
is represented by the solid. Any other mesh is divided into such solids, so that rooms, doorways and shelves stay
hollow.
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
