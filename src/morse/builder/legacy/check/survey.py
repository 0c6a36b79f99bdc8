"""Runs a script as often as it has errors: each error is noted, and its statement left out in the next run."""

from __future__ import annotations

import ast
import contextlib
import io
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.builder.errors import ScriptError
from morse.builder.legacy import language
from morse.builder.legacy.check.finding import Edit, Finding, sentence
from morse.builder.legacy.check.silence import Silence
from morse.builder.legacy.check.syntax import parsed
from morse.builder.script import compiled, load_scene
from morse.scene.scene_warnings import scene_warnings, silent_log
from morse.system.regular_files import read_regular
from morse.system.source_text import source_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.scene import Scene, SourceLine
    from morse.scene.scene_warnings import SceneWarning
    from morse.simulation.options import RunOptions

__all__ = ["Finding", "Survey", "survey"]

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
    tree = _without_python_2(tree, result)
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
