"""Message kinds: declared once, gathered and scattered, refused if invalid."""

import contextlib
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kind_components import made, spoken

from morse.core.declarations import add_data, add_kind, add_property, euler, mapped, prop
from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds import KINDS, KindError, bind, findings_of
from morse.core.validation import CommandError, Commands
from morse.mathutils import Euler, Matrix, Quaternion

angles = st.floats(-math.pi, math.pi)
coordinates = st.floats(-1e6, 1e6)


class Sonar:
    add_data("timestamp", 0.0, "float", "", unit="s")
    add_data("distance", math.inf, "float", "To the echo", unit="m", frame="own", low=0.02, high=4.0, allow=("inf",))
    add_data("echo", [0.0] * 4, "array", "Strength", shape=4, dtype="float32", low=0.0, high=1.0)
    add_property("_reach", 400.0, "Range", "float", "How far it hears", unit="cm", low=0.0)
    add_kind("range", distance="distance", min=0.02, max=prop("_reach"), fov=0.5, radiation="ultrasound")


class Place:
    add_data("timestamp", 0.0, "float", "", unit="s")
    add_data("x", 0.0, "float", "", unit="km", frame="world")
    add_data("y", 0.0, "float", "", unit="km", frame="world")
    add_data("z", 0.0, "float", "", unit="km", frame="world")
    add_data("roll", 0.0, "float", "", unit="deg", frame="world", angle=True)
    add_data("pitch", 0.0, "float", "", unit="deg", frame="world", angle=True)
    add_data("yaw", 0.0, "float", "", unit="deg", frame="world", angle=True)
    add_kind("pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))


def test_the_kinds_are_those_of_the_specification():
    expected = (
        "pose twist accel attitude odometry wrench imu magnetic_field fix pressure temperature battery range scan "
        "cloud image camera_info detections contact joints actuators switch clock general"
    )
    assert set(KINDS) == set(expected.split())
    slots = {
        "pose": "position orientation tolerance speed covariance",
        "odometry": "position orientation linear angular pose_covariance twist_covariance",
        "scan": "ranges intensities angle_min angle_increment range_min range_max",
        "range": "distance min max fov radiation variance",
        "fix": "latitude longitude altitude velocity course utc covariance",
        "cloud": "points intensity color ring id",
    }
    for kind, names in slots.items():
        assert set(KINDS[kind].slots) == set(names.split())


def test_a_message_has_units_constants_and_properties():
    message = spoken(Sonar, distance=1.5, timestamp=0.5).gather()
    assert message.kind.name == "range"
    assert message.stamp == 500_000_000
    assert (message.distance, message.min, message.max, message.fov) == (1.5, 0.02, 4.0, 0.5)
    assert message.radiation == "ultrasound"
    assert message.variance is None
    with pytest.raises(AttributeError, match="no slot 'gyro'"):
        _ = message.gyro


def test_the_stamp_is_that_of_the_measurement_in_exact_nanoseconds():
    component = made(Sonar)
    (bound,) = bind(component)
    for tick in range(200):
        component.local_data["timestamp"] = component.clock.time
        assert bound.gather().stamp == round(tick * 10**9 / 60)
        component.clock.advance()
    component.local_data["timestamp"] = 10 / 60
    assert bound.gather().stamp == 166_666_667


@given(coordinates, coordinates, coordinates, angles, angles, angles)
def test_what_is_gathered_can_be_scattered(x, y, z, roll, pitch, yaw):
    data = {"x": x, "y": y, "z": z, "roll": math.degrees(roll), "pitch": math.degrees(pitch), "yaw": math.degrees(yaw)}
    bound = spoken(Place, **data)
    message = bound.gather()
    assert message.position == pytest.approx([1e3 * x, 1e3 * y, 1e3 * z])
    assert message.orientation.flags.c_contiguous
    assert not message.orientation.flags.writeable
    fields, remark = bound.scatter(message.slots)
    assert remark is None
    assert [fields[n] for n in "xyz"] == pytest.approx([x, y, z], rel=1e-12, abs=1e-12)
    again = Euler([math.radians(fields[n]) for n in ("roll", "pitch", "yaw")]).to_matrix()
    assert np.allclose(again, Euler([roll, pitch, yaw]).to_matrix(), atol=1e-7)


@given(angles, angles, angles)
def test_a_quaternion_is_that_of_the_turns_about_fixed_axes_x_y_z(roll, pitch, yaw):
    bound = spoken(Place, roll=math.degrees(roll), pitch=math.degrees(pitch), yaw=math.degrees(yaw))
    w, x, y, z = bound.gather().orientation
    assert math.hypot(w, x, y, z) == pytest.approx(1.0)
    turned = Matrix.Rotation(yaw, 3, "Z") @ Matrix.Rotation(pitch, 3, "Y") @ Matrix.Rotation(roll, 3, "X")
    assert np.allclose(Quaternion((w, x, y, z)).to_matrix(), turned, atol=1e-9)


def test_what_a_command_lacks_stays():
    bound = spoken(Place)
    assert bound.scatter({"position": [1000, 2000, 3000]})[0] == {"x": 1.0, "y": 2.0, "z": 3.0}
    assert bound.scatter({"orientation": [0.0, 0.0, 0.0, 0.0], "position": None})[0] == {}
    assert bound.scatter({"orientation": [5.0, 0.0, 0.0, 5.0]})[0]["yaw"] == pytest.approx(90.0)
    assert bound.scatter({"tolerance": 1.0}) == ({}, "slot 'tolerance' has no effect")


@pytest.mark.parametrize(
    ("slots", "said"),
    [
        ({"positoin": [0, 0, 0]}, "has no slot 'positoin'; did you mean 'position'"),
        ({"position": [0, 0]}, r"'position' is \[0, 0\], expected the shape \(3,\)"),
        ({"position": "abc"}, "expected numbers of the shape"),
        ({"position": [0, 0, "z"]}, "expected numbers of the shape"),
        ({"orientation": [math.nan] * 4}, "a quaternion of finite numbers"),
        ({"orientation": {"w": 1}}, "expected numbers of the shape"),
    ],
)
def test_commands_that_do_not_fit_are_refused(slots, said):
    with pytest.raises(CommandError, match=said):
        spoken(Place).scatter(slots)


slot_values = st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(), st.lists, max_leaves=8)


