"""Errors in a scene script: the line, the given value, and the expected value."""

import os
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import morse
from morse.builder import workspace
from morse.builder.script import ScriptError, is_loading, load_scene
from morse.middleware import registry
from morse.scene import Scene
from morse.simulation.options import RunOptions
from tests.kit.effort import examples

Load = Callable[..., Scene]

HEAD = "from morse.builder import *\n"
END = "env = Environment('empty')\n"
OURS = os.path.dirname(os.path.abspath(morse.__file__))


def failure(load: Load, text: str, **options: object) -> ScriptError:
    with pytest.raises(ScriptError) as caught:
        load(text, **options)
    report = caught.value.report()
    assert OURS not in report.replace(f"searched: {OURS}", ""), "no line of ours in what the user reads"
    assert "Traceback" not in report
    return caught.value


# error, line, words of the report
# fmt: off
MISTAKES = [
    ("rover = FakeRobot()\nrover.translate(1e300)\n" + END, 2, ["'rover' is 1e+300 m away", "at most 1e+09 m"]),
    ("rover = FakeRobot()\nrover.append(Pose)\n" + END, 3, ["FakeRobot.append takes a component", "write Pose()"]),
    ("rover = FakeRobot(\n" + END, 2, ["SyntaxError", "'(' was never closed"]),
    ("  rover = FakeRobot()\n" + END, 2, ["IndentationError", "unexpected indent"]),
    ("rover = FakeRobott()\n" + END, 2, ["'FakeRobott' is not defined", "Did you mean 'FakeRobot'?"]),
    ("rover = fakerobot()\n" + END, 2, ["'fakerobot' is not defined", "Did you mean 'FakeRobot'?"]),
    ("rover = FakeRobot()\nrover.transalte(1)\n" + END, 3, ["'transalte'", "did you mean 'translate'"]),
    ("rover = FakeRobot()\nrover.translate('one')\n" + END, 3, ["FakeRobot.translate(x) takes a number, got 'one'"]),
    (
        "rover = FakeRobot()\nrover.translate(1, 2, 3, 4)\n" + END,
        3,
        ["takes from 1 to 4", "translate(x=0.0"],
    ),
    (
        "rover = FakeRobot(nam='x')\n" + END,
        2,
        ["keyword argument 'nam'", "Did you mean 'name'?", "(name=None)"],
    ),
    (
        "rover = FakeRobot()\nrover.rotate(yaw=1)\n" + END,
        3,
        ["keyword argument 'yaw'", "rotate(x=0.0, y=0.0"],
    ),
    ("from morse.builder import Posee\n" + END, 2, ["no 'Posee' in 'morse.builder'", "Did you mean 'Pose'?"]),
    ("from morse.builder.sensors import Pos\n" + END, 2, ["no 'Pos' in", "Did you mean 'Pose'?"]),
    ("import morse.bilder\n" + END, 2, ["no module 'morse.bilder'", "Did you mean 'morse.builder'?"]),
    ("from ranger_sim.builder import Ranger\n" + END, 2, ["no module 'ranger_sim'", "folder 'src'"]),
    ("import json.qqq\n" + END, 2, ["no module 'json.qqq'", "If 'qqq' was deleted or renamed"]),
    ("print(math.squareroot(2))\n" + END, 2, ["squareroot"]),
    ("print(math.flor(2))\n" + END, 2, ["flor", "Did you mean 'floor'?"]),
    ("a = FakeRobot()\na.append(Pose)\n" + END, 3, ["append takes a component such as Pose()"]),
    ("a = FakeRobot()\na.add_default_interface('sokcet')\n" + END, 3, ["'sokcet'", "did you mean 'socket'"]),
    ("o = Odometry()\no.level('raww')\n" + END, 3, ["no level 'raww'", "raw, differential, integrated", "'raw'?"]),
    ("p = Pose()\np.alter('Noize')\n" + END, 3, ["'Noize'"]),
    (
        "r = Robot('mrosy')\n" + END,
        2,
        ["no model 'mrosy'", "mean 'morsy'", "searched: ", "MORSE_RESOURCE"],
    ),
    ("e = Environment('sandbx')\n", 2, ["no model 'sandbx'", "did you mean 'sandbox'"]),
    (END + "env.set_gravity(float('nan'))\n", 3, ["env.set_gravity(gravity) takes a finite number, got nan"]),
    (END + "env.set_camera_loction([1, 2, 3])\n", 3, ["did you mean 'set_camera_location'"]),
    (END + "env.set_time_scale()\n", 3, ["slowdown_by", "accelerate_by"]),
    ("bpymorse.get_object('Ground')\n" + END, 2, ["no object 'Ground'"]),
    ("p = Pose()\n" + END, 2, ["'p' (Pose) is not attached to a robot", "robot.append(p)"]),
    ("x = {}['speed']\n" + END, 2, ["KeyError: 'speed'"]),
    ("x = 1 / 0\n" + END, 2, ["ZeroDivisionError: division by zero"]),
    ("raise RuntimeError('out of paint')\n", 2, ["RuntimeError: out of paint"]),
    ("def f():\n    f()\nf()\n", 3, ["infinite recursion"]),
    ("sys.exit('no licence')\n" + END, 2, ["sys.exit('no licence')"]),
    ("assert False, 'never'\n" + END, 2, ["AssertionError: never"]),
    ("Zone('Charging').rotate(z=1)\n" + END, 2, ["cannot be rotated"]),
    ("c = Cube()\nc._bpy_object.game.mas = 3\n" + END, 3, ["mas"]),
    ("c = Cube()\nprint(c._bpy_object.game.mas)\n" + END, 3, ["did you mean 'mass'"]),
]
# fmt: on


