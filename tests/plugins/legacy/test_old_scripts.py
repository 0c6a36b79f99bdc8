"""Scripts in the manner of earlier versions: module names, methods, values, arguments, and the Python of their time."""

import importlib
import math
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from morse.builder.names.catalog import load_class
from morse.builder.script import ScriptError, load_scene
from morse.plugins.legacy.imports import REMOVED
from morse.scene import Scene
from morse.simulation.options import RunOptions

Load = Callable[..., Scene]

HEAD = "from morse.builder import *\n"
END = "env = Environment('empty')\n"


def warnings(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.levelname == "WARNING"]


# --- modules and names -------------------------------------------------------------------------


@pytest.mark.parametrize(
    "statement",
    [
        "from morse.builder.robots.pr2 import NavPR2",
        "from morse.builder.robots.morserobots import *; ATRV",
        "from morse.builder.robots.human import Human",
        "from morse.builder.robots.segway import SegwayRMP400",
        "import morse.builder.robots.pr2; morse.builder.robots.pr2.BarePR2",
        "from morse.builder.creator import SensorCreator, ActuatorCreator, ComponentCreator, bpymorse",
        "from morse.builder import bpymorse",
        "from morse.builder.data import MORSE_DATASTREAM_MODULE, MORSE_MODIFIER_DICT",
        "from morse.core.morse_time import TimeStrategies; TimeStrategies.FixedSimulationStep",
        "from morse.core.ackermann_robot import PhysicsAckermannRobot",
        "from morse.core.morse_math import normalise_angle",
        "from morse.core.datastream import DatastreamManager",
        "from morse.helpers.controller import PIDController; PIDController(kp=1, kd=0.1, ki=0, limits_integrator=5)",
        "from morse.middleware.abstract_datastream import AbstractDatastream",
        "from morse.middleware.ros.abstract_ros import ROSPublisher, ROSSubscriber",
        "from morse.middleware.ros.static_tf import StaticTFPublisher, StaticTF2Publisher",
    ],
)
def test_modules_of_1_4(load: Load, statement: str) -> None:
    load(f"{statement}\n{HEAD}{END}")


