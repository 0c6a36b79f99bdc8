"""The triangles of convex hulls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.scene import CollisionShape


def hulls_of(shapes: Sequence[CollisionShape]) -> dict[CollisionShape, tuple[NDArray[np.float64], NDArray[np.int32]]]:
    """Return vertices (V, 3) in the frame of the node and faces (T, 3) of convex shapes.

    MuJoCo computes the hulls, as for contacts, so that rays and contacts use the same geometry.
    """
    shapes = list(dict.fromkeys(shapes))
    if not shapes:
        return {}
    spec = mujoco.MjSpec()
    for number, shape in enumerate(shapes):
        spec.add_mesh(
            name=str(number),
            uservert=np.ascontiguousarray(shape.vertices, dtype=np.float32).ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
    model = spec.compile()
    hulls = {}
    for number, shape in enumerate(shapes):
        mesh = model.mesh(str(number)).id
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        # the compiler has moved the mesh to its centre of mass and principal axes
        rotation = np.reshape(rigid.rotation_of_quaternion(model.mesh_quat[mesh]), (3, 3))
        vertices = matmul(model.mesh_vert[first : first + count].astype(np.float64), rotation.T) + model.mesh_pos[mesh]
        first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        hulls[shape] = (vertices, model.mesh_face[first : first + count].astype(np.int32))
    return hulls
