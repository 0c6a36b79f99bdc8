"""Simulated time, frames and poses of nodes in many ticks, from the poses of the engine."""

from __future__ import annotations

import json
from bisect import bisect_right
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotation_rows import quaternions_from_rotations
from morse.mathutils.rotations import product, turn_back
from morse.physics.poses.snapshot import PoseRows
from morse.recording.fields.columns import Batch
from morse.rosmsgs.cdr import encode, encode_rows
from morse.rosmsgs.names import MAP
from morse.rosmsgs.parts import header_at, quaternion, quaternion_of, time, xyz, xyzw
from morse.rosmsgs.table import Qos

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.values import Fields, RosMessage
    from morse.core.world import Body
    from morse.physics.poses.snapshot import Numbers
    from morse.recording.streams import TopicFile
    from morse.rosmsgs.moving import MovingFrame
    from morse.rosmsgs.topics.backend import Backend
    from morse.rosmsgs.topics.transforms import Transforms


# Poses and appearance of everything that moves or changes, so that a run can be shown without simulating it.

POSES, NODES, LOOKS = "/morse/poses", "/morse/nodes", "/morse/appearance"
TOPICS = (POSES, NODES, LOOKS)
POSES_TYPE, TEXT_TYPE = "geometry_msgs/msg/PoseArray", "std_msgs/msg/String"


class Motion:
    """Publishes the poses of all moving nodes in the world in every tick, their names, and changes of appearance.

    Attributes:
        repainted: objects whose appearance has changed since the last `publish_looks`.

    Args:
        context: of the simulation.
        backend: receives the messages.
    """

    def __init__(self, context: Context, backend: Backend) -> None:
        self._world = context.world
        self._poses = backend.publisher(POSES, POSES_TYPE, Qos(100))
        self._nodes = backend.publisher(NODES, TEXT_TYPE, Qos(1, latched=True))
        self._looks = backend.publisher(LOOKS, TEXT_TYPE, Qos(1000))
        self.repainted: set[Any] = set()
        self._last_looks: dict[str, Any] = {}
        self._names: list[str] | None = None
        self._world.repaint_sinks.append(self.repainted.add)
        self.follow()

    def close(self) -> None:
        """Stop observing the world."""
        if self.repainted.add in self._world.repaint_sinks:
            self._world.repaint_sinks.remove(self.repainted.add)

    def follow(self) -> None:
        """The objects may have changed."""
        self._layout = -1
        self._objects: list[Any] = []
        self._is_new = True

    # -- a tick ------------------------------------------------------------------------------

    def publish(self, stamp: int) -> None:
        """Publish the poses, and what has changed, encoded in the tick.

        Args:
            stamp: simulated time, ns.
        """
        self.renew()
        self.publish_looks()
        if self._poses is not None:
            self._poses.publish(self.message(stamp))

    @property
    def channel(self) -> int:
        """The id of the channel of poses in the file; -1 if they are not in a file."""
        return getattr(self._poses, "number", -1)

    def renew(self) -> list[object]:
        """Publish the names of the nodes if they have changed, and return their objects."""
        world = self._world
        if world.layout != self._layout or self._is_new:
            self._layout = world.layout
            self._name_nodes()
        if self._is_new:
            self._is_new = False
            # restored objects do not report their appearance
            self.repainted.update(world.objects())
        return self._objects

    def _name_nodes(self) -> None:
        world = self._world
        nodes = [node for node, _ in world.moving_nodes()]
        self._objects = [world.object_of(node) for node in nodes]
        self._snapshots = world.snapshots(self._objects)
        names = [node.name for node in nodes]
        if self._nodes is not None and names != self._names:
            self._names = names
            self._nodes.publish(encode(TEXT_TYPE, {"data": json.dumps(names)}))

    def message(self, stamp: int) -> bytes:
        """Return the message of the present poses, encoded in the tick."""
        snapshot, origin = self._snapshots.now(), Transformation3d()
        poses = []
        for row in range(len(snapshot.slots)):
            pose = Transformation3d()
            pose.set_pose(*snapshot.pose(row))
            relative = origin.transformation3d_with(pose)
            poses.append(
                {
                    "position": xyz((relative.x, relative.y, relative.z)),
                    "orientation": quaternion(quaternion_of(relative)),
                }
            )
        return encode(POSES_TYPE, {"header": header_at(stamp, MAP), "poses": poses})

    # -- appearance --------------------------------------------------------------------------

    def publish_looks(self) -> None:
        """Publish the appearance of the objects that have changed."""
        if not self.repainted:
            return
        looks = []
        for obj in sorted((one for one in self.repainted if not one.invalid), key=lambda one: str(one.name)):
            look = look_of(obj)
            if self._last_looks.get(obj.name) != look:
                self._last_looks[obj.name] = look
                looks.append({"name": obj.name, **look})
        self.repainted.clear()
        if looks and self._looks is not None:
            self._looks.publish(encode(TEXT_TYPE, {"data": json.dumps(looks)}))


