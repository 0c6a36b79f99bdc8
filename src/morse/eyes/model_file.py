"""An MJCF file that is simulated by MuJoCo alone, and shown by its own cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.eyes.renderer import Renderer

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

_CAMERA = int(mujoco.mjtObj.mjOBJ_CAMERA)
#: more than there are types of objects
_TYPES = 32


class ModelFile:
    """Runs a model from its initial state, without commands.

    Args:
        path: MJCF file.
        width, height: of the pictures, pixels.

    Raises:
        ValueError: MuJoCo cannot read the file.
    """

    def __init__(self, path: Path, width: int, height: int) -> None:
        try:
            self._model = model = mujoco.MjModel.from_xml_path(str(path))
        except mujoco.FatalError as error:
            raise ValueError(str(error)) from None
        buffer = model.vis.global_
        buffer.offwidth, buffer.offheight = max(buffer.offwidth, width), max(buffer.offheight, height)
        self._data = mujoco.MjData(model)
        self._renderer = Renderer(model, height, width)
        self._steps = 0
        #: names of the cameras of the file
        self.cameras = [mujoco.mj_id2name(model, _CAMERA, n) or str(n) for n in range(model.ncam)]

    def run(self, until: float) -> None:
        """Simulate until that time, s."""
        # MuJoCo sets the time back when it restarts a simulation that has become unstable: steps are counted
        steps = round(until / self._model.opt.timestep) - self._steps
        if steps > 0:
            mujoco.mj_step(self._model, self._data, steps)
            self._steps += steps

    def picture(self, camera: str | None, kind: str) -> NDArray[Any]:
        """Return the present picture.

        Args:
            camera: one of `cameras`; None for MuJoCo's free camera.
            kind: ``rgb``, ``depth`` or ``ids``.

        Returns:
            (H, W, 3) uint8; or (H, W) float32 depths, m, infinite for the background; or (H, W) uint16 numbers of
            objects, 0 for the background.
        """
        mujoco.mj_forward(self._model, self._data)
        self._renderer.update_scene(self._data, -1 if camera is None else self.cameras.index(camera))
        self._renderer.show(kind)
        picture = self._renderer.render()
        if kind == "depth":
            far = self._model.vis.map.zfar * self._model.stat.extent
            return np.where(picture < 0.999 * far, picture, np.float32(np.inf))
        if kind == "ids":
            numbers = picture[..., 0] * _TYPES + picture[..., 1] + 1
            return np.where(picture[..., 0] < 0, 0, np.minimum(numbers, 65535)).astype(np.uint16)
        return picture
