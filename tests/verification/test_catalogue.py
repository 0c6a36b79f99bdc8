"""Every component of the catalogue, in every variant: whatever happens in a run, the run is the same again.

A run is recorded with commands, services, keys, a restart, a saved and restored state, robots that come and go. It is
repeated in another simulation, and goes on there past its end; a state of it goes on in another process. The variants
are read from the catalogue: a class that is added is tested without a line here.
"""

import contextlib
import inspect
import json
import logging
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import morse
import morse.builder
from morse.builder.names import catalog
from morse.core.actuator import Actuator
from morse.core.classes.classpath import load_class
from morse.core.declarations import levels
from morse.core.sensor import Sensor
from morse.recording.recording import Recording
from morse.simulation.loader import LoadError
from morse.simulation.simulation import Simulation
from morse.verification.contract.contract_world import CARRIERS, HOLDERS, example
from morse.verification.contract.subjects import library, subjects
from morse.verification.resimulation import repeat

pytestmark = pytest.mark.long
#: variants in one scene
_TOGETHER = 14
#: ticks after the end of a recording
_BEYOND = 6
_HEAD = """
from morse.builder import *
from morse.core.declarations import properties
from morse.core.exceptions import MorseBuilderError

def small(component):
    # images of a few pixels are sufficient
    names = [declared.name for declared in properties(component.component_class() or object).values()]
    if "cam_width" in names:
        component.properties(cam_width=16, cam_height=12)
    for inner in component.children:
        small(inner)

def realistic(part):
    part.delay(0.05)
    part.phase(0.02)
    try:
        part.noise(gaussian=0.01, bias_walk=0.02, quantization=0.001, dropout=0.1)
    except MorseBuilderError:
        pass  # it has no numbers

def carried(carrier, drive, holder, make):
    robot = carrier()
    if drive is not None:
        robot.append(drive("drive"))
    global _member
    _member = Pose("member")
    robot.append(_member)
    place = robot
    if holder is not None:
        place = holder("holder")
        robot.append(place)
    part = make()
    part.name = "part"
    place.append(part)
    small(part)
    return robot, part
"""
_TAIL = """
for number, make in enumerate([{makers}]):
    robot = make()
    robot.name = f"r{{number}}"
    robot.translate(5.0 * (number % 4), 5.0 * (number // 4), 0.2)
wall = Cube("Wall")
wall.location = (4.0, 0.0, 1.0)
wall.properties(Object=True, Fire=True, Robot_Tag=True, Injured=True, Catched_Object=True)
wall.static()
env = Environment("empty")
env.properties(longitude=1.43, latitude=43.6, altitude=135.0, UTMXOffset=0.0, UTMYOffset=0.0, UTMZOffset=0.0)
"""


class Variant(NamedTuple):
    """A component of the catalogue, and what a scene script says about it.

    Attributes:
        lines: lines of the script; the component is ``part``.
    """

    name: str
    call: str
    lines: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "-".join([self.name, *(line.removeprefix("part.") for line in self.lines)])

    def maker(self, number: int, carrier: str) -> str:
        """The function of the script that creates a robot with the component."""
        cls = getattr(morse.builder, self.name)
        lines = [f"def make{number}():"]
        if issubclass(cls, morse.builder.Robot):
            lines.append(f"    robot = part = {self.call}")
        else:
            holder, drive = HOLDERS.get(self.name), CARRIERS[carrier] or None
            lines.append(f"    robot, part = carried({carrier}, {drive}, {holder}, lambda: {self.call})")
        return "\n".join([*lines, *(f"    {line}" for line in self.lines), "    return robot", ""])


def component_class(name: str) -> type | None:
    """The class that runs for a class of scene scripts."""
    path = getattr(getattr(morse.builder, name), "_classpath", None)
    return load_class(path) if path else None


def variants() -> Iterator[Variant]:
    """Every component, with each of its levels and modifiers, and each sensor with noise and delay."""
    for name in library():
        call, cls = subjects(name)[0].call, component_class(name)
        yield Variant(name, call)
        if cls is None:
            continue
        for level in levels(cls):
            yield Variant(name, call, (f"part.level({level!r})",))
        if issubclass(cls, Sensor):
            yield Variant(name, call, ("realistic(part)",))
        bases = {base.__name__ for base in cls.__mro__}
        for entry in catalog.modifiers():
            if bases & set(entry.attributes.get("_components", ())):
                yield Variant(name, call, (f"part.alter({entry.attributes['_names'][0]!r})",))


VARIANTS = list(variants())
#: neighbours in the list are of one class, and groups of members (`morse.core.rows`): they belong to one scene
GROUPS = [VARIANTS[first : first + _TOGETHER] for first in range(0, len(VARIANTS), _TOGETHER)]


def test_the_catalogue_is_tried_as_a_whole() -> None:
    names = {variant.name for variant in VARIANTS}
    assert names == set(library())
    tried = {line for variant in VARIANTS for line in variant.lines}
    for entry in catalog.modifiers():
        assert f"part.alter({entry.attributes['_names'][0]!r})" in tried


# -- a run in which everything happens ---------------------------------------------------------


def loaded(group: list[Variant], path: Path) -> Simulation:
    """Write the script, with the first robots that can carry the components, and load it."""
    carriers = [iter(CARRIERS) for _ in group]
    present = [next(one) for one in carriers]
    while True:
        makers = [variant.maker(number, present[number]) for number, variant in enumerate(group)]
        tail = _TAIL.format(makers=", ".join(f"make{number}" for number in range(len(group))))
        path.write_text("\n".join([_HEAD, *makers, tail]))
        try:
            return morse.load(path, seed=3)
        except LoadError as error:
            number = int(str(error).partition(".")[0].rpartition("r")[2])
            present[number] = next(carriers[number])


