"""A recorded run at any of its ticks: simulated again from its inputs, or shown from its recorded poses."""

from __future__ import annotations

import bisect
import logging
import math
from bisect import bisect_right
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.classes.project_imports import ProjectImports
from morse.core.journal import DELETE, EDIT, RESET, RESTORE, SPAWN
from morse.core.reports.faults import describe
from morse.mathutils import Quaternion
from morse.physics.model.layout import Motion
from morse.physics.poses import rigid
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.made.reading import RecordedMade
from morse.recording.recording import Moment, RecordedWorld
from morse.simulation.recordings.input_recording import ReplayError
from morse.simulation.recordings.replaying import Replay
from morse.simulation.states.state import State

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from numpy.typing import NDArray

    from morse.core.journal import Entry
    from morse.recording.recording import Recording
    from morse.simulation.recordings.input_recording import InputRecording
    from morse.simulation.simulation import Simulation


logger = logging.getLogger(__name__)

#: initial number of ticks between two states
_EVERY = 30
#: maximum number of states; above it, every second state is removed
_MOST = 600


class Timeline:
    """A simulation at any tick of a recorded run.

    Positions count ticks since the beginning of the recording. Resets and restored states do not decrease them.

    Args:
        simulation: a simulation of the scene; it is set to the beginning of the recording.
        length: number of ticks of the whole recording.

    Attributes:
        position: ticks since the beginning.
        length: the last position.
    """

    def __init__(self, simulation: Simulation, length: int) -> None:
        self._simulation = simulation
        self.position, self.length = 0, length

    @property
    def at_end(self) -> bool:
        """Whether the end of the recording is reached."""
        return self.position >= self.length

    def forward(self) -> None:
        """One tick."""
        self.approach(self.position + 1)

    def approach(self, target: int) -> bool:
        """Go to a position, or a part of the way that takes about the time of a tick.

        Returns:
            Whether the position is reached, or the recording ends before it.
        """
        raise NotImplementedError

    def poses(self) -> NDArray[np.float32]:
        """Return (M, 7) poses of the moving nodes of the world, as `World.poses` does."""
        return self._simulation.world.poses()


class _Kept(NamedTuple):
    position: int
    state: State
    replay: Any


class SimulatedTimeline(Timeline):
    """The inputs of the run are replayed; states that are saved in between make it go back.

    Args:
        recording: the inputs.

    Raises:
        StateError: the recording belongs to another scene.
    """

    def __init__(self, simulation: Simulation, recording: InputRecording, length: int) -> None:
        super().__init__(simulation, length)
        self._replay = Replay(simulation, recording)
        self._every = _EVERY
        self._moments: list[_Kept] = []
        self._keep()

    @property
    def at_end(self) -> bool:
        """Whether the end of the recording is reached."""
        return super().at_end or self._replay.done

    def forward(self) -> None:
        """Run one tick; the run ends at an input that does not fit it, which is logged."""
        try:
            self._replay.step()
        except ReplayError as error:
            logger.error("[ERROR][MORSE] the run cannot be shown further: %s", error)
            self.length = self.position
            return
        self.position += 1
        if self.position > self._moments[-1].position + self._every - 1:
            self._keep()

    def _keep(self) -> None:
        self._moments.append(_Kept(self.position, self._simulation.silent_state(), self._replay.place()))
        if len(self._moments) > _MOST:
            del self._moments[1::2]
            self._every *= 2

    def approach(self, target: int) -> bool:
        """Move towards a position by one tick, or by restoring a saved state."""
        target = max(0, min(target, self.length))
        nearest = self._moments[bisect.bisect_right(self._moments, target, key=lambda moment: moment.position) - 1]
        if target < self.position or nearest.position > self.position:
            self._simulation.restore(nearest.state)
            self._replay.go_to(nearest.replay)
            self.position = nearest.position
        elif self.position < target and not self.at_end:
            self.forward()
        return self.position == target or self.at_end


#: inputs that add or remove objects
_POPULATION = (RESET, RESTORE, SPAWN, DELETE)
#: fields of a lamp in a change of appearance
_LAMP = ("energy", "distance", "spot_size")


