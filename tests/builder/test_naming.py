from collections.abc import Callable
from pathlib import Path

import pytest

from morse.builder.script import ScriptError
from morse.scene import Scene

Load = Callable[..., Scene]

HEAD = "from morse.builder import *\n"
END = "env = Environment('empty')\n"


def names(scene: Scene) -> list[str]:
    return [component.name for component in scene.components]


def test_components_are_named_after_variables(load: Load) -> None:
    scene = load(HEAD + "rover = FakeRobot()\neye = Pose()\nrover.append(eye)\n" + END)
    assert names(scene) == ["rover", "rover.eye"]
    assert scene.find("rover.eye") is scene.components[1].node


def test_components_of_components_get_the_whole_path(load: Load) -> None:
    scene = load(
        HEAD + "rover = FakeRobot()\narm = Teleport()\nhand = Pose()\narm.append(hand)\nrover.append(arm)\n" + END
    )
    assert names(scene) == ["rover", "rover.arm", "rover.arm.hand"]
    assert scene.components[2].robot is scene.components[0].node


def test_attributes_and_locals_of_a_robot_class(load: Load) -> None:
    scene = load(
        HEAD + "class Ranger(FakeRobot):\n"
        "    def __init__(self, name=None):\n"
        "        FakeRobot.__init__(self, name)\n"
        "        self.motion = MotionVW()\n"
        "        self.append(self.motion)\n"
        "        keyboard = Keyboard()\n"
        "        self.append(keyboard)\n"
        "robot = Ranger()\nother = Ranger()\n" + END
    )
    assert names(scene) == [
        "robot", "robot.motion", "robot.keyboard", "other", "other.motion", "other.keyboard",
    ]  # fmt: skip


def test_an_attribute_is_preferred_to_the_variable_of_a_loop(load: Load) -> None:
    scene = load(
        HEAD + "class Ranger(FakeRobot):\n"
        "    def __init__(self):\n"
        "        FakeRobot.__init__(self)\n"
        "        self.left, self.right = Pose(), Pose()\n"
        "        for sensor in (self.left, self.right):\n"
        "            self.append(sensor)\n"
        "r = Ranger()\n" + END
    )
    assert names(scene) == ["r", "r.left", "r.right"]


def test_a_given_name_wins(load: Load) -> None:
    scene = load(
        HEAD + "a = FakeRobot('mana')\nb = Pose('eye')\na.append(b)\nc = FakeRobot()\nc.name = 'minnie'\n" + END
    )
    assert names(scene) == ["mana", "mana.eye", "minnie"]


def test_loop_closed_by_hand(load: Load) -> None:
    scene = load(
        HEAD + "for i in range(3):\n"
        "    m = FakeRobot()\n"
        "    p = Pose()\n"
        "    m.append(p)\n"
        "    AbstractComponent.close_context()\n" + END
    )
    assert names(scene) == ["m", "m.p", "m_001", "m_001.p", "m_002", "m_002.p"]


def test_loop_needs_no_closing(load: Load) -> None:
    scene = load(HEAD + "for i in range(3):\n    m = FakeRobot()\n    p = Pose()\n    m.append(p)\n" + END)
    assert names(scene) == ["m", "m.p", "m_001", "m_001.p", "m_002", "m_002.p"]


def test_robots_of_a_class_of_the_script_are_named_in_a_loop_as_others(load: Load) -> None:
    scene = load(
        HEAD + "class Ranger(FakeRobot):\n"
        "    def __init__(self, name=None):\n"
        "        FakeRobot.__init__(self, name)\n"
        "        self.pose = Pose()\n"
        "        self.append(self.pose)\n"
        "for i in range(3):\n    m = Ranger()\n" + END
    )
    assert names(scene) == ["m", "m.pose", "m_001", "m_001.pose", "m_002", "m_002.pose"]


def test_close_context_of_the_caller(load: Load) -> None:
    scene = load(
        HEAD + "def done():\n    AbstractComponent.close_context(2)\n"
        "fleet = []\n"
        "for i in range(2):\n    rover = FakeRobot()\n    done()\n    fleet.append(rover)\n    del rover\n" + END
    )
    assert names(scene) == ["rover", "rover_001"]


def test_robots_made_by_a_function_are_named_where_they_end_up(load: Load) -> None:
    scene = load(
        HEAD + "def equipped():\n"
        "    robot = FakeRobot()\n"
        "    pose = Pose()\n"
        "    robot.append(pose)\n"
        "    return robot\n"
        "alice = equipped()\nbob = equipped()\n" + END
    )
    assert names(scene) == ["alice", "alice.pose", "bob", "bob.pose"]


def test_robots_kept_in_a_list_still_have_distinct_names(load: Load) -> None:
    scene = load(
        HEAD + "def equipped():\n    robot = FakeRobot()\n    robot.append(Pose('eye'))\n    return robot\n"
        "fleet = [equipped() for i in range(3)]\n" + END
    )
    assert names(scene) == ["robot", "robot.eye", "robot_001", "robot_001.eye", "robot_002", "robot_002.eye"]


def test_environment_made_in_a_method(load: Load) -> None:
    """The format of scene scripts from the test harness."""
    scene = load(
        HEAD + "class MyEnv():\n"
        "    def setUpEnv(self):\n"
        "        robot = FakeRobot()\n"
        "        pose = Pose()\n"
        "        robot.append(pose)\n"
        "        env = Environment('empty')\n"
        "        env.set_time_strategy(TimeStrategies.FixedSimulationStep)\n"
        "MyEnv().setUpEnv()\n",
        name="no_suffix",
    )
    assert names(scene) == ["robot", "robot.pose"]


