"""Converts the objects of a script into the scene for the simulation."""

from __future__ import annotations

import logging
import math
from dataclasses import replace
from struct import pack, unpack
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.components.passive import Zone as ZoneComponent
from morse.builder.components.robot import Robot, connect
from morse.builder.errors import ScriptError, Step, checks
from morse.builder.names.catalog import load_class
from morse.core.declarations import data_fields
from morse.core.exceptions import MorseBuilderError
from morse.core.reports.quoting import nearest
from morse.mathutils.portable import matmul
from morse.scene import ComponentDeclaration, PhysicsType, Scene, TimeStrategies, Zone
from morse.scene.scene import Display, Overlay, PanelPlace
from morse.scene.scene_warnings import about
from morse.system import OF_MACHINE
from morse.system.variables import node_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from morse.builder.assembly.description import EnvironmentDescription, Wish
    from morse.builder.workspace import Workspace
    from morse.core.values import Properties
    from morse.scene import ComponentDeclaration, Node, SourceLine
    from morse.scene.mjcf import MjcfModel

logger = logging.getLogger(__name__)


class Displaying:
    """The components and objects of a scene, by their names.

    Args:
        workspace: the objects of the script.
        components: the declarations of the components.
    """

    def __init__(self, workspace: Workspace, components: Iterable[ComponentDeclaration]) -> None:
        self._components = {component.name: component for component in components}
        self._workspace = workspace

    def display(self, wishes: Mapping[str, Wish]) -> Display:
        """What the view shows at first.

        Args:
            wishes: the arguments of ``env.show``.

        Raises:
            ScriptError: a component, a field or a word is unknown.
        """
        display = Display()
        for name, (where, value) in wishes.items():
            try:
                getattr(self, f"_{name}")(display, value)
            except (TypeError, ValueError) as error:
                raise ScriptError(str(error), [Step(where)] if where else []) from None
        return display

    def _rays(self, display: Display, value: object) -> None:
        if isinstance(value, bool):
            display.overlays = tuple(dict.fromkeys((*display.overlays, *(("rays",) if value else ()))))
        else:
            display.rays = tuple(self._component(one, "env.show(rays=[...])") for one in _items(value, "rays"))

    def _images(self, display: Display, value: object) -> None:
        what = "env.show(images=[...])"
        names = [name for one in _items(value, "images") for name in self._cameras(one, what)]
        display.images = tuple(dict.fromkeys((*display.images, *names)))

    def _display_camera(self, display: Display, camera: Any) -> None:
        display.images = tuple(dict.fromkeys((*display.images, camera.name)))

    def _plots(self, display: Display, value: object) -> None:
        diagrams = [[one] if isinstance(one, str) else _items(one, "plots") for one in _items(value, "plots")]
        display.plots = tuple(tuple(self._curve(curve) for curve in curves) for curves in diagrams)

    def _follow(self, display: Display, value: object) -> None:
        names = {node.name: None for node in self._workspace.nodes()}
        display.follow = _name_of(value, names, "env.show(follow=...)", "object")

    def _select(self, display: Display, value: object) -> None:
        display.select = self._component(value, "env.show(select=...)")

    def _overlays(self, display: Display, value: object) -> None:
        words = [_word(one, get_args(Overlay), "overlays") for one in _items(value, "overlays")]
        display.overlays = tuple(dict.fromkeys((*display.overlays, *words)))

    def _layout(self, display: Display, value: object) -> None:
        display.panels = tuple(_word(one, get_args(PanelPlace), "layout") for one in _items(value, "layout"))

    def _component(self, value: object, what: str) -> str:
        return _name_of(value, self._components, what, "component")

    def _cameras(self, value: object, what: str) -> list[str]:
        """A camera, or the cameras of a part that consists of several, such as a Kinect."""
        cameras = [name for name, component in self._components.items() if _is_camera(component)]
        names = {name: None for camera in cameras for name in _prefixes(camera)}
        name = _name_of(value, names, what, "camera")
        return [camera for camera in cameras if camera == name or camera.startswith(f"{name}.")]

    def _curve(self, value: object) -> tuple[str, str]:
        """Component and field of the text ``component.field``."""
        what = "env.show(plots=[...])"
        text = checks.text(value, what)
        owner, dot, field = text.rpartition(".")
        if text in self._components:
            fields = self._fields(text)
            example = f", such as '{text}.{fields[0]}'" if fields else ", which has none"
            raise ValueError(f"{what} takes a field of '{text}'{example}")
        name = _name_of(owner if dot else text, self._components, what, "component")
        fields = self._fields(name)
        if field not in fields:
            raise ValueError(f"{what}: '{name}' has no field '{field}'{checks.suggestion(field, fields)}")
        return name, field

    def _fields(self, name: str) -> list[str]:
        component = self._components[name]
        fields = data_fields(load_class(component.classpath))
        return [field for field, declared in fields.items() if declared.on_level(component.level)]


