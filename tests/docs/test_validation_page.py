"""The page of the validation is true: everything is measured again."""

import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
ROWS = re.compile(r"^\| (.+) \| (.+) \| (\S+) \| (\S+) \| (\S+) \| (.+) \|$", re.MULTILINE)

pytestmark = pytest.mark.long


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    pytest.importorskip("cv2")
    monkeypatch.setattr(sys, "path", [str(ROOT / "tools" / "validation"), *sys.path])
    import page

    return page


@pytest.mark.parametrize("title", ["Mechanics", "Linkages and arms", "Sensors", "Cameras", "People", "The engine"])
def test_figures_are_within_their_tolerances_and_on_the_page(page: Any, title: str) -> None:
    figures = list(dict(page.CHAPTERS)[title].figures())
    wrong = [f"{f.model}: {f.quantity}: {f.measured}, expected {f.expected}" for f in figures if not f.is_right]
    assert wrong == []
    text = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
    chapter = text.split(f"## {title}\n")[1].split("\n## ")[0]
    written = {
        row[:2]: row[2:]
        for row in ROWS.findall(chapter)
        if not row[2].startswith(("-", "expected")) or row[2][1:2].isdigit()
    }
    assert set(written) == {(f.model, f.quantity) for f in figures}, "run: python -m tools validation"
    for figure in figures:
        expected, measured, tolerance, source = written[figure.model, figure.quantity]
        assert float(expected) == pytest.approx(figure.expected, rel=1e-5, abs=1e-9)
        assert float(tolerance) == pytest.approx(figure.tolerance, rel=1e-4)
        assert abs(float(measured) - figure.expected) <= figure.tolerance * 1.01
        assert source == figure.source
