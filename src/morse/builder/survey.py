"""Everything in a scene script that needs a change, at once, and a copy with what can be mended: ``morse check``."""

from __future__ import annotations

import ast
import contextlib
import io
import re
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from morse.builder import compatibility
from morse.builder.errors import ScriptError
from morse.builder.script import compiled, load_scene
from morse.scene.scene_warnings import scene_warnings, silent_log
from morse.system.regular_files import read_regular
from morse.system.source_text import source_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from morse.scene import Scene, SourceLine
    from morse.scene.scene_warnings import SceneWarning
    from morse.simulation.options import RunOptions


def sentence(problem: str, mend: str) -> str:
    """A problem and its mend in one line."""
    if not mend:
        return problem
    return f"{problem}{'' if problem.endswith(('.', '?', '!')) else '.'} {mend}"


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of the text of a script: within a statement, a word becomes another one.

    Attributes:
        old: the word, e.g. ``configure_mw``.
        new: the word of today.
    """

    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing in a script that needs a change.

    Attributes:
        line: its line; 0 if unknown.
        message: what is wrong, and how it is written today.
        stops: whether the script does not run because of it.
        is_old: whether it is an old form, which still works.
        edit: the change, if it can be made without a person.
        file: another file of the project; empty for the script itself.
    """

    line: int
    message: str
    stops: bool = False
    is_old: bool = False
    edit: Edit | None = None
    file: str = ""


class Silence:
    """The statements that have been left out.

    A statement that uses a name which such a statement should have set fails because of that alone.
    """

    def __init__(self, tree: ast.Module) -> None:
        self._tree = tree
        self._missing: set[str] = set()

    def leave_out(self, line: int) -> bool | None:
        """Replace the innermost statement at a line by ``pass``; of several, one that fails because of an earlier one.

        Returns:
            Whether it fails by itself, not because of an earlier one; None if there is no statement.
        """
        place = min(self._at(line), key=lambda entry: self._rank(entry[1][entry[2]]), default=None)
        if place is None:
            return None
        owner, body, index = place
        statement = body[index]
        _, by_itself = self._rank(statement)
        self._missing.update(_written(statement))
        body[index] = ast.copy_location(ast.Pass(), statement)
        ast.fix_missing_locations(owner)
        return by_itself

    def _rank(self, statement: ast.stmt) -> tuple[int, bool]:
        return _length(statement), not self._missing & set(_read(statement))

    def _at(self, line: int) -> Iterator[tuple[ast.AST, list[ast.stmt], int]]:
        for node in ast.walk(self._tree):
            for part in ("body", "orelse", "finalbody"):
                body = getattr(node, part, None)
                # the body of a lambda is an expression
                for index, statement in enumerate(body) if isinstance(body, list) else ():
                    inside = statement.lineno <= line <= (statement.end_lineno or statement.lineno)
                    if inside and not isinstance(statement, ast.Pass):
                        yield node, cast("list[ast.stmt]", body), index


def _length(statement: ast.stmt) -> int:
    return (statement.end_lineno or statement.lineno) - statement.lineno


