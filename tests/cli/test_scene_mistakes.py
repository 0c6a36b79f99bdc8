"""Mistakes in scenes: `morse check` and `morse run --strict` find each one, with its line and its mend."""

import gc
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from morse import builder
from morse.builder.script import build
from morse.core import declarations
from morse.core.classes.project_imports import ProjectImports
from morse.core.reports import log
from morse.launch.load import SceneWarningError, load
from morse.scene.scene_warnings import scene_warnings
from tests.cli.conftest import Terminal

HEAD = """\
from morse.builder import *
robot = ATRV()
robot.translate(z=0.1)
pose = Pose()
robot.append(pose)
motion = MotionVW()
robot.append(motion)
"""
ENV = "env = Environment('empty')\n"

#: a robot of a file with mistakes
URDF = """\
<robot name="cart">
  <link name="base"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.4 0.4 0.1"/></geometry></collision>
    <visual><geometry><mesh filename="no_such_mesh.stl"/></geometry></visual></link>
  <gazebo reference="base"><sensor name="imu" type="imu"><update_rate>500</update_rate></sensor></gazebo>
</robot>
"""

#: lines before the environment, the marked one with the mistake, and words of the message
WARNINGS = {
    "property of a sensor": ("gps = GPS()\ngps.properties(longitud=3.0)  #!\nrobot.append(gps)", "'longitud'"),
    "property of an actuator": ("motion.properties(ControlTyp='Position')  #!", "did you mean 'ControlType'?"),
    "property without a likeness": ("motion.properties(banana=1)  #!", "ControlType"),
    "degrees": ("robot.rotate(z=90)  #!", "math.radians(90)"),
    "negative degrees": ("pose.rotate(0, -45)  #!", "math.radians(-45)"),
    "a name twice on a robot": (
        "one, two = Pose('eye'), IMU('eye')  #!\nrobot.append(one)\nrobot.append(two)",
        "give it another name",
    ),
    "a name twice": ("other = Morsy('robot')  #!\nother.translate(x=5)\nrobot.name = 'robot'", "give it another name"),
    "robots in each other": ("other = Morsy()  #!", "move one object"),
    "robot in the floor": ("other = Morsy()  #!\nother.translate(x=4, z=-0.3)", "move one object"),
    "robot below the floor": ("other = Morsy()  #!\nother.translate(x=4, z=-4)", "set them above it"),
    "option of another middleware": ("pose.add_stream('socket', topic='/pose')  #!", "leave it out"),
    "stream that does not exist": (
        "pose.add_stream('ros2', 'morse.middleware.ros.pose.PosePublishr')  #!",
        "uses the usual stream",
    ),
    "profile of an actuator": ("motion.profile()  #!", "not a sensor"),
    "options of services": ("motion.add_service('socket', config={'port': 3})  #!", "no options"),
    "property of a robot": ("robot.properties(GroundRobt=True)  #!", "did you mean 'GroundRobot'?"),
    "appended twice": ("robot.append(pose)  #!", "leave it out"),
    "on two robots": (
        "other = Morsy()\nother.translate(x=4)\nother.append(pose)  #!",
        "create a component for each of them",
    ),
    "port of another stream": (
        "pose.add_stream('socket', port=61234)\nmotion.add_stream('socket', port=61234)  #!",
        "choose another one",
    ),
    "two drives": ("more = MotionXYW()  #!\nrobot.append(more)", "remove one of them"),
    "mesh left out": ("cart = Robot('cart.urdf')  #!\ncart.translate(x=5, z=0.2)", "no_such_mesh"),
    "sensor of a file": ("cart = Robot('cart.urdf')  #!\ncart.translate(x=5, z=0.2)", "frequency(hz)"),
}
#: the same, after the environment
LATER_WARNINGS = {
    "rate": ("pose.frequency(1000)  #!\nenv.simulator_frequency(60)", "it becomes 60 Hz"),
    "rate as a property": ("pose.properties(frequency=90)  #!\nenv.simulator_frequency(30)", "it becomes 30 Hz"),
    "rates in a loop": ("for one in (pose, motion):\n    one.frequency(100)  #!\nenv.simulator_frequency(10)", "10 Hz"),
    "property of the world": ("env.properties(longitud=3.0)  #!", "did you mean 'longitude'?"),
    "degrees of the Earth": ("env.properties(latitude=120)  #!", "from -90 to 90"),
    "is for ==": ("if robot is 3:  #!\n    pass", 'Did you mean "=="?'),
    "robot of another node": (
        "env.configure_multinode(distribution={'a': ['robbot']})  #!",
        "did you mean 'robot'?",
    ),
}
OLD_FORMS = {
    "name of a method": ("pose.configure_mw('socket')  #!", "add_stream"),
    "text for a number": ("robot.translate(x='0.5')  #!", "write 0.5"),
    "keyboard of a human": ("human = Human()\nhuman.translate(x=3)\nhuman.disable_keyboard_control()  #!", "no effect"),
}
LATER_OLD_FORMS = {
    "name of the camera's method": ("env.aim_camera([1, 0, 0])  #!", "set_camera_rotation"),
    "frames a second": ("env.simulator_frequency(fps=50)  #!", "base_frequency"),
    "without effect": ("env.set_background_scene('x')  #!", "leave it out"),
    "text for a truth": ("env.use_relative_time('yes')  #!", "write True"),
    "list of names": ("env.configure_multinode(distribution={'a': 'robot'})  #!", "['robot']"),
}
ERRORS = {
    "component": ("eye = Pos()  #!\n", "Did you mean 'Pose'?"),
    "method": ("robot.trnslate(x=1)  #!", "did you mean 'translate'?"),
    "argument": ("robot.translate(u=1)  #!", "Expected: "),
    "kind of a value": ("robot.translate(x='far')  #!", "takes a number"),
    "not a number": ("robot.translate(x=float('nan'))  #!", "finite number"),
    "value out of range": ("eye = VideoCamera()\neye.properties(cam_width=-5)  #!", "cam_width"),
    "word": ("motion.properties(ControlType='Velocty')  #!", "did you mean 'Velocity'?"),
    "middleware": ("pose.add_stream('sockt')  #!", "did you mean 'socket'?"),
    "class path of a middleware": ("pose.add_stream('pocolibs')  #!", "ros2"),
    "option": ("pose.add_stream('socket', prt=60001)  #!", "did you mean 'port'?"),
    "value of an option": ("pose.add_stream('socket', port=99999999)  #!", "65535"),
    "modifier": ("pose.alter('Nois')  #!", "did you mean 'Noise'?"),
    "option of a modifier": ("pose.alter('Noise', pos_sd=0.1)  #!", "did you mean 'pos_std'?"),
    "level": ("scan = Hokuyo()\nscan.level('raw_data')  #!\nrobot.append(scan)", "'raw_data'"),
    "not on a robot": ("eye = IMU()  #!", "robot.append(eye)"),
    "in itself": ("robot.append(robot)  #!", "part of it"),
    "space in a name": ("eye = IMU('my eye')  #!\nrobot.append(eye)", "my_eye"),
    "dot in a name": ("eye = IMU('my.eye')  #!\nrobot.append(eye)", "my_eye"),
    "rate of 0": ("pose.frequency(0)  #!", "greater than 0"),
    "model": ("thing = PassiveObject('props/objects', 'BoxStandd')  #!", "did you mean 'BoxStand'?"),
    "file": ("robot.append(Robot('nothing.urdf'))  #!", "nothing.urdf"),
    "module": ("import mathh  #!", "Did you mean 'math'?"),
    "division": ("x = 1 / 0  #!", "ZeroDivisionError"),
    "print of Python 2": ("print 'hello'  #!", "print(...)"),
    "colon": ("for i in range(3)  #!\n    pass", "':'"),
    "end of the script": ("import sys\nsys.exit('done')  #!", "Let the script run to its end"),
}
LATER_ERRORS = {
    "method of the environment": ("env.set_gravty(9.81)  #!", "did you mean 'set_gravity'?"),
    "gravity": ("env.set_gravity('strong')  #!", "takes a number"),
    "second environment": ("more = Environment('empty')  #!", "only one Environment"),
    "component of a log": ("env.set_log_level('core', 'loud')  #!", "'LOUD'"),
}


