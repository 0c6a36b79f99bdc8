"""What actors do, in a subset of OpenSCENARIO DSL 2.1: the function of a scenario, read from a file.

Source: ASAM OpenSCENARIO DSL 2.1.0. The subset: one scenario; its actors, which are robots of the scene, and parameters
with a value; events; ``do`` with ``serial``, ``parallel``, ``one_of``, ``wait``, ``emit``; actions ``drive``,
``walk``, ``move`` with the modifiers ``speed`` and ``position``, and ``until``. Conditions are those of requirements,
with units. Everything else is refused, with its line.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Generator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from morse.core.reports.quoting import nearest, quoted
from morse.plugins.falsify.expressions import Expression, NotYetError, RequirementError
from morse.plugins.falsify.requirements import Names
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    import os

    from morse import Simulation

#: largest file, bytes; deepest indentation
_LARGEST, _DEEPEST = 1 << 20, 40
#: simulated time after which a scenario ends that has no end of its own, s
_LONGEST = 3600.0
#: the physical types of parameters, and their units in those of the SI
_UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "speed": {"mps": 1.0, "kph": 1.0 / 3.6, "mph": 0.44704},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0},
}
_ACTORS = ("vehicle", "person", "animal", "stationary_object", "physical_object")
_ACTIONS = ("drive", "walk", "move")
_COMPOSITIONS = ("serial", "parallel", "one_of")
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)([a-z]*)")
_NAME = re.compile(r"[A-Za-z_]\w*")
#: a number with a unit within an expression
_QUANTITY = re.compile(r"(?<![\w.])((?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)([A-Za-z_]\w*)")

#: a value in a run, given the parameters
_Value: TypeAlias = Callable[[Mapping[str, float]], float]
#: something that goes on from tick to tick, until it is done
_Course: TypeAlias = Generator[None, None, None]


class _Line(NamedTuple):
    number: int
    depth: int
    text: str
    below: list[Any]


class _Play(NamedTuple):
    """What a behaviour needs in a run."""

    simulation: Simulation
    parameters: Mapping[str, float]
    rng: np.random.Generator
    #: how often each event was emitted
    emitted: dict[str, int]
    names: Names


_Behaviour: TypeAlias = Callable[[_Play], _Course]
#: returns, when a behaviour begins, what tells in each tick whether an event has taken place since then
_Event: TypeAlias = Callable[[_Play], Callable[[], bool]]


def read_openscenario(file: str | os.PathLike[str]) -> Callable[..., None]:
    """Return the function of a scenario in OpenSCENARIO DSL, for `Scenario`; its parameters have defaults.

    Raises:
        RequirementError: the file is none of the subset; the message contains the line.
        OSError: it cannot be read.
    """
    path = Path(file)
    text = read_regular(path, _LARGEST).decode("utf-8", "replace")
    return _Reader(path.name, text).function()


class _Reader:
    def __init__(self, name: str, text: str) -> None:
        self._name = name
        self._actors: set[str] = set()
        self._parameters: dict[str, tuple[str, float]] = {}
        #: None for an event that only ``emit`` brings about
        self._events: dict[str, _Event | None] = {}
        self._lines = self._tree(text)

    def _refused(self, number: int, reason: str) -> RequirementError:
        return RequirementError(f"{self._name}:{number}: {reason}")

    def _tree(self, text: str) -> list[_Line]:
        """Lines with what is indented below them."""
        roots: list[_Line] = []
        open_lines: list[_Line] = []
        for number, raw in enumerate(text.split("\n"), 1):
            content = raw.partition("#")[0].rstrip()
            if not content.strip():
                continue
            depth = len(content) - len(content.lstrip(" "))
            if content.lstrip(" ").startswith("\t"):
                raise self._refused(number, "a tab; lines are indented by spaces")
            while open_lines and open_lines[-1].depth >= depth:
                open_lines.pop()
            line = _Line(number, depth, content.strip(), [])
            siblings = open_lines[-1].below if open_lines else roots
            if siblings and siblings[0].depth != depth:
                raise self._refused(number, "it is indented otherwise than the lines before it")
            siblings.append(line)
            open_lines.append(line)
            if len(open_lines) > _DEEPEST:
                raise self._refused(number, f"more than {_DEEPEST} levels")
        return roots

    # -- the scenario ----------------------------------------------------------------------

    def function(self) -> Callable[..., None]:
        scenarios = []
        for line in self._lines:
            if re.fullmatch(r"import osc\.standard(\.all)?", line.text):
                continue
            if not re.fullmatch(r"scenario [A-Za-z_][\w.]*:", line.text):
                raise self._refused(line.number, f"{quoted(line.text)} is not supported: expected 'scenario NAME:'")
            scenarios.append(line)
        if len(scenarios) != 1:
            number = scenarios[1].number if scenarios else 1
            raise self._refused(number, f"there are {len(scenarios)} scenarios, expected one")
        behaviour: _Behaviour | None = None
        for line in scenarios[0].below:
            if behaviour is not None:
                raise self._refused(line.number, f"{quoted(line.text)} after 'do': expected the end")
            if line.text.startswith("do "):
                behaviour = self._behaviour(line._replace(text=line.text[3:].strip()))
            else:
                self._declaration(line)
        if behaviour is None:
            raise self._refused(scenarios[0].number, "the scenario does nothing: 'do' is missing")
        return self._made(behaviour)

    def _declaration(self, line: _Line) -> None:
        if event := re.fullmatch(r"event ([A-Za-z_]\w*)(?:\s+is\s+(.+))?", line.text):
            name, specification = event.groups()
            if line.below or name in self._actors or name in self._parameters or name in self._events:
                raise self._refused(line.number, f"there is a '{name}' already")
            self._events[name] = None if specification is None else self._event(specification, line.number)
            return
        match = re.fullmatch(r"([A-Za-z_]\w*)\s*:\s*([A-Za-z_]\w*)(?:\s*=\s*(\S+))?", line.text)
        if match is None or line.below:
            raise self._refused(line.number, f"{quoted(line.text)} is not supported: expected 'NAME: TYPE', or 'do'")
        name, kind, value = match.groups()
        if name in self._actors or name in self._parameters or name in self._events:
            raise self._refused(line.number, f"there is a '{name}' already")
        if kind in _ACTORS and value is None:
            self._actors.add(name)
        elif kind in _UNITS and value is not None:
            self._parameters[name] = kind, self._literal(value, kind, line.number)
        else:
            what = "needs a value: " if kind in _UNITS else f"is of the type {quoted(kind)}, which is not supported"
            raise self._refused(line.number, f"'{name}' {what}{nearest(kind, [*_ACTORS, *_UNITS])}")

    def _made(self, behaviour: _Behaviour) -> Callable[..., None]:
        actors = sorted(self._actors)
        defaults = {name: value for name, (_, value) in self._parameters.items()}

        def run(simulation: Simulation, **parameters: float) -> None:
            for actor in actors:
                if actor not in simulation.robots:
                    hint = nearest(actor, simulation.robots)
                    raise RequirementError(f"{self._name}: the scene has no robot '{actor}'{hint}")
            values = {**defaults, **parameters}
            rng, names = np.random.default_rng(simulation.seed()), Names(simulation, {}, values)
            course = behaviour(_Play(simulation, values, rng, dict.fromkeys(self._events, 0), names))
            while next(course, course) is not course and simulation.time() < _LONGEST:
                simulation.step()
                names.forget()

        kinds = inspect.Parameter
        arguments = [kinds("simulation", kinds.POSITIONAL_OR_KEYWORD)]
        arguments += [kinds(name, kinds.KEYWORD_ONLY, default=value) for name, value in defaults.items()]
        vars(run).update(__signature__=inspect.Signature(arguments))
        return run

    # -- behaviours ------------------------------------------------------------------------

    def _behaviour(self, line: _Line) -> _Behaviour:
        word = line.text.removesuffix(":")
        if word in _COMPOSITIONS and line.text.endswith(":"):
            if not line.below:
                raise self._refused(line.number, f"'{word}' contains nothing")
            return _COMPOSED[word]([self._behaviour(one) for one in line.below])
        if line.text.startswith("wait "):
            return self._wait(line)
        if line.text.startswith("emit "):
            return self._emit(line)
        match = re.fullmatch(r"([A-Za-z_]\w*)\.([A-Za-z_]\w*)\((.*)\)(\s*with:)?", line.text)
        if match is None:
            known = [*_COMPOSITIONS, "wait", "emit"]
            hint = nearest(word.split("(")[0].split(" ")[0], known)
            raise self._refused(line.number, f"{quoted(line.text)} is not supported{hint}")
        actor, action, arguments, has_modifiers = match.groups()
        if actor not in self._actors:
            raise self._refused(line.number, f"there is no actor '{actor}'{nearest(actor, self._actors)}")
        if action not in _ACTIONS:
            raise self._refused(line.number, f"the action '{action}' is not supported{nearest(action, _ACTIONS)}")
        if bool(has_modifiers) != bool(line.below):
            raise self._refused(line.number, "modifiers are lines below 'with:'")
        return self._action(line, actor, arguments)

    def _wait(self, line: _Line) -> _Behaviour:
        if line.below:
            raise self._refused(line.below[0].number, f"{quoted(line.below[0].text)} below 'wait'")
        event = self._event(line.text.removeprefix("wait ").strip(), line.number)

        def course(play: _Play) -> _Course:
            is_there = event(play)
            while not is_there():
                yield

        return course

    def _emit(self, line: _Line) -> _Behaviour:
        name = line.text.removeprefix("emit ").strip()
        if line.below or self._events.get(name, self) is not None:
            known = nearest(name, [one for one, condition in self._events.items() if condition is None])
            raise self._refused(line.number, f"there is no event '{name}' without a condition{known}")

        def course(play: _Play) -> _Course:
            play.emitted[name] += 1
            yield from ()

        return course

    # -- events ----------------------------------------------------------------------------

    def _event(self, text: str, number: int) -> _Event:
        """Read what may follow ``wait``, ``until`` and ``event NAME is``."""
        if text.startswith("@"):
            return self._named(text[1:].strip(), number)
        if match := re.fullmatch(r"elapsed\((.+)\)", text):
            time = self._value(match[1].strip(), "time", number)

            def elapsed(play: _Play) -> Callable[[], bool]:
                end = play.simulation.time() + time(play.parameters) - 1e-9
                return lambda: play.simulation.time() >= end

            return elapsed
        edge, condition = "", text
        if match := re.fullmatch(r"(rise|fall)\s*\((.+)\)", text):
            edge, condition = match.groups()
        expression = self._expression(condition, number)

        def holds(play: _Play) -> bool:
            try:
                return expression.judge(play.names.look).holds
            except NotYetError:
                return False
            except RequirementError as error:
                raise RequirementError(f"{self._name}:{number}: {error}") from None

        def begun(play: _Play) -> Callable[[], bool]:
            wanted = edge != "fall"
            # an edge needs the opposite before
            seen = [not edge]

            def is_there() -> bool:
                if holds(play) != wanted:
                    seen[0] = True
                    return False
                return seen[0]

            return is_there

        return begun

    def _named(self, name: str, number: int) -> _Event:
        if name not in self._events:
            raise self._refused(number, f"there is no event '{name}'{nearest(name, self._events)}")
        condition = self._events[name]
        if condition is not None:
            return condition

        def begun(play: _Play) -> Callable[[], bool]:
            before = play.emitted[name]
            return lambda: play.emitted[name] > before

        return begun

    def _expression(self, text: str, number: int) -> Expression:
        def in_si(match: re.Match[str]) -> str:
            value, unit = match.groups()
            factor = next((units[unit] for units in _UNITS.values() if unit in units), None)
            if factor is None:
                raise self._refused(number, f"{quoted(match[0])}: there is no unit '{unit}'")
            return repr(float(value) * factor)

        try:
            expression = Expression(_QUANTITY.sub(in_si, text))
        except RequirementError as error:
            raise self._refused(number, f"{quoted(text)} is no event that is supported: {error}") from None
        for parts in expression.names:
            known = [*self._actors, *self._parameters, "time"]
            if (parts[0] not in self._actors) if len(parts) > 1 else (parts[0] not in (*self._parameters, "time")):
                raise self._refused(number, f"there is no '{'.'.join(parts)}'{nearest(parts[0], known)}")
        return expression

    def _action(self, line: _Line, actor: str, arguments: str) -> _Behaviour:
        given = self._arguments(arguments, ("duration",), line.number)
        duration = self._value(given["duration"], "time", line.number) if given else None
        ends: list[_Event] = []
        speed: _Value | None = None
        place: list[_Value] = []
        for one in line.below:
            if one.text.startswith("until ") and not one.below:
                ends.append(self._event(one.text.removeprefix("until ").strip(), one.number))
                continue
            match = re.fullmatch(r"([A-Za-z_]\w*)\((.*)\)", one.text)
            name = match[1] if match else ""
            if match is None or name not in ("speed", "position") or one.below:
                hint = nearest(name, ["speed", "position", "until"])
                raise self._refused(one.number, f"the modifier {quoted(one.text)} is not supported{hint}")
            if name == "speed":
                given = self._arguments(match[2], ("speed",), one.number)
                speed = self._value(given.get("speed", ""), "speed", one.number)
                continue
            given = self._arguments(match[2], ("x", "y", "yaw"), one.number)
            units = {"x": "length", "y": "length", "yaw": "angle"}
            place = [self._value(given.get(axis, "0rad" if axis == "yaw" else ""), units[axis], one.number)
                     for axis in units]  # fmt: skip

        if duration is None and not ends:
            raise self._refused(line.number, f"how long? {actor}.…(duration: 5s), or 'until' below 'with:'")

        def course(play: _Play) -> _Course:
            motion: Any = getattr(play.simulation[actor], "motion", None)
            if motion is None and speed is not None:
                raise RequirementError(f"{self._name}:{line.number}: the robot '{actor}' has no actuator 'motion'")
            if place:
                play.simulation.place(actor, [value(play.parameters) for value in place])
            if speed is not None:
                motion.publish({"v": speed(play.parameters)})
            has_ended = [event(play) for event in ends]
            end = math.inf if duration is None else play.simulation.time() + duration(play.parameters) - 1e-9
            # each of them is asked in each tick, because edges need what was before
            while not max([is_there() for is_there in has_ended], default=False) and play.simulation.time() < end:
                yield
            if speed is not None:
                motion.publish({"v": 0.0})

        return course

    def _arguments(self, text: str, names: tuple[str, ...], number: int) -> dict[str, str]:
        """Arguments by name; the first ones may be given without."""
        given: dict[str, str] = {}
        for index, part in enumerate(text.split(",") if text.strip() else []):
            name, colon, value = (word.strip() for word in part.rpartition(":"))
            if not colon:
                name = names[index] if index < len(names) else ""
            if name not in names or name in given or not value:
                raise self._refused(
                    number, f"the argument {quoted(part.strip())} is not supported{nearest(name, names)}"
                )
            given[name] = value
        return given

    def _value(self, text: str, kind: str, number: int) -> _Value:
        if _NAME.fullmatch(text):
            if text not in self._parameters:
                known = nearest(text, [name for name, (own, _) in self._parameters.items() if own == kind])
                raise self._refused(number, f"there is no parameter '{text}'{known}")
            if self._parameters[text][0] != kind:
                raise self._refused(number, f"'{text}' is a {self._parameters[text][0]}, expected a {kind}")
            return lambda parameters: float(parameters[text])
        value = self._literal(text, kind, number)
        return lambda _parameters: value

    def _literal(self, text: str, kind: str, number: int) -> float:
        match = _NUMBER.fullmatch(text)
        if match is None or match[2] not in _UNITS[kind]:
            units = ", ".join(_UNITS[kind])
            raise self._refused(number, f"{quoted(text)} is not a {kind}: expected a number with a unit: {units}")
        value = float(match[1]) * _UNITS[kind][match[2]]
        if not math.isfinite(value):
            raise self._refused(number, f"{quoted(text)} is not a finite {kind}")
        return value


def _serial(parts: list[_Behaviour]) -> _Behaviour:
    def course(play: _Play) -> _Course:
        for part in parts:
            yield from part(play)

    return course


def _parallel(parts: list[_Behaviour]) -> _Behaviour:
    def course(play: _Play) -> _Course:
        courses = [part(play) for part in parts]
        while courses := [one for one in courses if next(one, one) is not one]:
            yield

    return course


def _one_of(parts: list[_Behaviour]) -> _Behaviour:
    def course(play: _Play) -> _Course:
        # by the seed of the simulation
        yield from parts[int(play.rng.integers(len(parts)))](play)

    return course


_COMPOSED = {"serial": _serial, "parallel": _parallel, "one_of": _one_of}
