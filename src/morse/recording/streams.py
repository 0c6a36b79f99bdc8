"""All sensors as topics of ROS 2 in a recording."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseError
from morse.middleware.ros2.backends.backend import Backend, Publisher, Subscription
from morse.middleware.ros2.datastream import Ros2DatastreamManager
from morse.recording.captures import Moments
from morse.recording.keeping import Captures
from morse.recording.mcap.records import Message
from morse.recording.motion import Motion
from morse.rosmsgs.definitions import definition
from morse.scene import StreamDeclaration

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from morse.core.context import Context
    from morse.recording.disk import Disk
    from morse.rosmsgs.qos import Qos

logger = logging.getLogger(__name__)

_STREAM = "morse.recording.recorded_stream.RecordedStream"
_ROS2 = Ros2DatastreamManager.classpath
#: options of ros2 for recordings, independent of the options of the scene
_ALWAYS = {"clock": True, "tf": True, "rosout": True}
#: option that is left out: frames are recorded in each tick
_RATE = "tf_rate"
#: images are recorded uncompressed; a second, lossy copy would only take time
LEFT_OUT = ("sensor_msgs/msg/CompressedImage",)


class _Topic(Publisher):
    """Passes the messages of a topic to a writer.

    Attributes:
        number: id of the channel in the file.
    """

    def __init__(self, number: int, keep: Callable[[bytes], object]) -> None:
        self.number, self._keep = number, keep

    def publish(self, data: bytes) -> bool:
        self._keep(data)
        return True

    def wanted(self) -> bool:
        return True

    def close(self) -> None:
        """A topic of a file cannot be closed."""


class Tape(Backend):
    """Topics that are written to a file, with the time of the simulation.

    Args:
        context: of the simulation.
        disk: receives the messages.

    Attributes:
        queue: receives ticks, see `Disk.queue`.
        kept: number of the last tick in the queue.
    """

    name, opens = "recording", "a file"

    def __init__(self, context: Context, disk: Disk) -> None:
        self._clock = context.clock
        self._disk = disk
        self._topics: dict[tuple[str, str], _Topic] = {}
        self._tick = self._clock.tick
        self._moment: tuple[int, int, int] | None = None
        self._back = 0
        disk.begin(Moments(self._clock, 0))
        self.queue = disk.queue
        self.kept = self._tick

    def now(self) -> tuple[int, int, int]:
        """Number of ticks (32 bits), log time, simulated time, both in ns; log time never decreases."""
        tick = self._clock.tick
        if tick != self._tick or tick != self.kept or self._moment is None:
            last = max(self._tick, self.kept)
            if tick < last:
                self._go_back(last, tick)
            self._tick = self.kept = tick
            stamp = self._clock.stamp()
            self._moment = tick & 0xFFFFFFFF, stamp + self._back, stamp
        return self._moment

    def _go_back(self, last: int, tick: int) -> None:
        """After a restart or a restored state, time continues from the last value."""
        self._back += self._clock.stamp_of(last) - self._clock.stamp_of(tick)
        self._disk.begin(Moments(self._clock, self._back))

    def pass_on(self, size: int) -> None:
        """See `Disk.pass_on`."""
        self._disk.pass_on(size)

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """See `Backend.publisher`."""
        return None if type_name in LEFT_OUT else self.topic(topic, type_name, qos)

    def topic(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """A topic of the file."""
        key = (topic, type_name)
        if key not in self._topics:
            number, message = len(self._topics) + 1, self._disk.message
            metadata = {"offered_qos_profiles": _profile(qos)}
            text = definition(type_name)
            self._disk.other(lambda file: file.channel(topic, file.schema(type_name, text), metadata))
            self._topics[key] = _Topic(number, lambda data: message(Message(number, *self.now(), data)))
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


class RecordedStreams(Ros2DatastreamManager):
    """The messages of all sensors, simulated time and the tree of frames, as published by the middleware ros2.

    A sensor with a stream of ros2 in the scene has the same topic in the recording.

    Args:
        context: of the simulation.
        tape: receives the messages.
        names: names of the recorded sensors; None for all, empty for only inputs and the log.
    """

    classpath = "morse.recording.streams.RecordedStreams"
    title = "recording"

    def __init__(self, context: Context, tape: Backend, names: Collection[str] | None = None) -> None:
        self._tape = tape
        self._names = names
        self._refused: set[str] = set()
        given = context.scene.manager_options.get(_ROS2, {})
        super().__init__({**{name: given[name] for name in given if name != _RATE}, **_ALWAYS}, context)
        #: stores data of sensors that act together, to encode them later; None: every message is encoded in the tick
        records_sensors = names is None or bool(names)
        #: the poses of all moving nodes; None for only inputs and the log
        self.motion = Motion(context, tape) if records_sensors else None
        self.captures = Captures.made_for(self, tape) if records_sensors and isinstance(tape, Tape) else None
        #: stores the messages of a tick; returns False if `flush` has to encode some of them
        self.store: Callable[[], bool] = _nothing if self.captures is None else self.captures.flush
        self.follow()

    def _make_backend(self) -> Backend:
        return self._tape

    def follow(self) -> None:
        """Record the present sensors, and no others."""
        if isinstance(self._tape, Tape):
            self._tape.now()  # after a restart, the first tick is one tick later than the last one
        if self.captures is not None:
            self.captures.forget()
        if self.motion is not None:
            self.motion.follow()
        sensors = {
            declared.name: declared
            for declared in self.context.scene.components
            if declared.kind == "sensor" and (self._names is None or declared.name in self._names)
        }
        components = self.context.components
        for name in [name for name in self.streams if name not in sensors or name not in components]:
            self.disconnect(name)
        for name, declared in sensors.items():
            known = self.streams.get(name)
            component = components.get(name)
            if component is None or (known and known[0].component_instance is component):
                continue
            options = next((dict(s.options) for s in declared.streams if s.manager == _ROS2), {})
            self._add(component, options)

    def _add(self, component: Any, options: dict[str, Any]) -> None:
        refusal: MorseError | None = None
        # of two sensors that could move a robot in the tree of frames, only one does
        for more in ({}, {"tf": False}):
            before = len(component.output_functions)
            try:
                self.connect(component, StreamDeclaration(_ROS2, _STREAM, "OUT", {**options, **more}))
                return
            except MorseError as error:
                refusal = error
                del component.output_functions[before:]
                for stream in self.streams.pop(component.name(), ()):
                    if hasattr(stream, "robot"):  # it was refused after it had reserved topics
                        self.closed(stream)
        if component.name() not in self._refused:
            self._refused.add(component.name())
            logger.warning("%s is not recorded: %s", component.name(), refusal)

    def flush(self) -> None:
        """The end of a tick that the captures have not stored; see `store`."""
        captures, motion = self.captures, self.motion
        if motion is None:
            self.write_log()
            return
        if captures is not None and captures.kept and captures.keeps_clock:
            self._flush_frames(self.context.clock.stamp())
            self.flush_others()
            return
        super().flush()
        if captures is None or not captures.kept:
            motion.publish(self.context.clock.stamp())
        else:
            motion.publish_looks()

    def flush_others(self) -> None:
        """Publish messages of the tick other than time and frames."""
        self.robots.publish()
        if self._log is not None:
            self._log.publish(self.context.clock.stamp())
        if self.motion is not None:
            self.motion.publish_looks()

    def others(self) -> tuple[Collection[Any], ...]:
        """Collections that are empty while `flush_others` has nothing to do."""
        return (
            self.robots.stating,
            () if self._log is None else self._log.lines,
            () if self.motion is None else self.motion.repainted,
        )

    def own_channels(self) -> tuple[int, int] | None:
        """The channels of simulated time and of the frames; None if they are not in a file."""
        clock, frames = getattr(self._clock, "number", None), getattr(self._tf, "number", None)
        return None if clock is None or frames is None else (clock, frames)

    def write_log(self) -> None:
        """Write the lines logged since the last tick."""
        if self._log is not None:
            while self._log.waiting:
                self._log.publish(self.context.clock.stamp())

    def finalize(self) -> None:
        """Release the sensors."""
        if self.captures is not None:
            self.captures.close()
        if self.motion is not None:
            self.motion.close()
        for streams in self.streams.values():
            for stream in streams:
                functions = stream.component_instance.output_functions
                if stream.default in functions:
                    functions.remove(stream.default)
        super().finalize()


def _nothing() -> bool:
    """Store nothing."""
    return False