@pytest.mark.parametrize(("text", "line", "words"), MISTAKES, ids=[m[2][0][:30] for m in MISTAKES])
def test_mistakes(load: Load, tmp_path: Path, text: str, line: int, words: list[str]) -> None:
    error = failure(load, HEAD + text)
    report = error.report()
    assert error.where is not None
    assert (error.where.file, error.where.line) == (str(tmp_path / "scene.py"), line)
    for word in words:
        assert word in report
    assert report.startswith(f"{tmp_path / 'scene.py'}:{line}: ")
    assert (HEAD + text).splitlines()[line - 1].strip() in report, "the line itself is shown"


def test_forgotten_import(load: Load) -> None:
    error = failure(load, "robot = Morsy()\n")
    assert "from morse.builder import *" in error.report()


def test_no_environment(load: Load) -> None:
    report = failure(load, HEAD + "robot = FakeRobot()\n").report()
    assert "creates no Environment" in report
    assert "Environment('sandbox')" in report
    assert "scene.py" in report


def test_empty_scripts(load: Load) -> None:
    for text in ("", "\n", "# nothing\n", "pass"):
        assert "creates no Environment" in failure(load, text).report()


def test_the_way_to_the_mistake_is_shown(load: Load, tmp_path: Path) -> None:
    error = failure(
        load,
        HEAD + "def equip(robot):\n    robot.apend(Pose())\n\ndef build():\n    equip(FakeRobot())\n\nbuild()\n" + END,
    )
    assert [step.where.line for step in error.steps] == [8, 6, 3]
    assert error.where is not None
    assert error.where.line == 3
    assert f"called from {tmp_path / 'scene.py'}:8: build()" in error.report()


def test_endless_calls_fill_no_screen(load: Load) -> None:
    report = failure(load, HEAD + "def f():\n    f()\nf()\n" + END).report()
    assert len(report.splitlines()) < 15
    assert "more calls" in report


def test_a_script_may_go_on_without_a_model(load: Load) -> None:
    scene = load(
        HEAD + "try:\n    rover = Robot('no_such_rover')\nexcept FileNotFoundError:\n    rover = FakeRobot()\n" + END
    )
    assert [c.name for c in scene.components] == ["rover"]


