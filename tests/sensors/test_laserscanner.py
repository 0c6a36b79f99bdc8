"""Laser scanners against rooms and objects with distances known from geometry."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from messages import angle_of, published

from morse.core.exceptions import MorseRPCInvokationError, MorseRPCTypeError
from morse.helpers.fans import MOST_RAYS, fan
from morse.scene import Material
from morse.wire.encoding import to_json

WALLS = """
def wall(name, x, y, sx, sy, height=4):
    made = Cube(name)
    made.scale = (sx / 2, sy / 2, height / 2)
    made.location = (x, y, 0)
    made._bpy_object.game.physics_type = "STATIC"
    return made

wall("East", 4.1, 0, 0.2, 20)
wall("North", 0, 3.1, 20, 0.2)
wall("South", 0, -5.1, 20, 0.2)
wall("West", -6.1, 0, 0.2, 20)
"""
ROBOT = """
robot = FakeRobot()
laser = {kind}()
{setting}
robot.append(laser)
env = Environment("empty", fastmode=True)
"""


def in_room(kind="Sick", setting="", walls=WALLS):
    return walls + ROBOT.format(kind=kind, setting=setting)


def room_distance(degrees):
    """From the origin to the walls of the room."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    ways = [4 / c if c > 1e-12 else math.inf, -6 / c if c < -1e-12 else math.inf]
    ways += [3 / s if s > 1e-12 else math.inf, -5 / s if s < -1e-12 else math.inf]
    return min(ways)


def test_a_sick_sees_the_walls_from_right_to_left(simulate):
    simulation = simulate(in_room(), sockets=False)
    simulation.sleep(0.1)
    laser = simulation.context.component("robot.laser")
    ranges, points = laser.local_data["range_list"], laser.local_data["point_list"]
    assert len(ranges) == len(points) == 181
    assert ranges == pytest.approx([room_distance(i - 90) for i in range(181)], abs=1e-5)
    assert points[0] == pytest.approx([0, -5, 0], abs=1e-5)
    assert points[90] == pytest.approx([4, 0, 0], abs=1e-5)
    assert points[180] == pytest.approx([0, 3, 0], abs=1e-5)
    assert [angle_of(p) for p in points] == pytest.approx([i - 90 for i in range(181)], abs=1e-4)


def test_the_data_are_arrays_that_can_be_read_as_lists_and_are_lists_on_the_wire(simulate):
    simulation = simulate(in_room("Hokuyo", "laser.level('rssi')"), sockets=False)
    simulation.sleep(0.1)
    data = simulation.context.component("robot.laser").local_data
    written = to_json(data)
    ranges, points = data["range_list"], data["point_list"]
    assert (ranges.shape, points.shape, data["remission_list"].shape) == ((1081,), (1081, 3), (1081,))
    assert written == json.dumps({name: v if name == "timestamp" else v.tolist() for name, v in data.items()}).encode()
    assert len(ranges) == len([distance for distance in ranges]) == 1081  # noqa: C416 - it is read as a list
    assert min(ranges) == sorted(ranges)[0] == min(json.loads(written)["range_list"])
    x, y, z = points[540]
    assert math.hypot(x, y, z) == pytest.approx(ranges[540])


@pytest.mark.parametrize(
    ("kind", "rays", "first", "reach", "rate"),
    [
        ("LaserScanner", 181, -90.0, 30.0, 10),
        ("Sick", 181, -90.0, 30.0, 10),
        ("Hokuyo", 1081, -135.0, 30.0, 10),
        ("Infrared", 21, -10.0, 2.0, 10),
        ("SickLDMRS", 4 * 401, -50.0 + 0.125, 30.0, 4),
    ],
)
def test_presets(simulate, kind, rays, first, reach, rate):
    simulation = simulate(in_room(kind), sockets=False)
    laser = simulation.context.component("robot.laser")
    messages = published(laser)
    simulation.sleep(1.0)
    assert len(messages) == rate
    assert len(messages[0]["range_list"]) == rays
    assert angle_of(laser.rays.directions[0]) == pytest.approx(first)
    assert laser.laser_range == reach
    if kind == "Infrared":
        assert messages[0]["range_list"].tolist() == [2.0] * 21
        assert messages[0]["point_list"].tolist() == [[0, 0, 0]] * 21


