"""Objects of a file as nodes."""

from __future__ import annotations

import math
from math import pi, radians
from typing import TYPE_CHECKING, NamedTuple

from morse.assets.body_settings import settle
from morse.mathutils import Euler, Matrix, Quaternion, Vector
from morse.mathutils.rotations import nine
from morse.plugins.blend.bodies import debug_properties, game_properties, game_settings, id_properties, rigid_body
from morse.plugins.blend.container import Damage
from morse.plugins.blend.file import datablock_name
from morse.plugins.blend.poses import BONE, is_identity, matrix, parent_frame, parent_kind, pose
from morse.plugins.blend.unevaluated import crease_angle
from morse.scene import Bone, Camera, JointKind, Light, Node, NodeKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.plugins.blend.file import BlendFile, Record
    from morse.plugins.blend.materials import Materials
    from morse.plugins.blend.meshes import Meshes
    from morse.scene import Material

_LOCKED = (1 << 0, 1 << 1, 1 << 2)
_LIMITED = (1 << 3, 1 << 4, 1 << 5)
_CONNECTED = 1 << 4
_MAX_BONES = 4096
_AXIS_ANGLE = -1
_ORDERS = ("", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
_SHORTEST = 1e-9
_ORIGIN = (0.0, 0.0, 0.0)
_UNIT_QUATERNION = (1.0, 0.0, 0.0, 0.0)


class _Joint(NamedTuple):
    kind: JointKind = JointKind.FIXED
    axis: int = 1
    free: tuple[bool, bool, bool] = (False, False, False)
    low: float = 0.0
    high: float = 0.0
    value: float = 0.0


def bones(record: Record) -> tuple[Bone, ...]:
    """Return the bones of an armature object, parents before their children.

    Bones beyond the first 4096 are left out, with a warning.
    """
    armature = record.follow("data", "bArmature")
    if armature is None:
        return ()
    pose = record.follow("pose", "bPose") if record.has("pose") else None
    channels = {} if pose is None else {c.text("name"): c for c in pose.chain("chanbase", "bPoseChannel")}
    bone_list: list[Bone] = []
    frames: list[Matrix] = []
    for bone, parent in _walk(armature):
        if len(bone_list) >= _MAX_BONES:
            record.file.warn(f"an armature has more than {_MAX_BONES} bones; the others are left out")
            break
        name = bone.text("name")
        frame = _rest(bone)
        local = frame if parent < 0 else frames[parent].inverted() @ frame
        channel = channels.get(name)
        joint = _Joint() if channel is None else _joint(channel)
        if channel is not None:
            local = local @ _fixed_part(bone, channel, joint)
        length = math.dist(bone.reals("arm_head", _ORIGIN), bone.reals("arm_tail", _ORIGIN))
        x, y, z = local.translation
        rotation = nine(list(local.to_3x3()))
        bone_list.append(Bone(name, parent, (x, y, z), rotation, length, *joint))
        frames.append(frame)
    return tuple(bone_list)


def _walk(armature: Record) -> Iterator[tuple[Record, int]]:
    """Iterate over all bones with the index of the parent bone; parents first, in the order of the file."""
    queue = [(bone, -1) for bone in reversed(list(armature.chain("bonebase", "Bone")))]
    bones_so_far: set[int] = set()
    while queue:
        bone, parent = queue.pop()
        if bone.block.offset in bones_so_far:
            continue
        index = len(bones_so_far)
        bones_so_far.add(bone.block.offset)
        yield bone, parent
        queue.extend((child, index) for child in reversed(list(bone.chain("childbase", "Bone"))))


def _rest(bone: Record) -> Matrix:
    """The rest pose of a bone in the frame of the armature, without scale."""
    frame = matrix(bone, "arm_mat")
    rotation = frame.to_3x3() if abs(frame.determinant()) > _SHORTEST else Matrix.Identity(3)
    result = rotation.to_quaternion().normalized().to_matrix().to_4x4()
    result.translation = bone.reals("arm_head", _ORIGIN)
    return result


def _joint(channel: Record) -> _Joint:
    """The joint that the channel of a bone describes."""
    flags = channel.integer("ikflag", 0)
    stretch = channel.real("ikstretch")
    if stretch > 0.0:
        value = min(max(channel.reals("loc", _ORIGIN)[1], 0.0), stretch)
        return _Joint(JointKind.PRISMATIC, low=0.0, high=stretch, value=value)
    x, y, z = (not flags & mask for mask in _LOCKED)
    if not (x or y or z):
        return _Joint()
    axis = (x, y, z).index(True)
    low, high = -math.pi, math.pi
    if flags & _LIMITED[axis]:
        one, other = channel.reals("limitmin", (low,) * 3)[axis], channel.reals("limitmax", (high,) * 3)[axis]
        low, high = min(one, other), max(one, other)
    pose = _posed(channel)
    angle = math.remainder(2.0 * math.atan2(pose[axis + 1], pose[0]), math.tau)
    return _Joint(JointKind.REVOLUTE, axis, (x, y, z), low, high, min(max(angle, low), high))


def _posed(channel: Record) -> Quaternion:
    """The rotation of a bone from its rest pose, as it was saved."""
    mode = channel.integer("rotmode", 0)
    if 0 < mode < len(_ORDERS):
        return Euler(channel.reals("eul", _ORIGIN), _ORDERS[mode]).to_quaternion()
    if mode == _AXIS_ANGLE:
        axis, angle = channel.reals("rotAxis", (0.0, 1.0, 0.0)), channel.real("rotAngle")
        length = math.hypot(*axis)
        if length <= _SHORTEST:
            return Quaternion(_UNIT_QUATERNION)
        half = math.sin(0.5 * angle) / length
        return Quaternion((math.cos(0.5 * angle), *(half * value for value in axis)))
    quaternion = Quaternion(channel.reals("quat", _UNIT_QUATERNION))
    return quaternion.normalized() if quaternion.magnitude > _SHORTEST else Quaternion(_UNIT_QUATERNION)


def _fixed_part(bone: Record, channel: Record, joint: _Joint) -> Matrix:
    """Return the part of the saved pose relative to the rest pose that is not the value of the joint."""
    pose = _posed(channel)
    if joint.kind is JointKind.REVOLUTE:
        axis = Vector([float(i == joint.axis) for i in range(3)])
        pose = pose @ Quaternion((math.cos(0.5 * joint.value), *(-math.sin(0.5 * joint.value) * axis)))
    result = pose.to_matrix().to_4x4()
    if not bone.integer("flag", 0) & _CONNECTED:
        offset = list(channel.reals("loc", _ORIGIN))
        if joint.kind is JointKind.PRISMATIC:
            offset[1] -= joint.value
        result.translation = offset
    return result


_TYPES = {0: "POINT", 1: "SUN", 2: "SPOT", 3: "HEMI", 4: "AREA"}
#: since 2.80: power in watts (of a sun: irradiance in W/m^2) that looks like a lamp of energy 1. A new scene has a
#: point lamp of 1000 W. An area lamp emits only into one half space, mostly forward (1/pi of its power per steradian
#: along its axis; a point lamp 1/(4 pi)). A sun with pi W/m^2 fully lights a white wall.
_UNIT = {"POINT": 1000.0, "SPOT": 1000.0, "AREA": 250.0, "SUN": pi, "HEMI": pi}
_SHADOW, _OLD_SHADOWS = 1 << 0, (1 << 0) | (1 << 13)
_LEGACY_SENSOR = 32.0


def light(record: Record) -> Light:
    """A lamp datablock."""
    old = record.file.version < 280
    kind = _TYPES.get(record.integer("type", 0), "POINT")
    red, green, blue = (min(max(record.real(channel, 1.0), 0.0), 1e3) for channel in "rgb")
    size = record.real(record.either("spotsize", "spot_size"), 45.0 if old else 0.785)
    return Light(
        type=kind,
        color=(red, green, blue),
        energy=_energy(record) / (1.0 if old else _UNIT[kind]),
        distance=max(record.real("dist", 25.0), 1e-3) if old else 25.0,
        # the angle was stored in degrees until 2.6x; values in radians are at most pi
        spot_size=radians(size) if size > pi + 1e-3 else max(size, 0.0),
        casts_shadow=bool(record.integer("mode", 1) & (_OLD_SHADOWS if old else _SHADOW)),
    )


def camera(record: Record) -> Camera:
    """A camera datablock."""
    sensor = record.real("sensor_x", _LEGACY_SENSOR)
    start = max(record.real(record.either("clipsta", "clip_start"), 0.1), 1e-6)
    return Camera(
        focal_length=max(record.real("lens", 35.0), 1e-3) * _LEGACY_SENSOR / (sensor if sensor > 0 else _LEGACY_SENSOR),
        clip_start=start,
        clip_end=max(record.real(record.either("clipend", "clip_end"), 100.0), start * 2),
    )


def _energy(record: Record) -> float:
    """The energy that Blender shows; 5.0 adds an exposure in stops."""
    energy = max(record.real(record.either("energy_new", "energy"), 1.0), 0.0)
    exposure: float = 2.0 ** min(max(record.real("exposure", 0.0), -32.0), 32.0)
    return energy * exposure


MESH, LIGHT, CAMERA, ARMATURE = 1, 10, 11, 25
_KINDS = {MESH: NodeKind.MESH, LIGHT: NodeKind.LIGHT, CAMERA: NodeKind.CAMERA, ARMATURE: NodeKind.ARMATURE}
_HIDDEN = 1 << 2
#: maximum length of a chain of parents
_MAX_DEPTH = 256
#: maximum coordinate, m, or scale
_FAR = 1e9


class Objects:
    """Creates the node of each object.

    Attributes:
        records: the objects by address, in the order of the file.
        nodes: their nodes, by address.
    """

    def __init__(self, file: BlendFile, materials: Materials, meshes: Meshes) -> None:
        self._file = file
        self._materials = materials
        self._meshes = meshes
        self.records = {record.block.address: record for record in file.datablocks("OB", "Object")}
        self.nodes: dict[int, Node] = {}
        for address, record in self.records.items():
            try:
                self.nodes[address] = self._node(record)
            except Damage as damage:
                file.warn(f"the object '{datablock_name(record)}' is damaged and is left out: {damage}")

    def _node(self, record: Record) -> Node:
        name = datablock_name(record)
        kind = record.integer("type")
        settings = settle(name, id_properties(record), rigid_body(record), game_settings(record))
        for warning in settings.warnings:
            self._file.warn(warning)
        location, rotation_euler, scale = pose(record)
        node = Node(
            name,
            _KINDS.get(kind, NodeKind.EMPTY),
            location,
            rotation_euler,
            scale,
            body=settings.body,
            shapes=settings.shapes,
            properties={**game_properties(record), **settings.properties},
            debug=debug_properties(record),
            visible=settings.visible
            and not record.integer(record.either("restrictflag", "visibility_flag"), 0) & _HIDDEN,
            source_name=name,
        )
        self._fill(node, kind, record)
        return node

    def _fill(self, node: Node, kind: int, record: Record) -> None:
        """Add the mesh, the light, the camera or the bones."""
        if kind == MESH:
            data = record.follow("data", "Mesh")
            node.mesh = None if data is None else self._meshes.mesh(data, crease_angle(record))
            if node.mesh is not None:
                slots = self.slots(record)
                if slots != list(node.mesh.materials[: len(slots)]):
                    node.materials = [*slots, *node.mesh.materials[len(slots) :]]
        elif kind == LIGHT:
            data = record.follow("data", "Lamp" if self._file.dna.index("Lamp") is not None else "Light")
            node.light = None if data is None else light(data)
        elif kind == CAMERA:
            data = record.follow("data", "Camera")
            node.camera = None if data is None else camera(data)
        elif kind == ARMATURE:
            node.bones = bones(record)

    def slots(self, record: Record) -> list[Material | None]:
        """Return the materials of an object: those of the object for slots of the object, else those of its mesh."""
        data = record.follow("data") if record.integer("data", 0) else None
        mesh_slots: list[Material | None] = []
        if data is not None and data.has("mat"):
            mesh_slots = self._materials.slots(data, "mat", data.integer("totcol", 0))
        own = record.content("matbits", len(mesh_slots))
        if not any(own):
            return mesh_slots
        slots = self._materials.slots(record, "mat", len(own))
        return [
            slots[i] if i < len(slots) and own[i : i + 1] > b"\0" else mesh_slot
            for i, mesh_slot in enumerate(mesh_slots)
        ]

    def connect(self) -> None:
        """Give every node its parent."""
        for address, above in self._parents().items():
            node, parent = self.nodes[address], self.nodes[above]
            node.parent = parent
            parent.children.append(node)
            record = self.records[address]
            inverse = matrix(record, "parentinv")
            frame = parent_frame(record, self.records[above])
            if frame is not None:
                inverse = frame @ inverse
            node.parent_inverse = None if is_identity(inverse) else inverse
            if parent.bones and parent_kind(record) == BONE:
                node.bone = record.text("parsubstr")
        for node in self.nodes.values():
            if node.parent is None:
                self._check_poses(node)

    def _check_poses(self, root: Node) -> None:
        """Correct poses that become too large by the product of the scales of parents."""
        queue = [(root, Matrix())]
        while queue:
            node, above = queue.pop()
            world = above @ node.local_matrix()
            if not all(abs(value) < _FAR for row in world for value in row):
                self._file.warn(
                    f"the object '{node.name}' has a pose that is too large or not finite; it is placed at its parent"
                )
                node.location, node.rotation_euler, node.scale = [0.0] * 3, [0.0] * 3, [1.0] * 3
                node.parent_inverse = None
                world = above
            queue.extend((child, world) for child in node.children)

    def _parents(self) -> dict[int, int]:
        """Return object to parent, without cycles and overlong chains."""
        parents = {address: self.records[address].integer("parent", 0) for address in self.nodes}
        parents = {address: above for address, above in parents.items() if above in self.nodes}
        depths: dict[int, int] = {}
        for start in self.nodes:
            path: dict[int, None] = {}
            current: int | None = start
            while current is not None and current not in depths and current not in path:
                path[current] = None
                current = parents.get(current)
            # an object that closes a cycle becomes a root
            depth = -1 if current is None or current in path else depths[current]
            for address in reversed(path):
                depth += 1
                if address in parents and (depth > _MAX_DEPTH or depth == 0):
                    self._file.warn(
                        f"the object '{self.nodes[address].name}' is its own ancestor, or has too many ancestors; "
                        "its parent is ignored"
                    )
                    del parents[address]
                    depth = 0
                depths[address] = depth
        return parents