def _is_camera(component: ComponentDeclaration) -> bool:
    cls = load_class(component.classpath)
    return "image" in data_fields(cls) or hasattr(cls, "shown")


def _prefixes(text: str) -> Iterable[str]:
    """``a.b.c``, ``a.b``, ``a``."""
    while text:
        yield text
        text = text.rpartition(".")[0]


def _name_of(value: object, names: Iterable[str], what: str, kind: str) -> str:
    name = value if isinstance(value, str) else getattr(value, "name", None)
    if not isinstance(name, str):
        raise TypeError(
            f"{what} takes a {kind} or its name, got {checks.shown(value)}".replace("a object", "an object")
        )
    names = list(names)
    if name in names:
        return name
    last = name.rpartition(".")[2]
    same = [one for one in names if one.rpartition(".")[2] == last]
    hint = f"; did you mean '{same[0]}'?" if len(same) == 1 else checks.suggestion(name, names)
    raise ValueError(f"{what}: there is no {kind} '{name}'{hint}")


def _items(value: object, argument: str) -> list[Any]:
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        raise TypeError(f"env.show({argument}=[...]) takes a list, got {checks.shown(value)}")
    return list(value)


def _word(value: object, words: tuple[Any, ...], argument: str) -> Any:
    return checks.choice(value, words, f"env.show({argument}=[...])")


def distribute(robots: Sequence[Robot], shares: Mapping[str, Sequence[str]]) -> None:
    """Mark the robots that other nodes simulate as external.

    Args:
        robots: of the script.
        shares: name of a node to the names of its robots. Without nodes, each node simulates all robots of its script.
    """
    names = [robot.name for robot in robots]
    for node, share in shares.items():
        for name in share:
            if name not in names:
                logger.warning(
                    "env.configure_multinode(distribution): the robot '%s' of the node '%s' is not in the script%s",
                    name,
                    node,
                    nearest(name, names),
                )
    own = node_name()
    if shares and own not in shares:
        logger.warning(
            "this node is called '%s', and the distribution has no such node%s: it simulates all robots; to name it: "
            "morse run --name NODE",
            own,
            nearest(own, list(shares)),
            # the name is that of this computer or of an option, not of the script
            extra=OF_MACHINE,
        )
    elif shares:
        for robot in robots:
            if robot.name not in shares[own]:
                robot.make_external()
    for robot in robots:
        if robot.is_external:
            _hold(robot)


def _hold(robot: Robot) -> None:
    """Leave the motion of a robot to its node: it has no physics of its own here."""
    for node in robot.scene_node.walk():
        if node.body.moves:
            node.body.type = PhysicsType.STATIC


def of_own_robots(parts: Iterable[AbstractComponent]) -> list[AbstractComponent]:
    """Return the parts without the components of robots that other nodes simulate."""
    return [part for part in parts if isinstance(part, Robot) or not _is_elsewhere(part)]


def _is_elsewhere(part: AbstractComponent) -> bool:
    owner = part.parent
    while owner is not None and not owner.is_robot:
        owner = owner.parent
    return isinstance(owner, Robot) and owner.is_external


#: properties of the world that place its origin on the Earth
_ORIGIN = ("longitude", "latitude", "altitude")
#: largest height of ground that is level, m
_LEVEL = 1e-3
#: m; numbers of 64 bits are a micrometre apart there
_FARTHEST = 1e9


def build_scene(workspace: Workspace) -> Scene:
    """Return the scene that a script has described.

    Raises:
        ScriptError: there is no environment, or a component cannot be used.
    """
    environment = workspace.environment
    if environment is None:
        raise ScriptError(
            "the script creates no Environment",
            mend="Write at the end of the script: env = Environment('sandbox') (or 'empty', 'indoors-1/boxes', ...)",
        )
    with about(environment.where):
        return _built(workspace, environment)


