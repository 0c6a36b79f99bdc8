import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.assets import AssetNotFoundError, search
from morse.builder import (
    ATRV,
    BasePR2,
    Environment,
    FakeRobot,
    GroundRobot,
    MorseBuilderError,
    MorseBuilderUnexportableError,
    Morsy,
    Pioneer3DX,
    Pose,
    Robot,
    WheeledRobot,
    robots,
)
from morse.scene import Bounds, PhysicsType


def declaration(robot: Any) -> Any:
    return robot._declaration(robot)


def test_a_robot_without_a_model_is_an_empty_frame() -> None:
    robot = Robot()
    assert robot.scene_node.mesh is None
    assert robot.scene_node.body.type is PhysicsType.NO_COLLISION
    assert robot.property_value("Robot_Tag") is True
    assert robot.property_value("GroundRobot") is None
    assert declaration(robot).kind == "robot"
    assert declaration(robot).classpath == "morse.core.robot.Robot"
    assert declaration(robot).frequency is None


def test_ground_robots_say_so_and_wheeled_ones_do_not() -> None:
    assert GroundRobot().property_value("GroundRobot") is True
    assert Morsy().property_value("GroundRobot") is True
    assert WheeledRobot().property_value("GroundRobot") is None
    assert Pioneer3DX().property_value("GroundRobot") is None


@pytest.mark.parametrize(("make", "classpath"), [
    (FakeRobot, "morse.robots.fakerobot.FakeRobot"),
    (Morsy, "morse.robots.morsy.Morsy"),
    (ATRV, "morse.robots.atrv.ATRV"),
    (Pioneer3DX, "morse.robots.pioneer3dx.Pioneer3DX"),
    (WheeledRobot, "morse.core.wheeled_robot.PhysicsDifferentialRobot"),
])  # fmt: skip
def test_the_class_that_runs(make: type[Robot], classpath: str) -> None:
    class Mine(make):  # type: ignore[valid-type, misc]
        pass

    assert make().classpath == classpath
    assert Mine().classpath == classpath
    assert Mine().component_class() is make().component_class()


def test_a_class_of_ones_own() -> None:
    robot = GroundRobot()
    robot.properties(classpath="my_sim.robots.rover.Rover")
    assert declaration(robot).classpath == "my_sim.robots.rover.Rover"
    robot.classpath = "my_sim.robots.rover.Better"
    assert robot.property_value("classpath") == "my_sim.robots.rover.Better"


@pytest.mark.parametrize("name", [name for name in robots.__all__ if name != "FakeRobot"])
def test_a_robot_without_its_model_says_where_it_was_looked_for(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "MORSE_COMPONENTS", str(tmp_path))
    with pytest.raises(AssetNotFoundError, match=f"no model '.*' in 'robots'.*{re.escape(str(tmp_path))}"):
        getattr(robots, name)()


@pytest.mark.parametrize("name", ["Morsy", "ATRV", "Pioneer3DX"])
def test_robots_have_a_body(name: str) -> None:
    robot = getattr(robots, name)("mana")
    assert robot.name == "mana"
    assert robot.scene_node.body.moves
    assert any(node.mesh is not None for node in robot.own_nodes())


def test_morsy_is_one_rigid_body_of_convex_hulls() -> None:
    body = Morsy().scene_node.body
    assert (body.type, body.bounds, body.compound) == (PhysicsType.RIGID_BODY, Bounds.CONVEX_HULL, True)
    assert body.radius == 0.08
    assert body.mass == 15.0


def test_morsy_is_painted_alone() -> None:
    painted, plain = Morsy(), Morsy()
    painted.set_color((0.0, 0.0, 1.0))

    def paints(robot: Any) -> set[tuple[float, ...]]:
        slots = robot.get_child("morsy_mesh").material_slots
        return {slot.material.diffuse_color for slot in slots}

    assert (0.0, 0.0, 1.0) in paints(painted)
    assert (0.0, 0.0, 1.0) not in paints(plain)
    assert len(paints(painted) & paints(plain)) >= 1, "eyes and rubber keep their colours"
    plain.set_color()
    assert paints(plain) != paints(Morsy())
    for bad in ((1, 2, 3), "red", (0.1, 0.2), 0.3):
        with pytest.raises((TypeError, ValueError)):
            painted.set_color(bad)  # type: ignore[arg-type]


# --- physics -------------------------------------------------------------------------------------


def test_physics_settings() -> None:
    robot = ATRV()
    robot.set_mass(33)
    robot.set_friction(0.7)
    body = robot.scene_node.body
    assert (body.mass, body.friction) == (33.0, 0.7)
    robot.set_dynamic()
    assert body.type is PhysicsType.DYNAMIC
    robot.set_rigid_body()
    assert body.type is PhysicsType.RIGID_BODY
    robot.set_physics_type()
    assert body.type is PhysicsType.STATIC
    robot.set_collision_bounds()
    assert (body.bounds, body.compound) == (Bounds.CONVEX_HULL, True)
    robot.set_no_collision()
    assert {n.body.type for n in robot.own_nodes()} == {PhysicsType.NO_COLLISION}


@pytest.mark.parametrize("bad", [math.nan, -1, "seven", None, math.inf])
def test_bad_physics_settings(bad: Any) -> None:
    robot = FakeRobot()
    for setter in (robot.set_mass, robot.set_friction, robot.make_ghost):
        with pytest.raises((TypeError, ValueError)):
            setter(bad)
    with pytest.raises(ValueError, match="greater than 0"):
        robot.set_mass(0.0)


