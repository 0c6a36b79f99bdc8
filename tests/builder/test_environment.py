import contextlib
import logging
import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from morse.assets import AssetNotFoundError
from morse.builder import (
    Environment,
    FakeRobot,
    MorseBuilderError,
    MorseError,
    MorseMiddlewareError,
    MorseMultinodeError,
    Pose,
    TimeStrategies,
    workspace,
)
from morse.builder.assembly.finalise import build_scene
from morse.middleware import registry
from morse.scene import Mist, Scene
from tests.kit.effort import examples

SERVICES = "morse.middleware.socket_request_manager.SocketRequestManager"
STREAMS = "morse.middleware.socket_datastream.SocketDatastreamManager"


@pytest.fixture
def env() -> Environment:
    return Environment("empty")


def scene() -> Scene:
    return build_scene(workspace.current())


# --- the world -----------------------------------------------------------------------------------


def test_the_world_is_in_the_scene(env: Environment) -> None:
    built = scene()
    assert built.environment == "empty"
    assert built.find("Ground") is not None
    assert built.settings.view.horizon_color is not None, "the sky of the file"


def test_defaults(env: Environment) -> None:
    built = scene()
    view = built.settings.view
    assert built.settings.gravity == pytest.approx(9.81)
    assert built.settings.frequency == 60.0
    assert built.settings.physics_steps == 2
    assert built.settings.time_strategy is TimeStrategies.BestEffort
    assert built.settings.time_scale == 1.0
    assert not built.settings.fastmode
    assert view.camera_location == (5.0, -5.0, 5.0)
    assert view.camera_rotation == pytest.approx((math.pi / 4, 0.0, math.pi / 4), abs=1e-4)
    assert view.camera_clip == (0.1, 100.0)
    assert view.camera_speed == 2.0
    assert view.camera_focal_length == 20.0
    assert built.simulation_managers == [SERVICES]
    assert built.manager_options == {}


def test_unknown_environments() -> None:
    with pytest.raises(AssetNotFoundError, match="did you mean 'sandbox'"):
        Environment("sandbxo")
    assert workspace.current().environment is None


@pytest.mark.parametrize("bad", [None, 3, "", b"empty", ["empty"]])
def test_environments_are_given_by_name(bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="filename"):
        Environment(bad)


@pytest.mark.parametrize("option", ["fastmode", "component_renaming", "auto_tune_time"])
def test_options_are_true_or_false(option: str) -> None:
    with pytest.raises(TypeError, match=option):
        Environment("empty", **{option: []})
    Environment("empty", **{option: True})


def test_one_environment_a_scene(env: Environment) -> None:
    with pytest.raises(MorseBuilderError, match=r"only one Environment; it was created at .*test_environment.py"):
        Environment("empty")


# --- the view ------------------------------------------------------------------------------------


