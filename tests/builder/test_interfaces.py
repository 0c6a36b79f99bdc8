import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from morse.builder import (
    Cube,
    Environment,
    FakeRobot,
    Keyboard,
    MorseBuilderError,
    MorseBuilderUnexportableError,
    MorseError,
    MorseMiddlewareError,
    Morsy,
    MotionVW,
    Pose,
)
from morse.builder.names import catalog
from morse.builder.names.catalog import Entry
from morse.middleware import registry
from morse.middleware.registry import Middleware

STREAMS = "morse.middleware.socket_datastream.SocketDatastreamManager"
SERVICES = "morse.middleware.socket_request_manager.SocketRequestManager"
WRITER = "morse.middleware.socket_datastream.SocketPublisher"
READER = "morse.middleware.socket_datastream.SocketReader"


def declaration(component: Any) -> Any:
    return component._declaration(component)


def test_the_direction_follows_from_the_class() -> None:
    pose, motion = Pose(), MotionVW()
    pose.add_stream("socket")
    motion.add_stream("socket", port=61000)
    (out,), (into,) = declaration(pose).streams, declaration(motion).streams
    assert (out.manager, out.stream, out.direction, out.options) == (STREAMS, WRITER, "OUT", {})
    assert (into.manager, into.stream, into.direction, into.options) == (STREAMS, READER, "IN", {"port": 61000})
    assert out.where.file == __file__


@pytest.mark.parametrize("given", [
    {"method": "my_sim.streams.Writer"},
    {"method": "Writer", "path": "my_sim.streams"},
    {"classpath": "my_sim.streams.Writer"},
])  # fmt: skip
def test_a_class_of_ones_own(given: dict[str, str]) -> None:
    pose = Pose()
    pose.add_stream("socket", topic="/pose", **given)
    (stream,) = declaration(pose).streams
    assert stream.stream == "my_sim.streams.Writer"
    assert stream.options == {"topic": "/pose"}


def test_a_manager_of_ones_own_needs_a_class() -> None:
    pose = Pose()
    with pytest.raises(MorseBuilderError, match="classpath="):
        pose.add_stream("my_sim.streams.Manager")
    pose.add_stream("my_sim.streams.Manager", classpath="my_sim.streams.Writer")
    pose.add_stream(STREAMS)
    assert [s.stream for s in declaration(pose).streams] == ["my_sim.streams.Writer", WRITER]


def test_a_direction_that_is_given() -> None:
    pose = Pose()
    pose.add_stream("socket", direction="IN")
    assert declaration(pose).streams[0].stream == READER
    with pytest.raises(ValueError, match="IN, OUT"):
        pose.add_stream("socket", direction="SIDEWAYS")


@pytest.mark.parametrize(("name", "answer"), [
    ("sokcet", "did you mean 'socket'"),
    ("pocolibs", "not part of this installation"),
    ("carrier-pigeon", "installed: .*socket"),
])  # fmt: skip
def test_unknown_middlewares(name: str, answer: str) -> None:
    pose, robot = Pose(), FakeRobot()
    for call in (pose.add_stream, pose.add_service, pose.add_interface, robot.add_default_interface):
        with pytest.raises(MorseMiddlewareError, match=answer):
            call(name)


@pytest.mark.parametrize("bad", [None, 3, "", ["socket"], b"socket"])
def test_middlewares_are_given_by_name(bad: Any) -> None:
    for call in (Pose().add_stream, Pose().add_service, Pose().add_interface, FakeRobot().add_default_interface):
        with pytest.raises((TypeError, ValueError)):
            call(bad)


def test_what_has_no_data_is_not_streamed() -> None:
    keyboard = Keyboard()
    with pytest.raises(MorseBuilderUnexportableError, match="no data"):
        keyboard.add_stream("socket")
    keyboard.add_interface("socket")
    assert declaration(keyboard).streams == []
    assert declaration(keyboard).managers == [SERVICES]
    for thing in (Cube(), Morsy()):
        with pytest.raises(MorseBuilderUnexportableError):
            thing.add_stream("socket")


def test_services() -> None:
    pose, motion = Pose(), MotionVW()
    pose.add_service("socket")
    pose.add_service("socket")
    pose.add_service("my_sim.requests.Manager")
    pose.add_service("socket", component=motion)
    assert declaration(pose).managers == [SERVICES, "my_sim.requests.Manager"]
    assert declaration(motion).managers == [SERVICES]


def test_overlays() -> None:
    motion = MotionVW()
    motion.add_overlay("socket", "my_sim.overlays.Wheels", config={"a": 1}, namespace="base")
    (overlay,) = declaration(motion).overlays
    assert (overlay.manager, overlay.classpath) == (SERVICES, "my_sim.overlays.Wheels")
    assert overlay.options == {"a": 1, "namespace": "base"}


