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

    Hull = tuple[NDArray[np.float64], NDArray[np.int32]]

#: hulls by the bytes of their points: most scenes are loaded several times in a process
_hulls: dict[bytes, Hull] = {}
_MOST = 1000


def hulls_of(shapes: Sequence[CollisionShape]) -> dict[CollisionShape, Hull]:
    """Return vertices (V, 3) in the frame of the node and faces (T, 3) of convex shapes; the arrays are shared.

    MuJoCo computes the hulls, as for contacts, so that rays and contacts use the same geometry.
    """
    keys = {shape: np.ascontiguousarray(shape.vertices, dtype=np.float32).tobytes() for shape in shapes}
    here = {key: _hulls[key] for key in keys.values() if key in _hulls}
    if missing := list(dict.fromkeys(key for key in keys.values() if key not in here)):
        here.update(zip(missing, _computed(missing), strict=True))
        if len(_hulls) > _MOST:
            _hulls.clear()
        _hulls.update(here)
    return {shape: here[key] for shape, key in keys.items()}


def _computed(points: Sequence[bytes]) -> list[Hull]:
    spec = mujoco.MjSpec()
    for number, rows in enumerate(points):
        spec.add_mesh(
            name=str(number),
            uservert=np.frombuffer(rows, dtype=np.float32),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
    model = spec.compile()
    hulls = []
    for number in range(len(points)):
        mesh = model.mesh(str(number)).id
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        # the compiler has moved the mesh to its centre of mass and principal axes
        rotation = np.reshape(rigid.rotation_of_quaternion(model.mesh_quat[mesh]), (3, 3))
        vertices = matmul(model.mesh_vert[first : first + count].astype(np.float64), rotation.T) + model.mesh_pos[mesh]
        first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        faces = model.mesh_face[first : first + count].astype(np.int32)
        vertices.flags.writeable = faces.flags.writeable = False
        hulls.append((vertices, faces))
    return hulls
