"""Traffic: cars drive as the models of the literature say, brake for others, are seen, and take no wrong values."""

import cmath
import math
import re

import numpy as np
import pytest

import morse
from morse.core.state import StateError
from morse.plugins.traffic.driving import Driver, advance
from morse.plugins.traffic.roads import Road
from tests.kit.scenes import Load, script

GROUND = """
ground = Cube("ground")
ground.scale = (400.0, 400.0, 0.5)
ground.translate(z=-0.5)
ground.static()
"""
EMPTY = '\nenv = Environment("empty")\n'
ROBOT = """
robot = ATRV()
robot.translate({place}, 0.2)
motion = MotionVW()
robot.append(motion)
"""
#: 400 m, of straight parts and corners
RING = "[(0, 0), (150, 0), (150, 50), (0, 50)]"


def until(simulation, condition, seconds: float = 60.0) -> None:
    for _ in range(int(seconds * 60)):
        if condition():
            return
        simulation.step(1)
    raise AssertionError("the condition did not come true")


def bumpers(data, road: int = 0, length: float = 4.6) -> np.ndarray:
    """The gaps between cars that follow each other on a lane of an open road, m."""
    gaps = []
    for lane in np.unique(data["lanes"]):
        fronts = np.sort(data["places"][(data["roads"] == road) & (data["lanes"] == lane) & data["present"]])
        gaps.append(np.diff(fronts) - length)
    return np.concatenate(gaps)


@pytest.mark.parametrize("count", [10, *(pytest.param(n, marks=pytest.mark.slow) for n in (16, 40))])
def test_a_steady_stream_has_the_equilibrium_gap(load: Load, count: int):
    """On a ring, s_e(v) = (s0 + v T) / sqrt(1 - (v / v0)^4), with the parameters of Treiber et al. 2000."""
    simulation = load(f"cars = Traffic()\ncars.road('ring', {RING}, {count}, closed=True, speed=20.0)" + EMPTY)
    simulation.step(60 * 240)
    data = simulation.cars.data
    gap = 400.0 / count - 4.6
    speed = float(data["speeds"].mean())
    assert np.ptp(data["speeds"]) < 0.1
    assert (2.0 + 1.6 * speed) / math.sqrt(1.0 - (speed / 20.0) ** 4) == pytest.approx(gap, rel=0.02)


@pytest.mark.parametrize(("acceleration", "grows"), [(0.73, True), (3.0, False)])
def test_disturbances_grow_or_shrink_as_linear_theory_says(acceleration: float, grows: bool):
    """The gain from car to car, (f_s + iω f_l) / (f_s - ω² - iω f_v), and the criterion f_v² - f_l² > 2 f_s."""
    driver = Driver(headway=1.0, acceleration=acceleration)
    v, v0, omega = 10.0, 33.3, 0.25
    s = driver.equilibrium_gap(v, v0)
    wanted, rate = driver.gap + v * driver.headway, 2.0 * math.sqrt(driver.acceleration * driver.deceleration)
    f_s = 2.0 * acceleration * wanted**2 / s**3
    f_l = 2.0 * acceleration * wanted / s**2 * v / rate
    f_v = -4.0 * acceleration * v**3 / v0**4 - 2.0 * acceleration * wanted / s**2 * (driver.headway + v / rate)
    assert (f_v**2 - f_l**2 < 2.0 * f_s) == grows
    expected = abs((f_s + 1j * omega * f_l) / (f_s - omega**2 - 1j * omega * f_v))
    assert (expected > 1.0) == grows
    # four cars behind one whose speed oscillates a little
    step, speeds = 1.0 / 60.0, np.full(5, v)
    places = -np.arange(5) * (s + 4.6)
    waves = np.zeros(5, dtype=complex)
    period = round(2.0 * math.pi / omega / step)
    for tick in range(16 * period):
        speeds[0] = v + 0.01 * math.sin(omega * tick * step)
        gaps = places[:-1] - places[1:] - 4.6
        change = driver.accelerations(speeds[1:], v0, gaps, speeds[1:] - speeds[:-1])
        places, speeds = advance(places, speeds, np.concatenate([[0.0], change]), step)
        if tick >= 12 * period:
            waves += (speeds - v) * cmath.exp(-1j * omega * tick * step)
    gains = np.abs(waves[1:]) / np.abs(waves[:-1])
    assert gains == pytest.approx(np.full(4, expected), rel=0.02)


