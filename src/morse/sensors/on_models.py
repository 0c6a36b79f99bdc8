"""Sensors of scenes at any model of MuJoCo, as functions of its states.

::

    sensors = morse.sensors_on(model, seed=1)
    scan = sensors.lidar("VLP16", at="roof")
    ranges = scan(data).ranges
"""

from __future__ import annotations

import hashlib
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.declarations import properties
from morse.core.realism import Noise
from morse.core.reports.quoting import nearest, shown
from morse.core.validation.fields import checked_value
from morse.eyes.frames import GEOM, Frame, bodies_of_geoms
from morse.eyes.rays import Rays
from morse.eyes.renderer import Renderer, check_model
from morse.helpers.fans import fan
from morse.mathutils.portable import matmul
from morse.scene.component import NoiseModel
from morse.sensors.depth_camera import AbstractDepthCamera, noisy_depths
from morse.sensors.event_pixels import MOST_EVENTS, EventPixels, by_time, log_light, noise_events, thresholds
from morse.sensors.imu import IMU, InertialErrors, terms_of
from morse.sensors.laserscanner import LaserScanner, echoes
from morse.sensors.thermal_camera import COLDEST, HOTTEST

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray


class Scan(NamedTuple):
    """A scan; rays are ordered as by `LaserScanner`.

    Attributes:
        ranges: (N,) m; ``laser_range`` for no hit.
        points: (N, 3) m, in the frame of the scanner; 0 for no hit.
        geoms: (N,) number of the geom, -1 for no hit.
    """

    ranges: NDArray[np.float64]
    points: NDArray[np.float64]
    geoms: NDArray[np.int32]


class Inertia(NamedTuple):
    """A measurement of an IMU, in its own axes.

    Attributes:
        angular_velocity: (3,) rad/s.
        linear_acceleration: (3,) specific force, m/s^2: +9.81 along Z at rest.
    """

    angular_velocity: NDArray[np.float64]
    linear_acceleration: NDArray[np.float64]


