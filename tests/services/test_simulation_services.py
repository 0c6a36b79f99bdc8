"""The services of the pseudo component ``simulation``, called by a client of a running simulation."""

import math

import pytest

from morse.builder import ATRV, Environment, MotionVW, Pose, Sphere
from pymorse import Morse, MorseServiceFailed

STREAMS = "morse.middleware.socket_datastream.SocketDatastreamManager"
SERVICES = "morse.middleware.socket_request_manager.SocketRequestManager"


def scene():
    for name, x in (("anna", 0.0), ("bert", 4.0)):
        robot = ATRV(name)
        robot.translate(x, 0.0, 0.0)
        pose = Pose("pose")
        robot.append(pose)
        motion = MotionVW("motion")
        robot.append(motion)
        pose.add_stream("socket")
        motion.add_interface("socket")
    ball = Sphere("Ball")
    ball.location = (0.0, 3.0, 2.0)
    ball._bpy_object.game.physics_type = "RIGID_BODY"
    env = Environment("empty", fastmode=True)
    env.place_camera([-5.0, 1.0, 4.0])


def call(simu: Morse, service: str, *arguments: object) -> object:
    return simu.rpc("simulation", service, *arguments)


def position(simu: Morse, name: str) -> list[float]:
    return call(simu, "get_scene_objects")[name][1]


def test_the_robots(simu: Morse) -> None:
    assert call(simu, "list_robots") == ["anna", "bert"]


def test_the_details_describe_what_the_scene_says(simu: Morse) -> None:
    details = call(simu, "details")
    assert details["environment"].startswith("empty")
    anna, bert = details["robots"]
    assert (anna["name"], bert["name"], anna["type"]) == ("anna", "bert", "ATRV")
    assert set(anna["components"]) == {"anna.pose", "anna.motion"}
    pose, motion = anna["components"]["anna.pose"], anna["components"]["anna.motion"]
    assert pose["type"] == "Pose"
    assert pose["stream_interfaces"] == [[STREAMS, "OUT"]]
    assert pose["services"] == []
    assert pose["service_interfaces"] == []
    assert motion["type"] == "MotionVW"
    assert motion["stream_interfaces"] == [[STREAMS, "IN"]]
    assert motion["service_interfaces"] == [SERVICES]
    assert {"set_speed", "stop", "set_property", "get_properties", "get_configurations"} <= set(motion["services"])


def test_the_streams(simu: Morse) -> None:
    names = ["anna.pose", "anna.motion", "bert.pose", "bert.motion"]
    assert sorted(call(simu, "list_streams")) == sorted(names)
    ports = call(simu, "get_all_stream_ports")
    assert sorted(ports) == sorted(names)
    assert len(set(ports.values())) == 4
    for name in names:
        assert call(simu, "get_stream_port", name) == ports[name]
    with pytest.raises(MorseServiceFailed, match=r"Stream unavailable for component anna\.pos.*anna\.pose"):
        call(simu, "get_stream_port", "anna.pos")


def test_a_component_that_is_deactivated_does_nothing(simu: Morse) -> None:
    simu.anna.motion.set_speed(1.0, 0.0).result()
    assert call(simu, "deactivate", "anna.motion") is None
    simu.step(30)
    assert position(simu, "anna")[0] == pytest.approx(0.0, abs=0.01)
    call(simu, "activate", "anna.motion")
    simu.step(60)
    assert position(simu, "anna")[0] == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("service", ["activate", "deactivate"])
@pytest.mark.parametrize("name", ["anna.motio", "", "nobody", 3, None, ["anna.motion"]])
def test_an_unknown_component_is_refused(simu: Morse, service: str, name: object) -> None:
    with pytest.raises(MorseServiceFailed):
        call(simu, service, name)


def test_a_typing_mistake_is_answered_with_the_right_name(simu: Morse) -> None:
    with pytest.raises(MorseServiceFailed, match=r"did you mean 'anna\.motion'"):
        call(simu, "deactivate", "anna.motio")


