"""Compiles a scene into a MuJoCo model."""

from __future__ import annotations

import copy
import math
import warnings
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils import Matrix, Vector
from morse.mathutils.portable import matmul
from morse.physics.driving.command import friction_of, set_damping
from morse.physics.driving.supports import round_wheels, supports, wheel_joints
from morse.physics.gliding.feet import PlaneBuilder, Stance, stance, trimmed
from morse.physics.model.articulated import Articulated, is_single_link
from morse.physics.model.couplings import CouplingBuilder, add_links
from morse.physics.model.files import (
    Files,
    are_all_from_files,
    let_flexes_bend,
    level,
    models_of,
    set_ground,
    set_options,
)
from morse.physics.model.layout import Frame, Motion, Slot, frames_of
from morse.physics.model.shapes import (
    replace_unusable_hulls,
    robot_inertia,
    volume,
    wheel_axis,
    wheel_size,
)
from morse.physics.poses.rigid import as_array, relative_pose
from morse.scene import PhysicsType, ShapeKind
from morse.scene.extent import box_around, corners
from morse.scene.frames import RigidFrame, rigid_frame
from morse.scene.mjcf import DEFAULT_CONTACT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.physics.model.files import FileMotor
    from morse.scene import CollisionShape, Node, Scene, Settings

#: longest time step of the engine that neither a script nor a file asks for, s: with a step of 1/60 s, a robot pushing
#: into a wall penetrates it by 10 mm
MAX_STEP = 1.0 / 240.0
#: that of scenes with bodies that bounce, which overlap for one step
BOUNCING_STEP = 1.0 / 960.0
#: default friction coefficient
DEFAULT_FRICTION = 0.7
#: sum of the inertias for which the tolerance of the solver holds, kg: that of one robot
_SOLVER_INERTIA = 10.0
_TORSIONAL, _ROLLING = 0.005, 0.0001
#: factor on the moment of inertia of a dynamic robot, which, unlike a rigid body, is only rotated by commands
_UNTURNABLE = 1e6
#: inertia of a wheel with its motor and gear, kg m^2, large enough that friction does not turn a wheel at rest
_GEAR_INERTIA = 10.0

#: memory for each pair of bodies, and for the rest, bytes; the estimate of the engine ignores static bodies, and the
#: engine ends the process when memory runs out
_PAIR_MEMORY, _SPARE_MEMORY = 8, 1 << 22
#: above the first number of moving bodies, the memory estimate of the engine assumes contacts between all pairs of
#: bodies; the second number, bytes for each body, is used instead. Unused memory is not allocated
_MANY, _BODY_MEMORY = 1000, 1 << 20
#: the same for each vertex of a deformable body, whose contacts the estimate of the engine ignores
_VERTEX_MEMORY = 1 << 16

_ORIGIN = RigidFrame(Vector((0.0, 0.0, 0.0)), Matrix.Identity(3), Matrix.Identity(3))
_TYPES = {
    ShapeKind.BOX: mujoco.mjtGeom.mjGEOM_BOX,
    ShapeKind.SPHERE: mujoco.mjtGeom.mjGEOM_SPHERE,
    ShapeKind.CYLINDER: mujoco.mjtGeom.mjGEOM_CYLINDER,
    ShapeKind.CAPSULE: mujoco.mjtGeom.mjGEOM_CAPSULE,
    ShapeKind.ELLIPSOID: mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    ShapeKind.CONVEX: mujoco.mjtGeom.mjGEOM_MESH,
}