def test_view(env: Environment) -> None:
    env.set_camera_location([10.0, -10.0, 10.0])
    env.set_camera_rotation([1.05, 0, 0.78])
    env.set_camera_clip(0.5, 500)
    env.set_camera_speed(4)
    env.set_camera_focal_length(35.0)
    env.set_horizon_color((0.1, 0.2, 0.3))
    env.set_ambient_color((0.4, 0.5, 0.6))
    env.set_daylight(0.25)
    env.show_debug_properties()
    env.show_framerate()
    env.show_physics(True)
    env.set_material_mode("MULTITEXTURE")
    env.fullscreen()
    env.set_stereo()
    view = scene().settings.view
    assert view.camera_location == (10.0, -10.0, 10.0)
    assert view.camera_rotation == (1.05, 0.0, 0.78)
    assert (view.camera_clip, view.camera_speed, view.camera_focal_length) == ((0.5, 500.0), 4.0, 35.0)
    assert (view.horizon_color, view.ambient_color) == ((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    assert view.daylight == 0.25
    assert view.show_debug_properties
    assert view.show_framerate
    assert view.show_physics
    assert view.fullscreen
    assert view.material_mode == "MULTITEXTURE"
    assert view.stereo == {"mode": "ANAGLYPH", "eye_separation": 0.1, "stereo": "STEREO"}


def test_colours_have_the_defaults_of_1_4(env: Environment) -> None:
    env.set_horizon_color()
    assert scene().settings.view.horizon_color == (0.05, 0.22, 0.4)


def test_viewport(env: Environment) -> None:
    env.set_viewport("SOLID", 250)
    view = scene().settings.view
    assert (view.viewport, view.camera_clip) == ("SOLID", (0.1, 250.0))
    with pytest.raises(ValueError, match="WIREFRAME"):
        env.set_viewport("XRAY")


def test_mist(env: Environment) -> None:
    env.set_mist_settings(enable=True, intensity=0.2, start=1, depth=10.0, falloff="LINEAR")
    assert scene().settings.view.mist == Mist(True, 0.2, 1.0, 10.0, "LINEAR")
    env.enable_mist(False)
    assert scene().settings.view.mist == Mist(False, 0.2, 1.0, 10.0, "LINEAR")
    with pytest.raises(TypeError, match="dept"):
        env.set_mist_settings(dept=3)  # type: ignore[call-arg]
    for bad in ({"depth": math.nan}, {"intensity": -1}, {"falloff": "CUBIC"}, {"enable": None}, {"start": "near"}):
        with pytest.raises((TypeError, ValueError)):
            env.set_mist_settings(**bad)


def test_old_names_still_work(env: Environment, caplog: pytest.LogCaptureFixture) -> None:
    env.place_camera([1, 2, 3])
    env.aim_camera([0.1, 0.2, 0.3])
    env.configure_service("socket")
    view = scene().settings.view
    assert view.camera_location == (1.0, 2.0, 3.0)
    assert view.camera_rotation == (0.1, 0.2, 0.3)
    for new in ("set_camera_location", "set_camera_rotation", "add_service"):
        assert new in caplog.text


def test_display_camera(load: Callable[..., Any]) -> None:
    built = load(
        "from morse.builder import *\nr = FakeRobot()\neye = Pose()\nr.append(eye)\n"
        "env = Environment('empty')\nenv.select_display_camera(eye)\n"
    )
    assert built.settings.view.display.images == ("r.eye",)


def test_display_camera_is_a_component(env: Environment) -> None:
    with pytest.raises(TypeError, match="camera of a robot"):
        env.select_display_camera("eye")  # type: ignore[arg-type]


# --- time and physics ----------------------------------------------------------------------------


def test_time(env: Environment) -> None:
    env.set_gravity(1.62)
    env.set_time_strategy(TimeStrategies.FixedSimulationStep)
    env.set_time_scale(slowdown_by=4)
    env.simulator_frequency(100)
    env.set_physics_step_sub(5)
    env.use_relative_time(True)
    env.use_internal_syncer()
    env.use_vsync("OFF")
    env.set_auto_start(False)
    env.set_seed(42)
    built = scene().settings
    assert (built.gravity, built.time_scale, built.frequency) == (1.62, 0.25, 100.0)
    assert built.time_strategy is TimeStrategies.FixedSimulationStep
    assert (built.physics_steps, built.relative_time, built.internal_syncer) == (5, True, True)
    assert (built.auto_start, built.seed) == (False, 42)
    env.set_time_scale(accelerate_by=3)
    assert scene().settings.time_scale == 3.0


def test_one_of_two_time_scales(env: Environment) -> None:
    for both in ({}, {"slowdown_by": 2, "accelerate_by": 2}):
        with pytest.raises(ValueError, match="either slowdown_by"):
            env.set_time_scale(**both)  # type: ignore[arg-type]


@pytest.mark.parametrize("call", [
    lambda e: e.set_gravity(-9.81), lambda e: e.set_gravity(math.nan),
    lambda e: e.set_gravity("low"), lambda e: e.set_gravity(None), lambda e: e.set_gravity([9.81]),
    lambda e: e.set_time_scale(slowdown_by=0), lambda e: e.set_time_scale(accelerate_by=-1),
    lambda e: e.simulator_frequency(0), lambda e: e.simulator_frequency(math.inf),
    lambda e: e.set_physics_step_sub(0), lambda e: e.set_physics_step_sub(1.5),
    lambda e: e.set_time_strategy("BestEffort"), lambda e: e.set_time_strategy(7), lambda e: e.set_time_strategy(True),
    lambda e: e.use_vsync("MAYBE"), lambda e: e.use_relative_time(["no"]), lambda e: e.set_seed(-1),
    lambda e: e.set_camera_location([1, 2]), lambda e: e.set_camera_location([1, 2, math.nan]),
    lambda e: e.set_camera_location(5), lambda e: e.set_camera_rotation("abc"), lambda e: e.set_camera_rotation(None),
    lambda e: e.set_camera_clip(10, 1), lambda e: e.set_camera_clip(0, 1), lambda e: e.set_camera_clip(1, 1),
    lambda e: e.set_camera_speed(0),
    lambda e: e.set_camera_focal_length(math.nan), lambda e: e.set_horizon_color((0, 0, 300)),
    lambda e: e.set_daylight(1.5), lambda e: e.set_daylight(math.nan), lambda e: e.set_daylight("night"),
    lambda e: e.set_ambient_color((0, 0)), lambda e: e.show_physics(None), lambda e: e.fullscreen({}),
    lambda e: e.set_material_mode("PRETTY"), lambda e: e.set_stereo("CROSSED"), lambda e: e.create(3),
    lambda e: e.set_log_level("core", "LOUD"), lambda e: e.set_log_level(3, "INFO"),
    lambda e: e.set_log_level("core", None), lambda e: e.set_log_level("my robot", "INFO"),
    lambda e: e.properties(latitude=math.nan),
    lambda e: e.configure_multinode(protocol="pigeon"), lambda e: e.configure_multinode(server_port="99999"),
    lambda e: e.configure_multinode(server_port="x"), lambda e: e.configure_multinode(distribution={"a": 1}),
    lambda e: e.configure_multinode(server_address=""), lambda e: e.configure_multinode(distribution=[1]),
])  # fmt: skip
def test_bad_arguments_are_refused(env: Environment, call: Callable[[Environment], None]) -> None:
    before = repr(env.settings)
    with pytest.raises((TypeError, ValueError)) as caught:
        call(env)
    assert "env." in str(caught.value) or "property" in str(caught.value) or "dictionary" in str(caught.value)
    assert repr(env.settings) == before


anything = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.binary(max_size=3),
    st.lists(st.one_of(st.integers(), st.floats(), st.text(max_size=2)), max_size=4),
    st.dictionaries(st.text(max_size=3), st.one_of(st.integers(), st.lists(st.text(max_size=2), max_size=2))),
)  # fmt: skip
METHODS = sorted(name for name in dir(Environment) if not name.startswith("_"))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=examples(400), deadline=None)
@given(method=st.sampled_from(METHODS), arguments=st.lists(anything, max_size=2))
def test_arbitrary_arguments_never_break_the_environment(method: str, arguments: list[Any]) -> None:
    workspace.reset()
    env = Environment("empty")
    with contextlib.suppress(TypeError, ValueError, MorseError):
        getattr(env, method)(*arguments)
    built = scene()
    numbers = [built.settings.gravity, built.settings.frequency, built.settings.time_scale]
    numbers += [*built.settings.view.camera_location, *built.settings.view.camera_rotation]
    assert all(math.isfinite(number) for number in numbers)


