"""Triangle meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(eq=False, slots=True, weakref_slot=True)
class Image:
    """An encoded image.

    Attributes:
        data: the bytes of a PNG or JPEG file.
        mime: ``image/png`` or ``image/jpeg``.
    """

    name: str
    data: bytes
    mime: str


@dataclass(eq=False, slots=True)
class Material:
    """A surface in the metallic-roughness model.

    Attributes:
        color: linear RGBA, 0..1; multiplied by the image if there is one.
        emission: linear RGB times strength.
        specular: 0..1; a laser scanner reports it as remission.
        image: base colour texture, or None.
        shadeless: whether the surface is shown in its own colour, without lighting.
    """

    name: str
    color: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    metallic: float = 0.0
    roughness: float = 0.6
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    specular: float = 0.5
    image: Image | None = None
    shadeless: bool = False
    double_sided: bool = True


@dataclass(slots=True)
class Light:
    """A lamp that shines along the -Z axis of its node.

    Attributes:
        type: ``POINT``, ``SUN``, ``SPOT``, ``AREA`` or ``HEMI``.
        energy: relative to 1, the brightness of a normal lamp (for every type).
        distance: distance at which the intensity has fallen to half, m.
        spot_size: full opening angle of a spot, radians.
    """

    type: str = "POINT"
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    energy: float = 1.0
    distance: float = 25.0
    spot_size: float = 1.3
    casts_shadow: bool = True


@dataclass(slots=True)
class Camera:
    """A pinhole camera that looks along the -Z axis of its node, +Y up.

    Attributes:
        focal_length: mm, for a sensor 32 mm wide.
        clip_start: metres.
        clip_end: metres.
    """

    focal_length: float = 35.0
    clip_start: float = 0.1
    clip_end: float = 100.0


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
        follows: (V,) int32, of a deformable body: which child of its node each vertex follows; the physics moves these.
            None for others.
    """

    name: str
    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    material_index: NDArray[np.int32]
    uvs: NDArray[np.float32] | None = None
    normals: NDArray[np.float32] | None = None
    materials: tuple[Material | None, ...] = ()
    follows: NDArray[np.int32] | None = None
