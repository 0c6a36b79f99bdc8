"""The subset of OpenSCENARIO DSL: what actors do, and what is refused, by line."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

import morse
from morse.many import Scenario, uniform
from morse.plugins.falsify.expressions import RequirementError
from morse.plugins.falsify.openscenario import _Reader, read_openscenario

pytestmark = pytest.mark.long

CROSSING = """
import osc.standard
scenario crossing:
    car: vehicle
    walker: person
    walk: speed = 1.0mps
    delay: time = 500ms
    do parallel:
        car.drive(duration: 2s) with:
            speed(7.2kph)
        serial:  # the walker waits
            wait elapsed(delay)
            walker.walk(duration: 1s) with:
                position(x: 3m, y: -1m, yaw: 90deg)
                speed(walk)
"""


def scene():
    from morse.builder import Environment, MotionVW, Pose, Robot

    for name in ("car", "walker"):
        robot = Robot(name=name)
        for part in (MotionVW("motion"), Pose("pose")):
            robot.append(part)
    Environment("empty")


def written(tmp_path, text):
    file = tmp_path / "crossing.osc"
    file.write_text(text)
    return file


def test_actors_do_what_the_scenario_says(tmp_path):
    run = read_openscenario(written(tmp_path, CROSSING))
    with morse.load(scene) as sim:
        run(sim, walk=0.6)
        assert sim.time() == pytest.approx(2.0, abs=0.02)
        car, walker = sim.car.pose.data, sim.walker.pose.data
        # 7.2 km/h are 2 m/s
        assert car["x"] == pytest.approx(4.0, abs=0.04)
        assert (walker["x"], walker["y"]) == (pytest.approx(3.0, abs=0.01), pytest.approx(-1.0 + 0.6, abs=0.02))
        assert walker["yaw"] == pytest.approx(1.5708, abs=1e-3)
        sim.step(30)
        assert sim.car.pose.data["x"] == pytest.approx(car["x"], abs=0.04)


def test_one_of_is_chosen_by_the_seed(tmp_path):
    text = CROSSING.partition("    do ")[0] + (
        "    do one_of:\n        car.drive(duration: 1s) with:\n            speed(1mps)\n        wait elapsed(0.5s)\n"
    )
    run = read_openscenario(written(tmp_path, text))
    times = []
    for seed in (*range(8), 3):
        with morse.load(scene, seed=seed) as sim:
            run(sim)
            times.append(round(sim.time(), 1))
    assert set(times) == {0.5, 1.0}
    assert times[-1] == times[3]


def test_its_parameters_are_those_of_a_search(tmp_path):
    scenario = Scenario(scene, read_openscenario(written(tmp_path, CROSSING)), walk=uniform(0.2, 3.0))
    scenario.always("walker.pose.y < 1")
    found = scenario.falsify(tmp_path / "r", runs=30, workers=0)
    assert found.smallest.parameters["walk"] == pytest.approx(2.0, abs=0.06)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("import osc.standard", "import osc.other", ":2: 'import osc.other' is not supported"),
        ("car: vehicle", "car: spaceship", ":4: 'car' is of the type 'spaceship', which is not supported"),
        ("car: vehicle", "walker: vehicle", ":5: there is a 'walker' already"),
        ("walk: speed = 1.0mps", "walk: speed", ":6: 'walk' needs a value"),
        ("1.0mps", "1.0m", ":6: '1.0m' is not a speed: expected a number with a unit: mps, kph, mph"),
        ("1.0mps", "1e999mps", ":6: '1e999mps' is not a finite speed"),
        ("do parallel", "do paralel", ":8: 'paralel:' is not supported; did you mean 'parallel'?"),
        ("car.drive", "cat.drive", ":9: there is no actor 'cat'; did you mean 'car'?"),
        ("car.drive", "car.fly", ":9: the action 'fly' is not supported"),
        ("duration: 2s", "distance: 2m", ":9: the argument 'distance: 2m' is not supported"),
        ("duration: 2s", "", ":9: how long?"),
        ("speed(7.2kph)", "lane(2)", ":10: the modifier 'lane(2)' is not supported"),
        ("speed(7.2kph)", "speed(delay)", ":10: 'delay' is a time, expected a speed"),
        ("wait elapsed(delay)", "wait @car.arrived", ":12: there is no event 'car.arrived'"),
        ("speed(walk)", "speed(wlk)", ":15: there is no parameter 'wlk'; did you mean 'walk'?"),
        ("                speed(walk)", "              speed(walk)", ":15: it is indented otherwise"),
        ("    do parallel:", "\tdo parallel:", ":8: a tab"),
        ("scenario crossing:", "scenario crossing:\n    keep(walk < 2mps)", ":4: 'keep(walk < 2mps)' is not supported"),
    ],
)
def test_what_is_not_supported_is_refused_by_line(tmp_path, old, new, message):
    with pytest.raises(RequirementError) as caught:
        read_openscenario(written(tmp_path, CROSSING.replace(old, new, 1)))
    assert f"crossing.osc{message}" in str(caught.value)


def test_an_actor_that_the_scene_lacks(tmp_path):
    run = read_openscenario(written(tmp_path, CROSSING.replace("walker", "talker")))
    with morse.load(scene) as sim, pytest.raises(RequirementError, match="no robot 'talker'; did you mean 'walker'"):
        run(sim)


@given(st.text(alphabet="scenario do:\n ()=1.5mps_#\tserial,parallel", max_size=200))
def test_any_text_is_read_or_refused(text):
    for content in (text, "scenario s:\n    a: vehicle\n    " + text, CROSSING + text):
        try:
            _Reader("any.osc", content).function()
        except RequirementError as error:
            assert str(error).startswith("any.osc:")  # noqa: PT017 # or there is none


EVENTS = """
scenario meeting:
    car: vehicle
    walker: person
    gap: length = 2m
    event near is car.pose.x > 3m - gap
    event greeted
    do parallel:
        serial:
            car.drive() with:
                speed(2mps)
                until @greeted
            car.drive(duration: 9s) with:
                until rise(car.pose.x > 4m)
                speed(1mps)
        serial:
            wait @near
            walker.walk(duration: 500ms) with:
                speed(1mps)
            emit greeted