def test_environment_made_in_a_function_sees_the_variables_of_the_script(load: Load) -> None:
    scene = load(HEAD + "rover = FakeRobot()\ndef world():\n    return Environment('empty')\nenv = world()\n")
    assert names(scene) == ["rover"]


def test_environment_subclass_sees_the_variables_of_the_script(load: Load) -> None:
    scene = load(
        HEAD + "class World(Environment):\n    def __init__(self):\n        Environment.__init__(self, 'empty')\n"
        "def build():\n    rover = FakeRobot()\n    env = World()\n    return env\n"
        "env = build()\n"
    )
    assert names(scene) == ["rover"]


def test_append_in_a_function_finds_global_variables(load: Load) -> None:
    scene = load(HEAD + "rover = FakeRobot()\neye = Pose()\ndef equip():\n    rover.append(eye)\nequip()\n" + END)
    assert names(scene) == ["rover", "rover.eye"]


def test_attributes_given_to_a_robot_by_the_script(load: Load) -> None:
    scene = load(HEAD + "r = FakeRobot()\nr.eye = Pose()\nr.append(r.eye)\n" + END)
    assert names(scene) == ["r", "r.eye"]


def test_same_names_on_one_robot(load: Load) -> None:
    scene = load(HEAD + "r = FakeRobot()\nfor i in range(3):\n    eye = Pose()\n    r.append(eye)\n" + END)
    assert names(scene) == ["r", "r.eye", "r.eye_001", "r.eye_002"]


def test_what_no_variable_holds_is_named_after_its_class(load: Load) -> None:
    scene = load(HEAD + "r = FakeRobot()\nr.append(Pose())\nr.append(Pose())\n" + END)
    assert names(scene) == ["r", "r.Pose", "r.Pose_001"]


def test_things_are_named_after_variables_too(load: Load) -> None:
    scene = load(HEAD + "table = Cube()\nbox = PassiveObject('props/crates', 'small_crate')\n" + END)
    assert {"table", "box"} <= {node.name for node in scene.roots}


def test_the_first_of_two_objects_keeps_the_name(load: Load) -> None:
    scene = load(HEAD + "Ground = FakeRobot()\n" + END)
    assert names(scene) == ["Ground"]
    assert scene.find("Ground.001").plain_name == "Ground"  # type: ignore[union-attr]


def test_made_after_the_environment_keeps_its_raw_name(load: Load) -> None:
    scene = load(HEAD + "robot = FakeRobot()\n" + END + "late = Cube()\nvictim = FakeRobot()\n")
    assert names(scene) == ["robot", "FakeRobot"]
    assert "Cube" in {node.name for node in scene.roots}


def test_renaming_switched_off(load: Load) -> None:
    scene = load(
        HEAD + "a = FakeRobot()\neye = Pose()\na.append(eye)\nb = FakeRobot()\n"
        "env = Environment('empty', component_renaming=False)\n"
    )
    assert names(scene) == ["FakeRobot", "Pose", "FakeRobot.001"]


@pytest.mark.parametrize("line", ["r.name = 'a.b'", "r = FakeRobot('a.b')", "p = Pose('a.b')"])
def test_a_dot_in_a_name_fails_the_script(load: Load, line: str, tmp_path: Path) -> None:
    with pytest.raises(ScriptError) as caught:
        load(HEAD + "r = FakeRobot()\n" + line + "\n" + END)
    assert caught.value.where is not None
    assert caught.value.where.line == 3
    assert "a_b" in caught.value.report()
    assert isinstance(caught.value.__cause__, SyntaxError)


@pytest.mark.parametrize("name", ["''", "'  '", "3", "['a']", "b'x'"])
def test_what_is_no_name_fails_the_script(load: Load, name: str) -> None:
    with pytest.raises(ScriptError, match="name"):
        load(HEAD + f"r = FakeRobot({name})\n" + END)


def test_names_are_unique_over_the_whole_scene(load: Load) -> None:
    scene = load(
        HEAD
        + "for i in range(20):\n    m = Morsy()\n    m.append(Pose())\n    c = PassiveObject('props/crates')\n"
        + END
    )
    every = [node.name for node in scene.nodes()]
    assert len(every) == len(set(every))
    assert len(scene.robots()) == 20


def test_parts_of_a_model_are_found_by_their_plain_name(load: Load) -> None:
    scene = load(HEAD + "a = Morsy()\nb = Morsy()\n" + END)
    second = scene.find("b")
    assert second is not None
    assert "morsy_mesh" in {child.plain_name for child in second.children}
    assert "morsy_mesh.001" in {child.name for child in second.children}


def test_where_each_component_was_made(load: Load, tmp_path: Path) -> None:
    scene = load(HEAD + "rover = FakeRobot()\neye = Pose(\n)\nrover.append(eye)\n" + END)
    assert [str(c.where) for c in scene.components] == [f"{tmp_path}/scene.py:2", f"{tmp_path}/scene.py:3"]


def test_a_robot_class_of_the_script_is_made_where_it_is_called(load: Load) -> None:
    scene = load(
        HEAD
        + "class Ranger(FakeRobot):\n    def __init__(self):\n        FakeRobot.__init__(self)\n\nr = Ranger()\n"
        + END
    )
    assert scene.components[0].where is not None
    assert scene.components[0].where.line == 6