class ModelSensors:
    """Makes sensors of a model of MuJoCo: functions that take a state after `mujoco.mj_forward` and return data.

    Sensors are at a site, a body, a camera or a geom: ``at="roof"``, or ``at="camera:roof"`` if several types of
    objects have the name. Errors depend on the seed, on the kind of the sensor, and on where it is; two sensors of a
    kind at the same place have other errors.

    Args:
        model: `mujoco.MjModel`; it is not changed afterwards.
        seed: of all errors.
    """

    def __init__(self, model: Any, *, seed: int = 0) -> None:
        check_model(model)
        self._model, self._seed = model, seed
        self._drawn: dict[str, int] = {}

    def lidar(
        self, kind: str = "LaserScanner", *, at: str, noise: float = 0.0, dropout: float = 0.0, **values: object
    ) -> Callable[[Any], Scan]:
        """Return a laser scanner, whose rays pass through its own kinematic tree, as through the robot in scenes.

        Args:
            kind: a scanner of scene scripts: ``VLP16``, ``Hokuyo``, ``Sick``, ...; see `LaserScanner`.
            at: its frame: X forward, Z up.
            noise: standard deviation of the distances, m.
            dropout: share of the rays whose echo is lost.
            values: other properties, such as ``laser_range`` or ``resolution``.

        Raises:
            ValueError: a name or a value is wrong.
        """
        own = _properties(LaserScanner, kind, values)
        limit = float(own["laser_range"])
        ways = fan(*(own[name] for name in ("scan_window", "resolution", "layers", "layer_separation", "layer_offset")))
        frame, rays = Frame(self._model, at), Rays(self._model, whole_trees=True)
        errors = Noise(NoiseModel(gaussian=noise, dropout=dropout), self._random(f"lidar/{at}"))

        def scan(data: Any) -> Scan:
            position, rotation = frame.pose(data)
            ahead, left_out = matmul(ways, rotation.T), frame.root or -1
            hits = rays.cast(data, position, ahead, limit, bodyexclude=left_out, normals=False)
            has_hit = hits.geoms >= 0
            ranges = np.where(has_hit, hits.distances, limit)
            if noise or dropout:
                ranges = echoes(ranges, has_hit, errors, limit)
                has_hit = ranges < limit
            points = ways * np.where(has_hit, ranges, 0.0)[:, None]
            return Scan(ranges, points, np.where(has_hit, hits.geoms, -1).astype(np.int32))

        return scan

    def depth(
        self,
        camera: str,
        height: int = 240,
        width: int = 320,
        *,
        noise: float = 0.0,
        near: float | None = None,
        far: float | None = None,
    ) -> Callable[[Any], NDArray[np.float32]]:
        """Return a depth camera: (H, W) float32, m along the axis; 0 for pixels without a surface.

        Args:
            camera: name of a camera of the model.
            height, width: pixels.
            noise: standard deviation of the depth at 1 m, in m; it grows with the square of the depth.
            near, far: m; by default the clipping planes of the model.

        Raises:
            ValueError: a name or a value is wrong.
        """
        spread: Any = checked_value("the depth camera", properties(AbstractDepthCamera)["depth_noise"], noise)
        planes = self._model.vis.map
        extent = float(self._model.stat.extent)
        first = float(planes.znear) * extent if near is None else float(near)
        last = float(planes.zfar) * extent if far is None else float(far)
        if not 0.0 < first < last:
            raise ValueError(f"A depth camera measures from near to far, 0 < near < far; got {first:g} and {last:g} m.")
        Frame(self._model, f"camera:{camera}")  # that it exists
        renderer, random = Renderer(self._model, height, width), self._random(f"depth/{camera}")
        renderer.show("depth")

        def measure(data: Any) -> NDArray[np.float32]:
            renderer.update_scene(data, camera)
            depth = renderer.render()
            seen = np.where((depth >= first) & (depth < np.float32(last)), depth, np.float32(0.0))
            return noisy_depths(seen, random, spread, first, last) if spread else seen

        return measure

    def imu(self, kind: str = "IMU", *, at: str, **values: object) -> Callable[[Any], Inertia]:
        """Return an IMU with the errors of IEEE Std 952-1997: white noise, bias instability, random walk of the bias.

        Time is that of the states: they come in its order.

        Args:
            kind: an IMU of scene scripts: ``IMU`` without errors, ``BMI088``, ``ADIS16448``, ``VN100``.
            at: its frame.
            values: other properties, such as ``GyroNoiseDensity``.

        Raises:
            ValueError: a name or a value is wrong.
        """
        own = _properties(IMU, kind, values)
        frame = Frame(self._model, at)
        gyro, accelerometer = terms_of(own)
        turning = InertialErrors(self._random(f"imu/{at}/gyro"), gyro)
        feeling = InertialErrors(self._random(f"imu/{at}/accelerometer"), accelerometer)
        last: list[float] = []

        def measure(data: Any) -> Inertia:
            angular, force = frame.felt(data)
            now = float(data.time)
            dt = now - last[0] if last else float(self._model.opt.timestep)
            last[:] = [now]
            return Inertia(np.array(turning.added(angular.tolist(), dt)), np.array(feeling.added(force.tolist(), dt)))

        return measure

    def thermal(
        self,
        camera: str,
        temperatures: Mapping[str, float],
        height: int = 240,
        width: int = 320,
        *,
        ambient: float = 15.0,
        sky: float | None = None,
    ) -> Callable[[Any], NDArray[np.float32]]:
        """Return a thermal camera: (H, W) float32, °C of the surface in each pixel; surfaces are black bodies.

        Args:
            camera: name of a camera of the model.
            temperatures: of bodies by name, °C; the bodies on them have it, too, unless they have their own.
            height, width: pixels.
            ambient: of all other surfaces, °C.
            sky: without a surface, °C; None for that of the other surfaces.

        Raises:
            ValueError: a name is wrong.
        """
        Frame(self._model, f"camera:{camera}")  # that it exists
        bodies, names, parents = bodies_of_geoms(self._model)
        unknown = next((name for name in temperatures if name not in names), None)
        if unknown is not None:
            raise ValueError(f"The model has no body {shown(unknown)}{nearest(unknown, names)}")
        for name, value in {"ambient": ambient, "sky": sky, **temperatures}.items():
            if not (value is None and name == "sky") and not _is_number(value):
                raise ValueError(f"The temperature {name!r} is a number of degrees Celsius, got {value!r}")
        of_bodies = np.full(len(parents), float(ambient))
        for body, parent in enumerate(parents):
            of_bodies[body] = of_bodies[parent]  # parents come first
            for name, value in temperatures.items():
                if names[name] == body:
                    of_bodies[body] = value
        table = np.clip(np.append(of_bodies[bodies], ambient), COLDEST, HOTTEST).astype(np.float32)
        nothing = np.float32(ambient if sky is None else sky)
        renderer = Renderer(self._model, height, width)
        renderer.show("ids")

        def measure(data: Any) -> NDArray[np.float32]:
            renderer.update_scene(data, camera)
            ids = renderer.render()
            numbers = np.where(ids[..., 1] == GEOM, ids[..., 0], len(table) - 1)
            return np.where(ids[..., 0] < 0, nothing, table[numbers])

        return measure

    def events(
        self,
        camera: str,
        height: int = 240,
        width: int = 320,
        *,
        threshold: float = 0.2,
        threshold_deviation: float = 0.0,
        refractory_period: float = 0.0,
        noise_rate: float = 0.0,
        look: str = "classic",
    ) -> Callable[[Any], NDArray[np.float64]]:
        """Return an event camera: (n, 4) column, row, time (s) and polarity (1: brighter, -1: darker), by time.

        Events are between the last state and this one; after the first state there are none, nor after a state that is
        not later than the last one. The model is that of ESIM (H. Rebecq, D. Gehrig, D. Scaramuzza, CoRL 2018).

        Args:
            camera: name of a camera of the model.
            height, width: pixels.
            threshold: C, change of the logarithm of the light of an event.
            threshold_deviation: deviation of C among pixels.
            refractory_period: s, for which a pixel is blind after an event.
            noise_rate: events of a pixel without a reason, Hz.
            look: of the pictures, see `Renderer`.

        Raises:
            ValueError: a name or a value is wrong.
        """
        most = {"threshold": (0.01, 5.0), "threshold_deviation": (0.0, 1.0)}
        most |= {"refractory_period": (0.0, 1.0), "noise_rate": (0.0, 1e3)}
        given = {"threshold": threshold, "threshold_deviation": threshold_deviation}
        given |= {"refractory_period": refractory_period, "noise_rate": noise_rate}
        for name, value in given.items():
            low, high = most[name]
            if not _is_number(value) or not low <= value <= high:
                raise ValueError(f"The {name} of an event camera is from {low:g} to {high:g}, got {value!r}")
        Frame(self._model, f"camera:{camera}")  # that it exists
        renderer, random = Renderer(self._model, height, width, look=look), self._random(f"events/{camera}")
        limits = thresholds((height, width), threshold, threshold_deviation, random if threshold_deviation else None)
        last: list[tuple[EventPixels, float]] = []

        def measure(data: Any) -> NDArray[np.float64]:
            renderer.update_scene(data, camera)
            now, end = log_light(renderer.render()), float(data.time)
            if not last or not end > last[0][1]:
                last[:] = [(EventPixels.at_rest(now), end)]
                return np.zeros((0, 4))
            pixels, begin = last[0]
            events = pixels.events(now, limits, refractory_period, begin, end)
            if noise_rate:
                events = np.concatenate([events, noise_events(random, noise_rate, now.shape, begin, end)])
            last[:] = [(pixels, end)]
            return by_time(events)[:MOST_EVENTS]

        return measure

    def _random(self, name: str) -> np.random.Generator:
        """A generator of its own for each sensor."""
        count = self._drawn[name] = self._drawn.get(name, 0) + 1
        digest = hashlib.sha256(f"{self._seed}/{name}/{count}".encode("utf-8", "surrogatepass")).digest()
        return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))


def sensors_on(model: Any, *, seed: int = 0) -> ModelSensors:
    """Return what makes sensors of a model of MuJoCo; see `ModelSensors`."""
    return ModelSensors(model, seed=seed)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _properties(cls: type[LaserScanner | IMU], kind: str, values: Mapping[str, object]) -> dict[str, Any]:
    """All properties of a kind of sensor: declared, of the product, and given."""
    products = {product.name or "": product.properties for product in cls._products}
    if kind != cls.__name__ and kind not in products:
        known = nearest(kind, [cls.__name__, *products])
        raise ValueError(f"There is no {cls._name.lower()} {shown(kind)}{known}")
    declared = {prop.name: prop for prop in properties(cls).values()}
    own = {name: prop.default for name, prop in declared.items()}
    for name, value in {**products.get(kind, {}), **values}.items():
        if name not in declared:
            raise ValueError(f"{kind} has no property {shown(name)}{nearest(name, sorted(declared))}")
        own[name] = checked_value(kind, declared[name], value)
    return own
