"""MJCF files as libraries of nodes: a body, and below it an armature that moves the links; and their sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.errors import AssetError
from morse.assets.mjcf.joints import Bones, pose
from morse.assets.mjcf.shapes import add_skins, flex_node, hide_collision_shapes, shape_node
from morse.assets.mjcf.source import Source
from morse.assets.mjcf.textures import TextureImages
from morse.assets.robot_nodes import attach_links, robot_node
from morse.mathutils import Matrix
from morse.mathutils.portable import matmul
from morse.mathutils.rotations import nine
from morse.scene import Articulation, BodySettings, Inertial, Library, Node, PhysicsType
from morse.scene.component import DeclaredSensor
from morse.scene.library import Keyframe
from morse.scene.mjcf import DEFAULT_CONTACT, MjcfModel

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.assets.mjcf.model import BodyData, ModelData

#: quantities that `ArmaturePose` and the motors already measure
_OF_JOINTS = ("joint", "actuator", "tendon", "ball")
_PRODUCTS = {
    "camera": "VideoCamera",
    "rangefinder": "Infrared",
    "accelerometer": "IMU",
    "gyro": "IMU",
    "magnetometer": "Magnetometer",
    "force": "ForceTorqueSensor",
    "torque": "ForceTorqueSensor",
    "touch": "ContactForce",
    "velocimeter": "Velocity",
    "framelinvel": "Velocity",
    "frameangvel": "Velocity",
    "framepos": "Pose",
    "framequat": "Pose",
    "framexaxis": "Pose",
    "frameyaxis": "Pose",
    "framezaxis": "Pose",
    "clock": "Clock",
}
#: sensors of which each measures something else, also at one place
_SINGLE = ("VideoCamera", "Infrared")
_MOST_PIXELS = 4096
#: cameras look along -Z with +Y up, range finders along +Z; sensors of MORSE look along +X with +Z up
_FROM_CAMERA = Matrix(((0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0))).to_4x4()
_FROM_FINDER = Matrix(((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))).to_4x4()


def sensors_of(model: ModelData, links: Mapping[int, str]) -> tuple[list[DeclaredSensor], list[str]]:
    """Return the sensors of a model, and warnings about those that are left out.

    An accelerometer and a gyroscope with the same pose become one IMU.

    Args:
        links: names of the nodes by body.
    """
    by_site: dict[tuple[object, ...], DeclaredSensor] = {}
    unknown: list[str] = []
    for sensor in model.sensors:
        product = _PRODUCTS.get(sensor.kind)
        if sensor.kind.startswith(_OF_JOINTS):
            continue
        if product is None or (sensor.body not in links and product != "Clock"):
            unknown.append(f"'{sensor.name:.60}' ({sensor.kind})")
            continue
        place = pose(sensor.position, sensor.quaternion)
        properties: tuple[tuple[str, float | int], ...] = ()
        if sensor.kind == "camera":
            place = place @ _FROM_CAMERA
            properties = _view(*sensor.values)
        elif sensor.kind == "rangefinder":
            place = place @ _FROM_FINDER
            if math.isfinite(sensor.values[0]) and sensor.values[0] > 0.0:
                properties = (("range", min(max(sensor.values[0], 1e-3), 1e6)),)
        x, y, z = place.translation
        declaration = DeclaredSensor(
            sensor.name, product, links.get(sensor.body, ""), (x, y, z), nine(list(place.to_3x3())), properties
        )
        own = (sensor.name,) if product in _SINGLE else ()
        # the contacts are those of the whole body
        where = () if product == "ContactForce" else (sensor.position, sensor.quaternion)
        by_site.setdefault((product, sensor.body, *where, *own), declaration)
    warnings = []
    if unknown:
        more = f" and {len(unknown) - 10} more" if len(unknown) > 10 else ""
        warnings.append(f"sensors that MORSE does not have are left out: {', '.join(unknown[:10])}{more}")
    return list(by_site.values()), warnings


def _view(angle: float, width: float, height: float) -> tuple[tuple[str, float | int], ...]:
    """Return the properties of a camera.

    Args:
        angle: vertical field of view, deg.
        width, height: pixels; 1 for those of MORSE, whose images are square then.
    """
    size: tuple[tuple[str, float | int], ...] = ()
    if min(width, height) > 1.0:
        wide, high = (int(min(pixels, _MOST_PIXELS)) for pixels in (width, height))
        size = (("cam_width", wide), ("cam_height", high))
        angle = 2.0 * math.degrees(math.atan(math.tan(math.radians(min(angle, 179.0)) / 2.0) * wide / high))
    return (*size, ("cam_fov", min(max(angle, 1.0), 179.0)))


#: maximum number of bodies, and maximum depth of the tree of bodies
MOST_BODIES, _DEEPEST = 10_000, 200


@dataclass(frozen=True, slots=True)
class Group:
    """Bodies that become one robot or object.

    Attributes:
        tops: those below the world.
        bodies: all, parents first.
        base: the body with the free joint, or None for bodies that are fixed to the world.
        flexes: numbers of the deformable bodies that they carry.
        soft: the bodies of which these consist.
    """

    tops: tuple[int, ...]
    bodies: tuple[int, ...]
    base: int | None
    flexes: tuple[int, ...] = ()
    soft: tuple[int, ...] = ()


def groups_of(model: ModelData, path: Path) -> list[Group]:
    """Return the groups of a model, the robot first.

    Each free body is a group, and all fixed bodies together. The robot is the group with most joints; of several, a
    free one.

    Raises:
        AssetError: there are too many bodies, or they are nested too deeply.
    """
    bodies, joints = model.bodies, model.joints
    if len(bodies) > MOST_BODIES:
        raise AssetError(path, f"it has {len(bodies)} bodies, more than {MOST_BODIES}")
    top_of, depth = {0: 0}, {0: 0}
    members: dict[int, list[int]] = {}
    soft: dict[int, list[int]] = {}
    for index in range(1, len(bodies)):
        parent = bodies[index].parent
        top_of[index] = top = index if parent == 0 else top_of[parent]
        depth[index] = depth[parent] + 1
        if depth[index] > _DEEPEST:
            raise AssetError(path, f"the tree of bodies is deeper than {_DEEPEST}")
        (soft if bodies[index].is_soft else members).setdefault(top, []).append(index)
    free = [top for top in members if any(joints[joint].kind == "free" for joint in bodies[top].joints)]
    anchors = [top for top in members if top not in free]
    carried: dict[int, list[int]] = {}
    for number, flex in enumerate(model.flexes):
        carried.setdefault(top_of[flex.body], []).append(number)
    groups = [
        Group((top,), tuple(members[top]), top, tuple(carried.get(top, ())), tuple(soft.get(top, ()))) for top in free
    ]
    on_world = [top for top in soft if top not in members]
    flexes = tuple(number for top, numbers in carried.items() if top not in free for number in numbers)
    if anchors or flexes:
        fixed = tuple(index for top in anchors for index in members[top])
        loose = tuple(index for top in (*anchors, *on_world) for index in soft.get(top, ()))
        groups.append(Group((*anchors, *on_world), fixed, None, flexes, loose))

    def count(group: Group) -> int:
        return sum(joints[joint].kind != "free" for body in group.bodies for joint in bodies[body].joints)

    return sorted(groups, key=lambda group: -count(group))


#: largest accepted length, m, and mass, kg
_FARTHEST, _HEAVIEST = 1e6, 1e9


def check_sizes(model: ModelData, path: Path) -> None:
    """Check lengths and masses.

    Raises:
        AssetError: one of them is too large.
    """
    lengths = [
        *(("body", one.name, one.position) for one in model.bodies),
        *(("joint", one.name, (*one.position, *(one.limits or ()))) for one in model.joints if one.kind == "slide"),
        *(("shape", one.name, (*one.position, *one.size)) for one in model.geoms if one.kind != "plane"),
    ]
    for what, name, values in lengths:
        largest = max(map(abs, values), default=0.0)
        if not largest <= _FARTHEST:
            raise AssetError(
                path, f"the {what} '{name:.60}' has a length of {largest:.3g} m, more than {_FARTHEST:g} m"
            )
    for body in model.bodies:
        if not body.inertial[0] <= _HEAVIEST:
            raise AssetError(
                path, f"the body '{body.name:.60}' has a mass of {body.inertial[0]:.3g} kg, more than {_HEAVIEST:g} kg"
            )


#: mass of what has none, kg
_LIGHTEST = 1e-3
#: of the engine, s: a tick has 167 of them; robots with fine contacts have steps of 0.5 to 2 ms
_SHORTEST_STEP = 1e-4
#: from so many equal names on, they are counted
_MOST_SUFFIXES = 9
#: height of a plane that is the floor, m
_FLOOR = 1e-3


def read_mjcf(path: str | Path) -> Library:
    """Read a robot.

    Its bodies become nodes with the same names below the armature ``<model>_joints``, whose bones are the joints.
    Further bodies become objects. The origin of a free robot is that of its free body.

    Raises:
        AssetError: the file is broken, or the engine refuses it.
        OSError: it cannot be opened.
    """
    from morse.assets.mjcf.model import compiled

    source = Source(Path(path))
    return _Reader(source, compiled(source)).library()


class _Reader:
    def __init__(self, source: Source, model: ModelData) -> None:
        self.source, self.model = source, model
        self.warnings = [*source.warnings, *dict.fromkeys(model.lost)]
        if model.step < _SHORTEST_STEP:
            self.warnings.append(f"its time step of {model.step:g} s is too short: it is {_SHORTEST_STEP:g} s here")
        self._images = TextureImages(source.textures)
        #: names that are taken, and how often each was to be taken again
        self._names: dict[str, int] = {}
        self._ground: tuple[float, ...] = DEFAULT_CONTACT
        self._has_floor = False
        #: numbers of the level planes below height 0
        self._lower_floors: set[int] = set()
        #: name of the node of a shape to the number of the geom
        self._shape_of: dict[str, int] = {}

    def library(self) -> Library:
        check_sizes(self.model, self.source.path)
        hide_collision_shapes(self.model)
        self.warnings += add_skins(self.model, self.source.skins)
        if self._is_bare() and len(self.model.geoms) == 1:
            # the floor of a world that has nothing else
            return self._terrain()
        self._ground = self._floor()
        if self._is_bare():
            return self._terrain()
        name = self.source.name
        self._names = {name: 0, f"{name}_joints": 0}
        robot, *others = groups_of(self.model, self.source.path)
        root, links = self._body(robot, name)
        objects = [self._object(group) for group in others]
        if robot.base is not None and not any(group.base is None for group in others):
            ground = Node(self._name(f"{name}_world"))
            self._add_shapes(ground, self.model.bodies[0])
            if ground.children:
                ground.body = BodySettings(type=PhysicsType.STATIC)
                ground.articulation = Articulation(model=self._part((), (), ground, {}))
                objects.append(ground)
        sensors, remarks = sensors_of(self.model, links)
        return Library(
            str(self.source.path),
            roots=[root, *objects],
            robot=root.name if objects else "",
            sensors=sensors,
            keyframes=self._keyframes(robot),
            warnings=[*self.warnings, *self._images.pictures.warnings, *remarks],
        )

    def _is_bare(self) -> bool:
        """Whether there is nothing but the shapes of the world."""
        return len(self.model.bodies) == 1 and not self.model.flexes

    def _terrain(self) -> Library:
        """A file without bodies: the shapes of its world."""
        root = Node(self.source.name, source_name=self.source.name)
        self._names = {root.name: 0}
        self._add_shapes(root, self.model.bodies[0])
        if not root.children:
            reasons = f": {'; '.join(self.warnings[:3])}" if self.warnings else ""
            raise AssetError(self.source.path, f"it has no bodies and no shapes{reasons}")
        root.articulation = Articulation(model=self._part((), (), root, {}))
        return Library(str(self.source.path), roots=[root], warnings=[*self.warnings, *self._images.pictures.warnings])

    # -- bodies ----------------------------------------------------------------------------

    def _object(self, group: Group) -> Node:
        """Return the node of bodies that do not belong to the robot."""
        name = f"{self.source.name}_world" if group.base is None else self.model.bodies[group.base].name
        name = self._name(name)
        self._names.setdefault(f"{name}_joints", 0)
        return self._body(group, name)[0]

    def _body(self, group: Group, name: str) -> tuple[Node, dict[int, str]]:
        """Return the node of a group, and the names of the nodes of its bodies."""
        model, base = self.model, group.base
        bones = Bones(model, list(group.bodies), base)
        self.warnings += bones.warnings
        mass = sum(model.bodies[index].inertial[0] for index in (*group.bodies, *group.soft))
        body = BodySettings(
            type=PhysicsType.STATIC if base is None else PhysicsType.RIGID_BODY,
            compound=True,
            mass=mass or _LIGHTEST,
            linear_damping=0.0,
            angular_damping=0.0,
        )
        root, armature = robot_node(name, body, bones.bones)
        links = {index: self._name(model.bodies[index].name, "_link") for index in group.bodies}
        nodes = ((self._link(links[index], model.bodies[index]), *bones.hung[index]) for index in group.bodies)
        attach_links(armature, nodes)
        if base is None:
            world = Node(self._name("world"), source_name="world")
            self._add_shapes(world, model.bodies[0])
            if world.children:
                armature.attach(world)
        else:
            here = pose(model.bodies[base].position, model.bodies[base].quaternion)
            root.location, root.rotation_euler = list(here.translation), list(here.to_euler())
        place = Matrix.Identity(4) if base is None else here
        flexes = {}
        for number in group.flexes:
            node = flex_node(model.flexes[number], self._name(model.flexes[number].name), place, self._images)
            for child in node.children:
                child.name = self._name(child.name)
            for member in node.walk():
                member.source_name = member.name
            root.attach(node)
            flexes[node.name] = model.flexes[number].name
        both = {*group.bodies, 0}
        apart = tuple((links[a], links[b]) for a, b in model.apart if {a, b} <= both - {0})
        part = replace(self._part(group.tops, group.bodies, root, links, bones), flexes=flexes)
        armature.articulation = Articulation(mass=mass, self_collision=True, apart=apart)
        root.articulation = Articulation(mass=mass, model=part)
        return root, links

    def _part(
        self, tops: Iterable[int], bodies: Iterable[int], root: Node, links: dict[int, str], bones: Bones | None = None
    ) -> MjcfModel:
        """Return the part of the model that belongs to a node."""
        model = self.model
        geoms = {number: geom.name for number, geom in enumerate(model.geoms)}
        base = next(
            (top for top in tops if any(model.joints[j].kind == "free" for j in model.bodies[top].joints)), None
        )
        names = [model.bodies[top].name for top in tops]
        own = set(links)
        return MjcfModel(
            model.file,
            tuple(names if base is not None else [*names, "world"]),
            base="" if base is None else model.bodies[base].name,
            links={links[index]: model.bodies[index].name for index in bodies},
            shapes={
                node.source_name or node.name: geoms[self._shape_of[node.source_name or node.name]]
                for node in root.walk()
                if (node.source_name or node.name) in self._shape_of
            },
            step=max(model.step, _SHORTEST_STEP),
            motors={} if bones is None else bones.motors,
            ground=self._ground,
            is_joined=any((one in own) != (other in own) for one, other in model.joined if one and other),
            has_floor=self._has_floor,
            floors=tuple(
                name
                for node in root.walk()
                if self._shape_of.get(name := node.source_name or node.name, -1) in self._lower_floors
            ),
        )

    def _link(self, name: str, body: BodyData) -> Node:
        node = Node(name, source_name=name)
        mass, centre, rotation, moments = body.inertial
        if mass:
            axes = np.array([list(row) for row in pose((0.0, 0.0, 0.0), rotation).to_3x3()])
            a, b, c, d, e, f, g, h, i = (
                float(value) for value in (matmul(matmul(axes, np.diag(moments)), axes.T)).ravel()
            )
            x, y, z = centre
            node.inertial = Inertial(mass, (x, y, z), (a, b, c, d, e, f, g, h, i))
        self._add_shapes(node, body)
        return node

    # -- shapes ----------------------------------------------------------------------------

    def _floor(self) -> tuple[float, ...]:
        """Return the contact parameters of the plane that is the floor, and leave it out if it is at height 0."""
        planes = [
            number
            for number in self.model.bodies[0].geoms
            if (geom := self.model.geoms[number]).kind == "plane"
            and geom.position[2] <= _FLOOR
            and abs(geom.quaternion[1]) + abs(geom.quaternion[2]) < 1e-6
        ]
        floors = [number for number in planes if self.model.geoms[number].position[2] >= -_FLOOR]
        for number in floors:
            self.model.bodies[0].geoms.remove(number)
        self._has_floor = bool(floors)
        if not floors:
            floors = [number for number in planes if any(self.model.geoms[number].masks)]
            self._lower_floors = set(floors)
        return self.model.geoms[floors[0]].contact if floors else DEFAULT_CONTACT

    def _add_shapes(self, node: Node, body: BodyData) -> None:
        for number in body.geoms:
            geom = self.model.geoms[number]
            if geom.kind == "other":
                self.warnings.append(f"the shape '{geom.name:.60}' is left out: it has an unknown type")
                continue
            name = self._name(geom.name, "_shape")
            self._shape_of[name] = number
            node.attach(shape_node(geom, name, self._images))

    def _name(self, name: str, suffix: str = "_") -> str:
        first = name
        while name in self._names:
            number = self._names[first] = self._names[first] + 1
            # a thousand equal names would have a thousand suffixes
            name = first + (suffix * number if number < _MOST_SUFFIXES else f"{suffix}{number}")
        self._names[name] = 0
        return name

    # -- keyframes -------------------------------------------------------------------------

    def _keyframes(self, robot: Group) -> dict[str, Keyframe]:
        own = {joint for body in robot.bodies for joint in self.model.bodies[body].joints}
        keyframes = {}
        for name, values in self.model.keyframes.items():
            free = next((values[joint] for joint in own if self.model.joints[joint].kind == "free"), None)
            keyframes[name] = Keyframe(
                {self.model.joints[j].name: values[j] for j in own if self.model.joints[j].kind != "free"},
                None if free is None else (free[:3], free[3:]),
            )
        return keyframes
