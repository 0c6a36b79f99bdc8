"""Spawning and deletion of robots and objects while a simulation runs."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import PurePath
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict, TypeVar

from morse.assets.collision import resolve_shapes
from morse.assets.formats import suffixes
from morse.assets.search import available, project_dirs
from morse.builder.assembly.spawning import (
    Mount,
    Newcomer,
    component_again,
    component_of,
    describe_component,
    describe_newcomer,
    mount_of,
    object_maker,
    part_and_calls,
    split_kind,
)
from morse.builder.names import catalog
from morse.builder.script import describing
from morse.core.context import acting
from morse.core.exceptions import MorseBuilderError
from morse.core.reports.quoting import nearest, short, shown
from morse.core.state import StateError
from morse.core.validation.names import check_component_name, check_name
from morse.helpers.descriptions import is_description
from morse.recording.made.made import Made
from morse.scene import Scene
from morse.simulation.loader import connect, load_components

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from morse.core.object import Object
    from morse.core.overlay import MorseOverlay
    from morse.core.world import Body
    from morse.physics.state.scene_change import SceneChange
    from morse.scene import ComponentDeclaration, Node, Zone
    from morse.simulation.simulation import Simulation

_T = TypeVar("_T")
_NO_MAKERS: Mapping[str, Callable[[], object]] = MappingProxyType({})
#: maximum number of objects in a scene, so that clients cannot exhaust the memory
_MOST_ROOTS = 20_000
#: of what a client spawns at once: all others wait for the 2 ms that a component takes; hands have 92 sensors of touch
_MOST_COMPONENTS = 200
#: components of robots that clients add one by one: restoring a state creates them one after the other
_MOST_ADDED = 500
#: of the text of a client, s: all robots are moved at the shortest step
_SHORTEST_STEP = 0.0005
#: largest number of vertices of the deformable bodies of what a client spawns: each costs half a microsecond a
#: step, and such bodies have many steps in a tick
_MOST_VERTICES = 1000


def _is_number(value: object) -> bool:
    """Whether a value is a finite number that fits a float; a bool is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) < 1e300


class PopulationState(TypedDict):
    """The spawned objects, each as name, kind, position and rotation, and the names of the deleted objects."""

    came: list[list[Any]]
    gone: list[str]


class Recipe(NamedTuple):
    """How a spawned object was created: kind, position, rotation, and its root objects."""

    kind: str | Callable[[], object]
    position: list[float]
    rotation: list[float]
    roots: tuple[str, ...] = ()

    def gives(self, other: Recipe | None) -> bool:
        """Whether another recipe creates the same objects."""
        if other is None:
            return False
        same = self.kind == other.kind or (callable(self.kind) and not other.kind)
        return same and (self.position, self.rotation) == (other.position, other.rotation)


class Absentee(NamedTuple):
    """A component of the launch that was deleted.

    Attributes:
        parent: the name of the parent of its node.
        pixels: what the budget of sensing allows for it.
    """

    node: Node
    parent: str
    pixels: float