def test_mistakes_in_modules_of_the_project(load: Load, tmp_path: Path) -> None:
    package = tmp_path / "src" / "fleet"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "rovers.py").write_text(HEAD + "\nclass Rover(FakeRobot):\n    def __init__(self):\n        self.x()\n")
    error = failure(load, HEAD + "from fleet.rovers import Rover\nr = Rover()\n" + END, source="src")
    assert error.where is not None
    assert (Path(error.where.file).name, error.where.line) == ("rovers.py", 5)
    assert f"called from {tmp_path / 'scene.py'}:3" in error.report()
    (package / "rovers2.py").write_text("class Rover(:\n")
    error = failure(load, HEAD + "from fleet.rovers2 import Rover\n" + END, source="src")
    assert error.where is not None
    assert (Path(error.where.file).name, error.where.line) == ("rovers2.py", 1)
    error = failure(load, HEAD + "from fleet.rover import Rover\n" + END, source="src")
    assert "Did you mean 'fleet.rovers" in error.report()


def test_mistakes_inside_libraries_are_told_by_the_users_line(load: Load) -> None:
    error = failure(load, HEAD + "import json\njson.loads('{')\n" + END)
    assert error.where is not None
    assert error.where.line == 3
    assert "JSONDecodeError" in error.report()


def test_a_client_is_not_a_scene(load: Load) -> None:
    # nobody listens on port 1
    error = failure(load, HEAD + "from pymorse import Morse\nwith Morse('127.0.0.1', 1) as simu:\n    pass\n")
    assert error.where is not None
    assert error.where.line == 3
    assert "start it with python3" in error.mend
    assert "pymorse.py" not in error.report()


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("from knot_b import y\nx = 1", "from knot_a import x\ny = 2"),
        ("import knot_b\nx = 1", "import knot_a\ny = knot_a.x"),
    ],
)
def test_modules_that_import_each_other(load: Load, tmp_path: Path, first: str, second: str) -> None:
    source = tmp_path / "src"
    source.mkdir()
    (source / "knot_a.py").write_text(first)
    (source / "knot_b.py").write_text(second)
    error = failure(load, "import knot_a\n" + END)
    assert "circular import: knot_a imports knot_b, which imports knot_a, which has no 'x' yet" in error.message
    assert "import of 'knot_b' in the function of 'knot_a'" in error.mend
    assert [Path(step.where.file).name for step in error.steps] == ["scene.py", "knot_a.py", "knot_b.py"]


@pytest.mark.parametrize("module", ["no_such_rospy", "no_such_rospy.core", "no_such_tf"])
def test_a_module_of_ros_1_that_is_missing(load: Load, monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    ros = replace(registry.middleware("ros"), modules=("no_such_rospy",), imports=("no_such_tf",))
    monkeypatch.setattr(registry, "installed", lambda: {"ros": ros})
    error = failure(load, f"import {module}\n" + END)
    assert error.where is not None
    assert error.where.line == 1
    for way in ("apt install", "add_stream('ros2')", "add_stream('rosbridge')"):
        assert way in error.mend


@pytest.mark.parametrize("line", ["PassiveObject('props/objects', 'RedBox')", "bpymorse.get_object('RedBox')"])
def test_an_object_of_a_world_is_said_to_be_there(load: Load, line: str) -> None:
    with pytest.raises(ScriptError, match="it is in the worlds indoors-1/boxes, indoors-1/indoor-1"):
        load(f"{HEAD}thing = {line}\n{END}")


def test_broken_component_class(load: Load, project: Path) -> None:
    (project / "sonars" / "sonar.py").write_text("import no_such_library\n")
    error = failure(
        load,
        HEAD + "from sonars.builder import Sonar\nr = FakeRobot()\ns = Sonar()\nr.append(s)\n" + END,
        source="src",
    )
    assert [(Path(s.where.file).name, s.where.line) for s in error.steps] == [("scene.py", 4), ("builder.py", 6)]
    assert "no_such_library" in error.report()
    assert "sonar.py:1" in error.report()


def test_class_of_a_robot_that_is_not_there(load: Load) -> None:
    error = failure(load, HEAD + "r = FakeRobot()\nr.properties(classpath='no_such.robots.Rover')\n" + END)
    assert error.where is not None
    assert error.where.line == 2
    assert "no_such" in error.report()


@pytest.mark.parametrize("content", [b"\x00\x01", b"\xff\xfe\x00", b"# coding: klingon\n", b"x = '\x80'\n"])
def test_files_that_are_no_text(tmp_path: Path, content: bytes) -> None:
    script = tmp_path / "scene.py"
    script.write_bytes(content)
    with pytest.raises(ScriptError) as caught:
        load_scene(RunOptions(str(script)))
    assert "scene.py" in caught.value.report()


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / "nothing.py", tmp_path, tmp_path / "nothing.blend"):
        with pytest.raises(ScriptError) as caught:
            load_scene(RunOptions(str(path)))
        assert str(path) in caught.value.report()