@given(st.dictionaries(st.sampled_from(["position", "orientation", "speed", "other"]), slot_values))
def test_no_command_breaks_the_component(slots):
    component = made(Place)
    (bound,) = bind(component)
    with contextlib.suppress(CommandError):
        Commands(component).take(bound.scatter(slots)[0])
    assert all(math.isfinite(number) for number in component.local_data.values())


class Cart:
    add_data("v", 0.0, "float", "", unit="m/s", frame="robot", low=-10.0, high=10.0)
    add_data("w", 0.0, "float", "", unit="rad/s", frame="robot")
    add_kind("twist", linear=("v", None, None), angular=(None, None, "w"))


def test_axes_without_a_field_have_no_effect():
    bound = spoken(Cart, v=2.0)
    assert bound.gather().linear.tolist() == [2.0, 0.0, 0.0]
    fields, remark = bound.scatter({"linear": [1.0, 0.5, 0.0], "angular": [0.0, 0.0, 3.0]})
    assert fields == {"v": 1.0, "w": 3.0}
    assert remark == "item 1 has no effect in slot 'linear'"


# -- frames --------------------------------------------------------------------------------


class Push:
    add_data("force", [0.0] * 3, "vec3", "", unit="N", frame="world", shape=3)
    add_data("torque", [0.0] * 3, "vec3", "", unit="N·m", frame="own", shape=3)
    add_kind("wrench", force="force", torque="torque")


