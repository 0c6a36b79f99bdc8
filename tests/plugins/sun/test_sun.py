"""The sun: where almanacs have it, what it lights, and what follows it."""

import math
import re
from datetime import datetime

import numpy as np
import pytest

import morse
from morse.plugins.sun import axes, look
from morse.plugins.sun.almanac import Position, equatorial, position
from tests.kit.scenes import Load, script

SCENE = """
post = Cube("post")
post.scale = (0.25, 0.25, 2.0)
post.translate(z=2.0)
post.static()
ground = Cube("ground")
ground.scale = (30.0, 30.0, 0.5)
ground.translate(z=-0.5)
ground.static()
lamp = StreetLamp()
lamp.translate(x=25.0, y=-25.0)
env = Environment("empty")
env.sun({date!r}, latitude=43.6, longitude=1.44, speed={speed})
"""


def seconds(date: str) -> float:
    return datetime.fromisoformat(date).timestamp()


def test_the_example_of_the_solar_position_algorithm():
    """NREL/TP-560-34302, table A5.1: zenith 50.11162°, azimuth 194.34024°."""
    place = position(seconds("2003-10-17T12:30:30-07:00"), 39.742476, -105.1786, 1830.14, 820.0, 11.0)
    assert 90.0 - math.degrees(place.elevation) == pytest.approx(50.11162, abs=0.01)
    assert math.degrees(place.azimuth) == pytest.approx(194.34024, abs=0.01)


def test_the_example_of_meeus():
    """Astronomical Algorithms, example 25.b: λ 199.90606°, α 198.37818°, δ −7.78387°, R 0.99760853, at 0 h TD."""
    seen = equatorial(seconds("1992-10-13T00:00:00+00:00") - 59.0)
    assert (seen.longitude, seen.ascension) == pytest.approx((199.90606, 198.37818), abs=0.01)
    assert (seen.declination, seen.distance) == pytest.approx((-7.78387, 0.9976085), abs=0.01)


@pytest.mark.parametrize(
    ("date", "longitude"),
    [
        ("2025-03-20T09:01:00+00:00", 0.0),
        ("2024-06-20T20:51:00+00:00", 90.0),
        ("2024-09-22T12:44:00+00:00", 180.0),
        ("2024-12-21T09:21:00+00:00", 270.0),
    ],
)
def test_equinoxes_and_solstices_of_the_almanac(date: str, longitude: float):
    apart = equatorial(seconds(date)).longitude - longitude
    assert math.remainder(apart, 360.0) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("latitude", [-90.0, -23.44, 0.0, 60.0, 90.0])
def test_positions_everywhere_are_finite_and_continuous(latitude: float):
    before = None
    for minute in range(0, 1440, 10):
        place = position(seconds("2026-06-21T00:00:00+00:00") + 60.0 * minute, latitude, 10.0)
        towards = np.reshape(axes(place, 0.3), (3, 3))[:, 2]
        assert np.isfinite(towards).all()
        if before is not None:
            # 2.5° in ten minutes; half a degree more where refraction ends, below the horizon
            assert math.degrees(math.acos(min(1.0, float(towards @ before)))) < 3.2
        before = towards


def test_the_axes_of_the_lamp():
    """North is +Y, east is +X; with north at +X, east is −Y."""
    east = Position(math.pi / 2, 0.0)
    assert np.reshape(axes(east, 0.0), (3, 3))[:, 2] == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
    turned = np.reshape(axes(Position(0.0, 0.5), math.pi / 2), (3, 3))
    assert turned[:, 2] == pytest.approx((math.cos(0.5), 0.0, math.sin(0.5)), abs=1e-12)
    assert turned @ turned.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turned) == pytest.approx(1.0)


def test_the_light_is_redder_and_weaker_when_the_sun_is_low():
    high, low, down = look(math.radians(60.0)), look(math.radians(3.0)), look(math.radians(-10.0))
    assert high.energy > low.energy > down.energy == 0.0
    assert high.sky > low.sky > down.sky > 0.0
    assert high.color[2] > 0.9
    assert low.color[0] > low.color[1] > low.color[2]
    assert low.color[2] < 0.2