def test_nothing_within_reach_is_no_hit(simulate):
    simulation = simulate(in_room(setting="laser.properties(laser_range=4.5)"), sockets=False)
    simulation.sleep(0.1)
    laser = simulation.context.component("robot.laser")
    ranges, points = laser.local_data["range_list"], laser.local_data["point_list"]
    expected = [room_distance(i - 90) for i in range(181)]
    assert ranges == pytest.approx([min(d, 4.5) for d in expected], abs=1e-5)
    assert [p == [0, 0, 0] for p in points.tolist()] == [d > 4.5 for d in expected]


def test_levels_have_their_fields(simulate):
    for level, fields in [("raw", 2), ("rssi", 3), ("range", 1)]:
        simulation = simulate(in_room(setting=f"laser.level('{level}')"), sockets=False)
        simulation.sleep(0.1)
        data = simulation.context.component("robot.laser").local_data
        assert next(iter(data)) == "timestamp"
        names = {"range": {"range_list"}, "raw": {"range_list", "point_list"}}
        assert set(data) - {"timestamp"} == names.get(level, names["raw"] | {"remission_list"})
        assert len(data) == fields + 1
        assert all(len(data[name]) == 181 for name in set(data) - {"timestamp"})


def test_remission_is_that_of_the_material_where_there_is_an_echo(simulate):
    setting = "laser.level('rssi'); laser.properties(laser_range=4.5)"
    simulation = simulate(in_room(setting=setting), sockets=False)
    simulation.sleep(0.1)
    data = simulation.context.component("robot.laser").local_data
    expected = [Material("new").specular if room_distance(i - 90) <= 4.5 else 0.0 for i in range(181)]
    assert data["remission_list"].tolist() == expected


def test_the_scanner_is_where_and_how_it_is_mounted(simulate):
    setting = "laser.translate(1, 0, 0.5); laser.rotate(0, 0, math.pi / 2)"
    simulation = simulate(in_room(setting=setting), sockets=False)
    simulation.sleep(0.1)
    laser = simulation.context.component("robot.laser")
    # it faces north; its right is east
    ranges = laser.local_data["range_list"]
    assert [ranges[0], ranges[90], ranges[180]] == pytest.approx([3.0, 3.0, 7.0], abs=1e-5)
    assert laser.local_data["point_list"][90] == pytest.approx([3, 0, 0], abs=1e-5)


def test_layers_lie_above_each_other_and_every_other_one_is_turned(simulate):
    setting = "laser.properties(layers=3, layer_separation=10.0, layer_offset=0.5, scan_window=2.0)"
    simulation = simulate(in_room(setting=setting), sockets=False)
    simulation.sleep(0.1)
    laser = simulation.context.component("robot.laser")
    points = laser.local_data["point_list"]
    assert len(points) == 9
    heights = [math.degrees(math.atan2(z, math.hypot(x, y))) for x, y, z in points]
    assert heights == pytest.approx([10] * 3 + [0] * 3 + [-10] * 3)
    assert [angle_of(p) for p in points] == pytest.approx([-0.5, 0.5, 1.5, -1, 0, 1, -0.5, 0.5, 1.5])


def test_a_velodyne_turns_its_upright_fan(simulate):
    simulation = simulate(in_room("VelodyneRayCast"), sockets=False)
    laser = simulation.context.component("robot.laser")
    simulation.sleep(0.1)
    points = laser.local_data["point_list"]
    assert len(points) == 64
    assert {round(angle_of(p), 6) for p in points if p.any()} == {0.0}
    heights = [math.degrees(math.asin(z)) for _, _, z in laser.rays.directions]
    assert (heights[0], heights[-1]) == pytest.approx((-27.75, 3.75))
    simulation.sleep(1.9)
    # twenty measurements at 10 Hz
    yaw = laser.bge_object.worldOrientation.to_euler().z
    assert yaw == pytest.approx(20 * 0.01745)


