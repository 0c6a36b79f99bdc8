"""The functions of MuJoCo that draw with OpenGL, replaced by those of this package for a process."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.eyes.geoms import GeomArray
from morse.eyes.picture import LOOKS, Artist, View, view_of
from morse.eyes.renderer import Renderer, three_geoms
from morse.eyes.segments import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: rendering flags and maps of depths (`mujoco.mjtRndFlag`, `mujoco.mjtDepthMap`)
_ZERO_NEAR, _ZERO_FAR = 0, 1


class GLContext:
    """A context of OpenGL, which is not needed."""

    def __init__(self, max_width: int = 0, max_height: int = 0, device_id: int = -1) -> None:
        del max_width, max_height, device_id

    def make_current(self) -> None:
        """Do nothing."""

    def free(self) -> None:
        """Do nothing."""


class _Snapshot:
    """The geoms of a scene at the time of a picture."""

    def __init__(self, geoms: NDArray[np.void]) -> None:
        self._geoms = geoms

    def now(self) -> NDArray[np.void]:
        return self._geoms


class MjrContext:
    """Replaces `mujoco.MjrContext`: what draws a model, and the last picture.

    Attributes:
        offWidth, offHeight: largest size, pixels.
        currentBuffer: as `mjr_setBuffer` has set it; there is only one buffer.
        readDepthMap: 0 if depths are 0 at the near plane, 1 if they are 0 at the far plane.
    """

    look = "classic"

    def __init__(self, model: mujoco.MjModel | None = None, fontscale: object = None) -> None:
        del fontscale
        buffer = None if model is None else model.vis.global_
        self.offWidth = 0 if buffer is None else int(buffer.offwidth)
        self.offHeight = 0 if buffer is None else int(buffer.offheight)
        self.offSamples, self.currentBuffer, self.readDepthMap = 4, 0, _ZERO_NEAR
        self.offFBO, self.windowAvailable = 1, 0
        self.size = max(self.offWidth, self.offHeight, 1)
        self._model = model
        self._artist = None if model is None else Artist(model, self.look, self.size)
        self._scene: Any = None
        self._geoms: GeomArray | None = None
        self._shown: tuple[Any, _Snapshot, View] | None = None
        self._colors = np.zeros((0, 0, 3), np.uint8)

    def free(self) -> None:
        """Release the memory."""
        self._artist = self._shown = self._scene = self._geoms = None

    def render(self, viewport: Any, scene: Any) -> None:
        """See `mjr_render`."""
        if self._artist is None:
            raise RuntimeError("mjr_render cannot be called after the context was freed.")
        if self._scene is not scene or self._geoms is None:
            self._scene, self._geoms = scene, GeomArray(scene, three_geoms, self._model)
        view = view_of(scene, int(viewport.width), int(viewport.height))
        geoms = _Snapshot(self._geoms.now().copy())
        self._shown = scene, geoms, view
        self._colors = shown(self._artist, scene, geoms, view)

    def read(self, rgb: NDArray[np.uint8] | None, depth: NDArray[np.float32] | None, viewport: Any) -> None:
        """See `mjr_readPixels`."""
        if self._artist is None or self._shown is None:
            raise RuntimeError("mjr_readPixels cannot be called before mjr_render, or after the context was freed.")
        scene, geoms, view = self._shown
        shape = int(viewport.height), int(viewport.width)
        if shape != (view.height, view.width):
            raise ValueError(
                f"mjr_readPixels reads what mjr_render has drawn, {view.height} x {view.width}, not {shape}."
            )
        if rgb is not None:
            rgb.reshape(*shape, 3)[:] = self._colors[::-1]
        if depth is not None:
            near, far = view.near - view.shift, view.far - view.shift
            metres = self._artist.depths(scene, geoms, view).astype(np.float64)
            share = (far - metres) / (far - near)
            if not view.shift:
                share *= near / metres
            depth.reshape(shape)[:] = (share if self.readDepthMap == _ZERO_FAR else 1 - share)[::-1]


def _render(viewport: Any, scn: Any, con: MjrContext) -> None:
    con.render(viewport, scn)


def _read_pixels(
    rgb: NDArray[np.uint8] | None, depth: NDArray[np.float32] | None, viewport: Any, con: MjrContext
) -> None:
    con.read(rgb, depth, viewport)


def _set_buffer(framebuffer: int, con: MjrContext) -> None:
    con.currentBuffer = int(framebuffer)


def _nothing(*arguments: object, **named: object) -> None:
    """Texts, figures and uploads are not drawn."""


#: what replaces the names of `mujoco`
_NAMES: dict[str, Any] = {
    "MjrContext": MjrContext,
    "Renderer": Renderer,
    "mjr_render": _render,
    "mjr_readPixels": _read_pixels,
    "mjr_setBuffer": _set_buffer,
    **dict.fromkeys(
        ("mjr_overlay", "mjr_text", "mjr_figure", "mjr_rectangle", "mjr_finish", "mjr_resizeOffscreen"), _nothing
    ),
}


class _Contexts(ModuleType):
    """Replaces a module that makes contexts of OpenGL: all its classes need none."""

    def __getattr__(self, name: str) -> Any:
        if not name.endswith("Context"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}: morse.eyes.install replaced it")
        if not self.__name__.startswith("dm_control."):
            return GLContext
        base = importlib.import_module("dm_control._render.base").ContextBase
        direct = importlib.import_module("dm_control._render.executor").PassthroughRenderExecutor

        def make(context: Any, max_width: int, max_height: int) -> None:
            # a thread of OpenGL is not needed, and would have ended when a process that ends frees its contexts
            base.__init__(context, max_width, max_height, direct)

        methods = ("_platform_init", "_platform_make_current", "_platform_free")
        made = type(name, (base,), {"__module__": self.__name__, "__init__": make, **dict.fromkeys(methods, _nothing)})
        setattr(self, name, made)
        return made


#: modules that make contexts of OpenGL: of MuJoCo, dm_control and robosuite
_CONTEXTS = (
    *("mujoco.egl", "mujoco.osmesa", "mujoco.glfw"),
    *("dm_control._render.pyopengl.egl_renderer", "dm_control._render.pyopengl.osmesa_renderer"),
    "dm_control._render.glfw_renderer",
    *(f"robosuite.renderers.context.{name}_context" for name in ("egl", "osmesa", "glfw")),
)
_before: dict[str, Any] = {}


def install(*, look: str = "classic") -> None:
    """Let `mujoco.Renderer`, `mujoco.MjrContext` and the functions ``mjr_*`` draw without OpenGL in this process.

    dm_control and robosuite make contexts of OpenGL by themselves: these are replaced, too.

    Programs that import these names before keep those that they have: call it first. It does not matter how often.

    Args:
        look: ``classic`` or ``morse``, see `morse.Renderer`.

    Raises:
        ValueError: the look is unknown.
    """
    if look not in LOOKS:
        raise ValueError(f"The look {look!r} does not exist; there are: {', '.join(LOOKS)}.")
    MjrContext.look = look
    if _before:
        return
    _before.update({name: getattr(mujoco, name, None) for name in (*_NAMES, "GLContext")})
    _before.update({name: sys.modules.get(name) for name in _CONTEXTS})
    for name, value in {**_NAMES, "GLContext": GLContext}.items():
        setattr(mujoco, name, value)
    for name in _CONTEXTS:
        sys.modules[name] = _Contexts(name, _Contexts.__doc__)


def uninstall() -> None:
    """Give MuJoCo its own functions back."""
    for name, value in _before.items():
        if name in _CONTEXTS:
            sys.modules.pop(name, None)
            if value is not None:
                sys.modules[name] = value
        elif value is None:
            delattr(mujoco, name)
        else:
            setattr(mujoco, name, value)
    _before.clear()