def _cases() -> list[object]:
    """Each mistake as a script, its kind, the number of its line, and the words."""
    cases = []
    for kind, early, late in (
        ("warning", WARNINGS, LATER_WARNINGS),
        ("old", OLD_FORMS, LATER_OLD_FORMS),
        ("error", ERRORS, LATER_ERRORS),
    ):
        for table, form in ((early, HEAD + "{}\n" + ENV), (late, HEAD + ENV + "{}\n")):
            for name, (lines, words) in table.items():
                text = form.format(lines)
                number = 1 + next(i for i, line in enumerate(text.splitlines()) if "#!" in line)
                cases.append(pytest.param(text, kind, number, words, id=f"{kind}: {name}"))
    return cases


@pytest.fixture
def project(morse: Terminal, monkeypatch: pytest.MonkeyPatch) -> Iterator[Terminal]:
    (morse.directory / "cart.urdf").write_text(URDF)
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    # the modules of a project stay in the process of a run, which is that of the tests here
    monkeypatch.setattr(ProjectImports, "stay", lambda self: None)
    # which counts equal lines of the runs before
    monkeypatch.setattr(log, "_handler", None)
    yield morse
    gc.unfreeze()  # a run keeps its objects from the garbage collection


@pytest.mark.parametrize(("text", "kind", "number", "words"), _cases())
def test_check_and_strict_find_a_mistake(project: Terminal, text: str, kind: str, number: int, words: str) -> None:
    (project.directory / "scene.py").write_text(text)
    checked = project("check", "scene.py")
    strict = project("run", "--headless", "--strict", "--duration", "0.02", "scene.py")
    plain = project("run", "--headless", "--duration", "0.02", "scene.py")

    found = [line for line in checked.out.splitlines() if line.startswith(f"scene.py:{number}: ") and words in line]
    assert found, checked.out
    assert ("error: " in found[0], "warning: " in found[0]) == (kind == "error", kind == "warning")
    *_, count, verdict = checked.out.splitlines()
    assert {"error": "error", "warning": "warning", "old": "old form"}[kind] in count
    warnings = re.search(r"\d+ warnings?", count)
    assert (
        verdict
        == {
            "error": "* scene.py does not run.",
            "old": "* scene.py runs.",
            "warning": f"* scene.py runs, with {warnings and warnings[0]}; not with --strict.",
        }[kind]
    )
    assert "Nothing needs a change" not in checked.out
    # the two agree, and say the same of the same line: a warning is no error, as for compilers
    assert (checked.status, strict.status) == (kind == "error", 1)
    assert re.search(rf"scene\.py:{number}\b.*{re.escape(words)}", strict.out.replace("\n  ", " ")), strict.out
    assert plain.status == (kind == "error")
    if kind != "error":
        assert re.search(rf"WARNING \S*scene\.py:{number}: .*{re.escape(words)}", plain.out), plain.out
        assert _places(strict.out) == set(re.findall(r"scene\.py:(\d+): ", checked.out))
        assert re.search(r"^\[ *[\d.]+\] \d+ warnings?, \d+ about the scene$", plain.out, re.MULTILINE)


