"""The base class of cameras."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.core.exceptions import MorseBuilderError, MorseRPCTypeError
from morse.core.modifier import AbstractModifier
from morse.core.rows.marks import is_overridden, known_data
from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible, service
from morse.core.status import SUCCESS
from morse.core.validation.arguments import Range
from morse.helpers.components import add_property, add_state
from morse.sensors.delayed_pictures import DelayedPictures, Exposure

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.object import Object
    from morse.core.realism import Realism
    from morse.core.robot import Robot
    from morse.core.sensor import Pose, WatchedSpace
    from morse.core.values import Fields, Options
    from morse.core.world import Body
    from morse.rendering import CameraRequest, Lens, Picture
    from morse.scene.component import RealismModel

#: properties that determine the lens
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
#: methods whose override determines what an image depends on
_OF_AN_IMAGE = {"take", "measure", "develop", "default_action", "action", "sensor_setup"}
#: declaration of the field ``intrinsic_matrix``
INTRINSIC: Fields = {
    "default_value": [[0.0] * 3] * 3,
    "type": "mat3<float>",
    "doc": "Focal lengths and principal point, px; the centre of the first pixel is at 0",
    "unit": "px",
    "frame": "optical",
    "shape": (3, 3),
}
#: slots of the kind ``camera_info``
CAMERA_INFO: Fields = {
    "topic": "camera_info",
    "width": lambda camera: camera.image_width,
    "height": lambda camera: camera.image_height,
    "k": "intrinsic_matrix",
    "d": lambda camera: list(getattr(camera.lens, "coefficients", (0.0,) * 5)),
    "model": lambda camera: camera.lens_model,
    "p": lambda camera: camera.projection(),
}
#: maximum number of images of `StereoUnit.capture` and similar services
Pictures = Annotated[int, Range(low=-1e9, high=1e9)]


class PictureModifier(AbstractModifier):
    """Changes the pictures of a camera before the camera makes its data of them.

    Attributes:
        uses: the fields of `morse.rendering.Picture` that `modify_picture` uses, besides those of the camera.
    """

    uses: tuple[str, ...] = ("depth",)
    component_instance: Camera
    not_state = (*AbstractModifier.not_state, "uses")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self.use(*self.uses)

    def use(self, *fields: str) -> None:
        """Let the pictures contain fields, such as ``normals``, from the next one on."""
        self.uses = tuple(dict.fromkeys((*self.uses, *fields)))
        if "normals" in self.uses:
            self.component_instance.request.normals = True

    def modify(self) -> None:
        """Do nothing: the data follow from the picture."""

    @abstractmethod
    def modify_picture(self, picture: Picture, time: float) -> Picture:
        """Return the changed picture, of the same size.

        Args:
            picture: its arrays must not be changed; `picture._replace` makes another picture.
            time: simulated time of the exposure, s.
        """


class Camera(Sensor):
    """A pinhole camera that looks along its Z axis: X right, Y down.

    Subclasses fill ``local_data`` in `take`, which is called with each image.

    Attributes:
        image_width, image_height: pixels.
        capturing: whether it captures images at present.
        color: whether its images contain colours, not only depth.
        normals: whether its images contain normals.
        uses: the fields of `morse.rendering.Picture` that `take` uses, if `take` only depends on the image, ``noted``
            and the camera. Images with a delay are then rendered while the simulation continues. None if `take` reads
            the world. A subclass that overrides `take` has to set ``uses`` again.
        noted: the result of `note` at the tick of the image that is passed to `take`.
    """

    _builder = BuilderDefaults(
        frequency=20.0,
        properties={"cam_focal": 35.0},
        model="camera",
        part="CameraMesh",
    )

    add_property("image_width", 256, "cam_width", "integer", "Width of the image", unit="px", low=1, high=8192)
    add_property("image_height", 256, "cam_height", "integer", "Height of the image", unit="px", low=1, high=8192)
    add_property("image_focal", 25.0, "cam_focal", "float", "Focal length in mm, for a sensor width of 32 mm", low=1e-3)
    add_property(
        "image_fov",
        None,
        "cam_fov",
        "float",
        "Horizontal angle of view; replaces the focal length",
        unit="deg",
        low=1e-3,
        high=360.0,
        allow=("none",),
    )
    add_property("near_clipping", 0.1, "cam_near", "float", "Near clipping distance", unit="m", low=1e-6, high=1e6)
    add_property("far_clipping", 100.0, "cam_far", "float", "Far clipping distance", unit="m", low=1e-6, high=1e6)
    add_property("vertical_flip", True, "Vertical_Flip", "bool", "The first row of the image is the top row")
    add_property("retrieve_depth", False, "retrieve_depth", "bool", "Depth is measured; exists for old scripts")
    add_property("retrieve_zbuffer", False, "retrieve_zbuffer", "bool", "Z is measured; exists for old scripts")
    add_property(
        "lens_model",
        "plumb_bob",
        "lens_model",
        "string",
        "Model of the distortion",
        choices=("plumb_bob", "equidistant"),
    )
    add_property(
        "distortion",
        "",
        "distortion",
        "string",
        "Coefficients k1, k2, p1, p2, k3; of the fisheye lens 'equidistant' k1, k2, k3, k4",
    )
    add_property(
        "screen_space_error",
        0.0,
        "screen_space_error",
        "float",
        "Bound of the error of simplified meshes in the image; 0 for full detail",
        unit="px",
        low=0.0,
        high=1e3,
    )
    is_camera = True
    add_property("on_demand", False, "on_demand", "bool", "Images are only taken while somebody reads them")
    add_property("capturing", True, "capturing", "bool", "Take pictures")

    add_state("_left", int, "Number of remaining images; negative for no limit")
    add_state("_made_of", tuple, "Properties of the lens of the last image")
    add_state("_taken", int, "Tick of the last image")

    color = True
    normals = False
    uses: ClassVar[tuple[str, ...] | None] = None
    noted: Any = None
    _taken_from: Pose | None = None

    image_width: int
    image_height: int
    image_focal: float
    image_fov: float | None
    near_clipping: float
    far_clipping: float
    lens_model: str
    distortion: str
    screen_space_error: float
    vertical_flip: bool
    capturing: bool
    on_demand: bool

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        if "uses" not in vars(cls) and not _OF_AN_IMAGE.isdisjoint(vars(cls)):
            cls.uses = None

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        # imported on demand, because only scenes with cameras need it
        from morse.rendering import Renderer

        #: number of remaining images; negative for no limit
        self._left = -1
        #: tick of the last image
        self._taken = -1
        try:
            self.check_properties()
            self._look()
        except ValueError as error:
            raise MorseBuilderError(str(error)) from None
        renderer = self.context.server(Renderer)
        renderer.employ(self.context.image_workers)
        self.request: CameraRequest = renderer.request(
            obj, self.lens, color=self.color, normals=self.normals, wanted=self._wants
        )
        self.add_request(self.request)
        if self.context.scene.settings.fastmode and self.capturing:
            self.capturing = False
            text = f"{self.name()} captures no images: the environment is in fastmode"
            self.context.complaints.warn(text, text)

    def check_properties(self) -> None:
        """Raise `ValueError` if the values of the properties do not fit together; the lens is checked separately."""

    def _look(self) -> None:
        """Create the lens from the properties.

        Raises:
            ValueError: the properties are not valid for a lens.
        """
        self._made_of = self._lens_of = self._lens_properties()
        self.lens = self._make_lens()
        data = known_data(self)
        if "intrinsic_matrix" in data:
            data["intrinsic_matrix"] = self.lens.matrix

    def _lens_properties(self) -> tuple[Any, ...]:
        return tuple(getattr(self, name) for name in _OF_LENS)

    def _make_lens(self) -> Lens:
        from morse.rendering.distortion import lens_of

        return lens_of(*self._lens_properties())

    def sensing_cost(self) -> float:
        """Return the number of pixels of an image."""
        return self.image_width * self.image_height

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        before = dict(self.__dict__)
        super().set_property(name, value)
        try:
            self.check_properties()
            lens = self._make_lens()
            if isinstance(self.realism, DelayedPictures):
                self.realism.check_memory(lens)
        except ValueError as error:
            self.__dict__.update(before)
            raise MorseRPCTypeError(f"{self.name()}: {error}") from None

    @interruptible
    @async_service
    def capture(self, n: Pictures) -> None:
        """Capture a number of images; the service ends when the last image has been captured.

        Args:
            n: number of images; a negative number for no limit.
        """
        self.start(int(n))

    def start(self, count: int) -> None:
        """Capture a number of images; a negative number stands for no limit."""
        self._left, self.capturing = count, True

    def interrupt(self) -> None:
        """End `capture`."""
        self._left, self.capturing = -1, False
        super().interrupt()

    def _wants(self) -> bool:
        # asked before each image
        self.request.screen_space_error = self.screen_space_error
        self.request.color = self.color or (self.watched and "image" not in known_data(self))
        return self.capturing and self._left != 0 and self.is_wanted()

    def is_wanted(self) -> bool:
        """Whether somebody reads the images, or they are taken anyway."""
        return self._left > 0 or super().is_wanted()

    def rests(self) -> bool:
        """Whether no image is due, and no method of a subclass is called."""
        cls = type(self)
        return super().rests() or (
            self._left != 0
            and not (self.capturing and self.is_wanted())
            and self.realism is None
            and not (self.output_functions or self.output_modifiers or self._reports or is_overridden(self))
            and cls.measure is Camera.measure
            and cls.default_action is Sensor.default_action
            and cls.action is Sensor.action
        )

    def watched_space(self) -> WatchedSpace | None:
        """Return None, because the field of view is not a cone around the X axis."""
        return None

    def look_again(self) -> None:
        """Take another image in the same tick."""
        self._taken = -1

    def measure(self) -> None:
        """Capture an image, if one is due."""
        exposure = self.expose()
        if exposure is not None:
            self.develop(exposure)

    def expose(self) -> Exposure | None:
        """Return the image of the present tick, which may still be rendered; None if no image is due."""
        if not self._is_due():
            return None
        request = self.request
        if request.shot is None:
            request.server.serve([request])
        shot, request.shot = request.shot, None
        if shot is None:
            return None
        self._taken = self.clock.tick
        if self._left > 0:
            self._left -= 1
        exposure = Exposure(self.clock.time, shot, self.note(), _plain(self.bge_object.world_pose()))
        self.exposed()
        return exposure

    def _is_due(self) -> bool:
        if self._left == 0:
            # all requested images were captured
            if not self.under_way:
                self._left, self.capturing = -1, False
                if self.on_completion is not None and self.running_service == "capture":
                    self.completed(SUCCESS)
            return False
        if not self.capturing or not self.is_wanted():
            return False
        if self.has_other_lens():
            self.drop_under_way()
            self._made_of, self._taken = self._lens_properties(), -1
        self._follow_properties()
        return self._taken != self.clock.tick

    def _follow_properties(self) -> None:
        """Create the lens again if its properties have changed, or were restored."""
        if self._lens_of != self._lens_properties():
            self._look()
            self.request.lens, self.request.shot = self.lens, None

    def develop(self, exposure: Exposure) -> None:
        """Fill ``local_data`` from an image, and end `capture` with its last image."""
        self._follow_properties()
        self.noted, self._taken_from = exposure.noted, exposure.pose
        picture = exposure.picture()
        for modifier in self.output_modifiers:
            if isinstance(modifier, PictureModifier):
                picture = modifier.modify_picture(picture, exposure.time)
        self.take(picture)
        if self._left == 0 and not self.under_way and self.on_completion is not None:
            self.completed(SUCCESS)

    def measured_from(self) -> Pose:
        """Return the pose at the tick of the last image."""
        return self._taken_from or super().measured_from()

    def take(self, picture: Picture) -> None:
        """Fill ``local_data`` from an image."""

    def shown(self) -> Mapping[str, object]:
        """The fields ``image``, ``timestamp`` and ``objects`` as the live view shows them."""
        return known_data(self)

    def note(self) -> object:
        """Return the data of the world for `take` at the tick of an image, as plain data; see ``noted``."""
        return None

    def exposed(self) -> None:
        """Called after each image, at its tick."""

    # -- delay -----------------------------------------------------------------------------

    def make_realism(self, model: RealismModel) -> Realism:
        """Return the delay and the noise; with a delay, images are rendered while the simulation continues."""
        if model.delay and self.uses is not None:
            return DelayedPictures(self, model)
        return super().make_realism(model)

    @property
    def under_way(self) -> Sequence[Exposure]:
        """The images whose delay has not passed."""
        return self.realism.exposures if isinstance(self.realism, DelayedPictures) else ()

    def projection(self) -> list[list[float]] | None:
        """Return the matrix (3, 4) that projects points in the frame of the left camera of a pair, px.

        As in ``sensor_msgs/CameraInfo``: the last column of the right camera is -fx * baseline. None for a camera that
        is not the right one of a `StereoUnit`.
        """
        unit: Any = self.context.component(self.name().rpartition(".")[0])
        baseline = unit.baseline_of(self) if hasattr(unit, "baseline_of") else 0.0
        if not baseline:
            return None
        matrix = [[float(number) for number in row] for row in self.lens.matrix]
        return [[*row, -row[0] * baseline if index == 0 else 0.0] for index, row in enumerate(matrix)]

    def has_other_lens(self) -> bool:
        """Whether properties of the lens have changed since the last image."""
        return self._made_of != self._lens_properties()

    def drop_under_way(self) -> None:
        """Discard the images that were taken with another lens; `capture` takes other images instead."""
        if isinstance(self.realism, DelayedPictures):
            count = self.realism.drop()
            if self._left >= 0:
                self._left += count

    def ordered(self, rows: np.ndarray) -> np.ndarray:
        """Return the rows of an image, whose top row is first, in the order given by ``Vertical_Flip``."""
        return rows if self.vertical_flip else np.ascontiguousarray(rows[::-1])

    def top_first(self, rows: np.ndarray) -> np.ndarray:
        """Convert rows in the order of ``Vertical_Flip`` to rows with the top row first."""
        return np.asarray(rows) if self.vertical_flip else np.ascontiguousarray(np.asarray(rows)[::-1])


def _plain(pose: tuple[Sequence[float], Sequence[float]]) -> Pose:
    position, rotation = pose
    return tuple(map(float, position)), tuple(map(float, rotation))
