"""What pictures of recipes show besides the world: paths of robots, rays, images of cameras, curves."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageDraw

from morse.core.observer import Observer

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

_SENSOR, _FOCAL = 32.0, 28.0  # mm
#: ticks between two points of a path; longer steps are places that a robot was set to, m
_EACH, _LONGEST = 4, 0.7
#: objects and hits of rays that are farther from the robots need not be seen, m
_NEAR = 7.0
_PATH, _RAY, _CURVES = (20, 90, 200), (220, 60, 40), ((200, 40, 40), (40, 120, 60), (40, 80, 200))


class Track(Observer):
    """The path of each robot, and the curves that the scene shows.

    Args:
        simulation: a simulation at its start.
    """

    def __init__(self, simulation: Any) -> None:
        self._simulation = simulation
        self.shown = False
        self.paths: dict[str, list[list[float]]] = {}
        self.curves: dict[tuple[str, str], list[list[float]]] = {
            curve: [] for plot in self.display.plots for curve in plot
        }

    @property
    def display(self) -> Any:
        """What the scene asks the live view to show."""
        return self._simulation.scene.settings.view.display

    def after_tick(self) -> None:
        """Note where the robots are, and the values of the curves."""
        if self._simulation.clock.tick % _EACH == 0:
            for name, robot in self._simulation.context.robots.items():
                self.paths.setdefault(name, []).append(list(robot.bge_object.worldPosition))
        for component, field in self.curves:
            value = self._simulation.context.component(component).local_data[field]
            self.curves[component, field].append(np.atleast_1d(value).astype(float).tolist())


class Camera:
    """A viewpoint from which the robots and their paths are seen.

    Args:
        points: (N, 3), m, to be seen.
        size: width and height of the picture, pixels.
        azimuth: direction from the points to the camera about Z, rad.
    """

    def __init__(self, points: NDArray[np.float64], size: tuple[int, int], azimuth: float) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        high[2] += 0.9
        far = 3.6 + 1.15 * float(np.linalg.norm((high - low)[:2]))
        back = np.array([math.cos(azimuth), math.sin(azimuth), 0.62])
        self.location = (low + high) / 2 + far * back / np.linalg.norm(back)
        self.rotation = [math.atan2(math.hypot(*back[:2]), back[2]), 0.0, azimuth + math.pi / 2]
        self._size = size

    def project(self, points: NDArray[np.float64]) -> list[tuple[float, float] | None]:
        """The pixels of points of the world; None for those behind the camera."""
        x, z = self.rotation[0], self.rotation[2]
        about_x = np.array([[1, 0, 0], [0, math.cos(x), -math.sin(x)], [0, math.sin(x), math.cos(x)]])
        about_z = np.array([[math.cos(z), -math.sin(z), 0], [math.sin(z), math.cos(z), 0], [0, 0, 1]])
        seen = (points - self.location) @ (about_z @ about_x)
        scale = self._size[0] * _FOCAL / _SENSOR
        middle = self._size[0] / 2, self._size[1] / 2
        return [
            (middle[0] + scale * right / -back, middle[1] - scale * up / -back) if back < -0.1 else None
            for right, up, back in seen
        ]


def picture(simulation: Any, tracks: list[Track], size: tuple[int, int]) -> Image.Image:
    """The present world from outside, with paths, rays, images and curves.

    Args:
        tracks: that of the simulation first, then those of other simulations whose paths are shown, too.
        size: width and height, pixels.
    """
    display = tracks[0].display
    cameras = [sensor for name in display.images if "image" in (sensor := _measured(simulation, name)).local_data]
    paths = [part for track in tracks for path in track.paths.values() for part in _parts(path)]
    rays = [ray for name in display.rays for ray in _rays(simulation, name)]
    seen = _seen_points(simulation, paths, rays)
    if not paths and len(seen) == 1:  # a robot alone: with the world around it
        seen = seen + np.array([[-1.2, -1.2, 0.0], [1.2, 1.2, 0.0]])
    camera = Camera(seen, size, math.radians(-50.0))
    pixels = simulation.picture(*size, location=camera.location.tolist(), rotation=camera.rotation, focal_length=_FOCAL)
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image)
    for path in paths:
        on_ground = np.array(path) if max(p[2] for p in path) > 0.5 else np.array([[x, y, 0.02] for x, y, _ in path])
        _line(draw, camera.project(on_ground), _PATH, 3)
    for ray in rays:
        _line(draw, camera.project(np.array(ray)), _RAY, 1)
    _images(image, cameras)
    for number, plot in enumerate(display.plots):
        _plot(draw, [tracks[0].curves[curve] for curve in plot], size, number)
    return image


def chart(columns: dict[str, list[float]], size: tuple[int, int]) -> Image.Image:
    """The last column that varies over the first one."""
    image = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(image)
    varying = {name: values for name, values in columns.items() if isinstance(values[0], float) and len({*values}) > 1}
    across, up = list(varying)[:2]
    xs, ys = varying[across], varying[up]
    left, bottom, width, height = 80, size[1] - 60, size[0] - 140, size[1] - 120
    points = [(left + x / max(xs) * width, bottom - y / max(ys) * height) for x, y in zip(xs, ys, strict=True)]
    draw.line([(left, bottom - height), (left, bottom), (left + width, bottom)], fill=(0, 0, 0), width=2)
    draw.line(points, fill=_CURVES[2], width=3)
    for (x, y), value, result in zip(points, xs, ys, strict=True):
        draw.ellipse([x - 5, y - 5, x + 5, y + 5], fill=_CURVES[0])
        draw.text((x - 8, bottom + 8), f"{value:g}", fill=(0, 0, 0), font_size=16)
        draw.text((x + 8, y - 22), f"{result:.3f}", fill=(0, 0, 0), font_size=16)
    draw.text((left + width - 40, bottom + 30), across, fill=(0, 0, 0), font_size=16)
    draw.text((left - 60, bottom - height - 30), up, fill=(0, 0, 0), font_size=16)
    return image


def cloud(points: NDArray[np.float64], size: tuple[int, int]) -> Image.Image:
    """Points in the frame of a camera (X right, Y down, Z ahead), from behind it, near ones dark."""
    pixels = np.full((size[1], size[0], 3), 255, np.uint8)
    points = points[(points[:, 2] > 0.3) & (points[:, 2] < 30.0)]
    points = points[np.argsort(-points[:, 2])]
    scale = 0.9 * size[0] / (points[:, 2] + 1.0)
    column, row = size[0] / 2 + scale * points[:, 0], size[1] / 2 + scale * (points[:, 1] - 0.2)
    shade = np.clip(points[:, 2] / 14.0, 0.0, 1.0)
    colors = np.stack([40 + 160 * shade, 70 + 130 * (1 - shade), 220 - 120 * shade], axis=1).astype(np.uint8)
    within = (column >= 0) & (column < size[0] - 1) & (row >= 0) & (row < size[1] - 1)
    for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
        pixels[row[within].astype(int) + down, column[within].astype(int) + right] = colors[within]
    return Image.fromarray(pixels)


def _seen_points(simulation: Any, paths: list[Any], rays: list[Any]) -> NDArray[np.float64]:
    robots = [list(robot.bge_object.worldPosition) for robot in simulation.context.robots.values()]
    things = [end for _, end in rays]
    if "empty" in str(simulation.scene.environment):
        things += [
            list(body.worldPosition) for body in simulation.world.objects() if body.parent is None and body.is_dynamic
        ]
    near = [thing for thing in things if min(math.dist(thing, robot) for robot in robots) < _NEAR]
    return np.array([*robots, *(point for path in paths for point in path), *near])


def _measured(simulation: Any, name: str) -> Any:
    robot, _, component = name.partition(".")
    getattr(simulation[robot], component).get()  # takes an image
    return simulation.context.component(name)


def _parts(path: list[list[float]]) -> Iterable[list[list[float]]]:
    """The pieces of a path between the places that the robot was set to, without those at rest."""
    piece: list[list[float]] = []
    for point in [*path, [math.inf] * 3]:
        if piece and not math.dist(point, piece[-1]) < _LONGEST:
            if _length(piece) > 0.3:
                yield piece
            piece = []
        piece.append(point)


def _length(path: list[list[float]]) -> float:
    return float(np.ptp(np.array(path), axis=0).max()) if path else 0.0


def _rays(simulation: Any, name: str) -> Iterable[tuple[list[float], list[float]]]:
    sensor = simulation.context.component(name)
    body = sensor.bge_object
    origin, rotation = np.array(body.worldPosition), np.array(body.worldOrientation)
    for point in sensor.local_data.get("point_list", [])[::6]:
        if any(point):
            yield list(origin), list(origin + rotation @ np.array(point))


def _line(draw: Any, points: list[tuple[float, float] | None], color: tuple[int, ...], width: int) -> None:
    for one, other in pairwise(points):
        if one is not None and other is not None:
            draw.line([one, other], fill=color, width=width)


def _images(image: Image.Image, cameras: list[Any]) -> None:
    width = 200 if len(cameras) == 1 else 148
    for number, camera in enumerate(cameras):
        small = _seen(camera)
        small = small.resize((width, width * small.height // small.width))
        place = (image.width - (width + 6) * (number + 1), image.height - small.height - 6)
        image.paste(Image.new("RGB", (small.width + 4, small.height + 4), "white"), (place[0] - 2, place[1] - 2))
        image.paste(small, place)


def _seen(camera: Any) -> Image.Image:
    pixels = np.asarray(camera.local_data["image"])
    if pixels.ndim == 3:
        return Image.fromarray(np.ascontiguousarray(pixels[:, :, :3]).astype(np.uint8))
    values = pixels.astype(float)
    if values.dtype.kind == "f" and np.asarray(camera.local_data["image"]).dtype.kind == "f":
        return Image.fromarray((255.0 / (1.0 + values.clip(0.0, 50.0))).astype(np.uint8)).convert("RGB")
    colors = np.array([[(37 * k) % 206 + 50, (91 * k) % 206 + 50, (151 * k) % 206 + 50] for k in range(256)], np.uint8)
    colors[0] = 30
    return Image.fromarray(colors[values.astype(int) % 256])


def _plot(draw: Any, curves: list[list[list[float]]], size: tuple[int, int], number: int) -> None:
    left, top, width, height = 8, size[1] - 118 - 122 * number, 240, 110
    draw.rectangle([left, top, left + width, top + height], fill=(255, 255, 255), outline=(120, 120, 120))
    columns = [column for curve in curves for column in zip(*curve, strict=True)]
    # without the jump of the first ticks
    low, high = (float(np.quantile(np.concatenate(columns), share)) for share in (0.02, 0.98))
    for index, column in reversed(list(enumerate(columns))):
        xs = np.linspace(left + 36, left + width - 6, len(column))
        ys = top + height - 8 - (np.clip(column, low, high) - low) / ((high - low) or 1.0) * (height - 16)
        draw.line(list(zip(xs, ys, strict=True)), fill=_CURVES[index % 3], width=2)
    draw.text((left + 3, top + 2), f"{high:.3g}", fill=(0, 0, 0))
    draw.text((left + 3, top + height - 13), f"{low:.3g}", fill=(0, 0, 0))
