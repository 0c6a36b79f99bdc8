import subprocess
import sys

import morse.builder
from morse.builder.names import catalog
from morse.core import exceptions

NAMESPACE: dict[str, object] = {}
exec("from morse.builder import *", NAMESPACE)

# names that scripts of MORSE 1.4 take from the star import
CLASSES = [
    "AbstractComponent",
    "Component",
    "Robot",
    "GroundRobot",
    "WheeledRobot",
    "PassiveObject",
    "Zone",
    "Environment",
    "Configuration",
    "TimeStrategies",
    "ComponentCreator",
    "SensorCreator",
    "ActuatorCreator",
    "Cube",
    "Sphere",
    "Cylinder",
    "Cone",
    "Torus",
    "IcoSphere",
    "Plane",
    "Empty",
    "Mesh",
    "Coordsys",
    "Spot",
    "Camera",
    "FakeRobot",
    "Morsy",
    "ATRV",
    "B21",
    "Hummer",
    "Jido",
    "Pioneer3DX",
    "PatrolBot",
    "SegwayRMP400",
    "QUAD2012",
    "Quadrotor",
    "RMax",
    "Submarine",
    "Victim",
    "MotionVW",
    "MotionXYW",
    "MotionVWDiff",
    "Keyboard",
    "Teleport",
    "Pose",
    "Odometry",
]
MODULES = ["math", "os", "sys", "pprint", "logging", "mathutils", "bpymorse"]


def test_classes_of_scene_scripts_are_there() -> None:
    missing = [name for name in CLASSES if not isinstance(NAMESPACE.get(name), type)]
    assert missing == []


def test_modules_leak_as_scripts_expect() -> None:
    import math

    assert NAMESPACE["math"] is math
    assert NAMESPACE["sys"] is sys
    assert [name for name in MODULES if name not in NAMESPACE] == []
    assert NAMESPACE["mathutils"].Vector((1, 2, 3)).z == 3.0  # type: ignore[attr-defined]
    NAMESPACE["logger"].debug("a script may log")  # type: ignore[attr-defined]


def test_exceptions_are_there() -> None:
    for name, value in vars(exceptions).items():
        if isinstance(value, type) and issubclass(value, exceptions.MorseError):
            assert NAMESPACE[name] is value


def test_time_strategies_have_both_names() -> None:
    strategies = NAMESPACE["TimeStrategies"]
    assert strategies.BestEffort != strategies.FixedSimulationStep  # type: ignore[attr-defined]


def test_nothing_of_ours_leaks_besides() -> None:
    internal = {"workspace", "naming", "catalog", "checks", "creator", "script", "TYPE_CHECKING", "Any", "annotations"}
    assert internal.isdisjoint(NAMESPACE)


def test_every_component_has_a_builder_class() -> None:
    for package in ("morse.sensors", "morse.actuators"):
        for name in catalog.components(package):
            assert name in morse.builder.__all__, name
            assert getattr(morse.builder, name).__doc__, f"{name} says nothing about itself"


def test_submodules_of_1_4() -> None:
    program = (
        "from morse.builder.actuators import MotionVW\n"
        "from morse.builder.sensors import Pose\n"
        "from morse.builder.blenderobjects import Cube\n"
        "from morse.builder.robots import Morsy\n"
        "from morse.builder.creator import SensorCreator, ActuatorCreator\n"
        "from morse.builder.bpymorse import get_object\n"
        "from morse.builder.abstractcomponent import timer, AbstractComponent, Configuration\n"
        "from morse.builder.environment import Environment\n"
        "from morse.builder.data import MORSE_DATASTREAM_MODULE, MORSE_DATASTREAM_DICT, MORSE_SERVICE_DICT\n"
        "from morse.builder.morsebuilder import *\n"
        "assert issubclass(timer, float)\n"
        "assert MORSE_DATASTREAM_MODULE['socket'] == 'morse.middleware.socket_datastream.SocketDatastreamManager'\n"
        "assert MORSE_SERVICE_DICT['socket'] == 'morse.middleware.socket_request_manager.SocketRequestManager'\n"
    )
    exec(program, {})


def test_star_import_loads_nothing_heavy() -> None:
    program = (
        "import sys\n"
        "from morse.builder import *\n"
        "heavy = {'numpy', 'mujoco', 'asyncio', 'rich', 'typer', 'websockets', 'scipy', 'trimesh'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "[]"