def test_lanes_are_changed_by_the_criterion_of_mobil():
    driver = Driver(politeness=0.5, threshold=0.1, safe=4.0)
    none = (0.0, 0.0)
    assert driver.wants_change((-0.5, 0.5), none, none, 1)
    assert not driver.wants_change((0.4, 0.49), none, none, 1)
    # the new follower loses 1.9 m/s²: half of that is more than the advantage of 0.8
    assert not driver.wants_change((0.0, 0.8), (0.4, -1.5), none, 1)
    assert driver.wants_change((0.0, 0.8), (0.4, -0.5), none, 1)
    # the old follower gains
    assert driver.wants_change((0.0, 0.2), (0.4, -0.2), (-0.5, 0.5), 1)
    # nobody has to brake harder than 4 m/s², whatever the advantage
    assert not driver.wants_change((-3.0, 0.7), (0.0, -4.1), none, 1)
    right = driver._replace(bias=0.3)
    assert right.wants_change((0.0, 0.0), none, none, -1)
    assert not right.wants_change((0.0, 0.3), none, none, 1)


def test_a_faster_car_overtakes(load: Load):
    scene = (
        "cars = Traffic(politeness=0.0)\ncars.road('a', [(0, 0), (2000, 0)], 3, lanes=2, speed=15.0)" + GROUND + EMPTY
    )
    simulation = load(scene)
    simulation.step(1)
    cars = simulation.context.robots["cars"]
    cars.factor[:] = (0.4, 1.0, 1.0)
    cars.front[:], cars.lane[:], cars.before[:], cars.left[:] = (200.0, 100.0, 10.0), 0, 0, -1.75
    until(simulation, lambda: cars.lane[1] == 1, 40.0)
    until(simulation, lambda: cars.front[1] > cars.front[0], 60.0)
    assert simulation.cars.data["positions"][1, 1] == pytest.approx(1.75, abs=0.3)
    assert simulation.cars.data["speeds"][1] == pytest.approx(15.0, rel=0.15)


LIGHT = """
light = TrafficLight(phases=[("red", 30.0), ("green", 30.0), ("yellow", 3.0)])
light.translate(x=100.0, y=-5.0)
cars = Traffic()
cars.road("street", [(0, 0), (200, 0)], 6, over=5.0)
cars.stop("street", 100.0, light)
"""


def test_cars_wait_at_a_red_light_and_drive_at_green(load: Load):
    simulation = load(LIGHT + GROUND + EMPTY)
    simulation.step(60 * 29)
    data = simulation.cars.data
    fronts = np.sort(data["places"][data["present"]])
    assert fronts[-1] == pytest.approx(99.3, abs=0.7)
    assert data["speeds"].max() < 0.5
    assert bumpers(data).min() > 1.0
    until(simulation, lambda: simulation.cars.data["places"].max() > 130.0, 20.0)


def test_a_driver_stops_at_yellow_only_if_there_is_room(load: Load):
    simulation = load(LIGHT + GROUND + EMPTY)
    simulation.light.show("green")
    cars = simulation.context.robots["cars"]
    until(simulation, lambda: cars.front.max() > 80.0 and cars.speed.max() > 8.0, 60.0)
    first = int(cars.front.argmax())
    while 100.0 - cars.front[first] > 8.0:
        simulation.step(1)
    # v² / (2 · 8 m) is more than 3 m/s²
    assert cars.speed[first] ** 2 / 16.0 > 3.0
    simulation.light.show("yellow")
    simulation.step(120)
    assert cars.front[first] > 105.0
    simulation.step(600)
    others = np.delete(cars.front, first)
    assert not ((others > 100.0) & (others < 106.0)).any()