def _places(out: str) -> set[str]:
    """The lines that the error of ``--strict`` lists."""
    _, _, listing = out.partition("refused (--strict):\n")
    return set(re.findall(r"^  \S*scene\.py:(\d+): ", listing, re.MULTILINE))


def test_there_are_enough_mistakes() -> None:
    assert len(_cases()) >= 50


def test_a_scene_without_mistakes(project: Terminal) -> None:
    (project.directory / "scene.py").write_text(HEAD.replace("motion = MotionVW()\nrobot.append(motion)\n", "") + ENV)
    checked = project("check", "scene.py")
    assert (checked.status, checked.out.splitlines()) == (0, ["* Nothing needs a change.", "* scene.py runs."])
    strict = project("run", "--headless", "--strict", "--duration", "0.02", "scene.py")
    assert strict.status == 0
    assert "] 0 warnings\n" in strict.out


@pytest.mark.parametrize(
    ("line", "statuses"), [("", (0, 0)), ("robot.rotate(z=90)", (0, 1)), ("robot.rotat()", (1, 1))]
)
def test_strict_makes_warnings_errors(project: Terminal, line: str, statuses: tuple[int, int]) -> None:
    text = HEAD.replace("motion = MotionVW()\nrobot.append(motion)\n", "") + f"{line}\n" + ENV
    (project.directory / "scene.py").write_text(text)
    assert (project("check", "scene.py").status, project("check", "--strict", "scene.py").status) == statuses


def test_strict_belongs_to_scenes_and_models(project: Terminal) -> None:
    for words in ((), ("component", "Pose")):
        assert project("check", "--strict", *words).status == 2
    model = project.directory / "cart.urdf"
    words = ("check", str(model), "--picture", str(project.directory / "cart.png"))
    # a mesh that does not exist is left out
    assert (project(*words).status, project(*words, "--strict").status) == (0, 1)
    model.write_text(re.sub(r".*no_such_mesh.*", "</link>", URDF))
    assert project(*words, "--strict").status == 0


