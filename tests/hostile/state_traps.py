"""A scene for hostile states: its project contains a function and a class that do harm when anything calls them."""

import logging
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

import morse
from morse.core.actuator import Actuator
from morse.core.declarations import add_data
from morse.core.modifier import AbstractModifier
from morse.core.sensor import Sensor
from morse.core.state import StateError
from morse.simulation.states.state import State

PARTS = str(Path(__file__).parent)
#: what no state may cause
_EVENTS = (
    "compile", "ctypes.dlopen", "exec", "import", "os.chmod", "os.exec", "os.fork", "os.mkdir", "os.posix_spawn",
    "os.remove", "os.rename", "os.rmdir", "os.system", "os.truncate", "shutil.rmtree", "socket.bind", "socket.connect",
    "socket.sendto", "subprocess.Popen",
)  # fmt: skip


def wipe(*_: Any, **__: Any) -> None:
    """Do harm."""
    Path("precious").unlink()


class Wiper:
    """Does harm when any usual method is called."""

    def __init__(self) -> None:
        self.path = Path("precious")

    update = append = action = act = measure = default_action = close = get = next = tolist = __call__ = wipe


class Estimate:
    """An object of the user, with a method."""

    def __init__(self) -> None:
        self.mean = 0.0

    def update(self, value: float) -> None:
        """Follow a value."""
        self.mean += 0.1 * (value - self.mean)


WIPER = Wiper()


class Trap(Sensor):
    """Calls what its attributes hold, as components do."""

    add_data("number", 0.0, "float", "Follows from the attributes")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.estimate = Estimate()
        self.history = [0.0]
        self.table: dict[str, Any] = {"a": 1.0}
        self.space = SimpleNamespace(offset=1.0, estimate=Estimate())
        self.step: Callable[[], float] = self.first
        self.hook: Any = None
        self.random = self.context.random(self.name())
        self.draw = self.random.normal
        self.array = np.zeros(3)
        self.path = Path("log")

    def first(self) -> float:
        """One of two steps."""
        self.step = self.second
        return 1.0

    def second(self) -> float:
        """The other step."""
        self.step = self.first
        return 2.0

    def default_action(self) -> None:
        """Use all attributes."""
        if self.hook:
            self.hook()
        self.estimate.update(self.step() + float(self.draw()))
        self.space.estimate.update(self.space.offset)
        self.history.append(self.estimate.mean)
        del self.history[:-5]
        self.array += self.table.get("a", 0.0)
        self.local_data["number"] = sum(self.history) + float(self.array.sum()) + len(self.path.name)


class Press(Actuator):
    """An actuator of the user."""

    add_data("force", 0.0, "float", "Force")

    def default_action(self) -> None:
        """Do nothing with the force."""
        self.local_data["force"] += 0.0


class Mean(AbstractModifier):
    """A modifier of the user."""

    def __init__(self, component_instance: Any, kwargs: dict[str, Any]) -> None:
        super().__init__(component_instance, kwargs)
        self.estimate = Estimate()

    def modify(self) -> None:
        """Smooth the number."""
        self.estimate.update(self.data["number"])


def _build() -> None:
    from morse.builder import (
        ATRV,
        IMU,
        Environment,
        FakeRobot,
        KukaLWR,
        MotionVW,
        Odometry,
        PassiveObject,
        Pose,
        Waypoint,
    )
    from morse.builder.creator import ActuatorCreator, SensorCreator

    class TrapCreator(SensorCreator):  # type: ignore[misc]
        _classpath = "state_traps.Trap"

    class PressCreator(ActuatorCreator):  # type: ignore[misc]
        _classpath = "state_traps.Press"

    for number in range(4):
        robot = ATRV(f"r{number}")
        robot.translate(x=3.0 * number, z=0.2)
        for part in (MotionVW("motion"), Pose("pose"), Odometry("odometry"), IMU("imu")):
            robot.append(part)
        if number == 0:
            trap, noisy = TrapCreator("trap"), Pose("noisy")
            trap.alter("", classpath="state_traps.Mean")
            noisy.noise(gaussian=0.01)
            noisy.delay(0.05)
            for part in (trap, noisy, PressCreator("press"), Waypoint("waypoint"), KukaLWR("arm")):
                robot.append(part)
    FakeRobot("ghost").translate(y=5.0)
    crate = PassiveObject("props/crates", "small_crate")
    crate.name = "crate"
    crate.translate(1.0, 2.0, 1.0)
    Environment("empty", fastmode=True)


def _object(path: str, *attributes: Any) -> list[Any]:
    return ["object", path, list(attributes)]


