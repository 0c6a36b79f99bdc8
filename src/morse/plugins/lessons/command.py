"""``morse lesson``: list, start, show and check lessons, and make a table for a class."""

from __future__ import annotations

import csv
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from morse.core.exceptions import MorseError
from morse.core.reports.printing import echo, harmless_paragraph
from morse.core.reports.quoting import nearest, spreadsheet_cell
from morse.plugins.lessons.attempt import Attempt
from morse.plugins.lessons.catalog import PROGRAM, Lesson, LessonError, lesson, lessons
from morse.plugins.lessons.examining import Result, examine

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_ACTIONS = ("start", "show", "check", "task")
_TABLE = "lessons.csv"


def command(
    action: Annotated[
        str | None, typer.Argument(help="start, show, check or task; without it, all lessons.", show_default=False)
    ] = None,
    name: Annotated[str | None, typer.Argument(help="Name of the lesson.", show_default=False)] = None,
    folder: Annotated[
        Path | None,
        typer.Option("--folder", metavar="FOLDER", help="Folder of the program; by default the name of the lesson."),
    ] = None,
    results: Annotated[
        Path | None,
        typer.Option("--class", metavar="FOLDER", help="Check all lessons of a class: a folder for each student."),
    ] = None,
    record: Annotated[Path | None, typer.Option("--record", metavar="FILE", help="With show: record the run.")] = None,
) -> int:
    """List the lessons, start one, show the robot with your program, or check the program.

    `morse lesson start line` writes the folder `line` with the task, the scene and a program to complete. `morse lesson
    check line` says what is right and what is missing; its status is 0 if all is right. With --class, a table of all
    students and lessons is printed and written to `lessons.csv`.
    """
    if results is not None:
        return _check_class(results)
    if action is None:
        return _list()
    if action not in _ACTIONS:
        known = action in lessons()[0]
        hint = f": do you mean `morse lesson start {action}`?" if known else f", expected {', '.join(_ACTIONS)}"
        raise LessonError(f"there is no action '{action}'{hint}")
    if name is None:
        raise LessonError(f"which lesson? `morse lesson {action} NAME`; `morse lesson` lists them all")
    chosen = lesson(name.rstrip("/"))
    place = folder if folder is not None else Path(chosen.name)
    if action == "start":
        chosen.write(place)
        echo(f"* {chosen.title}: {place / 'README.md'} says what to do, {place / PROGRAM} is yours.")
        return 0
    if action == "task":
        echo(f"{chosen.title}\n\n{chosen.task}")
        return 0
    if not (place / PROGRAM).is_file():
        raise LessonError(f"there is no file {place / PROGRAM}: `morse lesson start {chosen.name}` writes it")
    return _show(chosen, place, record) if action == "show" else _report(examine(chosen, place))


def _list() -> int:
    found, wrong = lessons()
    width = max((len(name) for name in found), default=0)
    for name, each in found.items():
        begun = "  (begun here)" if (Path(name) / PROGRAM).is_file() else ""
        echo(f"{name:<{width}}  {harmless_paragraph(each.title)}{begun}")
    for reason in wrong:
        echo(f"* Warning: {harmless_paragraph(reason)}", err=True)
    echo("\n`morse lesson start NAME` begins one, in a folder of its name.")
    return 1 if wrong else 0


def _report(result: Result) -> int:
    _print(result)
    return 0 if result.is_passed else 1


def _print(result: Result) -> None:
    for finding in result.findings:
        echo(f"[{'right' if finding.is_right else 'WRONG'}] {harmless_paragraph(finding.what)}")
        if finding.hint:
            echo(f"        {harmless_paragraph(finding.hint)}")
    right = sum(finding.is_right for finding in result.findings)
    echo(f"* {right} of {len(result.findings)} points." + (" Passed." if result.is_passed else ""))


