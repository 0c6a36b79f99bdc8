"""All senses satisfy the contract of components."""

from pathlib import Path

import pytest

from morse.verification.contract import check_component

pytestmark = pytest.mark.long
FOLDER = Path(__file__).parents[3] / "src" / "morse" / "plugins" / "senses" / "sensors"


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("[a-z]*.py")))
def test_a_sense_satisfies_the_contract(name):
    reports = check_component(FOLDER / f"{name}.py")
    assert reports
    for report in reports:
        assert report.passed, str(report)
