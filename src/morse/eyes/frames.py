"""Frames of a model of MuJoCo: where they are in a state, how they move, and what an accelerometer there feels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.core.reports.quoting import nearest, shown
from morse.eyes.renderer import check_state
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: types of objects with a pose, in the order in which names are searched
_TYPES = {
    "site": mujoco.mjtObj.mjOBJ_SITE,
    "body": mujoco.mjtObj.mjOBJ_XBODY,
    "camera": mujoco.mjtObj.mjOBJ_CAMERA,
    "geom": mujoco.mjtObj.mjOBJ_GEOM,
}
#: the axes of sensors of scenes, X forward and Z up, in those of a camera, which looks along -Z
_IN_CAMERA = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])


class Frame:
    """The frame of a sensor: X forward, Y left, Z up; at cameras, X is the direction in which they look.

    Args:
        model: `mujoco.MjModel`.
        at: name of a site, else of a body, a camera or a geom; ``camera:NAME`` names the type.

    Attributes:
        body: number of its body.
        root: number of the first body of its kinematic tree, 0 for the world.

    Raises:
        ValueError: there is no such object.
    """

    def __init__(self, model: mujoco.MjModel, at: str) -> None:
        self._model = model
        given, _, rest = str(at).partition(":")
        kinds, name = ([given], rest) if rest and given in _TYPES else (list(_TYPES), str(at))
        for kind in kinds:
            number = mujoco.mj_name2id(model, _body_or(kind), name)
            if number >= 0:
                break
        else:
            names = [
                mujoco.mj_id2name(model, _body_or(kind), n) or ""
                for kind in kinds
                for n in range(getattr(model, {"body": "nbody", "camera": "ncam"}.get(kind, f"n{kind}")))
            ]
            known = nearest(name, [one for one in names if one], say=f"there are the {' and '.join(kinds)} names")
            raise ValueError(f"The model has no {' or '.join(kinds)} {shown(name)}{known}")
        self._kind, self._number = kind, number
        self.body = (
            number if kind == "body" else int(getattr(model, f"{'cam' if kind == 'camera' else kind}_bodyid")[number])
        )
        self.root = int(model.body_rootid[self.body])

    def pose(self, data: mujoco.MjData) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the position (3,), m, and the rotation (3, 3) into the world.

        Raises:
            ValueError: the state is one of another model.
        """
        check_state(self._model, data)
        prefix = {"body": "", "camera": "cam_"}.get(self._kind, f"{self._kind}_")
        position = getattr(data, f"{prefix}xpos")[self._number].copy()
        rotation = getattr(data, f"{prefix}xmat")[self._number].reshape(3, 3)
        return position, self._own(rotation)

    def _own(self, rotation: NDArray[np.float64]) -> NDArray[np.float64]:
        return matmul(rotation, _IN_CAMERA) if self._kind == "camera" else rotation.copy()

    def felt(self, data: mujoco.MjData) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the angular velocity (3,), rad/s, and the specific force (3,), m/s^2, in the axes of the frame.

        They are those of MuJoCo's gyroscope and accelerometer. ``data.cacc`` is computed.
        """
        check_state(self._model, data)
        mujoco.mj_rnePostConstraint(self._model, data)
        both = np.zeros(6), np.zeros(6)
        kind = int(_TYPES[self._kind])
        mujoco.mj_objectVelocity(self._model, data, kind, self._number, both[0], 1)
        mujoco.mj_objectAcceleration(self._model, data, kind, self._number, both[1], 1)
        turn = self._own(np.eye(3))
        return matmul(both[0][None, :3], turn)[0], matmul(both[1][None, 3:], turn)[0]


def _body_or(kind: str) -> int:
    """Bodies are named as such; their frames are those of `mjOBJ_XBODY`."""
    return int(mujoco.mjtObj.mjOBJ_BODY if kind == "body" else _TYPES[kind])


def bodies_of_geoms(model: mujoco.MjModel) -> tuple[NDArray[np.intp], dict[str, int], list[int]]:
    """Return the body of each geom (G,), the bodies by name, and the parent of each body."""
    names = {
        name: n
        for n in range(model.nbody)
        if (name := mujoco.mj_id2name(model, int(mujoco.mjtObj.mjOBJ_BODY), n)) is not None
    }
    return np.array(model.geom_bodyid, np.intp), names, np.array(model.body_parentid).tolist()


#: type of an object that is a geom, in pictures of ids
GEOM = int(mujoco.mjtObj.mjOBJ_GEOM)
