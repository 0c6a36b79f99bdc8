import sys
from pathlib import Path
from typing import Any

import pytest

import morse.builder
from morse.builder import (
    ActuatorCreator,
    ComponentCreator,
    Cube,
    MorseBuilderError,
    MorseBuilderNoComponentError,
    Pose,
    SensorCreator,
)
from morse.builder.names import catalog
from morse.core.actuator import Actuator
from morse.core.sensor import Sensor
from morse.scene import NodeKind, PhysicsType


@pytest.fixture
def sonar(project: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(project))
    from sonars.builder import Sonar  # type: ignore[import-not-found]

    return Sonar


def test_a_sensor_is_an_empty_frame_that_runs() -> None:
    pose = Pose()
    assert pose.scene_node.kind is NodeKind.EMPTY
    assert pose.property_value("Component_Tag") is True
    assert pose.property_value("classpath") == "morse.sensors.pose.Pose"
    assert pose.property_value("frequency") == 60.0
    assert {n.body.type for n in pose.scene_node.walk()} == {PhysicsType.NO_COLLISION}


def test_the_marker_has_the_declared_size() -> None:
    (marker,) = Pose().scene_node.children
    assert marker.kind is NodeKind.MESH
    assert marker.scale == [0.04, 0.04, 0.02]
    assert marker.name == "PoseMesh"


def test_products_of_one_class_differ_as_it_declares() -> None:
    sick, ldmrs = morse.builder.Sick(), morse.builder.SickLDMRS()
    assert sick.classpath == ldmrs.classpath == "morse.sensors.laserscanner.LaserScanner"
    assert (sick.property_value("frequency"), ldmrs.property_value("frequency")) == (10.0, 4.0)
    assert (sick.property_value("layers"), ldmrs.property_value("layers")) == (None, 4)
    assert [node.plain_name for node in sick.scene_node.children] == ["SickMesh"]
    assert "SICK LD-MRS" in str(morse.builder.SickLDMRS.__doc__)


def test_a_component_of_a_project(sonar: Any) -> None:
    sensor = sonar()
    assert sensor.property_value("frequency") == 12.0
    assert sensor.property_value("Range") == 4.0
    (marker,) = sensor.scene_node.children
    assert marker.materials[0].color == (1.0, 0.0, 0.0, 1.0)
    sensor.level("far")
    sensor.add_stream("socket")
    assert sensor._declaration(sensor).level == "far"
    assert sensor._declaration(sensor).streams[0].direction == "OUT"
    with pytest.raises(MorseBuilderError, match="did you mean 'far'"):
        sensor.level("faar")
    assert sonar("bat").name == "bat"


def test_a_project_may_have_its_own_builder_defaults(sonar: Any) -> None:
    class Slow(sonar):  # type: ignore[misc]
        def __init__(self) -> None:
            sonar.__init__(self)
            self.frequency(1.0)
            self.properties(Mode="continuous")

    slow = Slow()
    assert slow.property_value("frequency") == 1.0
    assert slow.property_value("Mode") == "continuous"


def test_plain_creators() -> None:
    class Nothing(ActuatorCreator):
        pass

    nothing = Nothing("idle")
    assert not nothing.is_morseable()
    assert nothing.property_value("frequency") == 60.0
    assert nothing.name == "idle"
    later = ComponentCreator("late", "sensors", make_morseable=False)
    assert not later.is_morseable()


def test_the_body_of_a_model() -> None:
    class Boxed(SensorCreator):
        _classpath = "morse.sensors.pose.Pose"

        def __init__(self, **kwargs: Any) -> None:
            SensorCreator.__init__(self, None, ComponentCreator.USE_BLEND, **kwargs)

    boxed = Boxed(blendfile="props/crates.blend", blendobject="small_crate")
    assert boxed.scene_node.plain_name == "small_crate"
    assert boxed.classpath == "morse.sensors.pose.Pose"
    assert {"BoxedMesh", "small_crate_mesh"} <= {c.plain_name for c in boxed.scene_node.children}
    with pytest.raises(MorseBuilderError, match="blendfile="):
        Boxed()
    with pytest.raises(FileNotFoundError, match="sensors"):
        Boxed(blendfile="no_such_casing")


def test_an_object_that_exists_already() -> None:
    cube = Cube("lens")

    class Eye(SensorCreator):
        _classpath = "morse.sensors.pose.Pose"

        def __init__(self, name: str) -> None:
            SensorCreator.__init__(self, "eye", ComponentCreator.LINK_EXISTING_OBJECT, blendobject=name)

    eye = Eye("lens")
    assert eye.scene_node is cube.scene_node
    assert eye.name == "eye"
    with pytest.raises(MorseBuilderNoComponentError, match="did you mean 'eye'"):
        Eye("eyes")


