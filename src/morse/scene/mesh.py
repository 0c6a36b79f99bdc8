"""Triangle meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.scene.appearance import Material


@dataclass(eq=False, slots=True, weakref_slot=True)
class Mesh:
    """Triangles in the frame of the node that shows them, without the scale of the node.

    Attributes:
        vertices: (V, 3) float32, metres.
        triangles: (T, 3) int32, indices of vertices, counter-clockwise seen from outside.
        material_index: (T,) int32, index into the material slots of the node.
        uvs: (T, 3, 2) float32 texture coordinates of each corner (v upward), or None.
        normals: (T, 3, 3) float32 unit normal of each corner, or None for flat shading.
        materials: default material slots, used if the node has none.
    """

    name: str
    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    material_index: NDArray[np.int32]
    uvs: NDArray[np.float32] | None = None
    normals: NDArray[np.float32] | None = None
    materials: tuple[Material | None, ...] = ()
