"""A whole scene as plain data, created by the builder and run by the simulation."""

from __future__ import annotations

import time
from contextlib import nullcontext
from copy import deepcopy
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

    from morse.scene.component import ComponentDeclaration, SensorAlteration, SourceLine
    from morse.scene.node import Node


class TimeStrategies(IntEnum):
    """How simulated time relates to the wall clock.

    ``BestEffort`` keeps up with the wall clock, and reports if it cannot. ``FixedSimulationStep`` runs every tick, even
    if it falls behind the wall clock.
    """

    BestEffort = 0
    FixedSimulationStep = 1

    @property
    def human_repr(self) -> str:
        """The name that the service ``time.mode`` returns."""
        return ("Best Effort", "Fixed Simulation Step")[self.value]


@dataclass(slots=True)
class Mist:
    """Fog from ``start`` m on, full after ``depth`` more; falloff QUADRATIC, LINEAR or INVERSE_QUADRATIC."""

    enabled: bool = True
    intensity: float = 0.0
    start: float = 5.0
    depth: float = 25.0
    falloff: str = "QUADRATIC"


#: overlays of the world that the live view can show
Overlay = Literal["rays", "frustums", "cones", "trails", "names", "frames", "contacts", "masses", "shapes"]
#: panels of the live view
PanelPlace = Literal["tree", "details", "plots"]


@dataclass(slots=True)
class Display:
    """What the live view shows at first, by the names of components; the user may close all of it.

    Attributes:
        rays: sensors whose rays or points are shown.
        images: cameras whose images are shown.
        plots: the curves of each diagram: component and field.
        follow: the node that the camera moves with; empty for none.
        select: the component whose panel is open; empty for none.
        overlays: what else is shown in the world, of all robots.
        panels: the open panels; None for those that the user opened last.
    """

    rays: tuple[str, ...] = ()
    images: tuple[str, ...] = ()
    plots: tuple[tuple[tuple[str, str], ...], ...] = ()
    follow: str = ""
    select: str = ""
    overlays: tuple[Overlay, ...] = ()
    panels: tuple[PanelPlace, ...] | None = None


@dataclass(slots=True)
class ViewSettings:
    """Initial settings of the live view. The camera looks along its -Z axis.

    Attributes:
        daylight: factor of the light of sun and sky, 0..1; 0 is a night without a moon.
    """

    camera_location: tuple[float, float, float] = (5.0, -5.0, 5.0)
    camera_rotation: tuple[float, float, float] = (0.7854, 0.0, 0.7854)
    camera_clip: tuple[float, float] = (0.1, 100.0)
    camera_speed: float = 2.0
    camera_focal_length: float = 20.0
    horizon_color: tuple[float, float, float] | None = None
    ambient_color: tuple[float, float, float] | None = None
    daylight: float = 1.0
    mist: Mist | None = None
    show_debug_properties: bool = False
    show_framerate: bool = False
    show_physics: bool = False
    fullscreen: bool = False
    display: Display = field(default_factory=Display)
    material_mode: str = "GLSL"
    viewport: str | None = None
    stereo: dict[str, object] | None = None


@dataclass(slots=True)
class Settings:
    """Physics, time and view.

    Attributes:
        gravity: m/s^2, downward.
        frequency: ticks per simulated second.
        physics_of_1_4: whether friction and damping act on driven robots as in the engine of MORSE 1.4.
        physics_steps: smallest number of physics steps per tick; their number if `steps_are_exact`.
        steps_are_exact: whether the script has set the number of steps. Otherwise steps are at most 1/240 s, or as long
            as in the file if all robots come from MJCF files.
        time_scale: simulated seconds per wall-clock second.
        relative_time: whether time starts at 0; otherwise at the epoch time of the start.
        start_time: seconds since the epoch at the start, UTC; None for the present time. Only without relative time.
        seed: seed of all random numbers.
        cameras_on: where images are rendered, see `morse.scene.image_workers`.
        fastmode: whether the view shows wireframes and cameras give no images.
        fallen: what follows if a robot falls below everything: a ``warning``, or the end of the run with an ``error``.
    """

    gravity: float = 9.81
    frequency: float = 60.0
    physics_steps: int = 2
    steps_are_exact: bool = False
    physics_of_1_4: bool = False
    time_strategy: TimeStrategies = TimeStrategies.BestEffort
    time_scale: float = 1.0
    relative_time: bool = True
    start_time: float | None = None
    seed: int = 0
    cameras_on: int | str = 0
    fastmode: bool = False
    fallen: str = "warning"
    auto_start: bool = True
    internal_syncer: bool = False
    node_name: str | None = None
    view: ViewSettings = field(default_factory=ViewSettings)

    @property
    def origin(self) -> float:
        """Simulated time at the start, s: 0, or the date since the epoch."""
        if self.relative_time:
            return 0.0
        return time.time() if self.start_time is None else self.start_time


