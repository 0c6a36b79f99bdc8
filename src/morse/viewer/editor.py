"""Executes the requests of the editor of the page."""

from __future__ import annotations

import base64
import json
import logging
import os
import queue
import subprocess
import threading
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from morse.builder import workspace
from morse.builder.assembly.spawning import component_of
from morse.builder.editing.changes import Addition, Changes, Move, UnwritableError
from morse.builder.editing.source import Source
from morse.builder.editing.writing import variable_name
from morse.builder.names.project_files import source_folders
from morse.builder.script import describing
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseError
from morse.core.journal import EDIT
from morse.core.reports.faults import message
from morse.core.reports.quoting import short
from morse.mathutils.rotations import compatible_euler, rotation_from_quaternion
from morse.scene.extent import visible_extent
from morse.system.workers import command
from morse.viewer.script_file import ScriptFile
from morse.viewer.view_messages import Answer, Model, ModelPicture, Models, Refused, SceneChanges

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.scene import Node
    from morse.simulation.simulation import Simulation
    from morse.viewer import page_messages as page
    from morse.viewer.page_inputs import ServiceCalls
    from morse.viewer.server import ViewServer


# The models that the page offers, with their pictures, which another process draws.

_PROGRAM = "morse.launch.model_pictures"
#: maximum number of bytes of a line that classes of the project print
_LONGEST_LINE = 400

logger = logging.getLogger("morse.viewer")