def test_properties_may_be_changed_while_it_runs(simulate):
    simulation = simulate(in_room(), sockets=False)
    laser = simulation.context.component("robot.laser")
    simulation.sleep(0.1)
    laser.set_property("laser_range", 3.5)
    laser.set_property("resolution", 10.0)
    simulation.sleep(0.1)
    expected = [min(room_distance(10 * i - 90), 3.5) for i in range(19)]
    assert laser.local_data["range_list"] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("laser_range", 0.0),
        ("laser_range", -1.0),
        ("laser_range", math.inf),
        ("laser_range", math.nan),
        ("resolution", 0.0),
        ("resolution", 1e-9),
        ("scan_window", 361.0),
        ("scan_window", -1.0),
        ("layers", 0),
        ("layer_separation", math.inf),
        ("layer_offset", math.inf),
    ],
)
def test_a_property_that_makes_no_fan_is_refused_and_nothing_changes(simulate, name, value):
    simulation = simulate(in_room(setting="laser.properties(layers=2)"), sockets=False)
    laser = simulation.context.component("robot.laser")
    with pytest.raises(MorseRPCTypeError, match=name):
        laser.set_property(name, value)
    simulation.sleep(0.1)
    assert len(laser.local_data["range_list"]) == 362


def test_a_script_that_makes_no_fan_is_told_so(simulate):
    with pytest.raises(
        Exception, match=r"scan_window' of LaserScanner is 400.0, expected a number from 0 to 360 deg"
    ) as caught:
        simulate(in_room(setting="laser.properties(scan_window=400.0); laser.create_laser_arc()"), sockets=False)
    assert "laser" in str(caught.value).lower()
    with pytest.raises(Exception, match=r"resolution"):
        simulate(in_room(setting="laser.properties(resolution=-0.5)"), sockets=False)


def test_scanners_of_several_robots_see_each_other_but_not_their_own_robot(simulate):
    script = """
for i in range(3):
    robot = Robot(name=f"r{i}")
    body = Cylinder(f"body{i}")
    body.scale = (0.3, 0.3, 0.5)
    body._bpy_object.game.physics_type = "RIGID_BODY"
    body._bpy_object.game.collision_bounds_type = "CYLINDER"
    body._bpy_object.game.use_collision_bounds = True
    robot.append(body)
    robot.set_rigid_body()
    robot.properties(NoGravity=True)
    robot.translate(3.0 * i, 0, 5)
    laser = Sick(f"laser{i}")
    robot.append(laser)
env = Environment("empty", fastmode=True, component_renaming=False)
"""
    simulation = simulate(script, sockets=False)
    simulation.sleep(0.1)
    seen = [simulation.context.component(f"laser{i}").local_data["range_list"][90] for i in range(3)]
    assert seen == pytest.approx([2.7, 2.7, 30.0], abs=1e-3)
    # the edge of the next robot is at asin(0.3 / 3) = 5.74 degrees
    hits = [i - 90 for i, d in enumerate(simulation.context.component("laser0").local_data["range_list"]) if d < 30]
    assert hits == list(range(-5, 6))


def test_boxes_of_the_indoor_environment(simulate):
    """The red box stands 1 m wide around (-7.5, 0), 1.8 m high."""
    script = """
robot = FakeRobot()
robot.translate(-5, 0, 0.5)
robot.rotate(0, 0, math.pi)
laser = Sick()
robot.append(laser)
env = Environment("indoors-1/boxes", fastmode=True)
"""
    simulation = simulate(script, sockets=False)
    simulation.sleep(0.1)
    ranges = simulation.context.component("robot.laser").local_data["range_list"]
    assert ranges[90] == pytest.approx(2.0, abs=0.02)
    # half of its width under atan(0.5 / 2) = 14.04 degrees
    near = [i - 90 for i, d in enumerate(ranges) if d < 2.2]
    assert near == list(range(-14, 15))
    assert [ranges[90 + d] for d in near] == pytest.approx([2.0 / math.cos(math.radians(d)) for d in near], abs=0.02)


