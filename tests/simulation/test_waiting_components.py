"""Sensors that measure when they are read, and actuators whose speeds last: nobody notices which components act."""

import copy
import json
import logging
import math
import pickle

import msgspec
import numpy as np
import pytest

import morse
from morse.core.modifier import AbstractModifier
from morse.core.rows.marks import is_on_read, lasting_fields
from morse.core.sensor import Sensor

COUNT = 4


def scene(extra=""):
    def describe():
        from morse.builder import (  # noqa: F401
            Environment,
            FakeRobot,
            Morsy,
            MotionVW,
            MotionVWDiff,
            MotionXYW,
            Odometry,
            Pioneer3DX,
            Pose,
            Robot,
        )

        for number in range(COUNT):
            robot = Pioneer3DX() if extra == "wheels" else Morsy() if number % 2 else Robot()
            robot.name = f"r{number}"
            robot.translate(3.0 * number, 0.5, 0.0)
            robot.append({"sideways": MotionXYW, "wheels": MotionVWDiff}.get(extra, MotionVW)("motion"))
            pose, odometry = Pose("pose"), Odometry("odometry")
            pose.translate(0.1, 0.2, 0.3)
            pose.rotate(0.1, 0.0, 0.4)
            robot.append(pose)
            robot.append(odometry)
            if extra == "rates":
                odometry.frequency(20)
        Environment("empty", fastmode=True)

    return describe


@pytest.fixture
def sim():
    with morse.load(scene()) as simulation:
        yield simulation


def named(sim, name):
    return sim.context.components[name]


def drive(sim, tick):
    for number in range(COUNT):
        data = named(sim, f"r{number}.motion").local_data
        first = "v" if "v" in data else "x"
        data[first] = 0.3 * math.sin(0.05 * tick + number) if number != 2 else 0.0
        data["w"] = 0.5 * math.cos(0.03 * tick * number) if number != 2 else 0.0


def hashes(sim, ticks, read=None):
    found = []
    for tick in range(ticks):
        drive(sim, tick)
        sim.step(1)
        if read is not None:
            read(sim, tick)
        if tick % 20 == 19:
            found.append(sim.state_hash())
    return found


def touch(sim):
    """Keep the data of all sensors, which then measure in each tick."""
    for component in sim.context.components.values():
        assert component.local_data is not None


@pytest.fixture
def restless(monkeypatch):
    """Let all actuators act in each tick."""
    from morse.actuators.v_omega import MotionVW
    from morse.actuators.v_omega_diff_drive import MotionVWDiff
    from morse.actuators.xy_omega import MotionXYW

    for cls in (MotionVW, MotionVWDiff, MotionXYW):
        monkeypatch.setattr(cls, "may_wait", lambda self: False)


@pytest.mark.parametrize("extra", ["", "sideways", "rates", "wheels"])
def test_bits_are_those_of_components_that_act_in_each_tick(request, extra):
    with morse.load(scene(extra)) as simulation:
        waiting = hashes(simulation, 200)
    request.getfixturevalue("restless")
    with morse.load(scene(extra)) as simulation:
        touch(simulation)
        assert hashes(simulation, 200) == waiting


def test_readers_change_nothing():
    def read(simulation, tick):
        if tick % 3 == 0:
            named(simulation, "r1.odometry").local_data["x"]
        if tick % 7 == 0:
            simulation.save()

    with morse.load(scene()) as one, morse.load(scene()) as two:
        assert hashes(one, 100) == hashes(two, 100, read)


@pytest.mark.parametrize("extra", ["", "wheels"])
def test_save_and_restore_in_the_middle(extra):
    with morse.load(scene(extra)) as sim, morse.load(scene(extra)) as other:
        hashes(sim, 50)
        state = sim.save()
        expected = hashes(sim, 100)
        sim.restore(state)
        assert hashes(sim, 100) == expected
        other.restore(state)
        assert hashes(other, 100) == expected


