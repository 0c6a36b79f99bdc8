"""The physics of a running scene: step it, reset it, ask it where things are."""

from __future__ import annotations

from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.physics import rigid
from morse.physics.attachments import Attachments
from morse.physics.children import ObjectList
from morse.physics.compile import compile_scene
from morse.physics.contact_points import ContactPoints
from morse.physics.drives import Drives
from morse.physics.gameobject import GameObject
from morse.physics.gliding import Gliding
from morse.physics.layout import Motion
from morse.physics.locks import Locks
from morse.physics.raycast import cast_ray
from morse.physics.rays import Rays
from morse.physics.stability import check_stable
from morse.scene import ShapeKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from morse.mathutils import Vector
    from morse.physics.compile import Slot
    from morse.scene import CollisionShape, Node, Scene


#: the arrays of the model that are written while a simulation runs
_CHANGED_WHILE_RUNNING = (
    "body_pos",
    "body_quat",
    "body_gravcomp",
    "dof_damping",
    "geom_pos",
    "geom_quat",
    "geom_condim",
    "geom_priority",
    "geom_contype",
    "geom_conaffinity",
    "geom_margin",
    "geom_gap",
    "body_margin",
)


class World:
    """A compiled scene and its state.

    Every node of the scene has a `GameObject`; rigid groups of nodes share a *slot*. Slots that
    the engine moves come first, so that slot ``k`` is MuJoCo body ``k + 1``.

    Attributes:
        model, data: the MuJoCo model and state; only this package touches them.
        stamp: changes whenever anything has moved.
        positions: of each slot, [x, y, z] in metres, world frame.
        rotations: of each slot, 9 row-major numbers.
        loose: slots that stand still in the scene, but were put elsewhere since.
        rearranged: nodes whose shapes moved within their slots since the rays looked at them.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.period = 1.0 / scene.settings.frequency
        compiled = compile_scene(scene)
        self.model, self.data, self.slots = compiled.model, compiled.data, compiled.slots
        self.steps, self.geom_node = compiled.steps, compiled.geom_node
        self.moving = sum(1 for slot in self.slots if slot.body > 0 and slot.frame.motion is not Motion.FIXED)
        self.stamp = 0
        self._bodiless = [
            i for i in range(self.moving, len(self.slots)) if self.slots[i].frame.motion is not Motion.FIXED
        ]
        self.positions: list[Sequence[float]] = []
        self.rotations: list[Sequence[float]] = []
        self._quaternions: list[Sequence[float]] = []
        self.drives = Drives(self)
        self.attachments = Attachments(self)
        self.locks = Locks(self)
        self._slot_of: dict[Node, int] = {
            node: index for index, slot in enumerate(self.slots) for node in slot.frame.members
        }
        self._wheels: dict[int, list[int]] = {}
        for index, slot in enumerate(self.slots):
            if slot.frame.parent is not None:
                self._wheels.setdefault(self._slot_of[slot.frame.parent.node], []).append(index)
        self._objects: dict[Node, GameObject] = {}
        self._names: dict[str, GameObject] = {}
        for node in scene.nodes():
            obj = GameObject(self, node, self._slot_of[node])
            self._objects[node] = self._names[node.name] = obj
        self.displaced: list[GameObject] = []
        self.repainted: set[GameObject] = set()
        self.layout = 0
        self._forces = False
        self.loose: set[int] = set()
        self.rearranged: set[Node] = set()
        self._touched: set[int] = set()
        self._arrays: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        mujoco.mj_forward(self.model, self.data)
        self.gliding = Gliding(self)
        self._pristine = {name: getattr(self.model, name).copy() for name in _CHANGED_WHILE_RUNNING}
        self.reset()

    # -- objects ---------------------------------------------------------------------------

    @property
    def objects_by_name(self) -> dict[str, GameObject]:
        """Every object of the world."""
        return self._names

    def objects(self) -> Iterator[GameObject]:
        """Every object, parents before their children."""
        return iter(self._objects.values())

    def object_list(self) -> ObjectList:
        """Every object, found by number or by name."""
        return ObjectList(list(self._objects.values()))

    def object_of(self, node: Node) -> GameObject:
        """The object of a node."""
        return self._objects[node]

    def game_object(self, name: str) -> GameObject:
        """The object of that name.

        Raises:
            KeyError: if there is none.
        """
        return self._names[name]

    def geom_object(self, geom: int) -> GameObject:
        """The object whose shape a MuJoCo geom is."""
        return self._objects[self.geom_node[geom]]

    # -- time ------------------------------------------------------------------------------

    def reset(self) -> None:
        """Everything as the scene says, at rest."""
        for name, values in self._pristine.items():
            getattr(self.model, name)[:] = values
        mujoco.mj_resetData(self.model, self.data)
        self.gliding.reset()
        self.drives.reset()
        self.attachments.reset()
        self.positions = [tuple(slot.pose.position) for slot in self.slots]
        self.rotations = [tuple(v for row in slot.pose.rotation for v in row) for slot in self.slots]
        self._quaternions = [rigid.quaternion(rotation) for rotation in self.rotations]
        for obj in self._objects.values():
            obj.restore()
        for obj in self.displaced:
            self.rearranged.update(obj.node.walk())
        self.loose.clear()
        self._arrays = None
        self._forces = False
        mujoco.mj_forward(self.model, self.data)
        self.refresh()

    def step(self) -> None:
        """One tick: apply the commands, let the engine take its steps, read the poses."""
        self.attachments.before_step()
        self.drives.apply()
        self.locks.before_step()
        self.gliding.step()
        self.drives.release()
        self.locks.after_step()
        if self._forces:
            self.data.xfrc_applied[:] = 0.0
            self._forces = False
        self.attachments.after_step()
        check_stable(self)
        self.sync()

    def sync(self) -> None:
        """Work out where everything is, from the state as it is now."""
        mujoco.mj_kinematics(self.model, self.data)
        self.refresh()

    def refresh(self) -> None:
        """Take the poses of the moving bodies from the engine."""
        count = self.moving
        self.positions[:count] = self.data.xpos[1 : count + 1].tolist()
        self.rotations[:count] = self.data.xmat[1 : count + 1].tolist()
        self._touched.clear()
        self.stamp += 1

    # -- state of one slot -----------------------------------------------------------------

    def place(self, index: int, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Put a slot somewhere in the world; its velocity stays."""
        slot = self.slots[index]
        if slot.frame.motion is Motion.HINGE:
            return
        self.gliding.leave(index)
        p, q = position, rigid.quaternion(rotation)
        if slot.frame.motion is Motion.FREE and slot.qpos >= 0:
            self.data.qpos[slot.qpos : slot.qpos + 7] = (p[0], p[1], p[2], *q)
        elif slot.mocap >= 0:
            self.data.mocap_pos[slot.mocap] = p
            self.data.mocap_quat[slot.mocap] = q
        elif slot.body > 0:
            self._move_fixed(slot, p, q)
            self.loose.add(index)
        self.positions[index], self.rotations[index], self._quaternions[index] = tuple(position), tuple(rotation), q
        self._touched.add(index)
        self.stamp += 1
        for other in self._wheels.get(index, ()):
            child = self.slots[other]
            self._touched.add(other)
            mujoco.mj_kinematics(self.model, self.data)
            self.positions[other] = self.data.xpos[child.body].tolist()
            self.rotations[other] = self.data.xmat[child.body].tolist()

    def _move_fixed(self, slot: Slot, position: Sequence[float], quaternion: Sequence[float]) -> None:
        self.model.body_pos[slot.body] = position
        self.model.body_quat[slot.body] = quaternion
        self._place_fixed()

    def _place_fixed(self) -> None:
        self.gliding.leave_all()
        # what never moves is computed once while sleeping is allowed
        flag = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        self.model.opt.enableflags &= ~flag
        mujoco.mj_kinematics(self.model, self.data)
        self.model.opt.enableflags |= flag

    def velocity(self, index: int) -> tuple[Sequence[float], Sequence[float]]:
        """Linear (m/s) and angular (rad/s) velocity of a slot's origin, both in world axes."""
        slot = self.slots[index]
        if slot.frame.motion is Motion.FREE and slot.dof >= 0:
            v = self.data.qvel[slot.dof : slot.dof + 6].tolist()
            return v[:3], rigid.turn(self.rotations[index], v[3:])
        if slot.frame.motion is Motion.HINGE:
            return self._hinge_velocity(slot)
        return self.drives.kinematic_velocity(index)

    def _hinge_velocity(self, slot: Slot) -> tuple[Sequence[float], Sequence[float]]:
        result = np.zeros(6)
        mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_XBODY, slot.body, result, 0)
        return result[3:].tolist(), result[:3].tolist()

    def set_velocity(self, index: int, linear: Sequence[float] | None, angular: Sequence[float] | None) -> None:
        """Set the velocity of a free slot, in world axes; others keep theirs."""
        slot = self.slots[index]
        if slot.frame.motion is not Motion.FREE or slot.dof < 0:
            return
        self.gliding.leave(index)
        if linear is not None:
            self.data.qvel[slot.dof : slot.dof + 3] = linear
        if angular is not None:
            self.data.qvel[slot.dof + 3 : slot.dof + 6] = rigid.turn_back(self.rotations[index], angular)

    def apply_wrench(self, index: int, force: Sequence[float], torque: Sequence[float]) -> None:
        """Push a body at its centre of mass during the next tick: N and N m, world axes."""
        slot = self.slots[index]
        if slot.body > 0:
            self.gliding.leave(index)
            self.data.xfrc_applied[slot.body] += (*force, *torque)
            self._forces = True

    def pull(
        self,
        obj: GameObject,
        anchor: Sequence[float],
        target: Sequence[float],
        stiffness: float,
        damping: float,
        strongest: float,
    ) -> None:
        """See `GameObject.pull`; what does not obey forces is not pulled."""
        slot = self.slots[obj.slot]
        if slot.frame.motion is not Motion.FREE or slot.body < 0:
            return
        position, rotation = obj.world_pose()
        held, _ = rigid.compose(position, rotation, anchor, rigid.IDENTITY)
        linear, angular = self.velocity(obj.slot)
        origin = self.positions[obj.slot]
        speed = np.add(linear, np.cross(angular, np.subtract(held, origin)))
        wanted = stiffness * np.subtract(target, held) - damping * speed
        size = float(np.linalg.norm(wanted))
        if size > strongest:
            wanted *= strongest / size
        mass = float(self.model.body_subtreemass[slot.body])
        force = mass * wanted
        # pulling at the rim of a large body must not make it spin wildly: the lever counts in part
        torque = 0.3 * np.cross(np.subtract(held, self.data.xipos[slot.body]), force)
        self.apply_wrench(obj.slot, force.tolist(), torque.tolist())

    def set_collision(self, nodes: Sequence[Node], active: bool) -> None:
        """Let the shapes of nodes collide, or pass through everything."""
        for node in nodes:
            slot = self.slots[self._slot_of[node]]
            if slot.frame.motion is Motion.FIXED:
                self.gliding.leave_all()
            self.gliding.leave(self._slot_of[node])
            self.gliding.set_collision([*slot.geoms.get(node, ()), *slot.feet], active)

    def move_shapes(self, obj: GameObject) -> None:
        """Take the collision shapes of an object along after it moved within its body."""
        slot = self.slots[obj.slot]
        if obj.node not in slot.geoms or slot.frame.motion is Motion.HINGE:
            return
        self.gliding.leave(obj.slot)
        offset, turned = obj.offset
        for geom, shape in zip(slot.geoms[obj.node], obj.node.shapes or (), strict=True):
            position, rotation = rigid.compose(offset, turned, *self._shape_pose(geom, shape))
            self.model.geom_pos[geom] = position
            self.model.geom_quat[geom] = rigid.quaternion(rotation)
        if slot.frame.motion is Motion.FIXED:
            self._place_fixed()
            self.loose.add(obj.slot)
        self.rearranged.add(obj.node)
        self.stamp += 1

    def _shape_pose(self, geom: int, shape: CollisionShape) -> tuple[Sequence[float], Sequence[float]]:
        if shape.kind is not ShapeKind.CONVEX:
            return shape.position, shape.rotation
        # the compiler moves hulls to their centre of mass and principal axes
        mesh = self.model.geom_dataid[geom]
        return (
            self.model.mesh_pos[mesh].tolist(),
            rigid.rotation_of_quaternion(self.model.mesh_quat[mesh].tolist()),
        )

    def set_weightless(self, index: int) -> None:
        """Cancel gravity for a slot."""
        slot = self.slots[index]
        self.gliding.leave(index)
        if slot.body < 0 or self.model.body_gravcomp[slot.body] == 1.0:
            return
        self.model.body_gravcomp[slot.body] = 1.0
        # the engine counts weightless bodies at compile time only; counting anew spoils qpos
        qpos = self.data.qpos.copy()
        mujoco.mj_setConst(self.model, self.data)
        self.data.qpos[:] = qpos
        mujoco.mj_forward(self.model, self.data)

    # -- looking around ----------------------------------------------------------------------

    @cached_property
    def rays(self) -> Rays:
        """Casts rays; made when it is first needed."""
        return Rays(self)

    @property
    def is_stale(self) -> bool:
        """Whether something was put elsewhere since the engine last worked out where everything is."""
        return bool(self._touched or self.rearranged)

    def slot_poses(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions (K, 3) and rotations (K, 3, 3) of the slots with shapes, to be read at once."""
        if self._arrays is None:
            self._arrays = np.array(self.positions, dtype=np.float64), np.array(self.rotations, dtype=np.float64)
        positions, rotations = self._arrays
        count = self.moving
        positions[:count] = self.data.xpos[1 : count + 1]
        rotations[:count] = self.data.xmat[1 : count + 1]
        for index in sorted(self._touched | self.loose):
            positions[index], rotations[index] = self.positions[index], self.rotations[index]
        return positions, rotations.reshape(-1, 3, 3)

    def cast(
        self,
        start: Sequence[float],
        target: Sequence[float],
        distance: float,
        prop: str,
        xray: bool,
        exclude: GameObject,
    ) -> tuple[GameObject | None, Vector | None, Vector | None]:
        """See `GameObject.rayCast`; the body of ``exclude`` is looked through."""
        return cast_ray(self, start, target, distance, prop, xray, exclude)

    def contacts(self) -> list[tuple[GameObject, GameObject]]:
        """The pairs of objects that touch now."""
        pairs = self.data.contact.geom[: self.data.ncon].tolist() + self.gliding.supports()
        return [(self.geom_object(a), self.geom_object(b)) for a, b in pairs]

    def contact_forces(self) -> bytes:
        """Where bodies touch, at rest or not: see `ContactPoints.look`; (N, 6) float32."""
        return self._contact_points.look().tobytes()

    @cached_property
    def _contact_points(self) -> ContactPoints:
        return ContactPoints(self)

    def mass_centres(self) -> list[tuple[str, float, tuple[float, float, float]]]:
        """Name, mass (kg) and centre of mass (m, in its own frame) of every body that obeys forces."""
        found = []
        for slot in self.slots[: self.moving]:
            if slot.frame.motion in (Motion.FREE, Motion.HINGE):
                x, y, z = self.model.body_ipos[slot.body].tolist()
                found.append((slot.frame.node.name, float(self.model.body_mass[slot.body]), (x, y, z)))
        return found

    def appearance_changed(self, obj: GameObject) -> None:
        """Something about the looks of an object changed: the view has to know."""
        self.repainted.add(obj)

    # -- the view --------------------------------------------------------------------------

    def moving_nodes(self) -> list[tuple[Node, str]]:
        """The nodes whose poses `poses` gives, each with ``world`` or ``parent``, its frame."""
        nodes = [(slot.frame.node, "world") for slot in self.slots if slot.frame.motion is not Motion.FIXED]
        return nodes + [(obj.node, "parent") for obj in self.displaced]

    def poses(self) -> NDArray[np.float32]:
        """(M, 7) x, y, z, qw, qx, qy, qz of the moving nodes, in the order of `moving_nodes`."""
        count, rest = self.moving, self._bodiless
        end = count + len(rest)
        result = np.empty((end + len(self.displaced), 7), dtype=np.float32)
        result[:count, :3] = self.data.xpos[1 : count + 1]
        result[:count, 3:] = self.data.xquat[1 : count + 1]
        # numbers one after the other are read in half the time that rows of them take
        positions = chain.from_iterable([self.positions[i] for i in rest])
        quaternions = chain.from_iterable([self._quaternions[i] for i in rest])
        result[count:end, :3] = np.fromiter(positions, np.float32, 3 * len(rest)).reshape(-1, 3)
        result[count:end, 3:] = np.fromiter(quaternions, np.float32, 4 * len(rest)).reshape(-1, 4)
        for row, obj in enumerate(self.displaced, end):
            position, rotation = obj.local_pose()
            result[row, :3] = position
            result[row, 3:] = rigid.quaternion(rotation)
        return result

    def note_displaced(self, obj: GameObject) -> None:
        """A node has moved relative to its parent: from now on the view gets its pose."""
        if obj not in self.displaced and self.slots[obj.slot].frame.node is not obj.node:
            self.displaced.append(obj)
            self.layout += 1

    def state(self) -> NDArray[np.float64]:
        """Everything that determines the future of the physics, as one flat array."""
        size = mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_INTEGRATION)
        state = np.empty(size)
        mujoco.mj_getState(self.model, self.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        others: list[Any] = [v for i in range(self.moving, len(self.slots)) for v in self.positions[i]]
        others += [v for i in range(self.moving, len(self.slots)) for v in self.rotations[i]]
        return np.concatenate([state, np.asarray(others, dtype=np.float64)])
