"""Changes of a scene are written into its script: the script describes the changed scene, and keeps its other lines."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.builder import workspace
from morse.builder.assembly.spawning import component_of
from morse.builder.editing.changes import Addition, Changes, Move, UnwritableError
from morse.builder.editing.source import Source
from morse.builder.editing.writing import changed_script, variable_name
from morse.builder.own_classes import own_classes
from morse.builder.script import load_scene
from morse.core.classes.project_imports import ProjectImports
from morse.core.exceptions import MorseError
from morse.mathutils import Euler
from morse.simulation.options import RunOptions
from tests.kit.effort import examples

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


HEAD = "from morse.builder import *\n"
ORIGIN = (0.0, 0.0, 0.0)


def moved(name: str, x: float, y: float, old: tuple[float, float] = (0.0, 0.0)) -> Changes:
    return Changes([], [Move(name, (x, y, 0.0), ORIGIN, (*old, 0.0), ORIGIN)])


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("a = ATRV(); b = Morsy()\n{e}", "b = Morsy()\n{e}"),
        ("b = Morsy(); a = ATRV()  # two\n{e}", "b = Morsy()  # two\n{e}"),
        ("a = ATRV(); a.translate(1); a.rotate(1)  # three\nb = Morsy()\n{e}", "b = Morsy()\n{e}"),
        ("x = 1; a = ATRV(\n  'a'\n); y = (\n  2)\n{e}", "x = 1; y = (\n  2)\n{e}"),
        ("x = 1; \\\n  a = ATRV(); \\\n  y = 2\n{e}", "x = 1; \\\n  y = 2\n{e}"),
        ("a = ATRV(); {e}", "{e}"),
        ("x = 1  # one\na = ATRV()  # two\n# three\n{e}", "x = 1  # one\n# three\n{e}"),
        ("x = 1; a = ATRV()  # one\na.translate(1)  # two\n{e}", "x = 1  # one\n{e}"),
        ("a = ATRV()\np = Pose(); a.append(p); c = Morsy()\n{e}", "c = Morsy()\n{e}"),
        ("a = ATRV()\np = KukaLWR()\nq = Gripper()\np.append(q)\na.append(p)\n{e}", "{e}"),
        ("if True:\n\ta = ATRV()\n\t{e}", "if True:\n\t{e}"),
    ],
)
def test_a_deletion_removes_its_own_statements_only(before: str, after: str) -> None:
    before, after = (HEAD + text.format(e="env = Environment('empty')") for text in (before, after))
    assert changed_script(before, Changes(deletions={"a": []})) == after


def test_neighbours_on_one_line_are_deleted_together() -> None:
    text = HEAD + "a = ATRV(); b = ATRV(); c = ATRV(); Environment('empty')\n"
    changed = changed_script(text, Changes(deletions={"b": [], "a": []}))
    assert changed == HEAD + "c = ATRV(); Environment('empty')\n"


@pytest.mark.parametrize(
    "before",
    [
        "a = ATRV()\na.translate(x := 3)\nb = ATRV()\nb.translate(x)\n",
        "a = ATRV()\na.translate(next(n))\nb = ATRV()\nb.translate(next(n))\n",
        "a = make()\n",
        "a = b = ATRV()\n",
        "a = ATRV()\nfor n in range(2):\n    a = ATRV()\n",
        "for n in range(2):\n    b = ATRV()\n    b.name = 'a'\na = ATRV()\n",
    ],
)
def test_what_others_need_stays_and_the_object_is_deleted_by_name(before: str) -> None:
    before = HEAD + before + "env = Environment('empty')\n"
    written = changed_script(before, Changes(deletions={"a": []}))
    assert written.replace('"', "'") == before + "bpymorse.delete('a')\n"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("a.translate(\n\t1.0,  # x\n\t2.0,  # y\n)", "a.translate(\n\t3.0,  # x\n\t1.0,  # y\n)"),
        ("a.translate(1.0  # x\n)", "a.translate(3.0, -1.0  # x\n)"),
        ("a.translate((1.0),)", "a.translate((3.0), -1.0,)"),
        ("a.translate(y=(n))", "a.translate(y=(n - 1.0), x=2.0)"),
        ("a.translate(n | 1, -n)", "a.translate((n | 1) + 2.0, (-n) - 1.0)"),
        ("a.translate()  # no", "a.translate(x=2.0, y=-1.0)  # no"),
        ("a.translate(*n)  # all", "a.translate(*n)  # all\na.translate(2.0, -1.0)"),
        ("a.translate(1); a.location.x = 2; n = 3", "a.translate(1); a.location.x = 2; a.translate(2.0, -1.0); n = 3"),
    ],
)
def test_a_move_changes_numbers_and_nothing_between_them(before: str, after: str) -> None:
    text = HEAD + "a = ATRV()\n{}\nenv = Environment('empty')\n"
    assert changed_script(text.format(before), moved("a", 2.0, -1.0)) == text.format(after)


@pytest.mark.parametrize(
    "use",
    ["put(a)", "if n:\n    a.location = n", "b.location = a.location", "b = a", "def f():\n    a.location = n\nf()"],
)
def test_what_other_statements_may_place_is_placed_behind_them(use: str) -> None:
    text = f"{HEAD}a = ATRV()\n{use}\nenv = Environment('empty')\n"
    line = "bpymorse.get_object('a').location = (2.0, -1.0, 0.0)\n"
    assert changed_script(text, moved("a", 2.0, -1.0)) == text + line


def test_an_object_of_the_world_with_a_variable_is_placed_after_its_last_use(tmp_path: Path) -> None:
    text = HEAD + "env = Environment('sandbox')\nt = bpymorse.get_object('Ball1')\nt.location = (1, 2, 3)\nenv.create()"
    place = "\nbpymorse.get_object('Ball1').location = (5.0, 6.0, 0.0)"
    once = changed_script(text, moved("Ball1", 5.0, 6.0, (1.0, 2.0)))
    assert once == text.replace("3)", f"3){place}")
    assert scene_of(once, tmp_path)["Ball1"][0] == [5.0, 6.0, 0.0]
    again = changed_script(once, moved("Ball1", 7.0, 6.0, (5.0, 6.0)))
    assert again == once.replace("5.0", "7.0")
    # it is placed before it is deleted
    gone = changed_script(again, Changes(deletions={"Ball1": []}))
    assert gone.endswith("(7.0, 6.0, 0.0)\nbpymorse.delete('Ball1')\nenv.create()")
    assert "Ball1" not in scene_of(gone, tmp_path)


def test_a_script_that_may_end_before_the_new_last_line_is_refused() -> None:
    text = HEAD + "import sys\ndef main():\n    Environment('sandbox')\n    sys.exit(0)\nmain()\n"
    with pytest.raises(UnwritableError, match="line 5, may end the script"):
        changed_script(text, moved("Ball1", 5.0, 6.0), "scene.py")


@pytest.mark.parametrize(
    "head",
    [
        "#!/usr/bin/python\n# -*- coding: latin-1 -*-\n# mine\n'''Text.'''\nfrom morse.builder import Environment\n",
        "import os; from morse.builder import Environment; x = 1\n",
        "import morse.builder as mb\nfrom morse.builder import Environment as World\n",
        "def later():\n    from morse.builder import PassiveObject\nfrom morse.builder import Environment\n",
    ],
)
def test_imports_stand_before_the_lines_that_need_them(head: str, tmp_path: Path) -> None:
    text = head + ("env = World('empty')" if "World" in head else "env = Environment('empty')")
    changed = changed_script(text, Changes([Addition("crate", "props/crates#small_crate", (1, 0, 0))]))
    assert changed.startswith(head.rpartition("Environment")[0])
    assert scene_of(changed, tmp_path)["crate"][0][0] == 1.0


@pytest.mark.parametrize(
    "line", ["def Morsy(): return 3", "from robots import Morsy", "for Morsy in range(3): pass", "import x as Morsy"]
)
def test_a_class_with_another_meaning_is_not_used(line: str) -> None:
    text = f"from morse.builder import *\n{line}\nEnvironment('empty')\n"
    with pytest.raises(UnwritableError, match="line 2, gives 'Morsy' another meaning"):
        changed_script(text, Changes([Addition("m", "Morsy", (1, 0, 0))]))


@pytest.mark.parametrize(
    "wrong", ["", "b = Morsy()\nenv = Environment('empty')\n", "b = Morsy()  # mine\n", "b = Morsy(  # mine\n"]
)
def test_a_result_that_is_not_proved_is_refused(wrong: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = HEAD + "a = ATRV()\nb = Morsy()  # mine\nenv = Environment('empty')\n"
    source = Source(text, "scene.py")
    source.edit(text.index("a ="), len(text), wrong)
    monkeypatch.setattr(source, "_removed", {id(source.tree.body[1])})
    monkeypatch.setattr(source, "_removals", list)
    with pytest.raises(UnwritableError, match="edit it by hand"):
        source.text()


@pytest.mark.parametrize(
    ("text", "changes", "place"),
    [
        ("from morse.builder import *\nrobot = (\n", Changes(), "line 2"),
        ("from scenes import *\n", Changes(), "Environment"),
        ("a = ATRV()\nprint(a)\nEnvironment('empty')\n", Changes(deletions={"a": []}), "line 2"),
        (
            "a = Zone('Charging')\nEnvironment('empty')\n",
            Changes(moves=[Move("a", ORIGIN, (0.0, 0.0, 1.0), ORIGIN, ORIGIN)]),
            "'a' is a Zone",
        ),
        ("x = '\0'\nEnvironment('empty')\n", Changes(), "valid"),
        (f"x = {'-' * 5000}1\nEnvironment('empty')\n", Changes(), "scene.py"),
        (
            "a = ATRV()\ne = Environment('empty')\ne.show(follow='a')\n",
            Changes(deletions={"a": []}),
            "line 3, uses 'a'",
        ),
        (
            "a = ATRV()\ne = Environment('empty')\ne.show(plots=['a.pose.x'])\n",
            Changes(deletions={"a": []}),
            "line 3, uses 'a.pose.x'",
        ),
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