def test_what_a_middleware_cannot_carry_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    picture = Middleware("picture", stream_manager="picture.Manager", not_carried=("Pose",))
    monkeypatch.setattr(registry, "installed", lambda: {"picture": picture})
    with pytest.raises(MorseBuilderUnexportableError, match="'picture' cannot carry the data of Pose"):
        Pose().add_stream("picture")
    with pytest.raises(MorseMiddlewareError, match="no services"):
        Pose().add_service("picture")
    pose = Pose()
    pose.add_interface("picture")
    assert declaration(pose).streams == []


def test_a_middleware_without_readers_names_commands_and_the_class_for_them(monkeypatch: pytest.MonkeyPatch) -> None:
    diary = Middleware("diary", stream_manager="diary.Manager", default_reader=None)
    monkeypatch.setattr(registry, "installed", lambda: {"diary": diary})
    with pytest.raises(MorseBuilderUnexportableError, match=r"'diary' cannot take commands for MotionVW.*MyReader'"):
        MotionVW().add_stream("diary")


def test_a_middleware_that_maps_kinds_carries_every_component(monkeypatch: pytest.MonkeyPatch) -> None:
    everything = Middleware("everything", stream_manager="everything.Manager")
    monkeypatch.setattr(registry, "installed", lambda: {"everything": everything})
    for component in (Pose(), MotionVW()):
        component.add_stream("everything")
        (stream,) = declaration(component).streams
        assert (stream.manager, stream.stream) == ("everything.Manager", "morse.core.streams.kind_stream.KindStream")


def test_components_of_the_socket_that_have_no_stream() -> None:
    socket = registry.middleware("socket")
    assert socket.stream_of(type("StereoUnit", (), {}), "OUT") is None
    assert socket.stream_of(object, "OUT") == "morse.middleware.socket_datastream.SocketPublisher"
    assert socket.stream_of(object, "IN") == "morse.middleware.socket_datastream.SocketReader"


def test_default_interface(load: Callable[..., Any]) -> None:
    scene = load(
        "from morse.builder import *\n"
        "r = FakeRobot()\n"
        "r.add_default_interface('socket')\n"
        "r.add_default_interface('socket')\n"
        "motion, pose, keyboard, arm, hand = MotionVW(), Pose(), Keyboard(), Teleport(), Pose()\n"
        "for part in (motion, pose, keyboard, arm):\n    r.append(part)\n"
        "arm.append(hand)\n"
        "pose.add_stream('socket', port=61000)\n"
        "other = FakeRobot()\n"
        "eye = Pose()\n"
        "other.append(eye)\n"
        "env = Environment('empty')\n"
        "late = Pose()\n"
        "r.append(late)\n"
    )
    found = {c.name: ([s.options for s in c.streams], c.managers) for c in scene.components}
    assert found["r"] == ([], [])
    assert found["r.motion"] == ([{}], [SERVICES])
    assert found["r.pose"] == ([{"port": 61000}], [SERVICES])
    assert found["r.keyboard"] == ([], [SERVICES])
    assert found["r.arm.hand"] == ([{}], [SERVICES])
    assert found["other.eye"] == ([], [])


# --- modifiers -----------------------------------------------------------------------------------


@pytest.fixture
def modifiers(monkeypatch: pytest.MonkeyPatch) -> None:
    entries = (
        Entry("ToNED", "mods.ned.ToNED", "", {"_names": ("NED",), "_components": ("Pose",)}),
        Entry("Noise", "mods.noise.PoseNoise", "", {"_names": ("PoseNoise", "Noise"), "_components": ("Pose",)}),
        Entry("ImuNoise", "mods.noise.ImuNoise", "", {"_names": ("Noise",), "_components": ("IMU",)}),
        Entry("Feet", "mods.feet.FromFeet", "", {"_names": ("feet",), "_components": ("Teleport",)}),
    )
    monkeypatch.setattr(catalog, "modifiers", lambda: entries)


@pytest.mark.usefixtures("modifiers")
def test_modifiers_by_name_and_class() -> None:
    pose = Pose()
    pose.alter("NED")
    pose.alter("Noise", pos_std=0.1)
    pose.alter(classpath="my_sim.mods.Drift", rate=1)
    assert [(m.classpath, m.options) for m in declaration(pose).modifiers] == [
        ("mods.ned.ToNED", {}),
        ("mods.noise.PoseNoise", {"pos_std": 0.1}),
        ("my_sim.mods.Drift", {"rate": 1}),
    ]


@pytest.mark.usefixtures("modifiers")
@pytest.mark.parametrize(("name", "answer"), [
    ("Noize", "did you mean 'Noise'"),
    ("feet", "not for Pose; there are: NED, Noise, PoseNoise"),
    ("warp", "no modifier 'warp' for Pose; there are: NED, Noise, PoseNoise"),
])  # fmt: skip
def test_unknown_modifiers(name: str, answer: str) -> None:
    with pytest.raises(MorseBuilderError, match=answer):
        Pose().alter(name)