def look_of(obj: Body) -> dict[str, Any]:
    """The appearance of an object that can change while the simulation runs."""
    node, light = obj.node, obj.node.light
    return {
        "visible": bool(obj.visible),
        "color": None if node.color is None else [float(value) for value in node.color],
        "light": None
        if light is None
        else {
            "color": [float(value) for value in light.color],
            "energy": float(light.energy),
            "distance": float(light.distance),
            "spot_size": float(light.spot_size),
        },
    }


CLOCK_TYPE, FRAMES_TYPE = "rosgraph_msgs/msg/Clock", "tf2_msgs/msg/TFMessage"


class Channels(NamedTuple):
    """Channels in the file; -1 if a topic is not in the file."""

    clock: int
    frames: int
    poses: int


class World(NamedTuple):
    """What is written of the poses, while it stays the same.

    Attributes:
        channels: of the messages.
        nodes: number of the nodes in the list of poses; these are the first objects.
        slots: rigid group of each object.
        frames: names of the frames, parent and child, or None if they are not made of poses.
        starts: (F, 12) poses of the parents of the first frames, m; the objects of these frames follow the nodes. For
            each other frame there are two objects: that of the frame and that of its parent.
    """

    channels: Channels
    nodes: int
    slots: NDArray[np.intp]
    frames: Sequence[tuple[str, str]] | None
    starts: NDArray[np.float64]

    def of(self, ticks: NDArray[np.int64], stamps: NDArray[np.int64], rows: PoseRows) -> list[Batch]:
        """Encode the messages of some ticks.

        Args:
            ticks: (R,) their numbers.
            stamps: (R,) simulated times, ns.
            rows: the poses of the engine.
        """
        count = len(ticks)
        batches = [Batch(self.channels.clock, ticks, encode_rows(CLOCK_TYPE, {"clock": time(stamps)}, count))]
        positions, rotations = rows.carried(self.slots)
        if self.frames:
            transforms = self._transforms(stamps, positions, rotations)
            batches.append(
                Batch(self.channels.frames, ticks, encode_rows(FRAMES_TYPE, {"transforms": transforms}, count))
            )
        # a sum with zero removes the sign of zero, as the product with the pose of the world
        nodes = [numbers[:, : self.nodes] + 0.0 for numbers in (*positions, *rotations)]
        poses = [
            {"position": _named("xyz", place), "orientation": _named("xyzw", quaternion)}
            for place, quaternion in zip(_each(nodes[:3]), _each(_quaternions(nodes[3:])), strict=True)
        ]
        message: RosMessage = {"header": header_at(stamps, MAP), "poses": poses}
        return [*batches, Batch(self.channels.poses, ticks, encode_rows(POSES_TYPE, message, count))]

    def _transforms(self, stamps: NDArray[np.int64], positions: Numbers, rotations: Numbers) -> list[Fields]:
        assert self.frames is not None
        first, bases, others = self.nodes, len(self.starts), len(self.frames) - len(self.starts)
        children = slice(first, first + bases + others)
        above = slice(first + bases + others, None)
        starts = np.broadcast_to(self.starts.T[:, None, :], (12, len(stamps), bases))
        parents = [np.concatenate((start, numbers[:, above]), axis=1)
                   for start, numbers in zip(starts, (*positions, *rotations), strict=True)]  # fmt: skip
        place, m = parents[:3], parents[3:]
        offsets = turn_back(m, [q[:, children] - p for p, q in zip(place, positions, strict=True)])  # type: ignore[arg-type]
        back = m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]
        turns = product(back, tuple(numbers[:, children] for numbers in rotations))  # type: ignore[arg-type, misc]
        pairs = zip(self.frames, _each(offsets), _each(_quaternions(turns)), strict=True)  # type: ignore[arg-type]
        return [
            {
                "header": header_at(stamps, parent),
                "child_frame_id": child,
                "transform": {"translation": _named("xyz", place), "rotation": _named("xyzw", turn)},
            }
            for (parent, child), place, turn in pairs
        ]