def test_a_marker_of_an_unknown_shape(sonar: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from morse.core.declarations import BuilderDefaults, Visual

    cls = sonar().component_class()
    monkeypatch.setattr(cls, "_builder", BuilderDefaults(visual=Visual("cubus", (1.0, 1.0, 1.0))))
    with pytest.raises(ValueError, match=r"cube, sphere, cylinder.*mean 'cube'"):
        sonar()


def test_unknown_action() -> None:
    with pytest.raises(ValueError, match="USE_BLEND"):
        SensorCreator(action="BLEND")


@pytest.mark.parametrize(("text", "answer"), [
    ("class Bell(:\n", r"SyntaxError.*bells[/\\]bell.py:1"),
    ("from morse.core.sensor import Sensor\n\nclass Bell(Sensr):\n    pass\n", r"NameError.*Sensr.*bell.py:3"),
    ("import no_such_library\n", r"no_such_library.*bell.py:1"),
    ("1 / 0\n", r"ZeroDivisionError.*bell.py:1"),
    ("class Bel:\n    pass\n", r"no class 'Bell'.*'Bel'"),
])  # fmt: skip
def test_component_files_with_mistakes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, answer: str) -> None:
    (tmp_path / "bells").mkdir()
    (tmp_path / "bells" / "__init__.py").write_text("")
    (tmp_path / "bells" / "bell.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))

    class Bell(SensorCreator):
        _classpath = "bells.bell.Bell"

    with pytest.raises(MorseBuilderNoComponentError, match=answer):
        Bell()


@pytest.mark.parametrize(("classpath", "answer"), [
    ("no_such_package.bell.Bell", "no_such_package"),
    ("json.bell.Bell", "json.bell"),
    ("Bell", "module.Class|package.module.Class"),
])  # fmt: skip
def test_class_paths_that_lead_nowhere(classpath: str, answer: str) -> None:
    bell = type("Bell", (SensorCreator,), {"_classpath": classpath})
    with pytest.raises(MorseBuilderNoComponentError, match=answer):
        bell()
    assert "no_such_package" not in sys.modules


@pytest.mark.parametrize(
    ("package", "base", "name"),
    [
        (package, base, name)
        for package, base in (("morse.sensors", Sensor), ("morse.actuators", Actuator))
        for name in catalog.components(package)
    ],
)
def test_every_component_of_morse_can_be_put_on_a_robot(package: str, base: type, name: str) -> None:
    # a compound sensor consists of its members, an armature belongs to a model
    given = {"CompoundSensor": ([morse.builder.Pose()],), "Armature": ("arm", "kuka_armature", "kuka_lwr")}
    arguments = given.get(name, ())
    robot, component = morse.builder.FakeRobot(), getattr(morse.builder, name)(*arguments)
    robot.append(component)
    cls = component.component_class()
    declared = component._declaration(robot)
    assert issubclass(cls, base), f"a class in {package}"
    assert declared.kind == {Sensor: "sensor", Actuator: "actuator"}[base]
    assert declared.frequency > 0.0
    # arms and the palm of the gripper collide, as in 1.4, and sensor shapes do not stop bodies
    arms = {arm: {PhysicsType.STATIC} for arm in ("Gripper", "Armature", "KukaLWR", "PA10")}
    bodies = {**arms, "Collision": {PhysicsType.SENSOR}, "Bumper": {PhysicsType.SENSOR}}
    assert {node.body.type for node in component.own_nodes()} - bodies.get(name, set()) <= {PhysicsType.NO_COLLISION}
    component.add_interface("socket")
    assert bool(component._declaration(robot).streams) == component.is_exportable()


def test_scanners_of_1_4_have_a_base_class_with_their_name(load):
    scene = load(
        "from morse.builder import *\n"
        "class Short(LaserSensorWithArc):\n"
        "    _classpath = 'morse.sensors.laserscanner.LaserScanner'\n"
        "    def __init__(self, name=None):\n"
        "        LaserSensorWithArc.__init__(self, name)\n"
        "        self.properties(laser_range=3.0, scan_window=90.0)\n"
        "        self.create_laser_arc()\n"
        "robot = ATRV()\nfront = Short()\nrobot.append(front)\nenv = Environment('empty')"
    )
    assert scene.find("robot.front").properties["laser_range"] == 3.0
