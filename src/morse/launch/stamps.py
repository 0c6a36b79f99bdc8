"""The files of a scene at the time when they were read."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from morse.core.classes.project_imports import ProjectImports
from morse.simulation.watching.files import stamp

if TYPE_CHECKING:
    from morse.scene import Scene
    from morse.simulation.options import RunOptions

Stamps = dict[str, "tuple[int, int, int] | None"]


def script_stamp(options: RunOptions) -> Stamps:
    """The stamp of the script, to be taken before it is read."""
    path = os.path.abspath(options.script)
    return {path: stamp(path)}


def sources_of(scene: Scene) -> list[str]:
    """The files of the modules of the project of a scene."""
    return list(scene.project.sources().values()) if isinstance(scene.project, ProjectImports) else []


def source_stamps(scene: Scene) -> Stamps:
    """The stamps of the modules that a scene has just imported."""
    return {path: stamp(path) for path in sources_of(scene)}