def command(sim: Simulation) -> None:
    """Send a valid command to every actuator."""
    for name, component in sim.context.components.items():
        if isinstance(component, Actuator):
            handle: Any = sim
            for part in name.split("."):
                handle = getattr(handle, part)
            handle.publish(example(component))


def call(sim: Simulation) -> None:
    """Call every service of every robot and component that may change something; some refuse the arguments."""
    values: dict[str, object] = {"str": "x", "bool": True, "int": 1, "float": 0.3}
    for name, component in {**sim.context.robots, **sim.context.components}.items():
        for service in component.services():
            if not service.changes or service.name in ("set_property",):
                continue
            parameters = list(inspect.signature(getattr(component, service.attribute)).parameters.values())
            needed = [one for one in parameters[service.asynchronous :] if one.default is one.empty]
            arguments = [values.get(str(one.annotation), 0.3) for one in needed]
            with contextlib.suppress(Exception):
                sim.call(name, service.name, *arguments)


def live(sim: Simulation, state: Path, spawned: Callable[[], object]) -> dict[str, str]:
    """A run with everything; return the fingerprints some ticks after the state was saved."""
    command(sim)
    sim.step(5)
    call(sim)
    sim.step(4)
    sim.set_controls(frozenset(["ArrowUp", "ArrowLeft"]), (0.4, -0.6))
    sim.spawn("guest", spawned, (-6.0, 0.0, 0.2))
    sim.step(3)
    sim.restart(5)
    sim.step(2)
    command(sim)
    sim.step(5)
    before = sim.save(state)
    sim.step(_BEYOND)
    went_on = sim.save().fingerprints()
    call(sim)
    sim.step(3)
    for _ in range(3):
        sim.restore(before)
        sim.step()
    sim.spawn("guest", spawned, (-6.0, 3.0, 0.2))
    command(sim)
    sim.step(2)
    sim.rpc("simulation", "restart_robot", "r0")
    sim.delete("guest")
    sim.delete(f"r{len(sim.robots) // 2}")
    sim.set_controls(frozenset())
    call(sim)
    sim.step(3)
    return went_on


# -- the other process -------------------------------------------------------------------------


class Elsewhere:
    """Another process, which restores states."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, script: Path, state: Path) -> None:
        """Let it restore a state, and go on."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps([str(script), str(state)]) + "\n")
        self._process.stdin.flush()

    def answer(self) -> dict[str, str]:
        """The fingerprints of all parts afterwards."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line, "the other process has ended"
        return dict(json.loads(line))

    def close(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(60)


def serve() -> None:
    """The work of the other process."""
    own = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    logging.disable(logging.CRITICAL)
    for line in sys.stdin:
        script, state = json.loads(line)
        with morse.load(script) as sim:
            sim.restore(state)
            sim.step(_BEYOND)
            own.write(json.dumps(sim.save().fingerprints()) + "\n")
        own.flush()


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[Elsewhere]:
    process = Elsewhere()
    yield process
    process.close()


def tried(group: list[Variant], folder: Path, elsewhere: Elsewhere) -> None:
    """Assert that a run of a scene is the same in each way."""
    script, state = folder / "scene.py", folder / "middle.state"
    namespace: dict[str, Any] = {}
    with loaded(group, script) as sim:
        text = script.read_text()
        exec(compile(text[: text.index("\nfor number, make")], str(script), "exec"), namespace)
        with sim.record(folder / "run.mcap"):
            went_on = live(sim, state, namespace["make0"])
        end = sim.save().fingerprints()
        elsewhere.ask(script, state)
        sim.step(_BEYOND)
        beyond = sim.save().fingerprints()
        failed = sorted(sim.context.failed)
        sim.restore(state)
        sim.step(_BEYOND)
        restored = sim.save().fingerprints()
    restored_elsewhere = elsewhere.answer()
    assert failed == []
    assert differing(restored, went_on, group) == {}
    assert differing(restored_elsewhere, went_on, group) == {}
    with morse.load(script, seed=8) as again, Recording(folder / "run.mcap") as recording:
        outcome = repeat(recording, again)
        assert outcome.departure is None
        assert outcome.complete
        assert differing(again.save().fingerprints(), end, group) == {}
        again.step(_BEYOND)
        assert differing(again.save().fingerprints(), beyond, group) == {}


def differing(one: dict[str, str], other: dict[str, str], group: list[Variant]) -> dict[str, str]:
    """The parts that differ, each with its variant."""
    robots = {f"r{number}": str(variant) for number, variant in enumerate(group)}
    return {
        part: robots.get(part.partition(".")[0].partition(",")[0], "")
        for part in {**one, **other}
        if one.get(part) != other.get(part)
    }


@pytest.mark.parametrize("group", GROUPS, ids=lambda group: f"{group[0].name}-{group[-1].name}")
def test_together(group: list[Variant], tmp_path: Path, elsewhere: Elsewhere) -> None:
    tried(group, tmp_path, elsewhere)


@pytest.mark.slow
@pytest.mark.parametrize("variant", VARIANTS, ids=str)
def test_alone(variant: Variant, tmp_path: Path, elsewhere: Elsewhere) -> None:
    tried([variant], tmp_path, elsewhere)


if __name__ == "__main__":
    serve()