def _values() -> dict[str, Any]:
    """Values of every type of the format, most of them made to do harm."""
    owners = {
        "a path": ["simple", "path", "precious"],
        "an own component": ["part", "component r0.trap"],
        "another component": ["part", "component r1.pose"],
        "an array": ["array", "<f8", [1], b"\\0" * 8],
        "a wiper": _object("state_traps:Wiper"),
        "the wiper": ["global", "state_traps:WIPER", ["as is"]],
        "the simulation": ["part", "services"],
    }
    methods = {
        "a path": "unlink", "an own component": "finalize", "another component": "toggle_active", "an array": "tofile",
        "a wiper": "update", "the wiper": "update", "the simulation": "finalize",
    }  # fmt: skip
    calls = {f"a method of {name}": ["method", owner, methods[name]] for name, owner in owners.items()}
    calls["a function"] = ["global", "state_traps:wipe", ["as is"]]
    names = ("update", "append", "action", "act", "measure", "get_pose", "follow", "stay", "tolist", "make", "get")
    spaces = {
        f"a namespace with {name}": ["namespace", [[method, call] for method in names]] for name, call in calls.items()
    }
    data = {
        "nothing": None, "a truth": True, "an integer": 7, "a number": 1.5, "no number": float("nan"), "a text": "x",
        "bytes": b"x", "a long integer": ["integer", hex(2**80)], "half a character": ["text", b"\\xed\\xa0\\x80"],
        "a list": ["list", [1.0]], "a tuple": ["tuple", [1.0]], "a set": ["set", [1.0]],
        "a frozen set": ["frozenset", [1.0]], "a queue": ["deque", 3, [1.0]], "a byte array": ["bytearray", b"x"],
        "a dictionary": ["dict", [["a", 1.0]]], "ordered": ["ordered dict", []], "local data": ["local data", []],
        "a counter": ["counter", [["a", 1]]], "with a default": ["default dict", [], "list"],
        "objects": ["objects", [1], [None]], "a scalar": ["scalar", "<f8", b"\\0" * 8],
        "a view": ["view", ["array", "<f8", [2], b"\\0" * 16], "<f8", [1], 8, [8]],
        "a vector": ["values", "Vector", [1.0, 2.0, 3.0]], "a matrix": ["values", "Matrix", [[1.0, 0.0], [0.0, 1.0]]],
        "a complex number": ["simple", "complex", 1.0, 2.0], "a range": ["simple", "range", 0, 2**62, 1],
        "a slice": ["simple", "slice", 0, 1, 1], "a time": ["simple", "time", "2020-01-01T00:00:00"],
        "a day": ["simple", "day", "2020-01-01"], "a duration": ["simple", "duration", 1, 2, 3],
        "a pose": ["pose", [0.0] * 3, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]],
        "what was read": ["again", 0], "as it is": ["as is"], "nothing at all": [], "no word": ["no word", 1],
    }  # fmt: skip
    generators = {
        "a generator": ["random", "PCG64", ["dict", []]],
        "an old generator": ["legacy random", ["tuple", []]],
        "a generator of Python": ["python random", ["tuple", []]],
    }
    classes = {
        "of the user": _object("state_traps:Estimate", ["mean", 0.0]),
        "of a component": _object("state_traps:Trap"),
        "with its own state": ["own", "state_traps:Mean", ["dict", []]],
        "of MORSE": _object("morse.actuators.limited_motion:Ramp"),
        "of the network": _object("morse.core.clients.network:Network"),
        "of a process": _object("subprocess:Popen"),
        "an enumeration": ["enum", "morse.scene:NodeKind", "MESH", None],
        "a named tuple": ["named tuple", "morse.core.context:Controls", [["frozenset", []], ["tuple", []], None]],
    }
    huge = {
        "of huge size": ["array", "<f8", [2**40], b""],
        "a view of huge size": ["view", ["array", "|u1", [1], b"x"], "|u1", [2**40], 0, [0]],
        "objects of huge size": ["objects", [2**40], []],
        "items of huge size": ["scalar", f"|V{2**31 - 1}", b""],
        "nested deeply": _nested(400),
    }
    parts = {f"the part {name}": ["part", name] for name in ("world", "context", "component r0", "object crate")}
    return {**data, **generators, **classes, **huge, **parts, **owners, **calls, **spaces}


def _nested(depth: int) -> Any:
    value: Any = 1.0
    for _ in range(depth):
        value = ["list", [value]]
    return value


VALUES = _values()


