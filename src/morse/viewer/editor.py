"""Executes the requests of the editor of the page."""

from __future__ import annotations

import hashlib
import logging
import os
from dataclasses import replace
from functools import partial
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.builder import workspace
from morse.builder.assembly.spawning import append_text, component_of, mount_of
from morse.builder.editing.changes import Addition, Changes, Move, UnwritableError
from morse.builder.editing.source import Source
from morse.builder.editing.writing import lines_of_script, variable_name
from morse.builder.names.part import Strength
from morse.builder.names.project_files import source_folders
from morse.builder.script import compiled, describing
from morse.core.clients.complaints import Complaints
from morse.core.declarations import properties
from morse.core.exceptions import MorseError
from morse.core.journal import EDIT
from morse.core.reports.faults import message
from morse.core.reports.quoting import short
from morse.scene.extent import visible_extent
from morse.viewer.catalog import Catalog
from morse.viewer.feeds.components import settings_of
from morse.viewer.object_settings import settings_of_object, whole_call
from morse.viewer.placing import (
    Place,
    carrier_of,
    free_place,
    local_pose,
    place_at,
    rounded,
    triple,
    usual_place,
    world_pose,
)
from morse.viewer.script_file import ScriptFile
from morse.viewer.uploads import Uploads, saved_place
from morse.viewer.view_messages import Answer, ComponentSettings, PropertyValue, Refused, SceneChanges
from morse.viewer.world_settings import (
    OWNER,
    Call,
    Calls,
    LiveSettings,
    check_world_call,
    is_immediate,
    lines_of,
    settings_of_world,
    with_call,
    world_line,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.scene import Node
    from morse.scene.extent import Corners
    from morse.simulation.simulation import Simulation
    from morse.viewer import page_messages as page
    from morse.viewer.page_inputs import ServiceCalls
    from morse.viewer.server import ViewServer


logger = logging.getLogger("morse.viewer")

Triple = tuple[float, float, float]

_UNSCALED: Triple = (1.0, 1.0, 1.0)
_LOCKED = "To change it here, start with morse run --edit-script; or use an editor: F11 loads what it has saved."


#: maximum number of changes of a scene, and of those that can be undone
_MOST_CHANGES = 1000
#: height over the ground of what cannot be seen, m
_OVERHEAD = 2.5
_FULL = f"the scene has {_MOST_CHANGES} changes: save and reload it before you change more"


#: what pages may call beside `properties`
_METHODS = ("frequency", "level", "noise", "delay", "phase", "alter", "add_stream")


#: where an object is, if it was added or moved
_Placed = tuple[Addition | None, Move | None]


class _Change(NamedTuple):
    what: str
    undo: Callable[[], object]
    redo: Callable[[], object]
    #: those with the same number, other than 0, one after another are undone together
    group: int


class Editor:
    """The changes of one scene, and how each is undone and made again.

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
        self._calls: dict[str, Calls] = {}
        self._group = 0
        self._undos: list[_Change] = []
        self._redos: list[_Change] = []
        options = simulation.options
        sources = [*options.source_paths, *(source_folders(Path(options.script).absolute()) if options.script else ())]
        self._catalog = Catalog(server, options.resource_paths, list(dict.fromkeys(sources)))
        self._live = LiveSettings(simulation, server)
        #: models that pages send
        self.uploads = Uploads(simulation.scene, server, services, self._catalog)
        self._saved = self._state()
        self._is_restarting = False
        #: the script that a page has written since the scene was loaded
        self._written: str | None = None
        self._last_message: SceneChanges | None = None
        self._complaints = Complaints(logger)

    # -- requests --------------------------------------------------------------------------

    def list_models(self, _event: page.ListModels) -> None:
        """Send the models that can be added."""
        self._catalog.open()

    def add(self, event: page.AddModel) -> None:
        """Add a robot or an object with its lowest point at a position, or a component to a robot."""
        self._attempt(event.request, lambda: self._add(event))

    def delete(self, event: page.DeleteObject) -> None:
        """Delete a robot, an object or a component."""
        self._attempt(event.request, lambda: self._delete(event.node), event.group)

    def duplicate(self, event: page.DuplicateObject) -> None:
        """Add a robot or an object once more, beside the first one."""
        self._attempt(event.request, lambda: self._duplicate(event.node), event.group)

    def scale(self, event: page.ScaleObject) -> None:
        """Give an object that was added another size."""
        self._attempt(event.request, lambda: self._scale(event.node, event.factors), event.group)

    def undo(self, event: page.UndoChange) -> None:
        """Undo the last change."""
        self._again_or_back(event.request, self._undos, self._redos, "undo")

    def redo(self, event: page.RedoChange) -> None:
        """Make the change again that was undone last."""
        self._again_or_back(event.request, self._redos, self._undos, "make again")

    def _again_or_back(self, request: int, source: list[_Change], target: list[_Change], what: str) -> None:
        if not source:
            self._server.send(Answer(request, False, error=f"there is no change to {what}"))
            return
        changes = [source.pop()]
        while changes[0].group and source and source[-1].group == changes[0].group:
            changes.append(source.pop())

        def make() -> str:
            for number, change in enumerate(changes):
                try:
                    (change.undo if source is self._undos else change.redo)()
                except BaseException:
                    source.extend(reversed(changes[number + 1 :]))
                    raise
                target.append(change)
            others = len(changes) - 1
            more = f", and {others} more change{'s' if others > 1 else ''}" if others else ""
            return changes[0].what + more

        self._attempt(request, make)

    def save(self, event: page.SaveScene) -> None:
        """Write the script, or only show what would be written."""
        self._attempt(event.request, lambda: self._save(write=event.write))

    def _attempt(self, request: int, action: Callable[[], object], group: int = 0) -> None:
        values: list[object] = []
        self._group = group
        if self._services.attempt(request, lambda: values.append(action())):
            self._server.send(Answer(request, True, values[0]))

    # -- adding and deleting ---------------------------------------------------------------

    def _add(self, event: page.AddModel) -> str:
        self._check_room()
        group = self._catalog.groups.get(event.model)
        if group is None:
            raise MorseError(f"there is no model '{event.model}' in the list")
        name = variable_name(event.model, self._names())
        position, angles, box, is_named = self._own_pose(event.model)
        if group in ("sensors", "actuators"):
            place = self._mount(event, group, box, angles)
            own = (position, angles, is_named)
            addition = Addition(name, event.model, place.position, place.angles, place.owner, *own, part=place.part)
        else:
            x, y, z = event.position or (0.0, 0.0, 0.0)
            # a lamp, or a camera of the world, looks down
            lowest = -_OVERHEAD if box is None else float(box[0][2])
            if event.beside and box is not None:
                x, y, z = free_place(self._simulation, (x, y, z), box, self._additions)
            at = rounded((x, y, z - lowest), 2)
            angles_now = rounded((angles[0], angles[1], angles[2] + event.yaw))
            addition = Addition(name, event.model, at, angles_now, "", position, angles, is_named)
        return self._add_together([addition])

    def _add_together(self, additions: Sequence[Addition]) -> str:
        """Add a robot or an object with its components, or a component; returns the name of the first."""
        self._add_all(additions)
        name = additions[0].scene_name
        self._undo_by(f"{name} was added", lambda: self._delete(name, undoable=False), lambda: self._add_all(additions))
        return name

    def _add_all(self, additions: Sequence[Addition]) -> None:
        for addition in additions:
            try:
                self._spawn(addition)
            except Exception:
                if addition is not additions[0]:
                    self._delete(additions[0].scene_name, undoable=False)
                raise

    def _check_room(self) -> None:
        if self._is_full:
            raise MorseError(_FULL)

    def _mount(self, event: page.AddModel, group: str, box: Corners | None, angles: Triple) -> Place:
        """Where a component goes."""
        simulation = self._simulation
        carrier = carrier_of(simulation, event.robot, self._is_known)
        if not self._belongs(self._root(carrier.name)):
            raise MorseError(f"'{carrier.name}' is not part of the scene: a client has spawned it")
        if event.position is None or (event.normal is not None and group == "actuators" and box is None):
            # what has no shape has no place of its own
            place = usual_place(simulation, carrier, group)._replace(angles=angles)
        elif event.normal is None:
            place = Place(carrier.name, "", event.position, angles)
        else:
            place = place_at(simulation, carrier, event.robot, event.position, event.normal, box, angles)
        return place._replace(position=rounded(place.position, 3), angles=rounded(place.angles))

    def _is_known(self, name: str) -> bool:
        """Whether the script, or a page, has created something as a whole: it is not part of a model."""
        if name in self._additions or self._file.path is None:
            return True
        try:
            return name in lines_of_script(self._file.text)
        except UnwritableError:
            return False

    def _duplicate(self, name: str) -> str:
        self._check_room()
        name = self._root(name).name
        original = self._additions.get(name)
        if original is None:
            raise MorseError(f"'{name}' was not added in this page: copy its lines in the script")
        names = self._names()
        parts = [original, *(one for one in self._additions.values() if _is_of(one.robot, name))]
        twins: list[Addition] = []
        owners = {original.robot: original.robot}
        for part in parts:
            word = variable_name(part.kind, names)
            names.add(word)
            twins.append(replace(part, name=word, robot=owners[part.robot]))
            owners[part.scene_name] = twins[-1].scene_name
            if calls := self._calls.get(part.scene_name):
                self._calls[twins[-1].scene_name] = dict(calls)
        if not original.robot:
            node = self._simulation.scene.find(name)
            corners = None if node is None else visible_extent(node)
            width = 1.0 if corners is None else float(corners[1][1] - corners[0][1]) + 0.3
            x, y, z = original.position
            twins[0] = replace(twins[0], position=rounded((x, y + width, z)))
        return self._add_together(twins)

    def _names(self) -> set[str]:
        import morse.builder

        names = {part for node in self._simulation.scene.nodes() for part in (node.name, *node.name.split("."))}
        names |= {*dir(morse.builder), *(one.name for one in self._additions.values())}
        try:
            return names | Source(self._file.text, "").names()
        except UnwritableError:
            return names

    def _own_pose(self, kind: str) -> tuple[Triple, Triple, Corners | None, bool]:
        """The pose that the builder gives to a model, the box around it from its origin, m, and whether it names it."""
        scene = self._simulation.scene
        with scene.project, describing(scene.resource_paths), workspace.described():
            part = component_of(kind)
            corners = visible_extent(part.scene_node)
            position, angles = triple(part.location), triple(part.rotation_euler)
            is_named = part.name_strength is Strength.GIVEN
        box = None if corners is None else (corners[0] - position, corners[1] - position)
        return position, angles, box, is_named

    def _scale(self, name: str, factors: Triple) -> str:
        name = self._root(name).name
        old = self._additions.get(name)
        if old is None or old.robot:
            raise MorseError(f"'{name}' was not added in this page as an object: write {name}.scale into the script")
        x, y, z = (round(now * factor, 4) for now, factor in zip(old.scale, factors, strict=True))
        new = replace(old, scale=(x, y, z))

        def exchange(after: Addition) -> None:
            present = self._additions[name]
            self._exchange(replace(present, scale=after.scale), self._calls.get(name, {}))

        exchange(new)
        self._undo_by(f"{name} was scaled", lambda: exchange(old), lambda: exchange(new))
        return name

    def _exchange(self, addition: Addition, calls: Calls) -> None:
        """Create an object that was added anew: with another size, or other calls."""
        name = addition.scene_name
        present, before = self._additions[name], self._calls.get(name, {})
        self._services.run("simulation", "delete", name)
        self._note(name, calls)
        try:
            self._spawn(addition)
        except Exception:
            self._note(name, before)
            self._spawn(present)
            raise

    def _class_of_object(self, name: str) -> type[AbstractComponent] | None:
        """The builder class of an object that was added; None for robots, components and what is no addition."""
        addition = self._additions.get(name)
        if addition is None or addition.robot or name in self._simulation.context.robots:
            return None
        scene = self._simulation.scene
        with scene.project, describing(scene.resource_paths), workspace.described():
            return type(component_of(addition.kind))

    def _configure_object(self, cls: type[AbstractComponent], event: page.Configure) -> str:
        """Call a method of the builder for an object that was added, or take the call back."""
        name, method = event.component, event.method
        node, old = self._simulation.scene.find(name), self._calls.get(name, {})
        values = None if node is None else whole_call(cls, node, method, event.values)
        if values is None:
            raise MorseError(f"'{short(method)}' is not a setting of {cls.__name__}")
        call = Call(method, values)
        if event.remove and call.key() not in old:
            raise MorseError(f"{method} was not set in this page: change the script")
        new = {key: one for key, one in old.items() if key != call.key()}
        if not event.remove:
            new[call.key()] = call

        def exchange(calls: Calls) -> None:
            self._exchange(self._additions[name], calls)

        exchange(new)
        what = f"{method} of {name} was {'taken back' if event.remove else 'set'}"
        self._undo_by(what, lambda: exchange(old), lambda: exchange(new))
        return name

    def _spawn(self, addition: Addition) -> None:
        name = addition.scene_name
        pose = addition.position, addition.angles
        self._appear(name, self._kind_of(addition), pose, self._calls.get(name, {}))
        self._additions[name] = addition

    @staticmethod
    def _kind_of(addition: Addition) -> str:
        """A kind with the lines for its size and for the part to which it is attached."""
        size = "" if addition.scale == _UNSCALED else f"\nscale({', '.join(map(repr, addition.scale))})"
        return addition.kind + size + (f"\n{append_text(addition.part)}" if addition.part else "")

    def _appear(self, name: str, kind: str, pose: tuple[Triple, Triple], calls: Calls) -> None:
        """Spawn a robot, an object or a component; a component without a kind is one of the script."""
        lines = "\n".join([kind, *lines_of(calls)]) if kind and calls else kind or "\n".join(["", *lines_of(calls), ""])
        self._services.run("simulation", "spawn", name, lines, *map(list, pose))

    def _delete(self, name: str, *, undoable: bool = True) -> str:
        root = self._root(name)
        if owner := self._placed_by(root):
            raise MorseError(f"'{root.name}' comes with '{owner}': only both together can be deleted")
        if not self._belongs(root):
            return self._delete_guest(root.name, undoable=undoable)
        # a robot goes with everything on it
        is_robot, is_component = root.name in self._simulation.context.robots, root.parent is not None
        below = [] if is_robot or is_component else [node.name for node in root.walk()][1:]
        addition = self._additions.get(root.name)
        if addition is None and self._file.path is not None:
            self._file.changed(Changes(deletions={root.name: below}))  # can it be saved?
        pose = triple(root.location), triple(root.rotation_euler)
        own = [one for table in self._tables() for one in table if _is_of(one, root.name)]
        before = [{one: table[one] for one in own if one in table} for table in self._tables()]
        self._services.run("simulation", "delete", root.name)
        for table in self._tables():
            for one in own:
                table.pop(one, None)
        if addition is None:
            self._deletions[root.name] = below
        if undoable:
            self._undo_by(
                f"{root.name} was deleted",
                lambda: self._bring_back(root.name, pose, before),
                lambda: self._delete(root.name, undoable=False),
            )
        return root.name

    def _tables(self) -> tuple[dict[str, Any], ...]:
        return self._additions, self._moves, self._deletions, self._calls

    def _belongs(self, root: Node) -> bool:
        """Whether an object is part of the scene: those that clients have spawned leave with the run."""
        while root.parent is not None and root.name not in self._additions:
            root = root.parent
        return root.name in self._additions or root.name in self._simulation.population.roots_at_launch()

    def _placed_by(self, node: Node) -> str:
        """The name of the component that places an object when the simulation starts, or nothing."""
        return next((one.name for one in self._simulation.scene.components if node in one.placed), "")

    def _delete_guest(self, name: str, *, undoable: bool) -> str:
        """Delete an object that a client has spawned."""
        came = self._simulation.population.get_state()["came"]
        self._services.run("simulation", "delete", name)
        for guest, kind, position, angles in came:
            if guest == name and kind and undoable:
                again = partial(self._services.run, "simulation", "spawn", name, kind, position, angles)
                self._undo_by(f"{name} was deleted", again, partial(self._delete_guest, name, undoable=False))
        return name

    def _undo_by(self, what: str, undo: Callable[[], object], redo: Callable[[], object]) -> None:
        self._undos.append(_Change(what, undo, redo, self._group))
        del self._undos[:-_MOST_CHANGES]
        self._redos.clear()

    @property
    def _is_full(self) -> bool:
        return self._count() >= _MOST_CHANGES

    def _count(self) -> int:
        own = sum(len(calls) for name, calls in self._calls.items() if name not in self._additions)
        return len(self._additions) + len(self._moves) + len(self._deletions) + own

    def _root(self, name: str) -> Node:
        """The object or the component to which a node belongs."""
        node = self._simulation.scene.find(name)
        if node is None:
            raise MorseError(f"there is no object '{name}'")
        while node.parent is not None and node.name not in self._simulation.context.components:
            node = node.parent
        return node

    def _bring_back(self, name: str, pose: tuple[Triple, Triple], before: list[dict[str, Any]]) -> None:
        additions, moves, deletions, calls = before
        self._calls |= calls
        if name in additions:
            self._spawn(additions[name])
        elif "." in name and name in self._calls:
            self._appear(name, "", pose, self._calls[name])
        else:
            population = self._simulation.population
            self._simulation.journal.note(EDIT, name, "brought back")
            present = population.get_state()
            back = {name, *population.placed_at_launch(name)}
            population.set_state({**present, "gone": [one for one in present["gone"] if one not in back]})
        self._deletions.pop(name, None)
        self._deletions |= deletions
        for part, addition in additions.items():
            if part != name:
                self._spawn(addition)
        for part in calls:
            if part != name and part not in additions and "." in part:
                self._compose(part, calls[part])
        for moved, move in moves.items():
            self._moves[moved] = move
            self._place(moved, move.position, move.angles)

    # -- settings of components --------------------------------------------------------------

    def set_property(self, event: page.SetProperty) -> None:
        """A page has set a property of a component: the script gets it as well."""
        self._group = 0
        component = self._simulation.context.component(event.component)
        declared = {one.name: python_name for python_name, one in properties(type(component)).items()}
        before = getattr(component, declared[event.name]) if event.name in declared else None
        if not self._services.set_property(event) or not self._belongs(self._root(event.component)):
            return
        call = Call("properties", {event.name: event.value})
        old = self._calls.get(event.component, {})
        new = {**old, call.key(): call}
        first = old.get(call.key())

        def change(value: object, calls: Calls) -> None:
            self._services.run(event.component, "set_property", event.name, value)
            self._server.send(PropertyValue(event.component, event.name, value))
            self._note(event.component, calls)

        self._note(event.component, new)
        self._undo_by(
            f"{event.name} of {event.component} was set",
            lambda: change(first.values[event.name] if first is not None else before, old),
            lambda: change(event.value, new),
        )

    def configure(self, event: page.Configure) -> None:
        """Call a method of the builder for a component, or take the call back."""
        self._attempt(event.request, lambda: self._configure(event))

    def _set_up_world(self, event: page.Configure) -> str:
        """Set up the environment: at once, or from the next start on; see `world_settings`."""
        old = self._calls.get(OWNER, {})
        new = with_call(old, event.method, event.values, remove=event.remove)
        if not event.remove:
            self._check_room()
            check_world_call(event.method, event.values, self._simulation.scene.settings)
            if self._file.path is not None:
                self._file.changed(Changes(settings=[world_line(*one) for one in new.values()]))  # can it be saved?
        self._settle(new)
        what = f"{event.method} was {'taken back' if event.remove else 'set'}"
        self._undo_by(what, lambda: self._settle(old), lambda: self._settle(new))
        return OWNER

    def _settle(self, calls: Calls) -> None:
        self._live.follow([(call.method, call.values) for call in calls.values()])
        self._note(OWNER, calls)

    def _configure(self, event: page.Configure) -> str:
        if event.component == OWNER:
            return self._set_up_world(event)
        if odd := [name for name in event.values if name and (not name.isidentifier() or iskeyword(name))]:
            raise MorseError(f"'{short(odd[0])}' is not a name of an argument")
        if (cls := self._class_of_object(event.component)) is not None:
            return self._configure_object(cls, event)
        if event.method not in _METHODS:
            raise MorseError(f"'{event.method}' is not a setting of a component: there are {', '.join(_METHODS)}")
        name, call = event.component, Call(event.method, event.values)
        declared = next((d for d in self._simulation.scene.components if d.name == name), None)
        if declared is None or declared.kind not in ("sensor", "actuator"):
            raise MorseError(f"there is no sensor or actuator '{name}'")
        if not self._belongs(self._root(name)):
            raise MorseError(f"'{name}' is not part of the scene: a client has spawned its robot")
        if not event.remove:
            self._check_room()
        old = self._calls.get(name, {})
        if event.remove and call.key() not in old:
            raise MorseError(f"{event.method} was not set in this page: change the script")
        new = {key: one for key, one in old.items() if key != call.key()}
        if not event.remove:
            new[call.key()] = call
        addition = self._additions.get(name)
        if addition is None and self._file.path is not None and new:
            self._file.changed(Changes(calls={name: lines_of(new)}))  # can it be saved?
        self._compose(name, new)
        what = f"{event.method} of {name} was {'taken back' if event.remove else 'set'}"
        self._undo_by(what, lambda: self._compose(name, old), lambda: self._compose(name, new))
        return name

    def _compose(self, name: str, calls: Calls) -> None:
        """Create a component anew, with other calls."""
        node, addition = self._simulation.scene.find(name), self._additions.get(name)
        if node is None:
            raise MorseError(f"there is no component '{name}'")
        declared = {one.node for one in self._simulation.scene.components}
        own = {one.scene_name for one in self._additions.values()}
        carried = [one.name for one in node.walk() if one is not node and one in declared and one.name not in own]
        if addition is None and carried:
            raise MorseError(f"'{name}' carries {', '.join(carried)}: write its settings into the script")
        placed = addition or self._moves.get(name)
        at = (node.location, node.rotation_euler) if placed is None else (placed.position, placed.angles)
        kind, pose = "" if addition is None else self._kind_of(addition), (triple(at[0]), triple(at[1]))
        parts = [one for one in self._additions.values() if _is_of(one.robot, name)]
        self._services.run("simulation", "delete", name)
        try:
            self._appear(name, kind, pose, calls)
        except Exception:
            self._appear(name, kind, pose, self._calls.get(name, {}))
            raise
        finally:
            for part in parts:
                self._spawn(part)
        self._note(name, calls)

    def _note(self, name: str, calls: Calls) -> None:
        if calls:
            self._calls[name] = calls
        else:
            self._calls.pop(name, None)

    def list_settings(self, event: page.ListSettings) -> None:
        """Tell pages what can be set for a component."""
        own = [*self._calls.get(event.component, {}).values()]
        scene = self._simulation.scene
        name = event.component
        if name == OWNER:
            settings: ComponentSettings | None = settings_of_world(scene, own)
        elif (cls := self._class_of_object(name)) is not None and (node := scene.find(name)) is not None:
            settings = settings_of_object(name, cls, node, own)
        else:
            settings = settings_of(self._simulation, name, own)
        if settings is not None:
            self._server.send(settings)

    # -- moving ----------------------------------------------------------------------------

    def moved(self, event: page.Teleport) -> None:
        """A page has moved an object."""
        node = self._simulation.scene.find(event.node)
        if node is None or (node.parent is not None and event.node not in self._simulation.context.components):
            return
        if not self._belongs(node) or self._placed_by(node):
            return
        if self._is_full and event.node not in self._moves and event.node not in self._additions:
            self._server.send(Refused("teleport", _FULL))
            return
        name = event.node
        addition, move = self._additions.get(name), self._moves.get(name)
        old = addition or move
        near = node.rotation_euler if old is None else old.angles
        position, angles = local_pose(self._simulation, node, event.position, event.quaternion, near)
        position, angles = rounded(position), rounded(angles)
        if event.first:
            self._group = event.group
            self._undo_of_move(name, (addition, move), (triple(node.location), triple(node.rotation_euler)))
        if addition is not None:
            self._additions[name] = replace(addition, position=position, angles=angles)
        else:
            # a component at the tip of an arm is there because the script places it nowhere
            is_at_tip = node.parent_inverse is not None and self._is_at_tip(name, node)
            before = (0.0, 0.0, 0.0) if is_at_tip else triple(node.location)
            self._moves[name] = Move(name, position, angles, before, triple(node.rotation_euler))

    def _is_at_tip(self, name: str, node: Node) -> bool:
        owner = name.rpartition(".")[0]
        carrier = next((one for one in self._simulation.scene.components if one.name == owner), None)
        return carrier is not None and [*node.location] == [*mount_of(carrier).usual]

    def _undo_of_move(self, name: str, before: _Placed, at_launch: tuple[Triple, Triple]) -> None:
        later: list[_Placed] = []

        def undo() -> None:
            later[:] = [(self._additions.get(name), self._moves.get(name))]
            self._put_back(name, before, at_launch)

        self._undo_by(f"{name} was moved", undo, lambda: self._put_back(name, later[0], at_launch))

    def _put_back(self, name: str, placed: _Placed, at_launch: tuple[Triple, Triple]) -> None:
        addition, move = placed
        if addition is not None:
            self._additions[name] = addition
            self._place(name, addition.position, addition.angles)
        elif move is not None:
            self._moves[name] = move
            self._place(name, move.position, move.angles)
        else:
            self._moves.pop(name, None)
            self._place(name, *at_launch)

    def _place(self, name: str, position: Triple, angles: Triple) -> None:
        node = self._simulation.scene.find(name)
        if node is None:
            raise MorseError(f"there is no object '{name}'")
        place, quaternion = world_pose(self._simulation, node, position, angles)
        self._services.run("simulation", "set_object_pose", name, place, quaternion)

    # -- the script ------------------------------------------------------------------------

    def show_script(self, event: page.ShowScript) -> None:
        """Send the script with the changes, and where it describes what."""
        self._attempt(event.request, self._script)

    def _script(self) -> dict[str, object]:
        text = self._shown()
        try:
            lines = lines_of_script(text)
        except UnwritableError:  # what a page has written has a mistake
            lines = {}
        return {
            "file": "" if self._file.path is None else self._file.path.name,
            "text": text,
            "lines": lines,
            "locked": "" if self._simulation.options.edit_script else _LOCKED,
            "version": _version(text),
        }

    def _shown(self) -> str:
        """The script that a save would write, or that a page has written and that does not run yet."""
        return self._changed() if self._written is None else self._written

    def change_script(self, event: page.ChangeScript) -> None:
        """Write another text in place of the script, or show what would be written."""
        self._attempt(event.request, lambda: self._change_script(event.text, event.version, write=event.write))

    def _change_script(self, text: str, version: str, *, write: bool) -> dict[str, object]:
        if not self._simulation.options.edit_script:
            raise MorseError(_LOCKED)
        if version != _version(self._shown()):
            raise MorseError("the scene was changed meanwhile: copy your lines, discard them, and insert them again")
        assert self._file.path is not None
        line, error = _mistake(text, self._file.path.name)
        kinds = [addition.kind for addition in self._additions.values()]
        if write and not error:
            self.uploads.save(kinds, self._file.path)
            self._file.save(text)
            self._written = text
        folders = [str(saved_place(folder, self._file.path)) for folder in self.uploads.folders(kinds)]
        runs = os.path.abspath(self._simulation.options.script) == str(self._file.path)
        shown = {"path": str(self._file.path), "difference": self._file.difference(text), "folders": folders}
        return {**shown, "line": line, "error": error, "runs": runs}

    def _changed(self) -> str:
        """The script with all changes.

        Raises:
            UnwritableError: a change cannot be written.
        """
        if self._written is not None:
            raise UnwritableError(
                f"{self._file.path} was changed in the page and does not run yet: correct its mistakes, reload it (F11)"
            )
        additions = [
            replace(one, calls=tuple(lines_of(self._calls.get(name, {})))) for name, one in self._additions.items()
        ]
        parts = {name: own for name, own in self._calls.items() if name not in self._additions and name != OWNER}
        calls = {name: lines_of(own) for name, own in parts.items()}
        settings = [world_line(*call) for call in self._calls.get(OWNER, {}).values()]
        return self._file.changed(Changes(additions, [*self._moves.values()], self._deletions, calls, settings))

    # -- saving ----------------------------------------------------------------------------

    def _save(self, *, write: bool) -> dict[str, object]:
        text = self._changed()
        difference = self._file.difference(text)
        assert self._file.path is not None
        kinds = [addition.kind for addition in self._additions.values()]
        if write:
            self.uploads.save(kinds, self._file.path)
            content = self._file.save(text)
            if all(is_immediate(call.method) for call in self._calls.get(OWNER, {}).values()):
                # others are not in use yet: then a page offers to load the script
                self._simulation.edits.write(os.path.abspath(str(self._file.path)), content)
            self._saved = self._state()
        folders = [str(saved_place(folder, self._file.path)) for folder in self.uploads.folders(kinds)]
        return {"path": str(self._file.path), "difference": difference, "folders": folders}

    def _state(self) -> str:
        """All changes, to compare them with those that were saved."""
        return repr(self._tables())

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
            if not self._again(f"{name} is not added", partial(self._spawn, addition)):
                del self._additions[name]
        for name, calls in [*self._calls.items()]:
            if (
                name not in self._additions
                and name != OWNER
                and not self._again(f"the settings of {name} are not made", partial(self._set_again, name, calls))
            ):
                del self._calls[name]
        for name, move in [*self._moves.items()]:
            place = partial(self._place, name, move.position, move.angles)
            if not self._again(f"{name} is not moved", place):
                del self._moves[name]

    def _set_again(self, name: str, calls: Calls) -> None:
        if name in self._simulation.context.robots:
            for call in calls.values():
                for prop, value in call.values.items():
                    self._services.run(name, "set_property", prop, value)
        else:
            self._compose(name, calls)

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
        self.uploads.update()
        count = self._count()
        # without the changes that were saved, the file is to be written again
        count = 0 if self._state() == self._saved else max(count, 1)
        last, later = (changes[-1].what if changes else "" for changes in (self._undos, self._redos))
        message = SceneChanges(count, last, later, "" if self._file.path is None else self._file.path.name)
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)

    def close(self) -> None:
        """End the drawing of pictures, and delete the files that pages have sent."""
        self._catalog.close()
        self.uploads.close()


def _version(text: str) -> str:
    return hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest()[:16]


def _mistake(text: str, name: str) -> tuple[int, str]:
    """The line of a text that is not Python, and why; 0 and nothing if it is."""
    try:
        compiled(text, name)
    except SyntaxError as error:
        return error.lineno or 1, error.msg
    except (ValueError, RecursionError, MemoryError, OverflowError) as error:  # zeros, deep nesting, long numbers
        return 1, str(error) or "it is nested too deeply"
    return 0, ""


def _is_of(name: str, whole: str) -> bool:
    return name == whole or name.startswith(f"{whole}.")
