"""A drop-in for `mujoco.Renderer` that needs neither OpenGL nor a display."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.eyes.geoms import GeomArray, LightArray
from morse.eyes.picture import LOOKS, Artist, view_of
from morse.eyes.segments import shown
from morse.kernel import threads

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from numpy.typing import NDArray

    from morse.eyes.batch import BatchRenderer
    from morse.eyes.picture import View


class Renderer:
    """Renders pictures of a model of MuJoCo; arguments, methods and errors are those of `mujoco.Renderer`.

    Args:
        model: `mujoco.MjModel`.
        height, width: of the pictures, pixels; at most those of the offscreen buffer of the model.
        max_geom: largest number of geoms of a scene; None for a number that suffices for the model, with 2,000 more.
            `scene` is then another one from the first option on that shows more than MuJoCo does by default.
        font_scale: ignored: texts are not drawn.
        look: ``classic`` for the look of MuJoCo's own renderer, ``morse`` for that of the cameras of MORSE.

    Raises:
        TypeError: the size is not an integer.
        ValueError: the size is larger than the offscreen buffer or not positive, or the look is unknown.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        height: int = 240,
        width: int = 320,
        max_geom: int | None = None,
        font_scale: object = None,
        *,
        look: str = "classic",
    ) -> None:
        del font_scale
        self._artist: Artist | None = None
        check_model(model)
        if max_geom is not None:
            check_count("max_geom", max_geom, 0)
        buffer = model.vis.global_
        for name, size, most in (("width", width, buffer.offwidth), ("height", height, buffer.offheight)):
            if not isinstance(size, (int, np.integer)) or isinstance(size, bool):
                raise TypeError(f"Image {name} {size!r} is not an integer.")
            if size < 1:
                raise ValueError(f"Image {name} {size} is not positive.")
            if size > most:
                raise ValueError(
                    f"Image {name} {size} > framebuffer {name} {most}. Either reduce the image {name} or specify a "
                    f'larger offscreen framebuffer in the model XML: <visual><global off{name}="{size}"/></visual>'
                )
        if look not in LOOKS:
            raise ValueError(f"The look {look!r} does not exist; there are: {', '.join(LOOKS)}.")
        self._model, self._width, self._height = model, int(width), int(height)
        self._scene = mujoco.MjvScene(
            model=model, maxgeom=_room_for(model, all_of_it=False) if max_geom is None else max_geom
        )
        #: a scene takes 0.8 kB a geom: one that has room for everything is made when it is needed
        self._grows = max_geom is None
        self._geoms = GeomArray(self._scene, three_geoms, self._model)
        self._lights = LightArray(self._scene, three_geoms)
        self._scene_option = mujoco.MjvOption()
        self._artist = Artist(model, look, 2 * max(width, height))
        self._mode = "rgb"
        #: what draws serves one call at a time
        self._lock = threads.lock()

    @property
    def model(self) -> mujoco.MjModel:
        """The model."""
        return self._model

    @property
    def scene(self) -> mujoco.MjvScene:
        """The scene; geoms may be appended after `update_scene`."""
        return self._scene

    @property
    def height(self) -> int:
        """Of the pictures, pixels."""
        return self._height

    @property
    def width(self) -> int:
        """Of the pictures, pixels."""
        return self._width

    def enable_depth_rendering(self) -> None:
        """Let `render` return depths."""
        self._mode = "depth"

    def disable_depth_rendering(self) -> None:
        """Let `render` return colours again."""
        if self._mode == "depth":
            self._mode = "rgb"

    def enable_segmentation_rendering(self) -> None:
        """Let `render` return ids."""
        self._mode = "ids"

    def disable_segmentation_rendering(self) -> None:
        """Let `render` return colours again."""
        if self._mode == "ids":
            self._mode = "rgb"

    def show(self, kind: str) -> None:
        """Let `render` return ``rgb``, ``depth`` or ``ids``.

        Raises:
            ValueError: the kind is another one.
        """
        if kind not in KINDS:
            raise ValueError(f"The kind of pictures {kind!r} does not exist; there are: {', '.join(KINDS)}.")
        self._mode = kind

    def update_scene(
        self,
        data: mujoco.MjData,
        camera: int | str | mujoco.MjvCamera = -1,
        scene_option: mujoco.MjvOption | None = None,
    ) -> None:
        """Take over the present state; pictures show it until the next call.

        Args:
            data: the state; `mujoco.mj_forward` has been called.
            camera: number or name of a camera of the model, -1 for the free camera, or any camera.
            scene_option: which groups and elements are shown.

        Raises:
            RuntimeError: the renderer is closed.
            ValueError: there is no such camera, its frustum begins at it, or the state is one of another model.
        """
        self._open("update_scene")
        check_state(self._model, data)
        if scene_option is not None and not isinstance(scene_option, mujoco.MjvOption):
            raise TypeError(f"Expected an option, mujoco.MjvOption, got {type(scene_option).__name__}.")
        if not isinstance(camera, mujoco.MjvCamera):
            camera = camera_of(self._model, camera)
        with self._lock:
            if self._grows and scene_option is not None and not _is_usual(scene_option):
                self._grow()
            # infinite planes are placed around the camera of the scene, which would be that of the last call
            mujoco.mjv_updateCamera(self._model, data, camera, self._scene)
            near = min(view.frustum_near for view in self._scene.camera[:2])
            if near < _NEAREST:
                # mjv_updateScene would end the process
                raise ValueError(
                    f"The frustum of the camera begins at {near:g} m, at least {_NEAREST:g} is needed: vis.map.znear "
                    f"is {self._model.vis.map.znear:g}, stat.extent is {self._model.stat.extent:g}; their product is "
                    "the distance."
                )
            mujoco.mjv_updateScene(
                self._model,
                data,
                scene_option or self._scene_option,
                None,
                camera,
                mujoco.mjtCatBit.mjCAT_ALL.value,
                self._scene,
            )

    def _grow(self) -> None:
        """Take a scene that has room for everything that options can show."""
        self._grows, old = False, self._scene
        self._scene = mujoco.MjvScene(model=self._model, maxgeom=_room_for(self._model, all_of_it=True))
        self._scene.flags[:] = old.flags
        self._geoms = GeomArray(self._scene, three_geoms, self._model)
        self._lights = LightArray(self._scene, three_geoms)

    def render(self, *, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """Return the picture.

        Args:
            out: array into which it is written, of the same shape; other types are cast.

        Returns:
            (H, W, 3) uint8 colours; or (H, W) float32 depths along the axis, m; or (H, W, 2) int32 ids and types of
            objects, -1 for none.

        Raises:
            RuntimeError: the renderer is closed.
            ValueError: `out` has another shape, or the scene has no finite camera.
        """
        artist = self._open("render")
        shape = (self._height, self._width, *KINDS[self._mode][0])
        if out is not None and not isinstance(out, np.ndarray):
            raise TypeError(f"Expected an array, out, got {type(out).__name__}.")
        if out is not None and out.shape != shape:
            raise ValueError(f"Expected out.shape == {shape}. Got out.shape={out.shape} instead.")
        with self._lock:
            view = view_of(self._scene, self._width, self._height)
            if self._mode == "rgb":
                picture: NDArray[Any] = shown(artist, self._scene, self._geoms, view)
            else:
                draw = artist.depths if self._mode == "depth" else artist.objects
                picture = draw(self._scene, self._geoms, view)
        if out is None:
            return picture
        np.copyto(out, picture, casting="unsafe")
        return out

    @classmethod
    def batch(
        cls,
        model: mujoco.MjModel,
        count: int,
        height: int = 240,
        width: int = 320,
        max_geom: int | None = None,
        *,
        look: str = "classic",
    ) -> BatchRenderer:
        """Return a renderer of many states of a model; see `BatchRenderer`.

        Args:
            count: number of states, N.
            height, width, max_geom, look: see `Renderer`.

        Raises:
            ValueError: see `Renderer`; or the number is less than 1.
        """
        from morse.eyes.batch import BatchRenderer

        return BatchRenderer(model, count, lambda: cls(model, height, width, max_geom, look=look))

    def close(self) -> None:
        """Release the memory; `render` cannot be called afterwards."""
        self._artist = None

    def memory(self) -> int:
        """Return about how many bytes a picture needs while it is drawn, with shadow maps and a mirrored picture."""
        texels, _ = self._open("render").texels
        return 32 * self._width * self._height + 4 * texels**2 * int(np.count_nonzero(self._model.light_castshadow))

    def shown_scene(self) -> tuple[Artist, NDArray[np.void], NDArray[np.void], View]:
        """Return what draws the present scene, its geoms (G,) and lights (L,), and its camera.

        The arrays are those of the scene. The errors are those of `render`.
        """
        artist = self._open("render")
        return artist, self._geoms.now(), self._lights.now(), view_of(self._scene, self._width, self._height)

    def __reduce__(self) -> Any:
        raise TypeError("cannot pickle 'Renderer' object: make one of the model in each process")

    def _open(self, what: str) -> Artist:
        if self._artist is None:
            raise RuntimeError(f"{what} cannot be called after close.")
        return self._artist

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


#: kinds of pictures: the shape of a pixel, and its type
KINDS: dict[str, tuple[tuple[int, ...], type]] = {
    "rgb": ((3,), np.uint8),
    "depth": ((), np.float32),
    "ids": ((2,), np.int32),
}


#: least distance to the near plane in MuJoCo, m: mjMINVAL
_NEAREST = float(mujoco.mjMINVAL)

#: sizes of models on which the arrays of states depend that pictures and rays read
_SIZES: tuple[str, ...] = (
    *("nq", "nv", "nu", "nbody", "njnt", "ngeom", "nsite", "ncam", "nlight", "ntendon", "nwrap", "nsensordata"),
    *("nflex", "nflexvert", "nflexelem", "nskin", "nskinvert", "nmocap"),
)


def _room_for(model: mujoco.MjModel, *, all_of_it: bool) -> int:
    """A number of geoms for a model: those that are shown by default, or all of them.

    All of them include frames, labels, forces and contacts.
    """
    # a slack tendon is a chain of segments
    shown = model.ngeom + model.nsite + 2 * model.nwrap + 40 * model.ntendon + 16 * model.nflex + model.nskin
    shown += model.nsensordata  # rays of range finders
    rest = 3 * shown + 4 * (model.nbody + model.njnt + model.nu + model.nsensor) if all_of_it else 0
    return int(shown + rest + 2000)


def _is_usual(option: mujoco.MjvOption) -> bool:
    """Whether an option shows no more kinds of elements than MuJoCo does by default."""
    usual = _usual_flags()
    return not ((np.asarray(option.flags) != 0) & ~usual).any() and not option.frame and not option.label


@cache
def _usual_flags() -> NDArray[np.bool_]:
    return np.array(mujoco.MjvOption().flags, np.bool_)


def check_model(model: object) -> None:
    """Check that something is a model.

    Raises:
        TypeError: it is not a model.
    """
    if not isinstance(model, mujoco.MjModel):
        raise TypeError(
            f"Expected a model, mujoco.MjModel, got {type(model).__name__}; of a file: mujoco.MjModel.from_xml_path."
        )


def check_count(name: str, number: object, least: int) -> None:
    """Check a number of something.

    Raises:
        TypeError: it is not an integer.
        ValueError: it is less than the least one.
    """
    if not isinstance(number, (int, np.integer)) or isinstance(number, bool):
        raise TypeError(f"{name} is an integer, got {number!r}.")
    if number < least:
        raise ValueError(f"{name} is at least {least}, got {number}.")


def check_state(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Check that a state is one of a model, or of one of the same sizes: MuJoCo would read memory of others.

    Raises:
        TypeError: it is not a state.
        ValueError: it is one of another model.
    """
    if not isinstance(data, mujoco.MjData):
        raise TypeError(f"Expected a state, mujoco.MjData, got {type(data).__name__}.")
    own = data.model
    if own is model:
        return
    sizes = [
        f"{name} {getattr(own, name)} instead of {getattr(model, name)}"
        for name in _SIZES
        if getattr(own, name) != getattr(model, name)
    ]
    if sizes:
        raise ValueError(f"The state is one of another model: {', '.join(sizes)}.")


def three_geoms() -> mujoco.MjvScene:
    """Return a scene that has room for three geoms."""
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    return mujoco.MjvScene(model, maxgeom=3)


def camera_of(model: mujoco.MjModel, camera: int | str) -> mujoco.MjvCamera:
    """Return a camera of a model by number or name, -1 for the free camera.

    Raises:
        TypeError: it is neither of them.
        ValueError: there is no such camera.
    """
    number = camera
    if isinstance(number, bool) or not isinstance(number, (int, str, np.integer)):
        raise TypeError(f"A camera is a number, a name or a mujoco.MjvCamera, got {camera!r}.")
    if isinstance(number, str):
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA.value, number)
        if number == -1:
            raise ValueError(f'The camera "{camera}" does not exist.')
    if not -1 <= number < model.ncam:
        raise ValueError(f"The camera id {number} is out of range [-1, {model.ncam}).")
    view = mujoco.MjvCamera()
    view.fixedcamid = number
    if number == -1:
        view.type = mujoco.mjtCamera.mjCAMERA_FREE
        mujoco.mjv_defaultFreeCamera(model, view)
    else:
        view.type = mujoco.mjtCamera.mjCAMERA_FIXED
    return view
