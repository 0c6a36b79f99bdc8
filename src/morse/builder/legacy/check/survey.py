"""Runs a script as often as it has errors: each error is noted, and its statement left out in the next run."""

from __future__ import annotations

import ast
import contextlib
import io
import logging
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from morse.builder.errors import ScriptError
from morse.builder.legacy import language
from morse.builder.legacy.check.finding import Edit, Finding, sentence
from morse.builder.legacy.check.silence import Silence
from morse.builder.legacy.check.syntax import parsed
from morse.builder.script import load_scene
from morse.system.regular_files import read_regular
from morse.system.source_text import source_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.scene import Scene
    from morse.simulation.options import RunOptions

__all__ = ["Finding", "Survey", "survey"]

_MOST_RUNS = 60
_PLACE = re.compile(r"^(?P<file>.+?):(?P<line>\d+): (?P<message>.*)$", re.DOTALL)


@dataclass(slots=True)
class Survey:
    """The result for one script.

    Attributes:
        findings: what needs a change, in the order of the lines.
        scene: the scene, or None if the script cannot be run to its end.
        text: the text of the script.
    """

    text: str
    findings: list[Finding] = field(default_factory=list)
    scene: Scene | None = None

    def note(self, finding: Finding) -> None:
        """Add a finding, once."""
        if finding not in self.findings:
            self.findings.append(finding)
            self.findings.sort(key=lambda other: (other.file, other.line))

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
    result = Survey(content)
    try:
        _valid, tree, errors = parsed(content, str(script))
    except SyntaxError as error:
        result.note(Finding(error.lineno or 0, f"{type(error).__name__}: {error.msg}", stops=True))
        return result
    for finding in errors:
        result.note(finding)
    tree = _without_python_2(tree, result)
    silence = Silence(tree)
    for _run in range(_MOST_RUNS):
        try:
            with _warnings(result, script), contextlib.redirect_stdout(io.StringIO()):
                result.scene = load_scene(options, code=compile(tree, str(script), "exec", dont_inherit=True))
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


def _without_python_2(tree: ast.Module, result: Survey) -> ast.Module:
    """Note the names of Python 2, and replace those that have another name today."""
    own = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    own |= {alias.asname or alias.name for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom))
            for alias in node.names}  # fmt: skip
    own |= {node.name for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in language.NAMES and node.id not in own:
            new = language.NAMES[node.id]
            edit = Edit(node.id, new) if new.isidentifier() else None
            mend = language.mend_of_name(node.id)
            result.note(Finding(node.lineno, f"the name '{node.id}' is not defined. {mend}", stops=True, edit=edit))
            if edit is not None:
                node.id = new
    return tree


@contextlib.contextmanager
def _warnings(result: Survey, script: Path) -> Iterator[None]:
    """Note the warnings of the builder about lines of the script, and keep them from the terminal."""
    handler = _Noting(result, script)
    logger = logging.getLogger("morse")
    handlers, propagate, logger.handlers, logger.propagate = logger.handlers, logger.propagate, [handler], False
    try:
        yield
    finally:
        logger.handlers, logger.propagate = handlers, propagate


class _Noting(logging.Handler):
    def __init__(self, result: Survey, script: Path) -> None:
        super().__init__(logging.WARNING)
        self._result = result
        self._script = script

    def emit(self, record: logging.LogRecord) -> None:
        place = _PLACE.match(record.getMessage())
        if place is None:
            return
        file = "" if Path(place["file"]) == self._script else place["file"]
        old, new = getattr(record, "edit", ("", ""))
        edit = Edit(old, new) if old else None
        self._result.note(Finding(int(place["line"]), place["message"], edit=edit, file=file))