class Population:
    """The present robots and objects of a simulation, and those at its launch.

    Attributes:
        check_kind: called with the kind of each object that is spawned by the name of a robot or of a model; raises an
            error to refuse it.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        scene = simulation.scene
        self._launch: tuple[list[Node], list[ComponentDeclaration], list[Zone]] = (
            list(scene.roots),
            list(scene.components),
            list(scene.zones),
        )
        self._recipes: dict[str, Recipe] = {}
        self._absentees: dict[str, Absentee] = {}
        parents = {d.node.parent for d in scene.components if d.node.parent is not None}
        #: the children of what carries components, at the launch
        self._children = {parent.name: [child.name for child in parent.children] for parent in parents}
        self.check_kind: Callable[[str], object] = _accept
        self._kinds: dict[str, str] = {}

    # -- spawning --------------------------------------------------------------------------

    def check(self, name: object, kind: object, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Check what is to be spawned, whoever asks: a program, a client, a page, a saved state or a recording.

        A name with a dot, such as ``robot.camera`` or ``robot.arm.camera``, is that of a component of a robot.

        Raises:
            MorseBuilderError: the name is invalid, reserved or that of something else, the kind is neither a name nor a
                function, the pose is invalid, or there are too many objects.
        """
        scene = self._simulation.scene
        carrier = self._carrier_of(name)
        if carrier is None:
            check_name(name, self._addressed())
        else:
            assert isinstance(name, str)
            own = (one.rpartition(".") for one in self._addressed())
            check_name(name.rpartition(".")[2], [word for owner, _, word in own if owner == carrier.name])
        assert isinstance(name, str)
        if scene.find(name) is not None:
            raise MorseBuilderError(f"there is already an object '{short(name)}' in the scene")
        if not isinstance(kind, str) and not callable(kind):
            raise MorseBuilderError(
                f"the kind of '{name}' is the name of a robot or of a model, or a function, not {shown(kind)}"
            )
        for what, numbers in (("position", position), ("rotation", rotation)):
            if len(numbers) != 3 or not all(map(_is_number, numbers)):
                raise MorseBuilderError(f"the {what} of '{name}' is 3 numbers, not {shown(numbers)}")
        if len(scene.roots) + sum("." in one for one in self._recipes) >= _MOST_ROOTS:
            raise MorseBuilderError(f"a scene has at most {_MOST_ROOTS} objects: delete some before you add others")

    def _carrier_of(self, name: object) -> ComponentDeclaration | None:
        """The robot or component to which a component of that name is attached; None for the name of an object.

        Raises:
            MorseBuilderError: there is none.
        """
        owner, dot, _ = name.rpartition(".") if isinstance(name, str) else ("", "", "")
        if not dot:
            return None
        context = self._simulation.context
        carriers = [*context.robots, *context.components]
        if owner not in carriers:
            what = "robot or component" if "." in owner else "robot"
            raise MorseBuilderError(f"there is no {what} '{short(owner)}'{nearest(owner, carriers)}")
        return next(d for d in self._simulation.scene.components if d.name == owner)

    def _addressed(self) -> set[str]:
        """The names that clients can address."""
        context = self._simulation.context
        offers = {component for manager in context.services.everybody() for component in manager.services()}
        return offers.union(context.robots, context.components, context.external_robots, context.overlays)

    def spawn(
        self,
        name: str,
        kind: str | Callable[[], object],
        position: Sequence[float],
        rotation: Sequence[float],
        *,
        by_client: bool = False,
    ) -> None:
        """Spawn a robot or an object, or a component of a robot at a pose in the frame of what carries it.

        Raises:
            MorseBuilderError: see `check`; or there is no such kind; or a client spawns more than its budget.
            LoadError: a component cannot be created.
            ValueError: the engine refuses the shape of the object.
        """
        self.check(name, kind, position, rotation)
        if by_client and "." in name and sum("." in one for one in self._recipes) >= _MOST_ADDED:
            raise MorseBuilderError(f"clients add at most {_MOST_ADDED} components to robots: delete some first")
        simulation = self._simulation
        scene, context = simulation.scene, simulation.context
        carrier = self._carrier_of(name)
        mount = None if carrier is None else self._mount(name, kind, carrier)
        if mount is not None and not any(position):
            position = mount.usual
        newcomer = self._describe(name, kind, position, rotation, _MOST_COMPONENTS if by_client else None)
        if by_client and isinstance(kind, str) and is_description(kind):
            _check_step(name, newcomer.roots)
        if by_client:
            _check_vertices(name, newcomer.roots)
        if carrier is not None and mount is not None:
            for root in newcomer.roots:
                root.parent_inverse = mount.turn
            for declaration in newcomer.components:
                declaration.robot = carrier.robot
        part = Scene(roots=newcomer.roots, components=newcomer.components, settings=scene.settings)
        resolve_shapes(part)
        before = context.world.get_state()
        context.world.add(newcomer.roots, newcomer.components, None if mount is None else mount.node)
        try:
            with acting(context), scene.project:
                # names may come from clients, functions are code of the program
                parts = load_components(context, newcomer.components, by_client=isinstance(kind, str))
                if name in self._absentees and name in context.components:
                    context.sensing.allow(context.components[name], self._absentees[name].pixels)
                context.sensing.check(name, [*parts.sensors, *parts.actuators])
                connect(context, parts, newcomer.components)
        except BaseException:
            self._forget(newcomer.components)
            context.world.remove([context.world.object_of(root) for root in newcomer.roots])
            # what is refused has no effect: a recorded run is repeated without it
            context.world.set_state(before)
            simulation.schedule()
            raise
        simulation.loaded.join(parts)
        scene.models += newcomer.models
        roots = tuple(root.name for root in newcomer.roots)
        self._recipes[name] = Recipe(kind, list(position), list(rotation), roots)
        self._changed()

    def _mount(self, name: str, kind: str | Callable[[], object], carrier: ComponentDeclaration) -> Mount:
        """Where a component is attached: one like that of the launch, where that was."""
        own, calls = split_kind(kind) if isinstance(kind, str) else ("", [])
        if isinstance(kind, str) and not own and name in self._absentees:
            absentee = self._absentees[name]
            parent = self._simulation.scene.find(absentee.parent)
            if parent is None:
                raise MorseBuilderError(f"'{short(name)}' cannot come again: there is no '{short(absentee.parent)}'")
            return Mount(parent, absentee.node.parent_inverse)
        return mount_of(carrier, part_and_calls(calls)[0])

    def _describe(
        self,
        name: str,
        kind: str | Callable[[], object],
        position: Sequence[float],
        rotation: Sequence[float],
        most_components: int | None,
    ) -> Newcomer:
        simulation = self._simulation
        scene = simulation.scene
        if isinstance(kind, str):
            self.check_kind(kind)
        interfaces = ["socket", *scene.interfaces] if simulation.context.network is not None else []
        nearby = [] if isinstance(kind, str) else scene.nearby_paths
        own, calls = split_kind(kind) if isinstance(kind, str) else ("", [])
        with scene.project, describing([*scene.resource_paths, *nearby]):
            try:
                if "." in name:
                    make = self._component_maker(name, own) if isinstance(kind, str) else kind
                    settings = part_and_calls(calls)[1]
                    newcomer = describe_component(name, make, settings, position, rotation, scene.nodes(), interfaces)
                else:
                    make = object_maker(kind) if isinstance(kind, str) else kind
                    newcomer = describe_newcomer(
                        name, make, position, rotation, scene.nodes(), interfaces, most_components
                    )
            except (OSError, SyntaxError) as error:
                raise MorseBuilderError(f"'{short(name)}' cannot come: {error}") from error
            except TypeError as error:
                if not isinstance(kind, str):
                    raise  # the function of a program
                # a class of the builder that needs arguments
                raise MorseBuilderError(f"'{short(name)}' cannot come as {short(own or kind)}: {error}") from error
        if isinstance(kind, str):
            for declaration in newcomer.components:
                check_component_name(declaration.name, name)
        return newcomer

    def _component_maker(self, name: str, kind: str) -> Callable[[], object]:
        """The function that creates a component; without a kind, one like that of the launch, which was deleted."""
        if kind:
            return partial(component_of, kind)
        nodes = {*self._absentees[name].node.walk()} if name in self._absentees else set()
        declarations = [d for d in self._launch[1] if d.node in nodes]
        if len(declarations) != 1:
            reason = "consists of several components" if declarations else "was not deleted, or was not there"
            raise MorseBuilderError(f"'{short(name)}' cannot come again: it {reason}")
        return partial(component_again, declarations[0])

    def kinds(self) -> dict[str, str]:
        """The robots and models that can be spawned by name, with a sentence about each; read once."""
        if not self._kinds:
            robots = {name: entry.doc for name, entry in catalog.components("morse.robots").items()}
            with project_dirs(self._simulation.scene.resource_paths):
                names = available("props")
            # those of a project are paths with a suffix
            models = [name if PurePath(name).suffix.lower() in suffixes() else f"props/{name}" for name in names]
            self._kinds = {**robots, **dict.fromkeys(models, "model")}
        return self._kinds

    def environments(self) -> list[str]:
        """The environments of MORSE and of the project by name."""
        with project_dirs(self._simulation.scene.resource_paths):
            return available("environments")

    def restart(self, name: str, seed: int | None) -> None:
        """Restart one robot: pose, parts and components as after the launch; the others go on.

        Args:
            seed: seed of its random numbers; None for the present one.

        Raises:
            MorseBuilderError: there is no such robot, or it is a part of another object.
            LoadError: a component cannot be created.
        """
        context = self._simulation.context
        if name not in context.robots:
            raise MorseBuilderError(f"there is no robot '{short(name)}'{nearest(name, list(context.robots))}")
        roots, nodes = self._whole(name)
        if seed is not None:
            context.robot_seeds[name] = seed
        scene = self._simulation.scene
        declarations = self._declared(nodes)
        self._forget(declarations, returns=True)
        context.world.renew(roots)
        with acting(context), scene.project:
            parts = load_components(context, declarations, by_client=True)
            own = [one for one in (*parts.sensors, *parts.actuators) if not self._is_of_client(one.name())]
            context.sensing.grant(own)
            connect(context, parts, declarations)
        self._simulation.loaded.join(parts)
        self._sort_components(scene.components)
        self._changed()

    def _is_of_client(self, name: str) -> bool:
        """Whether a client, and not the script or a function of the program, chose a component."""
        recipes = [recipe for one, recipe in self._recipes.items() if name == one or name.startswith(f"{one}.")]
        return any(isinstance(recipe.kind, str) for recipe in recipes)

    # -- deletion --------------------------------------------------------------------------

    def _declared(self, nodes: Collection[Node]) -> list[ComponentDeclaration]:
        return [d for d in self._simulation.scene.components if d.node in nodes or d.robot in nodes]

    def _whole(self, name: str) -> tuple[list[Body], set[Node]]:
        """Return the root objects that exist together with an object, and the nodes below them.

        Raises:
            MorseBuilderError: see `delete`.
        """
        objects = self._simulation.context.world.objects_by_name
        obj = objects.get(name)
        if obj is None:
            raise MorseBuilderError(f"there is no object '{short(name)}'{nearest(name, list(objects))}")
        if obj.node.parent is not None:
            declared = {d.node: d for d in self._simulation.scene.components}.get(obj.node)
            is_whole = name in self._recipes or not any(name.startswith(f"{one}.") for one in self._recipes)
            if declared is not None and declared.kind in ("sensor", "actuator") and is_whole:
                return [obj], {*obj.node.walk()}
            top = obj.node
            while top.parent is not None:
                top = top.parent
            raise MorseBuilderError(f"'{name}' is a part of '{top.name}': only the whole object can be deleted")
        came_with = next((came for came, recipe in self._recipes.items() if name in recipe.roots), name)
        if came_with != name:
            raise MorseBuilderError(f"'{name}' was spawned with '{came_with}': only both together can be deleted")
        roots = [obj]
        if name in self._recipes:
            roots = [objects[root] for root in self._recipes[name].roots if root in objects]
        else:
            roots += [
                objects[node.name] for one in self._declared([obj.node]) for node in one.placed if node.name in objects
            ]
        return roots, {node for root in roots for node in root.node.walk()}

    def delete(self, name: str) -> None:
        """Delete a robot, an object or a component with all its parts.

        Raises:
            MorseBuilderError: there is no object of that name, or it is a part of another object.
        """
        simulation = self._simulation
        roots, nodes = self._whole(name)
        for component in [one for one in self._recipes if one.startswith(f"{name}.")]:
            self.delete(component)
        node = roots[0].node
        absentee = None
        if node.parent is not None and name not in self._recipes:
            here = simulation.context.components.get(name)
            pixels = 0.0 if here is None else simulation.context.sensing.allowance(here)
            absentee = Absentee(node, node.parent.name, pixels)
        self._forget(self._declared(nodes))
        simulation.context.world.remove(roots)
        if absentee is not None:
            self._absentees[name] = absentee
        if self._recipes.pop(name, None) is not None:
            # objects of the launch can be restored
            models = simulation.scene.models
            models[:] = [use for use in models if not any(node in nodes for node in use.nodes.values())]
        self._changed()

    def _forget(self, declarations: list[ComponentDeclaration], *, returns: bool = False) -> None:
        """Finalize components, and close their streams and services unless the components return."""
        simulation = self._simulation
        context = simulation.context
        with acting(context):
            for declaration in declarations:
                component = context.component(declaration.name)
                if component is None:
                    continue
                if component.on_completion is not None:
                    component.interrupt()
                simulation.finalize_one(component)
                if not returns:
                    for manager in context.stream_managers.values():
                        manager.disconnect(component)
                    for part in (component, *self._overlays_of(component)):
                        context.services.unregister(part)
                for table in (context.robots, context.components, context.external_robots):
                    if table.get(declaration.name) is component:
                        del table[declaration.name]
                simulation.loaded.drop(component)

    def _overlays_of(self, component: Object) -> list[MorseOverlay]:
        """Remove and return the overlays of a component."""
        table = self._simulation.context.overlays
        overlays = {name: overlay for name, overlay in table.items() if overlay.overlaid_object is component}
        for name in overlays:
            del table[name]
        return [*overlays.values()]

    def _changed(self) -> None:
        simulation = self._simulation
        simulation.schedule()
        simulation.components_changed()
        simulation.context.guard.tell(simulation.observers, lambda observer: observer.rearranged())

    # -- reset to the launch ---------------------------------------------------------------

    @property
    def has_changed(self) -> bool:
        """Whether objects were spawned or deleted since the launch."""
        components = self._absentees or any("." in name for name in self._recipes)
        return bool(components) or self._simulation.scene.roots != self._launch[0]

    def go_back(self) -> None:
        """Restore the objects of the launch; components are recreated afterwards."""
        if not self.has_changed:
            return
        simulation = self._simulation
        at_launch = {id(declaration) for declaration in self._launch[1]}
        self._forget([d for d in simulation.scene.components if id(d) not in at_launch])
        self._arrange(self._absentees, self._launch, [name for name in self._recipes if "." in name])
        present = set(simulation.scene.nodes())
        models = simulation.scene.models
        models[:] = [use for use in models if any(node in present for node in use.nodes.values())]
        self._recipes.clear()
        simulation.components_changed()

    def _arrange(
        self,
        returning: Collection[str],
        arrangement: tuple[list[Node], list[ComponentDeclaration], list[Zone]],
        leaving: Collection[str] = (),
    ) -> None:
        """Set the nodes and the components of the world.

        Args:
            returning: components of the launch that were deleted, by name.
            arrangement: roots, components and zones.
            leaving: spawned components, which go.
        """
        scene = self._simulation.scene
        going = [node for node in scene.nodes() if node.name in leaving]

        def rebuild(change: SceneChange) -> None:
            change.remove(going)
            nodes = {node.name: node for root in self._launch[0] for node in root.walk()}
            for name in [name for name in self._absentees if name in returning]:
                parent = nodes[self._absentees[name].parent]
                change.attach(self._absentees[name].node, parent, self._place_of(name, parent.name, parent.children))
            change.arrange(*arrangement)

        self._simulation.world.rebuild(rebuild)
        self._absentees = {name: one for name, one in self._absentees.items() if name not in returning}

    def _place_of(self, name: str, parent: str, children: Sequence[Node]) -> int:
        """The place of a returning component among the present children of its parent: as at the launch."""
        order = self._children[parent]
        later = {*order[order.index(name) + 1 :]}
        places = (place for place, child in enumerate(children) if child.name in later or child.name not in order)
        return next(places, len(children))

    def edited(self, pairs: Sequence[tuple[Node, Node]], come: Sequence[Node], removals: Sequence[Node]) -> None:
        """Update the launch after a model was edited, with the present nodes of the model."""
        roots = self._launch[0]
        latest = dict(pairs)
        present = {root.name for root in self._simulation.scene.roots}
        self._recipes = {name: recipe for name, recipe in self._recipes.items() if name in present}
        roots[:] = [*(latest.get(root, root) for root in roots if root not in removals), *come]

    # -- state -----------------------------------------------------------------------------

    def roots_at_launch(self) -> list[str]:
        """Return the root objects of the launch."""
        return [root.name for root in self._launch[0]]

    def placed_at_launch(self, name: str) -> list[str]:
        """Return the root objects that a robot of the launch places when the simulation starts."""
        return [node.name for d in self._launch[1] if d.name == name for node in d.placed]

    def components_at_launch(self) -> list[str]:
        """Return the sensors and actuators of the launch."""
        return [d.name for d in self._launch[1] if d.kind in ("sensor", "actuator")]

    def names_at_launch(self, without: Sequence[str]) -> list[str]:
        """Return the robots and components of the launch, except those of the objects in ``without``."""
        declared = [d.node for d in self._launch[1]]
        absentees = {node for top in (*self._launch[0], *declared) if top.name in without for node in top.walk()}
        return [d.name for d in self._launch[1] if d.node not in absentees and d.robot not in absentees]

    def makers(self) -> dict[str, Callable[[], object]]:
        """Return the functions that created spawned objects, by name; objects with a named kind are omitted."""
        return {name: recipe.kind for name, recipe in self._recipes.items() if callable(recipe.kind)}

    def made(self) -> dict[str, Made]:
        """Return the present objects that were spawned, by name."""
        return {
            name: Made(
                recipe,
                recipe.position,
                recipe.rotation,
                partial(self._present, recipe),
                recipe.kind if isinstance(recipe.kind, str) else "",
            )
            for name, recipe in self._recipes.items()
        }

    def scene_at_launch(self) -> Scene:
        """Return the scene with the objects of the launch."""
        roots, components, zones = self._launch
        scene = replace(self._simulation.scene, roots=roots, components=components, zones=zones)
        return self._without_changes(scene) if self._absentees or any("." in name for name in self._recipes) else scene

    def _without_changes(self, scene: Scene) -> Scene:
        """A copy of a scene of the launch, whose robots have the components of the launch."""
        copies: dict[Node, Node] = {}

        def copied(node: Node) -> Node:
            copy = copies[node] = replace(node, parent=None, children=[])
            children = [child for child in node.children if child.name not in self._recipes]
            for name, absentee in self._absentees.items():
                if absentee.parent == node.name:
                    children.insert(self._place_of(name, node.name, children), absentee.node)
            for child in children:
                below = copied(child)
                below.parent = copy
                copy.children.append(below)
            return copy

        roots = [copied(root) for root in scene.roots]
        components = [replace(d, node=copies[d.node], robot=copies[d.robot]) for d in scene.components]
        zones = [replace(zone, node=copies[zone.node]) for zone in scene.zones]
        return replace(scene, roots=roots, components=components, zones=zones)

    def _present(self, recipe: Recipe) -> Newcomer:
        scene = self._simulation.scene
        roots = [node for node in scene.nodes() if node.name in recipe.roots]
        nodes = {node for root in roots for node in root.walk()}
        components = [component for component in scene.components if component.node in nodes]
        # a component that came later is described without its robot
        return Newcomer(roots, [d if d.robot in nodes else replace(d, robot=roots[0]) for d in components])

    def get_state(self) -> PopulationState:
        """Return the spawned objects with their kinds and poses, and the names of the deleted objects.

        An object that a function of the process created is saved by name only, and cannot be recreated in another
        process.
        """
        # by identity: an object that was spawned later may have the name of a deleted one
        present = {id(root) for root in self._simulation.scene.roots}
        gone = [name for name in self.components_at_launch() if name in self._absentees] if self._absentees else []
        return {
            "came": [
                [name, recipe.kind if isinstance(recipe.kind, str) else "", [*recipe.position], [*recipe.rotation]]
                for name, recipe in self._recipes.items()
            ],
            "gone": [*(root.name for root in self._launch[0] if id(root) not in present), *gone],
        }

    def set_state(self, state: PopulationState, makers: Mapping[str, Callable[[], object]] = _NO_MAKERS) -> None:
        """Spawn and delete robots and objects until they match the state.

        Args:
            makers: see `makers`.

        Raises:
            StateError: an object cannot be recreated.
        """
        if state == self.get_state():
            return
        names = {
            name: Recipe(makers.get(name) or kind, position, rotation)
            for name, kind, position, rotation in state["came"]
        }
        leaving = [name for name, recipe in self._recipes.items() if not recipe.gives(names.get(name))]
        if [name for name in self._recipes if name not in leaving] != [name for name in names if name in self._recipes]:
            # components come again in the right order
            leaving += [name for name in self._recipes if "." in name and name not in leaving]
        for name in leaving:
            if name in self._recipes:  # it may have left with its robot
                self.delete(name)
        for root in self._launch[0]:
            if root.name in state["gone"] and root in self._simulation.scene.roots:
                self.delete(root.name)
        self._bring_back(
            [root for root in self._launch[0] if root.name not in state["gone"]],
            [name for name in self._absentees if name not in state["gone"]],
        )
        for name in self.components_at_launch():
            if name in state["gone"] and name not in self._absentees and name in self._simulation.context.components:
                self.delete(name)
        for name, recipe in names.items():
            if name in self._recipes:
                continue
            if not recipe.kind:
                raise StateError(f"'{name}' was created by a function of a program, and cannot be created again here")
            self.spawn(name, recipe.kind, recipe.position, recipe.rotation)
        self._put_in_order(list(names))

    def _put_in_order(self, names: list[str]) -> None:
        """Sort the spawned objects in the scene, because the engine processes bodies in the order of the scene."""
        if names == list(self._recipes):
            return
        simulation = self._simulation
        scene = simulation.scene
        self._recipes = {name: self._recipes[name] for name in names}
        place = {name: number for number, name in enumerate(names)}

        place |= {root: place[name] for name, recipe in self._recipes.items() for root in recipe.roots}

        def order(name: str) -> int:
            return place.get(name, -1)  # objects of the launch are the first, as before

        def order_of(component: ComponentDeclaration) -> int:
            owners = (one for one in names if component.name == one or component.name.startswith(f"{one}."))
            return order(max(owners, key=len, default=""))

        roots = sorted(scene.roots, key=lambda root: order(root.name))
        components = sorted(scene.components, key=order_of)
        simulation.context.world.arrange(roots, components, list(scene.zones))
        self._sort_components(components)
        self._changed()

    def _sort_components(self, declarations: Sequence[ComponentDeclaration]) -> None:
        """Sort the components as their declarations, because they act in this order."""
        simulation = self._simulation
        by_declaration = {one.name: number for number, one in enumerate(declarations)}
        for members in (simulation.loaded.robots, simulation.loaded.actuators, simulation.loaded.sensors):
            members.sort(key=lambda component: by_declaration[component.name()])
        _sort(simulation.context.robots, by_declaration)
        _sort(simulation.context.components, by_declaration)

    def _bring_back(self, roots: list[Node], names: Collection[str] = ()) -> None:
        """Restore deleted robots and objects of the launch, and its components of some names."""
        simulation = self._simulation
        scene, context = simulation.scene, simulation.context
        missing = {node for root in roots if root not in scene.roots for node in root.walk()}
        missing |= {node for name in names for node in self._absentees[name].node.walk()}
        if not missing:
            return
        came = [root for root in scene.roots if root not in self._launch[0]]
        present = list(scene.components)
        back = [d for d in self._launch[1] if d.node in missing]
        components = [d for d in self._launch[1] if d in present or d in back]
        components += [d for d in present if d not in self._launch[1]]
        zones = [zone for zone in self._launch[2] if zone in scene.zones or zone.node in missing]
        self._arrange(names, ([*roots, *came], components, zones))
        with acting(context), scene.project:
            parts = load_components(context, back)
            connect(context, parts, back)
        simulation.loaded.join(parts)
        self._sort_components(components)
        self._changed()


