"""Robots and objects whose bodies, motors and options the engine reads from their MJCF files.

The part of a file that belongs to a robot is attached to the model of the scene as it is, with contact parameters,
tendons, constraints and actuators. Only what a scene has in another form is removed: sensors, cameras, key frames, and
the motors of single joints, which can change their control modes.

The time step of the engine is at most that of each file. In a scene whose robots all come from files, it may be as long
as there, the options of the first file apply, and the objects of the scene have the contact parameters of its floor.
Beside robots of other kinds, whose drives are tuned for the options of MORSE, those of files do not apply.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.layout import Motion
from morse.physics.model.shapes import ALL_BITS, OF_FILE, file_bits
from morse.scene import is_dynamic

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.core.values import Options
    from morse.physics.model.layout import Frame, Slot
    from morse.scene import Node
    from morse.scene.mjcf import MjcfModel


@dataclass(eq=False, slots=True)
class Part:
    """What a root of the scene has of a file.

    Attributes:
        root: the frame of the robot or object.
        prefix: of the names in the engine.
        bodies, geoms: all of them, as elements of the model.
        option: options of the file.
    """

    root: Frame
    model: MjcfModel
    prefix: str
    option: Options
    bodies: list[mujoco.MjsBody] = field(default_factory=list)
    geoms: list[mujoco.MjsGeom] = field(default_factory=list)


def model_of(frame: Frame) -> MjcfModel | None:
    """Return the model of a frame whose bodies the engine reads from a file."""
    node, pose = frame.node, frame.motion
    settings = node.articulation
    if frame.parent is not None or settings is None or settings.model is None or pose is Motion.FIXED:
        return None
    if not (settings.model.links or settings.model.flexes) or any(abs(value - 1.0) > 1e-9 for value in _scales(node)):
        return None
    armatures = [member for member in frame.members if member.bones]
    return settings.model if all(is_dynamic(armature) for armature in armatures) else None


def _scales(node: Node) -> Iterator[float]:
    one: Node | None = node
    while one is not None:
        yield from one.scale
        one = one.parent


@dataclass(eq=False, slots=True)
class FileMotor:
    """An actuator in the arrays of the engine.

    Attributes:
        armature: name of the node.
        name: name of the actuator; with the suffix ``_tendon`` or ``_motor`` if a joint has it.
        commands: smallest and largest command.
        start: initial command.
        actuator: id.
    """

    armature: str
    name: str
    commands: tuple[float, float]
    start: float
    actuator: int

    @property
    def key(self) -> tuple[str, str]:
        """What identifies the motor in the world."""
        return self.armature, self.name


def motors_of(model: mujoco.MjModel, armature: str) -> Iterator[FileMotor]:
    """Yield the actuators of an armature; those with position control at first hold their length."""
    prefix = f"{armature}/"
    joints = {model.joint(index).name for index in range(model.njnt)}
    for index in range(model.nu):
        full = model.actuator(index).name
        if not full.startswith(prefix) or full in joints:
            continue
        tendon = int(model.actuator_trntype[index]) == int(mujoco.mjtTrn.mjTRN_TENDON)
        name = full.removeprefix(prefix)
        name = name.removesuffix(SUFFIX)
        if full.removesuffix(SUFFIX) in joints:
            name += "_tendon" if tendon else "_motor"
        low, high = model.actuator_ctrlrange[index] if model.actuator_ctrllimited[index] else (-math.inf, math.inf)
        start, gain = 0.0, float(model.actuator_gainprm[index][0])
        if int(model.actuator_biastype[index]) == int(mujoco.mjtBias.mjBIAS_AFFINE) and gain:
            constant, stiffness = model.actuator_biasprm[index][:2]
            if stiffness:
                start = -(constant + stiffness * float(model.actuator_length0[index])) / gain
        yield FileMotor(armature, name, (float(low), float(high)), min(max(start, float(low)), float(high)), index)


#: of the names of actuators in the engine, in which the motor of a joint has the name of the joint
SUFFIX = " actuator"


#: smallest weight of contact parameters that counts
_LEAST = 1e-15


def add_pair(spec: mujoco.MjSpec, one: mujoco.MjsGeom, other: mujoco.MjsGeom) -> None:
    """Add a pair of geoms to a `mujoco.MjSpec`, with the parameters that a contact of these geoms has.

    The rules are those of the section "Contact parameters" of MuJoCo's documentation; the engine does not apply them to
    pairs.
    """
    pair = spec.add_pair(geomname1=one.name, geomname2=other.name)
    pair.margin, pair.gap = one.margin + other.margin, one.gap + other.gap
    if one.priority != other.priority:
        source = max(one, other, key=lambda geom: geom.priority)
        pair.condim, pair.solref, pair.solimp = source.condim, source.solref, source.solimp
        friction = np.array(source.friction)
    else:
        pair.condim = max(one.condim, other.condim)
        share = _share(float(one.solmix), float(other.solmix))
        stiffness, others = np.array(one.solref), np.array(other.solref)
        mixes = stiffness[0] > 0.0 and others[0] > 0.0
        pair.solref = share * stiffness + (1.0 - share) * others if mixes else np.minimum(stiffness, others)
        pair.solimp = share * np.array(one.solimp) + (1.0 - share) * np.array(other.solimp)
        friction = np.maximum(one.friction, other.friction)
    slide, torsion, roll = friction
    pair.friction = [slide, slide, torsion, roll, roll]


def touch_floors(spec: mujoco.MjSpec, floors: set[str]) -> None:
    """Let the shapes that an MJCF file pairs with floors touch the objects of a scene as they would touch these.

    The floors are not part of the scene. The objects of the scene touch any shape with the bits of a file, those of the
    same file only touch the shape if it has others as well.
    """
    first = 1 + max((geom.priority for geom in spec.geoms), default=0)
    for pair in spec.pairs:
        names = {pair.geomname1, pair.geomname2}
        if len(names & floors) != 1:
            continue
        geom = spec.geom((names - floors).pop())
        if geom is None:
            continue
        geom.priority, geom.condim, geom.margin, geom.gap = first, pair.condim, pair.margin, pair.gap
        geom.solref, geom.solimp = pair.solref, pair.solimp
        geom.friction = [pair.friction[0], pair.friction[2], pair.friction[3]]
        if not geom.contype and not geom.conaffinity:
            geom.contype, geom.conaffinity = OF_FILE, ALL_BITS


def _share(one: float, other: float) -> float:
    """The weight of the first geom."""
    if one >= _LEAST and other >= _LEAST:
        return one / (one + other)
    return 0.5 if max(one, other) < _LEAST else float(one >= _LEAST)


_FREE = mujoco.mjtJoint.mjJNT_FREE
_OF_FLEXES = tuple(getattr(mujoco.mjtEq, name) for name in dir(mujoco.mjtEq) if name.startswith("mjEQ_FLEX"))
_CONTACT = ("friction", "solref", "solimp", "solmix", "margin", "gap", "condim", "priority")


class Files:
    """The parts of files in the model of a scene.

    Args:
        spec: the model.

    Attributes:
        motors: the actuators that are not motors of single joints.
        link_bodies: the body of each link, also of those that are fixed to others.
    """

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._spec = spec
        self._parts: dict[Frame, Part] = {}
        self._of_link: dict[Node, Part] = {}
        self._terrain: dict[Node, tuple[mujoco.MjSpec, dict[str, str]]] = {}
        self.motors: list[FileMotor] = []
        self.link_bodies: dict[Node, int] = {}

    def __bool__(self) -> bool:
        return bool(self._parts)

    @property
    def parts(self) -> list[Part]:
        """All parts."""
        return list(self._parts.values())

    def part_of(self, frame: Frame) -> Part | None:
        """Return the part to which a frame belongs."""
        return self._parts.get(frame.root)

    # -- bodies ----------------------------------------------------------------------------

    def add(self, frame: Frame, slot: Slot, add_body: Callable[[Frame, Slot], mujoco.MjsBody]) -> mujoco.MjsBody | None:
        """Add the bodies of a frame, and return its own body; None if it does not come from a file."""
        part = self.part_of(frame)
        if part is not None:
            if frame.parent is None:
                return part.bodies[0]
            names = (part.model.links.get(node.source_name or node.name) for node in frame.members)
            name = next((name for name in names if name), None)
            return None if name is None else self._spec.body(part.prefix + name)
        model = model_of(frame)
        return None if model is None else self._attach(frame, slot, model, add_body)

    def _attach(
        self, frame: Frame, slot: Slot, model: MjcfModel, add_body: Callable[[Frame, Slot], mujoco.MjsBody]
    ) -> mujoco.MjsBody:
        spec = model.file.spec()
        armature = next((node for node in frame.members if node.bones), frame.node)
        part = self._parts[frame] = Part(frame, model, f"{armature.name}/", copy_of(spec.option))
        file_bits([*spec.geoms, *spec.flexes])
        _reduce(spec, model)
        names = [body.name for body in spec.bodies if body.name != "world"]
        shapes = [geom.name for geom in spec.geoms]
        if model.base:
            _move_to_origin(spec, spec.body(model.base))
        if frame.motion is Motion.FREE:
            rotation = np.zeros(4)
            mujoco.mju_mat2Quat(rotation, np.array([list(row) for row in slot.pose.rotation]).ravel())
            outer = self._spec.worldbody.add_frame(pos=list(slot.pose.position), quat=rotation)
            root = None
        else:
            for joint in [joint for joint in spec.joints if joint.type == _FREE]:
                spec.delete(joint)
            for body in spec.worldbody.bodies:
                body.mocap = False
            root = add_body(frame, slot)
            # the engine hangs nothing elastic on bodies with given poses
            root.mocap = root.mocap and not model.flexes
            outer = root.add_frame()
        for name in dir(spec.option):
            if not name.startswith("_"):
                value = getattr(self._spec.option, name)
                if not callable(value):
                    setattr(spec.option, name, value)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self._spec.attach(spec, frame=outer, prefix=part.prefix)
        part.bodies = [self._spec.body(part.prefix + name) for name in names]
        part.geoms = [self._spec.geom(part.prefix + name) for name in shapes]
        if root is not None:
            part.bodies.insert(0, root)
            self._let_fixed_links_touch(part)
        return part.bodies[0]

    def _let_fixed_links_touch(self, part: Part) -> None:
        """Add the pairs of fixed shapes and the shapes that the first joints move.

        The engine ignores contacts of a moving body with its parent, unless the latter belongs to the world; the fixed
        bodies of a file do, those of a robot that can be placed elsewhere do not.
        """
        fixed: list[mujoco.MjsGeom] = []
        moving: list[tuple[mujoco.MjsBody, list[mujoco.MjsGeom]]] = []

        def walk(body: mujoco.MjsBody, group: list[mujoco.MjsGeom]) -> None:
            for child in body.bodies:
                if list(child.joints):
                    if group is fixed:
                        own = list(child.geoms)
                        moving.append((child, own))
                        walk(child, own)
                    continue
                group.extend(child.geoms)
                walk(child, group)

        fixed.extend(part.bodies[0].geoms)
        walk(part.bodies[0], fixed)
        apart = {frozenset((pair.bodyname1, pair.bodyname2)) for pair in self._spec.excludes}
        for one in fixed:
            for other in (geom for _, own in moving for geom in own):
                meet = (one.contype & other.conaffinity) | (other.contype & one.conaffinity)
                if meet and frozenset((one.parent.name, other.parent.name)) not in apart:
                    add_pair(self._spec, one, other)

    # -- shapes ----------------------------------------------------------------------------

    def geom(self, frame: Frame, node: Node) -> mujoco.MjsGeom | None:
        """Return the geom of a node, or None if it is not a shape of the file."""
        part = self.part_of(frame)
        name = None if part is None else part.model.shapes.get(node.source_name or node.name)
        return None if part is None or name is None else self._spec.geom(part.prefix + name)

    def set_contact(self, frame: Frame, node: Node, geom: object) -> None:
        """Give a shape of the world of a file, which the scene has as a static object, the parameters of the file."""
        settings = frame.node.articulation
        if settings is None or settings.model is None or frame in self._parts:
            return
        name = settings.model.shapes.get(node.source_name or node.name)
        if frame.node not in self._terrain:
            self._terrain[frame.node] = settings.model.file.spec(), settings.model.shapes
        original = self._terrain[frame.node][0].geom(name) if name else None
        if original is not None:
            for attribute in _CONTACT:
                setattr(geom, attribute, getattr(original, attribute))

    # -- deformable bodies -----------------------------------------------------------------

    def flexes(self) -> Iterator[tuple[Node, str]]:
        """Yield the nodes of the deformable bodies, and the names of these in the engine."""
        for part in self.parts:
            for node in part.root.node.children:
                name = part.model.flexes.get(node.source_name or node.name)
                if name is not None:
                    yield node, part.prefix + name

    def stand_for_flexes(self) -> tuple[mujoco.MjsGeom, Node] | None:
        """Add the last shape of the model, which touches nothing, if there are deformable bodies.

        The contacts of the engine have the number -1 for a deformable body, which is the last one of any array. So
        what reads contacts finds a shape of a deformable body.
        """
        node = next((node for node, _ in self.flexes()), None)
        if node is None:
            return None
        body = self._spec.worldbody.add_body(name=f"{node.name} (contacts)")
        return body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[1e-3, 0.0, 0.0], contype=0, conaffinity=0, mass=0.0
        ), node

    # -- after the compilation -------------------------------------------------------------

    def resolve(self, model: mujoco.MjModel, data: mujoco.MjData, geom_node: list[Node]) -> None:
        """Give shapes without a node that of their root, set the masses, and find the actuators."""
        is_changed = False
        for part in self.parts:
            for geom in part.geoms:
                if geom_node[geom.id] is None:
                    geom_node[geom.id] = part.root.node
            # the first body of a fixed robot stands for the world, whose shapes have no mass in the file
            first = 0 if part.root.motion is Motion.FREE else 1
            bodies = [body.id for body in part.bodies[first:]]
            mass = float(model.body_mass[bodies].sum())
            wanted = part.root.node.body.mass
            if mass and abs(wanted - mass) > 1e-9 * mass:
                model.body_mass[bodies] *= wanted / mass
                model.body_inertia[bodies] *= wanted / mass
                is_changed = True
            armature = next((node for node in part.root.members if node.bones), None)
            if armature is not None:
                self.motors += motors_of(model, armature.name)
                for link in armature.children:
                    name = part.model.links.get(link.source_name or link.name)
                    if name:
                        self.link_bodies[link] = self._spec.body(part.prefix + name).id
        if is_changed:
            mujoco.mj_setConst(model, data)
            mujoco.mj_resetData(model, data)


def _move_to_origin(spec: mujoco.MjSpec, base: mujoco.MjsBody) -> None:
    """Place a free body so that its frame in the compiled model is that of the world."""
    base.set_frame(spec.worldbody.add_frame())
    base.pos, base.quat = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    base.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    joint = next(joint for joint in base.joints if joint.type == _FREE)
    is_aligned = mujoco.mjtAlignFree.mjALIGNFREE_TRUE
    if joint.align == is_aligned or (joint.align == mujoco.mjtAlignFree.mjALIGNFREE_AUTO and spec.compiler.alignfree):
        # the compiler moves the frame to the centre of mass, along the principal axes of the inertia
        body = spec.copy().compile().body(base.name)
        turned = np.zeros(4)
        mujoco.mju_negQuat(turned, body.quat)
        place = np.zeros(3)
        mujoco.mju_rotVecQuat(place, -body.pos, turned)
        base.pos, base.quat = place, turned


def _reduce(spec: mujoco.MjSpec, model: MjcfModel) -> None:
    """Remove what does not belong to a part of a file, or what the scene has in another form."""
    needed = {name for pair in spec.pairs for name in (pair.geomname1, pair.geomname2)}
    lost = {flex.name for flex in spec.flexes} - set(model.flexes.values())
    for constraint in [one for one in spec.equalities if one.type in _OF_FLEXES and one.name1 in lost]:
        spec.delete(constraint)
    for flex in [flex for flex in spec.flexes if flex.name in lost]:
        spec.delete(flex)
    for body in list(spec.worldbody.bodies):
        if body.name not in model.tops:
            spec.delete(body)
    floors = [
        geom
        for geom in spec.worldbody.geoms
        if "world" not in model.tops or geom.name not in set(model.shapes.values())
    ]
    motors = set(model.motors.values())
    touch_floors(spec, {geom.name for geom in floors})
    removed = [
        *floors,
        *(actuator for actuator in spec.actuators if actuator.name in motors),
        *spec.sensors, *spec.keys, *spec.cameras, *spec.lights,
    ]  # fmt: skip
    for element in removed:
        spec.delete(element)
    for actuator in spec.actuators:
        actuator.name += SUFFIX
    needed |= {wrap.target.name for tendon in spec.tendons for wrap in tendon.path if wrap.target is not None}
    for body in spec.bodies:
        if body.explicitinertial and body.name != "world":
            for geom in [geom for geom in body.geoms if not (geom.contype or geom.conaffinity)]:
                if geom.name not in needed:
                    spec.delete(geom)
    meshes = {geom.meshname for geom in spec.geoms} | {
        site.meshname for site in spec.sites if hasattr(site, "meshname")
    }
    for mesh in [mesh for mesh in spec.meshes if mesh.name not in meshes]:
        spec.delete(mesh)


def copy_of(option: object) -> Options:
    """Return the options of a model."""
    names = (name for name in dir(option) if not name.startswith("_"))
    values = {name: getattr(option, name) for name in names}
    return {name: np.array(v) if isinstance(v, np.ndarray) else v for name, v in values.items() if not callable(v)}


#: options that the scene determines
_OF_SCENE = ("timestep", "gravity", "jacobian", "enableflags")
#: largest number of iterations of a solver
_MOST_ITERATIONS = 1000
_USUAL_GRAVITY = 9.81
#: depth of floors that stand for height 0, and their smallest half length, m
_NEARLY_LEVEL, _WIDE = 1e-4, 5.0
_FIELDS = (("friction", 3), ("solref", 2), ("solimp", 5), ("solmix", 1), ("margin", 1), ("gap", 1), ("condim", 1),
           ("priority", 1))  # fmt: skip


def models_of(frames: Sequence[Frame]) -> list[MjcfModel]:
    """Return the models of all robots and objects of a scene that the engine reads from files."""
    return [model for frame in frames if (model := model_of(frame)) is not None]


def are_all_from_files(frames: Sequence[Frame]) -> bool:
    """Whether a scene has robots, and all of them come from MJCF files."""
    robots = [frame for frame in frames if frame.robot is not None and frame.has_body]
    return bool(robots) and all(model_of(frame) is not None for frame in robots)


def set_ground(spec: mujoco.MjSpec, ground: Sequence[float]) -> None:
    """Set the contact parameters of the objects of a scene; see `MjcfModel.ground`."""
    geom, place = spec.default.geom, 0
    for name, count in _FIELDS:
        values = ground[place : place + count]
        place += count
        value = values[0] if count == 1 else list(values)
        setattr(geom, name, int(values[0]) if name in ("condim", "priority") else value)


def set_options(spec: mujoco.MjSpec, part: Part) -> None:
    """Set the options of a file."""
    option = spec.option
    for name, value in part.option.items():
        if name not in _OF_SCENE:
            setattr(option, name, min(value, _MOST_ITERATIONS) if "iterations" in name else value)
    # what sleeps does not creep: in such a scene, bodies sleep only if the file says so
    option.enableflags = int(part.option["enableflags"])
    if option.gravity[2] == -_USUAL_GRAVITY:
        option.gravity = part.option["gravity"]
    if option.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        option.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)


#: integrators with which the engine refuses elastic bodies
_NOT_ELASTIC = (mujoco.mjtIntegrator.mjINT_IMPLICIT, mujoco.mjtIntegrator.mjINT_IMPLICITFAST)


def let_flexes_bend(spec: mujoco.MjSpec) -> None:
    """Choose an integrator for elastic bodies if that of the scene does not integrate them.

    The motors of robots need an implicit one, which knows elastic bodies but no springs and dampers of their edges.
    """
    elastic = [flex for flex in spec.flexes if flex.young > 0.0]
    if elastic and spec.option.integrator in _NOT_ELASTIC:
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
        for flex in spec.flexes:
            flex.edgestiffness = flex.edgedamping = 0.0


def level(geom: mujoco.MjsGeom, height: float = 0.0) -> None:
    """Replace a wide floor at a height, or a little below it as in the worlds of MORSE 1.4, by a plane at that height.

    Robots of files are compared with those in other programs, whose floors are planes there.
    """
    is_level = geom.type == mujoco.mjtGeom.mjGEOM_BOX and abs(geom.quat[0]) > 1.0 - 1e-12
    top = geom.pos[2] + geom.size[2] - height
    if is_level and -_NEARLY_LEVEL <= top <= 1e-9 and (height or min(geom.size[:2]) >= _WIDE):
        geom.type = mujoco.mjtGeom.mjGEOM_PLANE
        geom.pos = [geom.pos[0], geom.pos[1], height]
        geom.size = [geom.size[0], geom.size[1], 1.0]
