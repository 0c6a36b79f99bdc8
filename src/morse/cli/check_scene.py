"""``morse check scene.py``: list everything in a scene script that needs a change."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.cli.messages import say
from morse.cli.scenes import resolve
from morse.core.exceptions import MorseError
from morse.core.reports.printing import echo
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
        The exit status: 1 if the script does not run, or has a mistake that ``morse run`` warns of. Old forms, which
        still work, leave it 0.

    Raises:
        CommandError: there is no such script.
    """
    resolved = resolve(words)
    options = resolved.options()
    result = _surveyed(options)
    _print(result.findings, resolved.script)
    if fix:
        _fix(result, resolved.script, options)
    say(_verdict(resolved.script.name, result.findings))
    return 0 if all(finding.is_old for finding in result.findings) else 1


def _verdict(name: str, findings: Sequence[Finding]) -> str:
    """The last line: whether the script runs, and what keeps ``morse run --strict`` from running it."""
    if any(finding.stops for finding in findings):
        return f"{name} does not run."
    warnings = sum(not finding.is_old for finding in findings)
    return f"{name} runs, with {_count(warnings, 'warning')}; not with --strict." if warnings else f"{name} runs."


def _surveyed(options: RunOptions, text: str | None = None) -> Survey:
    """The findings of the script, and those of its components when they are loaded without connections."""
    # imported on demand, because they load the builder and the simulator
    from morse.builder.legacy.check import survey
    from morse.launch.load import load
    from morse.middleware.registry import missing_modules

    result = survey(options, text)
    if result.scene is not None and not result.stops:
        try:
            with result.collecting():
                load(result.scene).close()
        except (MorseError, ValueError, OSError) as error:
            result.note_at(getattr(error, "where", None), str(error), stops=True)
        lines = result.scene.lines_of_managers()
        for manager, message in missing_modules(lines).items():
            result.note_at(lines[manager], message, stops=True)
    return result


def _print(findings: Sequence[Finding], script: Path) -> None:
    for finding in findings:
        place = f"{finding.file or script.name}:{finding.line}: " if finding.line else f"{script.name}: "
        kind = "error: " if finding.stops else "" if finding.is_old else "warning: "
        echo(f"{place}{kind}{finding.message}")
    say(f"{_counted(findings)}." if findings else "Nothing needs a change.")


def _counted(findings: Sequence[Finding]) -> str:
    errors, old = sum(finding.stops for finding in findings), sum(finding.is_old for finding in findings)
    numbers = ((errors, "error"), (len(findings) - errors - old, "warning"), (old, "line"))
    words = [_count(number, what) for number, what in numbers if number]
    if old:
        words[-1] += f" with an old form, which still {'works' if old == 1 else 'work'}"
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


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