def _sort(table: dict[str, _T], order: Mapping[str, int]) -> None:
    ordered = sorted(table.items(), key=lambda item: order[item[0]])
    table.clear()
    table.update(ordered)


def _accept(kind: str) -> None:
    """Refuse no kind."""


def _check_vertices(name: str, roots: Sequence[Node]) -> None:
    """Check the size of deformable bodies.

    Raises:
        MorseBuilderError: they are larger than what clients may spawn.
    """
    count = sum(len(node.children) for root in roots for node in root.walk() if node.flex is not None)
    if count > _MOST_VERTICES:
        raise MorseBuilderError(
            f"'{short(name)}' has {count} vertices of deformable bodies, and clients may spawn {_MOST_VERTICES}, "
            "because each tick computes all of them; a scene script may have more"
        )


def _check_step(name: str, roots: Sequence[Node]) -> None:
    """Check the time step of an MJCF text.

    Raises:
        MorseBuilderError: it is shorter than what clients may set.
    """
    for node in (node for root in roots for node in root.walk()):
        model = None if node.articulation is None else node.articulation.model
        if model is not None and model.step < _SHORTEST_STEP:
            raise MorseBuilderError(
                f"'{short(name)}' has a time step of {model.step:g} s, and clients may spawn descriptions with "
                f"{_SHORTEST_STEP:g} s or more, because all robots are moved at it; a scene script may have less"
            )
