"""Reloads an edited scene script when the user restarts the simulation (F11)."""

from __future__ import annotations

import logging
import os
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from morse.builder.script import ScriptError, load_scene
from morse.core.classes.project_imports import ProjectImports
from morse.core.exceptions import MorseError
from morse.core.observer import SHOWN
from morse.launch.load import refuse
from morse.scene.scene_warnings import scene_warnings
from morse.simulation.watching.edits import stamp

if TYPE_CHECKING:
    from morse.scene import Scene
    from morse.simulation.options import RunOptions
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import View


# The files of a scene at the time when they were read.

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


logger = logging.getLogger("morse.main")


class Rereading:
    """Compares the files of a scene with those on the disk, and loads the scene again if they were edited.

    Args:
        options: options of the run.
        scene: the loaded scene; its project stays in the process until another project replaces it.
        loaded: the stamps of files from the time when they were read: a file that is saved while the simulation starts
            counts as edited.

    Attributes:
        successor: the edited scene, its options and the stamps of its files; None until there is one.
    """

    def __init__(self, options: RunOptions, scene: Scene, stamps: Stamps) -> None:
        self._options, self._scene = options, scene
        self._stamps = {path: stamp(path) for path in [os.path.abspath(options.script), *sources_of(scene)]} | stamps
        self.successor: tuple[Scene, RunOptions, Stamps] | None = None

    def edited(self, simulation: Simulation) -> list[str]:
        """The files that were saved since the scene was loaded, except components that are already reloaded."""
        # it imports the physics, which a run loads in a section that Ctrl+C does not interrupt
        from morse.simulation.watching.watch import Watch

        exchanged_files = {
            path for watch in simulation.observers if isinstance(watch, Watch) for path in watch.exchanged
        }
        return [
            path for path, earlier in self._stamps.items() if path not in exchanged_files and stamp(path) != earlier
        ]

    def start_anew(self, simulation: Simulation) -> bool:
        """Load the edited scene and end the simulation, so that the edited scene replaces it.

        Returns:
            False if no file was edited, or if the edited files have an error: the error is logged, and the caller has
            to restart the previous scene.
        """
        edited = self.edited(simulation)
        if not edited:
            return False
        project = self._scene.project
        if isinstance(project, ProjectImports):
            project.leave()
        stamps = script_stamp(self._options)
        read = {path: stamp(path) for path in edited}
        try:
            with scene_warnings(refused=self._options.on_warning == "raise") as collected:
                scene = load_scene(self._options, anew=True)
                refuse(collected.complete())
        except (ScriptError, MorseError) as error:
            text = error.report() if isinstance(error, ScriptError) else str(error)
            first, _, rest = text.partition("\n")
            said = {SHOWN: True}
            logger.error(
                "[ERROR][MORSE] the edited scene cannot be loaded, the previous scene is restarted: %s",
                first,
                extra=said,
            )
            if rest:
                logger.error("%s", rest, extra=said)
            mend = error.mend if isinstance(error, ScriptError) else ""
            simulation.edits.refuse_at_restart(edited, read, f"{error}. {mend}" if mend else str(error))
            if isinstance(project, ProjectImports):
                project.stay()
            return False
        if isinstance(scene.project, ProjectImports):
            scene.project.stay()
        logger.info("read again: %s", ", ".join(edited))
        options = self._options
        if simulation.view is not None and options.view == "web":
            # open pages reconnect to the same address
            port, token = cast("View", simulation.view).address
            options = replace(options, view_port=port, view_token=token, open_browser=False)
        self.successor = scene, options, stamps | source_stamps(scene)
        simulation.stop()
        return True