def test_all_kinds_of_findings_are_counted(project: Terminal) -> None:
    text = HEAD + "robot.rotate(z=90)\npose.rotate(z=90)\nrobot.translate(x='1')\n" + ENV
    (project.directory / "scene.py").write_text(text)
    assert (
        "* 2 warnings and 1 line with an old form, which still works." in project("check", "scene.py").out.splitlines()
    )
    (project.directory / "scene.py").write_text(text + "env.nothing()\nenv.aim_camera([1, 0, 0])\n")
    expected = "* 1 error, 2 warnings and 2 lines with an old form, which still work."
    assert expected in project("check", "scene.py").out.splitlines()


PARTS = [
    (kind, name)
    for kind in ("sensors", "actuators")
    for name in getattr(builder, kind).__all__
    if not name.endswith("Creator") and name not in ("Armature", "CompoundSensor")  # which need arguments
]


@pytest.mark.parametrize(("kind", "name"), PARTS)
def test_each_property_of_each_component_misspelled(kind: str, name: str) -> None:
    """Without its last letter, a property is named with its line; the right one is suggested if it is the nearest."""
    misspelled: list[str] = []

    def describe() -> None:
        component = getattr(getattr(builder, kind), name)()
        cls = component.component_class()
        properties = [p.name for p in declarations.properties(cls).values()] if cls is not None else []
        for one in properties:
            if len(one) > 3 and one[:-1] not in properties:
                misspelled.append(one)
                component.properties(**{one[:-1]: 1})
        robot = builder.ATRV()
        robot.append(component)
        builder.Environment("empty")

    with scene_warnings() as collected:
        build(describe)
    found = [warning for warning in collected.warnings if "has no property" in warning.message]
    assert len(found) == len(misspelled)
    for one, warning in zip(misspelled, found, strict=True):
        assert f"has no property '{one[:-1]}'; did you mean '" in warning.message
        assert warning.where is not None
        assert warning.where.file == __file__


def test_a_loaded_scene_lists_all_its_warnings(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(HEAD + "robot.rotate(z=90)\npose.properties(x=1)\nother = Morsy()\n" + ENV)
    for _ in range(2):  # the second time, too: files and shapes are kept
        with pytest.raises(SceneWarningError) as caught:
            load(script, on_warning="raise")
        assert [warning.where.line for warning in caught.value.warnings if warning.where] == [8, 9, 10]


def test_files_that_are_kept_warn_in_each_scene(tmp_path: Path) -> None:
    (tmp_path / "cart.urdf").write_text(URDF)
    script = tmp_path / "scene.py"
    script.write_text("from morse.builder import *\nfor i in range(3):\n    cart = Robot('cart.urdf')\n"
                      "    cart.translate(x=2 * i, z=1)\n" + ENV)  # fmt: skip
    for _ in range(2):
        with scene_warnings() as collected:
            load(script).close()
        assert sum("no_such_mesh" in warning.message for warning in collected.warnings) == 1


def test_levels_of_the_log_hide_no_warning(project: Terminal) -> None:
    text = (
        HEAD
        + "other = Morsy()\n"
        + ENV
        + "env.set_log_level('main', 'error')\nenv.set_log_level('morse', 'critical')\n"
    )
    (project.directory / "scene.py").write_text(text)
    assert project("run", "--headless", "--strict", "--duration", "0.02", "scene.py").status == 1


def test_a_bad_word_for_warnings(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="on_warning is 'log' or 'raise', not 'rais'; did you mean 'raise'"):
        load(tmp_path / "scene.py", on_warning="rais")


def test_a_model_that_is_a_scene_has_no_lines(project: Terminal) -> None:
    """What has called MORSE is not the script: its warnings name the file alone."""
    mesh = "<visual name='v'><geometry><mesh><uri>nothing.dae</uri></mesh></geometry></visual>"
    model = f"<model name='box'><link name='l'>{mesh}</link></model>"
    (project.directory / "world.sdf").write_text(f"<sdf version='1.7'><world name='w'>{model}</world></sdf>")
    strict = project("run", "--headless", "--strict", "--duration", "0.02", "world.sdf")
    assert strict.status == 1
    assert "WARNING world.sdf: the mesh 'nothing.dae' is left out" in strict.out
