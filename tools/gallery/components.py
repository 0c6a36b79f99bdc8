"""Creates the pictures of the component library: ``python -m tools pictures [NAME...]``.

The example on the page of each component is run in this process. Views of the scene, camera images, and plots of sensor
data are stored in ``docs/pictures/library``; the pages show the existing files.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

import morse
from morse.core.declarations import fields_of_component
from morse.core.image_colors import as_coordinates, as_heat

DOCS = Path(__file__).parents[2] / "docs"
sys.path.insert(0, str(DOCS))
sys.path.insert(0, str(Path(__file__).parent))

import component_library  # noqa: E402
from component_library.sizes import extent as extent_of  # noqa: E402
from curves import plot  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.simulation.simulation import Simulation

PICTURES = DOCS / "pictures" / "library"
SIZE = (640, 400)
SECONDS = 6.0
#: a component is looked at from nearby if its size is at most this share of that of the robot
_SMALL = 0.4
#: what is shown then: metres, and sizes of the component
_NEAR, _AROUND = 0.35, 2.2
#: m above the origin of the robot
_LOWEST = 0.3
#: smallest size for which the distance of the camera is computed, metres
_TINY = 0.3
#: a robot of at most this size is shown whole, metres
_LARGE = 1.0
_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_ENVIRONMENT = "env = Environment('empty')"
#: objects around the robot, for sensors
_THINGS = """
for _name, _place, _colour, _heat in (
    ("red", (5.0, 1.5), (0.8, 0.1, 0.1), 60.0),
    ("blue", (3.0, -3.0), (0.1, 0.2, 0.8), 20.0),
    ("green", (-2.0, 4.0), (0.1, 0.6, 0.2), 36.0),
):
    _box = Cube(_name)
    _box.location = (*_place, 0.5)
    _box.scale = (0.5, 0.5, 0.5)
    _box.set_color(*_colour)
    _box.properties(Object=True, Type="box", Injured=True, Fire=True, Temperature=_heat)
    _box.static()