"""


def test_events_end_and_begin_what_actors_do(tmp_path):
    """The car passes x = 1 m at 0.5 s, the walker walks until 1 s, and from x = 2 m on the car is slower."""
    run = read_openscenario(written(tmp_path, EVENTS))
    with morse.load(scene) as sim:
        run(sim)
        assert sim.car.pose.data["x"] == pytest.approx(4.0, abs=0.1)
        assert sim.walker.pose.data["x"] == pytest.approx(0.5, abs=0.05)
        # 2 m at 2 m/s, and 2 m at 1 m/s
        assert sim.time() == pytest.approx(3.0, abs=0.15)
    with morse.load(scene) as sim:
        run(sim, gap=1.0)
        assert sim.time() == pytest.approx(2.5, abs=0.15)


@pytest.mark.parametrize(
    ("event", "end"), [("rise(car.pose.x < 1m)", 9.0), ("fall(car.pose.x < 1m)", 0.5), ("car.pose.x >= 0m", 0.0)]
)
def test_an_edge_needs_the_opposite_before(tmp_path, event, end):
    text = "scenario s:\n    car: vehicle\n    do car.drive(duration: 9s) with:\n        speed(2mps)\n"
    text += f"        until {event}\n"
    run = read_openscenario(written(tmp_path, text))
    with morse.load(scene) as sim:
        sim.step(12)
        begin = sim.time()
        run(sim)
        assert sim.time() - begin == pytest.approx(end, abs=0.1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "emit greeted",
            "emit greated",
            ":20: there is no event 'greated' without a condition; did you mean",
        ),
        ("emit greeted", "emit near", ":20: there is no event 'near' without a condition"),
        ("wait @near", "wait @nera", ":17: there is no event 'nera'; did you mean 'near'"),
        ("event greeted", "event near", ":7: there is a 'near' already"),
        ("event greeted", "event car", ":7: there is a 'car' already"),
        ("3m - gap", "3parsec - gap", ":6: '3parsec': there is no unit 'parsec'"),
        ("3m - gap", "3m - gab", ":6: there is no 'gab'; did you mean 'gap'"),
        ("car.pose.x > 3m", "cat.pose.x > 3m", ":6: there is no 'cat.pose.x'; did you mean 'car'"),
        ("car.pose.x > 3m - gap", "__import__('os')", ":6: '__import__('os')' is no event that is supported"),
        ("rise(car.pose.x > 4m)", "rise(rise(car.pose.x > 4m))", ":14: "),
        ("                until @greeted\n", "", ":10: how long?"),
    ],
)
def test_what_is_no_event_is_refused_by_line(tmp_path, old, new, message):
    with pytest.raises(RequirementError) as caught:
        read_openscenario(written(tmp_path, EVENTS.replace(old, new, 1)))
    assert f"crossing.osc{message}" in str(caught.value)


def test_an_event_of_a_field_that_does_not_exist_is_named_in_the_run(tmp_path):
    run = read_openscenario(written(tmp_path, EVENTS.replace("car.pose.x > 3m", "car.pose.xx > 3m")))
    with morse.load(scene) as sim, pytest.raises(RequirementError, match=r"crossing.osc:6: .* has no 'xx'"):
        run(sim)
