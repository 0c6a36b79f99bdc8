"""All sensors as topics of ROS 2 in a recording."""

from __future__ import annotations

import logging
from bisect import bisect_right
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from morse.core.exceptions import MorseError
from morse.recording.disk import CHUNK
from morse.recording.fields.columns import Keeper
from morse.recording.fields.kept_rows import KeptRows
from morse.recording.fields.poses import KeptPoses, Motion
from morse.recording.mcap.writer import Messages
from morse.rosmsgs.definitions import definition
from morse.rosmsgs.names import ROS2_MANAGER, TOPIC_OPTIONS
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription
from morse.rosmsgs.topics.manager import TopicManager
from morse.scene import StreamDeclaration

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.recording.disk import Disk
    from morse.recording.fields.columns import Batch
    from morse.rosmsgs.table import Qos

logger = logging.getLogger(__name__)

_STREAM = "morse.recording.recorded_stream.RecordedStream"
#: options of ros2 for recordings, independent of the options of the scene
_ALWAYS = {"clock": True, "tf": True, "rosout": True}
#: option that is left out: frames are recorded in each tick
_RATE = "tf_rate"
#: images are recorded uncompressed; a second, lossy copy would only take time
LEFT_OUT = ("sensor_msgs/msg/CompressedImage",)
#: approximate overhead of a message, bytes
_OVERHEAD = 100
#: later than every tick
_LAST = 1 << 62


class _Topic(Publisher):
    """Passes the messages of a topic to a writer.

    Attributes:
        number: id of the channel in the file.
    """

    def __init__(self, number: int, keep: Callable[[int, bytes], object]) -> None:
        self.number, self._keep = number, keep

    def publish(self, data: bytes) -> bool:
        self._keep(self.number, data)
        return True

    def wanted(self) -> bool:
        return True

    def close(self) -> None:
        """A topic of a file cannot be closed."""


class Kept(Protocol):
    """Keeps data in ticks."""

    def batches(self, until: int, times: Callable[[NDArray[np.int64]], NDArray[np.int64]]) -> Iterable[Batch]:
        """See `RecordedStream.batches`."""


class TopicFile(Backend):
    """Topics that are written to a file, with the time of the simulation.

    Args:
        context: of the simulation.
        disk: writes the messages.

    Attributes:
        held: approximate size of the data that were kept since the last chunk, bytes.
        kept: keep data, of which messages are made later.
        complete: number of the last complete tick.
    """

    name, opens = "recording", "a file"

    def __init__(self, context: Context, disk: Disk) -> None:
        self._clock = context.clock
        self._disk = disk
        self._topics: dict[tuple[str, str], _Topic] = {}
        self._back = 0
        self._last = self.complete = self._clock.tick
        self.held = 0
        self.kept: list[Kept] = []
        #: tick, id of a channel, and a message, one after the other
        self._messages: list[Any] = []
        disk.begin(self)

    def follow_clock(self) -> None:
        """After a restart or a restored state, time continues from the last value."""
        tick = self._clock.tick
        if tick < self._last:
            self.finish()
            self._back += self._clock.stamp_of(self._last) - self._clock.stamp_of(tick)
            self.complete = tick
        self._last = tick

    def finish(self) -> None:
        """Let all that was kept be encoded now, because what it refers to changes."""
        size, self.held = self.held, 0
        self._disk.pass_on(size, None)

    def end_tick(self) -> None:
        """All data of the present tick were kept."""
        self._last = self.complete = self._clock.tick
        if self.held > CHUNK:
            size, self.held = self.held, 0
            self._disk.pass_on(size, self.complete)

    def _keep(self, number: int, data: bytes) -> None:
        if self._clock.tick < self._last:
            self.follow_clock()
        self._messages += (self._clock.tick, number, data)
        self.held += _OVERHEAD + len(data)

    def take(self, until: int | None) -> list[Messages]:
        """See `morse.recording.disk.Source`."""
        if until is None:
            until = _LAST
        present = [Messages(one.channel, self._moments(one.ticks), one.data)
                 for rows in list(self.kept) for one in rows.batches(until, self._times)]  # fmt: skip
        ticks, numbers, messages = (self._messages[k::3] for k in range(3))
        count = bisect_right(ticks[: len(messages)], until)
        del self._messages[: 3 * count]
        by_channel: dict[int, list[int]] = {}
        for index, number in enumerate(numbers[:count]):
            by_channel.setdefault(number, []).append(index)
        for number, indices in by_channel.items():
            moments = self._moments(np.array([ticks[index] for index in indices], dtype=np.int64))
            present.append(Messages(number, moments, [messages[index] for index in indices]))
        return [one for one in present if len(one.moments)]

    def _times(self, ticks: NDArray[np.int64]) -> NDArray[np.int64]:
        """Log times, ns."""
        return self._clock.stamps_of(ticks) + self._back

    def _moments(self, ticks: NDArray[np.int64]) -> NDArray[np.int64]:
        """Number of each tick (32 bits), its log time and its simulated time, ns: (R, 3)."""
        stamps = self._clock.stamps_of(ticks)
        return np.stack((ticks & 0xFFFFFFFF, stamps + self._back, stamps), axis=1)

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """See `Backend.publisher`."""
        return None if type_name in LEFT_OUT else self.topic(topic, type_name, qos)

    def topic(self, topic: str, type_name: str, qos: Qos, more: Mapping[str, str] = MappingProxyType({})) -> _Topic:
        """A topic of the file.

        Args:
            more: named strings of its channel.
        """
        key = (topic, type_name)
        if key not in self._topics:
            metadata = {"offered_qos_profiles": _profile(qos), **more}
            text = definition(type_name)
            self._disk.other(lambda file: file.channel(topic, file.schema(type_name, text), metadata))
            self._topics[key] = _Topic(len(self._topics) + 1, self._keep)
        return self._topics[key]

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription | None:
        """Return None: a file has no commands."""
        return None

    def close(self) -> None:
        """Do nothing, because the owner closes the file."""


