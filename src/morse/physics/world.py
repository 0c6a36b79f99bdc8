"""The physics of a running scene: steps, reset, poses and queries."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, cast

import mujoco
import numpy as np

from morse.kernel.loading import library
from morse.physics.bodies import Bodies, KinematicBodies
from morse.physics.driving.drives import Drives
from morse.physics.driving.fleet import Fleet, WheelFleet
from morse.physics.driving.traction import Traction
from morse.physics.engine_functions import forward, without_contacts
from morse.physics.gliding.floors import FloorPlanes
from morse.physics.gliding.gliding import Gliding
from morse.physics.gliding.passage import FreeRun
from morse.physics.model.compile import compile_scene
from morse.physics.model.layout import Motion
from morse.physics.model.motors import ARRAYS as MOTOR_ARRAYS
from morse.physics.model.motors import control_of
from morse.physics.model.placement import raise_sunken
from morse.physics.objects.attachments import Attachments, Locks
from morse.physics.objects.gameobject import GameObject
from morse.physics.objects.linkage import Linkage
from morse.physics.objects.object_world import ObjectList
from morse.physics.poses import kinematics
from morse.physics.poses.snapshot import MovingPoses, Snapshots
from morse.physics.rays.rays import RayWorld
from morse.physics.reactions import ContactPoints
from morse.physics.separation import Separation
from morse.physics.stability import Crowding, Recovery, Rescue
from morse.physics.state import saved
from morse.physics.state.engine_values import CHANGED_WHILE_RUNNING
from morse.physics.state.saving import Saving
from morse.physics.state.scene_change import SceneChange
from morse.physics.state.transfer import Transfer
from morse.physics.steps import Steps
from morse.physics.tick import Tick
from morse.physics.touches import Touches, Touching
from morse.physics.variations import Variations
from morse.scene import Control

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.physics.model.compile import Compiled
    from morse.physics.objects.object_world import Posed
    from morse.scene import Bone, ComponentDeclaration, Node, Scene, Zone


class World(RayWorld):
    """A compiled scene and its state; every node of the scene has a `GameObject`.

    Args:
        compiled: the compiled scene, which belongs to this world from now on; None to compile it.

    Attributes:
        repainted: objects whose appearance changed since the view last read it.
        repaints: number of changes of appearance.
        repaint_sinks: called with each object whose appearance changes.
        arrangement: changes whenever objects are added, removed or replaced.
    """

    def __init__(self, scene: Scene, compiled: Compiled | None = None) -> None:
        self.scene = scene
        self.arrangement = 0
        self._rescue = Rescue()
        self.touches: Touches | None = None
        self.repainted: set[GameObject] = set()
        self.repaints = 0
        self.repaint_sinks: list[Callable[[Any], object]] = []
        self._objects: dict[Node, GameObject] = {}
        self._names: dict[str, GameObject] = {}
        # rays may be cast for the first time within a tick, when there may be no file descriptor left
        library()
        super().__init__(compiled or compile_scene(scene), 1.0 / scene.settings.frequency)
        self._build()
        self.reset()

    def __repr__(self) -> str:
        return f"<World '{self.scene.environment}': {len(self._objects)} objects>"

    def _build(self) -> None:
        """Create the parts that belong to the present compiled model."""
        # contacts at the poses of the scene are not needed: spawned robots may all have come at one place
        without_contacts(self)
        self.gliding = Gliding(self)
        free = {slot.body: slot.frame.node.name for slot in self.slots if slot.frame.motion is Motion.FREE}
        self._steps = Steps(self, self.gliding, self._rescue, Crowding(self, free, self._rescue))
        self.bodies = Bodies(self, self.gliding)
        self.drives = Drives(self, self.gliding, self.bodies)
        self._floor_planes = FloorPlanes(self, self.gliding.floors)
        self._tick = Tick()
        self._pristine = {name: getattr(self.model, name).copy() for name in CHANGED_WHILE_RUNNING}
        pristine = self._pristine
        self.separation = Separation(self, self._tick, pristine["geom_solref"], pristine["geom_priority"])
        self.attachments = Attachments(self, self.bodies, self._tick)
        self._traction, self._locks = Traction(self, self.drives), Locks(self)
        self._moving_poses = MovingPoses(self)
        self._contact_points = ContactPoints(self, self.gliding)
        self._touching: Touching | None = None
        self._take_objects()
        if self.touches is not None:
            self.watch = self.touches = Touches(self, self._contact_points, self.touches.impulses)
        self._arrange_tick()
        self.free_run = FreeRun(self, self.gliding, self._steps.passage, self.drives, self._is_idle)
        self._saving = Saving(self, self.gliding, self._steps, self._names)
        self._variations = Variations(self, self._pristine)

    def _arrange_tick(self) -> None:
        """Set the order of the parts in a tick."""
        watch = () if self.touches is None else (self.touches,)
        self._tick.arrange(
            before=(*watch, self.attachments, self._floor_planes, self._traction, self.drives, self._locks),
            after=(self.separation, self.drives, self._locks, self.attachments, *watch),
        )

    def _take_objects(self) -> None:
        """Create one object for each node; objects of nodes with the same names are kept."""
        before, self._names = self._names, {}
        self._objects = {}
        for node in self.scene.nodes():
            obj = before.pop(node.name, None)
            if obj is None:
                obj = GameObject(self, node, self.slot_of[node])
            else:
                obj.belong(node, self.slot_of[node])
            self._objects[node] = self._names[node.name] = obj
        for obj in before.values():
            self.repainted.discard(obj)
            obj.remove()

    # -- adding and removing ---------------------------------------------------------------

    def add(
        self,
        roots: Sequence[Node],
        components: Sequence[ComponentDeclaration] = (),
        carrier: Node | None = None,
    ) -> list[GameObject]:
        """See `morse.core.world.World.add`."""
        self._change(lambda change: change.add(roots, components, carrier))
        return [self._objects[node] for root in roots for node in root.walk()]

    def remove(self, objects: Sequence[Posed]) -> None:
        """See `morse.core.world.World.remove`."""
        self._change(lambda change: change.remove([obj.node for obj in objects]))

    def arrange(self, roots: Sequence[Node], components: Sequence[ComponentDeclaration], zones: Sequence[Zone]) -> None:
        """See `morse.core.world.World.arrange`."""
        self._change(lambda change: change.arrange(roots, components, zones))

    def replace(self, node: Node, new: Node) -> GameObject:
        """Replace a node, with all nodes below it, by another node, while the simulation runs.

        Objects of nodes with the same names are kept. Moving bodies keep their poses; static bodies get the pose of the
        new node.

        Raises:
            ValueError: as for `add`, or nodes that carry components are missing below the new node.
        """
        self._change(lambda change: change.replace(node, new))
        return self._objects[new]

    def renew(self, objects: Sequence[Posed]) -> None:
        """See `morse.core.world.World.renew`."""
        nodes = {node for obj in objects for node in obj.node.walk()}
        for node in nodes:
            self._objects[node].restore()
        self._change(lambda change: None, {node.name for node in nodes})

    def rebuild(self, edit: Callable[[SceneChange], None]) -> None:
        """Apply several changes to the nodes of the scene at once, while the simulation runs; see `add`, `replace`.

        Args:
            edit: function that makes the changes; its argument is a `SceneChange`.

        Raises:
            ValueError: the engine refuses a shape, or a change is not possible; the world is then unchanged.
        """
        self._change(edit)

    def _release_from_what_goes(self, renewed: Collection[str]) -> None:
        staying = {node.name for node in self.scene.nodes() if node.name not in renewed}
        for obj in self._objects.values():
            holder = self.attachments.holder(obj.slot)
            if holder is not None and holder.node.name not in staying:
                self.attachments.release(obj.slot)

    def _change(self, edit: Callable[[SceneChange], None], renewed: Collection[str] = ()) -> None:
        """Change the scene; objects keep their state, except the new ones and those with a name in ``renewed``."""
        change = SceneChange(self.scene)
        try:
            edit(change)
            compiled = compile_scene(self.scene)
        except Exception:
            change.undo()
            raise
        self._release_from_what_goes(renewed)
        before = saved.checked(self.get_state())
        varied = {name: values for name, values in self._variations.present().items() if name not in renewed}
        parting = [name for name in self.separation.names() if name not in renewed]
        old, floors = copy.copy(self), self.gliding.floor_bits()
        stamp, poses_before = self.stamp, self._moving_poses
        self.take(compiled, self.period)
        self._build()
        bits = {
            bit: later[number]
            for node, numbers in self.gliding.floor_bits().items()
            for later in [numbers]
            for number, bit in floors.get(node, {}).items()
            if number in later
        }
        transfer = Transfer(old, self, bits, renewed)
        self._saving.set_state(transfer.state(before, self._names))
        self._variations.apply(varied)
        came = {index for name, index in self.named.items() if name in renewed or name not in old.named}
        self.separation.begin(came, parting)
        self.gliding.lift_all()
        self._floor_planes.before_step()
        self.stamp = stamp + 1
        self._moving_poses.follow(poses_before)
        self.arrangement += 1
        rays = self.__dict__.get("rays")
        if rays is not None:
            rays.rebuild()

    # -- objects ---------------------------------------------------------------------------

    @property
    def objects_by_name(self) -> dict[str, GameObject]:
        """All objects of the world by name."""
        return self._names

    def objects(self) -> Iterator[GameObject]:
        """Iterate over all objects, parents before their children."""
        return iter(self._objects.values())

    def object_list(self) -> ObjectList[GameObject]:
        """All objects, indexed by number or by name."""
        return ObjectList(list(self._objects.values()))

    def object_of(self, node: Node) -> GameObject:
        """The object of a node."""
        return self._objects[node]

    def find_object(self, node: Node) -> GameObject | None:
        """Return the object of a node, or None if the node was removed from the world."""
        return self._objects.get(node)

    def game_object(self, name: str) -> GameObject:
        """The object of that name.

        Raises:
            KeyError: there is no such object.
        """
        return self._names[name]

    def geom_object(self, geom: int) -> GameObject:
        """Return the object to which a MuJoCo geom belongs."""
        return self._objects[self.geom_node[geom]]

    # -- time ------------------------------------------------------------------------------

    def reset(self, *, motors: bool = False) -> None:
        """Reset all objects to the scene, at rest.

        Args:
            motors: whether motors get the gains and the control modes of `keep_motors`; else they keep their own.
        """
        for name, values in self._pristine.items():
            if motors or name not in MOTOR_ARRAYS:
                getattr(self.model, name)[:] = values
        self.bodies.moved_shapes.reset()
        mujoco.mj_resetData(self.model, self.data)
        self._start_joints()
        self._hold_joints()
        self.gliding.reset()
        self._steps.reset()
        self._rescue.reset()
        if self.touches is not None:
            self.touches.forget()
        self.drives.reset()
        self.attachments.reset()
        kinematics.place_as_compiled(self)
        for obj in self._objects.values():
            obj.restore()
        for part in self._moving_poses.put_back():
            self.rearranged.update(part.node.walk())
        self.loose.clear()
        self.has_forces = False
        self.is_stirred = True
        self.known_contacts = None
        forward(self, self._hold_joints)
        if raise_sunken(self, self.bodies):
            forward(self, self._hold_joints)
        self.separation.begin()
        kinematics.refresh(self)

    def keep_motors(self) -> None:
        """Take the gains and the control modes of motors for `reset`: those after the components were created."""
        self._pristine.update((name, getattr(self.model, name).copy()) for name in MOTOR_ARRAYS)

    def _start_joints(self) -> None:
        """Set the initial values of joints; keyframes have others than those of the bodies of the file."""
        for joints in self.joints.values():
            for joint in joints.values():
                if joint.width == 1:
                    self.data.qpos[joint.qpos] = joint.start

    def _hold_joints(self) -> None:
        """Set the setpoints of the motors of joints to the initial positions."""
        for joints in self.joints.values():
            for joint in joints.values():
                if joint.actuator >= 0:
                    holds = control_of(self.model.actuator_biasprm[joint.actuator]) is Control.POSITION
                    number = int(self.model.dof_jntid[joint.dof])
                    low, high = self.model.jnt_range[number] if self.model.jnt_limited[number] else (-np.inf, np.inf)
                    self.data.ctrl[joint.actuator] = min(max(joint.start, low), high) if holds else 0.0

        for motor in self.file_motors:
            self.data.ctrl[motor.actuator] = motor.start

    def step(self) -> None:
        """Run one tick: the parts that have work, the steps of the engine; then read the poses."""
        for act in self._tick.before:
            act()
        self._steps.step()
        for act in self._tick.after:
            act()
        kinematics.sync(self)

    def advance(self, ticks: int) -> int:
        """See `morse.core.world.World.advance`."""
        done = self.free_run.run(ticks) if ticks > 1 else 0
        if ticks > 1 and not done and self.drives.is_idle and self._is_idle():
            # nobody is driven, and asks for the poses at the beginning of the last tick
            done = self._steps.run(ticks)
        if not done:
            self.step()
        return done or 1

    def only_steps(self) -> bool:
        """Whether the next ticks are steps of the engine and nothing else, if motors alone are commanded."""
        return self.touches is None and self.drives.is_idle and self._is_idle() and self._steps.are_plain

    def missed(self, ticks: int) -> None:
        """Take note of ticks whose steps were run elsewhere; the caller sets the state of the engine."""
        self._steps.missed(ticks)

    @property
    def most_contacts(self) -> int:
        """Number of contacts beyond which bodies may be excluded; see `morse.physics.stability`."""
        return self._steps.most_contacts

    def _is_idle(self) -> bool:
        """Whether no part of the physics but the drives has work."""
        touches = self.touches
        if len(self._tick.before) != 1 + (touches is not None) or len(self._tick.after) != len(self._tick.before):
            return False
        return touches is None or touches.is_idle

    @property
    def recoveries(self) -> Sequence[Recovery]:
        """The last bodies that diverged and were reset, one entry per event; see `morse.physics.stability`."""
        return self._rescue.recoveries

    @property
    def recovered(self) -> int:
        """Number of resets of bodies since the world was created."""
        return self._rescue.count

    def linkage(
        self,
        armature: Posed,
        bones: Sequence[Bone],
        hanging: Sequence[tuple[Any, int, Sequence[float], Sequence[float]]],
    ) -> Linkage:
        """Create a linkage: objects on bones that joints move."""
        return Linkage(self, cast("GameObject", armature), bones, hanging)

    def fleet(self, objects: Sequence[Posed]) -> Fleet:
        """Create a fleet of objects that are driven as bodies by one call."""
        return Fleet(self.drives, [obj.slot for obj in objects])

    def wheel_fleet(self, objects: Sequence[Posed]) -> WheelFleet:
        """Create a fleet of robots whose wheels are turned by one call."""
        return WheelFleet(self, [obj.slot for obj in objects])

    def kinematic_bodies(self, objects: Sequence[Posed]) -> KinematicBodies:
        """Create what moves bodies of the type ``KINEMATIC`` by one call."""
        return KinematicBodies(self, list(objects))

    def snapshots(self, objects: Sequence[Posed]) -> Snapshots:
        """Create a source of snapshots of the poses of some objects."""
        return Snapshots(self, cast("Sequence[GameObject]", objects))

    def sync(self) -> None:
        """Compute all poses from the present state."""
        kinematics.sync(self)

    # -- queries -----------------------------------------------------------------------------

    def is_fixed(self, slot: int) -> bool:
        """Whether a slot is static, apart from explicit calls."""
        return self.slots[slot].frame.motion is Motion.FIXED

    def contacts(self) -> list[tuple[GameObject, GameObject]]:
        """Return the pairs of objects that are in contact."""
        pairs = kinematics.contact_pairs(self).tolist() + self.gliding.supports()
        return [(self.geom_object(a), self.geom_object(b)) for a, b in pairs]

    def touched_by(self, obj: Posed, margin: float = 0.0) -> list[GameObject]:
        """Return the objects whose shapes are closer than ``margin`` (m) to the shapes of an object, see `Touching`."""
        if self._touching is None:
            self._touching = Touching(self)
        return self._touching.objects(cast("GameObject", obj), margin)

    def set_mass(self, obj: Posed, mass: float) -> None:
        """See `morse.core.world.World.set_mass`."""
        self._variations.set_mass(obj, mass)

    def set_friction(self, obj: Posed, friction: float) -> None:
        """See `morse.core.world.World.set_friction`."""
        self._variations.set_friction(obj, friction)

    def check_variation(self, obj: Posed, what: str, value: float) -> None:
        """See `morse.core.world.World.check_variation`."""
        self._variations.check(obj, what, value)

    def watch_touches(self, name: str) -> Mapping[str, float]:
        """See `morse.core.world.World.watch_touches`."""
        if self.touches is None:
            self.watch = self.touches = Touches(self, self._contact_points, {})
            self._arrange_tick()
        self.touches.watch(name)
        return self.touches.impulses[name]

    def contact_forces(self) -> bytes:
        """Return all contact points as bytes of (N, 6) float32, see `ContactPoints.look`."""
        return self._contact_points.look().tobytes()

    def mass_centres(self) -> list[tuple[str, float, tuple[float, float, float]]]:
        """Return the name, mass (kg) and centre of mass (m, in its own frame) of every dynamic body."""
        centres = []
        for slot in self.slots[: self.moving]:
            if slot.frame.motion in (Motion.FREE, Motion.HINGE, Motion.JOINT):
                x, y, z = self.model.body_ipos[slot.body].tolist()
                centres.append((slot.frame.node.name, float(self.model.body_mass[slot.body]), (x, y, z)))
        return centres

    # -- the view --------------------------------------------------------------------------

    @property
    def layout(self) -> int:
        """A value that changes whenever `moving_nodes` changes."""
        return self._moving_poses.layout

    def moving_nodes(self) -> list[tuple[Node, str]]:
        """Return the nodes in the order of `poses`, each with its frame, ``world`` or ``parent``."""
        return self._moving_poses.nodes()

    def poses(self) -> NDArray[np.float32]:
        """Return (M, 7) x, y, z, qw, qx, qy, qz of the moving nodes, in the order of `moving_nodes`."""
        return self._moving_poses.read()

    def note_displaced(self, obj: GameObject) -> None:
        """Record that a node has moved relative to its parent, so that the view gets its pose from now on."""
        self._moving_poses.note_displaced(obj)

    def appearance_changed(self, obj: Posed) -> None:
        """Notify the view that the appearance of an object changed."""
        self.repainted.add(cast("GameObject", obj))
        self.repaints += 1
        for sink in self.repaint_sinks:
            sink(obj)

    # -- the whole state -------------------------------------------------------------------

    def get_state(self) -> dict[str, Any]:
        """See `morse.core.world.World.get_state`."""
        return self._saving.get_state()

    def check_state(self, state: object) -> None:
        """Raise `ValueError` if `set_state` would refuse the state."""
        self._saving.checked(state)

    def validated(self, state: object) -> saved.SavedWorld:
        """Return a state for `set_state`, which does not validate it again.

        Raises:
            ValueError: see `set_state`.
        """
        return self._saving.checked(state)

    def set_state(self, state: object) -> None:
        """Restore a state that `get_state` returned, of this world or of another world of the same scene.

        Raises:
            ValueError: the state is damaged, or belongs to another scene; the world is then unchanged.
        """
        world_state = state if isinstance(state, saved.SavedWorld) else self._saving.checked(state)
        self._moving_poses.put_back()
        self._saving.set_state(world_state)
        self.separation.resume()
        if self.touches is not None:
            self.touches.forget()
