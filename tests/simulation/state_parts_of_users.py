"""Components of users, with attributes of all kinds."""

import random
import threading
from collections import Counter, OrderedDict, defaultdict, deque, namedtuple
from dataclasses import dataclass, field
from enum import Enum
from types import SimpleNamespace
from typing import Any

import numpy as np

from morse.core.declarations import add_data
from morse.core.sensor import Sensor

Reading = namedtuple("Reading", "tick value")


class Mood(Enum):
    CALM = 1
    WILD = 2


@dataclass
class Estimate:
    mean: float = 0.0
    history: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Mode:
    name: str
    gain: float


SLOW, FAST = Mode("slow", 0.5), Mode("fast", 2.0)
HOME = np.array([1.0, 2.0, 3.0])


class Slotted:
    __slots__ = ("__hidden", "other")

    def __init__(self) -> None:
        self.__hidden = 0

    def work(self) -> float:
        self.__hidden += 1
        return float(self.__hidden)


class Window(list):  # type: ignore[type-arg]
    """A list with an attribute."""

    def __init__(self, size: int) -> None:
        super().__init__()
        self.size = size

    def push(self, value: float) -> None:
        self.append(value)
        del self[: -self.size]


class Own:
    """Defines its own state; the other attributes can be computed."""

    def __init__(self) -> None:
        self.count = 0
        self.doubled = [0]

    def get_state(self) -> int:
        return self.count

    def set_state(self, state: int) -> None:
        self.count, self.doubled = state, [2 * state]


class Everything(Sensor):
    """Uses every kind of attribute; its number depends on all of them."""

    add_data("number", 0.0, "float", "Follows from all attributes")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.queue: deque[float] = deque([0.0], maxlen=7)
        self.matrix = np.asfortranarray(np.arange(12.0).reshape(3, 4))
        self.state = np.zeros(6)
        self.position, self.velocity = self.state[:3], self.state[3:]
        self.structured = np.zeros(2, dtype=[("a", "f8"), ("b", "i4")])
        self.boxed = np.array([None, [1.0]], dtype=object)
        self.estimate = Estimate()
        self.same = self.estimate
        self.numpy_random = self.context.random(self.name())
        self.draw = self.numpy_random.normal
        self.legacy = np.random.RandomState(5)
        self.twister = np.random.Generator(np.random.MT19937(7))
        self.python_random = random.Random(3)
        self.reading = Reading(0, 1.0)
        self.mood = Mood.CALM
        self.mode = SLOW
        self.target = HOME
        self.slotted = Slotted()
        self.window = Window(4)
        self.own = Own()
        self.lists: defaultdict[int, list[float]] = defaultdict(list)
        self.counts: Counter[str] = Counter()
        self.ordered: OrderedDict[str, float] = OrderedDict()
        self.space = SimpleNamespace(a=1.0)
        self.ring: list[Any] = [1.0]
        self.ring.append(self.ring)
        self.seen = {1, 2, (3, "x")}
        self.large = 2**70
        self.number_of = complex(1, 2)
        self.raw = bytearray(b"ab")
        self.step = self._first
        self.friend: Any = None

    def _first(self) -> float:
        self.step = self._second
        return 1.0

    def _second(self) -> float:
        self.step = self._first
        return -0.5

    def default_action(self) -> None:
        tick = self.clock.tick
        self.friend = self.context.components.get("robot.pose") if tick % 2 else self.robot_parent
        noise = float(self.draw()) + float(self.twister.random()) + self.legacy.rand() + self.python_random.gauss(0, 1)
        self.queue.append(noise)
        self.matrix *= 1.0 + 0.01 * noise
        self.position += noise
        self.velocity[:] = self.state[:3] * 0.1
        self.structured["a"] += noise
        self.structured["b"] += tick
        self.boxed[1].append(noise)
        self.estimate.mean = 0.9 * self.estimate.mean + 0.1 * noise
        self.same.history.append(self.estimate.mean)
        self.reading = Reading(tick, noise)
        self.mood = Mood.WILD if noise > 0 else Mood.CALM
        self.mode = FAST if self.mode is SLOW else SLOW
        self.target = HOME if self.mode is FAST else self.target + noise
        self.window.push(noise)
        self.own.set_state(self.own.get_state() + 1)
        self.lists[tick % 3].append(noise)
        self.counts["x" * (tick % 4)] += 1
        self.ordered[str(tick % 5)] = noise
        self.ordered.move_to_end(str(tick % 5))
        self.space.a += noise
        self.ring[1][0] += noise
        self.seen.add(tick % 9)
        self.large += 1
        self.number_of *= 1j
        self.raw.append(tick % 256)
        gain = {SLOW: 1.0, FAST: 3.0}[self.mode] * (2.0 if self.mood is Mood.WILD else 1.0)
        parts = [
            sum(self.queue),
            float(self.matrix.sum()),
            float(self.state.sum()),
            float(self.structured["a"].sum() + self.structured["b"].sum()),
            sum(self.boxed[1]),
            self.estimate.mean * len(self.estimate.history),
            self.reading.value,
            float(self.target.sum()),
            self.slotted.work(),
            sum(self.window) + self.window.size,
            float(self.own.count + self.own.doubled[0]),
            sum(map(sum, self.lists.values())),
            float(sum(self.counts.values())),
            float(next(iter(self.ordered))),
            self.space.a + self.ring[0],
            float(sum(value for value in self.seen if isinstance(value, int))),
            float(self.large % 97) + self.number_of.real + sum(self.raw),
            self.step(),
            self.friend.position_3d.x,
        ]
        self.local_data["number"] = gain * sum(number * (place + 1) for place, number in enumerate(parts)) % 1e6


class Unsaveable(Sensor):
    """Has an attribute that cannot be saved."""

    add_data("count", 0, "int", "Ticks")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.thread = threading.Thread(target=print)
        self.lock = threading.Lock()
        self.file = open(__file__, encoding="utf-8")  # noqa: SIM115 (it is the point)

    def default_action(self) -> None:
        self.local_data["count"] += 1

    def finalize(self) -> None:
        self.file.close()
