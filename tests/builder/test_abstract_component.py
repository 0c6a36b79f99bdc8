import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.builder import (
    AbstractComponent,
    Cube,
    FakeRobot,
    GroundRobot,
    Keyboard,
    Kinect,
    MorseBuilderError,
    Morsy,
    MotionVW,
    Odometry,
    PassiveObject,
    Pose,
)
from morse.builder.abstractcomponent import timer
from morse.mathutils import Euler, Vector
from morse.scene import Node

metres = st.floats(-1e6, 1e6)


@given(metres, metres, metres, metres, metres, metres)
def test_translations_add_up(a: float, b: float, c: float, d: float, e: float, f: float) -> None:
    thing = Cube()
    thing.translate(a, b, c)
    thing.translate(x=d, y=e, z=f)
    assert list(thing.location) == [a + d, b + e, c + f]


def test_rotations_add_up_angle_by_angle() -> None:
    thing = Cube()
    thing.rotate(z=math.pi / 2)
    thing.rotate(0.1, 0.2, 0.3)
    assert list(thing.rotation_euler) == pytest.approx([0.1, 0.2, math.pi / 2 + 0.3])


def test_the_pose_is_that_of_the_parent_frame() -> None:
    robot, sensor = FakeRobot(), Pose()
    robot.translate(1.0, 2.0, 3.0)
    robot.rotate(z=math.pi / 2)
    sensor.translate(1.0, 0.0, 0.5)
    robot.append(sensor)
    world = sensor.scene_node.world_matrix()
    assert [world[i][3] for i in range(3)] == pytest.approx([1.0, 3.0, 3.5])


def test_appending_keeps_the_numbers_of_the_pose() -> None:
    robot, sensor = FakeRobot(), Pose()
    robot.translate(5.0)
    sensor.translate(0.2, 0.0, 0.9)
    robot.append(sensor)
    assert list(sensor.location) == [0.2, 0.0, 0.9]


def test_location_can_be_changed_in_place() -> None:
    thing = Cube()
    thing.location = (1, 2, 3)
    thing.location.x += 0.5
    thing.location[2] = 9
    assert thing.location == Vector((1.5, 2.0, 9.0))
    assert thing.location == (1.5, 2.0, 9.0)
    thing.rotation_euler.z = 1.0
    assert thing.rotation_euler == Euler((0.0, 0.0, 1.0))
    thing.scale = [2, 2, 2]
    assert list(thing.scale) == [2.0, 2.0, 2.0]


def test_a_copy_of_the_location_stays_behind() -> None:
    thing = Cube()
    before = thing.location.copy()
    thing.translate(1.0)
    assert list(before) == [0.0, 0.0, 0.0]
    assert list(thing.location + before) == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("bad", [math.nan, math.inf, "one", None, [1], True, object()])
def test_poses_take_finite_numbers(bad: Any) -> None:
    thing = Cube()
    for change in (
        lambda: thing.translate(bad),
        lambda: thing.rotate(z=bad),
        lambda: setattr(thing, "location", (0.0, bad, 0.0)),
        lambda: setattr(thing, "rotation_euler", [0.0, 0.0, bad]),
        lambda: thing.location.__setitem__(0, bad),
        lambda: setattr(thing.location, "y", bad),
    ):
        with pytest.raises((TypeError, ValueError)):
            change()
    assert list(thing.location) == [0.0, 0.0, 0.0]
    assert list(thing.rotation_euler) == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("bad", [(1, 2), (1, 2, 3, 4), "abc", 5, None, {"x": 1}])
def test_locations_have_three_numbers(bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="three numbers"):
        Cube().location = bad


# --- append ------------------------------------------------------------------------------------


def test_append_to_a_named_part() -> None:
    robot, sensor = Morsy(), Pose()
    robot.append(sensor, "morsy_mesh")
    assert sensor.scene_node.parent is not None
    assert sensor.scene_node.parent.plain_name == "morsy_mesh"
    assert sensor.parent is robot


def test_append_to_an_unknown_part() -> None:
    robot = Morsy()
    with pytest.raises(MorseBuilderError, match="did you mean 'morsy_mesh'"):
        robot.append(Pose(), "morsy_mseh")


