"""The contract that every component follows, and its check.

The command ``morse check component`` prints the results. Tests of MORSE and of users call it::

    from morse.verification.contract import check_component

    def test_the_sonar_keeps_the_contract():
        for report in check_component("src/my_sim/sensors/sonar.py"):
            assert report.passed, report

The rules are in `morse.verification.contract.check`.
"""

from morse.verification.contract.check import check_component
from morse.verification.contract.subjects import Fault, Report, SubjectError

__all__ = ["Fault", "Report", "SubjectError", "check_component"]
