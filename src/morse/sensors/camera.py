"""What all cameras have in common."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np

from morse.core.exceptions import MorseRPCTypeError
from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible, service
from morse.core.status import SUCCESS
from morse.core.validation.arguments import Range
from morse.helpers.components import add_property

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.watched_space import WatchedSpace
    from morse.rendering import CameraRequest, Lens, Picture

logger = logging.getLogger(__name__)

#: properties that the lens is made of
_OF_LENS = (
    "image_width",
    "image_height",
    "image_focal",
    "image_fov",
    "near_clipping",
    "far_clipping",
    "lens_model",
    "distortion",
)
#: declaration of the field ``intrinsic_matrix``
INTRINSIC: dict[str, Any] = {
    "default_value": [[0.0] * 3] * 3,
    "type": "mat3<float>",
    "doc": "Focal lengths and the middle of the picture, px",
    "unit": "px",
    "frame": "optical",
    "shape": (3, 3),
}
#: slots of the kind ``camera_info``
CAMERA_INFO: dict[str, Any] = {
    "topic": "camera_info",
    "width": lambda camera: camera.image_width,
    "height": lambda camera: camera.image_height,
    "k": "intrinsic_matrix",
    "d": lambda camera: list(getattr(camera.lens, "coefficients", (0.0,) * 5)),
    "model": lambda camera: camera.lens_model,
}
#: of the pictures of `StereoUnit.capture` and of similar services
Pictures = Annotated[int, Range(low=-1e9, high=1e9)]


class Camera(Sensor):
    """A pinhole camera: X to the right, Y down, and it looks along Z.

    Subclasses fill ``local_data`` in `take`, which is called with each picture.

    Attributes:
        image_width, image_height: pixels.
        capturing: whether it takes pictures now.
        color: whether its pictures have colours, not only depth.
    """

    add_property("image_width", 256, "cam_width", "integer", "Width of the picture", unit="px", low=1, high=8192)
    add_property("image_height", 256, "cam_height", "integer", "Height of the picture", unit="px", low=1, high=8192)
    add_property("image_focal", 25.0, "cam_focal", "float", "Focal length in mm, of a sensor 32 mm wide", low=1e-3)
    add_property(
        "image_fov",
        None,
        "cam_fov",
        "float",
        "Angle of view from left to right; replaces the focal length",
        unit="deg",
        low=1e-3,
        high=360.0,
        allow=("none",),
    )
    add_property("near_clipping", 0.1, "cam_near", "float", "What is nearer is not seen", unit="m", low=1e-6, high=1e6)
    add_property("far_clipping", 100.0, "cam_far", "float", "What is farther is not seen", unit="m", low=1e-6, high=1e6)
    add_property("vertical_flip", True, "Vertical_Flip", "bool", "The first row of the picture is the top one")
    add_property("retrieve_depth", False, "retrieve_depth", "bool", "Depth is measured; kept for old scripts")
    add_property("retrieve_zbuffer", False, "retrieve_zbuffer", "bool", "Z is measured; kept for old scripts")
    add_property(
        "lens_model", "plumb_bob", "lens_model", "string", "Of the distortion", choices=("plumb_bob", "equidistant")
    )
    add_property(
        "distortion",
        "",
        "distortion",
        "string",
        "Coefficients k1, k2, p1, p2, k3; of the fisheye lens 'equidistant' k1, k2, k3, k4",
    )
    add_property("capturing", True, "capturing", "bool", "Take pictures")

    color = True
    not_state: ClassVar[tuple[str, ...]] = ("requests", "request", "lens")

    image_width: int
    image_height: int
    image_focal: float
    image_fov: float | None
    near_clipping: float
    far_clipping: float
    lens_model: str
    distortion: str
    vertical_flip: bool
    capturing: bool

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        # imported by scenes with cameras alone
        from morse.rendering import Renderer

        #: pictures still to be taken; negative for no end
        self._left = -1
        #: the tick of the last picture
        self._taken = -1
        self._look()
        renderer = self.context.server(Renderer)
        self.request: CameraRequest = renderer.request(obj, self.lens, color=self.color, wanted=self._wants)
        self.add_request(self.request)
        if self.context.scene.settings.fastmode and self.capturing:
            self.capturing = False
            logger.warning("%s takes no pictures: the environment is in fastmode", self.name())

    def _look(self) -> None:
        """Make the lens from the properties.

        Raises:
            ValueError: no lens has such properties.
        """
        self._made_of = self._lens_properties()
        self.lens = self._make_lens()
        if "intrinsic_matrix" in self.local_data:
            self.local_data["intrinsic_matrix"] = self.lens.matrix

    def _lens_properties(self) -> tuple[Any, ...]:
        return tuple(getattr(self, name) for name in _OF_LENS)

    def _make_lens(self) -> Lens:
        from morse.rendering.distortion import lens_of

        return lens_of(*self._lens_properties())

    @service
    def set_property(self, name: str, value: Any) -> None:
        """Change a property while the simulation runs."""
        before = dict(self.__dict__)
        super().set_property(name, value)
        try:
            self._make_lens()
        except ValueError as error:
            self.__dict__.update(before)
            raise MorseRPCTypeError(f"{self.name()}: {error}") from None

    @interruptible
    @async_service
    def capture(self, n: Pictures) -> None:
        """Take pictures, and then no more; ends when the last one is taken.

        Args:
            n: how many; a negative number for pictures without end.
        """
        self.start(int(n))

    def start(self, count: int) -> None:
        """Take that number of pictures; a negative number stands for pictures without end."""
        self._left, self.capturing = count, True

    def interrupt(self) -> None:
        """End `capture`: no more pictures."""
        self._left, self.capturing = -1, False
        super().interrupt()

    def _wants(self) -> bool:
        return self.capturing and self._left != 0

    def watched_space(self) -> WatchedSpace | None:
        """Nothing that is a cone about the X axis."""
        return None

    def measure(self) -> None:
        """Take a picture, if one is to be taken."""
        if self._left == 0:
            # all that were asked for were taken
            self._left, self.capturing = -1, False
            if self.on_completion is not None and self.running_service == "capture":
                self.completed(SUCCESS)
            return
        if not self.capturing:
            return
        if self._made_of != self._lens_properties():
            self._look()
            self.request.lens = self.lens
            self.request.picture, self._taken = None, -1
        if self._taken == self.clock.tick:
            return
        picture = self.request.picture
        if picture is None:
            self.request.server.serve([self.request])
            picture = self.request.picture
        if picture is None:
            return
        self.take(picture)
        self.request.picture, self._taken = None, self.clock.tick
        if self._left > 0:
            self._left -= 1
            if self._left == 0 and self.on_completion is not None:
                self.completed(SUCCESS)

    def take(self, picture: Picture) -> None:
        """Fill ``local_data`` from a picture."""

    def ordered(self, rows: NDArray[Any]) -> NDArray[Any]:
        """Rows of a picture, the top one first, in the order that ``Vertical_Flip`` says."""
        return rows if self.vertical_flip else np.ascontiguousarray(rows[::-1])

    def top_first(self, rows: Any) -> NDArray[Any]:
        """The same backwards."""
        return np.asarray(rows) if self.vertical_flip else np.ascontiguousarray(np.asarray(rows)[::-1])
