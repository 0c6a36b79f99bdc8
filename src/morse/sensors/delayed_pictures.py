"""Images that are rendered while the simulation continues, until the delay of their camera has passed."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, TypedDict, cast

import numpy as np

from morse.core.exceptions import MorseBuilderError
from morse.core.realism import Realism, RealismState, copied
from morse.core.state import StateError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.sensor import Pose
    from morse.core.values import Fields
    from morse.rendering import Lens, Picture
    from morse.rendering.picture import Shot
    from morse.scene.component import RealismModel
    from morse.sensors.camera import Camera

#: types of the arrays of an image, and numbers of their axes
_ARRAYS = {
    "rgba": (np.uint8, 3),
    "depth": (np.float32, 2),
    "ids": (np.int32, 2),
    "normals": (np.float32, 3),
    "models": (np.float32, 2),
    "eye": (np.float32, 1),
    "axes": (np.float32, 2),
}


#: limit of the memory of all images of a camera that wait for their delay, bytes
_MOST_BYTES = 2 << 30


def _stored(uses: Sequence[str]) -> list[str]:
    """The stored fields of an image that contain the used ones."""
    return list(dict.fromkeys("rgba" if name == "rgb" else name for name in uses))


class _ExposureState(TypedDict):
    time: float
    noted: object
    pose: list[list[float]] | None
    is_metered: bool
    picture: Fields


class _State(RealismState):
    exposures: list[_ExposureState]


class Exposure:
    """An image of a tick, which may still be rendered.

    Attributes:
        time: simulated time of the image, s.
        noted: data of the world for `Camera.take` at this time.
        pose: position (3,) in m and rotation (9,), row by row, of the camera in the world at this time; or None.
        is_metered: whether an automatic exposure has been adjusted by this image.
    """

    def __init__(
        self, time: float, shot: Shot, noted: object = None, pose: Pose | None = None, *, is_metered: bool = False
    ) -> None:
        self.time, self.noted, self.pose, self.is_metered = time, noted, pose, is_metered
        self._shot = shot

    def picture(self) -> Picture:
        """Return the image, and wait until it is complete."""
        return self._shot.picture()

    def get_state(self, uses: Sequence[str]) -> _ExposureState:
        """Return the complete image, with some of its fields, as plain data."""
        picture = self.picture()
        return {
            "time": self.time,
            "noted": copied(self.noted),
            "pose": None if self.pose is None else [list(self.pose[0]), list(self.pose[1])],
            "is_metered": self.is_metered,
            "picture": {name: copied(getattr(picture, name)) for name in _stored(uses)},
        }

    @classmethod
    def from_state(cls, state: _ExposureState, uses: Sequence[str]) -> Exposure:
        """Restore an image with some of its fields.

        Raises:
            StateError: the state is not that of an image.
        """
        from morse.rendering import Picture
        from morse.rendering.picture import Finished

        if set(state["picture"]) != set(_stored(uses)):
            raise StateError("the saved state is damaged: an image lacks fields")
        fields: Fields = {"rgba": None, "normals": None, "nodes": [], "names": []}
        for name, (kind, axes) in _ARRAYS.items():
            values = state["picture"].get(name)
            if values is None:
                fields.setdefault(name, np.zeros((0,) * axes, kind))
                continue
            if not isinstance(values, np.ndarray) or values.dtype != kind or values.ndim != axes:
                raise StateError(f"the saved state is damaged: '{name}' of an image has another type or shape")
            fields[name] = values.copy()
        fields["names"] = [str(name) for name in state["picture"].get("names", [])]
        pose = None if state["pose"] is None else (tuple(state["pose"][0]), tuple(state["pose"][1]))
        if pose is not None and ([len(part) for part in pose] != [3, 9] or not np.isfinite(np.hstack(pose)).all()):
            raise StateError("the saved state is damaged: the pose of an image is 3 and 9 numbers")
        shot = Finished(Picture(**fields))
        return cls(float(state["time"]), shot, state["noted"], pose, is_metered=bool(state["is_metered"]))


class DelayedPictures(Realism):
    """Delay and noise of a camera.

    An image is rendered in a thread from the poses of its tick. When its delay has passed, the simulation waits until
    the image is complete, and publishes it. The data of the camera therefore do not depend on the speed of the thread.

    Attributes:
        exposures: the images whose delay has not passed, in the order of their ticks.
    """

    def __init__(self, camera: Camera, model: RealismModel) -> None:
        super().__init__(camera, model)
        self._camera = camera
        try:
            self.check_memory(camera.lens)
        except ValueError as error:
            raise MorseBuilderError(str(error)) from None
        camera.request.beside = True
        self._truth = {name: copied(camera.local_data[name]) for name in self._noises}
        self.exposures: deque[Exposure] = deque()

    def check_memory(self, lens: Lens) -> None:
        """Raise `ValueError` if the images of a lens that wait for their delay need too much memory."""
        count = self.delay * min(self._camera.frequency, self._camera.clock.frequency)
        pixel = 8 + 4 * self._camera.color + 12 * self._camera.normals
        size = count * lens.width * lens.height * pixel
        if size > _MOST_BYTES:
            raise ValueError(
                f"with a delay of {self.delay:g} s, {count:.0f} images of {lens.width} x {lens.height} pixels wait "
                f"at the same time: they need {size / 2**30:.1f} GiB of memory, and the limit is "
                f"{_MOST_BYTES >> 30} GiB; shorten the delay, or reduce the size or the frequency"
            )

    @property
    def _uses(self) -> Sequence[str]:
        """The fields of a picture that the camera and the modifiers of its pictures use."""
        assert self._camera.uses is not None
        own: list[str] = [name for one in self._camera.output_modifiers for name in getattr(one, "uses", ())]
        return list(dict.fromkeys((*self._camera.uses, *own)))

    def act(self) -> None:
        """Begin an image, if one is due."""
        camera = self._camera
        camera.position_3d.update(camera.bge_object)
        exposure = camera.expose()
        if exposure is not None:
            self.exposures.append(exposure)

    def release(self) -> None:
        """Publish the images whose delay has passed; called every tick."""
        camera = self._camera
        now = camera.clock.time + 1e-9
        while self.exposures and self.exposures[0].time + self.delay <= now:
            if camera.has_other_lens():
                # the next image has another size
                camera.drop_under_way()
                return
            exposure, data = self.exposures.popleft(), camera.local_data
            measurement = {name: data[name] for name in self._noises}
            data.update(self._truth)
            data["timestamp"] = exposure.time
            camera.develop(exposure)
            self._truth = {name: copied(data[name]) for name in self._noises}
            if not self._change(measurement, exposure.time):
                return
            self._publish()

    def drop(self) -> int:
        """Discard all images that were not published; return their number."""
        count = len(self.exposures)
        self.exposures.clear()
        return count

    def get_state(self) -> _State:
        """Return the state, with all unfinished images, which are completed first."""
        return {**super().get_state(), "exposures": [exposure.get_state(self._uses) for exposure in self.exposures]}

    def set_state(self, state: RealismState) -> None:
        """Restore a state that `get_state` returned."""
        super().set_state(state)
        exposures = cast("_State", state)["exposures"]
        self.exposures = deque(Exposure.from_state(exposure, self._uses) for exposure in exposures)