def test_deeply_nested_source(load: Load) -> None:
    error = failure(load, "x = " + "(" * 5000 + ")" * 5000 + "\n")
    assert "scene.py" in error.report()


def test_leaving_early_with_success_is_fine(load: Load) -> None:
    assert isinstance(load(HEAD + END + "sys.exit(0)\n"), Scene)
    assert isinstance(load(HEAD + END + "sys.exit()\n"), Scene)


def test_ctrl_c_is_not_a_mistake(load: Load) -> None:
    with pytest.raises(KeyboardInterrupt):
        load(HEAD + "raise KeyboardInterrupt\n")
    assert not is_loading()


# --- how a script is run -------------------------------------------------------------------------


def test_the_script_is_main(load: Load, tmp_path: Path) -> None:
    scene = load(
        HEAD + "assert __name__ == '__main__'\n"
        "assert __file__ == sys.argv[0]\n"
        "robot = FakeRobot(sys.argv[1] + sys.argv[2])\n" + END,
        name="scene",
        arguments=("ro", "ver"),
    )
    assert scene.components[0].name == "rover"
    assert sys.modules["__main__"].__dict__.get("robot") is None


def test_classes_of_the_script_find_their_module(load: Load) -> None:
    scene = load(
        "from __future__ import annotations\n"
        "import dataclasses, typing\n" + HEAD + "@dataclasses.dataclass\nclass Plan:\n    robots: int = 2\n"
        "assert typing.get_type_hints(Plan) == {'robots': int}\n"
        "fleet = [FakeRobot() for i in range(Plan().robots)]\n" + END
    )
    assert len(scene.robots()) == 2


def test_packages_of_the_project_come_first(load: Load, tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "colors_of_rovers.py").write_text("WHO = 'src'\n")
    (tmp_path / "colors_of_rovers.py").write_text("WHO = 'beside'\n")
    (tmp_path / "beside_only.py").write_text("X = 1\n")
    before = list(sys.path), list(sys.argv), set(sys.modules)
    scene = load(
        HEAD + "import beside_only\nfrom colors_of_rovers import WHO\nr = FakeRobot(WHO)\n" + END, source="src"
    )
    assert scene.components[0].name == "src"
    assert (sys.path, sys.argv) == before[:2]
    assert not {"beside_only", "colors_of_rovers"} & (set(sys.modules) - before[2])


def test_models_of_the_project_are_found(tmp_path: Path) -> None:
    crates = Path(OURS) / "data" / "props" / "crates.blend"
    (tmp_path / "data" / "sim" / "robots").mkdir(parents=True)
    (tmp_path / "data" / "sim" / "robots" / "boxy.blend").write_bytes(crates.read_bytes())
    script = tmp_path / "default.py"
    script.write_text(HEAD + "r = GroundRobot('sim/robots/boxy.blend')\n" + END)
    scene = load_scene(RunOptions(str(script), resource_paths=[str(tmp_path / "data")]))
    parts = {node.plain_name for node in scene.components[0].node.walk()}
    assert {"small_crate_mesh", "large_crate_mesh"} <= parts
    elsewhere = tmp_path / "other" / "default.py"
    elsewhere.parent.mkdir()
    elsewhere.write_text(script.read_text().replace("boxy.blend", "box.blend"))
    with pytest.raises(ScriptError, match="boxy"):
        load_scene(RunOptions(str(elsewhere)))


def test_a_model_as_script_is_an_empty_world() -> None:
    path = Path(OURS) / "data" / "environments" / "indoors-1" / "boxes.blend"
    scene = load_scene(RunOptions(str(path)))
    assert scene.components == []
    assert scene.find("RedBox") is not None


