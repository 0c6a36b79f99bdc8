"""Sensors at models of MuJoCo: geometry, mechanics, and the errors of data sheets."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
import pytest

import morse

if TYPE_CHECKING:
    from collections.abc import Callable

_MODEL = """<mujoco><option timestep=".01"/><worldbody><geom type="plane" size="0 0 1"/>
<geom name="wall" type="box" size=".1 5 5" pos="4.1 0 0"/>
<body name="car" pos="0 0 1"><freejoint/><geom name="hull" type="box" size=".3 .2 .1" mass="1"/>
<site name="roof" pos="0 0 .3"/><site name="tail" pos="-.5 0 0" euler="0 0 90"/>
<camera name="front" pos=".31 0 0" xyaxes="0 -1 0 0 0 1"/>
<body name="mast" pos=".2 0 .4"><geom type="box" size=".05 .05 .4" mass="1e-6"/></body></body></worldbody></mujoco>"""


def _state() -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(_MODEL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def test_a_lidar_sees_the_world_and_not_its_own_robot() -> None:
    model, data = _state()
    scan = morse.sensors_on(model).lidar("VLP16", at="roof")(data)
    assert scan.ranges.shape == (16 * 1800,)
    # two layers each side of the horizon: the wall at 4 m; the mast before it belongs to the robot
    ahead = scan.points[(scan.geoms == 1)]
    assert ahead[:, 0] == pytest.approx(4.0)
    # the lowest layer reaches the ground at 1.3 m / sin(15 degrees)
    assert scan.ranges[-1800:][scan.geoms[-1800:] == 0] == pytest.approx(1.3 / math.sin(math.radians(15)))
    assert set(np.unique(scan.geoms)) == {-1, 0, 1}
    nothing = scan.geoms < 0
    assert (scan.ranges[nothing] == 100.0).all()
    assert not scan.points[nothing].any()


@pytest.mark.parametrize(("at", "distance"), [("roof", 4.0), ("camera:front", 3.69), ("car", 4.0)])
def test_frames_look_ahead(at: str, distance: float) -> None:
    model, data = _state()
    scan = morse.sensors_on(model).lidar(at=at, scan_window=0.0)(data)
    assert scan.points == pytest.approx(np.array([[distance, 0.0, 0.0]]))


def test_errors_of_lidars_are_those_that_are_set() -> None:
    model, data = _state()
    lidar = morse.sensors_on(model, seed=3).lidar(
        at="roof", scan_window=20.0, resolution=0.001, noise=0.02, dropout=0.1
    )
    ideal = morse.sensors_on(model).lidar(at="roof", scan_window=20.0, resolution=0.001)(data)
    scan = lidar(data)
    lost = scan.geoms < 0
    assert lost.mean() == pytest.approx(0.1, abs=0.01)
    assert (scan.ranges - ideal.ranges)[~lost].std() == pytest.approx(0.02, rel=0.05)
    again = morse.sensors_on(model, seed=3).lidar(
        at="roof", scan_window=20.0, resolution=0.001, noise=0.02, dropout=0.1
    )
    np.testing.assert_array_equal(again(data).ranges, scan.ranges)


def test_an_imu_feels_gravity_when_it_rests_and_the_centripetal_force_when_it_turns() -> None:
    model, data = _state()
    imu, tail = (morse.sensors_on(model).imu(at=at) for at in ("roof", "tail"))
    # it falls
    assert imu(data).linear_acceleration == pytest.approx(np.zeros(3), abs=1e-9)
    data.qpos[2] = 0.1
    for _ in range(300):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    assert imu(data).linear_acceleration == pytest.approx([0.0, 0.0, 9.81], abs=1e-3)
    # in free fall, it turns with 2 rad/s; the body is so flat that the centre of mass is nearly at the origin
    data.qpos[2], data.qvel[:] = 3.0, [0, 0, 0, 0, 0, 2.0]
    mujoco.mj_forward(model, data)
    measured = tail(data)
    assert measured.angular_velocity == pytest.approx([0.0, 0.0, 2.0], abs=1e-6)
    # 0.5 m from the axis, towards +X of the car, which is -Y of the site that is turned by 90 degrees
    assert measured.linear_acceleration == pytest.approx([0.0, -(2.0**2) * 0.5, 0.0], abs=1e-3)


def test_noise_of_an_imu_has_the_density_of_its_data_sheet() -> None:
    model, data = _state()
    imu = morse.sensors_on(model, seed=1).imu("BMI088", at="roof")
    rows = []
    for n in range(4000):
        data.time = n * 0.01
        rows.append(np.concatenate(imu(data)))
    # the difference of two measurements has no bias
    spread = np.diff(rows, axis=0).std(axis=0) / math.sqrt(2) * math.sqrt(0.01)
    assert spread[:3] == pytest.approx(np.full(3, math.radians(0.014)), rel=0.05)
    assert spread[3:] == pytest.approx(np.array([160e-6, 160e-6, 190e-6]) * 9.80665, rel=0.05)


def test_depths_and_their_noise() -> None:
    model, data = _state()
    sensors = morse.sensors_on(model, seed=1)
    assert sensors.depth("front", 40, 60)(data)[20, 30] == pytest.approx(3.69, abs=1e-3)
    noisy = sensors.depth("front", 40, 60, noise=0.0014)(data)
    # the wall fills the picture above the horizon
    assert noisy[:18].std() == pytest.approx(0.0014 * 3.69**2, rel=0.1)
    # what is farther is not seen
    assert not sensors.depth("front", 40, 60, far=3.0)(data)[:18].any()


def test_temperatures_are_those_of_bodies_and_their_parts() -> None:
    model, data = _state()
    data.qpos[3:7] = [0.0, 0.0, 0.0, 1.0]  # it looks away from the wall
    mujoco.mj_forward(model, data)
    image = morse.sensors_on(model).thermal("front", {"world": 10.0, "car": 60.0}, 40, 60, sky=-20.0)(data)
    assert set(np.unique(image)) == {10.0, -20.0}
    other = mujoco.MjModel.from_xml_string(_MODEL.replace('pos=".31 0 0"', 'pos="-2 0 .5"'))
    data = mujoco.MjData(other)
    mujoco.mj_forward(other, data)
    sensors = morse.sensors_on(other)
    assert set(np.unique(sensors.thermal("front", {"car": 60.0}, 80, 120)(data))) == {15.0, 60.0}
    both = sensors.thermal("front", {"car": 60.0, "mast": 90.0}, 80, 120)(data)
    assert set(np.unique(both)) == {15.0, 60.0, 90.0}


def _plate() -> tuple[Any, Any]:
    """A white plate that shines, before black."""
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><visual><headlight ambient="0 0 0" diffuse="0 0 0" specular="0 0 0"/></visual><asset>'
        '<material name="white" emission="1" rgba="1 1 1 1"/></asset><worldbody><camera name="c" pos="0 0 2"/>'
        '<body><joint type="slide" axis="1 0 0"/><geom type="box" size=".3 .3 .1" material="white"/></body>'
        "</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def _moved(model: Any, data: Any, x: float, time: float) -> Any:
    data.qpos[0], data.time = x, time
    mujoco.mj_forward(model, data)
    return data


def test_a_plate_that_moves_makes_events_at_its_edges() -> None:
    model, data = _plate()
    camera = morse.sensors_on(model).events("c", 60, 80, threshold=0.2)
    assert camera(_moved(model, data, 0.0, 1.0)).shape == (0, 4)
    events = camera(_moved(model, data, 0.2, 1.01))
    # from black to white, with the dark current of a pixel
    each = math.floor(math.log(1.002 / 0.002) / 0.2)
    focal = 30 / math.tan(math.radians(45 / 2))
    edges = [40 + focal * x / 1.9 for x in (-0.3, -0.1, 0.3, 0.5)]
    brighter = events[(events[:, 3] > 0) & (events[:, 1] == 30)]
    darker = events[(events[:, 3] < 0) & (events[:, 1] == 30)]
    for found, (left, right) in ((darker, edges[:2]), (brighter, edges[2:])):
        columns, counts = np.unique(found[:, 0], return_counts=True)
        assert columns.min() == pytest.approx(left - 0.5, abs=1)
        assert columns.max() == pytest.approx(right - 0.5, abs=1)
        assert np.median(counts) == each
    assert (np.diff(events[:, 2]) >= 0).all()
    assert 1.0 <= events[:, 2].min() < events[:, 2].max() <= 1.01
    # time that does not go on begins anew, and what stands makes no events
    assert camera(_moved(model, data, 0.0, 1.01)).shape == (0, 4)
    assert camera(_moved(model, data, 0.0, 2.0)).shape == (0, 4)


def test_events_without_a_reason_come_at_their_rate_and_depend_on_the_seed() -> None:
    model, data = _plate()
    found = []
    for seed in (1, 1, 2):
        camera = morse.sensors_on(model, seed=seed).events("c", 60, 80, noise_rate=5.0, threshold_deviation=0.05)
        camera(_moved(model, data, 0.0, 0.0))
        found.append(camera(_moved(model, data, 0.0, 1.0)))
    assert np.array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])
    # a Poisson process: five standard deviations
    assert len(found[0]) == pytest.approx(5 * 60 * 80, abs=5 * math.sqrt(5 * 60 * 80))


_ASKED: list[tuple[str, Callable[[Any], object]]] = [
    ("There is no laser scanner 'VLP6'; did you mean 'VLP16'", lambda s: s.lidar("VLP6", at="roof")),
    ("no site or body or camera or geom 'rof'; did you mean 'roof'", lambda s: s.lidar(at="rof")),
    ("LaserScanner has no property 'resolutio'", lambda s: s.lidar(at="roof", resolutio=1)),
    ("property 'laser_range' of LaserScanner is -1, expected", lambda s: s.lidar(at="roof", laser_range=-1)),
    ("at least 0, got -1", lambda s: s.lidar(at="roof", noise=-1)),
    ("The model has no site 'x'; there are the site names: roof, tail", lambda s: s.imu(at="site:x")),
    ("There is no imu 'BMI08'; did you mean 'BMI088'", lambda s: s.imu("BMI08", at="roof")),
    ("no camera 'frnt'; did you mean 'front'", lambda s: s.depth("frnt")),
    ("property 'depth_noise' of the depth camera is -1", lambda s: s.depth("front", noise=-1)),
    ("0 < near < far; got 3 and 2 m", lambda s: s.depth("front", near=3, far=2)),
    ("no camera 'frnt'; did you mean 'front'", lambda s: s.events("frnt")),
    ("threshold of an event camera is from 0.01 to 5, got 0", lambda s: s.events("front", threshold=0)),
    ("noise_rate of an event camera is from 0 to 1000, got nan", lambda s: s.events("front", noise_rate=math.nan)),
    ("no body 'cr'; did you mean 'car'", lambda s: s.thermal("front", {"cr": 1.0})),
    ("The temperature 'car' is a number of degrees Celsius, got nan", lambda s: s.thermal("front", {"car": math.nan})),
]


@pytest.mark.parametrize(("told", "ask"), _ASKED)
def test_mistakes_are_told(told: str, ask: Callable[[Any], object]) -> None:
    with pytest.raises(ValueError, match=told.replace("?", r"\?")):
        ask(morse.sensors_on(_state()[0]))


def test_states_of_other_models_are_refused() -> None:
    model, _ = _state()
    empty = mujoco.MjModel.from_xml_string("<mujoco/>")
    sensors = morse.sensors_on(model)
    for sensor in (sensors.lidar(at="roof"), sensors.imu(at="roof"), sensors.depth("front")):
        with pytest.raises(ValueError, match="The state is one of another model"):
            sensor(mujoco.MjData(empty))


def test_a_lidar_on_the_ant_of_gymnasium() -> None:
    found = importlib.util.find_spec("gymnasium")
    assert found is not None
    assert found.submodule_search_locations
    model = mujoco.MjModel.from_xml_path(str(Path(found.submodule_search_locations[0]) / "envs/mujoco/assets/ant.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 20)
    mujoco.mj_forward(model, data)
    scan = morse.sensors_on(model).lidar("VLP16", at="torso")(data)
    ways = scan.points[scan.geoms >= 0] / scan.ranges[scan.geoms >= 0, None]
    rotation = data.body("torso").xmat.reshape(3, 3)
    # it sees nothing but the floor: its legs are its own
    assert set(np.unique(scan.geoms)) == {-1, 0}
    down = (ways @ rotation.T)[:, 2]
    assert scan.ranges[scan.geoms >= 0] == pytest.approx(-data.body("torso").xpos[2] / down)
