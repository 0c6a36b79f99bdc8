"""A picture of a model file, in an empty world."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from morse.cli.render import load
from morse.cli.viewing import drawn, request_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.scene import Library, Node

    Box = tuple[NDArray[np.float64], NDArray[np.float64]]

_SIZE, _ANGLE = (960, 720), 40.0
#: direction from the model to the viewpoint: its front, its right side and its top are visible
_FROM = (0.8, -0.5, 0.4)
#: what is larger is the ground of a world, m
_GROUND = 40.0
_SCRIPTS = {
    "Environment": "env = Environment({file!r})",
    "Robot": "robot = Robot({file!r}, sensors=False)\nrobot.translate(z={lift})\nenv = Environment('empty')",
    "PassiveObject": "model = PassiveObject({file!r})\nmodel.translate(z={lift})\nenv = Environment('empty')",
}


def draw(path: Path, library: Library, picture: Path) -> None:
    """Load a model into the physics, and write a picture of it before the first tick.

    Raises:
        CommandError: a scene with the model cannot be loaded.
        OSError: the picture cannot be written.
    """
    import numpy as np

    from morse.mathutils.portable import norm
    from morse.rendering import picture_files

    kind = _class_of(library)
    low, high = _box(library)
    # the lowest point of a robot is on the floor
    lift = 0.0 if kind == "Environment" else -float(low[2])
    middle = 0.5 * (low + high) + (0.0, 0.0, lift)
    distance = 0.5 * norm(high - low) / math.sin(math.radians(0.4 * _ANGLE))
    viewpoint = middle + distance / math.hypot(*_FROM) * np.array(_FROM)
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "model.py"
        text = _SCRIPTS[kind].format(file=str(path.absolute()), lift=lift)
        script.write_text(f"from morse.builder import *\n{text}\n", encoding="utf-8")
        simulation = load([str(script)], None)
        try:
            places = tuple(viewpoint.tolist()), tuple(middle.tolist())
            request = request_of(simulation, None, places, _SIZE, _ANGLE, True, True)
            picture_files.save_picture(picture, drawn(request, "color", True))
        finally:
            simulation.close()


def _class_of(library: Library) -> str:
    """The class of scene scripts for a model file."""
    if library.world or (len(library.roots) > 1 and not library.robot):
        return "Environment"
    return "Robot" if any(node.bones for node in library.nodes()) else "PassiveObject"


def _box(library: Library) -> Box:
    """The corners of what the model shows, without the ground of a world."""
    import numpy as np

    from morse.scene.extent import extent

    boxes = [box for root in library.roots if (box := extent(_shown(root))) is not None]
    boxes = [box for box in boxes if (box[1] - box[0]).max() < _GROUND] or boxes
    if not boxes:
        return np.full(3, -0.5), np.full(3, 0.5)
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def _shown(root: Node) -> list[Node]:
    nodes = [node for node in root.walk() if node.mesh is not None]
    return [node for node in nodes if node.visible] or nodes
