"""``morse check scene.py``: list everything in a scene script that needs a change."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from morse.cli.messages import say
from morse.cli.scenes import resolve
from morse.core.exceptions import MorseError
from morse.system.free_names import free_path
from morse.system.source_text import encoded_source

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from morse.builder.legacy.check import Finding, Survey
    from morse.simulation.options import RunOptions


def check_scene(words: Sequence[str], *, fix: bool) -> int:
    """Check a scene script, and print what needs a change, with its lines, and whether it runs.

    Args:
        words: as after ``morse run``.
        fix: whether to write a mended copy beside the script.

    Returns:
        The exit status: 1 if the script does not run.

    Raises:
        CommandError: there is no such script.
    """
    resolved = resolve(words)
    options = resolved.options()
    result = _surveyed(options)
    _print(result.findings, resolved.script)
    runs = not result.stops
    if fix:
        _fix(result, resolved.script, options)
    say(f"{resolved.script.name} {'runs' if runs else 'does not run'}.")
    return 0 if runs else 1


def _surveyed(options: RunOptions, text: str | None = None) -> Survey:
    """The findings of the script, and those of its components when they are loaded without connections."""
    # imported on demand, because they load the builder and the simulator
    from morse.builder.legacy.check import Finding, survey
    from morse.launch.load import load
    from morse.middleware.registry import missing_modules

    result = survey(options, text)
    if result.scene is not None and not result.stops:
        try:
            load(result.scene).close()
        except (MorseError, ValueError, OSError) as error:
            result.note(Finding(0, str(error), stops=True))
        for message in missing_modules(result.scene.managers()):
            result.note(Finding(0, message, stops=True))
    return result


def _print(findings: Sequence[Finding], script: Path) -> None:
    for finding in findings:
        place = f"{finding.file or script.name}:{finding.line}: " if finding.line else ""
        typer.echo(f"{place}{'error: ' if finding.stops else ''}{finding.message}")
    stopping = sum(finding.stops for finding in findings)
    old = len(findings) - stopping
    if findings:
        say(f"{_count(stopping, 'error')}; {_count(old, 'line')} with an old form, which still works.")
    else:
        say("Nothing needs a change.")


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _fix(result: Survey, script: Path, options: RunOptions) -> None:
    from morse.builder.legacy.check.mending import mended

    text = mended(result.text, result.findings)
    if text == result.text:
        say("Nothing can be mended automatically: no copy is written.")
        return
    copy = free_path(script.with_name(f"{script.stem}_fixed.py"))
    copy.write_bytes(encoded_source(text))
    rest = _surveyed(options, text)
    say(f"Mended copy: {copy}, which {'does not run' if rest.stops else 'runs'}.")
    if rest.findings:
        say(f"{_count(len(rest.findings), 'line')} of it {'needs' if len(rest.findings) == 1 else 'need'} a person:")
        _print(rest.findings, copy)