def test_wheels_keep_the_speed_of_the_last_command_whoever_else_sets_them(monkeypatch):
    from morse.actuators.v_omega_diff_drive import MotionVWDiff

    applied = count_calls(monkeypatch, MotionVWDiff, "default_action")
    with morse.load(scene("wheels")) as sim:
        robot, radius = sim.context.robots["r1"], sim.context.robots["r1"].wheel_radius
        sim.r1.motion.publish({"v": 0.4})
        sim.step(60)
        assert len(applied) == COUNT
        assert [wheel.speed * radius for wheel in robot.get_wheels()] == pytest.approx([0.4, 0.4], rel=0.02)
        before = sim.save()
        robot.apply_vw_wheels(-3.0, 0.0)
        named(sim, "r1.motion").local_data["v"] = 0.2
        state = sim.save()
        sim.step(60)
        assert [wheel.speed * radius for wheel in robot.get_wheels()] == pytest.approx([0.2, 0.2], rel=0.02)
        for saved, speed in ((state, 0.2), (before, 0.4)):
            sim.restore(saved)
            sim.step(60)
            assert [wheel.speed * radius for wheel in robot.get_wheels()] == pytest.approx([speed] * 2, rel=0.02)
        robot.set_property("FixTurningSpeed", 1.0)
        sim.r1.motion.publish({"v": 0.0, "w": 0.5})
        sim.step(60)
        assert [wheel.speed * radius for wheel in robot.get_wheels()] == pytest.approx([-0.25, 0.25], rel=0.02)
        robot.set_property("FixTurningSpeed", 0.5)
        sim.step(60)
        assert [wheel.speed * radius for wheel in robot.get_wheels()] == pytest.approx([-0.125, 0.125], rel=0.02)


def test_robots_that_turn_their_wheels_in_their_own_way_act_in_each_tick(monkeypatch):
    from morse.actuators.v_omega_diff_drive import MotionVWDiff
    from morse.core.wheeled_robot import PhysicsDifferentialRobot

    applied = count_calls(monkeypatch, MotionVWDiff, "default_action")
    turned = []
    with morse.load(scene("wheels")) as sim:
        robot = sim.context.robots["r1"]
        robot.apply_vw_wheels = lambda v, w: (
            turned.append((v, w)) or PhysicsDifferentialRobot.apply_vw_wheels(robot, v, w)
        )
        named(sim, "r1.motion").set_property("MaxSpeed", 0.0)
        sim.step(10)
        assert len(turned) == 10
        assert applied.count("r1.motion") == 10
        assert applied.count("r0.motion") <= 2


# reading ----------------------------------------------------------------------------------------

