"""Scripts of many forms are edited at random: the saved script describes the edited scene, and all other text stays."""

import io
import re
import shutil
import tokenize
from pathlib import Path
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_editing import NEW, poses, same

import morse
from morse.builder import workspace
from morse.builder.assembly.spawning import component_of
from morse.builder.editing.changes import Addition, Changes, Move, UnwritableError
from morse.builder.editing.source import Source
from morse.builder.editing.writing import changed_script, variable_name
from morse.builder.script import load_scene
from morse.simulation.options import RunOptions
from morse.system.source_text import encoded_source
from tests.kit.effort import examples

DEMOS = Path(morse.__file__).parent / "data" / "examples"
CRATE = 'PassiveObject("props/crates", object_name="small_crate")'
KINDS = [CRATE, "PassiveObject('props/objects', 'Desk')", "ATRV()", "Morsy()"]

#: how a script makes an object; `{v}` is its variable, `{k}` its class, an indented line begins with a tab
CREATIONS = [
    "{v} = {k}",
    "{v} = {k}",
    "{v}: object = {k}",
    "{v} = same_{v} = {k}",
    "{v}, other_{v} = {k}, 3",
    "({v} := {k})",
    "if True:\n\t{v} = {k}\nelse:\n\tpass",
    "with nullcontext() as nothing:\n\t{v} = {k}  # in a block\n\t{v}.translate(1, 1)",
    "try:\n\t{v} = {k}\nfinally:\n\tpass",
    "for {v}_number in range(2):\n\t{v} = {k}; {v}.translate(0, {v}_number * 4)",
    "def make_{v}(count=1):\n\t'''Docstring.'''\n\tmade = {k}\n\tmade.translate(z=count)\n\treturn made\n"
    "{v} = make_{v}()",
    "@logged\ndef make_{v}():\n\treturn {k}\n\n{v} = make_{v}()",
    "{v}_all = [{k} for _ in range(2)]\n{v} = {v}_all[1]",
    "class Maker{v}:\n\tdef make(self):\n\t\treturn {k}\n{v} = Maker{v}().make()",
    "{v} = {k}\n{v}.name = 'named_{v}'",
    "{v} = {k}\n{v}.name = f'formatted_{v}'",
    "class Own{v}({c}):\n\tdef at_home(self):\n\t\tself.location = (7, 7, 0)\n{v} = Own{v}({a})\n{v}.at_home()",
]
#: how it places the object
PLACEMENTS = [
    "{v}.translate(1.0, -2.0, 0.5)  # by the door",
    "{v}.translate(\n\tx=1.0,  # east\n\tz=(2),\n)",
    "{v}.translate(1.5  # only this\n)",
    "{v}.translate(1, \\\n  (2.0))",
    "{v}.translate(x := 1.0, 2 if x else 3)",
    "{v}.translate(1 | 2, 3 << 1)",
    "{v}.translate(*(1, 2))",
    "{v}.translate(**dict(x=2))",
    "{v}.translate(next(numbers), 0)",
    "{v}.rotate(z=math.pi / 2)  # to the left",
    "{v}.rotate(0.1, -0.2)",
    "{v}.rotate()",
    "{v}.location = (3.0, 2.0, 1.0)",
    "{v}.location = here = (3.0, 2.0, 1.0)",
    "{v}.location[0] += 2",
    "{v}.location.x = 4",
    "{v}.rotation_euler = (0, 0, 1)",
    "if {v}:\n\t{v}.location = (6, 6, 0)  # in a block",
    "def put_{v}(thing=None):\n\t{v}.location = (5, 5, 0)\nput_{v}()",
    "[{v}.translate(axis) for axis in (1, 2)]",
    "place({v})",
    "beside = {v}.location[1] + 1",
    "{v}.location, unused = (1, 2, 3), '#'",
    "{v}.properties(Label='{v} # no comment')",
    '"""Text {v} = 1"""',
    "# a comment on {v}",
    "",
]
AFTER = [
    "env.set_camera_location([1, 2, 3])  # from here",
    "env.properties(latitude=3.0)",
    "for thing in everything:\n\tthing.translate(z=1)",
    "found = bpymorse.get_object('Marker')\nfound.location = (9, 9, 0)",
    "import json",
    "# the end",
]
ENVIRONMENTS = [
    "env = Environment('empty')",
    "Environment('empty')",
    "env = Environment(\n\t'empty',  # nothing\n)",
    "if everything is None:\n\tenv = Environment('sandbox')\nelse:\n\tenv = Environment('empty')",
    "if everything is None:\n\tenv = Environment('sandbox')\nelif True:\n\tenv = Environment('empty')",
    "try:\n\tenv = Environment('nowhere at all')\nexcept FileNotFoundError:\n\tenv = Environment('empty')",
    "if True: env = Environment('empty')",
    "with nullcontext(): env = Environment('empty')",
    "ready = True; env = Environment('empty'); ready = False",
    "make = lambda: Environment('empty')\nenv = make()",
    "class World(Environment):\n\t'''Mine.'''\n\nenv = World('empty')",
]
HEADS = [
    "from morse.builder import *\n",
    "from morse.builder import ATRV, Morsy, PassiveObject, Zone, bpymorse, Environment  # what is needed\n",
    "from morse.builder import (\n\tATRV,\n\tMorsy,  # a robot\n\tPassiveObject, Zone,\n\tEnvironment,\n)\n"
    "from morse.builder import bpymorse\n",
    "import os; from morse.builder import *\n",
]
HELPERS = """import math
from contextlib import nullcontext
everything = []
numbers = iter(range(100))
def logged(function):
\treturn function
def place(thing):
\tthing.location = (8, 8, 0)
"""
#: the end of a line, indentation, the first bytes, whether the last line ends
LAYOUTS = st.tuples(
    st.sampled_from(["\n", "\r\n", "\r"]), st.sampled_from(["\t", "    ", " "]), st.booleans(), st.booleans()
)


