from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator

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