@pytest.mark.parametrize("bad", [None, "pose", Pose, 3])
def test_append_takes_components(bad: Any) -> None:
    with pytest.raises(TypeError, match="component"):
        FakeRobot().append(bad)


def test_nothing_is_part_of_itself() -> None:
    outer, inner = FakeRobot(), Pose()
    outer.append(inner)
    for parent, child in ((outer, outer), (inner, outer)):
        with pytest.raises(MorseBuilderError, match="part of it"):
            parent.append(child)
    assert outer.parent is None


def test_appended_twice_belongs_to_the_second() -> None:
    first, second, sensor = FakeRobot(), FakeRobot(), Pose()
    first.append(sensor)
    second.append(sensor)
    assert first.children == []
    assert second.children == [sensor]
    assert sensor.parent is second


def test_get_child() -> None:
    robot = Morsy()
    other = Morsy()
    found = robot.get_child("morsy_mesh")
    assert found is not None
    assert found.parent == robot._bpy_object
    assert other.get_child("morsy_mesh").name == "morsy_mesh.001"  # type: ignore[union-attr]
    assert robot.get_child("morsy_b").name == "morsy_bb"  # type: ignore[union-attr]
    assert robot.get_child("antenna") is None
    crate = PassiveObject("props/crates", "small_crate")
    sensor = Pose()
    crate.append(sensor)
    assert crate.get_child("PoseMesh") is not None
    assert crate.get_child("PoseMesh", recursive=False) is None
    assert crate.get_child("morsy_mesh", robot._bpy_object.children) == found


def test_a_child_of_exactly_that_name_is_found_without_a_look_at_plain_names(monkeypatch: pytest.MonkeyPatch) -> None:
    # each sensor of a description looks for its link among all others
    robot = Morsy()
    name = robot._bpy_object.children[0].name
    monkeypatch.setattr(Node, "plain_name", property(lambda _: pytest.fail("all names are compared")))
    assert robot.get_child(name) is not None


# --- properties ----------------------------------------------------------------------------------


def test_properties_have_the_type_of_their_value() -> None:
    thing = Cube()
    thing.properties(Object=True, Count=3, Size=0.5, Label="box", Clock=timer(1.0))
    properties = thing._bpy_object.game.properties
    assert {name: p.type for name, p in properties.items()} == {
        "Object": "BOOL",
        "Count": "INT",
        "Size": "FLOAT",
        "Label": "STRING",
        "Clock": "TIMER",
    }
    assert thing.property_value("Label") == "box"
    assert thing.property_value("Weight") is None
    properties["Count"].value = 4
    assert thing.property_value("Count") == 4


def test_a_property_is_not_nan() -> None:
    with pytest.raises(ValueError, match="Size"):
        Cube().properties(Size=math.nan)


def test_numbers_of_numpy_become_plain() -> None:
    np = pytest.importorskip("numpy")
    thing = Cube()
    thing.properties(Size=np.float32(0.5), Count=np.int64(3))
    assert type(thing.property_value("Size")) is float
    assert type(thing.property_value("Count")) is int


def test_unknown_property_is_kept_with_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    motion = MotionVW()
    motion.properties(ControlTyp="Position")
    assert motion.property_value("ControlTyp") == "Position"
    assert "'ControlTyp'" in caplog.text
    assert "did you mean 'ControlType'?" in caplog.text
    assert "test_abstract_component.py:" in caplog.text


def test_declared_property_gives_no_warning(caplog: pytest.LogCaptureFixture) -> None:
    MotionVW().properties(ControlType="Position")
    Cube().properties(Anything=1)
    FakeRobot().properties(Team="red")
    assert caplog.text == ""


def test_a_number_is_no_word() -> None:
    with pytest.raises(TypeError, match="'Speed' of Keyboard is 'fast', expected a number"):
        Keyboard().properties(Speed="fast")


# --- frequency, level, profile -------------------------------------------------------------------


def test_frequency() -> None:
    pose = Pose()
    assert pose.property_value("frequency") == 60.0
    pose.frequency(12)
    assert pose.property_value("frequency") == 12.0
    pose.properties(frequency=5)
    assert pose._declaration(pose).frequency == 5.0


