"""What a world has besides its models: lights, gravity, its place on the Earth, the colours of the sky, actors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.errors import AssetError
from morse.assets.gazebo.plugins import unknown_plugins
from morse.assets.gazebo.values import ValueMistakeError, boolean, number, pose_of, text_of, vector
from morse.assets.meshfiles.reader import MeshError, mesh_nodes
from morse.assets.nearby_files import FileRefusedError
from morse.assets.sdf.files import find_file
from morse.assets.sdf.scope import FrameMistakeError
from morse.mathutils import Matrix, Vector
from morse.mathutils.portable import linear_light
from morse.mathutils.rotations import nine
from morse.scene import BodySettings, CollisionShape, Light, Material, Node, NodeKind, PhysicsType, ShapeKind
from morse.scene.component import DeclaredSensor
from morse.scene.extent import extent

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.includes import Includes
    from morse.assets.sdf.scope import Scope
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
        figure.body = BodySettings(type=PhysicsType.STATIC, ghost=True)
        figure.shapes = [_shadow(figure)]
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


def _shadow(figure: Node) -> CollisionShape:
    """The upright cylinder that rays hit: as high as the figure, and no broader than a person with spread arms is."""
    bounds = extent(figure.walk(), figure)
    low, high = bounds or ((-_RADIUS, -_RADIUS, -_HALF - _RADIUS), (_RADIUS, _RADIUS, _HALF + _RADIUS))
    half = [0.5 * max(float(b) - float(a), 0.01) for a, b in zip(low, high, strict=True)]
    x, y, z = (0.5 * (float(a) + float(b)) for a, b in zip(low, high, strict=True))
    return CollisionShape(ShapeKind.CYLINDER, (min(half[0], half[1], _RADIUS), half[2]), (x, y, z))


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


_LIGHTS = {"point": "POINT", "spot": "SPOT", "directional": "SUN"}
#: distance at which lights have half of their intensity, if the file does not say, m
_DISTANCE = 25.0


def add_world(library: Library, scope: Scope, element: Element, includes: Includes) -> None:
    """Add the content of an element ``world`` to a library."""
    for light, frame in scope.lights:
        try:
            library.roots.append(light_node(light, scope.place_of(frame)))
        except (ValueMistakeError, FrameMistakeError) as error:
            includes.warn(f"the light '{(light.get('name') or '')[:80]}' is left out: {error}")
    add_actors(library, scope.actors, includes)
    if scope.joints:
        includes.warn(f"joints between the models of the world are left out: {', '.join(scope.joints)[:200]}")
    if element.tag != "world":
        return
    if names := unknown_plugins(plugin for plugin, _ in scope.plugins):
        includes.warn(f"plugins of the world are left out: {', '.join(dict.fromkeys(names))[:400]}")
    for add in (_add_gravity, _add_place, _add_sky):
        try:
            add(library, element, includes)
        except ValueMistakeError as error:
            includes.warn(f"the world: {error}; it is left out")


def light_node(element: Element, place: Matrix) -> Node:
    """The node of an element ``light``.

    Args:
        place: its 4x4 pose.

    Raises:
        ValueMistakeError: a number is wrong.
    """
    kind = _LIGHTS.get(element.get("type") or "point", "POINT")
    red, green, blue = (min(max(value, 0.0), 1.0) for value in vector(element, "diffuse", (1.0, 1.0, 1.0)))
    color = linear_light((red, green, blue)).tolist()
    direction = Vector(vector(element, "direction", (0.0, 0.0, -1.0)))
    if direction.length > 1e-9:
        place = place @ Vector((0.0, 0.0, -1.0)).rotation_difference(direction.normalized()).to_matrix().to_4x4()
    name = element.get("name") or "light"
    node = Node(name, NodeKind.LIGHT, source_name=name)
    node.location, node.rotation_euler = list(place.translation), list(place.to_euler())
    outer = number(element, "spot/outer_angle", 1.3)
    node.light = Light(
        kind,
        (color[0], color[1], color[2]),
        energy=min(max(number(element, "intensity", 1.0), 0.0), 100.0),
        distance=_half_distance(element),
        spot_size=min(max(outer, 0.01), math.pi),
        casts_shadow=boolean(element, "cast_shadows"),
    )
    return node


def _half_distance(element: Element) -> float:
    """The distance at which 1 / (constant + linear d + quadratic d^2) has fallen to half, m."""
    a = number(element, "attenuation/constant", 1.0)
    b, c = number(element, "attenuation/linear", 0.0), number(element, "attenuation/quadratic", 0.0)
    rest = a - 2.0 * max(a, 1e-3)
    if c > 1e-9:
        return min(max((-b + math.sqrt(max(b * b - 4.0 * c * rest, 0.0))) / (2.0 * c), 0.01), 1000.0)
    return min(max(-rest / b, 0.01), 1000.0) if b > 1e-9 else _DISTANCE


def _add_gravity(library: Library, element: Element, includes: Includes) -> None:
    path = "gravity" if element.find("gravity") is not None else "physics/gravity"
    x, y, z = vector(element, path, (0.0, 0.0, -9.8))
    if max(abs(x), abs(y)) > 1e-9:
        includes.warn(f"gravity is {x:g} {y:g} {z:g}; only its vertical part acts")
    library.world["gravity"] = -z


def _add_place(library: Library, element: Element, includes: Includes) -> None:
    place = element.find("spherical_coordinates")
    if place is None:
        return
    names = {"latitude": "latitude_deg", "longitude": "longitude_deg", "altitude": "elevation"}
    properties = {name: number(place, tag, 0.0) for name, tag in names.items()}
    library.world["properties"] = properties
    heading = number(place, "heading_deg", 0.0)
    if heading:
        properties["angle_against_north"] = math.radians(heading)
    if text_of(place, "world_frame_orientation", "ENU") != "ENU":
        includes.warn("the axes of the world are read as east, north, up")


def _add_sky(library: Library, element: Element, includes: Includes) -> None:
    del includes
    scene = element.find("scene")
    if scene is None:
        return
    for tag, name in (("ambient", "ambient_color"), ("background", "horizon_color")):
        if text_of(scene, tag):
            color = [min(max(value, 0.0), 1.0) for value in vector(scene, tag, (0.0, 0.0, 0.0))]
            red, green, blue = linear_light(color).tolist()
            library.world[name] = (red, green, blue)