def test_physics_types_are_checked() -> None:
    with pytest.raises(ValueError, match="did you mean 'RIGID_BODY'"):
        FakeRobot().set_physics_type("RIGIDBODY")
    with pytest.raises(ValueError, match="STATIC"):
        FakeRobot().set_physics_type("AUTO")


def test_a_ghost_is_transparent_and_touches_nothing() -> None:
    ghost, solid, sensor = Morsy(), Morsy(), Pose()
    ghost.append(sensor)
    ghost.make_ghost(0.25)
    assert {n.body.type for n in ghost.own_nodes()} == {PhysicsType.NO_COLLISION}
    assert solid.scene_node.body.type is PhysicsType.RIGID_BODY

    def opacities(obj: Any) -> set[float]:
        return {slot.material.alpha for slot in obj.material_slots}

    assert opacities(ghost.get_child("morsy_mesh")) == {0.25}
    assert 0.25 not in opacities(solid.get_child("morsy_mesh"))
    assert opacities(sensor.get_child("PoseMesh")) == {1.0}
    with pytest.raises(ValueError, match="0 to 1"):
        ghost.make_ghost(1.5)


# --- roles ---------------------------------------------------------------------------------------


def test_external_robots() -> None:
    robot = FakeRobot()
    robot.make_external()
    assert declaration(robot).kind == "external_robot"
    assert robot.property_value("Robot_Tag") is None
    assert robot.property_value("External_Robot_Tag") is True
    assert robot.is_robot


def test_recorded_robots() -> None:
    robot = FakeRobot()
    assert declaration(robot).options == {}
    robot.set_use_record_animation(True)
    assert declaration(robot).options == {"record_animation": True}
    with pytest.raises(TypeError, match="True or False"):
        robot.set_use_record_animation(None)  # type: ignore[arg-type]


def test_graspers() -> None:
    robot = Morsy()
    robot.make_grasper("morsy_mesh")
    assert robot.get_child("morsy_mesh").game.properties["Grasper"].value is True  # type: ignore[union-attr]
    with pytest.raises(MorseBuilderError, match="did you mean 'morsy_mesh'"):
        robot.make_grasper("morsy_mehs")


def test_wheels_are_known_after_the_renaming(load: Callable[..., Any]) -> None:
    scene = load(
        "from morse.builder import *\na = Pioneer3DX()\nb = Pioneer3DX()\nb.append(Pose())\n"
        "m = Morsy()\nenv = Environment('empty')\n"
    )
    first, second, morsy = scene.robots()
    assert "wheels" not in morsy.options
    for declared in (first, second):
        assert len(declared.options["wheels"]) >= 2
        for name in declared.options["wheels"]:
            wheel = scene.find(name)
            assert wheel.parent is declared.node, "wheels stay children of the robot"
            assert "wheel" in wheel.plain_name.lower()
            assert wheel.body.collides
    assert not set(first.options["wheels"]) & set(second.options["wheels"])


def test_painted_wheels_do_not_turn() -> None:
    """The wheels of the ATRV are only visual: they do not collide."""

    class Cart(WheeledRobot):
        def __init__(self) -> None:
            WheeledRobot.__init__(self, "atrv")

    cart = Cart()
    cart.unparent_wheels()
    assert declaration(cart).options == {"wheels": []}


def test_a_script_may_prepare_the_wheels_itself() -> None:
    """MORSE 1.4: the origin of a Pioneer at rest is 0.15 m above the floor (0.04), called by the script or not."""

    class Prepared(Pioneer3DX):
        def __init__(self, name: str | None = None) -> None:
            super().__init__(name)
            self.unparent_wheels()

    def scene() -> None:
        plain, prepared = Pioneer3DX("plain"), Prepared("prepared")
        plain.translate(z=0.1)
        prepared.translate(y=2.0, z=0.1)
        for robot in (plain, prepared):
            robot.append(Pose("pose"))
        Environment("empty")

    def late() -> Prepared:
        robot = Prepared()
        robot.append(Pose("pose"))
        return robot

    with morse.load(scene) as sim:
        sim.spawn("late", late, (0.0, -2.0, 0.1))
        sim.step(90)
        heights = [robot.pose.data["z"] for robot in (sim.plain, sim.prepared, sim.late)]
    assert heights == pytest.approx([0.15] * 3, abs=0.04)


def test_unknown_models_and_parts() -> None:
    with pytest.raises(AssetNotFoundError, match="did you mean 'morsy'"):
        Robot("mrosy")
    with pytest.raises(MorseBuilderError, match="Pioneer"):
        Robot("pioneer3dx", blender_object_name="Pionier")
    assert Robot("pioneer3dx", blender_object_name="Wheel_L").scene_node.plain_name == "Wheel_L"
    for bad in (3, None, b"morsy", ["morsy"]):
        with pytest.raises(TypeError, match="name"):
            Robot(bad)  # type: ignore[arg-type]


def test_streams_of_a_whole_robot() -> None:
    robot = BasePR2("robot")
    robot.add_stream("socket")
    streams = {part.name: [stream.stream for stream in part._streams] for part in robot._walk() if part is not robot}
    assert all(len(each) == 1 for name, each in streams.items() if name in ("robot.motion", "robot.odometry"))
    (joints,) = (each for name, each in streams.items() if name.endswith("joint_state"))
    assert joints == ["morse.middleware.sockets.jointstate.PR2JointStatePublisher"]


def test_a_robot_without_components_has_nothing_to_stream() -> None:
    with pytest.raises(MorseBuilderUnexportableError, match="no data to stream"):
        ATRV("robot").add_stream("socket")
