"""Every example works as described. The values are those of geometry and physics."""

import math
import re
from pathlib import Path

import pytest

from morse.cli.demo import examples

pytestmark = pytest.mark.long

TESTED = set()


def example_test(name):
    """Mark a function as the test of an example."""
    TESTED.add(name)
    return lambda function: function


def test_each_example_is_tested_described_and_shown():
    found = examples()
    assert len(found) >= 15
    assert set(found) == TESTED
    page = Path(__file__).parents[2].joinpath("docs", "examples.md").read_text(encoding="utf-8")
    for each in found.values():
        assert each.what.endswith((".", "?")), each.name
        assert each.client.is_file()
        assert f"(pictures/examples/{each.name}.webp)" in page
        assert each.what in page


@pytest.mark.parametrize("page", ["README.md", "docs/index.md", "docs/tutorial.md"])
def test_pages_say_how_many_examples_there_are(page):
    text = Path(__file__).parents[2].joinpath(page).read_text(encoding="utf-8")
    assert {int(number) for number in re.findall(r"(\d+) scenes", text)} == {len(examples())}


@example_test("drive")
def test_drive(run):
    by_wheels, in_world = run("drive")
    # a square of 1 m ends at its start, except for the stopping distances
    assert math.hypot(*by_wheels) < 0.25
    # odometry of wheels without slip is exact
    assert math.dist(by_wheels, in_world) < 0.03


@example_test("waypoints")
def test_waypoints(run):
    visited = run("waypoints")
    for place, wanted in zip(visited, [(8.0, 0.0), (8.0, 5.0), (0.0, 5.0)], strict=True):
        assert math.dist(place, wanted) < 0.8


@example_test("laser")
def test_laser(run):
    way, nearest = run("laser", 2.0)
    assert way > 4.0
    # the scanner is 0.2 m behind the bumper of the robot
    assert nearest > 0.35


@example_test("mapping")
def test_mapping(run):
    hits = run("mapping")
    # the red and the blue box of that hall, and its wall at y = 14
    for x, y in ((-7, 0), (-4, -4)):
        assert any(abs(column - x) <= 1 and abs(row - y) <= 1 for column, row in hits)
    assert sum(count for (_, row), count in hits.items() if row in (13, 14)) > 40
    assert not any(-2 <= column <= 2 and -1 <= row <= 1 for column, row in hits)


@example_test("camera")
def test_camera(run):
    x, y = run("camera", 2.0)
    # in front of the ball at (8, 2.5), and on the way to it
    assert 1.0 < math.dist((x, y), (8.0, 2.5)) < 5.0
    assert math.atan2(y, x) == pytest.approx(math.atan2(2.5, 8.0), abs=0.12)


@example_test("depth")
def test_depth(run):
    left, right = run("depth")
    # the camera is 0.56 m ahead of the robot, the faces of the crates 2.5 and 4.0 m
    assert left == pytest.approx(2.5 - 0.56, abs=0.02)
    assert right == pytest.approx(4.0 - 0.56, abs=0.02)


@example_test("semantic")
def test_semantic(run):
    assert run("semantic", 2.0) == {"Jam": "Food", "Milk": "Food", "Knife": "Cutlery"}


@example_test("quadrotor")
def test_quadrotor(run):
    errors = run("quadrotor")
    assert len(errors) == 5
    # 0.3 m, and the distance until the client asks
    assert max(errors) < 0.8


@example_test("imu")
def test_imu(run):
    error, to_the_left = run("imu", math.inf)
    # v w, the centripetal acceleration on a circle
    assert to_the_left == pytest.approx(1.0 * 0.5, abs=0.02)
    # 0.014 deg/s per root Hz over 8 s is 7e-4 rad; with its bias, several times as much
    assert 0.0 < abs(error) < 0.03


@example_test("gps")
def test_gps(run):
    assert run("gps", 2.0) < 0.5


@example_test("gripper")
def test_gripper(run):
    held, carried = run("gripper", 2.0)
    assert held == "tape"
    # a quarter turn at 1 m from the centre of the robot moves it by the square root of 2
    assert carried == pytest.approx(math.sqrt(2.0), abs=0.35)


@example_test("legs")
def test_legs(run):
    walked, torque = run("legs", math.inf)
    assert walked > 0.8
    # a quarter of 12 kg, less the shin, is ahead of the knee by 0.22 m times the sine of the angle of the thigh
    lever = 0.22 * math.sin(math.acos(0.36 / 0.44))
    assert torque == pytest.approx((12.0 / 4.0 - 0.15) * 9.81 * lever, rel=0.1)


