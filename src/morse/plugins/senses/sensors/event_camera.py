"""An event camera."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.helpers.components import add_data, add_kind, add_property, add_state, prop
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera
from morse.sensors.event_pixels import MOST_EVENTS, EventPixels, by_time, log_light, noise_events, thresholds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.rendering import Picture
    from morse.sensors.delayed_pictures import Exposure


def aer(events: NDArray[np.float64]) -> NDArray[np.uint32]:
    """Return events (n, 4) as pairs (n, 2) of address and time in µs, the address-event representation of a DAVIS.

    Bits 22 to 30 of an address are the row, 12 to 21 the column, bit 11 is the polarity (jAER's file format AEDAT 2.0).
    """
    rows = np.asarray(events, dtype=np.float64).reshape(-1, 4)
    address = rows[:, 1].astype(np.uint32) << 22 | rows[:, 0].astype(np.uint32) << 12
    address |= (rows[:, 3] > 0).astype(np.uint32) << 11
    return np.stack([address, np.rint(rows[:, 2] * 1e6).astype(np.uint32)], axis=1)


class EventCamera(Camera):
    """Reports the pixels whose brightness has changed: column, row, time, polarity.

    A pixel remembers the logarithm of its light. As soon as the logarithm differs from it by the ``threshold`` C, the
    pixel emits an event and remembers the new value: a change by Δ ln I gives Δ ln I / C events. The logarithm is
    linear in time between two images; a pixel is blind for ``refractory_period`` after an event. This is the model of
    ESIM (H. Rebecq, D. Gehrig, D. Scaramuzza, "ESIM: an open event camera simulator", CoRL 2018).

    With ``errors``, each pixel has a threshold of its own, and emits events without a reason at the rate
    ``noise_rate``. The light is that of an image of 256 codes: changes of less than about 1 % of a dark pixel are not
    seen.
    """

    _name = "Event camera"
    _short_desc = "A camera that reports changes of the brightness of pixels"
    _source = "ESIM, CoRL 2018"
    _builder = BuilderDefaults(
        frequency=100.0, properties={"cam_width": 320, "cam_height": 240, "cam_focal": 25.0}, model="camera",
        part="CameraMesh",
    )  # fmt: skip
    _products = (
        BuilderDefaults(
            "DAVIS346",
            frequency=200.0,
            model="camera",
            part="CameraMesh",
            properties={
                "cam_width": 346,
                "cam_height": 260,
                "threshold": 0.14,
                "threshold_deviation": 0.035,
                "noise_rate": 0.1,
                "refractory_period": 1e-4,
                "errors": True,
            },
            doc="An iniVation DAVIS346: 346 x 260 pixels, threshold 14.3 %, deviation 3.5 %.",
            source="specifications of iniVation: contrast sensitivity of the DAVIS346; noise: our choice",
        ),
    )

    add_data(
        "events",
        np.zeros((0, 4)),
        "buffer",
        "Column and row of the pixel from the upper left corner, time (s), polarity (1: brighter, -1: darker), by time",
        shape=(None, 4),
        dtype="float64",
    )
    add_data("lost", 0, "integer", "Number of events of this measurement that were too many", low=0)
    add_data("intrinsic_matrix", **INTRINSIC)

    add_property("threshold", 0.2, "threshold", "float", "C, change of the logarithm of the light", low=0.01, high=5.0)
    add_property(
        "threshold_deviation", 0.03, "threshold_deviation", "float", "Deviation of C among pixels", low=0.0, high=1.0
    )
    add_property(
        "refractory_period", 0.0, "refractory_period", "float", "Time without events after an event", unit="s",
        low=0.0, high=1.0,
    )  # fmt: skip
    add_property(
        "noise_rate", 0.1, "noise_rate", "float", "Events of a pixel without a reason", unit="Hz", low=0.0, high=1e3
    )
    add_property("errors", False, "errors", "bool", "Thresholds differ, and there is noise")

    add_kind("events", events="events", width=prop("image_width"), height=prop("image_height"))
    add_kind("camera_info", **CAMERA_INFO)

    add_state("_memory", np.ndarray, "Logarithm of the light that each pixel remembers")
    add_state("_last", np.ndarray, "Logarithm of the light in the last image")
    add_state("_fired", np.ndarray, "Time of the last event of each pixel", unit="s")
    add_state("_time", float, "Time of the last image", unit="s")

    uses = ("rgb",)
    image_width: int
    image_height: int
    threshold: float
    threshold_deviation: float
    refractory_period: float
    noise_rate: float
    errors: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._memory = self._last = np.zeros((0, 0), np.float32)
        self._fired = np.zeros((0, 0))
        self._time = self._exposed = 0.0
        self._limits: tuple[object, NDArray[np.float32]] = (None, self._last)

    def develop(self, exposure: Exposure) -> None:
        """Take note of the time of the image, which may be developed later."""
        self._exposed = exposure.time
        super().develop(exposure)

    def take(self, picture: Picture) -> None:
        """Compare the image with what the pixels remember."""
        assert picture.rgba is not None
        now, end = log_light(picture.rgba), self._exposed
        if self._last.shape != now.shape or end <= self._time:
            rest = EventPixels.at_rest(now)
            self._memory, self._last, self._fired = rest.memory, rest.last, rest.fired
            self.local_data["events"], self.local_data["lost"] = np.zeros((0, 4)), 0
            self._time = end
            return
        events = self._events(now, self._time, end)
        self._last, self._time = now, end
        self.local_data["lost"] = max(len(events) - MOST_EVENTS, 0)
        self.local_data["events"] = events[:MOST_EVENTS]

    def _threshold(self, shape: tuple[int, ...]) -> NDArray[np.float32]:
        key = (shape, self.threshold, self.threshold_deviation, self.errors)
        if self._limits[0] != key:
            random = self.context.random(f"{self.name()}/thresholds") if self.errors else None
            self._limits = key, thresholds(shape, self.threshold, self.threshold_deviation, random)
        return self._limits[1]

    def _events(self, now: NDArray[np.float32], begin: float, end: float) -> NDArray[np.float64]:
        """Return the events (n, 4) between two images, and change what the pixels remember."""
        pixels = EventPixels(self._memory, self._last, self._fired)
        events = pixels.events(now, self._threshold(now.shape), self.refractory_period, begin, end)
        if self.errors and self.noise_rate > 0.0:
            events = np.concatenate(
                [events, noise_events(self.tick_random("noise"), self.noise_rate, now.shape, begin, end)]
            )
        return by_time(events)

    def shown(self) -> dict[str, object]:
        """The events since the last image as a picture: red is brighter, blue is darker."""
        image = np.full((self.image_height, self.image_width, 3), 235, np.uint8)
        events = np.asarray(self.local_data["events"], dtype=np.float64)
        columns, rows = events[:, 0].astype(np.int64), events[:, 1].astype(np.int64)
        inside = (columns < self.image_width) & (rows < self.image_height)
        image[rows[inside], columns[inside]] = np.where(events[inside, 3:] > 0, (210, 40, 40), (40, 60, 200))
        return {"image": image, "timestamp": self.local_data["timestamp"]}

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()
