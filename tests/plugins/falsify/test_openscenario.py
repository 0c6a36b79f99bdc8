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
        ("1.0mps", "1.0m", ":6: '1.0m' is no speed: expected a number with a unit: mps, kph, mph"),
        ("1.0mps", "1e999mps", ":6: '1e999mps' is no finite speed"),
        ("do parallel", "do paralel", ":8: 'paralel:' is not supported; did you mean 'parallel'?"),
        ("car.drive", "cat.drive", ":9: there is no actor 'cat'; did you mean 'car'?"),
        ("car.drive", "car.fly", ":9: the action 'fly' is not supported"),
        ("duration: 2s", "distance: 2m", ":9: the argument 'distance: 2m' is not supported"),
        ("duration: 2s", "", ":9: how long?"),
        ("speed(7.2kph)", "lane(2)", ":10: the modifier 'lane(2)' is not supported"),
        ("speed(7.2kph)", "speed(delay)", ":10: 'delay' is a time, expected a speed"),
        ("wait elapsed(delay)", "wait @car.arrived", ":12: 'wait @car.arrived' is not supported"),
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