class Catalog:
    """Lists models when a page asks for them first.

    What the classes of the project print in the other process is logged.

    Args:
        folders: of the models of the project.
        sources: folders of its packages.

    Attributes:
        groups: the group of each kind: ``robots``, ``sensors``, or another one for objects.
    """

    def __init__(self, server: ViewServer, folders: Sequence[str], sources: Sequence[str] = ()) -> None:
        self._server = server
        self._arguments = [json.dumps([*paths]) for paths in (folders, sources)]
        self._process: subprocess.Popen[bytes] | None = None
        self._lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._printed = ""
        self._complaints = Complaints(logger)
        self.groups: dict[str, str] = {}

    def open(self) -> None:
        """Start to list the models, unless that has been done.

        Raises:
            OSError: the process cannot be started.
        """
        if self._process is not None and (self.groups or self._process.poll() is None):
            return
        self._process = process = subprocess.Popen(
            command(_PROGRAM, *self._arguments),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert process.stdout is not None
        assert process.stderr is not None
        for name, read in (("models", self._read), ("what models print", self._log)):
            stream = process.stdout if read == self._read else process.stderr
            threading.Thread(target=read, args=[process, stream], name=name, daemon=True).start()

    def _read(self, process: subprocess.Popen[bytes], stream: IO[bytes]) -> None:
        for line in stream:
            self._lines.put(line)
        if process.wait() > 0:
            self._lines.put(b"")

    def _log(self, process: subprocess.Popen[bytes], stream: IO[bytes]) -> None:
        while line := stream.readline(_LONGEST_LINE):
            if text := short(line.decode(errors="replace").rstrip(), _LONGEST_LINE):
                self._printed = text
                self._complaints.log(logging.INFO, text, f"the list of models: {text}")

    def update(self) -> None:
        """Send the pages what has been drawn."""
        while not self._lines.empty():
            line = self._lines.get()
            if line:
                self._take(json.loads(line))
            else:
                text = f"The list of models is not complete: its process has failed. {self._printed}".rstrip()
                self._complaints.warn("failed", text)
                self._server.send(Refused("list_models", text))

    def _take(self, content: Any) -> None:
        if isinstance(content, list):
            models = [Model(one["kind"], one["name"], one["group"]) for one in content]
            self.groups = {model.kind: model.group for model in models}
            self._server.send(Models(models))
        else:
            url = self._server.offer("pictures", "image/webp", base64.b64decode(content["picture"]))
            self._server.send(ModelPicture(content["kind"], url))

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()


Triple = tuple[float, float, float]


#: maximum number of changes of a scene, and of those that can be undone
_MOST_CHANGES = 1000
_FULL = f"the scene has {_MOST_CHANGES} changes: save and reload it before you change more"


class Editor:
    """The changes of one scene, and how each is undone.

    A restart of the simulation makes the changes again: they belong to the scene, not to the run.
    """

    def __init__(self, simulation: Simulation, server: ViewServer, services: ServiceCalls) -> None:
        self._simulation = simulation
        self._server = server
        self._services = services
        self._file = ScriptFile(simulation.options.script)
        self._additions: dict[str, Addition] = {}
        self._moves: dict[str, Move] = {}
        self._deletions: dict[str, list[str]] = {}
        self._undos: list[tuple[str, Callable[[], object]]] = []
        options = simulation.options
        sources = [*options.source_paths, *(source_folders(Path(options.script).absolute()) if options.script else ())]
        self._catalog = Catalog(server, options.resource_paths, list(dict.fromkeys(sources)))
        self._saved = self._state()
        self._is_restarting = False
        self._last_message: SceneChanges | None = None
        self._complaints = Complaints(logger)

    # -- requests --------------------------------------------------------------------------

    def list_models(self, _event: page.ListModels) -> None:
        """Send the models that can be added."""
        self._catalog.open()

    def add(self, event: page.AddModel) -> None:
        """Add a robot or an object with its lowest point at a position, or a sensor to a robot."""
        self._attempt(event.request, lambda: self._add(event))

    def delete(self, event: page.DeleteObject) -> None:
        """Delete a robot or an object."""
        self._attempt(event.request, lambda: self._delete(event.node))

    def undo(self, event: page.UndoChange) -> None:
        """Undo the last change."""
        if self._undos:
            what, undo = self._undos.pop()
            self._attempt(event.request, lambda: (undo(), what)[1])
        else:
            self._server.send(Answer(event.request, False, error="there is no change to undo"))

    def save(self, event: page.SaveScene) -> None:
        """Write the script, or only show what would be written."""
        self._attempt(event.request, lambda: self._save(write=event.write))

    def _attempt(self, request: int, action: Callable[[], object]) -> None:
        values: list[Any] = []
        if self._services.attempt(request, lambda: values.append(action())):
            self._server.send(Answer(request, True, values[0]))

    # -- adding and deleting ---------------------------------------------------------------

    def _add(self, event: page.AddModel) -> str:
        if self._is_full:
            raise MorseError(_FULL)
        group = self._catalog.groups.get(event.model)
        if group is None:
            raise MorseError(f"there is no model '{event.model}' in the list")
        name = variable_name(event.model, self._names())
        position, angles, lowest = self._own_pose(event.model)
        if group == "sensors":
            if event.robot not in self._simulation.context.robots:
                raise MorseError("drop a sensor on a robot")
            place = _rounded(event.position, 2)
            self._additions[name] = Addition(name, event.model, place, angles, event.robot, position, angles)
            self._undo_by(f"{event.robot}.{name} was added", lambda: self._additions.pop(name, None))
            return name
        x, y, z = event.position
        place = _rounded((x, y, z - lowest), 2)
        angles_now = _rounded((angles[0], angles[1], angles[2] + event.yaw))
        self._spawn(Addition(name, event.model, place, angles_now, "", position, angles))
        self._undo_by(f"{name} was added", lambda: self._delete(name, undoable=False))
        return name

    def _names(self) -> set[str]:
        import morse.builder

        names = {node.name for node in self._simulation.scene.nodes()} | {*dir(morse.builder), *self._additions}
        try:
            return names | Source(self._file.text, "").names()
        except UnwritableError:
            return names

    def _own_pose(self, kind: str) -> tuple[Triple, Triple, float]:
        """The pose that the builder gives to a model, and its lowest point over its origin, m."""
        scene = self._simulation.scene
        with scene.project, describing(scene.resource_paths), workspace.described():
            part = component_of(kind)
            corners = visible_extent(part.scene_node)
            position, angles = _triple(part.location), _triple(part.rotation_euler)
        return position, angles, 0.0 if corners is None else float(corners[0][2]) - position[2]

    def _spawn(self, addition: Addition) -> None:
        pose = [*addition.position], [*addition.angles]
        self._services.run("simulation", "spawn", addition.name, addition.kind, *pose)
        self._additions[addition.name] = addition

    def _delete(self, name: str, *, undoable: bool = True) -> str:
        root = self._root(name)
        if not self._belongs(root):
            return self._delete_guest(root.name, undoable=undoable)
        # a robot goes with everything on it
        is_robot = root.name in self._simulation.context.robots
        below = [] if is_robot else [node.name for node in root.walk()][1:]
        additions = {one.name: one for one in self._additions.values() if one.robot == root.name}
        addition, move = self._additions.get(root.name), self._moves.get(root.name)
        if addition is None and self._file.path is not None:
            self._file.changed(Changes(deletions={root.name: below}))  # can it be saved?
        self._services.run("simulation", "delete", root.name)
        for part in (*additions, root.name):
            self._additions.pop(part, None)
        self._moves.pop(root.name, None)
        if addition is None:
            self._deletions[root.name] = below
        if undoable:
            self._undo_by(f"{root.name} was deleted", lambda: self._bring_back(root.name, addition, move, additions))
        return root.name

    def _belongs(self, root: Node) -> bool:
        """Whether an object is part of the scene: those that clients have spawned leave with the run."""
        population = self._simulation.population
        return root.name in self._additions or root.parent is not None or root.name in population.roots_at_launch()

    def _delete_guest(self, name: str, *, undoable: bool) -> str:
        """Delete an object that a client has spawned."""
        came = self._simulation.population.get_state()["came"]
        self._services.run("simulation", "delete", name)
        for guest, kind, position, angles in came:
            if guest == name and kind and undoable:
                again = partial(self._services.run, "simulation", "spawn", name, kind, position, angles)
                self._undo_by(f"{name} was deleted", again)
        return name

    def _undo_by(self, what: str, undo: Callable[[], object]) -> None:
        self._undos.append((what, undo))
        del self._undos[:-_MOST_CHANGES]

    @property
    def _is_full(self) -> bool:
        return len(self._additions) + len(self._moves) + len(self._deletions) >= _MOST_CHANGES

    def _root(self, name: str) -> Node:
        """The object to which a node belongs; a component of a robot is no object."""
        node = self._simulation.scene.find(name)
        if node is None:
            raise MorseError(f"there is no object '{name}'")
        while node.parent is not None and node.name not in self._simulation.context.components:
            node = node.parent
        return node

    def _bring_back(
        self, name: str, addition: Addition | None, move: Move | None, additions: dict[str, Addition]
    ) -> None:
        if addition is not None:
            self._spawn(addition)
        else:
            population = self._simulation.population
            self._simulation.journal.note(EDIT, name, "brought back")
            present = population.get_state()
            population.set_state({**present, "gone": [one for one in present["gone"] if one != name]})
            self._deletions.pop(name, None)
        self._additions |= additions
        if move is not None:
            self._moves[name] = move
            self._place(name, move.position, move.angles)

    # -- moving ----------------------------------------------------------------------------

    def moved(self, event: page.Teleport) -> None:
        """A page has moved an object."""
        node = self._simulation.scene.find(event.node)
        if node is None or node.parent is not None or not self._belongs(node):
            return
        if self._is_full and event.node not in self._moves and event.node not in self._additions:
            self._server.send(Refused("teleport", _FULL))
            return
        name, position = event.node, _rounded(event.position)
        addition, move = self._additions.get(name), self._moves.get(name)
        old = addition or move
        near = node.rotation_euler if old is None else old.angles
        angles = _rounded(compatible_euler(rotation_from_quaternion(*event.quaternion), "XYZ", list(near)))
        if event.first:
            self._undo_by(f"{name} was moved", lambda: self._put_back(name, addition, move))
        if addition is not None:
            self._additions[name] = replace(addition, position=position, angles=angles)
        else:
            self._moves[name] = Move(name, position, angles, _triple(node.location), _triple(node.rotation_euler))

    def _put_back(self, name: str, addition: Addition | None, move: Move | None) -> None:
        node = self._simulation.scene.find(name)
        if node is None:
            raise MorseError(f"there is no object '{name}'")
        if addition is not None:
            self._additions[name] = addition
            self._place(name, addition.position, addition.angles)
        elif move is not None:
            self._moves[name] = move
            self._place(name, move.position, move.angles)
        else:
            self._moves.pop(name, None)
            self._place(name, _triple(node.location), _triple(node.rotation_euler))

    def _place(self, name: str, position: Triple, angles: Triple) -> None:
        from morse.mathutils import Euler

        quaternion = Euler(angles).to_quaternion()
        self._services.run("simulation", "set_object_pose", name, [*position], [*quaternion])

    # -- saving ----------------------------------------------------------------------------

    def _save(self, *, write: bool) -> dict[str, str]:
        text = self._file.changed(Changes([*self._additions.values()], [*self._moves.values()], self._deletions))
        difference = self._file.difference(text)
        if write:
            content = self._file.save(text)
            if not self._waiting():
                self._simulation.edits.write(os.path.abspath(str(self._file.path)), content)
            self._saved = self._state()
        return {"path": str(self._file.path), "difference": difference}

    def _waiting(self) -> list[str]:
        """The sensors that appear when the scene is loaded again."""
        return [f"{one.robot}.{one.name}" for one in self._additions.values() if one.robot]

    def _state(self) -> str:
        """All changes, to compare them with those that were saved."""
        return repr((self._additions, self._moves, self._deletions))

    # -- the view --------------------------------------------------------------------------

    def restarted(self) -> None:
        """The simulation has restarted without its changes."""
        self._is_restarting = True

    def change_again(self) -> None:
        """Make the changes again after a restart."""
        if not self._is_restarting:
            return
        self._is_restarting = False
        for name in [*self._deletions]:
            if not self._again(f"{name} is not deleted", partial(self._services.run, "simulation", "delete", name)):
                del self._deletions[name]
        for name, addition in [*self._additions.items()]:
            if not addition.robot and not self._again(f"{name} is not added", partial(self._spawn, addition)):
                del self._additions[name]
        for name, move in [*self._moves.items()]:
            place = partial(self._place, name, move.position, move.angles)
            if not self._again(f"{name} is not moved", place):
                del self._moves[name]

    def _again(self, consequence: str, change: Callable[[], object]) -> bool:
        """Make a change again; returns whether that was possible."""
        try:
            change()
        except Exception as error:  # of the change alone: the others are made nevertheless
            text = f"{consequence} again: {short(message(error), 500)}"
            self._complaints.warn(consequence, f"live view: {text}")
            self._server.send(Refused("reset", text))
            return False
        return True

    def update(self) -> None:
        """Tell the pages what has changed."""
        self._catalog.update()
        count = len(self._additions) + len(self._moves) + len(self._deletions)
        # without the changes that were saved, the file is to be written again
        count = 0 if self._state() == self._saved else max(count, 1)
        last = self._undos[-1][0] if self._undos else ""
        message = SceneChanges(count, last, self._waiting(), "" if self._file.path is None else self._file.path.name)
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)

    def close(self) -> None:
        """End the drawing of pictures."""
        self._catalog.close()


def _triple(values: Sequence[float]) -> Triple:
    x, y, z = values
    return x, y, z


def _rounded(values: Sequence[float], decimals: int = 4) -> Triple:
    x, y, z = (round(value, decimals) for value in values)
    return x, y, z