def _read(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self":
            yield f"self.{node.attr}"


def _written(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        match node:
            case ast.Name(id=name, ctx=ast.Store()):
                yield name
            case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                yield f"self.{name}"
            case ast.alias(name=name, asname=other):
                yield other or name.partition(".")[0]
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                yield name


_MOST = 200


def parsed(text: str, name: str) -> tuple[str, ast.Module, list[Finding]]:
    """The text with valid syntax, its tree, and the errors.

    Args:
        text: the script.
        name: its name in errors.

    Raises:
        SyntaxError: the text cannot be made valid line by line.
    """
    findings: list[Finding] = []
    first: SyntaxError | None = None
    while True:
        try:
            with warnings.catch_warnings():  # of lines that are mended; the others are told when the script is compiled
                warnings.simplefilter("ignore", SyntaxWarning)
                return text, ast.parse(text, name), findings
        except (SyntaxError, ValueError) as caught:
            error = caught if isinstance(caught, SyntaxError) else SyntaxError(str(caught))
            # later ones may be the consequences of a line that was left out
            first = first or error
        lines = text.split("\n")
        number = error.lineno or 0
        if not 1 <= number <= len(lines) or len(findings) >= _MOST:
            raise first
        mend = compatibility.first("mend_of_syntax", error)
        findings.append(Finding(number, sentence(f"{type(error).__name__}: {error.msg}", mend), stops=True))
        if isinstance(error, TabError):
            text = text.expandtabs(8)
            continue
        line = lines[number - 1]
        mended = _with_colon(line, error) if error.msg == "expected ':'" else _mended_line(line)
        # a line that stays wrong is left out; its block keeps a statement
        indent = line[: len(line) - len(line.lstrip())]
        lines[number - 1] = mended if mended != line else f"{indent}pass"
        if lines[number - 1] == line:
            raise first
        text = "\n".join(lines)


def _mended_line(line: str) -> str:
    for entry in compatibility.installed():
        line = entry.mended_line(line)
    return line


def _with_colon(line: str, error: SyntaxError) -> str:
    """The line of a block with the colon that it lacks, so that the lines of the block stay one."""
    place = max((error.offset or len(line) + 1) - 1, 0)
    return f"{line[:place].rstrip()}:{line[place:]}"


def mended(text: str, findings: Sequence[Finding]) -> str:
    """The mended text; lines that nobody can mend but a person stay as they are.

    Raises:
        SyntaxError: the syntax cannot be mended line by line.
    """
    lines = _valid_where_possible(text).split("\n")
    spans = _spans("\n".join(lines))
    for finding in findings:
        if finding.edit is not None and not finding.file:
            first, last = spans.get(finding.line, (finding.line, finding.line))
            _replace(lines, finding.line, first, last, finding.edit)
    text = "\n".join(lines)
    for entry in compatibility.installed():
        text = entry.mended_text(text)
    return text


def _valid_where_possible(text: str) -> str:
    """The text with mended syntax, without the lines that ``parsed`` empties."""
    lines = (text.expandtabs(8) if _has_mixed_tabs(text) else text).split("\n")
    try:
        _, _, errors = parsed("\n".join(lines), "script")
    except SyntaxError:
        return "\n".join(lines)
    for number in {finding.line for finding in errors}:
        lines[number - 1] = _mended_line(lines[number - 1])
    return "\n".join(lines)


def _has_mixed_tabs(text: str) -> bool:
    try:
        ast.parse(text)
    except TabError:
        return True
    except (SyntaxError, ValueError):
        return False
    return False


def _spans(text: str) -> dict[int, tuple[int, int]]:
    """The first and last line of the innermost statement at each line."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return {}
    spans: dict[int, tuple[int, int]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt):
            first, last = node.lineno, node.end_lineno or node.lineno
            for line in range(first, last + 1):
                line_spans = spans.get(line)
                if line_spans is None or line_spans[1] - line_spans[0] >= last - first:
                    spans[line] = (first, last)
    return spans


def _replace(lines: list[str], line: int, first: int, last: int, edit: Edit) -> None:
    """Replace a word at a line, else at the next place in its statement."""
    if _replace_import(lines, line, edit):
        return
    # a word may be given in several spellings
    words = "|".join(re.escape(spelling) for spelling in edit.old.split("|"))
    word = re.compile(rf"(?<![\w.])(?:{words})(?!\w)" if "." in words else rf"(?<!\w)(?:{words})(?!\w)")
    for number in [*range(line, last + 1), *range(first, line)]:
        new_line = word.sub(lambda _: edit.new, lines[number - 1])
        if new_line != lines[number - 1]:
            lines[number - 1] = new_line
            return


def _replace_import(lines: list[str], line: int, edit: Edit) -> bool:
    """Replace a name in ``from module import name``; other names of the line stay."""
    module, _, name = edit.old.rpartition(".")
    match = re.match(rf"^(\s*)from\s+{re.escape(module)}\s+import\s+([\w, ]+?)\s*(#.*)?$", lines[line - 1])
    if not module or match is None:
        return False
    names = [word.strip() for word in match[2].split(",")]
    if name not in names:
        return False
    there, _, today = edit.new.rpartition(".")
    others = ", ".join(word for word in names if word != name)
    lines_after = [f"{match[1]}from {module} import {others}"] if others else []
    alias = f" as {name}" if today != name else ""
    lines[line - 1] = "\n".join([*lines_after, f"{match[1]}from {there} import {today}{alias}"])
    return True


_MOST_RUNS = 60


@dataclass(slots=True)
class Survey:
    """The result for one script.

    Attributes:
        script: the absolute path of the script.
        text: the text of the script.
        findings: what needs a change, in the order of the lines.
        scene: the scene, or None if the script cannot be run to its end.
    """

    script: Path
    text: str
    findings: list[Finding] = field(default_factory=list)
    scene: Scene | None = None

    def note(self, finding: Finding) -> None:
        """Add a finding, once."""
        if finding not in self.findings:
            self.findings.append(finding)
            self.findings.sort(key=lambda other: (other.file, other.line))

    def note_at(self, where: SourceLine | None, message: str, **qualities: Any) -> None:
        """Add a finding with a line of the scene.

        Args:
            qualities: see `Finding`.
        """
        own = where is None or Path(where.file) == self.script
        file = "" if own or where is None else where.file
        self.note(Finding(0 if where is None else where.line, message, file=file, **qualities))

    @contextlib.contextmanager
    def collecting(self) -> Iterator[None]:
        """Within the block, note the warnings about the scene, and keep the log from the terminal."""
        with silent_log(), scene_warnings() as collected:
            try:
                yield
            finally:
                self._note_all(collected.warnings)

    def _note_all(self, warnings: Iterable[SceneWarning]) -> None:
        for warning in warnings:
            edit = Edit(*warning.edit) if warning.edit[0] else None
            self.note_at(warning.where, warning.message, is_old=warning.is_old, edit=edit)

    @property
    def stops(self) -> bool:
        """Whether something keeps the script from running."""
        return any(finding.stops for finding in self.findings)


def survey(options: RunOptions, text: str | None = None) -> Survey:
    """Find everything in a scene script that needs a change. The script is executed; what it prints is left out.

    Args:
        options: the script, and the folders of its project.
        text: another text for the script.
    """
    script = Path(options.script).absolute()
    content = _text_of(script) if text is None else text
    result = Survey(script, content)
    try:
        _valid, tree, errors = parsed(content, str(script))
    except SyntaxError as error:
        result.note(Finding(error.lineno or 0, f"{type(error).__name__}: {error.msg}", stops=True))
        return result
    for finding in errors:
        result.note(finding)
    if not errors:
        with result.collecting():
            compiled(content, str(script))
    tree = _without_old_names(tree, result)
    silence = Silence(tree)
    for _run in range(_MOST_RUNS):
        try:
            with result.collecting(), contextlib.redirect_stdout(io.StringIO()):
                with warnings.catch_warnings():  # they are noted already
                    warnings.simplefilter("ignore", SyntaxWarning)
                    code = compile(tree, str(script), "exec", dont_inherit=True)
                result.scene = load_scene(options, code=code)
            break
        except ScriptError as error:
            if not _leave_out(error, script, silence, result):
                break
    return result


def _text_of(script: Path) -> str:
    """The text of a script; Python 2 accepted bytes of any encoding, which was mostly this one."""
    source = read_regular(script)
    try:
        text = source_text(source)
    except SyntaxError:
        text = source.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _leave_out(error: ScriptError, script: Path, silence: Silence, result: Survey) -> bool:
    """Note an error, and leave out its statement; False if there is none in the script."""
    message = sentence(error.message, error.mend)
    lines = [step.where.line for step in error.steps if Path(step.where.file) == script]
    if not lines:
        where = error.where
        # a scene without an environment may be the consequence of other errors
        if not (where is None and result.stops):
            result.note(Finding(where.line if where else 0, message, stops=True, file=where.file if where else ""))
        return False
    by_itself = silence.leave_out(lines[-1])
    if by_itself is None:
        result.note(Finding(lines[-1], message, stops=True))
        return False
    if by_itself:
        result.note(Finding(lines[-1], message, stops=True))
    return True


def _without_old_names(tree: ast.Module, result: Survey) -> ast.Module:
    """Note the names of earlier languages, and replace those that have another name today."""
    own = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    own |= {alias.asname or alias.name for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom))
            for alias in node.names}  # fmt: skip
    own |= {node.name for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Name) or node.id in own:
            continue
        if new := compatibility.first("name_of_today", node.id):
            edit = Edit(node.id, new) if new.isidentifier() else None
            mend = compatibility.first("mend_of_name", node.id)
            result.note(Finding(node.lineno, f"the name '{node.id}' is not defined. {mend}", stops=True, edit=edit))
            if edit is not None:
                node.id = new
    return tree