"""
#: the robot drives, so that the data of sensors change
_DRIVE = "_drive = MotionVW()\nrobot.append(_drive)\n"


def take(name: str, page: str) -> list[Path]:
    """Run the example of a page and save its pictures."""
    scene, *clients = _BLOCK.findall(page)
    sensor = "/sensors/" in name
    text = scene.replace(_ENVIRONMENT, _THINGS + _ENVIRONMENT)
    if sensor and "robot = ATRV()" in text:
        text = text.replace("robot = ATRV()\n", "robot = ATRV()\n" + _DRIVE)
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder, "scene.py")
        script.write_text(text, encoding="utf-8")
        with morse.load(script, seed=1) as simulation:
            return list(_pictures(name.rpartition("/")[2], simulation, clients, sensor=sensor))


def _pictures(name: str, simulation: Simulation, clients: list[str], *, sensor: bool) -> Any:
    component = _component(simulation, name)
    said: list[dict[str, Any]] = []
    if sensor and component is not None:
        component.output_functions.append(lambda each: said.append(_numbers(each.local_data)))
    drive = simulation.context.component("robot._drive")
    if drive is not None:
        drive.local_data.update(v=0.6, w=0.35)
    command = _command(clients, simulation)
    simulation.step(60)
    if command is not None:
        command()
    simulation.step(round((SECONDS if sensor else 1.0) * 60))
    PICTURES.mkdir(parents=True, exist_ok=True)
    seen = PICTURES / f"{name}.webp"
    Image.fromarray(simulation.picture(*SIZE, **_view(simulation, component))).save(seen, "WEBP", quality=80, method=6)
    yield seen
    image = None if component is None else component.local_data.get("image")
    if image is not None and np.ndim(image) >= 2:
        path = PICTURES / f"{name}-image.webp"
        drawn = _as_image(component, np.asarray(image))
        drawn.resize((400, 400), Image.Resampling.NEAREST).save(path, "WEBP", quality=80)
        yield path
    elif (points := _points(component)) is not None and len(points):
        path = PICTURES / f"{name}-points.webp"
        _map(points).save(path, "WEBP", quality=85)
        yield path
    elif len(said) > 2 and (drawn := plot(said)):
        path = PICTURES / f"{name}.svg"
        path.write_text(drawn, encoding="utf-8")
        yield path


def _component(simulation: Simulation, name: str) -> Any:
    """The component of the page."""
    found = simulation.context.components.items()
    return next(
        (part for full, part in found if full.rpartition(".")[2].replace("_", "") == name.replace("_", "")), None
    )


def _command(clients: list[str], simulation: Simulation) -> Callable[[], object] | None:
    """The command that the client of the page publishes."""
    found = [match for client in clients for match in re.finditer(r"simu\.([\w.]+)\.publish\((.*)\)", client)]
    if not found:
        return None
    full, message = found[0].groups()

    def publish() -> None:
        handle: Any = simulation
        for part in full.split("."):
            handle = getattr(handle, part)
        handle.publish(eval(message))

    return publish


def _view(simulation: Simulation, component: Any) -> dict[str, Any]:
    """A camera that shows the component, or the robot if it has no body, from the front left."""
    robot = next(iter(simulation.context.robots.values()))
    extent = extent_of(robot.bge_object.node) or [0.0, 0.0, 0.0]
    size = max(_TINY, *extent)
    x, y, z = robot.bge_object.world_pose()[0]
    middle = np.array([x, y, z + 0.35 * extent[2]])
    own = None if component is None else extent_of(component.bge_object.node)
    place = (0.0, 0.0, 0.0) if own is None else component.bge_object.world_pose()[0]
    # one that is lower is inside of the robot, or below it; a small robot is seen with its component in one picture
    large = size > _LARGE and place[2] - z > _LOWEST
    if own is not None and large and 0.0 < max(own) < _SMALL * size:
        # a part of the robot shows how large the component is
        middle = np.array(place)
        size = max(_NEAR, _AROUND * max(own))
    away = np.array([0.75, 0.9, 0.55]) * size * 1.7
    eye = middle + away
    yaw = np.arctan2(away[0], -away[1])
    pitch = np.arctan2(np.hypot(away[0], away[1]), away[2])
    return {"location": eye.tolist(), "rotation": (float(pitch), 0.0, float(yaw)), "focal_length": 28.0}


def _points(component: Any) -> np.ndarray | None:
    """The end points of the beams of a scanner or of the pixels of a camera, in metres ahead and to the left."""
    data = {} if component is None else component.local_data
    if "point_list" in data:
        found = np.asarray(data["point_list"], dtype=float).reshape(-1, 3)
        return found[np.any(found != 0.0, axis=1)][:, :2]
    if "points" in data:
        found = np.asarray(data["points"], dtype=float).reshape(-1, 3)
        return np.column_stack([found[:, 2], -found[:, 0]])
    return None


def _map(points: np.ndarray) -> Image.Image:
    """A top view with the sensor in the centre, 20 m wide; ahead is up."""
    side, reach = 400, 10.0
    pixels = np.full((side, side, 3), 255, np.uint8)
    pixels[side // 2 - 2 : side // 2 + 3, side // 2 - 2 : side // 2 + 3] = (180, 86, 15)
    scaled = (side / 2 - points * side / (2 * reach)).astype(int)
    inside = np.all((scaled >= 1) & (scaled < side - 1), axis=1)
    for rows in (-1, 0):
        for columns in (-1, 0):
            pixels[scaled[inside, 0] + rows, scaled[inside, 1] + columns] = (31, 122, 112)
    return Image.fromarray(pixels)


def _as_image(component: Any, pixels: np.ndarray) -> Image.Image:
    if pixels.dtype == np.uint8:
        return Image.fromarray(pixels[..., :3])
    if pixels.ndim == 3 and pixels.shape[2] == 3:
        return Image.fromarray(as_coordinates(pixels))
    finite = np.where(np.isfinite(pixels), pixels, np.nan)
    near, far = np.nanmin(finite), np.nanmax(finite)
    if fields_of_component(component)["image"].unit == "°C":
        return Image.fromarray(as_heat(pixels))
    grey = 255.0 * (1.0 - (np.nan_to_num(finite, nan=far) - near) / max(far - near, 1e-9))
    return Image.fromarray(grey.astype(np.uint8)).transpose(Image.Transpose.FLIP_TOP_BOTTOM)


def _numbers(data: dict[str, Any]) -> dict[str, float]:
    """The numbers among the data, and the components of vectors."""
    found: dict[str, float] = {}
    for field, value in data.items():
        if isinstance(value, (int, float)):
            found[field] = float(value)
        elif hasattr(value, "__len__") and not isinstance(value, (str, dict)) and 0 < len(value) <= 4:
            parts = list(value)
            if all(isinstance(part, (int, float)) for part in parts):
                found |= {f"{field}[{i}]": float(part) for i, part in enumerate(parts)}
    return found


def main(names: list[str]) -> int:
    """Create the pictures of these components, or those that are missing; return 1 if an example cannot run."""
    failed = 0
    bodiless = component_library.robot_pages.bodiless()
    pages = {
        **component_library.component_pages.pages("sensors"),
        **component_library.component_pages.pages("actuators"),
        **component_library.robot_pages.pages(),
    }
    for page, text in pages.items():
        name = page.rpartition("/")[2]
        # a robot without a body has nothing to show
        if name in bodiless or (name not in names if names else component_library.pictures.of(name) or name == "index"):
            continue
        try:
            print(*(path.name for path in take(f"/{page}", text)))
        except Exception as error:
            print(f"{page}: {type(error).__name__}: {error}", file=sys.stderr)
            failed = 1
    return failed