class RecordedTimeline(Timeline):
    """The world of a simulation at any tick of a recorded run: poses and appearance are those of the recording.

    The components do not act, and nothing is simulated. Robots that were spawned or deleted come and go with the inputs
    of the recording.

    Args:
        simulation: a simulation of the scene; it is set to the beginning of the recording.
        recording: the recording, with the poses of the nodes.
        inputs: its inputs.
        described: whether the recording describes the scene: all objects are created from their descriptions then.

    Attributes:
        moment: the poses.
        made: descriptions of the objects that were spawned.
        lost: names of objects without a description; they are not shown.

    Raises:
        StateError: the recording belongs to another scene.
        RecordingError: the recording is damaged.
    """

    def __init__(
        self, simulation: Simulation, recording: Recording, inputs: InputRecording, *, described: bool = False
    ) -> None:
        super().__init__(simulation, recording.length())
        self._inputs, self._from_descriptions = inputs, described
        self._world = simulation.world
        self.recorded = RecordedWorld(recording)
        if "origin" in recording.facts:  # the time of tick 0, ns: of a scene with the time of day, that of the run
            simulation.clock.go_to(simulation.clock.tick, recording.number("origin") / 1e9)
        self._start = simulation.clock.stamp_of(recording.number("tick"))
        (channel,) = recording.topic_numbers(INPUTS) or (-1,)
        times = [one.log_time for one in self.recorded.history.every(channel)]
        pairs = list(zip(times, inputs.entries, strict=True))
        refused = inputs.refused()
        self._events: list[tuple[int, int, Entry]] = [
            (time, index, entry)
            for index, (time, entry) in enumerate(pairs)
            if entry.kind in _POPULATION and entry.order not in refused
        ]
        self.made = RecordedMade(recording, partial(modules_of, simulation))
        self.lost = [entry.name for _, index, entry in self._events if self._is_lost(entry, index)]
        self._inputs_of: dict[tuple[str, str], tuple[list[int], list[Entry]]] = {}
        for time, entry in pairs:
            inputs_so_far = self._inputs_of.setdefault((entry.kind, entry.name), ([], []))
            inputs_so_far[0].append(time)
            inputs_so_far[1].append(entry)
        self._apply: dict[str, Callable[[int, Entry], object]] = {
            RESET: lambda _, entry: simulation.restart(entry.content),
            RESTORE: lambda index, entry: self._arrange(entry.content, index),
            SPAWN: self._spawn,
            DELETE: lambda _, entry: simulation.delete(entry.name),
        }
        self._event_count = 0
        self._looks_until = -1
        self._placements: set[str] = set()
        self._rows: tuple[Any, list[tuple[int, int]], list[tuple[int, Any]]] = (None, [], [])
        self._static: list[int] = []
        self._begin()
        self.show()

    @classmethod
    def is_possible(cls, recording: Recording, inputs: InputRecording) -> bool:
        """Whether the recording has the poses of the nodes, and no file was edited while it was recorded."""
        return RecordedWorld.is_in(recording) and all(entry.kind != EDIT for entry in inputs.entries)

    @property
    def log_time(self) -> int:
        """The log time of the messages of the present position, ns."""
        return self._start + round(self.position / self._simulation.clock.frequency * 1e9)

    def last_input(self, kind: str, name: str) -> Any:
        """Return the content of the last input of a component up to the present position; None if there is none.

        Args:
            kind: of the input, see `morse.core.journal.Entry`.
            name: of the component.
        """
        times, entries = self._inputs_of.get((kind, name), ([], []))
        count = bisect_right(times, self.log_time + 1000)
        return entries[count - 1].content if count else None

    def approach(self, target: int) -> bool:
        """Go to a position; returns True, because that takes no time."""
        self.position = max(0, min(target, self.length))
        self.show()
        return True

    # -- the world ---------------------------------------------------------------------------

    def show(self) -> None:
        """Set the world to the present position.

        Raises:
            RecordingError: the recording is damaged.
        """
        # times of ticks are rounded
        time = self.log_time + 1000
        self._populate(time - 2000)
        # before the first recorded tick, the world is that of the beginning
        self.moment = self.recorded.at(time) or self._first
        stray = self._placements.difference(self.moment.names)
        if any(name in self._world.objects_by_name for name in stray):
            # it was moved later: at this moment, it was at its place in the scene
            self._begin()
            self._populate(time - 2000)
        self._placements = set(self.moment.names)
        self._paint(time)
        self._simulation.clock.go_to(self.moment.tick)
        self._place(self.moment)

    def _begin(self) -> None:
        if self._inputs.start is None:
            self._simulation.restart(self._inputs.seed)
        else:
            self._arrange(self._inputs.start, -1)
        self._event_count = 0
        self._looks_until = -1
        world = self._world
        objects = [world.object_of(node) for node, _ in world.moving_nodes()]
        rows = [[*position, *rigid.quaternion(turn)] for position, turn in (obj.world_pose() for obj in objects)]
        self._first = Moment(
            self._simulation.clock.tick,
            tuple(obj.name for obj in objects),
            np.array(rows, dtype=np.float64).reshape(-1, 7),
        )

    def _populate(self, time: int) -> None:
        """Let robots come and go as before a log time: inputs of that time came after the tick."""
        count = sum(1 for moment, _, _ in self._events if moment < time)
        if count < self._event_count:
            self._begin()
        for _, index, entry in self._events[self._event_count : count]:
            try:
                self._apply[entry.kind](index, entry)
            except Exception as error:  # what was refused during the recording is refused again
                logger.debug("%s of %s: %s", entry.kind, entry.name, describe(error))
            self._looks_until = -1
        self._event_count = count

    def _spawn(self, index: int, entry: Entry) -> None:
        entity = self.made.after(index).get(entry.name)
        if entity is not None:
            self._simulation.spawn(entry.name, entity, entity.position, entity.rotation)
        elif entry.content is not None and not self._from_descriptions:
            self._simulation.spawn(entry.name, *entry.content)

    def _arrange(self, state: State, index: int) -> None:
        """Restore who is there and where; the components do not act, so that their states are not needed."""
        whole = State(state.parts, state.unsaved, self.made.known(index), state.middlewares)
        self._simulation.arrange(whole, described=self._from_descriptions)

    def _is_lost(self, entry: Entry, index: int) -> bool:
        """Whether an object was spawned, and cannot be shown: in recordings of earlier versions, one by a function."""
        if entry.kind != SPAWN or entry.name in self.made.after(index):
            return False
        return entry.content is None

    def _paint(self, time: int) -> None:
        """Apply the changes of appearance up to a log time."""
        begin = self._looks_until if time >= self._looks_until else -1
        self._looks_until = time
        # of several changes of an object, the last one holds
        last = {change["name"]: change for change in self.recorded.looks(begin, time) if _is_look(change)}
        objects = self._world.objects_by_name
        for name, change in last.items():
            obj = objects.get(name)
            if obj is not None and _paint(obj, change):
                self._world.appearance_changed(obj)

    def _place(self, moment: Moment) -> None:
        world = self._world
        objects = world.objects_by_name
        if self._rows[0] != (moment.names, world.arrangement):
            leading, parts, self._static = [], [], []
            for row, name in enumerate(moment.names):
                obj = objects.get(name)
                if obj is None and name.partition(".")[0] in self.lost:
                    continue
                if obj is None:
                    logger.warning("the recorded object '%s' is not in the scene, and is not shown", name[:80])
                elif world.slots[obj.slot].frame.node is obj.node:
                    leading.append((row, obj.slot))
                    if world.slots[obj.slot].frame.motion is Motion.FIXED:
                        self._static.append(obj.slot)
                else:
                    parts.append((row, obj))
            self._rows = ((moment.names, world.arrangement), leading, parts)
        # the page gets the poses of static objects that calls have moved
        world.relocated.update(self._static)
        poses = moment.poses.tolist()
        for row, slot in self._rows[1]:
            x, y, z, *turn = poses[row]
            world.positions[slot] = (x, y, z)
            world.rotations[slot] = _rotation(turn)
        world.stamp += 1
        for row, obj in self._rows[2]:
            x, y, z, *turn = poses[row]
            obj.set_pose((x, y, z), _rotation(turn))

    def poses(self) -> NDArray[np.float32]:
        """Return (M, 7) poses of the moving nodes of the world, as `World.poses` does."""
        world = self._world
        rows = []
        for node, frame in world.moving_nodes():
            obj = world.object_of(node)
            position, rotation = obj.world_pose() if frame == "world" else obj.local_pose()
            rows.append([*position, *rigid.quaternion(rotation)])
        return np.array(rows, dtype=np.float32).reshape(-1, 7)


