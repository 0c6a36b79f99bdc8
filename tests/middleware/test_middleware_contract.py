"""The services of the base classes for authors of middlewares."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any, ClassVar

import pytest
from socket_bench import Bench, Body

from morse.core.actuator import Actuator
from morse.core.datastream import AbstractDatastream, DatastreamManager
from morse.core.declarations import Option, add_data, add_kind, euler
from morse.core.exceptions import MorseDeclarationError, MorseMiddlewareError
from morse.core.mapping import maps
from morse.core.sensor import Sensor
from morse.core.streams.kind_stream import KindStream
from morse.core.validation import OptionError
from morse.scene import StreamDeclaration
from tests.kit.programs import python
from tests.kit.waiting import wait_until

KIND_STREAM = "morse.core.streams.kind_stream.KindStream"


class Place(Sensor):
    add_data("x", 1.0, "float", "X", unit="m", frame="world")
    add_data("y", 2.0, "float", "Y", unit="m", frame="world")
    add_data("z", 3.0, "float", "Z", unit="m", frame="world")
    add_data("yaw", 0.0, "float", "yaw", unit="rad", frame="world")
    add_data("pitch", 0.0, "float", "pitch", unit="rad", frame="world")
    add_data("roll", 0.0, "float", "roll", unit="rad", frame="world")
    add_kind("pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))


class Smell(Sensor):
    add_data("intensity", 0.5, "float", "of something")


class Wheels(Actuator):
    add_data("v", 0.0, "float", "speed", unit="m/s", frame="own")
    add_data("w", 0.0, "float", "turn rate", unit="rad/s", frame="own")
    add_kind("twist", linear=("v", None, None), angular=(None, None, "w"))


class Pigeons(DatastreamManager):
    """A middleware that appends every message to a list."""

    manager_options: ClassVar = {"loft": Option(str, "roof", "where the pigeons live")}

    def __init__(self, options: dict[str, Any], context: Any) -> None:
        super().__init__(options, context)
        self.sky: list[tuple[str, str, Any]] = []
        self.told: list[tuple[str, str]] = []

    def opened(self, stream: Any) -> None:
        self.told.append(("opened", stream.component_name))

    def closed(self, stream: Any) -> None:
        self.told.append(("closed", stream.component_name))

    def left(self, name: str) -> None:
        self.told.append(("left", name))

    @maps("general")
    def general(self, stream: Any, message: Any) -> None:
        self.sky.append((stream.component_name, "general", dict(message.fields)))

    @maps("pose")
    def pose(self, stream: Any, message: Any) -> None:
        self.sky.append((stream.component_name, "pose", [float(v) for v in message.position]))


class FastPigeons(Pigeons):
    def wanted(self, stream: Any, topic: str) -> bool:
        return bool(stream.component_name == "robot1.smell")


class Recorder(AbstractDatastream):
    """A stream class of a user."""

    made: list[Recorder] = []  # noqa: RUF012 - the test empties it

    def initialize(self) -> None:
        self.events = ["initialize", self.direction, self.kwargs]
        self.made.append(self)

    def default(self, ci: Any = None) -> bool:
        assert ci is self.component_instance
        self.events.append("default")
        return False

    def finalize(self) -> None:
        self.events.append("finalize")


class Asks(Recorder):
    options: ClassVar = {"topic": Option(str, "/a", "where to")}


class Of14(DatastreamManager):
    """Written for MORSE 1.4."""

    def __init__(self, args: Any, kwargs: Any) -> None:
        DatastreamManager.__init__(self, args, kwargs)
        self.seen: list[Any] = []

    def register_component(self, component_name, component_instance, mw_data):  # type: ignore[no-untyped-def,override]
        self.seen.append((component_name, component_instance, mw_data))
        DatastreamManager.register_component(self, component_name, component_instance, mw_data)


def declared(direction: str, stream: str = KIND_STREAM, **options: object) -> StreamDeclaration:
    return StreamDeclaration("pigeons", stream, direction, options)


def test_every_component_is_carried_by_its_kind_or_as_general(bench: Bench) -> None:
    pigeons = Pigeons({}, bench.context)
    place, smell = Place(Body("robot1.place")), Smell(Body("robot1.smell"))
    for component in (place, smell):
        pigeons.connect(component, declared("OUT"))
        component.action()
    assert [(name, kind) for name, kind, _ in pigeons.sky] == [("robot1.place", "pose"), ("robot1.smell", "general")]
    assert pigeons.sky[0][2] == [1.0, 2.0, 3.0]
    assert pigeons.sky[1][2]["intensity"] == 0.5


def test_nothing_is_gathered_for_nobody(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    pigeons = FastPigeons({}, bench.context)
    place = Place(Body("robot1.place"))
    pigeons.connect(place, declared("OUT"))
    (stream,) = pigeons.streams["robot1.place"]
    monkeypatch.setattr(type(stream.kinds[0]), "gather", lambda self: pytest.fail("nobody listens"))
    place.action()
    assert pigeons.sky == []


def test_commands_come_in_by_slots_and_are_checked(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    pigeons = Pigeons({}, bench.context)
    wheels = Wheels(Body("robot1.wheels"))
    pigeons.connect(wheels, declared("IN"))
    (stream,) = pigeons.streams["robot1.wheels"]
    assert isinstance(stream, KindStream)
    (twist,) = stream.kinds
    stream.receive(twist, {"linear": [0.5, 0.0, 0.0], "angular": [0.0, 0.0, 0.1]})
    assert wheels.local_data["v"] == 0.0, "not before the component acts"
    wheels.action()
    assert (wheels.local_data["v"], wheels.local_data["w"]) == (0.5, 0.1)
    for wrong in ({"linear": "fast"}, {"lineer": [1, 0, 0]}, {"linear": [float("nan"), 0.0, 0.0]}, {"linear": [1]}):
        stream.receive(twist, wrong)
        wheels.action()
        assert (wheels.local_data["v"], wheels.local_data["w"]) == (0.5, 0.1), wrong
    assert "robot1.wheels: a message is refused" in caplog.text


class Owls(DatastreamManager):
    """A middleware with one message for each component, whose payloads are texts."""

    by_component = True

    def __init__(self, options: dict[str, Any], context: Any) -> None:
        super().__init__(options, context)
        self.sky: list[tuple[str, str]] = []

    @maps("general")
    def general(self, stream: Any, message: Any) -> str | None:
        if message.fields.get("x") == 0.0:
            return None
        return f"{message.kind.name} {sorted(message.fields)}"

    def send(self, stream: Any, payload: str) -> None:
        self.sky.append((stream.component_name, payload))

    @maps("general", direction="IN")
    def command(self, stream: Any, kind: Any, data: str) -> dict[str, float] | None:
        name, _, value = data.partition("=")
        return {name: float(value)} if name != "other" else None

    @maps("twist", direction="IN")
    def twist(self, stream: Any, kind: Any, data: str) -> dict[str, Any]:
        return {"linear": [float(data), 0.0, 0.0]}


class Plain(DatastreamManager):
    """Has forms for data only."""

    @maps("general")
    def general(self, stream: Any, message: Any) -> bytes:
        return b""


class Gear(Actuator):
    add_data("gear", 1, "int", "of the box")


def test_fields_are_those_of_the_component_whatever_its_kind(bench: Bench) -> None:
    owls = Owls({}, bench.context)
    place = Place(Body("robot1.place"))
    owls.connect(place, declared("OUT"))
    place.action()
    names = sorted(("x", "y", "z", "yaw", "pitch", "roll", "timestamp"))
    assert owls.sky == [("robot1.place", f"pose {names}")]
    place.local_data["x"] = 0.0
    place.action()
    assert len(owls.sky) == 1, "None: nothing is sent"


def test_methods_read_commands_by_field_or_by_slot(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    owls = Owls({}, bench.context)
    wheels, box = Wheels(Body("robot1.wheels")), Gear(Body("robot1.box"))
    for component in (wheels, box):
        owls.connect(component, declared("IN"))
    owls.streams["robot1.wheels"][0].receive("0.5")
    for data in ("gear=3", "other=7"):
        owls.streams["robot1.box"][0].receive(data)
    for component in (wheels, box):
        component.action()
    assert wheels.local_data["v"] == 0.5
    assert box.local_data["gear"] == 3
    assert not caplog.text
    for wrong in ("gear=high", "gear=nan", None):
        owls.streams["robot1.box"][0].receive(wrong)
        box.action()
        assert box.local_data["gear"] == 3, wrong
    assert "robot1.box: this message cannot be read (ValueError" in caplog.text
    assert "robot1.box: a message is refused: 'gear' is nan" in caplog.text


def test_without_a_method_commands_are_fields(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    plain = Plain({}, bench.context)
    wheels = Wheels(Body("robot1.wheels"))
    plain.connect(wheels, declared("IN"))
    (stream,) = plain.streams["robot1.wheels"]
    for data in ({"v": 0.5}, {"v": "fast"}, ["v"], {"w": 0.25}):
        stream.receive(data)
    wheels.action()
    assert (wheels.local_data["v"], wheels.local_data["w"]) == (0.5, 0.25)
    assert "'v' is 'fast', expected" in caplog.text
    assert "expected a JSON object" in caplog.text


def test_a_payload_needs_a_way_out_and_a_failing_stream_is_closed_alone(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    plain, owls = Plain({}, bench.context), Owls({}, bench.context)
    place = Place(Body("robot1.place"))
    for manager in (plain, owls):
        manager.connect(place, declared("OUT"))
    for _ in range(2):
        place.action()
    assert "Plain has a method that returns a payload, b'', but no method send(self, stream, payload)" in caplog.text
    assert plain.streams["robot1.place"] == []
    assert len(owls.sky) == 2


@pytest.mark.parametrize(("period", "messages"), [(0.1, 10), (0.25, 4), (1e-3, 60), (None, 60)])
def test_a_stream_has_a_period(bench: Bench, period: float | None, messages: int) -> None:
    owls = Owls({}, bench.context)
    place = Place(Body("robot1.place"))
    owls.connect(place, declared("OUT", **({} if period is None else {"period": period})))
    for _ in range(60):
        place.action()
        bench.context.clock.advance()
    assert len(owls.sky) == messages


def test_periods_are_for_sensors_and_timeouts_for_actuators(bench: Bench) -> None:
    with pytest.raises(MorseMiddlewareError, match=r"period=0.1 is for sensors"):
        Owls({}, bench.context).connect(Wheels(Body("robot1.wheels")), declared("IN", period=0.1))
    with pytest.raises(MorseMiddlewareError, match=r"timeout=0.1 is for actuators"):
        Owls({}, bench.context).connect(Place(Body("robot1.place")), declared("OUT", timeout=0.1))


def test_the_base_keeps_the_streams(bench: Bench) -> None:
    pigeons = Pigeons({}, bench.context)
    Recorder.made.clear()
    stream = f"{__name__}.Recorder"
    old, other = Place(Body("robot1.place")), Smell(Body("robot1.smell"))
    for component, direction in ((old, "OUT"), (old, "IN"), (other, "OUT")):
        pigeons.connect(component, declared(direction, stream, colour="grey"))
    assert {name: len(streams) for name, streams in pigeons.streams.items()} == {"robot1.place": 2, "robot1.smell": 1}
    first = Recorder.made[0]
    old.action()
    assert first.events == ["initialize", "OUT", {"colour": "grey"}, "default"]

    new = Place(Body("robot1.place"))  # like after a reset
    pigeons.connect(new, declared("OUT", stream))
    assert first.events[-1] == "finalize"
    assert [s.component_instance for s in pigeons.streams["robot1.place"]] == [new]

    pigeons.disconnect(other)
    assert pigeons.told[-2:] == [("closed", "robot1.smell"), ("left", "robot1.smell")]
    pigeons.finalize()
    assert pigeons.streams == {}
    assert all(made.events[-1] == "finalize" for made in Recorder.made)


def test_options_are_declared(bench: Bench) -> None:
    assert Pigeons({}, bench.context).options == {"loft": "roof"}
    with pytest.raises(OptionError, match="did you mean 'loft'"):
        Pigeons({"lofd": "cellar"}, bench.context)
    with pytest.raises(OptionError, match="loft"):
        Pigeons({"loft": 3}, bench.context)
    pigeons = Pigeons({}, bench.context)
    Recorder.made.clear()
    pigeons.connect(Place(Body("robot1.place")), declared("OUT", f"{__name__}.Asks"))
    assert Recorder.made[0].kwargs == {"topic": "/a"}
    with pytest.raises(OptionError, match="did you mean 'topic'"):
        pigeons.connect(Smell(Body("robot1.smell")), declared("OUT", f"{__name__}.Asks", topik="/b"))


def test_general_has_to_be_mapped() -> None:
    with pytest.raises(MorseDeclarationError, match="but not 'general'"):

        class Half(DatastreamManager):
            @maps("pose")
            def pose(self, stream: Any, message: Any) -> None: ...

    with pytest.raises(MorseDeclarationError, match="did you mean 'pose'"):
        maps("posse")


def test_a_manager_of_1_4_works(bench: Bench) -> None:
    manager = Of14({}, bench.context)
    place = Place(Body("robot1.place"))
    Recorder.made.clear()
    manager.connect(place, declared("OUT", f"{__name__}.Recorder", topic="/place"))
    assert manager.seen == [("robot1.place", place, ["pigeons", f"{__name__}.Recorder", "OUT", {"topic": "/place"}])]
    place.action()
    assert Recorder.made[0].events == ["initialize", "OUT", {"topic": "/place"}, "default"]
    again = Place(Body("robot1.place"))
    manager.connect(again, declared("OUT", f"{__name__}.Recorder"))
    assert [stream.component_instance for stream in manager.streams["robot1.place"]] == [again]


def test_what_is_no_stream_is_refused(bench: Bench) -> None:
    with pytest.raises(MorseMiddlewareError, match="no method 'default'"):
        Pigeons({}, bench.context).connect(Place(Body("robot1.place")), declared("OUT", "morse.core.clock.Clock"))


def test_the_port_of_a_component_that_is_deleted_is_closed(bench: Bench) -> None:
    sensor = bench.sensor("robot1.pose", port=0)
    port = bench.port_of("robot1.pose")
    client = bench.connect("robot1.pose")
    bench.streams.disconnect(sensor)
    wait_until(client.has_ended)
    client.close()
    bench.components.clear()
    bench.sensor("robot1.pose", port=port)
    assert bench.port_of("robot1.pose") == port


# -- packages with a middleware -------------------------------------------------------------------

MAPPING = """
from morse.core.declarations import Option
from morse.middleware.registry import Middleware

