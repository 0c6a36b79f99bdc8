"""``morse render``: an image or a film of a scene, without a window."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from morse.cli.messages import CommandError, complain, nearest, say
from morse.cli.scenes import resolve
from morse.system.regular_files import RefusedFileError, check_default_name

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.rendering import CameraRequest, Lens
    from morse.sensors.camera import PictureModifier
    from morse.simulation.simulation import Simulation


# Viewpoints and sizes of images and films of a scene.

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
    from morse.rendering.renderer import Viewpoint, angle_of

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


class _View:
    """The free viewpoint, for the modifiers of the pictures of all video cameras, such as those of the weather."""

    exposure_time = 0.0
    lens = property(lambda self: self.request.lens)

    def __init__(self, context: Context, request: CameraRequest) -> None:
        self.context, self.request = context, request

    def name(self) -> str:
        return "view"


def modifiers_of(simulation: Simulation, camera: str | None, request: CameraRequest) -> list[PictureModifier]:
    """The modifiers of the pictures of a camera, or of the free viewpoint."""
    from morse.builder.names.catalog import fitting_modifier
    from morse.core.classes.classpath import load_class
    from morse.sensors.camera import PictureModifier
    from morse.sensors.video_camera import VideoCamera

    if camera is not None:
        component: Any = simulation.context.components[camera]
        own = [one for one in component.output_modifiers if isinstance(one, PictureModifier)]
        request.normals = any("normals" in one.uses for one in own)
        return own
    view: Any = _View(simulation.context, request)
    found = []
    for one in simulation.context.scene.alterations:
        path = fitting_modifier(one.name, VideoCamera)
        cls = None if path is None else load_class(path)
        if cls is not None and issubclass(cls, PictureModifier):
            found.append(cls(view, dict(one.options)))
    return found


def shape_of(request: CameraRequest, fine: bool) -> tuple[int, int]:
    """Width and height of the images, px."""
    from morse.rendering.renderer import Viewpoint

    lens = request.lens
    halved = fine and isinstance(request.obj, Viewpoint)
    return (lens.width // 2, lens.height // 2) if halved else (lens.width, lens.height)


def drawn(
    request: CameraRequest, show: str, fine: bool, modifiers: Sequence[PictureModifier] = (), time: float = 0.0
) -> NDArray[np.uint8]:
    """(H, W, 3) the present image, as modifiers change it; ``time`` is the simulated time, s."""
    import numpy as np

    from morse.core.image_colors import as_colors, as_pixels
    from morse.rendering.textures import LIGHT, encoded

    request.server.serve([request])
    picture = request.picture
    assert picture is not None
    for modifier in modifiers:
        picture = modifier.modify_picture(picture, time)
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


CONTEXT_SETTINGS = {"allow_interspersed_args": True}

_SHOWN = ("color", "depth", "ids")
_LONGEST = 3600.0


def command(
    scene: Annotated[
        list[str],
        typer.Argument(
            metavar="ENVIRONMENT [FILE] | PATH",
            help="The scene, as for `morse run`, or an MJCF file.",
            show_default=False,
        ),
    ],
    output: Annotated[
        str, typer.Option("-o", "--output", metavar="FILE", help="picture.png, .jpg or .webp; for a film, see --film.")
    ] = "picture.png",
    origin: Annotated[
        str | None,
        typer.Option("--from", metavar="X,Y,Z", help="Position of the viewpoint, m (default: that of the script)."),
    ] = None,
    target: Annotated[
        str | None, typer.Option("--to", "--at", metavar="X,Y,Z", help="Point to look at, m (default: the origin).")
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option("--camera", metavar="ROBOT.CAMERA", help="Draw the image of a camera of the scene instead."),
    ] = None,
    size: Annotated[str, typer.Option("--size", metavar="WxH", help="Pixels.")] = "1280x720",
    fov: Annotated[
        float | None, typer.Option("--fov", help="Horizontal angle of view, degrees (default: that of the script).")
    ] = None,
    show: Annotated[
        str | None,
        typer.Option(
            "--show",
            metavar="color|depth|ids",
            help="What to draw (default: color; what a depth or id camera measures).",
        ),
    ] = None,
    time: Annotated[float, typer.Option("--time", min=0.0, help="Simulated seconds before the picture.")] = 0.5,
    film: Annotated[
        float | None,
        typer.Option(
            "--film",
            metavar="SECONDS",
            help="Draw a film of this length, simulated seconds: .gif, .webp, frame_%04d.png, or with ffmpeg .mp4, "
            ".webm, .mkv.",
        ),
    ] = None,
    rate: Annotated[float, typer.Option("--rate", help="Frames per simulated second of a film.")] = 20.0,
    fine: Annotated[bool, typer.Option("--fine", help="Draw four times as many pixels, for smoother edges.")] = False,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of all random numbers.")] = None,
) -> int:
    """Draw an image or a film of a scene: the same file on every machine, without a window or a graphics card."""
    from morse.rendering import picture_files

    path = Path(output)
    _check(show, time, film, rate, camera, (origin, target, fov))
    width, height = size_of(size)
    places = place_of(origin, "--from"), place_of(target, "--to")
    try:
        picture_files.check(path, film=film is not None)
        check_default_name(path)
    except (ValueError, RefusedFileError) as error:
        raise CommandError(f"-o: {error}.", status=2) from None
    if scene and Path(scene[0]).suffix.lower() in _MODELS and Path(scene[0]).is_file():
        others = {"--from": origin, "--to": target, "--fov": fov, "--fine": fine or None, "--seed": seed}
        if given := [name for name, value in others.items() if value is not None]:
            raise CommandError(
                f"{given[0]} is an option of scenes: a model file is shown by --camera, one of its own cameras.",
                status=2,
            )
        return _draw_model(Path(scene[0]), path, camera, (width, height), show or "color", (time, film, rate))
    simulation = load(scene, seed)
    try:
        show = show or usual_of(simulation, camera)
        request = request_of(simulation, camera, places, (width, height), fov, fine, show == "color")
        modifiers = modifiers_of(simulation, camera, request)
        _run(simulation, time)
        _write(
            path,
            shape_of(request, fine),
            (time, film, rate),
            lambda: drawn(request, show, fine, modifiers, simulation.clock.time),
            lambda until: _run(simulation, until),
        )
        return _status(simulation)
    except OSError as error:
        raise CommandError(f"{path} could not be written: {error.strerror or error}") from None
    finally:
        simulation.close()


def _write(
    path: Path,
    size: tuple[int, int],
    times: tuple[float, float | None, float],
    draw: Callable[[], NDArray[np.uint8]],
    run: Callable[[float], None],
) -> None:
    """Write a picture, or a film of a width and a height; ``times`` are the start, the length, s, and frames per s."""
    from morse.rendering import picture_files

    start, film, rate = times
    if film is None:
        picture_files.save_picture(path, draw())
        say(f"{path}: {start:g} s after the start.")
        return
    frames = max(1, round(film * rate))
    video = picture_files.film(path, size, rate)
    for number in range(frames):
        video.add(draw())
        run(start + (number + 1) / rate)
    video.close()
    say(f"{path}: {frames} frames of {film:g} s.")


#: files that MuJoCo reads
_MODELS = (".xml", ".mjcf")


def _draw_model(
    file: Path,
    path: Path,
    camera: str | None,
    size: tuple[int, int],
    show: str,
    times: tuple[float, float | None, float],
) -> int:
    """Draw an MJCF file, which MuJoCo simulates, by one of its cameras."""
    from morse.core.image_colors import as_colors, as_pixels

    try:
        from morse.eyes.model_file import ModelFile

        model = ModelFile(file, *size)
    except ValueError as error:
        raise CommandError(f"{file} cannot be read by MuJoCo: {error}") from None
    except ImportError as error:  # the version of MuJoCo
        raise CommandError(f"{error}.") from None
    if camera is not None and camera not in model.cameras:
        there = f" There are: {', '.join(model.cameras)}." if model.cameras else " The file has none."
        raise CommandError(f"There is no camera '{camera}' in {file}.{nearest(camera, model.cameras)}{there}")

    def draw() -> NDArray[np.uint8]:
        import numpy as np

        picture = model.picture(camera, "rgb" if show == "color" else show)
        if show == "ids":
            return as_colors(picture)
        return np.repeat(as_pixels(picture)[..., None], 3, axis=2) if show == "depth" else picture

    model.run(times[0])
    try:
        _write(path, size, times, draw, model.run)
    except OSError as error:
        raise CommandError(f"{path} could not be written: {error.strerror or error}") from None
    return 0


def _status(simulation: Simulation) -> int:
    """End a simulation, and return the exit status: a picture lacks what a part would have done that has failed."""
    from morse.core.guard import by_part
    from morse.simulation.ending import FAULTS

    simulation.close()
    faults = [failure for failure in simulation.failures if failure.kind == "fault"]
    if not faults:
        return 0
    complain(f"Switched off by faults:\n{by_part(faults)}")
    return FAULTS


def _check(
    show: str | None, time: float, film: float | None, rate: float, camera: str | None, others: tuple[object, ...]
) -> None:
    if show is not None and show not in _SHOWN:
        raise CommandError(f"--show is one of {', '.join(_SHOWN)}, not '{show}'.{nearest(show, _SHOWN)}", status=2)
    if not 0.0 <= time <= _LONGEST:
        raise CommandError(f"--time is 0 to {_LONGEST:g} simulated seconds, not {time:g}.", status=2)
    if film is not None and not 0.0 < film <= _LONGEST:
        raise CommandError(f"--film is a number of simulated seconds up to {_LONGEST:g}, not {film:g}.", status=2)
    if not 0.0 < rate <= 1000.0:
        raise CommandError(f"--rate is a number of frames per second up to 1000, not {rate:g}.", status=2)
    if camera is not None and any(other is not None for other in others):
        raise CommandError(
            "--camera shows the image of a camera: it cannot be combined with --from, --to and --fov.", status=2
        )


def load(words: list[str], seed: int | None) -> Simulation:
    """Load a scene without windows and sockets.

    Raises:
        CommandError: it cannot be loaded.
    """
    from morse.builder.errors.script_error import ScriptError
    from morse.core.exceptions import MorseError
    from morse.launch.load import described, start

    resolved = resolve(words)
    options = resolved.options(
        view="none",
        sockets=False,
        seed=seed,
    )
    try:
        return start(described(resolved.script, options), options)
    except ScriptError as error:
        raise CommandError(error.report()) from None
    except (MorseError, ValueError, OSError) as error:
        raise CommandError(str(error)) from None


def _run(simulation: Simulation, until: float) -> None:
    ticks = round(until * simulation.clock.frequency) - simulation.clock.tick
    if ticks > 0:
        simulation.step(ticks)