def test_broken_models_are_told(load: Load, tmp_path: Path) -> None:
    (tmp_path / "broken.blend").write_bytes(b"BLENDER-v279" + b"\x00" * 50)
    error = failure(load, HEAD + f"r = Robot({str(tmp_path / 'broken.blend')!r})\n" + END)
    assert error.where is not None
    assert error.where.line == 2
    assert "broken.blend" in error.report()


def test_each_script_begins_with_an_empty_scene(load: Load) -> None:
    first = load(HEAD + "a = FakeRobot()\n" + END)
    second = load(HEAD + "b = FakeRobot()\n" + END)
    assert [c.name for c in first.components] == ["a"]
    assert [c.name for c in second.components] == ["b"]


def test_a_script_knows_that_it_is_a_scene(load: Load) -> None:
    scene = load(
        HEAD + "from morse.builder.script import is_loading\nr = FakeRobot('yes' if is_loading() else 'no')\n" + END
    )
    assert scene.components[0].name == "yes"
    assert not is_loading()


SCRIPT = (
    HEAD + "robot = Morsy()\nrobot.translate(1.0, 0.0, 0.0)\nrobot.rotate(0.0, 0.0, 3.5)\n"
    "motion = MotionVW()\nrobot.append(motion)\nkeyboard = Keyboard()\n"
    "keyboard.properties(ControlType='Position')\nrobot.append(keyboard)\npose = Pose()\nrobot.append(pose)\n"
    "robot.add_default_interface('socket')\n"
    "env = Environment('empty', fastmode=False)\n"
    "env.set_camera_location([-18.0, -6.7, 10.8])\nenv.set_camera_rotation([1.09, 0, -1.14])\n"
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=examples(150), deadline=None)
@given(start=st.integers(0, len(SCRIPT)), length=st.integers(0, 12), put=st.text("abcPM()[]'=.,:0 \n#", max_size=4))
def test_damaged_scripts_give_a_scene_or_a_report(tmp_path: Path, start: int, length: int, put: str) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT[:start] + put + SCRIPT[start + length :], encoding="utf-8")
    try:
        assert load_scene(RunOptions(str(script))).environment
    except ScriptError as error:
        report = error.report()
        assert "scene.py" in report
        assert "Traceback" not in report
    finally:
        workspace.reset()


@pytest.mark.parametrize(
    ("text", "answers"),
    [
        ("sonar = Sonar()\n", ["no sensor Sonar yet", "Pose", "morse add sensor"]),
        ("sonar = sonar()\n", ["no sensor Sonar yet"]),
        ("from morse.builder import Winch\n", ["no actuator Winch yet", "MotionVW"]),
        ("from morse.builder.sensors import Sonar\n", ["no sensor Sonar yet"]),
        ("robot = Mule()\n", ["no robot Mule yet", "Morsy"]),
        ("camera = Camera()\ncamera.add_stream('socket')\n", ["viewpoint", "not a sensor", "VideoCamera()"]),
    ],
)
def test_what_this_version_lacks_is_said_plainly(
    load: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch, text: str, answers: list[str]
) -> None:
    from morse.builder.errors import explain

    lacking = {"sensor": ("Sonar",), "actuator": ("Winch",), "robot": ("Mule",)}
    monkeypatch.setattr(explain, "_OF_1_4", lacking)
    with pytest.raises(ScriptError) as caught:
        load(HEAD + text + END)
    for answer in answers:
        assert answer in caught.value.report()


def test_a_modifier_that_is_not_there_is_said_with_those_that_are(load: Callable[..., Scene]) -> None:
    with pytest.raises(ScriptError, match=r"no modifier 'NEDD' for Pose.*'NED'"):
        load(HEAD + "pose = Pose()\npose.alter('NEDD')\n" + END)
    with pytest.raises(ScriptError, match=r"no modifier 'Wobble' for Pose.*NED"):
        load(HEAD + "pose = Pose()\npose.alter('Wobble')\n" + END)
    with pytest.raises(ScriptError, match="the modifier 'OdometryNoise' is for Odometry, not for Pose"):
        load(HEAD + "pose = Pose()\npose.alter('OdometryNoise')\n" + END)


