"""Scripts of MORSE 1.0 to 1.2 run, and `morse check --fix` writes them in the form of today."""

import importlib
from collections.abc import Callable
from pathlib import Path

import pytest

from morse.builder import MorseBuilderNoComponentError, bpymorse
from morse.builder.script import ScriptError
from morse.scene import Scene
from tests.kit.programs import python

Load = Callable[..., Scene]

SCRIPT = """\
from morse.builder import *
from morse.helpers.colors import bcolors

print(bcolors.OKGREEN + "scene" + bcolors.ENDC)
robot = ATRV()
motion = Actuator('v_omega')
motion.frequency(delay=2)
robot.append(motion)
place = Sensor("pose")
robot.append(place)
arm = Arm('kuka_lwr')
robot.append(arm)
gripper = ActuatorCreator("gripper", "morse.actuators.gripper.Gripper", "gripper")
robot.append(gripper)
gyro = SensorCreator("gyro", 'morse.sensors.gyroscope.Gyroscope')
robot.append(gyro)
env = Environment('empty')
"""
COMPONENTS = {
    "robot.motion": "morse.actuators.v_omega.MotionVW",
    "robot.place": "morse.sensors.pose.Pose",
    "robot.arm": "morse.actuators.armature.Armature",
    "robot.gripper": "morse.actuators.gripper.Gripper",
    "robot.gyro": "morse.sensors.gyroscope.Gyroscope",
}


def components(scene: Scene) -> dict[str, str]:
    return {part.name: part.classpath for part in scene.components if part.name in COMPONENTS}


def test_a_script_runs_and_each_old_form_is_named(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    scene = load(SCRIPT)
    assert components(scene) == COMPONENTS
    (motion,) = [part for part in scene.components if part.name == "robot.motion"]
    assert motion.frequency == 20.0  # one of three ticks, 60 in a second
    told = [record.getMessage() for record in caplog.records if "form of MORSE 1.0" in record.getMessage()]
    assert [text.rpartition("write ")[2] for text in told] == [
        "MotionVW()",
        "frequency(20)",
        "Pose()",
        "KukaLWR()",
        "action='USE_BLEND', blendfile='gripper', classpath='morse.actuators.gripper.Gripper'",
        "classpath='morse.sensors.gyroscope.Gyroscope'",
    ]


@pytest.mark.parametrize("module", ["morse.builder", "morse.builder.morsebuilder"])
def test_check_rewrites_it(load: Load, tmp_path: Path, module: str) -> None:
    (tmp_path / "scene.py").write_text(SCRIPT.replace("from morse.builder import *", f"from {module} import *"))
    done = python("-m", "morse", "check", "scene.py", "--fix", folder=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    text = (tmp_path / "scene_fixed.py").read_text()
    for old in ("Actuator(", "delay", "Sensor(", "Arm(", '"morse.actuators'):
        assert old not in text
    assert components(load(text)) == COMPONENTS


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("Actuator('v_omegaa')", "did you mean 'v_omega'"),
        ("Sensor('')", "takes a non-empty string"),
        ("Sensor(3)", "takes a string, got 3"),
        ("Arm('a' * 1_000_000)", "there is no component"),
        ("Sensor()", "Sensor() needs the name of a sensor: Sensor('gps'), or write its class, such as GPS()"),
        ("Arm()", "Arm() needs the name of an actuator: Arm('kuka_lwr'), or write its class, such as KukaLWR()"),
        ("Pose().frequency(delay=-1)", "at least 0"),
        ("Pose().frequency(delay='soon')", "takes a number"),
        ("SensorCreator('a', 'no.such.Sensor')", "no.such.Sensor"),
        ("SensorCreator('a', 'USE_BLENDER')", "did you mean 'USE_BLEND'"),
    ],
)
def test_wrong_forms_are_errors_of_the_script(load: Load, line: str, answer: str) -> None:
    with pytest.raises(ScriptError) as caught:
        load(f"from morse.builder import *\n{line}\nenv = Environment('empty')\n")
    assert answer in caught.value.report()[:3000]


def test_components_that_had_a_shape_of_their_own_run_without(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    """The models of most sensors are gone."""
    scene = load(
        "from morse.builder import *\nrobot = ATRV()\n"
        "class Foo(SensorCreator):\n    def __init__(self, name=None):\n"
        '        SensorCreator.__init__(self, name, "morse.sensors.pose.Pose", "morse_pose")\n'
        "foo = Foo()\nrobot.append(foo)\narm = Arm('kuka_arm')\nrobot.append(arm)\nenv = Environment('empty')\n"
    )
    classes = {part.name: part.classpath for part in scene.components}
    assert classes["robot.foo"] == "morse.sensors.pose.Pose"
    assert classes["robot.arm"] == "morse.actuators.armature.Armature"
    assert "there is no model 'morse_pose' any more" in caplog.text


def test_modifiers_have_options(load: Load) -> None:
    scene = load(
        "from morse.builder import *\nrobot = ATRV()\nimu = IMU()\nrobot.append(imu)\n"
        "imu.configure_modifier('IMUNoise', gyro_std=0.5)\npose = Pose()\nrobot.append(pose)\n"
        "pose.configure_modifier('NED', ['morse.modifiers.ned.MorseNED'])\nenv = Environment('empty')\n"
    )
    options = {part.name: [one.options for one in part.modifiers] for part in scene.components}
    assert options["robot.imu"] == [{"gyro_std": 0.5}]
    assert options["robot.pose"] == [{}]


def test_a_name_of_the_script_comes_first(load: Load) -> None:
    load("from morse.builder import *\nclass Sensor:\n    pass\nassert Sensor()\nenv = Environment('empty')\n")


def test_what_is_missing_is_also_a_key_error() -> None:
    with pytest.raises(KeyError) as caught:
        bpymorse.get_object("Tabel")
    assert isinstance(caught.value, MorseBuilderNoComponentError)
    assert str(caught.value).startswith("there is no object 'Tabel'")


def test_programs_that_are_no_scripts_import_old_modules() -> None:
    human = importlib.import_module("morse.builder.robots.human")
    assert human.Human is importlib.import_module("morse.builder").Human
    assert importlib.import_module("morse.core.blenderapi").version() >= (2, 65, 0)


def test_objects_have_the_attributes_of_blender(load: Load) -> None:
    load(
        "from morse.builder import *\n"
        "robot = ATRV()\n"
        "body = robot._bpy_object\n"
        "body.game.mass = 12.0\n"
        "assert body.game.mass == 12.0 and body.type == 'MESH' and not body.hide\n"
        "body.hide = True\n"
        "assert body.hide and not robot.scene_node.visible\n"
        "try:\n    body.hidden = True\n"
        "except AttributeError as error:\n    assert \"did you mean 'hide'\" in str(error), error\n"
        "else:\n    raise AssertionError\n"
        "env = Environment('empty')\n"
    )