@dataclass(eq=False, slots=True)
class Compiled:
    """A compiled model.

    Attributes:
        steps: physics steps per tick.
        geom_node: node of each geom.
        file_motors: actuators of MJCF files that are not motors of single joints.
        link_bodies: the body of each link of MJCF files.
        planes: the geoms of boxes to those of the planes at their tops; see `morse.physics.gliding.floors`.
        restitution: (ngeom,) of each geom, from 0 to 1, or -1.
        wheels: geoms that roll on the ground, of joints of robots from files.
        flexes: the deformable bodies: number in the engine, slot, and those of its vertices.
        physics_of_1_4: see `morse.physics.driving.command`.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    slots: list[Slot]
    steps: int
    geom_node: list[Node]
    file_motors: list[FileMotor]
    link_bodies: dict[Node, int]
    planes: dict[int, int]
    restitution: NDArray[np.float64]
    wheels: list[int]
    flexes: list[tuple[int, int, list[int]]]
    physics_of_1_4: bool = False

    def copy(self) -> Compiled:
        """Return a copy for another world of the same scene, before this one is used."""
        model = copy.copy(self.model)
        data = mujoco.MjData(model)
        mujoco.mj_copyData(data, model, self.data)
        return replace(self, model=model, data=data)


def compile_scene(scene: Scene) -> Compiled:
    """Build the MuJoCo model of a scene whose collision shapes have been computed.

    Convex shapes that the engine refuses are removed from the scene, with a warning.
    """
    try:
        return _compile(scene)
    except ValueError:
        if not replace_unusable_hulls(scene):
            raise
        return _compile(scene)


def _compile(scene: Scene) -> Compiled:
    settings = scene.settings
    frames = sorted(frames_of(scene), key=_not_moved_by_engine)
    rolling = round_wheels(frames)
    models = models_of(frames)
    as_in_files = are_all_from_files(frames)
    steps = _steps(settings, frames, [model.step for model in models], as_in_files=as_in_files)
    spec = mujoco.MjSpec()
    _set_options(spec, settings.gravity, 1.0 / settings.frequency / steps)
    if as_in_files:
        set_ground(spec, next((model.ground for model in models if model.ground != DEFAULT_CONTACT), DEFAULT_CONTACT))
    # shown only by the viewer of MuJoCo
    spec.worldbody.add_light(pos=[0.0, 0.0, 30.0], dir=[0.3, 0.2, -1.0], type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL)
    builder = _Builder(spec, frames)
    builder.physics_of_1_4, builder.as_in_files = settings.physics_of_1_4, as_in_files
    builder.rolling = rolling
    slots = [builder.add(frame) for frame in frames]
    if as_in_files:
        set_options(spec, builder.files.parts[0])
    let_flexes_bend(spec)
    builder.articulated.finish(spec.option.timestep)
    builder.couple(slots)
    add_links(spec, builder.files.parts)
    builder.planes.finish()
    builder.stand_for_flexes(slots)
    bodies = sum(1 for slot in slots if slot.frame.motion is not Motion.FIXED)
    if bodies > _MANY:
        spec.memory = _PAIR_MEMORY * (len(slots) + 1) ** 2 + _BODY_MEMORY * bodies + _SPARE_MEMORY
    model = _compiled(spec)
    needed = _PAIR_MEMORY * model.nbody**2 + _SPARE_MEMORY + _VERTEX_MEMORY * model.nflexvert
    if model.narena < needed:
        spec.memory = needed
        model = _compiled(spec)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    if not as_in_files:
        _make_bodies_independent(model)
    # the engine cannot wake what two tendons couple, and ends with an error; and where nothing may sleep, a batch steps
    # the states of all rows in one call, with the same bits
    if np.any(model.eq_type == int(mujoco.mjtEq.mjEQ_TENDON)) or (model.ntree and not _may_sleep(model)):
        model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    geom_node = builder.resolve(model, slots)
    data = mujoco.MjData(model)
    builder.files.resolve(model, data, geom_node)
    planes = {box.id: plane.id for box, plane in builder.planes.pairs}
    motors, links = builder.files.motors, builder.files.link_bodies
    restitution, rolling_joints = builder.restitution(model), wheel_joints(frames)
    wheels = [
        geom
        for slot in slots
        if any(joint.name in rolling_joints.get(slot.frame.root, ()) for joint in slot.joints)
        for geoms in slot.geoms.values()
        for geom in geoms
    ]
    return Compiled(
        model,
        data,
        slots,
        steps,
        geom_node,
        motors,
        links,
        planes,
        restitution,
        wheels,
        builder.flexes(model, slots),
        settings.physics_of_1_4,
    )


def _compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    with warnings.catch_warnings():
        # what the engine says of deformable bodies is for authors of MJCF
        warnings.simplefilter("ignore")
        return spec.compile()


def _steps(settings: Settings, frames: Sequence[Frame], of_files: Sequence[float], *, as_in_files: bool) -> int:
    """Return the number of steps in a tick.

    Args:
        of_files: the steps of MJCF files, s.
        as_in_files: whether the robots move as their files say.
    """
    if settings.steps_are_exact:
        return settings.physics_steps
    bounces = any(node.body.restitution is not None for frame in frames for node in frame.members)
    limits = [*of_files]
    if bounces or not as_in_files:
        limits.append(BOUNCING_STEP if bounces else MAX_STEP)
    least = 1 if as_in_files else settings.physics_steps
    return max(least, math.ceil(1.0 / settings.frequency / min(limits) - 1e-9))


def _may_sleep(model: mujoco.MjModel) -> bool:
    """Whether a tree of bodies may fall asleep: none of those that motors move."""
    never = mujoco.mjtSleepPolicy.mjSLEEP_AUTO_NEVER, mujoco.mjtSleepPolicy.mjSLEEP_NEVER
    return not np.isin(model.tree_sleep_policy, [int(policy) for policy in never]).all()


def _make_bodies_independent(model: mujoco.MjModel) -> None:
    """Let the engine compute the same bits for a body, however many other bodies there are that it does not touch.

    Last digits may differ in two cases:

    * Contacts with friction. The engine chooses the start of its solver for all bodies together. Without that choice,
      heaps would not fall asleep.
    * Driven robots with the centre of mass off their centre. The engine solves a single island of contacts as a whole
      and several islands one by one, and the results differ by rounding. The number of islands depends on all bodies.
    """
    # products with rows of another length are summed in another order
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE
    # the tolerance of the solver is divided by the product of both
    model.stat.meaninertia = _SOLVER_INERTIA / max(model.nv, 1)


def _not_moved_by_engine(frame: Frame) -> bool:
    # a stable sort, so that moving bodies get the ids 1, 2, ... in the order of the scene
    return not frame.has_body or frame.motion in (Motion.FIXED, Motion.VIRTUAL)


def _set_options(spec: mujoco.MjSpec, gravity: float, step: float) -> None:
    spec.compiler.degree = False
    option = spec.option
    option.timestep = step
    option.gravity = [0.0, 0.0, -gravity]
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 10.0
    option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    spec.default.geom.solref = [2.0 * step, 1.0]
    spec.default.geom.friction = [DEFAULT_FRICTION, _TORSIONAL, _ROLLING]


class _Builder:
    def __init__(self, spec: mujoco.MjSpec, frames: Sequence[Frame]) -> None:
        self._spec = spec
        self._has_wheels = any(frame.motion is Motion.HINGE for frame in frames)
        self.articulated = Articulated(spec, frames)
        self.planes = PlaneBuilder()
        self._bounces: list[tuple[mujoco.MjsGeom, float]] = []
        self._bodies: dict[Frame, mujoco.MjsBody] = {}
        self._geoms: list[tuple[mujoco.MjsGeom, Node, Slot]] = []
        self._feet: list[tuple[mujoco.MjsGeom, Node, Slot]] = []
        self._hulls: dict[bytes, str] = {}
        self._step = spec.option.timestep
        self.files, self.as_in_files = Files(spec), False
        self.physics_of_1_4 = False
        #: the ellipsoids that stand for the cylinders of wheels
        self.rolling: dict[CollisionShape, CollisionShape] = {}

    def add(self, frame: Frame) -> Slot:
        slot = Slot(frame, rigid_frame(frame.node))
        if not frame.has_body:
            return slot
        if is_part_of_the_world(frame):
            # the engine spends time on each body in each step, but not on each shape of one body
            slot.body = 0
            self._add_geoms(frame, slot, self._spec.worldbody, False)
            return slot
        body = self.files.add(frame, slot, self._add_body)
        if body is None:
            body = self._add_body(frame, slot)
        elif _is_weightless(frame) and frame.motion is Motion.FREE:
            body.gravcomp = 1.0
        self._bodies[frame] = body
        of_file = self.files.part_of(frame) is not None
        has_links = of_file and frame.motion is Motion.FREE
        if frame.carries or frame.joints or is_single_link(frame):
            has_links = self.articulated.set_inertia(frame, slot.pose, body, of_file=of_file)
        if frame.joints:
            slot.joints = self.articulated.add_joints(frame, slot.pose, body, of_file=of_file)
        if frame.motion is Motion.HINGE:
            self._add_wheel(frame, slot, body)
        else:
            self._add_geoms(frame, slot, body, has_links)
        return slot

    def _add_body(self, frame: Frame, slot: Slot) -> object:
        parent, pose = self._spec.worldbody, slot.pose
        position, rotation = np.array(pose.position), as_array(pose.rotation)
        if frame.parent is not None:
            parent = self._bodies[frame.parent]
            outer = rigid_frame(frame.parent.node)
            turned = as_array(outer.rotation).T
            position, rotation = (
                matmul(turned, position - np.array(outer.position)),
                matmul(turned, rotation),
            )
        # the engine has a body "world" of its own
        name = "world (object)" if frame.node.name == "world" else frame.node.name
        body = parent.add_body(
            name=name, pos=position, quat=_quaternion(rotation), mocap=frame.motion is Motion.KINEMATIC
        )
        if frame.motion is Motion.FREE:
            body.add_freejoint(name=name)
            if _is_weightless(frame):
                body.gravcomp = 1.0
        return body

    def _add_geoms(self, frame: Frame, slot: Slot, body: mujoco.MjsBody, has_links: bool) -> None:
        heavy = [node for node in frame.solid if node.body.type is not PhysicsType.SENSOR]
        total = sum(volume(shape) for node in heavy or frame.solid for shape in node.shapes or ()) or 1.0
        mass = frame.node.body.mass if frame.motion is Motion.FREE and not has_links else 0.0
        lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
        is_robot = _is_free_robot(frame) and not has_links
        gets_planes = self._has_wheels and frame.motion is Motion.FIXED
        pose = _ORIGIN if slot.body == 0 else slot.pose
        turned = as_array(pose.rotation)
        stand, raised = self._stance(frame, slot), supports(frame)
        for node in frame.solid:
            position, rotation = relative_pose(node, pose)
            if raised.get(node):
                position = position + np.array([0.0, 0.0, raised[node]])
            if heavy and node.body.type is PhysicsType.SENSOR:
                self._add_feelers(node, slot, body, pose)
                continue
            for shape in node.shapes or ():
                geom = self.files.geom(frame, node)
                if geom is None:
                    fitted = self.rolling.get(shape, shape)
                    fitted = fitted if stand is None else trimmed(fitted, position, rotation, stand) or fitted
                    geom = self._add_geom(body, fitted, position, rotation)
                    geom.mass = mass * volume(shape) / total
                    self.files.set_contact(frame, node, geom)
                    if frame.motion is Motion.FIXED:
                        self._level(geom, frame, node)
                self._set_surface(geom, node, frame)
                self._geoms.append((geom, node, slot))
                if gets_planes and shape.kind is ShapeKind.BOX:
                    surface = partial(self._set_surface, node=node, frame=frame)
                    self.planes.note(body, geom, turned, surface)
                if is_robot:
                    low, high = box_around(shape, position, rotation)
                    lower, upper = np.minimum(lower, low), np.maximum(upper, high)
        if is_robot:
            assert frame.robot is not None
            body.explicitinertial = True
            body.mass = mass
            body.ipos, body.inertia = robot_inertia(mass, lower, upper)
            rolls = frame.node.properties.get("GroundRobot") and not self.physics_of_1_4
            if not rolls and not frame.robot.options.get("wheels") and np.all(lower <= 0.0) and np.all(upper >= 0.0):
                # as in 1.4: forces and damping at the origin do not turn the robot
                body.ipos = np.zeros(3)
            if frame.node.body.type is PhysicsType.DYNAMIC:
                body.inertia = _UNTURNABLE * np.asarray(body.inertia)
            self._add_feet(frame, slot, body, stand)

    def _level(self, geom: mujoco.MjsGeom, frame: Frame, node: Node) -> None:
        """Make a plane of a floor: of one that an MJCF file has, and of one on which only robots of files stand."""
        articulation = frame.node.articulation
        model = None if articulation is None else articulation.model
        if model is not None and (node.source_name or node.name) in model.floors:
            level(geom, float(geom.pos[2] + geom.size[2]))
        elif self.as_in_files:
            level(geom)

    def _add_feelers(self, node: Node, slot: Slot, body: Body, pose: RigidFrame) -> None:
        """Add shapes that only detect contacts: they have no mass and exert no forces."""
        position, rotation = relative_pose(node, pose)
        for shape in node.shapes or ():
            geom = self._add_geom(body, shape, position, rotation)
            geom.mass, geom.contype, geom.conaffinity = 0.0, 0, 0
            self._geoms.append((geom, node, slot))

    def _stance(self, frame: Frame, slot: Slot) -> Stance | None:
        """Return the stance of a robot that is driven as one body over a floor; wheels, rotors and props have none."""
        if frame.robot is None or frame.motion is not Motion.FREE or frame.robot.options.get("wheels") or frame.carries:
            return None
        if slot.pose.rotation[2][2] < 0.99 or not frame.node.properties.get("GroundRobot"):
            return None
        solid = [node for node in frame.solid if node.body.collides]
        points = [corners(shape, *relative_pose(node, slot.pose)) for node in solid for shape in node.shapes or ()]
        return stance(np.vstack(points)) if points else None

    def _add_feet(self, frame: Frame, slot: Slot, body: mujoco.MjsBody, stand: Stance | None) -> None:
        if stand is None:
            return
        # the engine has to be prepared for weightless bodies; see resolve
        body.gravcomp = 1.0
        for centre in stand.feet:
            foot = body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[stand.radius, 0.0, 0.0], pos=centre, mass=0.0)
            self._set_surface(foot, frame.node, frame)
            self._feet.append((foot, frame.node, slot))

    def _add_geom(
        self, body: mujoco.MjsBody, shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> mujoco.MjsGeom:
        if shape.kind is ShapeKind.CONVEX:
            mesh = self._hull(shape)
            return body.add_geom(type=_TYPES[shape.kind], meshname=mesh, pos=position, quat=_quaternion(rotation))
        shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
        if shape.kind is ShapeKind.HEIGHT_FIELD:
            return body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_HFIELD,
                hfieldname=self._height_field(shape),
                pos=position + matmul(rotation, np.asarray(shape.position)),
                quat=_quaternion(shape_rotation),
            )
        size = np.zeros(3)
        size[: len(shape.size)] = shape.size
        return body.add_geom(
            type=_TYPES[shape.kind],
            size=size,
            pos=position + matmul(rotation, np.asarray(shape.position)),
            quat=_quaternion(shape_rotation),
        )

    def _height_field(self, shape: CollisionShape) -> str:
        """Return the name of the heights of a shape; robots of one file share them."""
        assert shape.heights is not None
        heights = np.ascontiguousarray(shape.heights, dtype=np.float32)
        key = repr(shape.size).encode() + repr(heights.shape).encode() + heights.tobytes()
        if key not in self._hulls:
            name = self._hulls[key] = f"heights{len(self._hulls)}"
            rows, columns = heights.shape
            self._spec.add_hfield(name=name, size=shape.size, nrow=rows, ncol=columns, userdata=heights.ravel())
        return self._hulls[key]

    def _hull(self, shape: CollisionShape) -> str:
        """Return the name of the mesh of a convex shape; equal shapes, as in a fleet of robots, share a mesh."""
        vertices = np.ascontiguousarray(shape.vertices, dtype=np.float32).ravel()
        key = vertices.tobytes()
        if key not in self._hulls:
            name = self._hulls[key] = f"hull{len(self._hulls)}"
            inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            self._spec.add_mesh(name=name, uservert=vertices, inertia=inertia)
        return self._hulls[key]

    def _set_surface(self, geom: mujoco.MjsGeom, node: Node, frame: Frame) -> None:
        friction = node.body.friction if node.body.friction is not None else frame.node.body.friction
        if self.physics_of_1_4 and _is_free_robot(frame):
            friction = friction_of(node.body if node.body.friction is not None else frame.node.body)
        if friction is not None:
            geom.friction = [friction, _TORSIONAL, _ROLLING]
            # the friction of a script applies to all contacts, not only to contacts with lower friction, and that of a
            # body that moves also where the ground has one
            geom.priority = max(geom.priority, 1) if frame.motion is Motion.FIXED else max(geom.priority, 1) + 1
        self._note_restitution(geom, node, frame.node)
        if node in supports(frame):
            geom.condim, geom.priority = 1, 3
        if (not node.body.collides and not frame.node.body.collides) or node.body.type is PhysicsType.SENSOR:
            geom.contype = geom.conaffinity = 0

    def _note_restitution(self, geom: mujoco.MjsGeom, *nodes: Node) -> None:
        ratios = [node.body.restitution for node in nodes if node.body.restitution is not None]
        if ratios:
            self._bounces.append((geom, max(ratios)))

    def restitution(self, model: mujoco.MjModel) -> NDArray[np.float64]:
        """Return the restitution (ngeom,) of each geom, from 0 to 1, or -1."""
        ratios = np.full(model.ngeom, -1.0)
        for geom, ratio in self._bounces:
            ratios[geom.id] = ratio
        return ratios

    def _add_wheel(self, frame: Frame, slot: Slot, body: mujoco.MjsBody) -> None:
        node = frame.node
        assert frame.parent is not None
        axis = wheel_axis(node, frame.parent.node)
        radius, half_width, rotation = wheel_size(node, axis)
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, name=node.name, axis=axis, armature=_GEAR_INERTIA)
        # an ellipsoid touches the floor at one point
        geom = body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_ELLIPSOID,
            size=[radius, radius, half_width],
            quat=_quaternion(rotation),
            mass=0.0,
        )
        # The inertia about the axle is 0, because an accelerating wheel would lift the front of a light robot. The
        # inertia about the other axes is that of a disc, m r^2 / 4.
        body.explicitinertial = True
        body.mass = node.body.mass
        body.ipos, body.iquat = [0.0, 0.0, 0.0], _quaternion(rotation)
        across = 0.25 * node.body.mass * radius**2
        body.inertia = [across, across, 1e-3 * across]
        friction = frame.parent.node.properties.get("Friction") if node.body.friction is None else node.body.friction
        mu = float(friction) if isinstance(friction, (int, float)) and 0.0 <= friction < math.inf else 1.0
        geom.friction = [mu, _TORSIONAL, _ROLLING]
        geom.priority = 1
        self._note_restitution(geom, node, frame.parent.node)
        self._geoms.append((geom, node, slot))
        motor = self._spec.add_actuator(name=node.name, target=node.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        # reduces the difference to the commanded speed by nine tenths in each step
        motor.set_to_velocity(kv=10.0 * _GEAR_INERTIA / self._step)

    def couple(self, slots: list[Slot]) -> None:
        """Add constraints, after all bodies and joints."""
        CouplingBuilder(self._spec, slots, self._bodies)

    def stand_for_flexes(self, slots: list[Slot]) -> None:
        """See `Files.stand_for_flexes`."""
        added = self.files.stand_for_flexes()
        if added is not None:
            geom, node = added
            self._geoms.append((geom, node, next(slot for slot in slots if slot.frame.node is node)))

    def flexes(self, model: mujoco.MjModel, slots: list[Slot]) -> list[tuple[int, int, list[int]]]:
        """Return the deformable bodies; see `Compiled`."""
        index = {slot.frame.node: number for number, slot in enumerate(slots)}
        found = []
        for node, name in self.files.flexes():
            number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_FLEX, name)
            slot = slots[index[node]]
            bodies = [body for body in range(model.nbody) if _is_of_flex(model, body, name)]
            if bodies:
                first = int(model.body_dofadr[bodies[0]])
                slot.qpos = int(model.jnt_qposadr[model.body_jntadr[bodies[0]]])
                slot.dof, slot.soft = first, int(model.body_dofnum[bodies].sum())
            found.append((number, index[node], [index[child] for child in node.children]))
        return found

    def resolve(self, model: mujoco.MjModel, slots: list[Slot]) -> list[Node]:
        """Store the ids that the compiler has assigned."""
        self.articulated.resolve(model)
        # every geom gets its node: here, or by `Files.resolve`
        geom_node: list[Node] = [None] * model.ngeom  # type: ignore[list-item]
        for geom, node, slot in self._geoms:
            geom_node[geom.id] = node
            slot.geoms.setdefault(node, []).append(geom.id)
        for box, plane in self.planes.pairs:
            geom_node[plane.id] = geom_node[box.id]
        for foot, node, slot in self._feet:
            geom_node[foot.id] = node
            slot.feet.append(foot.id)
        for slot in slots:
            body = self._bodies.get(slot.frame)
            if body is None:
                continue
            slot.body = body.id
            slot.mocap = int(model.body_mocapid[body.id])
            if model.body_jntnum[body.id]:
                joint = int(model.body_jntadr[body.id])
                slot.qpos, slot.dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
            if slot.frame.motion is Motion.FREE:
                set_damping(model, slot, self.physics_of_1_4)
                if slot.feet and not _is_weightless(slot.frame):
                    model.body_gravcomp[slot.body] = 0.0
            if slot.frame.motion is Motion.HINGE:
                slot.actuator = model.actuator(slot.frame.node.name).id
        return geom_node


def is_part_of_the_world(frame: Frame) -> bool:
    """Whether the shapes of a frame belong to the world in the engine: it is static, and nothing moves within it."""
    return frame.motion is Motion.FIXED and not any(node.bones for node in frame.members)


def _is_of_flex(model: mujoco.MjModel, body: int, flex: str) -> bool:
    """Whether the engine has made a body that moves for a vertex or a node of a deformable body."""
    name = model.body(body).name
    return name.startswith(f"{flex}_") and name[len(flex) + 1 :].isdigit() and bool(model.body_dofnum[body])


def _is_free_robot(frame: Frame) -> bool:
    return frame.robot is not None and frame.motion is Motion.FREE


def _is_weightless(frame: Frame) -> bool:
    return not frame.node.body.gravity or bool(frame.node.properties.get("NoGravity"))


def _quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    return quaternion