@pytest.mark.parametrize("what", ["robot", "people"])
def test_cars_brake_for_who_stands_on_their_lane(load: Load, what: str):
    if what == "robot":
        scene = ROBOT.format(place="120.0, 0.0")
    else:
        scene = "crowd = Crowd('crowd', 1)\ncrowd.start(places=[(120.0, 0.0)])\n"
    simulation = load(scene + "cars = Traffic()\ncars.road('street', [(0, 0), (240, 0)], 4, over=8.0)" + GROUND + EMPTY)
    cars = simulation.context.robots["cars"]
    simulation.step(60 * 40)
    front = float(cars.front.max())
    assert 120.0 - 5.0 < front < 119.0
    assert cars.speed.max() < 0.1
    assert not simulation.failures
    if what == "robot":
        simulation.context.robots["robot"].force_pose((120.0, 8.0, 0.2), None)
        until(simulation, lambda: cars.front.max() > 150.0, 20.0)


def test_a_robot_among_cars_is_followed(load: Load):
    scene = ROBOT.format(place="60.0, 0.0") + "cars = Traffic()\ncars.road('street', [(0, 0), (300, 0)], 3, over=4.0)"
    simulation = load(scene + GROUND + EMPTY)
    simulation.robot.motion.set_speed(4.0, 0.0)
    cars, robot = (simulation.context.robots[name] for name in ("cars", "robot"))
    until(simulation, lambda: robot.position_3d.x > 250.0, 80.0)
    behind = float(cars.front.max())
    assert cars.speed[int(cars.front.argmax())] == pytest.approx(4.0, abs=0.2)
    # s0 + v T from bumper to bumper
    assert robot.position_3d.x - behind == pytest.approx(2.0 + 1.6 * 4.0, abs=2.0)


def test_cars_of_crossing_roads_wait_for_each_other(load: Load):
    scene = (
        "cars = Traffic()\ncars.road('east', [(-150, 0), (150, 0)], 2, over=1.0)\n"
        "cars.road('north', [(0, -150), (0, 150)], 1, over=1.0)" + GROUND + EMPTY
    )
    simulation = load(scene)
    cars = simulation.context.robots["cars"]
    until(simulation, lambda: bool(cars.there[2]) and cars.front[2] > 152.0, 60.0)
    cars.hold(2)
    cars.speed[2] = 0.0
    simulation.step(60 * 30)
    assert cars.front[2] < 162.0
    waits = cars.front[:2][cars.front[:2] < 150.0]
    assert len(waits)
    assert waits.max() < 149.0
    cars.go()
    until(simulation, lambda: cars.front[:2].max() > 160.0, 30.0)


def test_cars_on_many_lanes_never_touch(load: Load):
    scene = (
        "cars = Traffic(deviation=0.25, trucks=0.2, bias=0.2)\n"
        "cars.road('a', [(0, 0), (600, 0), (900, 300)], 40, lanes=3, speed=25.0)" + GROUND + EMPTY
    )
    simulation = load(scene, seed=3)
    cars = simulation.context.robots["cars"]
    seen = set()
    for _ in range(120):
        simulation.step(30)
        for lane in range(3):
            on = np.flatnonzero(cars.there & ((cars.lane == lane) | (cars.before == lane)))
            order = on[np.argsort(cars.front[on])]
            apart = cars.front[order[1:]] - cars._length[order[1:]] - cars.front[order[:-1]]
            assert (apart > 0.0).all()
        seen |= {tuple(cars.lane.tolist())}
    assert len(seen) > 10
    assert not simulation.failures