# --- auto-tune -----------------------------------------------------------------------------------


def _with_sensor(hertz: float, **options: Any) -> Environment:
    robot, sensor = FakeRobot(), Pose()
    robot.append(sensor)
    sensor.frequency(hertz)
    return Environment("empty", **options)


def test_the_fastest_component_sets_the_frequency() -> None:
    _with_sensor(250)
    assert scene().settings.frequency == 250.0


def test_slow_components_do_not_slow_the_simulation() -> None:
    _with_sensor(5)
    assert scene().settings.frequency == 60.0


def test_auto_tune_can_be_switched_off() -> None:
    _with_sensor(250, auto_tune_time=False)
    assert scene().settings.frequency == 60.0


def test_a_fixed_step_is_not_tuned() -> None:
    _with_sensor(250).set_time_strategy(TimeStrategies.FixedSimulationStep)
    assert scene().settings.frequency == 60.0


def test_a_given_frequency_is_not_tuned() -> None:
    _with_sensor(250).simulator_frequency(80)
    assert scene().settings.frequency == 80.0


# --- middlewares, nodes, logs --------------------------------------------------------------------


def test_stream_managers(env: Environment) -> None:
    env.configure_stream_manager("socket", time_sync=True, sync_port=5000)
    env.configure_stream_manager("my_sim.streams.Manager", host="a")
    assert scene().manager_options == {
        STREAMS: {"time_sync": True, "sync_port": 5000},
        "my_sim.streams.Manager": {"host": "a"},
    }
    with pytest.raises(MorseMiddlewareError, match="did you mean 'socket'"):
        env.configure_stream_manager("sockte", time_sync=True)


