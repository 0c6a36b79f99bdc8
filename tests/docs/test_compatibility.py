"""The table of programs that others wrote."""

import re
from pathlib import Path

from tools import compatibility

ROOT = Path(__file__).parents[2]
MARK = re.compile(r'mark\.peer\(\s*"([^"]+)"')


def test_the_page_has_the_programs_of_the_tests() -> None:
    programs = {name for path in (ROOT / "tests").rglob("test_*.py") for name in MARK.findall(path.read_text())}
    assert programs == set(re.findall(r"^\| `([^`]+)` \|", compatibility.PAGE.read_text(), re.MULTILINE)), (
        "python -m tools compatibility"
    )


def test_failures_and_what_was_not_run_are_told() -> None:
    outcomes = {
        "mcap": {"reads a recording": ["passed", "passed"], "reads an index": ["passed", "failed"]},
        "no-such-program": {"drives": ["skipped"]},
    }
    text = compatibility.page(outcomes)
    version = compatibility.version_of("mcap")
    assert re.fullmatch(r"[\d.]+", version)
    assert f"| `mcap` | {version} | 3 of 4 |" in text
    assert "- reads a recording\n- reads an index (failed)\n" in text
    assert "| `no-such-program` | - | not run |" in text
    assert "- drives (not run)" in text
