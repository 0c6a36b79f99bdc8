"""The example of the page about falsification."""

import re
from pathlib import Path

import pytest

from tests.kit.programs import python

PAGE = (Path(__file__).parents[3] / "docs" / "falsify.md").read_text(encoding="utf-8")

pytestmark = pytest.mark.long


def test_the_example_fails_where_it_stops_too_late(tmp_path):
    script, _program = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "crossing.py").write_text(script)
    words = ("falsify", "crossing.py", "-o", "results", "--runs", "120", "--workers", "2")
    done = python("-m", "morse", *words, folder=tmp_path)
    assert done.returncode == 3, done.stdout + done.stderr
    found = re.search(r"nearest > 0.3: fails with speed=([\d.]+), reaction=([\d.]+), height=1", done.stdout)
    # it sees the block at 1.5 m, and drives on for the reaction, and up to 0.2 s until it is told to stop
    speed, reaction = map(float, found.groups())
    assert speed * (reaction + 0.3) > 1.5 - 0.3 - 0.2 * speed
    assert "it does not drive on: fails" not in done.stdout
    files = {path.name for path in (tmp_path / "results").iterdir()}
    assert {"report.html", "test_crossing.py", "recordings", "junit.xml", "runs.csv", "rows.jsonl"} <= files