def test_the_slots_of_a_message_are_in_the_frame_of_the_first():
    component = made(Push, torque=[1.0, 0.0, 0.0])
    component.position_3d.set_pose((5.0, 0.0, 0.0), (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0))
    (bound,) = bind(component)
    assert bound.frame == "world"
    assert bound.gather().torque == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    fields, _ = bound.scatter({"torque": [0.0, 2.0, 0.0]})
    assert fields["torque"] == pytest.approx([2.0, 0.0, 0.0], abs=1e-12)
    # a message may state that all slots are in the frame of the component
    assert bound.scatter({"force": [1.0, 0.0, 0.0]}, "own")[0]["force"] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)


def test_frames_that_are_not_those_of_a_component_cannot_be_turned():
    class Wrong:
        add_data("a", [0.0] * 3, "vec3", "", unit="N", frame="world", shape=3)
        add_data("b", [0.0] * 3, "vec3", "", unit="N·m", frame="ned", shape=3)
        add_kind("wrench", force="a", torque="b")

    with pytest.raises(KindError, match="in the frame 'ned', and cannot be converted into 'world'"):
        spoken(Wrong)


# -- words, levels, conditions -------------------------------------------------------------


class Battery:
    add_data("charge", 100.0, "float", "", unit="%")
    add_data("status", "Charged", "string", "")
    add_kind(
        "battery",
        charge="charge",
        status=mapped("status", charging="Charging", discharging="Discharging", full="Charged"),
    )


def test_words_are_those_of_the_kind():
    message = spoken(Battery, charge=50.0, status="Discharging").gather()
    assert (message.charge, message.status) == (0.5, "discharging")
    assert spoken(Battery).scatter({"status": "full"})[0] == {"status": "Charged"}


def test_when_decides_by_the_properties_of_the_component():
    class Lidar:
        add_data("r", [], "list", "", unit="m", shape=(None,), dtype="float64")
        add_data("p", [], "list", "", unit="m", shape=(None, 3), dtype="float64", frame="own")
        add_property("layers", 1, "layers", "int")
        add_kind(
            "scan",
            when=lambda c: c.layers == 1,
            ranges="r",
            angle_min=0.0,
            angle_increment=0.1,
            range_min=0.0,
            range_max=5.0,
        )
        add_kind("cloud", when=lambda c: c.layers > 1, points="p")
        add_kind("cloud", when=lambda c: c.layers == 1, on_request=True, topic="points", points="p")

    component = made(Lidar, r=np.array([1.0, np.inf]))
    (scan,) = bind(component)
    assert scan.gather().ranges.dtype == np.float32
    assert [b.topic for b in bind(component, on_request=True)] == ["", "points"]
    component.layers = 4
    (cloud,) = bind(component)
    assert cloud.kind.name == "cloud"
    assert cloud.gather().points.shape == (0, 3)


def test_a_component_without_a_kind_is_carried_all_the_same():
    class Plain:
        add_data("a", 1, "int", "")
        add_data("b", "x", "string", "")

    message = spoken(Plain).gather()
    assert message.kind.name == "general"
    assert dict(message.fields) == {"a": 1, "b": "x"}

    class Silent:
        pass

    assert bind(made(Silent)) == ()


# -- modifiers -----------------------------------------------------------------------------


def altered(changes):
    component = made(Place)
    component.output_modifiers.append(SimpleNamespace(changes=changes))
    return component


def test_a_modifier_changes_the_declaration():
    feet = {name: {"unit": "ft", "frame": "ned"} for name in "xyz"}
    component = altered(feet | {name: {"frame": "ned"} for name in ("roll", "pitch", "yaw")})
    component.local_data["x"] = 10.0
    message = bind(component)[0]
    assert message.frame == "ned"
    assert message.gather().position[0] == pytest.approx(3.048)