def test_objects_are_put_back(simu: Morse) -> None:
    before = call(simu, "get_scene_objects")
    simu.anna.motion.set_speed(1.0, 0.5).result()
    simu.step(60)
    assert math.dist(position(simu, "anna"), before["anna"][1]) > 0.5
    assert isinstance(simu.reset(), str)
    assert call(simu, "get_scene_objects") == before
    # a command is not an object
    simu.step(60)
    assert math.dist(position(simu, "anna"), before["anna"][1]) > 0.5


def test_the_tree_of_objects(simu: Morse) -> None:
    tree = call(simu, "get_scene_objects")
    children, place, quaternion = tree["anna"]
    assert place == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)
    assert quaternion == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-6)
    assert "anna.pose" in children
    assert children["anna.pose"][1] == pytest.approx(place, abs=1e-6)
    assert tree["bert"][1] == pytest.approx([4.0, 0.0, 0.1], abs=1e-6)


def test_dynamics_are_suspended_and_restored(simu: Morse) -> None:
    assert call(simu, "suspend_dynamics") == "Physics is suspended"
    simu.step(30)
    assert position(simu, "Ball") == pytest.approx([0.0, 3.0, 2.0], abs=1e-6)
    assert call(simu, "restore_dynamics") == "Physics is resumed"
    simu.step(12)
    # s = g t^2 / 2, up to the step of the engine
    assert position(simu, "Ball")[2] == pytest.approx(2.0 - 0.5 * 9.81 * 0.2**2, abs=0.03)


def test_dynamics_of_one_object(simu: Morse) -> None:
    assert call(simu, "set_object_dynamics", "Ball", False) is None  # false values are omitted
    simu.step(10)
    assert position(simu, "Ball")[2] == pytest.approx(2.0, abs=1e-6)
    assert call(simu, "set_object_dynamics", "Ball", True) is True
    simu.step(10)
    assert position(simu, "Ball")[2] < 1.95


def test_an_object_is_put_somewhere(simu: Morse) -> None:
    call(simu, "suspend_dynamics")
    assert call(simu, "set_object_position", "Ball", [1.0, 2.0, 5.0], [0.0, 0.0, math.pi / 2]) is None
    _, place, quaternion = call(simu, "get_scene_objects")["Ball"]
    assert place == pytest.approx([1.0, 2.0, 5.0])
    assert quaternion == pytest.approx([0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4)])
    call(simu, "set_object_position", "Ball", [1.0, 2.0, 6.0])
    _, place, kept = call(simu, "get_scene_objects")["Ball"]
    assert place == pytest.approx([1.0, 2.0, 6.0])
    assert kept == pytest.approx(quaternion)


@pytest.mark.parametrize(
    "place",
    [
        [1.0, 2.0],
        [1.0, 2.0, 3.0, 4.0],
        "here",
        None,
        [1.0, 2.0, "3"],
        [1.0, 2.0, math.nan],
        [math.inf, 0.0, 0.0],
        [10**400, 0.0, 0.0],
        7,
    ],
)
def test_a_place_that_is_none_is_refused(simu: Morse, place: object) -> None:
    before = position(simu, "Ball")
    with pytest.raises(MorseServiceFailed):
        call(simu, "set_object_position", "Ball", place)
    with pytest.raises(MorseServiceFailed):
        call(simu, "set_object_position", "Ball", [0.0, 0.0, 0.0], place or [0.0])
    assert position(simu, "Ball") == before


def test_an_unknown_object_is_refused(simu: Morse) -> None:
    for service, arguments in (
        ("set_object_position", [[0.0, 0.0, 0.0]]),
        ("set_object_dynamics", [True]),
        ("set_object_visibility", [True, True]),
    ):
        with pytest.raises(MorseServiceFailed, match="Object Bal unknown; did you mean 'Ball'"):
            call(simu, service, "Bal", *arguments)