@example_test("ptu")
def test_ptu(run):
    seen = run("ptu")
    for pan, x, y in seen:
        # the head is 0.2 m ahead of the robot, which stands at the origin
        assert pan == pytest.approx(math.atan2(y, x - 0.2), abs=0.02)
    assert seen[2][1] > seen[0][1] + 1.0


@example_test("lights")
def test_lights(run):
    left, back = run("lights", 2.0)
    # 0.5 rad/s for two seconds, and for as long back
    assert left == pytest.approx(1.0, abs=0.3)
    assert back == pytest.approx(0.0, abs=0.5)


@example_test("swarm")
def test_swarm(run):
    radii, gaps = run("swarm", math.inf)
    assert radii == pytest.approx([4.0] * 9, abs=0.05)
    assert gaps == pytest.approx([math.tau / 9] * 9, abs=0.1)


@example_test("submarine")
def test_submarine(run):
    # F = C v^2
    assert run("submarine") == pytest.approx(math.sqrt(50.0 / 8.0), rel=0.01)


@example_test("car")
def test_car(run):
    fast, turned, at_the_end = run("car", 2.0)
    assert fast > 2.5
    # v tan(steer) / wheelbase, for two seconds and the latency of the client
    assert turned == pytest.approx(2.0 * 3.1 * math.tan(0.3) / 3.9, rel=0.3)
    assert at_the_end < 0.05


@example_test("rescue")
def test_rescue(run):
    assert run("rescue") == ["victim1", "victim2"]


@example_test("battery")
def test_battery(run):
    low, arrived, left = run("battery", 2.0)
    assert 0.0 < arrived < low <= 50.0
    assert left >= 80.0


@example_test("noise")
def test_noise(run):
    deviation, (x, y, z), (north, east, down) = run("noise", math.inf)
    # 600 samples: three standard errors of a standard deviation are 3 / sqrt(1200) of it
    assert deviation == pytest.approx(0.1, rel=0.09)
    assert (north, east, down) == pytest.approx((y, x, -z))


@example_test("repeatable")
def test_repeatable(run):
    assert run("repeatable", math.inf) == (True, False)


@example_test("human")
def test_human(run):
    taken, way, joints = run("human")
    assert taken is True
    # from the table to the place where the walk began, within the tolerances of both ways
    assert 1.5 < way < 3.2
    # the raised arm: the upper arm is far above the horizontal
    assert joints["shoulder01_L"] > 1.0


@example_test("pr2")
def test_pr2(run):
    torso, joints, (x, y) = run("pr2")
    assert torso == pytest.approx(0.2, abs=1e-6)
    assert joints["l_shoulder_pan_joint"] == pytest.approx(1.2, abs=0.02)
    assert joints["r_shoulder_pan_joint"] == pytest.approx(-1.2, abs=0.02)
    # 0.5 m/s for 2 s, and at most for the time until the next command is heard
    assert x == pytest.approx(0.0, abs=0.02)
    assert 0.95 < y < 1.5


@example_test("crossroads")
def test_crossroads(run):
    (x, y), nearest, state = run("crossroads", 2.0)
    assert (x, y) == pytest.approx((6.5, 5.6), abs=0.5)
    assert state == "red"
    # the cars wait at their stop lines
    assert nearest > 1.5


@pytest.mark.slow
@example_test("hospital")
def test_hospital(run):
    x, y, z = run("hospital")
    assert math.dist((x, y), (7.0, 0.0)) < 0.3
    # on the upper floor
    assert z == pytest.approx(3.5, abs=0.02)


@pytest.mark.slow
@example_test("mall")
def test_mall(run):
    met, shop, robot = run("mall")
    # the visitor waited at the entrance, and is in the shop; the robot is back at its desk
    assert met[0] < -17.0
    assert math.dist(shop, (3.0, 8.5)) < 1.0
    assert math.dist(robot, (-18.0, -0.8)) < 0.4


@example_test("warehouse")
def test_warehouse(run):
    load, (x, y, z) = run("warehouse")
    # a pallet of 25 kg with three boxes of 80 kg
    assert load == pytest.approx(265.0, rel=0.02)
    # the belt is 0.5 m high, and has carried the pallet from y = -3.1 at 0.4 m/s for six seconds
    assert z == pytest.approx(0.5, abs=0.01)
    assert x == pytest.approx(0.5, abs=0.1)
    assert y == pytest.approx(-3.1 - 0.4 * 6.0, abs=0.4)


@example_test("depot")
def test_depot(run):
    places = run("depot")
    for (x, y, z), bay in zip(places, [(6.0, -2.0), (6.0, -3.5), (6.0, -5.0)], strict=True):
        assert math.dist((x, y), bay) < 0.6
        assert z == pytest.approx(0.1, abs=0.02)