def test_a_pose_in_degrees_is_a_fix_and_an_attitude():
    degrees = {"unit": "deg", "frame": "wgs84"}
    component = altered({"x": degrees, "y": degrees, "z": {"unit": "m", "frame": "wgs84"}})
    component.local_data.update(x=1.5, y=43.6, z=150.0)
    fix, attitude = bind(component)
    message = fix.gather()
    assert (message.longitude, message.latitude, message.altitude) == (1.5, 43.6, 150.0)
    assert (attitude.kind.name, attitude.topic) == ("attitude", "attitude")


def test_geocentric_coordinates_have_no_kind():
    component = altered({name: {"unit": "deg", "frame": "geocentric"} for name in "xyz"})
    assert [bound.kind.name for bound in bind(component)] == ["general"]


def test_the_covariance_follows_from_the_noise():
    component = made(Place)
    component.realism = SimpleNamespace(changes=lambda: {"x": {"stddev": 2e-3}, "yaw": {"stddev": 1.0}})
    covariance = bind(component)[0].gather().covariance
    assert covariance.shape == (6, 6)
    assert np.diag(covariance) == pytest.approx([4.0, 0, 0, 0, 0, math.radians(1.0) ** 2])
    assert np.count_nonzero(covariance) == 2
    assert spoken(Place).gather().covariance is None


# -- errors --------------------------------------------------------------------------------


def declare(**slots):
    kind = slots.pop("kind")

    class Boiler:
        add_data("heat", 0.0, "float", "", unit="W")
        add_data("level", 0.0, "float", "")
        add_data("three", [0.0] * 3, "vec3", "", unit="m/s", shape=3)
        add_data("bearing", 0.0, "float", "")
        add_kind(kind, **slots)

    return spoken(Boiler)


@pytest.mark.parametrize(
    ("declared", "said"),
    [
        ({"kind": "posse"}, "no message kind 'posse'; did you mean 'pose'"),
        ({"kind": "imu", "gyro": "three"}, "kind 'imu' has no slot 'gyro'; known: angular_velocity"),
        ({"kind": "imu", "angular_velocty": "three"}, "did you mean 'angular_velocity'"),
        ({"kind": "range", "distance": "heat"}, "kind 'range' needs the slot 'min', 'max', 'fov', 'radiation'"),
        ({"kind": "attitude"}, "kind 'attitude' needs one of the slots"),
        ({"kind": "temperature", "temperature": "heat"}, "it takes °C; field 'heat' has W; known: K, degC, °F"),
        ({"kind": "temperature", "temperature": "level"}, "it takes °C; field 'level' has no unit"),
        ({"kind": "temperature", "temperature": "haet"}, "no field 'haet'; did you mean 'heat'"),
        ({"kind": "clock", "now": "three"}, r"it takes the shape \(\), field 'three' has \(3,\)"),
        ({"kind": "clock", "now": prop("_x")}, "no property '_x'"),
        ({"kind": "attitude", "orientation": euler("bearing", "bearing", "bearing")}, "an angle needs the unit rad"),
        ({"kind": "battery", "charge": "level", "status": "fulll"}, "did you mean 'full'"),
    ],
)
def test_what_is_declared_wrongly_is_refused(declared, said):
    with pytest.raises(MorseDeclarationError, match=said) as caught:
        declare(**declared)
    assert "Boiler" in str(caught.value) or "robot.boiler" in str(caught.value)


def test_all_findings_come_at_once():
    class Two:
        add_data("a", 0.0, "float", "", unit="W")
        add_kind("range", distance="a", min=0.0, max="b", fov=0.0, radiation="x")

    (first, *others) = findings_of([made(Two)])
    assert len(others) == 2
    assert "distance" in first[1]


def test_two_kinds_cannot_have_one_topic():
    class Two:
        add_data("t", 0.0, "float", "", unit="s")
        add_kind("clock", now="t")
        add_kind("clock", now="t")

    with pytest.raises(KindError, match="have the same topic"):
        spoken(Two)


def test_a_class_that_declares_kinds_does_not_inherit_others():
    class Mute(Sonar):
        add_kind(None)

    assert bind(made(Mute)) == (), "no middleware carries its data"
