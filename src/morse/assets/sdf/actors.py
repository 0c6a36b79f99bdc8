"""Actors: figures that move along a path, whatever is in their way."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.errors import AssetError
from morse.assets.gazebo.values import ValueMistakeError, boolean, number, pose_of, text_of
from morse.assets.nearby_files import FileRefusedError
from morse.assets.sdf.files import find_file
from morse.assets.urdf.meshes import MeshError, mesh_nodes
from morse.mathutils import Matrix
from morse.mathutils.rotations import nine
from morse.scene import BodySettings, Material, Node, NodeKind
from morse.scene.component import DeclaredSensor

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.includes import Includes
    from morse.scene import Library

_MOST_POINTS = 10_000
#: size of the figure of an actor whose skin cannot be read, m
_RADIUS, _HALF = 0.25, 0.6


def add_actors(library: Library, actors: list[tuple[Element, Path]], includes: Includes) -> None:
    """Add the figures of actors, and their paths as actuators."""
    libraries: dict[Path, Library] = {}
    for element, path in actors:
        name = (element.get("name") or "actor")[:200]
        try:
            points = _points(element)
            pose = pose_of(element.find("pose"))
            delay = max(number(element, "script/delay_start", 0.0), 0.0)
            scale = number(element, "skin/scale", 1.0)
        except ValueMistakeError as error:
            includes.warn(f"the actor '{name:.80}' is left out: {error}")
            continue
        title = f"figure of {name}"
        figure = Node(title, source_name=title, location=list(pose.translation), rotation_euler=list(pose.to_euler()))
        for part in _skin(element, path, libraries, includes, name):
            figure.attach(part)
        for part in figure.children:
            part.scale = [scale * value for value in part.scale]
        for node in figure.walk():
            node.body = BodySettings()
            node.shapes = []
        library.roots.append(figure)
        if points:
            properties: dict[str, float | int | str] = {
                "Points": "; ".join(" ".join(map(repr, point)) for point in points),
                "Loop": boolean(element, "script/loop", True),
                "Delay": delay,
            }
            identity = nine(list(Matrix.Identity(3)))
            sensor = DeclaredSensor(name, "TimedPath", title, (0.0, 0.0, 0.0), identity, tuple(properties.items()))
            library.walkers.append(sensor)


def _points(element: Element) -> list[tuple[float, ...]]:
    """Times and poses of the first trajectory.

    Raises:
        ValueMistakeError: a number is wrong.
    """
    points: list[tuple[float, ...]] = []
    for point in element.findall("script/trajectory/waypoint")[:_MOST_POINTS]:
        pose = pose_of(point.find("pose"))
        points.append((number(point, "time", 0.0), *pose.translation, *pose.to_euler()))
    return points


def _skin(element: Element, path: Path, libraries: dict[Path, Library], includes: Includes, name: str) -> list[Node]:
    file = text_of(element, "skin/filename")
    try:
        if not file:
            raise FileRefusedError("it has no skin")
        return mesh_nodes(find_file(file, path), libraries=libraries)
    except (AssetError, FileRefusedError, MeshError, OSError) as error:
        reason = error.message if isinstance(error, AssetError) else str(error)
        includes.warn(f"the actor '{name:.80}' is shown as a capsule: {file:.100} {reason}")
        node = Node(f"{name}_figure", NodeKind.MESH, source_name=f"{name}_figure", location=[0.0, 0.0, 0.0])
        node.mesh = solids.capsule(_RADIUS, _HALF)
        node.materials = [Material(node.name, (0.2, 0.3, 0.6, 1.0))]
        return [node]
