"""Changes of a scene are written into its script: the script describes the changed scene, and keeps its other lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from effort import examples
from morse.builder import workspace
from morse.builder.assembly.spawning import component_of
from morse.builder.editing.changes import Addition, Changes, Move, UnwritableError
from morse.builder.editing.writing import changed_script, variable_name
from morse.builder.own_classes import own_classes
from morse.builder.script import load_scene
from morse.core.classes.project_imports import ProjectImports
from morse.core.exceptions import MorseError
from morse.mathutils import Euler
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from pathlib import Path

#: what users write: literals, expressions, keywords, assignments, loops, names, several calls, no call
BODIES = [
    "{v} = {k}\n{v}.translate(1.0, -2.0, 0.5)  # by the door\n",
    "{v} = {k}\n{v}.translate(x=1)\n{v}.rotate(z=math.pi / 2)  # to the left\n",
    "{v} = {k}\n{v}.translate(1, 2)\n{v}.translate(z=0.25)\n{v}.rotate(0.1, 0.2, 0.3)\n",
    "{v} = {k}\n{v}.location = (3.0, 2.0, 1.0)\n",
    "{v} = {k}\n{v}.location[0] += 2\n{v}.rotate(0.0, -0.5)\n",
    "{v} = {k}\n{v}.name = '{v}er'\n",
    "{v} = {k}  # nothing else",
]
KINDS = ['PassiveObject("props/crates", object_name="small_crate")', "ATRV()", "PassiveObject('props/objects', 'Desk')"]
NEW = ["ATRV", "Morsy", "props/crates#small_crate", "props/kitchen_objects#Cup_Blue"]
#: where the environment stands
FRAMES = [
    "import math\nfrom morse.builder import *\n\n{body}\n# the world\nenv = Environment('empty')\n"
    "env.set_camera_location([1, 2, 3])\n",
    '"""Text."""\nimport math\nfrom morse.builder import (\n    ATRV,\n    Environment,\n    PassiveObject,\n)\n'
    '{body}Environment("empty")',
    "import math\nfrom morse.builder import ATRV, PassiveObject, Environment  # what is needed\n"
    "{body}env = Environment('empty')\n",
]
LOOP = """for number in range(2):
    box = PassiveObject('props/crates', object_name='small_crate')
    box.translate(number, 5)
    box.name = f'box{number}'