def test_cars_are_seen(load: Load):
    scene = """
robot = ATRV()
robot.translate(-10.0, 0.0, 0.1)
scan = Sick()
scan.translate(z=0.5)
robot.append(scan)
camera = SemanticCamera()
camera.translate(z=1.0)
robot.append(camera)
radar = Radar()
radar.translate(z=0.6)
robot.append(radar)
cars = Traffic()
cars.road("street", [(0, 0), (12, 0)], 1, speed=5.0)
"""
    simulation = load(scene + GROUND + EMPTY)
    cars = simulation.context.robots["cars"]
    simulation.step(30)
    rear = float(cars.front[0] - 4.6)
    assert min(simulation.robot.scan.get()["range_list"]) == pytest.approx(10.0 + rear, abs=0.3)
    found = simulation.robot.camera.get()["visible_objects"]
    assert [(one["name"], one["type"]) for one in found] == [("cars car 0", "car")]
    echoes = simulation.robot.radar.get()["detections"]
    speeds = [one["velocity"] for one in echoes if abs(one["range"] - 10.0 - cars.front[0]) < 6.0]
    assert any(abs(speed - cars.speed[0]) < 0.5 for speed in speeds), echoes


SCENE = """
cars = Traffic(deviation=0.1)
cars.road("a", [(0, 0), (200, 0), (300, 80)], 12, lanes=2)
cars.road("b", [(60, -150), (60, 150)], 6, over=10.0)
light = TrafficLight()
light.translate(y=9.0)
cars.stop("a", 50.0, light)
"""


def test_states_and_rows_agree(load: Load, tmp_path):
    simulation = load(SCENE + EMPTY, seed=2)
    simulation.step(300)
    state = simulation.save()
    simulation.step(300)
    end = simulation.save()
    places = simulation.cars.data["positions"]
    simulation.step(50)
    simulation.restore(state)
    simulation.step(300)
    assert simulation.save() == end
    with morse.batch(script(tmp_path, SCENE + EMPTY), rows=2, seed=2) as rows:
        rows.step(600)
        assert (rows[1].context.robots["cars"].local_data["positions"] != places).any()
    again = load(SCENE + EMPTY, seed=2)
    again.step(600)
    assert (again.cars.data["positions"] == places).all()


def test_a_state_with_impossible_cars_is_refused(load: Load):
    simulation = load(SCENE + EMPTY)
    cars = simulation.context.robots["cars"]
    for name, value in (
        ("lane", 7),
        ("before", -1),
        ("front", math.nan),
        ("front", -5.0),
        ("speed", 1e9),
        ("left", math.inf),
    ):
        state = cars.get_state()
        state["cars"][name][0] = value
        with pytest.raises(StateError, match="the cars of cars"):
            cars.set_state(state)
    state = cars.get_state()
    state["cars"].pop("left")
    with pytest.raises(StateError, match="missing"):
        cars.set_state(state)
    simulation.step(10)
    assert not simulation.failures


def test_services(load: Load):
    simulation = load(SCENE + EMPTY)
    simulation.step(60)
    simulation.cars.hold()
    simulation.step(60 * 15)
    assert simulation.cars.data["speeds"].max() < 1e-6
    simulation.cars.go()
    simulation.cars.limit("a", 5.0)
    simulation.step(60 * 20)
    data = simulation.cars.data
    on = data["present"] & (data["roads"] == 0)
    assert data["speeds"][on].max() < 6.5
    for name, arguments, words in (
        ("hold", (99,), "cars 0 to 17"),
        ("limit", ("c", 5.0), "no road 'c'"),
        ("limit", ("a", math.nan), "expected|number"),
        ("limit", ("a", 1e300), "expected|80"),
    ):
        with pytest.raises(Exception, match=words):
            getattr(simulation.cars, name)(*arguments).result()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("Traffic(headway=0)", "Traffic(headway)"),
        ("Traffic(trucks=2)", "Traffic(trucks)"),
        ("Traffic(deviation=float('nan'))", "Traffic(deviation)"),
        ("Traffic().road('a', [(0, 0)])", "2 to 1000 points"),
        ("Traffic().road('a', 'b')", "takes points such as"),
        ("Traffic().road('a', [(0, 0), (0, 0)])", "twice in a row"),
        ("Traffic().road('a', [(0, 0), (1, float('inf'))])", "finite number"),
        ("Traffic().road('a', [(0, 0), (1, 2, 3)])", "points (x, y)"),
        ("Traffic().road('a', [(0, 0), (9, 9)], closed=True)", "at least three points"),
        ("Traffic().road('a', [(0, 0), (20, 0)], 9)", "9 cars need 59 m, and 'a' has 20 m of lanes"),
        ("Traffic().road('a', [(0, 0), (20, 0)], 10**9)", "at most 2000 cars"),
        ("Traffic().road('a', [(0, 0), (20, 0)], lanes=99)", "1 to 8 lanes"),
        ("Traffic().road('a', [(0, 0), (20, 0)], speed=-1)", "Traffic.road(speed)"),
        ("Traffic().road('a', __import__('itertools').repeat((0, 0)))", "twice in a row"),
        ("Traffic().road('a', ((k, 0) for k in __import__('itertools').count()))", "2 to 1000 points"),
        ("Traffic().stop('a', 5.0, 'light')", "there is no road 'a'"),
    ],
)
def test_mistakes_are_named(tmp_path, call: str, words: str):
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'one = {call}\nenv = Environment("empty")')).close()


