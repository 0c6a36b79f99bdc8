"""Runs the tests whose other side is a program that others wrote, and writes docs/compatibility.md.

``python -m tools compatibility [ARGUMENT...]``, with arguments of pytest. The tests have the mark ``peer``.
"""

from __future__ import annotations

import json
import platform
import re
import shutil
import subprocess
from collections import defaultdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "compatibility.md"
_HEAD = """# Tried with

This page lists programs of other projects, with their versions, and what the tests do with them. All of them
have their default settings. `python -m tools compatibility` runs these tests and writes this page. It does not run
programs that are not installed. The page was written with {python}, {system}.

| program | version | tests passed |
|---|---|---|
"""
_WORDS = {"passed": "", "failed": " (failed)", "skipped": " (not run)"}


#: program to what is done with it to the outcomes of its tests
_outcomes: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tell the program of each test: reports of other processes have the properties of their test, not its marks."""
    for item in items:
        mark = item.get_closest_marker("peer")
        if mark is not None:
            does = mark.kwargs.get("does") or _sentence(item.originalname)  # type: ignore[attr-defined]
            item.user_properties.append(("peer", (mark.args[0], does)))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Keep the outcome of a test: that of its call, or why there was none."""
    if report.when == "call" or (report.when == "setup" and report.outcome != "passed"):
        for name, value in report.user_properties:
            if name == "peer":
                program, does = value
                _outcomes[program][does].append(report.outcome)


def _sentence(name: str) -> str:
    return name.removeprefix("test_").replace("_", " ")


def _output(*command: str) -> str:
    if shutil.which(command[0]) is None:
        return ""
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def version_of(program: str) -> str:
    """The version of a package of this Python, of the one with ROS, of npm or of Debian; empty without it."""
    _, _, number = program.partition("==")
    if number:
        return number  # the test installs it
    try:
        return version(program)
    except PackageNotFoundError:
        pass
    question = f"from importlib.metadata import version; print(version({program!r}))"
    found = _output(str(ROOT / ".venv-ros/bin/python"), "-c", question)
    package = ROOT / ".foxglove/node_modules" / program / "package.json"
    if not found and package.is_file():
        found = json.loads(package.read_text(encoding="utf-8"))["version"]
    if not found and (ROOT / ".yarp").is_dir() and program == "yarp":
        found = re.sub(r"[^\d.]", "", _output(str(next(ROOT.glob(".yarp/**/bin/yarp"), "yarp")), "version"))
    return found or _output("dpkg-query", "-W", "-f=${Version}", program)


def page(outcomes: dict[str, dict[str, list[str]]]) -> str:
    """The text of the page."""
    text = _HEAD.format(python=f"Python {platform.python_version()}", system=_system())
    lists = []
    for program in sorted(outcomes, key=str.lower):
        done = outcomes[program]
        results = [one for each in done.values() for one in each]
        ran = [one for one in results if one != "skipped"]
        count = f"{ran.count('passed')} of {len(ran)}" if ran else "not run"
        text += f"| `{program}` | {version_of(program) or '-'} | {count} |\n"
        lines = [f"- {does}{_WORDS[_worst(each)]}\n" for does, each in sorted(done.items())]
        lists.append(f"\n## {program}\n\n{''.join(lines)}")
    return text + "".join(lists)


def _worst(each: list[str]) -> str:
    return next((one for one in ("failed", "passed") if one in each), "skipped")


def _system() -> str:
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except OSError:
        return platform.platform()


def main(arguments: list[str]) -> int:
    """Run the tests and write the page; the result is the status of pytest."""
    # as a plugin by name, which the processes of pytest-xdist load as well
    status = pytest.main(["-m", "peer", "-q", "-p", __name__, *arguments])
    if _outcomes:
        PAGE.write_text(page(_outcomes), encoding="utf-8")
        print(PAGE.relative_to(ROOT))
    return int(status)