def test_old_modules_are_named_in_every_script_and_stay_in_none(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    for _ in range(2):
        caplog.clear()
        load(f"from morse.builder.robots.pr2 import NavPR2\n{HEAD}{END}")
        assert any("scene.py:1: " in text and "write morse.builder.robots" in text for text in warnings(caplog))
    # programs that are not scene scripts import them, too
    assert importlib.import_module("morse.builder.robots.pr2") is importlib.import_module("morse.builder.robots")


def test_methods_of_earlier_versions(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    scene = load(
        HEAD
        + "robot = ATRV()\n"
        + "pose = Pose()\n"
        + "robot.append(pose)\n"
        + "pose.configure_mw('socket', ['Socket', 'post_message', 'morse/middleware/socket_mw'])\n"
        + "pose.configure_modifier('NED')\n"
        + "pose.configure_service('socket')\n"
        + "person = Human()\n"
        + "person.disable_keyboard_control()\n"
        + END
    )
    pose = next(c for c in scene.components if c.node.name == "robot.pose")
    assert [stream.direction for stream in pose.streams] == ["OUT"]
    assert [modifier.classpath.rpartition(".")[2] for modifier in pose.modifiers] == ["CoordinatesToNED"]
    assert len(pose.managers) == 1
    said = "\n".join(warnings(caplog))
    for line, new in ((5, "add_stream"), (6, "alter"), (7, "add_service")):
        assert f"scene.py:{line}: " in said
        assert f"write {new}" in said


def test_old_methods_are_no_methods_of_anything_else(load: Load) -> None:
    with pytest.raises(ScriptError, match="no attribute 'configure_mv'"):
        load(HEAD + "Pose().configure_mv('socket')\n" + END)
    with pytest.raises(ScriptError, match="no attribute 'disable_keyboard_control'"):
        load(HEAD + "ATRV().disable_keyboard_control()\n" + END)


def test_keywords_of_the_pr2(load: Load) -> None:
    scene = load(HEAD + "a = NavPR2(with_keyboard=False, show_laser=True)\nb = LocalizedPR2('c', False)\n" + END)
    parts = {component.node.name: component for component in scene.components}
    assert "a.keyboard" not in parts
    assert "c.keyboard" not in parts
    assert parts["a.base_scan"].node.properties["Visible_arc"] is True


# --- values ------------------------------------------------------------------------------------


def test_texts_count_as_numbers_and_truth_values(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    scene = load(
        HEAD
        + "robot = ATRV()\n"
        + "robot.translate('1', y=' 2.5 ')\n"
        + "robot.set_mass('12')\n"
        + "env = Environment('empty', fastmode='True')\n"
        + "env.set_gravity('1.62')\n"
        + "env.simulator_frequency(fps='120')\n"
        + "env.show_framerate('False')\n"
    )
    robot = scene.components[0].node
    assert robot.location[:2] == [1.0, 2.5]
    assert robot.body.mass == 12.0
    settings = scene.settings
    assert (settings.fastmode, settings.gravity, settings.frequency) == (True, 1.62, 120.0)
    assert settings.view.show_framerate is True, "as in 1.4, a text that is not empty is true"
    said = "\n".join(warnings(caplog))
    for line, form in ((3, "write 1"), (4, "write 12"), (5, "write True"), (6, "write 1.62"), (8, "write True")):
        assert any(f"scene.py:{line}: " in text and form in text for text in said.splitlines())


@pytest.mark.parametrize("text", ["far", "1,5", "nan", "inf", ""])
def test_other_texts_are_no_numbers(load: Load, text: str) -> None:
    with pytest.raises(ScriptError, match="takes a number"):
        load(f"{HEAD}robot = ATRV()\nrobot.translate({text!r})\n{END}")


def test_arrays_and_scalars_of_numpy(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    scene = load(
        HEAD
        + "import numpy as np\n"
        + "robot = ATRV()\n"
        + "robot.translate(*np.array([1, 2, 3]))\n"
        + "robot.rotate(z=np.array([0.5]))\n"
        + "env = Environment('empty', fastmode=np.bool_(True))\n"
        + "env.set_camera_location(np.array([1, 2, 3.5]))\n"
        + "env.simulator_frequency(np.int64(90))\n"
    )
    robot = scene.components[0].node
    assert robot.rotation_euler[2] == 0.5
    assert scene.settings.view.camera_location == (1.0, 2.0, 3.5)
    assert (scene.settings.fastmode, scene.settings.frequency) == (True, 90.0)
    assert not warnings(caplog)


def test_one_name_for_a_list_of_names(
    load: Load, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MORSE_NODE", "0")
    scene = load(
        HEAD
        + "dala0, dala1 = ATRV(), ATRV()\n"
        + END
        + "env.configure_multinode(distribution={0: 'dala0', 'b': ('dala1',)})\n"
    )
    assert [robot.kind for robot in scene.robots()] == ["robot", "external_robot"]
    assert any("write ['dala0']" in text for text in warnings(caplog))


# --- the command line --------------------------------------------------------------------------


def test_arguments_after_two_dashes(load: Load) -> None:
    script = "import sys\nname = (sys.argv[sys.argv.index('--') + 1:] + ['none'])[0]\nATRV(name)\n"
    for arguments, name in ((("dala",), "dala"), (("--", "dala"), "dala"), ((), "none")):
        scene = load(HEAD + script + END, arguments=arguments)
        assert [component.node.name for component in scene.components] == [name]


def test_arguments_of_new_scripts(load: Load) -> None:
    script = (
        "import argparse\nparser = argparse.ArgumentParser()\nparser.add_argument('--name')\n"
        "ATRV(parser.parse_args().name)\n"
    )
    scene = load(HEAD + script + END, arguments=("--name", "dala"))
    assert [component.node.name for component in scene.components] == ["dala"]


# --- Python ------------------------------------------------------------------------------------


def test_names_that_python_has_removed(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    load(
        HEAD
        + "import collections, time, inspect, imp\n"
        + "from collections import Mapping\n"
        + "from fractions import gcd\n"
        + "import xml.etree.cElementTree as ET\n"
        + "assert gcd(12, 18) == 6\n"
        + "assert isinstance({}, Mapping) and issubclass(list, collections.Sequence)\n"
        + "assert time.clock() <= time.clock() and time.time() > 0\n"
        + "assert inspect.getargspec(lambda a, b=1: 0).args == ['a', 'b']\n"
        + "assert imp.new_module('x').__name__ == 'x'\n"
        + "assert ET.fromstring('<a/>').tag == 'a'\n"
        + END
    )
    said = warnings(caplog)
    for line, new in ((2, "importlib"), (3, "collections.abc.Mapping"), (4, "math.gcd"), (8, "time.perf_counter")):
        assert any(f"scene.py:{line}: " in text and new in text for text in said)
    assert not hasattr(time, "clock"), "the modules of Python themselves are not changed"


def test_the_table_of_removed_names() -> None:
    assert math.gcd(4, 6) == 2
    for module, names in REMOVED.items():
        for new in names.values():
            place, _, name = new.rpartition(".")
            assert hasattr(importlib.import_module(place), name), f"{module}: {new}"


@pytest.mark.parametrize(
    ("line", "mend"),
    [
        ("print 'robot'", "print(...)"),
        ("exec 'x = 1'", "exec(...)"),
        ("try:\n    pass\nexcept ValueError, error:\n    pass", "except Error as error"),
        ("raise ValueError, 'no'", "raise Error('message')"),
        ("if 1 <> 2: pass", "!="),
        ("mode = 0755", "0o17"),
        ("async = True", "keywords since Python 3.7"),
        ("if True:\n\tx = 1\n        y = 2", "spaces only"),
        ("n = xrange(3)", "write range"),
        ("name = raw_input()", "write input"),
        ("Middleware('socket')", "component.add_stream('socket')"),
        ("from morse.builder.creator import RobotCreator", "class MyRobot(GroundRobot)"),
    ],
)
def test_earlier_names_and_python_2(load: Load, line: str, mend: str) -> None:
    with pytest.raises(ScriptError) as caught:
        load(f"{HEAD}{line}\n{END}")
    assert mend in caught.value.report()


# --- streams and middlewares -------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        "'morse.middleware.socket_datastream.Socket', 'morse.middleware.socket_datastream.SocketPublisher'",
        "'socket', 'post_message', 'morse/middleware/socket_mw'",
        "'socket', 'post_message'",
        "'morse.middleware.socket_mw.MorseSocketClass'",
    ],
)
def test_streams_as_earlier_versions_name_them(load: Load, arguments: str) -> None:
    scene = load(f"{HEAD}robot = ATRV()\npose = Pose()\nrobot.append(pose)\npose.add_stream({arguments})\n{END}")
    (stream,) = next(c for c in scene.components if c.kind == "sensor").streams
    assert stream.manager == "morse.middleware.socket_datastream.SocketDatastreamManager"
    load_class(stream.stream)


@pytest.mark.parametrize(
    ("name", "new"),
    [("pocolibs", "ros2"), ("hla", "socket"), ("pprzlink", "mavlink"), ("sockets", "socket"), ("txt", "text")],
)
def test_refused_middlewares_name_another(load: Load, name: str, new: str) -> None:
    with pytest.raises(ScriptError, match=rf"'{new}'|; {new} can be used instead") as caught:
        load(f"{HEAD}robot = ATRV()\npose = Pose()\nrobot.append(pose)\npose.add_stream('{name}')\n{END}")
    assert "scene.py:5" in caught.value.report()


# --- places ------------------------------------------------------------------------------------

COMPONENT = """
from morse.core.sensor import Sensor
from morse.helpers.components import add_data
class Thing(Sensor):
    _name = 'Thing'
    add_data('d', 0.0, 'float', 'distance')
    def default_action(self):
        self.local_data['d'] = self.position_3d.x
"""


@pytest.mark.parametrize("place", ["", "data", "data/robots", "../data", "../data/robots"])
def test_models_beside_and_above_the_script(tmp_path: Path, place: str) -> None:
    scenes = tmp_path / "lab" / "scenes"
    folder = scenes / place
    folder.mkdir(parents=True, exist_ok=True)
    scenes.mkdir(exist_ok=True)
    (folder / "ownbot.obj").write_text("o bot\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    script = scenes / "scene.py"
    script.write_text(f"{HEAD}bot = Robot('ownbot')\n{END}")
    scene = load_scene(RunOptions(str(script)))
    assert scene.models[0].path == str((folder / "ownbot.obj").resolve())


def test_components_of_a_project_that_was_never_registered(tmp_path: Path) -> None:
    package = tmp_path / "lab" / "src" / "mypkg" / "sensors"
    package.mkdir(parents=True)
    (package / "thing.py").write_text(COMPONENT)
    (package / "__init__.py").write_text("")
    (package.parent / "__init__.py").write_text("")
    script = tmp_path / "lab" / "scenes" / "scene.py"
    script.parent.mkdir()
    script.write_text(
        f"{HEAD}from mypkg.builder.sensors import Thing\n"
        "class Other(SensorCreator):\n    _classpath = 'mypkg.sensors.thing.Thing'\n"
        f"robot = ATRV()\na, b = Thing(), Other()\nrobot.append(a)\nrobot.append(b)\n{END}"
    )
    scene = load_scene(RunOptions(str(script)))
    assert {c.classpath for c in scene.components if c.kind == "sensor"} == {"mypkg.sensors.thing.Thing"}