def test_a_missing_traffic_light_is_named(load: Load):
    scene = "cars = Traffic()\ncars.road('a', [(0, 0), (90, 0)], 2)\ncars.stop('a', 50.0, 'lihgt')"
    with pytest.raises(Exception, match=r":\d+\): cars: there is no traffic light 'lihgt'"):
        load(scene + EMPTY)


def test_traffic_without_cars_or_roads(load: Load):
    simulation = load("none = Traffic()\nempty = Traffic()\nempty.road('a', [(0, 0), (90, 0)], 0)" + EMPTY)
    simulation.step(10)
    state = simulation.save()
    simulation.restore(state)
    assert not simulation.failures


def test_lanes_beside_the_middle_have_no_gaps_at_corners(load: Load):
    """No car moves farther in a tick than its speed allows, on lanes that are longer or shorter than the middle."""
    ring = "[(0, 0), (60, 0), (90, 40), (20, 80)], 8, closed=True, lanes=3, speed=10.0"
    scene = f"cars = Traffic()\ncars.road('ring', {ring})"
    simulation = load(scene + EMPTY)
    before = simulation.cars.data["positions"].copy()
    for _ in range(900):
        simulation.step(1)
        data = simulation.cars.data
        way = np.linalg.norm(data["positions"] - before, axis=1)
        assert (way < 1.3 * data["speeds"] / 60.0 + 1e-3).all()
        before = data["positions"].copy()


def test_a_lane_keeps_its_distance_to_the_middle_of_the_road():
    road = Road(np.array([(0.0, 0.0), (50.0, 0.0), (80.0, 40.0), (80.0, 90.0)]), 2, 3.5, closed=False)
    along = np.linspace(0.0, road.length, 300)
    for left in (-1.75, 1.75):
        points, _ = road.places(along, np.full(300, left))
        assert np.abs(road.project(points)[1] - left).max() < 0.25
        assert np.linalg.norm(np.diff(points, axis=0), axis=1).max() < 1.2 * road.length / 299


def test_cars_wait_behind_a_truck_of_other_traffic(load: Load):
    """IDM comes to rest s0 behind the rear of what is 12 m long, whichever component moves it."""
    scene = (
        "trucks = Traffic(trucks=1.0)\ntrucks.road('one', [(0, 0), (300, 0)], 1, over=0.1)\n"
        "beside = Traffic(trucks=1.0)\nbeside.road('next', [(0, 3.5), (300, 3.5)], 1, over=0.1)\n"
        "cars = Traffic()\ncars.road('same', [(0, 0), (300, 0)], 1, over=20.0)"
    )
    simulation = load(scene + EMPTY)
    until(simulation, lambda: simulation.trucks.data["places"][0] > 80.0)
    simulation.trucks.hold()

    def stands() -> bool:
        # a truck beside the lane stops nobody
        assert np.isinf(simulation.beside.data["gaps"]).all()
        return bool(simulation.cars.data["present"][0] and simulation.cars.data["speeds"][0] < 0.01)

    until(simulation, stands, 120.0)
    rear = float(simulation.trucks.data["places"][0]) - 12.0
    assert float(simulation.cars.data["places"][0]) == pytest.approx(rear - 2.0, abs=0.3)