WAYS = {
    "item": lambda data: {key: data[key] for key in data},
    "dict": dict,
    "stars": lambda data: dict(**data),
    "display": lambda data: {**data},
    "items": lambda data: dict(data.items()),
    "copy": lambda data: data.copy(),
    "copy.copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda data: pickle.loads(pickle.dumps(data)),
    "json": lambda data: json.loads(json.dumps(data)),
    "msgspec": lambda data: msgspec.json.decode(msgspec.json.encode(data)),
    "msgpack": lambda data: msgspec.msgpack.decode(msgspec.msgpack.encode(data)),
    "or": lambda data: {} | data,
    "get": lambda data: {key: data.get(key) for key in data},
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("held", [False, True], ids=["asked for anew", "held"])
def test_every_reader_sees_the_last_measurement(sim, way, held):
    pose = named(sim, "r1.pose")
    hand = pose.local_data if held else None
    for _ in range(3):
        named(sim, "r1.motion").local_data["v"] = 1.0
        sim.step(10)
        seen = WAYS[way](hand if held else pose.local_data)
        x, y, z = pose.bge_object.worldPosition
        assert (seen["x"], seen["y"], seen["z"]) == (x, y, z)
        assert seen["timestamp"] == sim.clock.time
        assert sorted(seen) == ["pitch", "roll", "timestamp", "x", "y", "yaw", "z"]


def test_a_measurement_is_that_of_its_tick_however_late_it_is_read(sim):
    named(sim, "r1.motion").local_data["v"] = 1.0
    sim.step(30)
    pose = named(sim, "r1.pose")
    was = tuple(pose.bge_object.worldPosition)
    sim.context.robots["r1"].bge_object.worldPosition = (50.0, 50.0, 0.0)
    pose.bge_object.localPosition = (9.0, 9.0, 9.0)
    assert tuple(pose.local_data[axis] for axis in "xyz") == was
    assert (pose.position_3d.x, pose.position_3d.y, pose.position_3d.z) == was


def test_handles_kinds_and_states_read_too(sim):
    from morse.core.kinds import bind

    named(sim, "r3.motion").local_data["v"] = 1.0
    sim.step(20)
    x = named(sim, "r3.pose").bge_object.worldPosition[0]
    (bound,) = bind(named(sim, "r3.pose"))
    assert bound.gather().position[0] == x
    sim.step(20)
    x = named(sim, "r3.pose").bge_object.worldPosition[0]
    assert sim.r3.pose.data["x"] == x
    sim.step(20)
    x = named(sim, "r3.pose").bge_object.worldPosition[0]
    assert named(sim, "r3.pose").get_state()["local_data"]["x"] == x


def test_somebody_else_s_dictionary_is_taken(sim):
    sim.step(2)
    pose = named(sim, "r1.pose")
    pose.local_data = {**pose.local_data, "mine": 1}
    sim.step(2)
    assert pose.local_data["mine"] == 1
    assert pose.local_data["timestamp"] == sim.clock.time


class Reference(Sensor):
    """Keeps a reference to the data of another sensor from its construction on."""

    def __init__(self, obj, parent=None):
        super().__init__(obj, parent)
        self.theirs = self.context.component(f"{parent.name()}.pose").local_data


class Behind(AbstractModifier):
    """The same, as a modifier."""

    def initialize(self):
        sensor = self.component_instance
        self.theirs = sensor.context.component(f"{sensor.robot_parent.name()}.pose").local_data

    def modify(self):
        """Change nothing."""


@pytest.mark.parametrize("by", ["constructor", "modifier"])
def test_data_that_a_constructor_has_taken_are_those_of_each_tick(by):
    def describe():
        from morse.builder import Clock, Environment, Morsy, MotionVW, Pose
        from morse.builder.creator import SensorCreator

        for number in range(2):
            robot = Morsy(f"r{number}")
            robot.translate(3.0 * number, 0.5, 0.0)
            for part in (MotionVW("motion"), Pose("pose"), Clock("clock")):
                robot.append(part)
            if number:
                creator = type("Reference", (SensorCreator,), {"_classpath": f"{__name__}.Reference"})
                if by == "constructor":
                    robot.append(creator("user"))
                else:
                    part.alter(classpath=f"{__name__}.Behind")
        Environment("empty", fastmode=True)

    with morse.load(describe) as sim:
        user = named(sim, "r1.user") if by == "constructor" else named(sim, "r1.clock").output_modifiers[0]
        for restarted in (False, True):
            for _ in range(3):
                sim.step(10)
                assert user.theirs["timestamp"] == sim.clock.time
            assert named(sim, "r1.pose")._in_rows is None
            assert named(sim, "r0.pose")._in_rows is not None, "nobody has a reference to its data"
            if not restarted:
                sim.restart()
                user = named(sim, "r1.user") if by == "constructor" else named(sim, "r1.clock").output_modifiers[0]


# exceptions --------------------------------------------------------------------------------------


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e9, "fast", None, [1.0]])
def test_a_wrong_command_stops_the_component_that_has_it_and_no_other(sim, caplog, value):
    sim.step(5)
    named(sim, "r1.motion").local_data["v"] = value
    named(sim, "r3.motion").local_data["v"] = 1.0
    with caplog.at_level(logging.ERROR):
        sim.step(30)
    assert [r.getMessage() for r in caplog.records if "r1.motion failed and is deactivated" in r.getMessage()]
    assert len(caplog.records) == 1
    assert [named(sim, f"r{n}.motion").active for n in range(COUNT)] == [True, False, True, True]
    assert sim.r3.pose.data["x"] > 9.3


def test_a_command_as_a_string_counts_as_before(sim):
    named(sim, "r1.motion").local_data["v"] = "1.0"
    named(sim, "r3.motion").local_data["v"] = 1.0
    sim.step(60)
    one, three = (sim.context.robots[name].position_3d.x - start for name, start in (("r1", 3.0), ("r3", 9.0)))
    assert one == pytest.approx(three, abs=1e-12)