class Part(NamedTuple):
    """One object of a script."""

    variable: str
    text: str


@st.composite
def scripts(draw: st.DrawFn) -> str:
    """The text of a script."""
    statements = []
    for number in range(draw(st.integers(0, 3))):
        variable, kind = f"part{number}", draw(st.sampled_from(KINDS))
        cls, _, arguments = kind.partition("(")
        chosen = [draw(st.sampled_from(CREATIONS)), *draw(st.lists(st.sampled_from(PLACEMENTS), max_size=3))]
        words = {"v": variable, "k": kind, "c": cls, "a": arguments[:-1]}
        own = [re.sub(r"\{([vkca])\}", lambda match, words=words: words[match[1]], one) for one in chosen]
        if draw(st.integers(0, 4)) == 0:
            own.append(f"everything.append({variable})")
        statements += own
    marker = f"marker = {CRATE}\nmarker.name = 'Marker'"
    after = draw(st.lists(st.sampled_from(AFTER), max_size=3, unique=True))
    environment = draw(st.sampled_from(ENVIRONMENTS))
    if "env =" not in environment:
        after = [one for one in after if "env." not in one]
    body = joined(draw, [marker, *statements])
    body += ("" if draw(st.booleans()) else "\n# the world\n") + environment + "\n" + joined(draw, after)
    if draw(st.integers(0, 3)) == 0:
        # the statements of a function; a name is not bound within it and outside
        body = "def main():\n" + re.sub("(?m)^(?=.)", "\t", body) + "main()\n"
    ending, indent, docstring, last = draw(LAYOUTS)
    head = ("# -*- coding: latin-1 -*-\n" if draw(st.booleans()) else "") + (
        '"""Über\n# this."""\n' if docstring else ""
    )
    text = (head + draw(st.sampled_from(HEADS)) + HELPERS + "\f\n" + body).replace("\t", indent)
    return (text if last else text.rstrip("\n")).replace("\n", ending)


def joined(draw: st.DrawFn, statements: list[str]) -> str:
    """Statements on lines, some of them on the same one."""
    text = ""
    for statement in statements:
        simple = not re.match("if|with|try|for|def|class|@|#", statement) and "\n" not in statement and statement
        before = text.rpartition("\n")[2]
        if (
            simple
            and "#" not in before
            and before
            and not before.startswith(("\t", "def", "if", ")"))
            and draw(st.booleans())
        ):
            text += draw(st.sampled_from(["; ", " ;", "; \\\n"])) + statement
        else:
            text += ("\n" if text else "") + statement
    return text + "\n" if text else ""


def objects_of(text: str, folder: Path) -> dict[str, tuple[list[float], list[float], int]]:
    """For each root of the scene that a script describes: pose, and number of the nodes below it."""
    path = folder / "scene.py"
    path.write_bytes(encoded_source(text))
    scene = load_scene(RunOptions(script=str(path)), anew=True)
    return {root.name: ([*root.location], [*root.rotation_euler], len([*root.walk()])) for root in scene.roots}