def test_cars_of_a_road_that_crosses_itself_wait_for_each_other(load: Load):
    scene = "cars = Traffic()\ncars.road('eight', [(0, 0), (100, 100), (100, 0), (0, 100)], 6, closed=True, speed=8.0)"
    simulation = load(scene + EMPTY)
    cars = simulation.context.robots["cars"]
    # the middle of the first part is also that of the third
    middle = 50.0 * math.sqrt(2.0)
    until(simulation, lambda: bool((np.abs(cars.front - middle - 2.3) < 0.2).any()))
    held = int(np.abs(cars.front - middle - 2.3).argmin())
    cars.hold(held)
    cars.speed[held] = 0.0
    simulation.step(60 * 40)
    positions = simulation.cars.data["positions"][:, :2]
    apart = np.linalg.norm(positions - positions[held], axis=1)
    assert sorted(apart)[1] > 0.5 * (4.6 + 1.8)
    assert (cars.speed < 0.01).all()


def test_a_restored_state_has_the_gaps_of_its_time(load: Load):
    simulation = load(SCENE + EMPTY, seed=2)
    simulation.step(100)
    state, gaps = simulation.save(), simulation.cars.data["gaps"].copy()
    simulation.step(100)
    simulation.restore(state)
    assert np.isinf(gaps).any()
    assert (simulation.cars.data["gaps"] == gaps).all()


def test_cars_that_are_placed_on_their_roads_do_not_overlap_a_robot_at_the_origin(load: Load, caplog):
    load(ROBOT.format(place="0, 0") + "cars = Traffic()\ncars.road('r', [(-40, 20), (60, 20)], 3)" + GROUND + EMPTY)
    assert "overlap" not in caplog.text


@pytest.mark.parametrize("turn", [1, -1])
def test_a_truck_stays_on_its_lane_in_a_corner_of_90_degrees(load: Load, turn: int):
    """Its four corners are within 1.75 m of the middle of a lane of 3.5 m with a radius of 13 m."""
    simulation = load(f"""
        cars = Traffic("cars", trucks=1.0)
        cars.road("bend", [(-60, 0), (0, 0), (0, {60 * turn})], 1, speed=8.0, radius=13.0)
        env = Environment("empty")
        env.simulator_frequency(20)
    """)
    cars = simulation.cars.component
    cars.front[0] = 14.0
    # the middle of the lane: straight lines, and a quarter of a circle about (-13, 13)
    widest, turned = 0.0, 0.0
    for _ in range(20 * 12):
        simulation.step(1)
        (place,), (way,) = cars.local_data["positions"][:, :2], cars._ways
        side = np.array([-way[1], way[0]])
        for along in (-6.0, 6.0):
            for across in (-0.9, 0.9):
                x, y = (place + along * way + across * side) * (1, turn)
                if x > -13.0 and y < 13.0:
                    off = abs(math.dist((x, y), (-13.0, 13.0)) - 13.0)
                else:
                    off = abs(y) if y < 13.0 else abs(x)
                widest = max(widest, off)
        turned = max(turned, turn * way[1])
    assert turned > 0.99
    assert 0.9 <= widest < 1.75


@pytest.mark.parametrize(
    ("points", "words"),
    [("[(0, 0), (10, 0), (10, 50)]", "need 13.0 m"), ("[(0, 0), (50, 0), (1, 0)]", "turns back")],
)
def test_corners_without_room_for_an_arc_are_refused(load: Load, points: str, words: str):
    with pytest.raises(Exception, match=words):
        load(f"cars = Traffic()\ncars.road('a', {points}, 1, radius=13.0)" + EMPTY)
