"""The state of saved files."""

from pathlib import Path

from morse.simulation.watching.edits import Edits, stamp


def test_the_innermost_line_is_the_place() -> None:
    edits = Edits()
    lines = (
        "KeyError: 'lefft'",
        '  File "/p/eyes.py", line 24, in act',
        "    f()",
        '  File "/p/help.py", line 3, in f',
    )
    edits.refuse("/p/eyes.py", "\n".join(lines))
    (mistake,) = edits.mistakes.values()
    assert mistake == ("/p/help.py", 3, "KeyError: 'lefft'")


def test_an_error_of_a_script_begins_with_its_place() -> None:
    edits = Edits()
    edits.refuse("/p/scene.py", "/p/scene.py:5: there is no 'ATVR'; did you mean 'ATRV'?\n    robot = ATVR()")
    (mistake,) = edits.mistakes.values()
    assert mistake == ("/p/scene.py", 5, "there is no 'ATVR'; did you mean 'ATRV'?")


def test_a_file_without_a_line_and_a_mended_one() -> None:
    edits = Edits()
    edits.refuse("/p/ranger.blend", "the file is damaged")
    assert edits.mistakes["/p/ranger.blend"] == ("/p/ranger.blend", 0, "the file is damaged")
    edits.take("/p/ranger.blend")
    assert not edits.mistakes
    edits.take("/p/scene.py", waits=True)
    assert list(edits.waiting) == ["/p/scene.py"]
    edits.refuse("/p/scene.py", "SyntaxError: x")
    edits.take("/p/scene.py", waits=True)
    assert not edits.mistakes


def test_a_file_that_a_restart_has_refused_waits_only_after_the_next_save(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text("robot = ATVR()\n")
    edits, path = Edits(), str(script)
    assert not edits.was_refused(path)
    edits.refuse_at_restart([path], {path: stamp(path)}, f"{path}:1: there is no 'ATVR'")
    assert edits.was_refused(path)
    assert edits.mistakes[path] == (path, 1, "there is no 'ATVR'")
    script.write_text("robot = ATRV()  # longer\n")
    assert not edits.was_refused(path)
