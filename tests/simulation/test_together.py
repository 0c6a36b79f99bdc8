"""Components that act together are bit-identical to components that act alone; all readers see their data."""

from __future__ import annotations

import copy
import json
import logging
import math
import pickle
from typing import TYPE_CHECKING

import msgspec
import numpy as np
import pytest

import morse
from morse.core.sensor import Sensor
from morse.sensors.laserscanner import LaserScanner
from morse.simulation.ticks.together import Together

if TYPE_CHECKING:
    from morse.core.groups.group import Group

COUNT = 4


def scene(extra=""):
    def describe():
        from morse.builder import Environment, FakeRobot, Morsy, MotionVW, MotionXYW, Odometry, Pose, Robot  # noqa: F401

        for number in range(COUNT):
            robot = Morsy(f"r{number}") if number % 2 else Robot(name=f"r{number}")
            robot.translate(3.0 * number, 0.5, 0.0)
            robot.append(MotionXYW("motion") if extra == "sideways" else MotionVW("motion"))
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


def groups(sim):
    return [unit for unit in sim._ticker._groups if unit._group is not None]


@pytest.mark.parametrize("extra", ["", "sideways", "rates"])
@pytest.mark.parametrize("kernel", ["", "off"])
def test_bits_are_those_of_components_that_act_alone(monkeypatch, extra, kernel):
    with morse.load(scene(extra)) as simulation:
        assert {len(unit._group) for unit in groups(simulation)} == {COUNT}
        together = hashes(simulation, 200)
    monkeypatch.setenv("MORSE_FLEETS", "off")
    if kernel:
        from morse.kernel import loading

        loading.library.cache_clear()
        monkeypatch.setenv("MORSE_KERNEL", kernel)
    try:
        with morse.load(scene(extra)) as simulation:
            assert not groups(simulation)
            assert hashes(simulation, 200) == together
    finally:
        if kernel:
            loading.library.cache_clear()


def test_readers_change_nothing():
    def read(simulation, tick):
        if tick % 3 == 0:
            named(simulation, "r1.odometry").local_data["x"]
        if tick % 7 == 0:
            simulation.save()

    with morse.load(scene()) as one, morse.load(scene()) as two:
        assert hashes(one, 100) == hashes(two, 100, read)


def test_save_and_restore_in_the_middle(sim):
    hashes(sim, 50)
    state = sim.save()
    expected = hashes(sim, 100)
    sim.restore(state)
    assert hashes(sim, 100) == expected
    with morse.load(scene()) as other:
        other.restore(state)
        assert hashes(other, 100) == expected


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
    assert pose.group is not None
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


# classes of users ----------------------------------------------------------------------------------


class Height(Sensor):
    """Measures the height of a sensor; as the documentation has it."""

    _name = "Height"

    def default_action(self):
        self.local_data["timestamp"] = self.position_3d.z

    @classmethod
    def act_together(cls, group):
        raise ZeroDivisionError("the class is wrong")


class Lower(Height):
    def default_action(self):
        pass


def test_a_subclass_that_acts_differently_acts_alone():
    from morse.core.groups.joining import has_group_action
    from morse.sensors.odometry import IntegratedOdometry, Odometry, RawOdometry
    from morse.sensors.pose import Pose

    class Same(Pose):
        """Only another name."""

    class Different(Pose):
        def default_action(self):
            super().default_action()

    assert [has_group_action(c) for c in (Pose, Same, Different, Height, Lower)] == [True, True, False, True, False]
    assert [has_group_action(c) for c in (IntegratedOdometry, Odometry, RawOdometry)] == [True, False, False]


def test_a_class_whose_group_action_is_wrong_is_told_of_and_acts_one_by_one(sim, caplog, monkeypatch):
    from morse.sensors.pose import Pose

    monkeypatch.setattr(Pose, "act_together", classmethod(lambda cls, group: 1 / 0))
    with caplog.at_level(logging.ERROR):
        sim.step(5)
    (record,) = caplog.records
    assert "act_together of Pose failed" in record.getMessage()
    assert all(named(sim, f"r{n}.pose").local_data["timestamp"] == sim.clock.time for n in range(COUNT))


def test_arrays_are_read_row_by_row(sim):
    members = [named(sim, f"r{n}.pose") for n in range(COUNT)]
    sim.step(1)
    (unit,) = [unit for unit in groups(sim) if type(unit.members[0]).__name__ == "Pose"]
    group: Group = unit._group
    positions, rotations = group.poses.positions(), group.poses.rotations()
    for row, member in enumerate(members):
        assert positions[row].tolist() == list(member.bge_object.worldPosition)
        assert rotations[row].tolist() == [pytest.approx(list(r)) for r in member.bge_object.worldOrientation]
    group.write(("x", "y"), positions[:, :2] + 100.0)
    assert members[2].local_data["x"] == positions[2, 0] + 100.0
    with pytest.raises(ValueError, match="shape"):
        group.write(("x", "y"), positions)