def test_services_of_the_simulation(env: Environment) -> None:
    env.add_service("socket")
    env.add_service("my_sim.requests.Manager")
    assert scene().simulation_managers == [SERVICES, "my_sim.requests.Manager"]
    with pytest.raises(MorseMiddlewareError, match="not part of this installation"):
        env.add_service("pocolibs")


def test_multinode(env: Environment) -> None:
    env.configure_multinode(server_port="65001", distribution={"a": ["r1", "r2"], "b": ["r3"]})
    manager = registry.stream_manager("multinode")
    assert scene().manager_options == {manager: {"server_address": "localhost", "server_port": 65001}}


def test_multinode_without_a_middleware_for_it(env: Environment, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "installed", dict)
    with pytest.raises(MorseMultinodeError, match="no installed middleware exchanges poses"):
        env.configure_multinode()


def test_log_levels_and_properties(env: Environment) -> None:
    env.set_log_level("core.sensor", "debug")
    env.properties(longitude=1.43, latitude=43.6, altitude=150.0, Temperature=12)
    built = scene()
    assert built.log_levels == {"core.sensor": "DEBUG"}
    assert built.properties == {"longitude": 1.43, "latitude": 43.6, "altitude": 150.0, "Temperature": 12}


def test_settings_after_create(env: Environment) -> None:
    env.create("node_a")
    env.set_time_strategy(TimeStrategies.FixedSimulationStep)
    env.set_gravity(0)  # weightless
    built = scene().settings
    assert (built.node_name, built.gravity) == ("node_a", 0.0)
    assert built.time_strategy is TimeStrategies.FixedSimulationStep


def test_what_has_no_effect_says_so(env: Environment, caplog: pytest.LogCaptureFixture) -> None:
    env.save("/nowhere/scene.blend")
    env.set_background_scene("S.background")
    env.set_animation_record(True)
    assert caplog.text.count("has no effect") == 3


def test_debug(env: Environment, monkeypatch: pytest.MonkeyPatch) -> None:
    level = logging.getLogger("morse").level
    try:
        env.set_debug(True)
        assert logging.getLogger("morse").isEnabledFor(logging.DEBUG)
    finally:
        logging.getLogger("morse").setLevel(level)


def test_misspelt_settings(env: Environment) -> None:
    with pytest.raises(AttributeError, match="did you mean 'set_camera_location'"):
        env.set_camera_loction([1, 2, 3])  # type: ignore[operator]


def test_properties_of_the_place_are_known(env: Environment, caplog: pytest.LogCaptureFixture) -> None:
    env.properties(UTMXOffset=377000.0, UTMYOffset="4827000.5", UTMZOffset=100.0)
    assert not [record for record in caplog.records if "did you mean" in record.getMessage()]
    env.properties(UTMXOfset=1.0)
    assert any("did you mean 'UTMXOffset'" in record.getMessage() for record in caplog.records)
