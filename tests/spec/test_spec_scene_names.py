"""Names of components in a scene script, as in 1.4."""

import pytest

from morse.builder.errors import ScriptError

_ENV = "\nenv = Environment('empty')\n"


def names_of(scene) -> list[str]:
    return [component.name for component in scene.components]


@pytest.mark.parametrize(
    ("script", "names"),
    [
        # variables
        ("robot = ATRV()\npose = Pose()\nrobot.append(pose)", ["robot", "robot.pose"]),
        # names that were given explicitly
        ("r = ATRV('bob')\np = Pose(name='here')\nr.append(p)", ["bob", "bob.here"]),
        ("r = ATRV()\nr.name = 'foo'\np = Pose()\np.name = 'bar'\nr.append(p)", ["foo", "foo.bar"]),
        # loops
        (
            "for i in range(3):\n    m = ATRV()\n    p = Pose()\n    m.append(p)\n    m.close_context()",
            ["m", "m.p", "m_001", "m_001.p", "m_002", "m_002.p"],
        ),
        ("for i in range(2):\n    r = ATRV('atrv%d' % i)", ["atrv0", "atrv1"]),
        # functions
        (
            "def make():\n    robot = ATRV()\n    pose = Pose()\n    robot.append(pose)\n    return robot\n"
            "a = make()\nb = make()",
            ["a", "a.pose", "b", "b.pose"],
        ),
        (
            "def make():\n    robot = ATRV()\n    AbstractComponent.close_context()\nmake()\nmake()",
            ["robot", "robot_001"],
        ),
        # classes that carry their equipment
        (
            "class Mine(ATRV):\n    def __init__(self):\n        ATRV.__init__(self)\n"
            "        keyboard = Keyboard()\n        self.append(keyboard)\n"
            "        self.motion = MotionVW()\n        self.append(self.motion)\n"
            "first = Mine()\nsecond = Mine()",
            ["first", "first.keyboard", "first.motion", "second", "second.keyboard", "second.motion"],
        ),
        # parts of parts
        (
            "robot = ATRV()\narm = Teleport()\nrobot.append(arm)\npose = Pose()\narm.append(pose)",
            ["robot", "robot.arm", "robot.arm.pose"],
        ),
        # the same name twice
        ("r = ATRV()\na = Pose('x')\nb = Pose('x')\nr.append(a)\nr.append(b)", ["r", "r.x", "r.x_001"]),
    ],
)
def test_names(load, script, names):
    assert sorted(names_of(load(script + _ENV))) == sorted(names)


def test_the_environment_in_a_function_names_the_variables_of_that_function(load):
    script = (
        "def main():\n    robot = ATRV()\n    pose = Pose()\n    robot.append(pose)\n    env = Environment('empty')\n"
    )
    script += "main()"
    assert names_of(load(script)) == ["robot", "robot.pose"]


def test_what_is_made_after_the_environment_keeps_the_name_of_its_model(load):
    script = "robot = ATRV()" + _ENV + "env.create()\nhurt = Victim()\nhurt.translate(x=3)\n"
    assert names_of(load(script + "env.set_time_strategy(TimeStrategies.FixedSimulationStep)")) == ["robot", "Victim"]


def test_no_renaming(load):
    script = "robot = ATRV()\npose = Pose()\nrobot.append(pose)\nenv = Environment('empty', component_renaming=False)"
    assert "robot" not in names_of(load(script))


@pytest.mark.parametrize(
    "made", ["robot = ATRV('a.b')", "robot = ATRV()\np = Pose('a.b')", "r = ATRV()\nr.name = 'a.b'"]
)
def test_dots_in_a_name_fail_the_script(load, made):
    with pytest.raises(ScriptError, match=r"scene\.py:[23]: .*'a\.b'"):
        load(made + _ENV)


# --- the objects of the scene under the names of Blender -------------------------------------------------


def test_objects_are_found_by_number_and_by_name(load):
    script = """
objects = bpymorse.get_objects()
assert objects["RedBox"] == bpymorse.get_object("RedBox")
assert "RedBox" in objects
assert "robot" in objects.keys()
assert objects.get("nothing") is None
assert objects[0] in list(objects)
assert objects["robot"].children["Wheel.1"].parent == objects["robot"]
objects["RedBx"]
"""
    with pytest.raises(ScriptError, match="did you mean 'RedBox'"):
        load("robot = ATRV()\nenv = Environment('indoors-1/boxes')" + script)


def test_properties_are_gone_through_as_objects_with_names_and_values(load):
    script = """
game = bpymorse.get_object("robot").game
found = {prop.name: prop.value for prop in game.properties}
assert found["Label"] == "x"
assert found["Count"] == 3
assert "Label" in game.properties
assert game.properties.get("nothing") is None
game.properties["Count"].value = 4
assert dict(game.properties.items())["Count"].value == 4
assert game.properties[0].name == game.properties.keys()[0]
"""
    scene = load("robot = ATRV()\nrobot.properties(Label='x', Count=3)" + _ENV + script)
    assert scene.find("robot").properties["Count"] == 4


def test_settings_of_the_game_engine_without_a_meaning_are_taken_with_a_warning(load, caplog):
    scene = load("r = ATRV()\nr._bpy_object.game.velocity_max = 3\nr._bpy_object.game.mass = 7" + _ENV)
    assert "scene.py:3: game.velocity_max has no effect" in caplog.text
    assert scene.find("r").body.mass == 7.0


def test_settings_that_the_game_engine_did_not_have_are_refused(load):
    with pytest.raises(ScriptError, match=r"scene\.py:3: .*did you mean 'mass'"):
        load("r = ATRV()\nr._bpy_object.game.mas = 3" + _ENV)


@pytest.mark.parametrize("order", ["bpymorse.set_speed(120, 5, 5)" + _ENV, _ENV + "bpymorse.set_speed(120, 5, 5)"])
def test_set_speed_before_and_after_the_environment(load, order):
    assert load("robot = ATRV()\n" + order).settings.frequency == 120.0


def test_set_speed_is_not_tuned_away(load):
    scene = load("bpymorse.set_speed(50)\nr = ATRV()\np = Pose()\np.frequency(200)\nr.append(p)" + _ENV)
    assert scene.settings.frequency == 50.0


def test_mathutils_can_be_imported(load):
    scene = load("import mathutils\nr = ATRV()\nr.location = mathutils.Vector((1, 2, 3))" + _ENV)
    assert list(scene.components[0].node.location) == [1.0, 2.0, 3.0]