@pytest.mark.parametrize("bad", [0, -1, math.nan, math.inf, "fast", False])
def test_bad_frequencies(bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="frequency"):
        Pose().frequency(bad)


def test_a_frequency_that_is_not_given_stays() -> None:
    pose = Pose()
    pose.frequency(12)
    pose.frequency()
    pose.frequency(None)
    assert pose.property_value("frequency") == 12.0
    # scripts of 1.4 call it without an object
    GroundRobot.frequency(10)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"Pose\.frequency\(\) got an unexpected keyword argument 'delays'"):
        pose.frequency(delays=1)


def test_the_cameras_of_one_sensor_have_its_frequency() -> None:
    kinect = Kinect()
    kinect.frequency(7)
    kinect.frequency()
    assert [part.property_value("frequency") for part in (kinect, *kinect.children)] == [7.0, 7.0, 7.0]


def test_level() -> None:
    odometry = Odometry()
    odometry.level("raw")
    assert odometry._declaration(odometry).level == "raw"
    odometry.level("default")
    assert odometry._declaration(odometry).level == "integrated"


@pytest.mark.parametrize(("make", "word", "answer"), [
    (Odometry, "integratd", "did you mean 'integrated'?"),
    (Odometry, "perfect", "has raw, differential, integrated"),
    (Pose, "raw", "has no abstraction levels"),
])  # fmt: skip
def test_unknown_levels(make: Callable[[], Any], word: str, answer: str) -> None:
    with pytest.raises(MorseBuilderError) as caught:
        make().level(word)
    assert answer in str(caught.value)


def test_profile_is_for_sensors(caplog: pytest.LogCaptureFixture) -> None:
    pose, motion = Pose(), MotionVW()
    pose.profile()
    motion.profile()
    assert pose._declaration(pose).profile
    assert not motion._declaration(motion).profile
    assert "is not a sensor" in caplog.text


# --- exportable, morseable -----------------------------------------------------------------------


def test_what_has_no_data_cannot_be_exported() -> None:
    assert not Keyboard().is_exportable()
    pose = Pose()
    assert pose.is_exportable()
    pose.mark_unexportable()
    assert not pose.is_exportable()


def test_morseable() -> None:
    thing = Cube()
    assert not thing.is_morseable()
    with pytest.raises(MorseBuilderError, match="class"):
        thing.morseable()
    thing.morseable("my_sim.things.Lamp")
    assert thing.is_morseable()
    assert thing.property_value("Component_Tag") is True
    assert thing.classpath == "my_sim.things.Lamp"


def test_set_color_paints_the_model_and_not_what_is_on_it() -> None:
    crate, pose = PassiveObject("props/crates", "small_crate"), Pose()
    crate.append(pose)
    crate.set_color(1.0, 0.5, 0.0)
    assert crate.get_child("small_crate_mesh").node.color == (1.0, 0.5, 0.0, 1.0)  # type: ignore[union-attr]
    assert pose.scene_node.children[0].color is None
    with pytest.raises(ValueError, match="255"):
        crate.set_color(255, 0, 0)


# --- typos ---------------------------------------------------------------------------------------


def test_misspelt_methods_get_a_suggestion() -> None:
    for component, typo, meant in (
        (Morsy(), "transalte", "translate"),
        (Pose(), "add_steam", "add_stream"),
        (Cube(), "colour", "color"),
    ):
        with pytest.raises(AttributeError, match=f"did you mean '{meant}'"):
            getattr(component, typo)
    assert not hasattr(Pose(), "wheels")


def test_a_class_that_forgets_its_base_is_told() -> None:
    class Careless(FakeRobot):
        def __init__(self) -> None:
            self.pose = Pose()
            self.append(self.pose)

    with pytest.raises(AttributeError, match=r"Careless.*__init__.*FakeRobot"):
        Careless()

    class Hasty(FakeRobot):
        def __init__(self) -> None:
            self.location = (1.0, 0.0, 0.0)

    with pytest.raises(AttributeError, match=r"Hasty.*__init__.*FakeRobot"):
        Hasty()


def test_close_context_checks_its_level() -> None:
    with pytest.raises(ValueError, match="level"):
        AbstractComponent.close_context(0)
    AbstractComponent.close_context(10_000)
