"""Regular expressions take time in proportion to the text: an unfinished comment, tag or call repeats no search."""

import ast
import re
import time
from pathlib import Path
from re import _constants, _parser
from typing import Any

import pytest

import morse

SOURCE = Path(morse.__file__).parent
#: packages that read files and messages of others
READERS = ("assets", "core", "middleware", "plugins", "recording", "rosmsgs", "scene", "simulation", "viewer", "wire")
#: characters of a text, and processor time that a quiet machine takes for it in proportion or squared, s
LENGTH, LIMIT = 60_000, 0.15
FILLERS = " \n0a."


def _patterns() -> list[tuple[str, str | bytes, int, bool]]:
    """Of each regular expression that is written as a literal: place, pattern, flags, whether it is searched."""
    found = []
    for path in sorted(path for reader in READERS for path in (SOURCE / reader).rglob("*.py")):
        if "re." not in (text := path.read_text(encoding="utf-8")):
            continue
        for node in ast.walk(ast.parse(text)):
            if not (isinstance(node, ast.Call) and ast.unparse(node.func).startswith("re.") and node.args):
                continue
            pattern = node.args[0]
            if isinstance(pattern, ast.Constant) and isinstance(pattern.value, (str, bytes)):
                words = " ".join(
                    ast.unparse(part) for part in [*node.args[1:], *(word.value for word in node.keywords)]
                )
                flags = [getattr(re, name) for name in re.findall(r"re\.([A-Z]+)", words)]
                name = re.search(r"(\w+)(?:: [^=\n]+)? = $|$", text[: _place(text, node)].rpartition("\n")[2])
                methods = {ast.unparse(node.func)[3:]}
                if "compile" in methods and name is not None and name[1]:
                    methods = set(re.findall(rf"\b{name[1]}\.(\w+)", text)) or {"search"}
                is_searched = not methods <= {"match", "fullmatch"}
                found.append((f"{path.relative_to(SOURCE)}:{node.lineno}", pattern.value, sum(flags), is_searched))
    return found


def _place(text: str, node: ast.Call) -> int:
    lines = text.split("\n")
    return sum(len(line) + 1 for line in lines[: node.lineno - 1]) + node.col_offset


PATTERNS = _patterns()


def _sample(parts: Any) -> str:
    """A short text that a parsed expression matches, or nearly."""
    text = ""
    for kind, value in parts:
        match kind:
            case _constants.LITERAL:
                text += chr(value)
            case _constants.NOT_LITERAL:
                text += "b" if value == ord("a") else "a"
            case _constants.ANY:
                text += "a"
            case _constants.IN:
                text += next((one for one in "a0 =/_-<([\"'" if _is_in(one, value)), "~")
            case _constants.BRANCH:
                text += _sample(value[1][0])
            case _constants.SUBPATTERN:
                text += _sample(value[3])
            case _constants.MAX_REPEAT | _constants.MIN_REPEAT | _constants.POSSESSIVE_REPEAT:
                text += _sample(value[2]) * max(value[0], 1)
    return text


def _is_in(one: str, value: list[Any]) -> bool:
    return any(_holds(one, part) for part in value if part[0] is not _constants.NEGATE) != (
        (_constants.NEGATE, None) in value
    )


def _holds(one: str, part: Any) -> bool:
    kind, value = part
    if kind is _constants.LITERAL:
        return ord(one) == int(value)
    if kind is _constants.RANGE:
        return bool(value[0] <= ord(one) <= value[1])
    words = {"DIGIT": r"\d", "WORD": r"\w", "SPACE": r"\s"}
    name = str(value).removeprefix("CATEGORY_")
    is_other = name.startswith("NOT_")
    return (re.match(words[name.removeprefix("NOT_")], one) is not None) != is_other


def _texts(sample: str) -> list[str]:
    """Long texts in which a match often begins, and never ends."""
    beginnings = [sample[:length] for length in range(1, len(sample) + 1)]
    texts = [(one * LENGTH)[:LENGTH] for one in beginnings]
    texts += [one + filler * LENGTH for one in ["", *beginnings] for filler in FILLERS]
    return texts


@pytest.mark.parametrize(
    ("pattern", "flags", "is_searched"), [one[1:] for one in PATTERNS], ids=[one[0] for one in PATTERNS]
)
def test_time_is_in_proportion_to_the_text(pattern: str | bytes, flags: int, is_searched: bool) -> None:
    compiled: re.Pattern[Any] = re.compile(pattern, flags)
    sample = _sample(_parser.parse(pattern, flags))[:16]
    for text in dict.fromkeys(_texts(sample)):
        given = text if isinstance(pattern, str) else text.encode("latin-1", "replace")
        taken = _taken(compiled, given, is_searched)
        if taken > LIMIT:  # a machine whose caches others use may have been slow once
            taken = min(taken, _taken(compiled, given, is_searched))
        assert taken <= LIMIT, f"{taken:.2f} s for {LENGTH:,} characters: {text[:40]!r}..."


def _taken(compiled: re.Pattern[Any], text: Any, is_searched: bool) -> float:
    begin = time.process_time()
    if is_searched:
        compiled.sub(text[:0], text)
    else:
        compiled.match(text)
        compiled.fullmatch(text)
    return time.process_time() - begin


def test_most_expressions_are_found() -> None:
    assert len(PATTERNS) >= 40
