"""Renders many states of a model of MuJoCo at once."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.eyes.batch_lights import kinds_of_lights
from morse.eyes.geoms import looks_of
from morse.eyes.renderer import KINDS, camera_of, check_count, check_model
from morse.eyes.worlds import BatchArtist, Scenes
from morse.kernel import threads

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from numpy.typing import NDArray

    from morse.eyes.picture import Artist, View
    from morse.eyes.renderer import Renderer

#: memory of the pictures and shadow maps that are drawn at once, bytes
_MOST_MEMORY = 48_000_000
#: the largest number of looks of which instances are kept
_MOST_LOOKS = 8


class BatchRenderer:
    """Renders many states of a model at once: each processor draws other pictures, of the same bits as `Renderer`.

    Args:
        model: `mujoco.MjModel`.
        count: number of states, N.
        make: makes a renderer.
    """

    def __init__(self, model: mujoco.MjModel, count: int, make: Callable[[], Renderer]) -> None:
        check_model(model)
        check_count("count, the number of states,", count, 1)
        self._model, self._count = model, count
        self._thread_count = min(threads.count(), count)
        self._renderers = [make() for _ in range(self._thread_count)]
        #: for positions of joints, a state of each thread
        self._states = [mujoco.MjData(model) for _ in self._renderers]
        #: what draws scenes of geoms with the same looks, by `looks_of` these
        self._artists: dict[bytes, BatchArtist] = {}
        #: the renderers serve one call at a time
        self._lock = threads.lock()

    def render(
        self,
        states: Sequence[mujoco.MjData] | NDArray[np.floating],
        cameras: int | str | mujoco.MjvCamera | Sequence[int | str | mujoco.MjvCamera] = -1,
        scene_option: mujoco.MjvOption | None = None,
        *,
        kind: str = "rgb",
    ) -> NDArray[Any]:
        """Return pictures of all states.

        Args:
            states: N states after `mujoco.mj_forward`; or (N, nq) positions of joints, m and rad.
            cameras: a camera as in `Renderer.update_scene`, or a list of C cameras.
            scene_option: see `Renderer.update_scene`.
            kind: ``rgb``, ``depth`` or ``ids``.

        Returns:
            (N, H, W, 3) uint8, (N, H, W) float32 or (N, H, W, 2) int32, see `Renderer.render`; with a list of cameras
            (N, C, ...).

        Raises:
            RuntimeError: the renderer is closed.
            TypeError: a camera is neither a number, nor a name, nor a `mujoco.MjvCamera`.
            ValueError: the number of states, their shape, a camera or the kind is wrong.
        """
        if kind not in KINDS:
            raise ValueError(f"The kind of pictures {kind!r} does not exist; there are: {', '.join(KINDS)}.")
        if len(states) != self._count:
            raise ValueError(f"The batch has {self._count} states, got {len(states)}.")
        if isinstance(states, np.ndarray) and states.dtype.kind not in "biuf":
            raise TypeError(f"Positions are real numbers, got an array of type {states.dtype}.")
        if isinstance(states, np.ndarray) and states.shape != (self._count, self._model.nq):
            raise ValueError(f"Positions have the shape {(self._count, self._model.nq)}, got {states.shape}.")
        several = isinstance(cameras, (Sequence, np.ndarray)) and not isinstance(cameras, str)
        wanted: list[Any] = list(cameras) if several else [cameras]  # type: ignore[arg-type]
        views = [one if isinstance(one, mujoco.MjvCamera) else camera_of(self._model, one) for one in wanted]
        shape, form = KINDS[kind]
        with self._lock:
            # another thread may have closed it meanwhile
            if not self._renderers:
                raise RuntimeError("render cannot be called after close.")
            first = self._renderers[0]
            pictures: NDArray[Any] = np.empty((self._count, len(views), first.height, first.width, *shape), form)
            at_once = max(_MOST_MEMORY // (first.memory() * max(len(views), 1)), self._thread_count)
            for begin in range(0, self._count, at_once):
                end = min(begin + at_once, self._count)
                self._draw(states[begin:end], views, scene_option, kind, pictures[begin:end])
        return pictures if several else pictures[:, 0]

    def _draw(
        self,
        states: Sequence[mujoco.MjData] | NDArray[np.floating],
        cameras: list[mujoco.MjvCamera],
        option: mujoco.MjvOption | None,
        kind: str,
        pictures: NDArray[Any],
    ) -> None:
        """Draw the pictures (N, C, ...) of some states."""
        renderer, count = self._renderers[0], len(states)
        seen: list[_SceneCopy] = []
        # the pictures of a camera follow each other: successive states often are those of one run, and what stands in
        # them is drawn once
        for column, camera in enumerate(cameras):
            for row in range(count):
                renderer.update_scene(self._state(states, row, 0), camera, option)
                chain = column * self._thread_count + row * self._thread_count // count
                seen.append(_SceneCopy(renderer, row, column, chain))
        alone = []
        for group in _groups(seen):
            artist = self._artist_of(group, renderer) if len(group) > 1 else None
            if artist is None:
                alone += group
                continue
            scenes = Scenes(
                np.array([one.geoms for one in group]),
                np.array([one.lights for one in group]),
                [one.view for one in group],
                np.array([one.chain for one in group]),
                renderer.scene.flags,
            )
            out = [pictures[one.row, one.column] for one in group]
            if kind == "rgb":
                artist.colors(scenes, out)
            else:
                artist.surfaces(scenes, kind, out)
        if alone:
            self._draw_alone(states, cameras, option, kind, pictures, [(one.row, one.column) for one in alone])

    def _state(self, states: Sequence[mujoco.MjData] | NDArray[np.floating], row: int, thread: int) -> mujoco.MjData:
        if not isinstance(states, np.ndarray):
            return states[row]
        own = self._states[thread]
        own.qpos[:] = states[row]
        mujoco.mj_fwdPosition(self._model, own)
        return own

    def _artist_of(self, group: list[_SceneCopy], renderer: Renderer) -> BatchArtist | None:
        """What draws scenes with the same looks; None if they can only be drawn one by one."""
        one = group[0]
        if not one.artist.is_plain:
            return None
        looks = looks_of(one.geoms)
        artist = self._artists.get(looks)
        if artist is None:
            if len(self._artists) >= _MOST_LOOKS:
                self._artists.clear()
            artist = self._artists[looks] = BatchArtist(one.artist, one.geoms, renderer.scene)
        return artist if artist.can_draw else None

    def _draw_alone(
        self,
        states: Sequence[mujoco.MjData] | NDArray[np.floating],
        cameras: list[mujoco.MjvCamera],
        option: mujoco.MjvOption | None,
        kind: str,
        pictures: NDArray[Any],
        places: list[tuple[int, int]],
    ) -> None:
        """Draw single pictures; each thread draws others."""
        share = min(self._thread_count, len(places))

        def draw(number: int) -> None:
            renderer = self._renderers[number]
            renderer.show(kind)
            for row, column in places[len(places) * number // share : len(places) * (number + 1) // share]:
                renderer.update_scene(self._state(states, row, number), cameras[column], option)
                renderer.render(out=pictures[row, column])

        # threads of this call alone: a process that is forked has none of them, and an error ends none of the others
        with ThreadPoolExecutor(share, thread_name_prefix="morse-pictures") as pool:
            list(pool.map(draw, range(share)))

    def __reduce__(self) -> Any:
        raise TypeError("cannot pickle 'BatchRenderer' object: make one of the model in each process")

    def close(self) -> None:
        """Release the memory; `render` cannot be called afterwards."""
        with self._lock:
            for renderer in self._renderers:
                renderer.close()
            self._renderers = []
            self._artists = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class _SceneCopy:
    """A copy of the present scene of a renderer.

    Attributes:
        row, column: numbers of the state and of the camera.
        chain: number of the chain of pictures that are drawn one after the other.
        artist: draws it alone.
        geoms: (G,) those of MuJoCo.
        lights: (L,) those of MuJoCo.
        view: the camera.
        key: scenes of the same key have the same instances, and the same kinds of lights and cameras.
    """

    def __init__(self, renderer: Renderer, row: int, column: int, chain: int) -> None:
        self.row, self.column, self.chain = row, column, chain
        artist, geoms, lights, view = renderer.shown_scene()
        self.artist: Artist = artist
        # a copy of their memory is faster than one field by field
        self.geoms: NDArray[np.void] = np.frombuffer(geoms.tobytes(), geoms.dtype)
        self.lights: NDArray[np.void] = np.frombuffer(lights.tobytes(), lights.dtype)
        self.view: View = view
        self.key = looks_of(geoms), kinds_of_lights(lights[None])[0].tobytes(), view.far, view.parallel


def _groups(seen: list[_SceneCopy]) -> list[list[_SceneCopy]]:
    """Scenes of the same key, in their order."""
    groups: dict[object, list[_SceneCopy]] = {}
    for one in seen:
        groups.setdefault(one.key, []).append(one)
    return list(groups.values())
