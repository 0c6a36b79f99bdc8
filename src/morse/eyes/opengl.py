"""The functions of MuJoCo that draw with OpenGL, replaced by those of this package for a process."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

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
#: viewports whose pictures a context keeps
_MOST_VIEWPORTS = 64


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


class _Box(NamedTuple):
    """A viewport: columns and rows of the buffer, whose lowest row is 0."""

    left: int
    bottom: int
    right: int
    top: int

    def common(self, other: _Box) -> _Box | None:
        """The part that is in both; nothing if there is none."""
        low, high = map(max, self[:2], other[:2]), map(min, self[2:], other[2:])
        box = _Box(*low, *high)
        return box if box.left < box.right and box.bottom < box.top else None

    def within(self, other: _Box) -> tuple[slice, slice]:
        """The rows and columns of this box in a picture of another one, whose first row is the lowest."""
        rows = slice(self.bottom - other.bottom, self.top - other.bottom)
        return rows, slice(self.left - other.left, self.right - other.left)


class _Picture(NamedTuple):
    """What has been drawn in a viewport; the first row of colours is the highest."""

    box: _Box
    scene: Any
    geoms: _Snapshot
    view: View
    colors: NDArray[np.uint8]


def _box_of(viewport: Any) -> _Box:
    left, bottom, width, height = (int(getattr(viewport, name)) for name in ("left", "bottom", "width", "height"))
    return _Box(left, bottom, left + width, bottom + height)


class MjrContext:
    """Replaces `mujoco.MjrContext`: what draws a model, and the last picture of each viewport.

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
        self._pictures: list[_Picture] = []

    def free(self) -> None:
        """Release the memory."""
        self._artist = self._scene = self._geoms = None
        self._pictures = []

    def render(self, viewport: Any, scene: Any) -> None:
        """See `mjr_render`."""
        if self._artist is None:
            raise RuntimeError("mjr_render cannot be called after the context was freed.")
        if self._scene is not scene or self._geoms is None:
            self._scene, self._geoms = scene, GeomArray(scene, three_geoms, self._model)
        view = view_of(scene, int(viewport.width), int(viewport.height))
        geoms = _Snapshot(self._geoms.now().copy())
        box = _box_of(viewport)
        picture = _Picture(box, scene, geoms, view, shown(self._artist, scene, geoms, view))
        others = [one for one in self._pictures if one.box.common(box) != one.box]
        self._pictures = [*others[1 - _MOST_VIEWPORTS :], picture]

    def read(self, rgb: NDArray[np.uint8] | None, depth: NDArray[np.float32] | None, viewport: Any) -> None:
        """See `mjr_readPixels`; what has not been drawn is black and at the far plane."""
        if self._artist is None or not self._pictures:
            raise RuntimeError("mjr_readPixels cannot be called before mjr_render, or after the context was freed.")
        read = _box_of(viewport)
        parts = [(one, common) for one in self._pictures if (common := one.box.common(read)) is not None]
        if not parts:
            raise ValueError(
                f"mjr_readPixels reads {viewport.width} x {viewport.height} pixels from ({read.left}, {read.bottom}) "
                f"on, where mjr_render has drawn nothing; the last viewport is {tuple(self._pictures[-1].box)} "
                "(left, bottom, right, top)."
            )
        shape = read.top - read.bottom, read.right - read.left
        if rgb is not None:
            pixels = np.zeros((*shape, 3), np.uint8)
            for one, common in parts:
                pixels[common.within(read)] = one.colors[::-1][common.within(one.box)]
            rgb.reshape(pixels.shape)[:] = pixels
        if depth is not None:
            shares = np.zeros(shape)
            for one, common in parts:
                shares[common.within(read)] = self._shares(one)[::-1][common.within(one.box)]
            depth.reshape(shape)[:] = shares if self.readDepthMap == _ZERO_FAR else 1 - shares

    def _shares(self, one: _Picture) -> NDArray[np.float64]:
        """The depths (H, W) of a picture as OpenGL keeps them: 1 at the near plane and 0 at the far plane."""
        assert self._artist is not None
        view = one.view
        near, far = view.near, view.far
        metres = self._artist.depths(one.scene, one.geoms, view).astype(np.float64)
        share = (far - metres) / (far - near)
        return np.asarray(share if view.parallel else share * near / metres, np.float64)


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