def _profile(qos: Qos) -> str:
    """The quality of service in the format of ROS 2 bags, YAML."""
    return "\n".join(
        (
            "- history: 1",
            f"  depth: {qos.depth}",
            f"  reliability: {1 if qos.reliable else 2}",
            f"  durability: {1 if qos.latched else 2}",
            *(
                f"  {name}:\n    sec: 9223372036\n    nsec: 854775807"
                for name in ("deadline", "lifespan", "liveliness_lease_duration")
            ),
            "  liveliness: 1",
            "  avoid_ros_namespace_conventions: false",
        )
    )


class RecordedStreams(TopicManager):
    """The messages of all sensors, simulated time and the tree of frames, as published by the middleware ros2.

    A sensor with a stream of ros2 in the scene has the same topic in the recording.

    Args:
        context: of the simulation.
        topic_file: receives the messages.
        names: names of the recorded sensors; None for all, empty for only inputs and the log.
    """

    classpath = "morse.recording.streams.RecordedStreams"
    title = "recording"

    def __init__(self, context: Context, topic_file: Backend, names: Collection[str] | None = None) -> None:
        self._backend = topic_file
        #: None: messages are encoded in the tick
        self.topic_file = topic_file if isinstance(topic_file, TopicFile) else None
        self._names = names
        self._refusals: set[str] = set()
        self.keeper = Keeper()
        #: keeps the data of sensors that measure on read; None if messages are encoded in the tick
        self.rows = None if self.topic_file is None else KeptRows(context, self.topic_file)
        options = context.scene.manager_options.get(ROS2_MANAGER, {})
        super().__init__(
            {**{name: options[name] for name in options if name in TOPIC_OPTIONS and name != _RATE}, **_ALWAYS}, context
        )
        records_sensors = names is None or bool(names)
        #: the poses of all moving nodes; None for only inputs and the log
        self.motion = Motion(context, topic_file) if records_sensors else None
        #: keeps poses for the file; None if messages are encoded in the tick
        self._poses: KeptPoses | None = None
        if self.topic_file is not None and self.motion is not None:
            clock, frames = (getattr(one, "number", -1) for one in (self._clock, self._tf))
            self._poses = KeptPoses(context, self.topic_file, self.transforms, self.motion, clock, frames)
            self.topic_file.kept.append(self._poses)
        self.follow()

    def _make_backend(self) -> Backend:
        return self._backend

    def follow(self) -> None:
        """Record the present sensors, and no others."""
        if self.topic_file is not None:
            self.topic_file.follow_clock()
            self.topic_file.finish()
        if self._poses is not None:
            self._poses.follow()
        if self.motion is not None:
            self.motion.follow()
        sensors = {
            entry.name: entry
            for entry in self.context.scene.components
            if entry.kind == "sensor" and (self._names is None or entry.name in self._names)
        }
        components = self.context.components
        gone = [streams for name, streams in self.streams.items() if name not in sensors or name not in components]
        for component in [streams[0].component_instance for streams in gone if streams]:
            self.disconnect(component)
        for name, entry in sensors.items():
            streams = self.streams.get(name)
            component = components.get(name)
            if component is None or (streams and streams[0].component_instance is component):
                continue
            options = next((dict(s.options) for s in entry.streams if s.manager == ROS2_MANAGER), {})
            self._add(component, options)

    def _add(self, component: Object, options: Options) -> None:
        refusal: MorseError | None = None
        # of two sensors that could move a robot in the tree of frames, only one does
        for more in ({}, {"tf": False}):
            before = len(component.output_functions)
            try:
                self.connect(component, StreamDeclaration(ROS2_MANAGER, _STREAM, "OUT", {**options, **more}))
                return
            except MorseError as error:
                refusal = error
                del component.output_functions[before:]
                for stream in self.streams.pop(component.name(), ()):
                    if hasattr(stream, "robot"):  # it was refused after it had reserved topics
                        self.closed(stream)
        if component.name() not in self._refusals:
            self._refusals.add(component.name())
            logger.warning("%s is not recorded: %s", component.name(), refusal)

    def closed(self, stream: Any) -> None:
        """See `TopicManager.closed`; what the stream has kept was written before."""
        super().closed(stream)
        if self.topic_file is not None and stream in self.topic_file.kept:
            self.topic_file.kept.remove(stream)
        if self.rows is not None:
            self.rows.remove(stream)

    def flush(self) -> None:
        """The end of a tick."""
        if self._poses is None:
            if self.motion is None:
                self.write_log()
            else:
                super().flush()
                self.motion.publish(self.context.clock.stamp())
            return
        is_same = self._poses.keep()
        if not self._poses.has_frames:
            self._flush_frames(self.context.clock.stamp())
        lines = () if self._log is None else self._log.lines
        if not is_same or self.robots.stating or lines or self._poses.motion.repainted:
            self.robots.publish()
            if self._log is not None:
                self._log.publish(self.context.clock.stamp())
            self._poses.motion.publish_looks()

    def write_log(self) -> None:
        """Write the lines logged since the last tick."""
        if self._log is not None:
            while self._log.waiting:
                self._log.publish(self.context.clock.stamp())

    def finalize(self) -> None:
        """Release the sensors."""
        if self.motion is not None:
            self.motion.close()
        if self.rows is not None:
            self.rows.close()
        for streams in self.streams.values():
            for stream in streams:
                functions = stream.component_instance.output_functions
                if stream.default in functions:
                    functions.remove(stream.default)
        super().finalize()