def _built(workspace: Workspace, environment: EnvironmentDescription) -> Scene:
    for interface in environment._default_interfaces:
        for part in workspace.components:
            if isinstance(part, Robot):
                connect(part, interface)
    settings = environment.settings
    if environment._distribution is not None:
        robots = [part for part in workspace.components if isinstance(part, Robot)]
        with about(environment._distribution_where):
            distribute(robots, environment._distribution)
    parts = [part for part in workspace.components if isinstance(part, AbstractComponent) and part.is_morseable()]
    own = list(of_own_robots(parts))
    fastest = max((part._frequency or 0.0 for part in own if not part._keeps_tick), default=0.0)
    if environment._auto_tune and settings.time_strategy is TimeStrategies.BestEffort:
        settings.frequency = max(settings.frequency, fastest)
    _slow_down(own, settings.frequency)
    _tell_doubles(own)
    _tell_ports(own)
    _keep_one_floor(workspace)
    for part in workspace.components:
        if isinstance(part, AbstractComponent):
            part.scene_node.where = part._where
    components = [declare(part, workspace) for part in own]
    settings.view.display = Displaying(workspace, components).display(environment._wishes)
    _check_poses(workspace)
    scene = Scene(
        environment=environment.filename,
        where=environment.where,
        roots=list(workspace.roots),
        components=components,
        zones=[Zone(c.scene_node, c.type) for c in workspace.components if isinstance(c, ZoneComponent)],
        models=list(workspace.models),
        settings=settings,
        properties=_properties(environment),
        manager_options=environment._manager_options,
        simulation_managers=environment._simulation_managers,
        alterations=environment._alterations,
        interfaces=list(environment._default_interfaces),
        log_levels=environment._log_levels,
    )
    for where, complete in environment._completions:
        try:
            complete(scene)
        except MorseBuilderError as error:
            raise ScriptError(str(error), [Step(where)] if where else []) from None
    return scene


def _keep_one_floor(workspace: Workspace) -> None:
    """Leave either the floor of the world, or those of MJCF files below height 0.

    Robots of these files, whose poses refer to their floor, keep it in a world that is nothing but ground, as `empty`
    is, or that has nothing to stand on. If anything else stands in the scene, or the script has raised or lowered a
    robot, the world has the floor, and what the script has not raised stands over it as over that of its file.
    """
    of_world = {node for use in workspace.models if use.choice.role == "environment" for node in use.nodes.values()}
    bodies = [root for root in workspace.roots if any(node.body.collides for node in root.walk())]
    world = [root for root in bodies if root in of_world]
    low: dict[Node, MjcfModel] = {}
    placed: dict[Node, float] = {}
    for use in workspace.models:
        own = {name: root for name, root in use.nodes.items() if root in bodies and root not in of_world}
        floors = {root: model for root in own.values() if (model := _mjcf_of(root)) is not None and model.floors}
        tops = [_top_of(node) for root, model in floors.items() for node in _floors_of(root, model)]
        if floors and all(root.location[2] == use.originals[name].location[2] for name, root in own.items()):
            placed.update(dict.fromkeys(own.values(), max(tops)))
        low.update(floors)
    if not low:
        return
    is_level = all(_top_of(node) <= _LEVEL for root in world for node in root.walk() if node.body.collides)
    if is_level and all(root in placed for root in bodies if root not in of_world):
        for root in world:
            workspace.delete(root)
        for root in placed:
            _change_mjcf(root, has_floor=True)
    elif world:
        for root, model in low.items():
            for node in list(_floors_of(root, model)):
                workspace.delete(node)
            shapes = {name: geom for name, geom in model.shapes.items() if name not in model.floors}
            _change_mjcf(root, shapes=shapes, floors=())
        for root, height in placed.items():
            root.location[2] -= height
        for root, height in placed.items():
            if root.body.moves or root in low:
                text = (
                    "'%s' starts %.2g m higher than in its file, whose floor is at %.2g m: the scene has another floor"
                )
                logger.warning(text, root.name, -height, height, extra={"where": root.where})


def _floors_of(root: Node, model: MjcfModel) -> Iterator[Node]:
    return (node for node in root.walk() if (node.source_name or node.name) in model.floors)


def _change_mjcf(root: Node, **changes: object) -> None:
    settings = root.articulation
    if settings is not None and settings.model is not None:
        root.articulation = replace(settings, model=replace(settings.model, **changes))  # type: ignore[arg-type]


def _mjcf_of(root: Node) -> MjcfModel | None:
    return None if root.articulation is None else root.articulation.model


def _top_of(node: Node) -> float:
    """Return the height of the highest point of the mesh of a node, m; minus infinity without a mesh."""
    if node.mesh is None:
        return -math.inf
    matrix = node.world_matrix()
    row, height = np.array(matrix[2][:3]), matrix[2][3]
    return float(matmul(node.mesh.vertices, row).max(initial=-math.inf)) + height