@pytest.mark.usefixtures("modifiers")
def test_no_modifiers_for_this_component() -> None:
    with pytest.raises(MorseBuilderError, match="there are none for MotionVW"):
        MotionVW().alter("NED")
    with pytest.raises(TypeError, match="name of a modifier"):
        Pose().alter()


# --- the catalogue -------------------------------------------------------------------------------


def test_the_catalogue_reads_files_without_running_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "zoo"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "eye.py").write_text(
        "raise RuntimeError('not to be run')\n"
        "class Eye(Sensor):\n    _name: str = 'An eye'\n    _short_desc = 'Sees'\n"
        "class Lidar(Eye):\n    'Scans.'\n    _name = 'Lidar'\n    _builder = BuilderDefaults(name='LaserScanner')\n"
        "class Sonar(Eye):\n    _name = 'Sonar'\n    _builder = BuilderDefaults('Bat', frequency=10.0)\n"
        "class Level(Eye):\n    pass\n"
        "class _Base(Sensor):\n    _name = 'base'\n"
        "class Odd(Sensor):\n    _name = 'Odd' + str(1)\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    found = catalog.components("zoo")
    assert {name: (e.classpath, e.doc) for name, e in found.items()} == {
        "Bat": ("zoo.eye.Sonar", "Sonar"),
        "Eye": ("zoo.eye.Eye", "Sees"),
        "LaserScanner": ("zoo.eye.Lidar", "Scans."),
    }
    assert "zoo.eye" not in sys.modules


# --- options --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "answer"),
    [
        ({"prot": 3}, r"a stream of socket has no option 'prot'; did you mean 'port'\?"),
        ({"port": "abc"}, r"option 'port' of a stream of socket is 'abc', expected an integer"),
        ({"port": 70000}, r"is 70000, expected an integer from 0 to 65535"),
        ({"port": True}, r"is True, expected an integer"),
    ],
)
def test_options_of_streams_are_checked(options: dict[str, Any], answer: str) -> None:
    with pytest.raises(MorseError, match=answer):
        Pose().add_stream("socket", **options)


def test_options_of_other_middlewares_are_left_out(caplog: pytest.LogCaptureFixture) -> None:
    pose = Pose()
    pose.add_stream("socket", port=60100, topic="/pose")
    assert pose._declaration(pose).streams[0].options == {"port": 60100}
    assert "option 'topic' has no effect on socket" in caplog.text


def test_a_stream_class_of_the_user_takes_any_option() -> None:
    pose = Pose()
    pose.add_stream("socket", classpath="my_sim.streams.Quiet", every=3)
    assert pose._declaration(pose).streams[0].options == {"every": 3}


@pytest.mark.parametrize(
    ("options", "answer"),
    [({"time_sink": True}, r"did you mean 'time_sync'"), ({"time_sync": "yes"}, r"'time_sync'.* is 'yes', expected")],
)
def test_options_of_stream_managers_are_checked(options: dict[str, Any], answer: str) -> None:
    env = Environment("empty", fastmode=True)
    with pytest.raises(MorseError, match=answer):
        env.configure_stream_manager("socket", **options)


def test_options_of_modifiers_are_checked_if_they_declare_some(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "fog.py").write_text(
        "from morse.core.declarations import Option\nfrom morse.core.modifier import AbstractModifier\n"
        "class Fog(AbstractModifier):\n    options = {'density': Option(float, 0.1, low=0.0, high=1.0)}\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    pose = Pose()
    pose.alter(classpath="fog.Fog", density=0.5)
    for options, answer in (({"densty": 0.5}, "did you mean 'density'"), ({"density": 2.0}, r"from 0\.?0? to 1")):
        with pytest.raises(MorseError, match=answer):
            pose.alter(classpath="fog.Fog", **options)


def test_an_option_that_no_modifier_has_is_left_out_with_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    pose = Pose()
    pose.alter(classpath="morse.modifiers.pose_noise.PoseNoiseModifier", _pos_std_dev=0.8, pos_std=0.1)
    assert pose._modifiers[0].options == {"pos_std": 0.1}
    (warning,) = [record.getMessage() for record in caplog.records if record.levelname == "WARNING"]
    assert "has no option '_pos_std_dev'" in warning
    assert "(it has no effect)" in warning


def test_control_types_are_checked_where_the_script_gives_them() -> None:
    with pytest.raises(TypeError, match=r"'ControlType' of MotionVW is 'Velo', expected .*Velocity.*Position"):
        MotionVW().properties(ControlType="Velo")


def test_the_environment_offers_the_services_of_the_simulation() -> None:
    FakeRobot("robot")
    env = Environment("empty", fastmode=True)
    env.add_interface("socket")
    env.add_stream("socket")
    with pytest.raises(MorseMiddlewareError):
        env.add_interface("sokcet")
    assert env._simulation_managers == [registry.request_manager("socket")]