def test_visibility_is_set(simu: Morse) -> None:
    assert call(simu, "set_object_visibility", "Ball", True, False) is True
    assert call(simu, "set_object_visibility", "anna", False, True) is None
    assert call(simu, "set_object_visibility", "anna", True, True) is True


def test_the_log_level(simu: Morse) -> None:
    assert call(simu, "set_log_level", "core.request_manager", "warning") is None
    with pytest.raises(MorseServiceFailed, match="'warnin' is not a log level; did you mean 'warning'"):
        call(simu, "set_log_level", "core.request_manager", "warnin")
    for name in ("core.request_manage", "a" + ".b" * 30_000):
        with pytest.raises(MorseServiceFailed, match="there is no logger"):
            call(simu, "set_log_level", name, "warning")


def test_the_viewpoint_is_moved(simu: Morse) -> None:
    assert call(simu, "get_camarafp_position") == [-5.0, 1.0, 4.0]
    call(simu, "set_camarafp_position", [1.0, 2.0, 3.0])
    assert call(simu, "get_camarafp_position") == [1.0, 2.0, 3.0]
    # rotated by 90 degrees about Z, at (4, 5, 6)
    transform = [[0.0, -1.0, 0.0, 4.0], [1.0, 0.0, 0.0, 5.0], [0.0, 0.0, 1.0, 6.0], [0.0, 0.0, 0.0, 1.0]]
    call(simu, "set_camarafp_transform", transform)
    assert call(simu, "get_camarafp_position") == [4.0, 5.0, 6.0]
    for row, expected in zip(call(simu, "get_camarafp_transform"), transform, strict=True):
        assert row == pytest.approx(expected, abs=1e-9)


def test_the_projection_of_the_viewpoint(simu: Morse) -> None:
    call(simu, "set_camarafp_far_clip", 200.0)
    matrix = call(simu, "get_camarafp_projection_matrix")
    # OpenGL: a point on the far plane has depth 1 after the division by w
    depth = [sum(a * b for a, b in zip(row, [0.0, 0.0, -200.0, 1.0], strict=True)) for row in matrix]
    assert depth[2] / depth[3] == pytest.approx(1.0)
    assert matrix[1][1] / matrix[0][0] == pytest.approx(16 / 9)


@pytest.mark.parametrize("far", [0.1, 0.05, 0.0])
def test_the_viewpoint_sees_further_than_its_near_clip(simu: Morse, far: float) -> None:
    before = call(simu, "get_camarafp_projection_matrix")
    with pytest.raises(MorseServiceFailed, match=r"0\.1 m|at least|greater"):
        call(simu, "set_camarafp_far_clip", far)
    assert call(simu, "get_camarafp_projection_matrix") == before


@pytest.mark.parametrize("wrong", [None, "far", math.nan, [1.0, 2.0], [[1.0] * 4] * 3, [[1.0] * 3] * 4])
def test_a_viewpoint_that_is_none_is_refused(simu: Morse, wrong: object) -> None:
    for service in ("set_camarafp_position", "set_camarafp_transform", "set_camarafp_far_clip"):
        with pytest.raises(MorseServiceFailed):
            call(simu, service, wrong)


def test_unknown_services_and_wrong_numbers_of_arguments(simu: Morse) -> None:
    with pytest.raises(MorseServiceFailed, match="has not been registered"):
        call(simu, "list_robot")
    with pytest.raises(TypeError, match="wrong # of parameters"):
        call(simu, "activate", "anna.motion", 2)
    with pytest.raises(MorseServiceFailed, match="some parameters are expected"):
        call(simu, "activate")


@pytest.mark.parametrize("service", ["quit", "terminate"])
def test_the_simulation_ends_when_told_to(simulate, service: str) -> None:
    simu = simulate(scene)
    assert call(simu, service) is None
    simu.spin()
    assert not simu.is_up()