def test_a_robot_made_by_a_user_may_have_rays_of_its_own(simulate, tmp_path, monkeypatch):
    """A user's sensor: two eyes, 10 cm apart."""
    (tmp_path / "my_eyes.py").write_text(
        "from morse.core.sensor import Sensor\n"
        "from morse.helpers.components import add_data\n"
        "class Eyes(Sensor):\n"
        "    _name = 'Eyes'\n"
        "    add_data('left', 0.0, 'float', 'm')\n"
        "    add_data('what', '', 'string', 'name')\n"
        "    def __init__(self, obj, parent=None):\n"
        "        super().__init__(obj, parent)\n"
        "        self.add_rays([[1, 0.5, 0], [1, 0, 0]], 20.0, origins=[[0, 0.1, 0], [0, -0.1, 0]])\n"
        "    def default_action(self):\n"
        "        self.local_data['left'] = float(self.rays.distances[0])\n"
        "        self.local_data['what'] = self.rays.object_of(1).name\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    script = WALLS + "robot = FakeRobot()\neyes = SensorCreator()\neyes.morseable('my_eyes.Eyes')\nrobot.append(eyes)\n"
    simulation = simulate(script + "env = Environment('empty', fastmode=True)\n", sockets=False)
    simulation.sleep(0.1)
    data = simulation.context.component("robot.eyes").local_data
    assert data["left"] == pytest.approx(4.0 * math.hypot(1, 0.5), abs=1e-5)
    assert data["what"] == "East"


def test_a_sensor_of_a_user_may_use_our_names_for_its_own_things(simulate, tmp_path, monkeypatch):
    (tmp_path / "my_sonar.py").write_text(
        "from morse.core.sensor import Sensor\n"
        "from morse.helpers.components import add_data\n"
        "class Sonar(Sensor):\n"
        "    add_data('sum', 0, 'int', '')\n"
        "    def __init__(self, obj, parent=None):\n"
        "        super().__init__(obj, parent)\n"
        "        self.rays, self.phase, self.delay, self.noise = 12, 'warm', 3, None\n"
        "    def default_action(self):\n"
        "        self.local_data['sum'] += self.rays\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    script = "robot = FakeRobot()\nsonar = SensorCreator()\nsonar.morseable('my_sonar.Sonar')\nrobot.append(sonar)\n"
    simulation = simulate(script + "env = Environment('empty', fastmode=True)\n", sockets=False)
    simulation.sleep(0.1)
    assert simulation.context.component("robot.sonar").local_data["sum"] == 72


# -- fans ----------------------------------------------------------------------------------


@given(st.floats(0, 360), st.floats(0.1, 50), st.integers(1, 5), st.floats(0, 20), st.floats(-5, 5))
def test_fans(window, resolution, layers, separation, offset):
    rays = fan(window, resolution, layers, separation, offset)
    assert len(rays) % layers == 0
    count = len(rays) // layers
    assert (count - 1) * resolution <= window + 1e-6 < count * resolution + 2e-6
    assert (rays**2).sum(axis=1) == pytest.approx([1.0] * len(rays))
    heights = [math.degrees(math.asin(max(-1, min(1, z)))) for z in rays[::count, 2]]
    assert heights == pytest.approx([separation * ((layers - 1) / 2 - k) for k in range(layers)], abs=1e-5)


def test_fans_are_inclusive_in_spite_of_rounding():
    assert len(fan(31.5, 0.1)) == 316
    assert len(fan(0.3, 0.1)) == 4
    assert len(fan(0.0, 1.0)) == 1


def test_a_fan_of_too_many_rays():
    with pytest.raises(ValueError, match="too many rays"):
        fan(360, 360 / MOST_RAYS)


def test_clients_set_no_more_rays_than_a_tick_casts(simulate):
    scene = simulate(in_room("Hokuyo"), sockets=False)
    laser = scene.context.component("robot.laser")
    with pytest.raises(MorseRPCInvokationError, match="a ray counts as 16 pixels"):
        laser.set_property("resolution", 0.001)
    assert laser.resolution == 0.25
    laser.set_property("resolution", 0.01)
    scene.sleep(0.1)
    assert len(laser.local_data["range_list"]) == 27001


def test_a_vlp16_sees_the_whole_circle_at_once(simulate):
    """16 layers 2 degrees apart, as in the manual of the VLP-16; each scan is complete, in the same frame."""
    simulation = simulate(in_room("VLP16", "robot.translate(z=1.0)"), sockets=False)
    before = simulation.world.objects_by_name["robot.laser"].world_pose()
    simulation.step(20)
    points = np.asarray(simulation.robot.laser.get()["point_list"]).reshape(16, 1800, 3)
    assert simulation.world.objects_by_name["robot.laser"].world_pose() == before
    seen = np.linalg.norm(points, axis=2) > 0.0
    assert seen[7:9].all()  # the layers next to the horizon end at the walls, in all directions
    azimuth = np.degrees(np.arctan2(points[8, :, 1], points[8, :, 0]))
    assert np.sort(azimuth) == pytest.approx(np.arange(1800) * 0.2 - 179.9, abs=1e-6)
    down = points[15][seen[15]]
    assert np.degrees(np.arctan2(-down[:, 2], np.hypot(down[:, 0], down[:, 1]))) == pytest.approx(15.0, abs=1e-6)
    assert points[8, 900, 0] == pytest.approx(4.0, abs=0.01)