def places(parts: dict[str, Any]) -> Iterator[tuple[str, tuple[int, ...]]]:
    """The places of a state at which there are values: attributes, items and whole parts."""

    def within(data: Any, path: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        yield path
        if not isinstance(data, list) or not data:
            return
        word = data[0]
        if word in ("dict", "local data", "namespace", "ordered dict"):
            for number, (_, item) in enumerate(data[1]):
                yield from within(item, (*path, 1, number, 1))
        elif word in ("list", "tuple", "set"):
            for number, item in enumerate(data[1][:3]):
                yield from within(item, (*path, 1, number))
        elif word == "object":
            for number, (_, item) in enumerate(data[2]):
                yield from within(item, (*path, 2, number, 1))
        elif word == "own":
            yield from within(data[2], (*path, 2))
        elif word == "method":
            yield from within(data[1], (*path, 1))

    for name, saved in parts.items():
        for path in within(saved, ()):
            yield name, path


def placed(saved: Any, path: tuple[int, ...], value: Any) -> Any:
    """A copy of the state of a part with another value at a place."""
    if not path:
        return value
    copy = list(saved)
    copy[path[0]] = placed(saved[path[0]], path[1:], value)
    return copy


class Victim:
    """A simulation under attack, in a process of its own."""

    def __init__(self, folder: str) -> None:
        if PARTS not in sys.path:
            sys.path.insert(0, PARTS)
        os.chdir(folder)
        Path("precious").write_text("x")
        logging.disable(logging.CRITICAL)
        self.events: list[str] = []
        self.is_watched = False
        self.simulation = morse.load(_build, seed=1)
        self.simulation.step(7)
        self.kept = self.simulation.save()
        self.places = list(places(self.kept.parts))
        sys.addaudithook(self._hear)
        # what is loaded at the first fault and the first restored state is not caused by an attack
        for name in ("number", "local_data", "position_3d"):
            self.try_value("r0.trap", (), ["dict", [[name, 1]]])
        self.simulation.context.components["r0.press"].local_data = None
        self.simulation.step(2)
        self.simulation.restore(self.kept)
        self.events.clear()

    def _hear(self, event: str, arguments: Any) -> None:
        if "/morse/kernel/lib/" in f"{arguments!r:.200}":
            return  # MORSE loads its own native code when it needs it
        if self.is_watched and (event in _EVENTS or (event == "open" and _writes(arguments))):
            self.events.append(f"{event} {arguments!r:.200}")

    def try_value(self, part: str, path: tuple[int, ...], value: Any) -> bool:
        """Restore a state with a value at a place, and go on if it is accepted; return whether it was refused."""
        parts = {**self.kept.parts, part: placed(self.kept.parts[part], path, value)}
        self.is_watched = True
        try:
            self.simulation.restore(State(parts))
            self.simulation.step(10)
        except StateError:
            return True
        finally:
            self.is_watched = False
            self.simulation.restore(self.kept)
        return False

    def attack(self, choices: Iterable[tuple[int, str]]) -> tuple[list[str], int]:
        """Try values at places; return what went wrong, and the number of refusals."""
        wrong, refusals = [], 0
        for number, name in choices:
            part, path = self.places[number % len(self.places)]
            try:
                refusals += self.try_value(part, path, VALUES[name])
            except Exception as error:
                wrong.append(f"{name} at {part} {path}: {type(error).__name__}: {error}")
            wrong += [f"{name} at {part} {path}: {event}" for event in self.events]
            self.events.clear()
            if not Path("precious").exists():
                Path("precious").write_text("x")
                wrong.append(f"{name} at {part} {path}: the file is gone")
            if self.simulation.state_hash() != self.kept.hash():
                wrong.append(f"{name} at {part} {path}: the state that was kept is not restored")
        return wrong, refusals


def _writes(arguments: Any) -> bool:
    _, mode, flags = arguments
    return bool(set(mode or "") & set("wax+")) or bool((flags or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))


_victims: list[Victim] = []


def begin(folder: str) -> int:
    """Prepare the process; return the number of places."""
    _victims.append(Victim(folder))
    return len(_victims[0].places)


def attack(choices: list[tuple[int, str]]) -> tuple[list[str], int]:
    """See `Victim.attack`."""
    return _victims[0].attack(choices)


def message(component: str, attribute: str, value: Any) -> str:
    """Why a state with a value of an attribute is refused; the text is empty if it is accepted."""
    victim = _victims[0]
    saved = victim.kept.parts[component]
    names = [name for name, _ in saved[1]]
    pairs = list(saved[1])
    if attribute in names:
        pairs[names.index(attribute)] = [attribute, value]
    else:
        pairs.append([attribute, value])
    try:
        victim.simulation.restore(State({**victim.kept.parts, component: ["dict", pairs]}))
    except StateError as error:
        return str(error)
    return ""


def exchange(names: Iterable[str], values: Iterable[str]) -> list[str]:
    """Let attributes of the user's sensor hold other values; return those with which its own state is refused."""
    simulation, kept, wrong = _victims[0].simulation, _victims[0].kept, []
    trap = simulation.context.components["r0.trap"]
    for name in names:
        for value in values:
            setattr(trap, name, {"nothing": None, "a list": [1.0], "a text": "x", "a number": 1.5}.get(value, {}))
            try:
                simulation.restore(kept)
            except StateError as error:
                wrong.append(f"{name} = {value}: {error}")
            if simulation.state_hash() != kept.hash():
                wrong.append(f"{name} = {value}: the state is not restored")
    return wrong