@dataclass(eq=False, slots=True)
class Zone:
    """An axis-aligned box with a purpose, e.g. ``Charging``; the scale of its node is the half size."""

    node: Node
    type: str


@dataclass(eq=False, slots=True)
class Scene:
    """Everything the simulation needs to start.

    Attributes:
        environment: the name in the script, e.g. ``indoors-1/boxes``.
        where: the line of the script that created the environment.
        roots: nodes without a parent, in the order of creation.
        components: robots, sensors and actuators, in the order of creation.
        models: the model files from which nodes were loaded.
        properties: properties of the environment: longitude, latitude, altitude, UTMXOffset, ...
        manager_options: class path of a stream manager to its options.
        simulation_managers: request managers that offer the services of the simulation.
        alterations: the modifiers of all sensors that they fit, also of those that are created later.
        interfaces: names of the middlewares to which all components are connected, including those created later.
        log_levels: component to level, from ``env.set_log_level``.
        resource_paths: directories that the user named, which are searched for models; also for models of clients.
        nearby_paths: directories around the script, which only the script and the program search for models.
        project: the modules of the project; entered (``with scene.project:``) to import classes of the project.
    """

    environment: str = ""
    roots: list[Node] = field(default_factory=list)
    components: list[ComponentDeclaration] = field(default_factory=list)
    zones: list[Zone] = field(default_factory=list)
    models: list[ModelUse] = field(default_factory=list)
    settings: Settings = field(default_factory=Settings)
    properties: dict[str, object] = field(default_factory=dict)
    manager_options: dict[str, dict[str, object]] = field(default_factory=dict)
    simulation_managers: list[str] = field(default_factory=list)
    alterations: list[SensorAlteration] = field(default_factory=list)
    interfaces: list[str] = field(default_factory=list)
    log_levels: dict[str, str] = field(default_factory=dict)
    resource_paths: list[str] = field(default_factory=list)
    nearby_paths: list[str] = field(default_factory=list)
    project: AbstractContextManager[object] = field(default_factory=nullcontext)
    where: SourceLine | None = None

    def managers(self) -> set[str]:
        """The class paths of all stream and request managers that the scene uses."""
        return set(self.lines_of_managers())

    def lines_of_managers(self) -> dict[str, SourceLine | None]:
        """The class paths of all stream and request managers, and the first line of the script that needs each."""
        lines: dict[str, SourceLine | None] = dict.fromkeys(self.simulation_managers, self.where)
        for component in self.components:
            for stream in component.streams:
                lines.setdefault(stream.manager, stream.where or component.where)
            for overlay in component.overlays:
                lines.setdefault(overlay.manager, overlay.where or component.where)
            for manager in component.managers:
                lines.setdefault(manager, component.where)
        return lines

    def copy(self) -> Scene:
        """Return a copy that shares no objects that a simulation changes; meshes and images are shared."""
        memo: dict[int, object] = {id(self.project): self.project}
        originals = [node for use in self.models for node in use.originals.values()]
        for node in [*self.nodes(), *originals]:
            for part in (node.mesh, *node.materials, *(node.shapes or ())):
                memo[id(part)] = part
        return deepcopy(self, memo)

    def __repr__(self) -> str:
        robots = ", ".join(robot.name for robot in self.robots()) or "none"
        return f"<Scene in '{self.environment}': {sum(1 for _ in self.nodes())} nodes; robots: {robots}>"

    def nodes(self) -> Iterator[Node]:
        """Every node, parents before their children."""
        for root in self.roots:
            yield from root.walk()

    def robots(self) -> list[ComponentDeclaration]:
        """The declarations of the robots."""
        return [c for c in self.components if c.kind in ("robot", "external_robot")]

    def find(self, name: str) -> Node | None:
        """The node of that name, or None."""
        return next((node for node in self.nodes() if node.name == name), None)


#: the use of the objects, which determines their physics if the file does not; a casing is the body of a sensor or
#: actuator and does not collide
Role = Literal["environment", "component", "casing", "prop"]


@dataclass(frozen=True, slots=True)
class Choice:
    """The selection of objects of a model file for a scene.

    Attributes:
        role: the use of the objects in the scene.
        whole: whether all objects are used, below one root.
        names: names of the objects, each used with all objects below it; None for no such choice.
        prefix: objects whose names begin with it, or the collection of that name; None for no such choice.
    """

    role: Role
    whole: bool = False
    names: tuple[str, ...] | None = None
    prefix: str | None = None


@dataclass(eq=False, slots=True)
class ModelUse:
    """Nodes that came from a model file, so that they can follow the file when it changes.

    Attributes:
        path: the file.
        nodes: the nodes in the scene, by their names in the file; a script may have changed, moved or deleted them.
        originals: copies of the same nodes with the values of the file.
    """

    path: str
    choice: Choice
    nodes: dict[str, Node] = field(default_factory=dict)
    originals: dict[str, Node] = field(default_factory=dict)