def _show(chosen: Lesson, place: Path, record: Path | None) -> int:
    attempt = Attempt(chosen, place.absolute(), is_shown=True, record=record)
    status, run = 1, attempt.run
    try:
        while True:
            run(lambda: _print(Result(tuple(attempt.findings))))
            if attempt.is_outdated:
                echo(f"* {place / PROGRAM} has been saved: the check begins again.")
            else:
                status = _report(Result(tuple(attempt.findings)))
                echo(f"* Save {place / PROGRAM}, and it is checked again. Ctrl+C ends the view.")
            if not attempt.wait_for_change():
                break
            run = attempt.again
    except KeyboardInterrupt:
        return 130
    finally:
        attempt.close()
    return status


def _left_out(student: Path, found: Mapping[str, Lesson]) -> Iterator[str]:
    """What is in the folder of a student and is not checked, because it is not where it is looked for."""
    folders = sorted(path for path in student.glob("*") if path.is_dir() and not path.name.startswith((".", "_")))
    for folder in folders:
        name, program = folder.name, folder / PROGRAM
        if name in found and not program.is_file():
            yield f"there is no file {program}"
        elif name not in found and program.is_file():
            yield f"{program}: there is no lesson '{name}'{nearest(name, found)}"
    if not any((folder / PROGRAM).is_file() for folder in folders):
        elsewhere = next((path for path in sorted(student.rglob(PROGRAM)) if path.is_file()), None)
        there = f", but there is {elsewhere}" if elsewhere is not None else ""
        yield f"{student} has no program: expected {student / 'LESSON' / PROGRAM}{there}"


def _check_class(results: Path) -> int:
    """A table of the points of all students, who have a folder each."""
    if not results.is_dir():
        raise LessonError(f"there is no folder {results}")
    found, wrong = lessons()
    for reason in wrong:
        echo(f"* Warning: {harmless_paragraph(reason)}", err=True)
    students = sorted(path for path in results.iterdir() if path.is_dir() and not path.name.startswith("."))
    tasks = [
        (student.name, each)
        for student in students
        for each in found.values()
        if (student / each.name / PROGRAM).is_file()
    ]
    if not tasks:
        raise LessonError(
            f"{results} has no program: expected STUDENT/LESSON/{PROGRAM}, for instance anna/line/{PROGRAM}"
        )
    for student in students:
        for text in _left_out(student, found):
            echo(harmless_paragraph(f"* Warning: {text}"), err=True)
    used = [each.name for each in found.values() if any(task[1] is each for task in tasks)]

    def points(task: tuple[str, Lesson]) -> str:
        student, each = task
        result = examine(each, results / student / each.name, is_quiet=True)
        right = sum(finding.is_right for finding in result.findings)
        # of a check that was cut short, the number of points is not known
        text = f"{right}/{len(result.findings)}" if result.is_complete else "error"
        # what has cut a check short comes last
        findings = result.findings if result.is_complete else reversed(result.findings)
        wrong = next((finding for finding in findings if not finding.is_right), None)
        reason = ""
        if wrong is not None:
            reason = f": {wrong.hint}" if not result.is_complete else f"; wrong: {wrong.what} {wrong.hint}".rstrip()
        echo(harmless_paragraph(f"* {student}, {each.name}: {text}{reason}"), err=True)
        return text

    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        marks = dict(zip([(student, each.name) for student, each in tasks], pool.map(points, tasks), strict=True))
    rows = [["student", *used], *([s.name, *(marks.get((s.name, name), "–") for name in used)] for s in students)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        echo("  ".join(harmless_paragraph(cell).ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    try:
        with (results / _TABLE).open("w", newline="", encoding="utf-8", errors="backslashreplace") as file:
            # a spreadsheet takes 3/4 for a date; no name of a folder has a slash
            cells = [[spreadsheet_cell(cell.replace("/", " of ")) for cell in row] for row in rows]
            csv.writer(file).writerows(cells)
    except OSError as error:
        raise MorseError(f"{results / _TABLE} cannot be written: {error.strerror or error}") from None
    return 0
