"""``morse view``: a model in the live view, with sliders for its actuators."""

from __future__ import annotations

import socket
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from morse.cli.messages import CommandError, say
from morse.core.reports import log
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from morse.scene.library import Library

_SUFFIXES = (".xml", ".mjcf", ".urdf", ".sdf")


def command(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="An MJCF, URDF or SDF file.", show_default=False)],
    key: Annotated[
        str | None, typer.Option("--key", metavar="NAME", help="Start in this key frame (default: the first one).")
    ] = None,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the live view in a browser.")] = True,
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="Port of the live view.")] = 8765,
    duration: Annotated[
        float | None, typer.Option("--duration", min=0.0, help="End after that many simulated seconds.")
    ] = None,
) -> int:
    """Show an MJCF, URDF or SDF file in the live view, with a slider for each actuator."""
    path = Path(model)
    text = script_of(path, key)
    # imported on demand, so that a wrong name does not load the simulator
    from morse.launch.run import run

    with tempfile.TemporaryDirectory(prefix="morse-view-") as folder:
        script = Path(folder) / "scene.py"
        script.write_text(text, encoding="utf-8")
        log.setup()
        options = RunOptions(
            script=str(script), node_name=socket.gethostname(), open_browser=browser, view_port=port, duration=duration
        )
        say("The scene, for `morse run`:\n\n" + text)
        return run(options)


def script_of(path: Path, key: str | None) -> str:
    """A scene with the model and a component for its joints.

    Raises:
        CommandError: the file cannot be read, has no bodies, or has no such key frame.
    """
    from morse.assets import loader
    from morse.cli.messages import nearest

    if not path.is_file():
        raise CommandError(f"There is no file '{path}'.", status=2)
    if path.suffix.lower() not in _SUFFIXES:
        raise CommandError(
            f"`morse view` shows MJCF, URDF and SDF files, {', '.join(_SUFFIXES)}, not '{path}'.", status=2
        )
    try:
        library = loader.load(path)
    except (OSError, ValueError) as error:
        raise CommandError(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    keys = list(library.keyframes)
    if key is not None and key not in keys:
        there = f" There are: {', '.join(keys)}." if keys else " The file has none."
        raise CommandError(f"There is no key frame '{key}' in {path}.{nearest(key, keys)}{there}", status=2)
    first = key or next(iter(keys), None)
    start = "" if first is None else f", keyframe={first!r}"
    armatures = _armatures(library)
    lines = [
        "from morse.builder import Armature, Environment, Robot",
        "",
        f"robot = Robot({str(path.resolve())!r}{start})",
    ]
    for number, name in enumerate(armatures):
        lines.append(f"joints{number or ''} = Armature('joints{number or ''}', armature_name={name!r})")
        # a command acts at once, as in MuJoCo
        lines.append(f"joints{number or ''}.properties(RotationSpeed=1000.0, LinearSpeed=1000.0)")
        lines.append(f"robot.append(joints{number or ''})")
    lines += ['env = Environment("empty")', *(["env.show(select=joints)"] if armatures else []), ""]
    return "\n".join(lines)


def _armatures(library: Library) -> list[str]:
    """The joints of the robot: those of other groups are moved by nobody."""
    roots = [root for root in library.roots if root.name == library.robot] or library.roots
    return [node.name for root in roots for node in root.walk() if node.bones]
