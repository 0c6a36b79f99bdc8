"""MJCF files as libraries of nodes: a body, and below it an armature that moves the links."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.errors import AssetError
from morse.assets.mjcf.joints import Bones, pose
from morse.assets.mjcf.sensors import sensors_of
from morse.assets.mjcf.shapes import shape_node
from morse.assets.mjcf.source import Source
from morse.mathutils import Matrix
from morse.mathutils.portable import matmul
from morse.scene import Articulation, BodySettings, Inertial, Library, Node, NodeKind, PhysicsType
from morse.scene.bone_frames import start_frames

if TYPE_CHECKING:
    from morse.assets.mjcf.model import BodyData, ModelData

_LIGHTEST = 1e-3
#: largest accepted length, m, and mass, kg
_FARTHEST, _HEAVIEST = 1e6, 1e9
#: maximum number of bodies, and maximum depth of the tree of bodies
_MOST_BODIES, _DEEPEST = 2000, 200


def read_mjcf(path: str | Path) -> Library:
    """Read a robot.

    Its bodies become nodes with the same names below the armature ``<model>_joints``, whose bones are the joints.

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
        self._names: set[str] = set()

    def library(self) -> Library:
        self._demand_usual_sizes()
        if len(self.model.bodies) == 1:
            return self._terrain()
        robot_bodies, base = self._choose()
        bones = Bones(self.model, robot_bodies)
        self.warnings += bones.warnings
        mass = sum(self.model.bodies[index].inertial[0] for index in robot_bodies)
        body = BodySettings(
            type=PhysicsType.STATIC if base is None else PhysicsType.RIGID_BODY,
            compound=True,
            mass=max(mass, _LIGHTEST),
        )
        name = self.source.name
        self._names = {name, f"{name}_joints"}
        root = Node(name, body=body, source_name=name)
        armature = Node(f"{name}_joints", NodeKind.ARMATURE, source_name=f"{name}_joints")
        armature.bones = tuple(bones.bones)
        root.attach(armature)
        links = {index: self._link_name(index) for index in (*robot_bodies, 0)}
        apart = tuple((links[a], links[b]) for a, b in self._apart(robot_bodies))
        # a robot that is free cannot be tied to the world
        places = {index: name for index, name in links.items() if index or base is None}
        reading = self.model.couplings(places, bones.names)
        couplings = reading.read()
        self.warnings += dict.fromkeys(reading.lost)
        armature.articulation = Articulation(mass=mass, self_collision=True, apart=apart, couplings=couplings)
        root.articulation = Articulation(mass=mass)
        frames = []
        for (x, y, z), r in start_frames(armature.bones):
            frame = Matrix((r[:3], r[3:6], r[6:])).to_4x4()
            frame.translation = (x, y, z)
            frames.append(frame)
        for index in robot_bodies:
            bone, local = bones.hung[index]
            place = local if bone < 0 else frames[bone] @ local
            link = self._link(links[index], self.model.bodies[index])
            link.bone = armature.bones[bone].name if bone >= 0 else ""
            link.location, link.rotation_euler = list(place.translation), list(place.to_euler())
            armature.attach(link)
        world = Node(links[0], source_name=links[0])
        self._add_shapes(world, self.model.bodies[0])
        if world.children and base is None:
            armature.attach(world)
        elif world.children:
            self.warnings.append(f"{len(world.children)} shapes of the world are ignored, because the robot is free")
        sensors, remarks = sensors_of(self.model, {index: links[index] for index in robot_bodies})
        return Library(str(self.source.path), roots=[root], sensors=sensors, warnings=[*self.warnings, *remarks])

    def _terrain(self) -> Library:
        """A file without bodies: the shapes of its world."""
        root = Node(self.source.name, source_name=self.source.name)
        self._names = {root.name}
        self._add_shapes(root, self.model.bodies[0])
        if not root.children:
            raise AssetError(self.source.path, "it has no bodies and no shapes")
        return Library(str(self.source.path), roots=[root], warnings=self.warnings)

    def _demand_usual_sizes(self) -> None:
        """Refuse lengths and masses that are too large for the physics."""
        model = self.model
        lengths = [
            *(("body", one.name, one.position) for one in model.bodies),
            *(("joint", one.name, (*one.position, *(one.limits or ()))) for one in model.joints if one.kind == "slide"),
            *(("shape", one.name, (*one.position, *one.size)) for one in model.geoms if one.kind != "plane"),
        ]
        for what, name, values in lengths:
            largest = max(map(abs, values), default=0.0)
            if not largest <= _FARTHEST:
                raise AssetError(
                    self.source.path,
                    f"the {what} '{name:.60}' has a length of {largest:.3g} m, more than {_FARTHEST:g} m",
                )
        for body in model.bodies:
            if not body.inertial[0] <= _HEAVIEST:
                raise AssetError(
                    self.source.path,
                    f"the body '{body.name:.60}' has a mass of {body.inertial[0]:.3g} kg, more than {_HEAVIEST:g} kg",
                )

    def _choose(self) -> tuple[list[int], int | None]:
        """Return the bodies of the robot, parents first, and the free body; None for the latter if it is fixed."""
        bodies, joints = self.model.bodies, self.model.joints
        if len(bodies) > _MOST_BODIES:
            raise AssetError(self.source.path, f"it has {len(bodies)} bodies, more than {_MOST_BODIES}")
        tops = [index for index in range(1, len(bodies)) if bodies[index].parent == 0]
        if not tops:
            raise AssetError(self.source.path, "it has no bodies")
        free = [i for i in tops if any(joints[joint].kind == "free" for joint in bodies[i].joints)]
        base = free[0] if free and len(free) == len(tops) else None
        others = [index for index in free if index != base]
        if others:
            names = ", ".join(f"'{bodies[index].name:.60}'" for index in others[:5])
            self.warnings.append(f"a robot has at most one free body; {names} are ignored")
        robot_bodies: list[int] = []
        depth = {0: 0}
        for index in range(1, len(bodies)):
            parent = bodies[index].parent
            if index in others or parent not in depth:
                continue
            depth[index] = depth[parent] + 1
            if depth[index] > _DEEPEST:
                raise AssetError(self.source.path, f"the tree of bodies is deeper than {_DEEPEST}")
            robot_bodies.append(index)
        return robot_bodies, base

    def _link_name(self, index: int) -> str:
        name = self.model.bodies[index].name
        while name in self._names:
            name += "_link"
        self._names.add(name)
        return name

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

    def _add_shapes(self, node: Node, body: BodyData) -> None:
        for number in body.geoms:
            geom = self.model.geoms[number]
            if geom.kind in ("plane", "other"):
                what = "plane: the environment provides the floor" if geom.kind == "plane" else "unknown shape"
                if what not in " ".join(self.warnings):
                    self.warnings.append(f"the shape '{geom.name:.60}' is ignored: {what}")
                continue
            name = geom.name
            while name in self._names:
                name += "_shape"
            self._names.add(name)
            node.attach(shape_node(geom, name))

    def _apart(self, robot_bodies: list[int]) -> list[tuple[int, int]]:
        """Return the pairs of bodies that the file excludes from collision, or whose masks exclude it."""
        bodies, body_set = self.model.bodies, {*robot_bodies, 0}
        pairs = [pair for pair in self.model.apart if set(pair) <= body_set]
        masks = {i: [self.model.geoms[geom].masks for geom in bodies[i].geoms] for i in (*robot_bodies, 0)}
        numbers = sorted(masks)
        pairs += [
            (one, other)
            for position, one in enumerate(numbers)
            for other in numbers[position + 1 :]
            if masks[one] and masks[other] and not _meet(masks[one], masks[other])
        ]
        return pairs


def _meet(some: list[tuple[int, int]], others: list[tuple[int, int]]) -> bool:
    """Whether any of the shapes collides with any of the others, by their masks."""
    return any((a[0] & b[1]) or (b[0] & a[1]) for a in some for b in others)
