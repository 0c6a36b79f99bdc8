"""A whole scene as plain data, created by the builder and run by the simulation."""

from __future__ import annotations

from contextlib import nullcontext
from copy import deepcopy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from morse.scene.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

    from morse.scene.component import ComponentDeclaration, SourceLine
    from morse.scene.model import ModelUse
    from morse.scene.node import Node


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