def test_nothing_that_exists_is_said_to_be_missing() -> None:
    import morse.builder
    from morse.builder.errors.explain import missing_component

    assert [name for name in morse.builder.__all__ if missing_component(name) is not None] == []


@pytest.mark.parametrize(
    "text",
    ["robot.rotate(z=90)\n", "robot.rotate(-45.0)\n", "robot.rotation_euler = (0, 0, 180)\n"],
)
def test_angles_in_degrees_get_a_hint(load: Callable[..., Scene], text: str, caplog: pytest.LogCaptureFixture) -> None:
    load(HEAD + "robot = FakeRobot()\n" + text + END)
    (message,) = [record.getMessage() for record in caplog.records if "radians" in record.getMessage()]
    assert "scene.py:3:" in message
    assert "math.radians(" in message


def test_angles_of_a_turn_get_no_hint(load: Callable[..., Scene], caplog: pytest.LogCaptureFixture) -> None:
    load(HEAD + "robot = FakeRobot()\nrobot.rotate(math.pi, -2 * math.pi, 6)\n" + END)
    assert "radians" not in caplog.text


@pytest.mark.parametrize(
    ("text", "line", "answer"),
    [
        ("robot = Morsy('my robot')\n", 2, "write 'my_robot'"),
        ("robot = Morsy('a\\tb')\n", 2, "write 'a_b'"),
        ("pose = Pose()\npose.name = 'my pose'\n", 3, "write 'my_pose'"),
        (END + "env.simulator_frequency(1e-9)\n", 3, "at least 0.1, got 1e-09"),
        (END + "env.simulator_frequency(1e9)\n", 3, "at most 10000, got 1e+09"),
        ("pose = Pose()\npose.frequency(1e9)\n", 3, "at most 10000, got 1e+09"),
        (END + "env.set_camera_clip(5, 5)\n", 3, "greater than 5, got 5"),
    ],
)
def test_values_that_cannot_be_are_refused_in_their_line(
    load: Callable[..., Scene], text: str, line: int, answer: str
) -> None:
    with pytest.raises(ScriptError, match=re.escape(answer)) as caught:
        load(HEAD + text + ("" if END in text else END))
    assert caught.value.where is not None
    assert caught.value.where.line == line
    assert len(str(caught.value).splitlines()) == 1


def test_objects_may_have_blanks_in_their_names(load: Callable[..., Scene]) -> None:
    assert load(HEAD + "Cube('my box')\n" + END).roots[0].name == "my box"


def test_a_script_beside_a_project_is_told_where_its_classes_are_known(tmp_path) -> None:
    (tmp_path / "rover_sim" / "src" / "rover_sim" / "builder").mkdir(parents=True)
    script = tmp_path / "scene.py"
    script.write_text("from morse.builder import *\nfrom rover_sim.builder import Rover\nenv = Environment('empty')\n")
    with pytest.raises(ScriptError) as error:
        load_scene(RunOptions(script=str(script)))
    assert f"the project {tmp_path / 'rover_sim'}" in error.value.report()


@pytest.mark.parametrize(
    "creation",
    [
        "ATRV('a.b')",
        "Morsy(3)",
        "Human(name='a.b')",
        "BasePR2('a.b')",
        "Robot('nope')",
        "Human('nope')",
        "Pose('a.b')",
        "Kinect('a.b')",
        "KukaLWR('a.b')",
        "PTU('a.b')",
        "VLP16_180('a.b')",
        "Hokuyo('a.b')",
        "CompoundSensor([3])",
        "Cube('a.b')",
        "Armature('nope')",
        "PassiveObject('props/nope')",
    ],
)
def test_nothing_stays_of_a_component_that_could_not_be_created(load: Load, creation: str) -> None:
    first = "robot = ATRV()\nrobot.append(Pose())\n"
    attempt = f"try:\n    {creation}\nexcept Exception:\n    pass\nelse:\n    assert False\n"
    scenes = [load(HEAD + first + middle + "other = ATRV()\n" + END) for middle in (attempt, "")]
    names = [[re.sub(r"\.\d+$", "", node.name) for root in s.roots for node in root.walk()] for s in scenes]
    assert names[0] == names[1]
