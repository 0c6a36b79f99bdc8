from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from playwright.sync_api import Browser

CHROMIUM = os.environ.get("MORSE_CHROMIUM", "/usr/bin/chromium")
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]

_MUST_RUN_IN_CI = ("browser", "blender")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Where CI is set, Chromium and Blender are there: a test that is skipped for want of them has failed."""
    report = yield
    marks = [mark for mark in _MUST_RUN_IN_CI if item.get_closest_marker(mark)]
    if report.skipped and marks and os.environ.get("CI") and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid}: a test marked {', '.join(marks)} must not be skipped in CI ({reason})"
    return report


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Debian's Chromium with software GL: one for all tests, Playwright allows no second."""
    from morse.viewer.site import STATIC

    missing = [str(path) for path in (Path(CHROMIUM), STATIC / "index.html") if not path.exists()]
    if missing:
        message = f"needed for the tests in a browser: {', '.join(missing)}"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()