def test_profiles_name_groups(sim):
    from morse.simulation.ticks.profile import Profile

    profile = Profile()
    sim._ticker.component_profiles.append(profile)
    sim.step(2)
    assert {f"{COUNT} x Pose", f"{COUNT} x MotionVW", f"{COUNT} x IntegratedOdometry"} <= profile.components.keys()
    assert all(isinstance(unit, Together) for unit in groups(sim))


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


def scan(sim, name):
    data = named(sim, name).local_data
    return {key: np.asarray(data[key]).copy() for key in data}


def test_scanners_of_one_level_act_together_with_the_same_bits(monkeypatch):
    def seen():
        found = []
        with morse.load(scanners) as simulation:
            units = {(type(unit.members[0]), unit.members[0].level): len(unit._group) for unit in groups(simulation)}
            for tick in range(90):
                drive(simulation, tick)
                simulation.step(1)
                if tick == 50:
                    named(simulation, "r1.sick").set_property("scan_window", 90.0)
                if tick % 7 == 0:
                    found += [
                        scan(simulation, f"r{number}.{name}")
                        for number in range(COUNT)
                        for name in ("sick", "infrared", "hokuyo", "rssi")
                    ]
            return units, found, simulation.state_hash()

    units, together, state = seen()
    assert units[LaserScanner, "raw"] == 2 * COUNT
    assert units[LaserScanner, "range"] == COUNT
    assert (LaserScanner, "rssi") not in units
    monkeypatch.setenv("MORSE_FLEETS", "off")
    units, alone, other = seen()
    assert not units
    assert state == other
    for one, two in zip(together, alone, strict=True):
        assert one.keys() == two.keys()
        assert all(np.array_equal(one[key], two[key]) for key in one)
    assert {len(one["range_list"]) for one in together} >= {91, 181, 21, 1081}
    assert any((one["range_list"] < 5.0).any() for one in together)


def test_a_scan_that_was_read_stays_as_it_was():
    with morse.load(scanners) as simulation:
        simulation.step(1)
        kept = named(simulation, "r0.sick").local_data["range_list"]
        before = kept.copy()
        named(simulation, "r0.motion").local_data.update(v=1.0, w=1.0)
        simulation.step(60)
        assert np.array_equal(kept, before)
        assert not np.array_equal(named(simulation, "r0.sick").local_data["range_list"], before)


# inertial sensors and GPS ----------------------------------------------------------------------------


def travellers():
    from morse.builder import GPS, IMU, Environment, FakeRobot, Morsy, MotionVW

    for number in range(COUNT + 1):
        robot = FakeRobot(f"r{number}") if number == COUNT else Morsy(f"r{number}")
        robot.translate(2.0 * number, 0.3 * number, 0.0)
        robot.append(MotionVW("motion"))
        imu, gps = IMU("imu"), GPS("gps")
        imu.translate(0.2 * (number % 2), 0.1, 0.3)
        imu.rotate(0.0, 0.2, 0.1)
        gps.translate(0.0, 0.1, 0.5)
        robot.append(imu)
        robot.append(gps)
    Environment("indoors-1/boxes", fastmode=True)


def test_inertial_units_and_receivers_act_together_with_the_same_bits(monkeypatch):
    def seen():
        found = []
        with morse.load(travellers) as simulation:
            units = {type(unit.members[0]).__name__: len(unit._group) for unit in groups(simulation)}
            for tick in range(200):
                drive(simulation, tick)
                simulation.step(1)
                if tick == 60:
                    named(simulation, "r1.imu").set_property("GyroNoiseDensity", 0.01)
                if tick == 120:
                    named(simulation, "r1.imu").set_property("GyroNoiseDensity", 0.0)
                if tick % 9 == 0:
                    names = [f"r{number}.{kind}" for number in range(COUNT + 1) for kind in ("imu", "gps")]
                    found += [dict(named(simulation, name).local_data) for name in names]
                if tick % 40 == 0:
                    found.append(simulation.state_hash())
            after = {type(unit.members[0]).__name__: len(unit._group) for unit in groups(simulation)}
            return units, after, found

    units, after, together = seen()
    assert units["IMU"] == after["IMU"] == COUNT
    assert units["GPS"] == COUNT + 1
    monkeypatch.setenv("MORSE_FLEETS", "off")
    units, _, alone = seen()
    assert not units
    assert together == alone