def _tell_doubles(parts: Iterable[AbstractComponent]) -> None:
    """Warn of components of the script with the name of one that the file of the robot has declared."""
    for robot in (part for part in parts if isinstance(part, Robot)):
        declared = {**robot.actuators, **robot.sensors}
        for child in robot.children:
            name, _, number = child.name.rpartition("_")
            name = name.rpartition(".")[2]
            if name in declared and number.isdecimal() and child not in declared.values():
                table = "actuators" if name in robot.actuators else "sensors"
                logger.warning(
                    "the file of %s has a component '%s', and the one of the script is called %s: use "
                    "%s.%s['%s'], another name, or Robot(..., sensors=False) without the components of the file",
                    *(robot.name, name, child.name, robot.name, table, name),
                    extra={"where": child._where},
                )


def _tell_ports(parts: Iterable[AbstractComponent]) -> None:
    """Warn of streams with the port of a stream of another component: it gets another one."""
    owners: dict[tuple[str, object], str] = {}
    for part in parts:
        for stream in part._streams:
            port = stream.options.get("port")
            owner = owners.setdefault((stream.manager, port), part.name) if port else part.name
            if owner != part.name:
                logger.warning(
                    "the port %s of '%s' is that of '%s': choose another one",
                    *(port, part.name, owner),
                    extra={"where": stream.where},
                )


def _slow_down(parts: Iterable[AbstractComponent], tick: float) -> None:
    """Let components act at most once in a tick; the world does not become faster for a sensor of a file."""
    fast = {part: part._frequency or 0.0 for part in parts if (part._frequency or 0.0) > tick}
    of_file = {part: rate for part, rate in fast.items() if part._keeps_tick}
    if of_file:
        names = ", ".join(f"{part.name} ({rate:g} Hz)" for part, rate in of_file.items())
        mend = "frequency(hz) of the sensor makes the simulation as fast"
        where = {"where": next(iter(of_file))._where}
        logger.warning("sensors of files measure in each tick, at %g Hz; %s: %.400s", tick, mend, names, extra=where)
    lines: dict[SourceLine, AbstractComponent] = {}
    for part in fast:
        if part._rate_where is not None and part not in of_file:
            lines.setdefault(part._rate_where, part)
    for line, part in lines.items():
        logger.warning(
            "the frequency of '%s' is %g Hz, which is more than the %g ticks per second of the simulation: it becomes "
            "%g Hz; write frequency(%g), or env.simulator_frequency(%g) for as many ticks",
            *(part.name, fast[part], tick, tick, tick, fast[part]),
            extra={"where": line},
        )
    for part in fast:
        # not those of its children, which may be slower
        AbstractComponent._set_frequency(part, tick)


def _properties(environment: EnvironmentDescription) -> Properties:
    """Return the properties of the world; the engine of 1.4 stored numbers in single precision."""
    properties = dict(environment.environment_properties)
    for name in _ORIGIN if environment.settings.physics_of_1_4 else ():
        value = properties.get(name)
        if isinstance(value, (int, float)):
            properties[name] = unpack("f", pack("f", value))[0]
    return properties


def declare(component: AbstractComponent, workspace: Workspace) -> ComponentDeclaration:
    """The declaration of a component for the simulation.

    Raises:
        ScriptError: it is not attached to a robot, or its class cannot be loaded.
    """
    try:
        component.component_class()
    except MorseBuilderError as error:
        raise _error(component, str(error)) from error
    robot = component
    while not robot.is_robot:
        if robot.parent is None:
            message = f"'{component.name}' ({type(component).__name__}) is not attached to a robot"
            raise _error(component, message, f"Attach it to a robot: robot.append({component.plain_name})")
        robot = robot.parent
    roots = workspace.roots
    before = len(roots)
    declaration = component._declaration(robot)
    # the script has no names for them yet
    declaration.placed += roots[before:]
    return declaration


def _check_poses(workspace: Workspace) -> None:
    by_node = {part.scene_node: part for part in workspace.components if isinstance(part, AbstractComponent)}
    for node in workspace.nodes():
        far = max(map(abs, node.location), default=0.0)
        if _FARTHEST < far < math.inf:
            message = f"'{node.name}' is {far:g} m away from the origin: a scene is at most {_FARTHEST:g} m large"
            part = by_node.get(node)
            raise ScriptError(message) if part is None else _error(part, message, "Give its translation in metres.")
        if not all(math.isfinite(x) for x in (*node.location, *node.rotation_euler, *node.scale)):
            raise ScriptError(f"the pose of '{node.name}' is not finite: {node.location}, {node.rotation_euler}")


def _error(component: AbstractComponent, message: str, mend: str = "") -> ScriptError:
    return ScriptError(message, [Step(component._where)] if component._where else [], mend)