MIDDLEWARE = Middleware(
    "pigeon", stream_manager="my_lab.manager.Pigeons", stream_options={"wind": Option(float, 0.0, "m/s")}
)
"""
USE = """
import logging, sys
from morse.builder import *
from morse.core.exceptions import MorseMiddlewareError
from morse.middleware import registry
robot = FakeRobot()
pose = Pose()
robot.append(pose)
pose.add_stream("pigeon", wind=3.0)
(stream,) = pose._declaration(robot).streams
print(stream.manager, stream.options, "my_lab.manager" in sys.modules)
for name in ("broken", "wrong"):
    try:
        pose.add_stream(name)
    except MorseMiddlewareError as error:
        print(error)
print(sorted(registry.installed()))
"""


def test_a_package_brings_a_middleware(tmp_path: Path) -> None:
    for path, text in {
        "my_lab/__init__.py": "",
        "my_lab/mapping.py": MAPPING,
        "my_lab/manager.py": "raise RuntimeError('nobody has asked for it')",
        "my_lab/broken.py": "import nonsense_that_does_not_exist",
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": (
            "[morse.middlewares]\npigeon = my_lab.mapping:MIDDLEWARE\nbroken = my_lab.broken:MIDDLEWARE\n"
            "wrong = my_lab.mapping:Option\n"
        ),
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    script = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{USE}"
    run = python("-c", script)
    assert run.returncode == 0, run.stderr
    lines = run.stdout.splitlines()
    assert lines[0] == "my_lab.manager.Pigeons {'wind': 3.0} False"
    assert "'broken' of an installed package" in lines[1]
    assert "nonsense_that_does_not_exist" in lines[1]
    assert "'wrong'" in lines[2]
    names = lines[3].strip("[]").split(", ")
    assert {"'pigeon'", "'ros2'", "'socket'"} <= set(names)
    assert not {"'broken'", "'wrong'"} & set(names)
    logging.getLogger(__name__).debug(run.stderr)


def test_a_manager_gets_the_defaults_of_its_description(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "lab.py").write_text(
        "from morse.core.datastream import DatastreamManager\nfrom morse.core.declarations import Option\n"
        "from morse.core.mapping import maps\nfrom morse.middleware.registry import Middleware\n"
        "OPTIONS = {'gain': Option(float, 2.0, 'gain'), 'unit': Option(str, 'm', 'unit')}\n"
        "MIDDLEWARE = Middleware('crate', stream_manager='lab.Crates', manager_options=OPTIONS, needs_network=False)\n"
        "class Crates(DatastreamManager):\n"
        "    @maps('general')\n"
        "    def general(self, stream, message):\n        print(sorted(self.options.items()))\n"
    )
    (tmp_path / "pyproject.toml").write_text('[project.entry-points."morse.middlewares"]\ncrate = "lab:MIDDLEWARE"\n')
    (tmp_path / "scene.py").write_text(
        "from morse.builder import *\nrobot = FakeRobot()\npose = Pose()\npose.add_stream('crate')\n"
        "robot.append(pose)\nenv = Environment('empty')\nenv.configure_stream_manager('crate', unit='cm')\n"
    )
    program = f"import morse\nwith morse.load({str(tmp_path / 'scene.py')!r}, sockets=False) as s:\n    s.step(3)\n"
    run = python("-c", f"import sys; sys.path.insert(0, {str(tmp_path / 'src')!r})\n{program}")
    assert "[('gain', 2.0), ('unit', 'cm')]" in run.stdout, run.stderr