def test_a_component_that_is_switched_off_keeps_its_last_measurement_and_comes_back(sim):
    named(sim, "r1.motion").local_data["v"] = 1.0
    sim.step(30)
    pose = named(sim, "r1.pose")
    pose.active = False
    time, x = sim.clock.time, pose.bge_object.worldPosition[0]
    sim.step(30)
    assert (pose.local_data["timestamp"], pose.local_data["x"], pose.position_3d.x) == (time, x, x)
    pose.toggle_active()
    sim.step(1)
    assert pose.local_data["timestamp"] == sim.clock.time
    sim.step(70)
    assert pose.local_data["x"] == pose.bge_object.worldPosition[0]


def test_an_action_that_is_given_to_one_is_called(sim, caplog):
    sim.step(3)
    pose = named(sim, "r1.pose")
    pose.default_action = lambda: pose.local_data.__setitem__("x", 7.0)
    sim.step(1)
    assert pose.local_data["x"] == 7.0
    pose.default_action = lambda: 1 / 0
    with caplog.at_level(logging.ERROR):
        sim.step(1)
    assert not pose.active
    assert named(sim, "r3.pose").local_data["timestamp"] == sim.clock.time


def test_a_modifier_that_comes_later_is_called(sim):
    sim.step(3)
    pose = named(sim, "r1.pose")

    class Modifier:
        def modify(self):
            pose.local_data["x"] = -1.0

    pose.output_modifiers.append(Modifier())
    sim.step(1)
    assert pose.local_data["x"] == -1.0
    assert named(sim, "r3.pose").local_data["x"] != -1.0


def test_functions_that_publish_and_read_are_called(sim):
    sim.step(3)
    said = []
    pose, motion = named(sim, "r1.pose"), named(sim, "r1.motion")
    pose.output_functions.append(lambda component: said.append(dict(component.local_data)))
    motion.input_functions.append(lambda component: component.local_data.update(v=1.0) or True)
    sim.step(30)
    assert len(said) == 30
    assert said[-1]["x"] == pose.bge_object.worldPosition[0] > 3.2


def count_calls(monkeypatch, cls, name):
    calls = []
    original = getattr(cls, name)

    def counted(self, *arguments):
        calls.append(self.name())
        return original(self, *arguments)

    for mark in ("on_read", "while_same"):
        if hasattr(original, mark):
            setattr(counted, mark, getattr(original, mark))
    monkeypatch.setattr(cls, name, counted)
    return calls


@pytest.mark.parametrize("count", [1, 4])
def test_what_nobody_reads_is_not_measured_and_a_speed_that_lasts_is_not_applied_again(monkeypatch, count):
    from morse.actuators.v_omega import MotionVW
    from morse.sensors.pose import Pose

    monkeypatch.setattr("test_waiting_components.COUNT", count)
    measured, applied = (
        count_calls(monkeypatch, Pose, "default_action"),
        count_calls(monkeypatch, MotionVW, "default_action"),
    )
    with morse.load(scene()) as sim:
        named(sim, "r0.motion").local_data["v"] = 1.0
        sim.step(20)
        assert (measured, len(applied)) == ([], count)
        assert sim.r0.pose.data["x"] == named(sim, "r0.pose").bge_object.worldPosition[0] > 0.3
        assert measured == ["r0.pose"]
        sim.r0.motion.publish({"v": 0.5})
        sim.step(20)
        applied.clear()
        sim.r0.motion.publish({"v": 0.6})
        sim.step(20)
        assert applied == ["r0.motion"]
        assert measured == ["r0.pose"], "a copy of the data is no reference to them"
        kept = named(sim, "r0.pose").local_data
        sim.step(3)
        assert (kept["timestamp"], measured.count("r0.pose")) == (sim.clock.time, 5)