def _picture(simulation) -> np.ndarray:
    """The view from 25 m above the post: brightness (200, 200), upwards +Y."""
    picture = simulation.picture(200, 200, location=(0.0, 0.0, 25.0), rotation=(0.0, 0.0, 0.0), focal_length=28.0)
    return np.asarray(picture)[..., :3].astype(float).sum(axis=2)


def _shadow(simulation) -> np.ndarray:
    """The middle of the shadow of the post, m from its foot, towards +X and +Y of the world."""
    picture = _picture(simulation)
    rows, columns = np.nonzero(picture < 0.94 * float(np.median(picture)))
    scale = 25.0 * 32.0 / 28.0 / 200.0
    x, y = (columns - 99.5) * scale, (99.5 - rows) * scale
    near = (np.hypot(x, y) < 9.0) & (np.hypot(x, y) > 0.8)
    return np.array([x[near].mean(), y[near].mean()])


@pytest.mark.parametrize("date", ["2026-03-20T09:00:00+00:00", "2026-03-20T15:00:00+00:00"])
def test_shadows_point_away_from_the_sun(load: Load, date: str):
    simulation = load(SCENE.format(date=date, speed=0.0))
    simulation.step(2)
    place = position(seconds(date), 43.6, 1.44)
    shadow = _shadow(simulation)
    away = -np.array([math.sin(place.azimuth), math.cos(place.azimuth)])
    angle = math.atan2(shadow[0] * away[1] - shadow[1] * away[0], float(shadow @ away))
    assert math.degrees(angle) == pytest.approx(0.0, abs=4.0)


def test_the_day_passes_and_lamps_shine_at_dusk(load: Load):
    simulation = load(SCENE.format(date="2026-03-20T13:00:00+00:00", speed=3600.0))
    before = _shadow(simulation)
    simulation.step(120)
    after = _shadow(simulation)
    assert math.hypot(*(after - before)) > 0.5
    assert simulation.lamp.data["on"] is False
    while not simulation.lamp.data["on"]:
        simulation.step(1)
        assert simulation.context.clock.time < 10.0
    # at the equinox, the sun sets 6 h and 0.833° / cos φ after noon, which is 7.4 min late on that day
    sunset = 13.0 + simulation.context.clock.time
    noon = 12.0 - 1.44 / 15.0 + 7.4 / 60.0
    assert sunset == pytest.approx(noon + 6.0 + 0.833 / math.cos(math.radians(43.6)) / 15.0, abs=0.06)
    place = simulation.rpc("sun", "get")
    assert math.degrees(place["elevation"]) == pytest.approx(-0.8, abs=0.5)
    simulation.lamp.switch("off")
    simulation.step(2)
    assert simulation.lamp.data["on"] is False


def test_states_agree(load: Load):
    simulation = load(SCENE.format(date="2026-03-20T17:30:00+00:00", speed=600.0))
    simulation.step(60)
    state = simulation.save()
    simulation.step(200)
    end, picture = simulation.save(), _picture(simulation)
    simulation.step(100)
    simulation.restore(state)
    simulation.step(200)
    assert simulation.save() == end
    assert (_picture(simulation) == picture).all()
    assert not simulation.failures


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("env.sun('yesterday', 1, 2)", "env.sun(date)"),
        ("env.sun(12, 1, 2)", "env.sun(date)"),
        ("env.sun('1492-10-12', 1, 2)", "1900 to 2099"),
        ("env.sun('2026-01-01', 91, 2)", "env.sun(latitude)"),
        ("env.sun('2026-01-01', 1, float('nan'))", "env.sun(longitude)"),
        ("env.sun('2026-01-01', 1)", "latitude and longitude, or none"),
        ("env.sun('2026-01-01')", "takes a place"),
        ("env.sun('2026-01-01', 1, 2, speed=-1)", "env.sun(speed)"),
        ("env.sun('2026-01-01', 1, 2)\nenv.sun('2026-01-01', 1, 2)", "set before"),
        ("StreetLamp(height=0)", "StreetLamp(height)"),
        ("StreetLamp(color=3)", "StreetLamp(color)"),
    ],
)
def test_mistakes_are_named(tmp_path, call: str, words: str):
    text = f'env = Environment("empty")\n{call}' if "env." in call else f'one = {call}\nenv = Environment("empty")'
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, text)).close()