def modules_of(simulation: Simulation) -> Collection[str]:
    """The modules of the project."""
    project = simulation.scene.project
    return project.sources() if isinstance(project, ProjectImports) else ()


def _rotation(turn: list[float]) -> tuple[float, ...]:
    return tuple(value for row in Quaternion(turn).to_matrix() for value in row)


def _is_look(change: object) -> bool:
    return (
        isinstance(change, dict)
        and isinstance(change.get("name"), str)
        and isinstance(change.get("visible"), bool)
        and (change.get("color") is None or _are_numbers(change["color"], (3, 4)))
        and (change.get("light") is None or _is_lamp(change["light"]))
    )


def _is_lamp(lamp: object) -> bool:
    return (
        isinstance(lamp, dict)
        and _are_numbers(lamp.get("color"), (3,))
        and _are_numbers([lamp.get(name) for name in _LAMP], (3,))
    )


def _are_numbers(values: object, sizes: tuple[int, ...]) -> bool:
    return (
        isinstance(values, list)
        and len(values) in sizes
        and all(isinstance(value, (int, float)) and math.isfinite(value) for value in values)
    )


def _paint(obj: Any, change: dict[str, Any]) -> bool:
    """Set the appearance of an object; returns whether it has changed."""
    node, lamp = obj.node, change.get("light")
    color = None if change["color"] is None else tuple(map(float, change["color"]))
    light = node.light
    if light is not None and lamp is not None:
        numbers = {name: float(lamp[name]) for name in _LAMP}
        light = replace(light, color=tuple(map(float, lamp["color"])), **numbers)
    before = (obj.visible, node.color, node.light)
    obj.visible = change["visible"]
    if color is not None or node.color is not None:
        node.color = color
    node.light = light
    return before != (obj.visible, node.color, node.light)
