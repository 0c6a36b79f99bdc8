"""What scene scripts of 1.4 write: imports of the builder, and interfaces of components made of others."""

from collections.abc import Callable

import pytest

from morse.scene import Scene

MODULES = ("actuators", "sensors", "blenderobjects", "robots", "creator", "abstractcomponent", "morsebuilder")


@pytest.mark.parametrize("module", MODULES)
def test_importing_all_names_of_a_module_hides_no_name_of_the_builder(module):
    # the harness of 1.4 imports all names of several modules, one after the other
    names: dict[str, object] = {}
    exec("from morse.builder import *", names)
    before = dict(names)
    exec(f"from morse.builder.{module} import *", names)
    assert {name for name in before if names[name] is not before[name]} <= {"__builtins__"}


def test_the_old_module_of_the_builder_has_what_a_scene_needs(load: Callable[[str], Scene]):
    scene = load(
        "del ATRV, Environment, AbstractComponent, bpymorse, TimeStrategies, math\n"
        "from morse.builder.morsebuilder import *\n"
        "from morse.builder.robots import *\n"
        "robot = ATRV()\nrobot.rotate(z=math.pi)\nAbstractComponent.close_context()\n"
        "assert bpymorse.get_object('ATRV').name == robot.name\n"
        "env = Environment('empty')\nenv.set_time_strategy(TimeStrategies.FixedSimulationStep)\n"
    )
    assert [part.name for part in scene.components] == ["robot"]


def test_both_cameras_of_a_kinect_have_the_interface_of_the_kinect(load: Callable[[str], Scene]):
    scene = load(
        "robot = ATRV()\n"
        "kinect = Kinect()\nrobot.append(kinect)\nkinect.add_interface('socket')\n"
        "robot.add_default_interface('socket')\n"
        "env = Environment('empty')\n"
    )
    parts = [part for part in scene.components if part.name != "robot"]
    streams = {part.name: len(part.streams) for part in parts}
    assert streams == {"robot.Kinect": 0, "robot.Kinect.rgb": 1, "robot.Kinect.depth": 1}
    services = {part.name: len(part.managers) for part in parts}
    assert services == dict.fromkeys(streams, 1)


def test_the_colour_camera_of_a_kinect_is_at_its_left(load: Callable[[str], Scene]):
    scene = load("robot = ATRV()\nkinect = Kinect()\nrobot.append(kinect)\nenv = Environment('empty')\n")
    places = {part.name: part.node.location for part in scene.components}
    assert places["robot.Kinect.rgb"] == pytest.approx([0.06, 0.08, 0.04])
    assert places["robot.Kinect.depth"] == pytest.approx([0.06, -0.08, 0.04])


@pytest.mark.parametrize(
    ("middleware", "method", "used"),
    [
        ("yarp", "morse.middleware.yarp_datastream.YarpPublisher", "morse.middleware.yarp_datastream.YarpPublisher"),
        ("moos", "morse.middleware.moos.PoseNotifier", "morse.plugins.moos.datastream.MoosPublisher"),
        ("text", "morse.middleware.text_datastream.CSVPublisher", "morse.middleware.text_datastream.CSVPublisher"),
        ("ros", "morse.middleware.ros.pose.TFPublisher", "morse.middleware.ros.pose.TFPublisher"),
        ("socket", "my_lab.streams.Sender", "my_lab.streams.Sender"),
    ],
)
def test_a_stream_class_of_1_4_stands_for_the_stream_of_its_middleware(load, caplog, middleware, method, used):
    scene = load(
        f"robot = ATRV()\npose = Pose()\nrobot.append(pose)\npose.add_stream('{middleware}', '{method}')\n"
        "env = Environment('empty')\n"
    )
    (stream,) = next(part.streams for part in scene.components if part.name == "robot.pose")
    assert stream.stream == used
    assert ("there is no class" in caplog.text) == (used != method)
