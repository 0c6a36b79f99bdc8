"""A scene is fitted to logs of the same scene with other values; mistakes are told."""

import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseError
from morse.many import Twin
from morse.plugins.twin import command as twin_command
from morse.plugins.twin import parameters
from morse.plugins.twin.identifiability import relations
from morse.plugins.twin.parameters import Parameter
from morse.plugins.twin.replay import Simulations

SCRIPT = """
from morse.builder import *

robot = Pioneer3DX("robot")
motion, pose, imu = MotionVWDiff("motion"), Pose("pose"), IMU("imu")
pose.frequency(20)
for part in (motion, pose, imu):
    robot.append(part)
env = Environment("empty")
"""
PLANTED = {
    "robot.wheel_radius": 0.104,
    "robot.track": 0.36,
    "robot.motion.lag": 0.12,
    "robot.motion.delay": 0.045,
    "robot.imu.bias.angular_velocity.z": 0.015,
}
NOISE = 'pose.noise(gaussian=0.01)\nimu.noise(gaussian=0.02)\nenv.preset("planted.json")\n'


def preset_file(folder, values, name="planted.json"):
    (folder / name).write_text(json.dumps({"morse preset": 1, "values": values}))


def record(scene, path, seconds=10.0, seed=3):
    rng = np.random.default_rng(seed)
    with morse.load(scene, seed=seed) as sim, sim.record(path):
        for _ in range(round(seconds)):
            v, w = 0.8 * rng.uniform(-1.0, 1.0), 1.2 * rng.uniform(-1.0, 1.0)
            for _ in range(10):
                sim.robot.motion.publish({"v": v, "w": w})
                sim.step(6)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A scene, and a log of the scene with planted values and noise."""
    folder = tmp_path_factory.mktemp("twin")
    (folder / "scene.py").write_text(SCRIPT)
    (folder / "real.py").write_text(SCRIPT + NOISE)
    preset_file(folder, PLANTED)
    record(folder / "real.py", folder / "drive.mcap")
    return folder


@pytest.fixture(scope="module")
def fitted(folder):
    names = ["wheel_radius", "track", "motion.lag", "motion.delay", "imu.bias.angular_velocity"]
    return Twin(folder / "drive.mcap", folder / "scene.py", fit=names).fit(workers=0)


@pytest.mark.parametrize("name", PLANTED)
def test_planted_values_are_found(fitted, name):
    error = abs(fitted.values[name] - PLANTED[name])
    assert error < max(0.02 * PLANTED[name], 3.0 * fitted.spreads[name])
    # the log tells them well
    assert fitted.spreads[name] < 0.1 * PLANTED[name]


def test_what_is_left_is_the_noise(fitted):
    for name in ("robot.pose.x", "robot.pose.y", "robot.pose.yaw"):
        assert fitted.errors[name] == pytest.approx(0.01, rel=0.15)
        assert fitted.errors_before[name] > 2.0 * fitted.errors[name]
    assert fitted.errors["robot.imu.angular_velocity.z"] == pytest.approx(0.02, rel=0.1)


def test_the_page_the_preset_and_the_test(folder, fitted):
    fitted.write(report=folder / "twin.html", preset=folder / "found.json", test=folder / "test_drive.py")
    page = (folder / "twin.html").read_text("utf-8")
    assert page.count("<svg") > 10
    assert "robot.wheel_radius" in page
    # one page, without anything from elsewhere
    assert not re.search(r"<script|src=|href=|url\(|@import", page)
    (folder / "found.py").write_text(SCRIPT + 'env.preset("found.json")\n')
    with morse.load(folder / "found.py") as sim:
        robot = sim.context.robots["robot"]
        sim.robot.motion.publish({"v": 0.5})
        sim.step(120)
        v = sim.context.components["robot.motion"].local_data["v"]
    assert v == pytest.approx(0.5 * fitted.values["robot.wheel_radius"] / robot.wheel_radius, rel=1e-6)
    words = [sys.executable, "-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", str(folder / "test_drive.py")]
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder, timeout=300, check=False)
    assert done.returncode == 0, done.stdout
    # a scene with other wheels fails
    preset_file(folder, {**fitted.values, "robot.wheel_radius": 0.11}, "found.json")
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder, timeout=300, check=False)
    assert done.returncode == 1, done.stdout


def test_the_command(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    from pathlib import Path

    table = Path("links.toml")
    assert twin_command.command("drive.mcap", "scene.py", ["wheel_radius"], ["track"], table=table, workers=0) == 0
    shown = capsys.readouterr().out
    assert "robot.wheel_radius = 0.1" in shown
    assert "robot.track = 0.3" in shown
    assert "links.toml has this table" in shown
    # the table that was written says the same
    again = Twin("drive.mcap", "scene.py", table=table)
    assert [str(link) for link in again.links] == [str(link) for link in Twin("drive.mcap", "scene.py").links]


def test_the_help_has_names_of_parameters(folder):
    """Those of a robot on wheels are parameters of the scene."""
    words = set(re.findall(r"[\w.]+", twin_command.command.__doc__))
    known = Twin(folder / "drive.mcap", folder / "scene.py")._named
    for kind in ("mass", "friction", "wheel_radius", "track", "motion.lag", "motion.gain.v", "imu.delay", "imu.bias"):
        assert kind in words
        assert known.find([f"robot.{kind}"])
    assert {f"elbow.{what}" for what in parameters._JOINT} < words


def test_an_input_is_not_overwritten(folder, monkeypatch):
    from pathlib import Path

    monkeypatch.chdir(folder)
    with pytest.raises(MorseError, match=r"scene\.py is an input"):
        twin_command.command("drive.mcap", "scene.py", report=Path("scene.py"))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"report": "nowhere/page.html"}, "there is no folder nowhere"),
        ({"preset": "."}, "is a folder"),
        ({"fit": ["track"], "test": "test_x.py"}, "--test needs --preset"),
    ],
)
def test_what_cannot_be_written_is_told_before_the_fit(folder, monkeypatch, options, text):
    from pathlib import Path

    monkeypatch.chdir(folder)
    monkeypatch.setattr(Twin, "fit", lambda *_, **__: pytest.fail("it was fitted first"))
    paths = {name: value if name == "fit" else Path(value) for name, value in options.items()}
    with pytest.raises(MorseError, match=text):
        twin_command.command("drive.mcap", "scene.py", **paths)


def test_without_parameters_the_scene_is_compared(folder):
    fitted = Twin(folder / "drive.mcap", folder / "scene.py").fit(workers=0)
    assert fitted.values == {}
    assert fitted.errors == fitted.errors_before
    with pytest.raises(MorseError, match="path of a scene script"):
        Twin(folder / "drive.mcap", lambda: exec(SCRIPT, {})).fit(workers=0).write(test=folder / "test_x.py")


def test_parameters_without_effect_are_told(folder):
    """The pose of an actuator changes nothing, nor does the mass of a robot on a floor at constant speeds."""
    twin = Twin(folder / "drive.mcap", folder / "scene.py", fit=["motion.place.x", "wheel_radius"])
    fitted = twin.fit(workers=0, manoeuvre=False)
    assert "robot.motion.place.x has no effect here" in fitted.result.relations
    assert set(fitted.values) == {"robot.wheel_radius"}
    assert "robot.motion.place.x is not known from this log; it stays 0 m" in fitted.lines()


def test_a_manoeuvre_is_proposed_for_no_more_than_the_fit_costs(tmp_path, monkeypatch):
    """A robot that only drives straight on says nothing about its track; one that turns does."""
    simulated = []
    each = Simulations.each

    def counted(self, points, duration):
        simulated.append((self, len(points) * duration))
        return each(self, points, duration)

    monkeypatch.setattr(Simulations, "each", counted)
    (tmp_path / "scene.py").write_text(SCRIPT)
    lines = ["time,robot.motion.v,robot.motion.w,robot.pose.x,robot.pose.y,robot.pose.yaw"]
    rng = np.random.default_rng(1)
    lines += [f"{k / 10},0.5,0.0,{k * 0.053 + rng.normal(0.0, 0.01)},0.0,0.0" for k in range(50)]
    (tmp_path / "straight.csv").write_text("\n".join(lines))
    fitted = Twin(tmp_path / "straight.csv", tmp_path / "scene.py", fit=["wheel_radius", "track"]).fit(workers=0)
    assert "robot.track has no effect here" in fitted.result.relations
    assert "robot.motion.w between" in fitted.manoeuvre.text
    assert fitted.manoeuvre.spreads["robot.track"] < 0.05 * 0.34
    fit = simulated[0][0]
    of_fit = sum(seconds for one, seconds in simulated if one is fit)
    # one manoeuvre is always tried for 6 s, and then judged for 12 s with both parameters
    assert sum(seconds for one, seconds in simulated if one is not fit) <= max(of_fit, 2 * 6.0 + 3 * 12.0)


def test_processes_simulate_the_same_as_one(folder):
    twin = Twin(folder / "drive.mcap", folder / "scene.py", fit=["wheel_radius"])
    points = [{"robot.wheel_radius": radius} for radius in (0.09, 0.1, 0.11)]
    found = []
    for workers in (0, 2):
        with Simulations(twin._all, [twin.commands], {"robot.pose": ["x", "yaw"]}, workers) as simulations:
            found.append(simulations.each(points, 2.0))
            assert simulations.seconds == 6.0
    for one, other in zip(*found, strict=True):
        assert one["robot.pose"].fields["x"].tobytes() == other["robot.pose"].fields["x"].tobytes()


def test_what_only_together_has_an_effect_is_said_in_words():
    mass, friction = Parameter("r.mass", "r", 9.0, 9.0, low=0.0), Parameter("r.friction", "r", 0.7, 0.5, low=0.0)
    # the errors depend on the product alone: equal derivatives by the logarithms
    row = np.array([[1.0, 1.0]])
    assert relations([mass, friction], 1e6 * row.T @ row) == ["only r.mass × r.friction matters here"]
    row = np.array([[1.0, -1.0]])
    assert relations([mass, friction], 1e6 * row.T @ row) == ["only r.mass / r.friction matters here"]
    offset = Parameter("r.x", "r", 0.0, 0.1)
    row = np.array([[1.0, 1.0]])
    assert relations([offset, Parameter("r.y", "r", 0.0, 0.1)], 1e6 * row.T @ row) == [
        "only r.x + 1 · r.y matters here"
    ]
    assert relations([mass, friction], np.diag([1e6, 1e6])) == []


@pytest.mark.parametrize(
    ("names", "text"),
    [
        (["mas"], "there is no parameter 'mas'; did you mean 'mass'"),
        (["motion"], "'motion' is a component: name one of its parameters"),
        (["place.x"], "'place.x' is the name of several parameters"),
        (["pose.bias.xx"], "did you mean"),
        ([""], "there is no parameter"),
    ],
)
def test_wrong_names_are_refused(folder, names, text):
    if names == ["place.x"]:
        # the robot is meant
        assert [one.name for one in Twin(folder / "drive.mcap", folder / "scene.py", fit=names).parameters] == [
            "robot.place.x"
        ]
        return
    with pytest.raises(MorseError, match=text):
        Twin(folder / "drive.mcap", folder / "scene.py", fit=names)


def test_a_log_without_commands_is_refused(folder, tmp_path):
    with morse.load(folder / "scene.py") as sim, sim.record(tmp_path / "still.mcap"):
        sim.step(60)
    with pytest.raises(MorseError, match=r"has no commands for the actuators of the scene \(robot\.motion\).*--map"):
        Twin(tmp_path / "still.mcap", folder / "scene.py")


def test_a_scene_without_the_sensors_is_refused(folder, tmp_path):
    (tmp_path / "scene.py").write_text(
        "from morse.builder import *\nrobot = Pioneer3DX('robot')\nmotion = MotionVWDiff('motion')\n"
        "robot.append(motion)\nenv = Environment('empty')\n"
    )
    with pytest.raises(MorseError, match="has no measurements of the sensors of the scene"):
        Twin(folder / "drive.mcap", tmp_path / "scene.py")


def test_a_world_that_is_too_small_is_told(tmp_path):
    (tmp_path / "scene.py").write_text(SCRIPT)
    lines = ["time,robot.motion.v,robot.motion.w,robot.pose.x,robot.pose.y"]
    lines += [f"{k / 10},5.0,0.0,{k / 2},0.0" for k in range(600)]
    (tmp_path / "far.csv").write_text("\n".join(lines))
    with pytest.raises(MorseError, match=r"left the world.*too small"):
        Twin(tmp_path / "far.csv", tmp_path / "scene.py").fit(workers=0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{",
        '{"values": {}}',
        '{"morse preset": 2, "values": {}}',
        '{"morse preset": 1, "values": {"robot.mass": "heavy"}}',
        '{"morse preset": 1, "values": {"robot.mass": NaN}}',
        '{"morse preset": 1, "values": {"robot.mass": 1e999}}',
        '{"morse preset": 1, "values": {"robot.mass": true}}',
        f'{{"morse preset": 1, "values": {{"robot.mass": {10**400}}}}}',
        '{"morse preset": 1, "values": {"robot.mass": -1}}',
        '{"morse preset": 1, "values": {"robot.weight": 1}}',
        "[" * 100_000,
    ],
)
def test_wrong_presets_are_refused_with_the_line_of_the_script(tmp_path, text):
    (tmp_path / "scene.py").write_text(SCRIPT + 'env.preset("wrong.json")\n')
    (tmp_path / "wrong.json").write_text(text)
    with pytest.raises(MorseError) as error:
        morse.load(tmp_path / "scene.py")
    assert "scene.py:10: " in str(error.value)
    assert "OverflowError" not in str(error.value)


def test_a_preset_that_does_not_exist_is_named(tmp_path):
    (tmp_path / "scene.py").write_text(SCRIPT + 'env.preset("drve.json")\n')
    preset_file(tmp_path, {}, "drive.json")
    with pytest.raises(MorseError, match=r"did you mean 'drive\.json'"):
        morse.load(tmp_path / "scene.py")


def test_values_of_joints_links_and_properties_reach_the_scene(tmp_path):
    (tmp_path / "arm.urdf").write_text(
        "<robot name='arm'><link name='world'/><link name='upper'><inertial><origin xyz='0 0 0.2'/><mass value='3'/>"
        "<inertia ixx='0.06' iyy='0.06' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>"
        "<joint name='shoulder' type='revolute'><parent link='world'/><child link='upper'/><axis xyz='0 1 0'/>"
        "<limit lower='-2' upper='2' effort='200' velocity='5'/><dynamics damping='1' friction='0.5'/></joint></robot>"
    )
    (tmp_path / "scene.py").write_text(
        "from morse.builder import *\nrobot = Robot('arm.urdf')\narm = Armature('arm', armature_name='arm_joints')\n"
        "arm.gains(300.0, 20.0, ['shoulder'])\nrobot.append(arm)\nenv = Environment('empty')\nenv.preset('arm.json')\n"
    )
    values = {
        "robot.upper.mass": 6.0,
        "robot.shoulder.damping": 2.0,
        "robot.shoulder.gain": 400.0,
        "robot.arm.RotationSpeed": 0.5,
    }
    preset_file(tmp_path, values, "arm.json")
    with morse.load(tmp_path / "scene.py") as sim:
        (node,) = [one for one in sim.scene.nodes() if one.bones]
        assert node.bones[0].dynamics.damping == 2.0
        assert node.articulation.gains == (("shoulder", 400.0, 20.0),)
        (link,) = [one for one in sim.scene.nodes() if one.inertial is not None and one.inertial.mass]
        assert link.inertial.mass == 6.0
        assert link.inertial.inertia[0] == pytest.approx(0.12)
        assert sim.context.components["robot.arm"].bge_object["RotationSpeed"] == 0.5
    assert math.isfinite(link.inertial.mass)