def world_of(
    channels: Channels, nodes: Sequence[object], frames: Sequence[MovingFrame] | None
) -> tuple[World, list[object]]:
    """Return what is written, and the objects whose mountings are needed."""
    bases = [frame for frame in frames or () if frame.start is not None]
    others = [frame for frame in frames or () if frame.start is None]
    objects: list[Any] = [*nodes, *(one.object for one in (*bases, *others)), *(one.against for one in others)]
    numbers = [[*position, *rotation] for position, rotation in (one.start.get_pose() for one in bases if one.start)]
    names = None if frames is None else [(one.parent, one.child) for one in (*bases, *others)]
    slots = np.array([one.slot for one in objects], dtype=np.intp)
    return World(channels, len(nodes), slots, names, np.array(numbers, dtype=np.float64).reshape(-1, 12)), objects


def _quaternions(rotations: Numbers) -> Numbers:
    """Quaternions x, y, z, w, as messages have them."""
    shape = rotations[0].shape
    quaternions = quaternions_from_rotations([numbers.reshape(-1) for numbers in rotations])
    return [np.broadcast_to(part, quaternions[0].shape).reshape(shape) for part in xyzw(np.stack(quaternions, axis=-1))]  # type: ignore[arg-type]


def _each(numbers: Numbers) -> list[list[NDArray[np.float64]]]:
    """The numbers (R,) of each object."""
    return [[part[:, column] for part in numbers] for column in range(numbers[0].shape[1])]


def _named(axes: str, numbers: Sequence[NDArray[np.float64]]) -> Fields:
    return dict(zip(axes, numbers, strict=True))


# Keeps the poses of the engine in each tick.

#: number of values of a tick in the flat list
_POSE_STRIDE = 5


class KeptPoses:
    """Keeps the poses of all rigid groups; simulated time, frames and poses of nodes follow from them.

    Args:
        context: of the simulation.
        topic_file: receives messages when the nodes have changed.
        transforms: the tree of frames.
        motion: names the nodes, and publishes changes of their appearance.
        clock, frames: ids of the channels of time and frames.

    Attributes:
        has_frames: whether all frames follow from poses.
    """

    def __init__(
        self, context: Context, topic_file: TopicFile, transforms: Transforms, motion: Motion, clock: int, frames: int
    ) -> None:
        self._clock, self._world, self._topic_file = context.clock, context.world, topic_file
        self._transforms, self.motion = transforms, motion
        self._channels = Channels(clock, frames, motion.channel)
        self.has_frames = False
        self._rows: list[Any] = []
        self.follow()

    def follow(self) -> None:
        """The objects may have changed."""
        self._displacements = self._layout = -1
        self._mountings: list[object] = []
        self._objects: list[Any] = []
        self._world_so_far: World | None = None

    def keep(self) -> bool:
        """Keep the poses of the present tick; return False if the frames or the nodes have changed."""
        world, is_same = self._world, True
        if self._transforms.changed or world.layout != self._layout or self._world_so_far is None:
            self._renew()
            is_same = False
        if world.displacements != self._displacements:
            self._displacements = world.displacements
            mountings = [obj.mounting for obj in self._objects]
            # most objects that are moved are none of these, such as the bones of an arm
            if mountings != self._mountings:
                self._mountings = mountings
        positions, rotations = world.positions, world.rotations
        self._rows += (self._clock.tick, self._world_so_far, self._mountings, positions.share(), rotations.share())
        self._topic_file.held += 96 * len(positions)
        return is_same

    def _renew(self) -> None:
        world, stamp = self._world, self._clock.stamp()
        if self._transforms.changed:
            # only the fixed frames are sent, and the moving ones found
            self._transforms.publish(stamp, wanted=False)
        nodes = self.motion.renew()
        self._layout = world.layout
        frames = self._transforms.plain()
        self.has_frames = frames is not None
        self._world_so_far, self._objects = world_of(self._channels, nodes, frames)
        self._displacements = -1

    def batches(self, until: int, times: Callable[[NDArray[np.int64]], NDArray[np.int64]]) -> Iterator[Batch]:
        """See `RecordedStream.batches`."""
        some = self._rows[:]
        count = bisect_right(some[::_POSE_STRIDE], until)
        del self._rows[: _POSE_STRIDE * count]
        numbers, *columns = (some[k : _POSE_STRIDE * count : _POSE_STRIDE] for k in range(_POSE_STRIDE))
        every = np.array(numbers, dtype=np.int64)
        # compared without a function of Python for each tick: the simulation would wait for it
        keys = list(zip(map(id, columns[0]), map(len, columns[2]), strict=True))
        for _, group in groupby(range(count), keys.__getitem__):
            places = list(group)
            part = slice(places[0], places[-1] + 1)
            worlds, mountings, positions, rotations = (column[part] for column in columns)
            poses = PoseRows.of(positions, rotations, mountings)
            yield from worlds[0].of(every[part], self._clock.stamps_of(every[part]), poses)
