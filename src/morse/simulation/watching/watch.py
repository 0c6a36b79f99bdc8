"""Watches the files of a running simulation, and reloads models and components that were saved."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import load
from morse.assets.following import follow, resolve
from morse.builder.assembly.selection import take
from morse.core.classes.project_imports import ProjectImports
from morse.core.exceptions import MorseError
from morse.core.journal import EDIT
from morse.core.observer import SHOWN, Observer
from morse.core.reports.faults import ENDINGS, describe
from morse.physics.model.placement import bottom_of
from morse.simulation.watching.classes import exchange
from morse.simulation.watching.edits import SavedFiles
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.assets.following import Revision
    from morse.physics.state.scene_change import SceneChange
    from morse.scene import ModelUse, Node
    from morse.simulation.simulation import Simulation


# Updates the scene when a model file was saved.


@dataclass
class ModelEdit:
    """The changes of a saved file, computed in another thread and applied between two ticks.

    Attributes:
        arrangement: arrangement of the scene for which the edit was computed, see `morse.physics.World`.
        latest: the uses of the file, and their records after the edit.
    """

    path: str
    arrangement: int
    latest: list[tuple[ModelUse, Revision]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def summary(self) -> str:
        """Return a description of the changes for the user."""
        revisions = [revision for _, revision in self.latest]
        counts = (
            (sum(len(revision.replaced) for revision in revisions), "changed"),
            (sum(len(revision.come) for revision in revisions), "new"),
            (sum(len(revision.gone) for revision in revisions), "gone"),
        )
        return ", ".join(f"{count} {word}" for count, word in counts if count) or "nothing visible"


def prepare(simulation: Simulation, path: str) -> ModelEdit:
    """Read a file and compute its changes; may be called in another thread than the simulation.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is damaged.
        LookupError: the file does not contain any of the objects that the scene uses.
    """
    scene = simulation.scene
    edit = ModelEdit(path, simulation.world.arrangement)
    library = load(path)
    for use in [use for use in scene.models if use.path == path]:
        roots, latest = take(library, use.choice)
        if not roots:
            raise LookupError("it no longer contains any of the objects that the scene uses")
        revision = follow(scene, use, roots, latest)
        edit.latest.append((use, revision))
        edit.warnings += revision.warnings
    edit.warnings += resolve([revision for _, revision in edit.latest])
    return edit


def carry_out(simulation: Simulation, edit: ModelEdit) -> None:
    """Insert the new nodes into the running scene.

    Raises:
        ValueError: the engine refuses a shape; the scene is then unchanged.
    """
    revisions = [revision for _, revision in edit.latest]
    pairs = [pair for revision in revisions for pair in revision.replaced]
    come: list[Node] = [root for revision in revisions for root in revision.come]
    nodes: list[Node] = [node for revision in revisions for node in revision.gone]

    def rebuild(change: SceneChange) -> None:
        for revision in revisions:
            for node, place in revision.moved:
                change.move(node, place)
        for now, after in pairs:
            change.replace(now, after)
        change.remove(nodes)
        change.add(come, ())

    if pairs or come or nodes:
        world = simulation.world
        bottoms = {now.name: bottom_of(world, now) for now, _ in pairs if world.object_of(now).is_dynamic}
        world.rebuild(rebuild)
        for _, after in pairs:
            _lift(simulation, after, bottoms.get(after.name))
        simulation.population.edited(pairs, come, nodes)
    records = {id(use): revision.use for use, revision in edit.latest}
    models = simulation.scene.models
    models[:] = [records.get(id(use), use) for use in models]


def _lift(simulation: Simulation, node: Node, bottom: float | None) -> None:
    """Raise a body whose new model reaches lower than the old one, so that it does not penetrate the ground."""
    reaches = bottom_of(simulation.world, node)
    if bottom is not None and reaches is not None and reaches < bottom:
        body = simulation.world.object_of(node)
        x, y, z = body.worldPosition
        body.worldPosition = (x, y, z + bottom - reaches)


logger = logging.getLogger(__name__)

#: interval between checks of the files, wall-clock seconds
_INTERVAL = 0.2
#: time after which an unreadable file is an error; before that, it may still be being written, wall-clock seconds
_PATIENCE = 1.0
#: time to wait at the end for a thread that reads a model, wall-clock seconds
_FAREWELL = 5.0
_AT_START = "it is read again when the simulation is restarted from the live view (F11)"


class Watch(Observer):
    """Reloads models and components within about a second after they were saved.

    A thread checks the files and reads the models. The simulation changes between two ticks.

    Attributes:
        exchanged: the files of components whose latest version is running.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._script = os.path.abspath(simulation.options.script)
        self.exchanged: set[str] = set()
        self._files = SavedFiles()
        self._ready: deque[Callable[[], None]] = deque()
        self._unread: dict[str, float] = {}
        self._reading = "a saved file"
        self._stop = threading.Event()
        # the script also if it can be reloaded only later
        self._files.look([*self._watched(), self._script])
        self._thread = threading.Thread(target=self._run, name="morse watch", daemon=True)
        self._thread.start()

    def before_tick(self) -> None:
        """Apply the prepared changes."""
        while self._ready:
            self._ready.popleft()()

    def close(self) -> None:
        """Stop watching."""
        self._stop.set()
        self._thread.join(_FAREWELL)
        if self._thread.is_alive():
            logger.warning("%s is still being read after %.0f s: it is left", self._reading, _FAREWELL)

    # -- in the thread -----------------------------------------------------------------------

    def _watched(self) -> list[str]:
        project = self._simulation.scene.project
        sources = project.sources().values() if isinstance(project, ProjectImports) else ()
        scripts = [self._script] if self._simulation.reread is not None else []
        models = [use.path for use in list(self._simulation.scene.models)]
        return list(dict.fromkeys([*models, *sources, *scripts]))

    def _run(self) -> None:
        while not self._stop.wait(_INTERVAL):
            paths = self._files.look(self._watched())
            if self._script in paths:
                paths.remove(self._script)
                self._ready.append(self._script_saved)
            modules = [path for path in paths if path.endswith(".py")]
            if modules:
                self._ready.append(lambda files=modules: self._exchange(files))  # type: ignore[misc]
            now = time.monotonic()
            for path in paths:
                if not path.endswith(".py"):
                    self._unread[path] = now
            for path, since in list(self._unread.items()):
                self._read(path, last_try=now - since > _PATIENCE)

    def _read(self, path: str, *, last_try: bool) -> None:
        self._reading = path
        try:
            edit = prepare(self._simulation, path)
        except BaseException as error:
            # the file may be incomplete, or the scene has changed meanwhile
            if last_try:
                del self._unread[path]
                reason = describe(error)
                self._ready.append(lambda: self._refuse(path, reason))
            return
        del self._unread[path]
        self._ready.append(lambda: self._show(edit))

    # -- between two ticks -------------------------------------------------------------------

    def _script_saved(self) -> None:
        """A syntax error is told at once, others when the script is executed."""
        if self._simulation.edits.was_refused(self._script):
            return  # a restart was faster than this watch, and has told the error
        try:
            content = read_regular(self._script)
            compile(content, self._script, "exec", dont_inherit=True)
        except (SyntaxError, ValueError, OSError) as error:
            self._refuse(self._script, _syntax(error, self._script))
            return
        waits = not self._simulation.edits.in_use(self._script, content)
        self._simulation.edits.take(self._script, waits=waits)
        if waits:
            logger.info("%s was saved: %s", self._script, _AT_START)

    def _show(self, edit: ModelEdit) -> None:
        simulation = self._simulation
        if edit.arrangement != simulation.world.arrangement:
            self._unread[edit.path] = time.monotonic()
            return
        try:
            carry_out(simulation, edit)
        except ENDINGS:
            raise
        except BaseException as error:
            self._refuse(edit.path, describe(error))
            return
        simulation.edits.take(edit.path)
        logger.info("%s was saved: %s", Path(edit.path).name, edit.summary())
        for warning in edit.warnings:
            logger.warning("%s: %s", Path(edit.path).name, warning)
        self._changed(edit.path, "model")

    def _exchange(self, files: list[str]) -> None:
        try:
            names = exchange(self._simulation, files)
        except SystemExit as error:
            self._refuse(files[0], f"it exits the program (SystemExit: {error})")
        except SyntaxError as error:
            self._refuse(files[0], _syntax(error, files[0]))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self._refuse(files[0], str(error) if isinstance(error, MorseError) else describe(error))
        else:
            for file in files:
                self._simulation.edits.take(file, waits=not names and self._simulation.reread is not None)
            if not names:
                again = _AT_START if self._simulation.reread is not None else "it takes effect in the next simulation"
                logger.info("%s was saved: %s", files[0], again)
            for name in names:
                logger.info("%s now uses %s as saved", name, ", ".join(Path(file).name for file in files))
            if names:
                self.exchanged.update(files)
                self._changed(files[0], "class")
            else:
                self.exchanged.difference_update(files)

    def _changed(self, path: str, what: str) -> None:
        simulation = self._simulation
        simulation.journal.note(EDIT, path, what)
        guard = simulation.context.guard
        guard.tell(simulation.observers, lambda observer: observer.edited())
        guard.tell(simulation.observers, lambda observer: observer.rearranged())

    def _refuse(self, path: str, reason: str) -> None:
        self._simulation.edits.refuse(path, reason)
        logger.error(
            "[ERROR][MORSE] %s was saved, but the simulation continues with the previous version: %s",
            path,
            reason,
            extra={SHOWN: True},
        )


def _syntax(error: Exception, path: str) -> str:
    """The message of an error in the text of a file, and its place."""
    if not isinstance(error, SyntaxError):
        return describe(error)
    place = f'\n  File "{error.filename or path}", line {error.lineno}' if error.lineno else ""
    return f"{type(error).__name__}: {error.msg}{place}"