"""
metres = st.floats(-50, 50).map(lambda value: round(value, 3))
angles = st.floats(-3, 3).map(lambda value: round(value, 3))
poses = st.tuples(st.tuples(metres, metres, metres), st.tuples(angles, angles, angles))


def scene_of(text: str, folder: Path) -> dict[str, tuple[list[float], list[float]]]:
    """Poses of the roots of the scene that a script describes."""
    path = folder / "scene.py"
    path.write_text(text)
    scene = load_scene(RunOptions(script=str(path)), anew=True)
    return {root.name: ([*root.location], [*root.rotation_euler]) for root in scene.roots}


def same(a: tuple[Any, Any], b: tuple[Any, Any]) -> bool:
    """Whether two poses differ by less than a millimetre and a milliradian."""
    turn = Euler(a[1]).to_quaternion().rotation_difference(Euler(b[1]).to_quaternion())
    angle = 2 * math.acos(min(abs(turn.w), 1.0))
    return math.dist(a[0], b[0]) < 1e-3 and angle < 1e-3


def test_the_script_of_a_changed_scene_describes_the_changed_scene(tmp_path: Path) -> None:
    @settings(max_examples=examples(60), deadline=None)
    @given(
        st.lists(st.tuples(st.sampled_from(BODIES), st.sampled_from(KINDS)), max_size=3),
        st.sampled_from(FRAMES),
        st.booleans(),
        st.data(),
    )
    def check(parts: list[tuple[str, str]], frame: str, loop: bool, data: st.DataObject) -> None:
        body = "".join(text.format(v=f"part{n}", k=kind) + "\n" for n, (text, kind) in enumerate(parts))
        text = frame.format(body=body + (LOOP if loop else ""))
        before = scene_of(text, tmp_path)
        expected = dict(before)
        own = [name for name in before if name.startswith(("part", "box"))]
        additions, moves, deletions = [], [], {}
        for name in data.draw(st.lists(st.sampled_from(own), unique=True) if own else st.just([])):
            if name.startswith("part") and data.draw(st.booleans()):
                deletions[name] = []
                del expected[name]
                continue
            expected[name] = data.draw(poses)
            old = before[name]
            moves.append(Move(name, *expected[name], tuple(old[0]), tuple(old[1])))
        for kind in data.draw(st.lists(st.sampled_from(NEW), max_size=3)):
            name = variable_name(kind, expected)
            expected[name] = data.draw(poses)
            with workspace.described():
                made = component_of(kind)
                place = (*made.location,), (*made.rotation_euler,)
            additions.append(Addition(name, kind, *expected[name], "", *place))
        changed = changed_script(text, Changes(additions, moves, deletions))
        after = scene_of(changed, tmp_path)
        assert after.keys() == expected.keys(), changed
        assert all(same(after[name], expected[name]) for name in expected), changed
        comments = [line.partition("#")[2] for line in text.splitlines() if "#" in line]
        gone = tuple(deletions)
        for comment, line in zip(comments, (line for line in text.splitlines() if "#" in line), strict=True):
            assert comment in changed or line.startswith(gone)

    check()


def test_a_script_without_changes_stays_as_it_is() -> None:
    text = "from morse.builder import *\r\n\r\nrobot = ATRV( )   # ß\r\nenv = Environment('empty')"
    assert changed_script(text, Changes()) == text


def test_sensors_are_appended_to_their_robots() -> None:
    text = "from morse.builder import *\n\ncar = ATRV('tom')\n\nenv = Environment('empty')\n"
    changes = Changes([Addition("camera", "VideoCamera", (0.2, 0.0, 1.0), robot="tom")])
    assert changed_script(text, changes) == (
        "from morse.builder import *\n\ncar = ATRV('tom')\n\ncamera = VideoCamera()\ncamera.translate(0.2, 0.0, 1.0)\n"
        "car.append(camera)\n\nenv = Environment('empty')\n"
    )


def test_classes_of_a_project_are_imported_from_it() -> None:
    text = "from morse.builder import *\nenv = Environment('empty')\n"
    changes = Changes(
        [Addition("ranger", "my_sim.builder.robots:Ranger", (1, 0, 0)), Addition("atrv", "ATRV", (0, 0, 0))]
    )
    changed = changed_script(text, changes)
    assert "from my_sim.builder.robots import Ranger\n" in changed
    assert "ranger = Ranger()\nranger.translate(x=1.0)\n" in changed
    assert changed_script(changed, Changes([changes.additions[0]])).count("import Ranger") == 1


@pytest.mark.parametrize("kind", ["os.builder.robots:system", "my_sim.robots:Ranger", "my_sim.builder.robots:os"])
def test_only_classes_of_the_project_come_by_name(kind: str, tmp_path: Path) -> None:
    package = tmp_path / "src" / "my_sim"
    for folder in (package, package / "builder", package / "builder" / "robots"):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "__init__.py").touch()
    robots = package / "builder" / "robots" / "__init__.py"
    robots.write_text("import os\nfrom morse.builder import FakeRobot\n\n\nclass Ranger(FakeRobot):\n    pass\n")
    with ProjectImports([str(tmp_path / "src")]), workspace.described():
        assert own_classes([str(tmp_path / "src")]) == [("my_sim.builder.robots:Ranger", "Ranger")]
        assert type(component_of("my_sim.builder.robots:Ranger")).__name__ == "Ranger"
        with pytest.raises((MorseError, FileNotFoundError)):
            component_of(kind)
    with pytest.raises((MorseError, FileNotFoundError)), workspace.described():
        component_of("my_sim.builder.robots:Ranger")


def test_objects_of_the_world_are_placed_and_deleted_after_it_is_loaded() -> None:
    text = "from morse.builder import Environment\nenv = Environment('sandbox')\n"
    moves = [Move("Ball1", (1.0, 2.0, 0.3), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))]
    once = changed_script(text, Changes([], moves, {"Jump": ["Ramp"]}))
    assert once == (
        "from morse.builder import Environment, bpymorse\nenv = Environment('sandbox')\n"
        "bpymorse.get_object('Ball1').location = (1.0, 2.0, 0.3)\nbpymorse.delete(['Jump', 'Ramp'])\n"
    )
    again = [Move("Ball1", (5.0, 2.0, 0.3), (0.0, 0.0, 0.0), (1.0, 2.0, 0.3), (0.0, 0.0, 0.0))]
    assert changed_script(once, Changes([], again)) == once.replace("(1.0, 2.0", "(5.0, 2.0")


@pytest.mark.parametrize(
    ("text", "changes", "place"),
    [
        ("from morse.builder import *\nrobot = (\n", Changes(), "line 2"),
        ("from scenes import *\n", Changes(), "Environment"),
        ("a = ATRV()\nprint(a)\nEnvironment('empty')\n", Changes(deletions={"a": []}), "line 2"),
        ("Environment('empty')\n", Changes([Addition("eye", "VideoCamera", (0, 0, 1), robot="a.b")]), "by hand"),
    ],
)
def test_what_cannot_be_written_says_what_to_do(text: str, changes: Changes, place: str) -> None:
    with pytest.raises(UnwritableError, match=place):
        changed_script(text, changes, "scene.py")


def test_names_of_models_never_become_code() -> None:
    text = "from morse.builder import *\nEnvironment('empty')\n"
    hostile = 'props/x#a", b=print(1))\n\nprint("\''
    changed = changed_script(text, Changes([Addition(variable_name(hostile, set()), hostile, (1.0, 0.0, 0.0))]))
    assert "\nprint(" not in changed
    assert variable_name(hostile, set()).isidentifier()