def test_a_class_decides_for_its_own_action_only():
    from morse.actuators.v_omega import MotionVW
    from morse.core.modifier import AbstractModifier  # noqa: F401
    from morse.sensors.gps import GPS, RawGPS
    from morse.sensors.odometry import IntegratedOdometry, Odometry
    from morse.sensors.pose import Pose

    class Same(Pose):
        """Only another name, and a method of its own."""

        def height(self):
            return self.position_3d.z

    class Different(Pose):
        def default_action(self):
            super().default_action()

    class Reporting(Pose):
        def report(self):
            self.local_data["x"] = 0.0

    class Slow(MotionVW):
        def commanded(self):
            return (0.1,), 0.0

    assert [is_on_read(c) for c in (Pose, Same, Different, Reporting)] == [True, True, False, False]
    assert [is_on_read(c) for c in (GPS, RawGPS, IntegratedOdometry, Odometry)] == [True, False, True, False]
    assert [lasting_fields(c) for c in (MotionVW, Slow)] == [("v", "w"), ()]


def test_profiles_name_rows(sim):
    from morse.simulation.ticks.profile import Profile

    profile = Profile()
    sim._ticker.component_profiles.append(profile)
    sim.step(2)
    assert {f"{COUNT} x Pose", f"{COUNT} x MotionVW", f"{COUNT} x IntegratedOdometry"} <= profile.components.keys()


def test_negative_zero_is_zero(sim):
    sim.step(3)
    state = sim.save()
    named(sim, "r1.motion").local_data["v"] = -0.0
    sim.step(5)
    later = [named(sim, "r1.pose").get_state()["local_data"], sim.context.robots["r1"].bge_object.velocity()]
    sim.restore(state)
    sim.step(5)
    now = [named(sim, "r1.pose").get_state()["local_data"], sim.context.robots["r1"].bge_object.velocity()]
    assert repr(now) == repr(later)


# laser scanners -----------------------------------------------------------------------------------


def scanners():
    from morse.builder import Environment, Hokuyo, Infrared, Morsy, MotionVW, Sick

    for number in range(COUNT):
        robot = Morsy(f"r{number}")
        robot.translate(2.0 * number, 0.3 * number, 0.0)
        robot.append(MotionVW("motion"))
        for kind, name, level in ((Sick, "sick", "raw"), (Infrared, "infrared", "raw"), (Hokuyo, "hokuyo", "range")):
            scanner = kind(name)
            scanner.level(level)
            scanner.translate(0.2, 0.0, 0.3)
            robot.append(scanner)
        rssi = Sick("rssi")
        rssi.level("rssi")
        robot.append(rssi)
    Environment("indoors-1/boxes", fastmode=True)


def test_scans_are_the_same_whether_they_are_measured_in_each_tick_or_when_read():
    def seen(reader=None):
        found = []
        with morse.load(scanners) as simulation:
            if reader is not None:
                reader(simulation)
            for tick in range(90):
                drive(simulation, tick)
                simulation.step(1)
                if tick == 50:
                    named(simulation, "r1.sick").set_property("scan_window", 90.0)
                if tick % 7 == 0:
                    found += [
                        {
                            key: np.asarray(value).copy()
                            for key, value in getattr(getattr(simulation, f"r{number}"), name).data.items()
                        }
                        for number in range(COUNT)
                        for name in ("sick", "infrared", "hokuyo", "rssi")
                    ]
            return found, simulation.state_hash()

    waiting, state = seen()
    always, other = seen(touch)
    assert state == other
    for one, two in zip(waiting, always, strict=True):
        assert one.keys() == two.keys()
        assert all(np.array_equal(one[key], two[key]) for key in one)
    assert {len(one["range_list"]) for one in waiting} >= {91, 181, 21, 1081}
    assert any((one["range_list"] < 5.0).any() for one in waiting)


def test_a_scan_that_was_read_stays_as_it_was():
    with morse.load(scanners) as simulation:
        simulation.step(1)
        kept = named(simulation, "r0.sick").local_data["range_list"]
        before = kept.copy()
        named(simulation, "r0.motion").local_data.update(v=1.0, w=1.0)
        simulation.step(60)
        assert np.array_equal(kept, before)
        assert not np.array_equal(named(simulation, "r0.sick").local_data["range_list"], before)
