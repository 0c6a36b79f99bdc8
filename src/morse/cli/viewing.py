"""Viewpoints and sizes of images and films of a scene."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from morse.cli.messages import CommandError, nearest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.rendering import CameraRequest, Lens
    from morse.simulation.simulation import Simulation

_SIZE = re.compile(r"(\d{1,5})x(\d{1,5})")
_FARTHEST = 1e4


def size_of(text: str) -> tuple[int, int]:
    """Width and height, px, of ``1280x720``."""
    match = _SIZE.fullmatch(text)
    if match is None or not all(1 <= int(number) <= 8192 for number in match.groups()):
        raise CommandError(f"--size is width x height in pixels up to 8192, such as 1280x720, not '{text}'.", status=2)
    return int(match[1]), int(match[2])


def place_of(text: str | None, option: str) -> tuple[float, ...] | None:
    """Three numbers, m, from a text such as ``4,-5,2.5``; None if the option is not given."""
    if text is None:
        return None
    try:
        numbers = tuple(float(word) for word in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not all(abs(number) <= 1e6 for number in numbers):
        raise CommandError(f"{option} is three numbers in metres, such as 4,-5,2.5, not '{text}'.", status=2)
    return numbers


def usual_of(simulation: Simulation, camera: str | None) -> str:
    """What the camera of a scene measures: ``depth``, ``ids``, or ``color`` for all others and for a free viewpoint."""
    from morse.sensors.depth_camera import AbstractDepthCamera
    from morse.sensors.segmentation_camera import SegmentationCamera

    component = simulation.context.components.get(camera or "")
    if isinstance(component, AbstractDepthCamera):
        return "depth"
    return "ids" if isinstance(component, SegmentationCamera) else "color"


def request_of(
    simulation: Simulation,
    camera: str | None,
    places: tuple[Any, Any],
    size: tuple[int, int],
    fov: float | None,
    fine: bool,
    color: bool,
) -> CameraRequest:
    """Request the pictures of a camera of the scene, or of a free viewpoint."""
    from morse.rendering import Renderer
    from morse.rendering.viewpoint import Viewpoint, angle_of

    renderer = simulation.context.server(Renderer)
    if camera is not None:
        component = simulation.context.components.get(camera)
        lens: Lens | None = getattr(component, "lens", None)
        if component is None or lens is None:
            camera_names = [n for n, c in simulation.context.components.items() if getattr(c, "lens", None) is not None]
            there = f" There are: {', '.join(camera_names)}." if camera_names else " The scene has none."
            raise CommandError(f"There is no camera '{camera}'.{nearest(camera, camera_names)}{there}")
        return renderer.request(component.bge_object, lens, color=color)
    view = simulation.context.scene.settings.view
    try:
        if places == (None, None):
            viewpoint = Viewpoint.of_script(view)
        else:
            viewpoint = Viewpoint.looking_at(places[0] or view.camera_location, places[1] or (0.0, 0.0, 0.0))
        angle = angle_of(view) if fov is None else math.radians(fov)
        return renderer.request(viewpoint, _lens(size, angle, fine), color=color)
    except ValueError as error:
        raise CommandError(f"{error}.", status=2) from None


def _lens(size: tuple[int, int], angle: float, fine: bool) -> Lens:
    from morse.rendering import Lens

    width, height = (2 * number for number in size) if fine else size
    return Lens.of_angle(width, height, angle, 0.05, _FARTHEST)


def shape_of(request: CameraRequest, fine: bool) -> tuple[int, int]:
    """Width and height of the images, px."""
    from morse.rendering.viewpoint import Viewpoint

    lens = request.lens
    halved = fine and isinstance(request.obj, Viewpoint)
    return (lens.width // 2, lens.height // 2) if halved else (lens.width, lens.height)


def drawn(request: CameraRequest, show: str, fine: bool) -> NDArray[np.uint8]:
    """(H, W, 3) the present image."""
    import numpy as np

    from morse.core.colors.id_colors import as_colors
    from morse.core.colors.image_colors import as_pixels
    from morse.rendering.light_codes import LIGHT, encoded

    request.server.serve([request])
    picture = request.picture
    assert picture is not None
    if show == "ids":
        pixels = as_colors(np.minimum(picture.ids + 1, 65535).astype(np.uint16))
    elif show == "depth":
        grey = as_pixels(np.where(picture.depth > 0, picture.depth, np.float32(np.inf)))
        pixels = np.repeat(grey[..., None], 3, axis=2)
    else:
        assert picture.rgb is not None
        pixels = np.ascontiguousarray(picture.rgb)
    width, height = shape_of(request, fine)
    if pixels.shape[:2] == (height, width):
        return pixels
    if show != "color":
        return np.ascontiguousarray(pixels[::2, ::2])
    light = LIGHT[pixels]
    return encoded((light[0::2, 0::2] + light[1::2, 0::2] + light[0::2, 1::2] + light[1::2, 1::2]) * np.float32(0.25))