def comments_of(text: str) -> list[str]:
    lines = io.StringIO(re.sub("\r\n?", "\n", text)).readline
    return [token.string for token in tokenize.generate_tokens(lines) if token.type == tokenize.COMMENT]


def pieces_of(text: str) -> list[str]:
    """The lines, divided where semicolons join statements, without those that continue a statement."""
    pieces = (piece.strip(" \t\f\\") for piece in re.split("\r\n|\r|\n|;", text))
    return [piece for piece in pieces if piece and not re.match(r"[xz]=|\)|\(2\.0\)\)|'empty',", piece)]


def is_part_of(few: list[str], many: list[str]) -> bool:
    """Whether all items of a list are in another one, in the same order."""
    rest = iter(many)
    return all(any(item == other for other in rest) for item in few)


def test_a_saved_script_describes_the_edited_scene_and_keeps_all_other_text(tmp_path: Path) -> None:
    refusals: list[str] = []

    @settings(max_examples=examples(400, each_time=30), deadline=None)
    @given(scripts(), st.data())
    def check(text: str, data: st.DataObject) -> None:
        before = objects_of(text, tmp_path)
        expected = dict(before)
        additions, moves = [], []
        deletions: dict[str, list[str]] = {}
        for name in data.draw(st.lists(st.sampled_from(sorted(before)), unique=True, max_size=3)):
            if data.draw(st.booleans()):
                deletions[name] = []
                try:
                    changed_script(text, Changes(deletions=deletions))
                except UnwritableError as refusal:  # the editor refuses such a deletion at once
                    del deletions[name]
                    refusals.append(str(refusal))
                    continue
                del expected[name]
                continue
            new = data.draw(poses)
            moves.append(Move(name, *new, tuple(before[name][0]), tuple(before[name][1])))
            expected[name] = (*new, before[name][2])
        taken = Source(text, "").names() | {*before}
        for kind in data.draw(st.lists(st.sampled_from(NEW), max_size=2)):
            name = variable_name(kind, taken)
            taken.add(name)
            with workspace.described():
                made = component_of(kind)
                place, count = ((*made.location,), (*made.rotation_euler,)), len([*made.scene_node.walk()])
            new = data.draw(poses)
            additions.append(Addition(name, kind, *new, "", *place))
            expected[name] = (*new, count)
        changed = changed_script(text, Changes(additions, moves, deletions), "scene.py")
        moved = [move.name for move in moves]
        after = objects_of(changed, tmp_path)
        assert after.keys() == expected.keys(), changed
        for name, (*pose, count) in expected.items():
            assert same(after[name][:2], pose), (name, after[name], pose, changed)
            assert after[name][2] == count, (name, changed)
        # all other text: the statements without a variable of what was changed stay, and their order
        variables = {match[0] for name in (*deletions, *moved) for match in re.finditer(r"part\d|marker", name.lower())}
        mine = re.compile("|".join(["Environment", "import", *variables]), re.IGNORECASE)
        others = [piece for piece in pieces_of(text) if not mine.search(piece)]
        assert is_part_of(others, pieces_of(changed)), changed
        if not deletions:
            assert comments_of(changed) == comments_of(text)
        assert set(re.findall("\r\n|\r|\n", changed)) == set(re.findall("\r\n|\r|\n", text))

    check()
    assert all(re.search(r", line \d+, uses '\w+': delete", refusal) for refusal in refusals)


@pytest.mark.parametrize("path", sorted(DEMOS.rglob("scene.py")), ids=lambda path: path.parent.name)
def test_all_objects_of_a_demo_are_moved_at_once(path: Path, tmp_path: Path) -> None:
    shutil.copytree(path.parent, tmp_path, dirs_exist_ok=True)
    text = path.read_text(encoding="utf-8")
    before = objects_of(text, tmp_path)
    # zones cannot be rotated, nor the sun of a date; dispensers make their boxes
    fixed = ("station", "Sun")
    moves = [
        Move(name, (x + 1.0, y - 2.0, z + 0.5), (a, b, c + 0.3 * (name not in fixed)), (x, y, z), (a, b, c))
        for name, ((x, y, z), (a, b, c), _) in before.items()
        if not re.search(r" box \d+$", name)
    ]
    after = objects_of(changed_script(text, Changes(moves=moves), "scene.py"), tmp_path)
    assert after.keys() == before.keys()
    for move in moves:
        assert same(after[move.name][:2], (move.position, move.angles)), move.name
