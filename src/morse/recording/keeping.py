"""Stores data of sensors that act together, and frames of robots, so that they are encoded later."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.kernel.recording import records
from morse.middleware.ros2.transforms import transform
from morse.recording.captures import CopiesCapture, FramesCapture, Layout, Lone, capture_of
from morse.recording.captures.poses import groups_of
from morse.recording.captures.template import STAMP, Part, Template
from morse.recording.disk import CHUNK
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.kinds.states import clock

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.groups.group import Group
    from morse.kernel.recording import NativeRecords
    from morse.physics.objects.mounting import Mounting
    from morse.recording.captures import Capture
    from morse.recording.recorded_stream import RecordedStream
    from morse.recording.streams import RecordedStreams, Tape

_CLOCK, _TF = "rosgraph_msgs/msg/Clock", "tf2_msgs/msg/TFMessage"
#: maximum number of known groups and layouts; groups are formed again when their members change
_MOST_KNOWN = 256
#: maximum number of new captures until the components change: creating one takes as long as hundreds of messages
_MOST_MADE = 200
#: maximum number of rigid groups of a world, of all of which references to the poses are stored: the world then moves
#: to other memory in each tick, which takes longer in large worlds
_MOST_SHARED = 200
#: maximum number of rigid groups whose poses are copied
_MOST_COPIED = 128
#: size of a position and of a rotation, bytes
_POSITION, _ROTATION = 24, 72
#: maximum number of times that the data of a sensor no longer suit its capture
_MOST_FAILURES = 10


class Captures:
    """Stores the data of messages of a recording in the tick.

    A group of sensors, or a sensor that acts alone, is stored from the tick after its first measurement on: the streams
    are then silent, see `RecordedStream.waiting`. In a tick in which something has changed, the streams encode all
    messages.

    Attributes:
        fire: called with each group, or sensor that acts alone, that has measured, in order.
        quiet: components whose streams do not encode their measurements.
        world: the world of the simulation.

    Args:
        native: the encoder.
        streams: the streams of the recording.
        tape: receives the messages.
    """

    def __init__(self, native: NativeRecords, streams: RecordedStreams, tape: Tape) -> None:
        self._native, self._streams, self._tape = native, streams, tape
        self._context, self.world = streams.context, streams.context.world
        self._transforms, self._clock = streams.transforms, streams.context.clock
        self._queue, self._held = tape.queue, 0
        self._fired: list[Group | Lone] = []
        self.fire = self._fired.append
        #: whether the last `flush` has stored the poses of the nodes
        self.kept = False
        self.quiet: set[Any] = set()
        self.forget()
        self._context.group_taps.append(self.fire)

    @classmethod
    def made_for(cls, streams: RecordedStreams, tape: Tape) -> Captures | None:
        """Return the captures of a recording; None without the kernel."""
        native = records()
        return None if native is None else cls(native, streams, tape)

    def forget(self) -> None:
        """The components may have changed."""
        #: by the members of a group
        self._known: dict[tuple[Any, ...], tuple[Capture, Sequence[Mounting] | None] | None] = {}
        self._layouts: dict[tuple[Group | Lone, ...], Layout] = {}
        #: by the members of a group: how often its data did not suit its capture
        self._failures: dict[tuple[Any, ...], int] = {}
        self._frames: tuple[FramesCapture, Sequence[Mounting]] | None = None
        #: whether it encodes the frames too; the streams encode those of joints, and of robots that odometry moves
        self._has_frames = False
        self._displacements = self._relocated = -1
        #: whether references to the poses of all rigid groups are stored, and not copies of those that are needed
        self._is_whole = True
        self._stored, self._places = slice(0, 0), (0, 0)
        self._made = 0
        self._looked = False
        present = set(map(id, self._context.components.values()))
        self.quiet = {component for component in self.quiet if id(component) in present}

    def close(self) -> None:
        """Stop storing data."""
        self._fired.clear()
        if self.fire in self._context.group_taps:
            self._context.group_taps.remove(self.fire)

    @property
    def keeps_clock(self) -> bool:
        """Whether simulated time is stored."""
        return self._frames is not None

    # -- a tick ------------------------------------------------------------------------------

    def flush(self) -> bool:
        """The end of a tick. Returns False if the streams have to encode simulated time and the frames."""
        fired, world = self._fired, self.world
        layout = self._layouts.get(tuple(fired))
        tick, tape = self._clock.tick, self._tape
        if (
            layout is None
            or (world.displacements != self._displacements and not self._is_unmoved())
            or len(world.relocated) != self._relocated
            or self._transforms.changed
            or tick < tape.kept
        ):
            self.kept = False
            return self._look_around()
        positions, rotations = world.positions, world.rotations
        of_groups = positions.array
        for group in layout.posed:
            if group.poses.snapshot.group_positions is not of_groups:  # an object has moved since
                return self._encode_all()
        for sensor in layout.alone:
            if sensor.stamp != world.stamp:
                return self._encode_all()
        taken = None
        if layout.taken:
            taken = [(capture, capture.take(group)) for group, capture in layout.taken]
            for (changed, _), (_, data) in zip(layout.taken, taken, strict=True):
                if data is None:
                    self._distrust(changed)
                    return self._encode_all()
        fired.clear()
        tape.kept = tick
        # the values stay in one list: the release of a tuple per tick by another thread would take longer
        if self._is_whole:
            places = positions.place, rotations.place
            self._queue += (tick, layout, positions.share(), rotations.share(), *places, taken)
        else:
            stored, places = self._stored, self._places
            self._queue += (tick, layout, of_groups[stored].copy(), rotations.array[stored].copy(), *places, taken)
        held = self._held = self._held + layout.held
        if held > CHUNK:
            self._held = 0
            tape.pass_on(held)
        self.kept = True
        if not self._has_frames:
            return False
        joints, lines, looks = self._others
        if joints or lines or looks:
            self._streams.flush_others()
        return True

    def _distrust(self, group: Group | Lone) -> None:
        """The messages of a group have changed: make another capture, unless that happens too often."""
        failures = self._failures[group.members] = self._failures.get(group.members, 0) + 1
        self._layouts.clear()
        self._known.pop(group.members, None)
        if failures > _MOST_FAILURES:
            self._known[group.members] = None

    def _encode_all(self) -> bool:
        """Let the streams encode the measurements of the groups of this tick."""
        self.kept = False
        for group in self._fired:
            for stream in self._streams_of(group):
                if stream.component_instance in self.quiet:
                    try:
                        stream.publish_now()
                    except Exception:  # the stream encodes its messages itself from now on, and reports the error
                        self._known[group.members] = None
        self._fired.clear()
        return False

    def _streams_of(self, group: Group | Lone) -> list[RecordedStream]:
        known: Any = self._streams.streams
        members: Any = group.members
        return [stream for member in members for stream in known.get(member.name(), ())]

    # -- changes -----------------------------------------------------------------------------

    def _look_around(self) -> bool:
        """Encode this tick by the streams, and determine how the next ticks can be stored."""
        fired = tuple(self._fired)
        self._encode_all()
        if self._displacements != self.world.displacements:
            self._displacements = self.world.displacements
            self._drop_displaced()
        if self._transforms.changed:
            # the streams find the frames when they encode them
            self._drop_frames()
            self._layouts.clear()
            return False
        self._others = self._streams.others()
        if not self._looked:
            self._looked = True
            self._make_frames()
            self._layouts.clear()
        self._drop_dissolved()
        found = [(group, self._find(group)) for group in fired]
        kept = [(group, capture) for group, capture in found if capture is not None]
        motion = self._streams.motion
        assert motion is not None
        capture = motion.capture
        motion.renew(self._context.clock.stamp())
        self._relocated = motion.relocated
        if motion.capture is not capture:
            self._layouts.clear()
        others = [self._frames and self._frames[0], motion.capture]
        if not any(group.is_changed for group in fired):
            self._layouts[fired] = Layout(
                [group for group, _ in kept],
                [capture for _, capture in kept],
                [capture for capture in others if capture is not None],
            )
            self._store()
        return False

    def _store(self) -> None:
        """Determine how the poses of rigid groups are stored."""
        layouts, count = self._layouts.values(), len(self.world.positions)
        first, last = min(layout.first for layout in layouts), max(layout.last for layout in layouts)
        self._is_whole = is_whole = count <= _MOST_SHARED or last - first > _MOST_COPIED
        self._stored, self._places = slice(first, last), (-_POSITION * first, -_ROTATION * first)
        for layout in layouts:
            layout.store(count if is_whole else last - first)

    def _drop_dissolved(self) -> None:
        """Remove dissolved groups: their members are in other groups, and must not be stored twice."""
        if len(self._known) + len(self._layouts) > _MOST_KNOWN:
            self._known.clear()
            self._layouts.clear()
        for groups in list(self._layouts):
            if any(group.members[0].group is not (None if isinstance(group, Lone) else group) for group in groups):
                del self._layouts[groups]

    def _is_unmoved(self) -> bool:
        """Whether only other objects were moved within their rigid groups, such as the bones of an arm in each tick."""
        motion, frames = self._streams.motion, self._frames
        assert motion is not None
        if any(_is_displaced(members, found) for members, found in self._known.items()):
            return False
        if frames is not None and frames[1] != self._frame_mountings():
            return False
        if not motion.is_unmoved():
            return False
        self._displacements = self.world.displacements
        return True

    def _drop_frames(self) -> None:
        """Determine the frames again in the next tick."""
        self._frames, self._has_frames, self._looked = None, False, False

    def _drop_displaced(self) -> None:
        """Remove the captures of objects that were moved within their rigid groups."""
        for members, found in list(self._known.items()):
            if _is_displaced(members, found):
                del self._known[members]
                self._layouts.clear()
        if self._frames is not None and self._frames[1] != self._frame_mountings():
            self._drop_frames()
            self._layouts.clear()

    def _frame_mountings(self) -> list[Mounting]:
        frames = self._transforms.plain() or []
        objects = [one for frame in frames for one in (frame.object, frame.against) if one is not None]
        return [one.mounting for one in objects]

    def _find(self, group: Group | Lone) -> Capture | None:
        """The capture of a group; its members become silent, or no longer are, when the group is formed again."""
        if group.members not in self._known:
            self._known[group.members] = self._make(group)
        found = self._known[group.members]
        members = {stream.component_instance for stream in self._streams_of(group)}
        # a group asks which streams are silent only when it is formed
        forms = not isinstance(group, Lone)
        if found is None:
            group.is_changed |= forms and not self.quiet.isdisjoint(members)
            self.quiet -= members
            return None
        group.is_changed |= forms and not members <= self.quiet
        self.quiet |= members
        return found[0]

    def _make(self, group: Group | Lone) -> tuple[Capture, Sequence[Mounting] | None] | None:
        streams = self._streams_of(group)
        once = len({id(stream.component_instance) for stream in streams}) == len(streams)
        self._made += 1
        if not once or self._made > _MOST_MADE:
            return None
        capture = capture_of(self._native, group, streams)
        if capture is None:
            return None
        # numbers of the data do not depend on places
        return capture, None if isinstance(capture, CopiesCapture) else _mountings(group.members)

    def _make_frames(self) -> None:
        plain, channels = self._transforms.plain(), self._streams.own_channels()
        frames = plain or []
        stamp = self._context.clock.stamp()
        self._made += 1
        self._has_frames = False
        if channels is None or stamp <= 0 or self._made > _MOST_MADE:
            return
        made = [transform(stamp, frame.parent, frame.child, frame.pose()) for frame in frames]
        ends = [len(encode(_TF, {"transforms": made[: count + 1]})) for count in range(len(made))]
        messages = [encode(_CLOCK, clock(stamp))]
        parts = [Part(channels[0], messages[0])]
        if made:  # without moving frames, no message is sent
            messages.append(encode(_TF, {"transforms": made}))
            parts.append(Part(channels[1], messages[1], _stamps(ends)))
        snapshot = self.world.snapshots([frame.object for frame in frames]).now()
        capture = FramesCapture(self._native, Template(parts), ends, frames)
        if capture.agrees(groups_of(snapshot), messages):
            self._frames = capture, self._frame_mountings()
            self._has_frames = plain is not None


def _is_displaced(members: Any, found: tuple[Capture, Sequence[Mounting] | None] | None) -> bool:
    return found is not None and found[1] is not None and found[1] != _mountings(members)


def _mountings(components: Any) -> list[Mounting]:
    return [component.bge_object.mounting for component in components]


def _stamps(ends: Sequence[int]) -> list[int]:
    """Offsets of the time stamps of the transforms: after the count, and after each transform."""
    return [begin + -(begin - STAMP) % 4 for begin in (2 * STAMP, *ends[:-1])]
