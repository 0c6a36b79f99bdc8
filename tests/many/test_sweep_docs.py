"""The examples of the page about studies."""

import importlib.util
import re
from pathlib import Path

import pytest

from tests.kit.programs import python

PAGE = (Path(__file__).parents[2] / "docs" / "sweeps.md").read_text(encoding="utf-8")
STUDY, OTHERS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_the_study_runs(tmp_path):
    (tmp_path / "study.py").write_text(STUDY)
    outcome = python("study.py", folder=tmp_path)
    assert outcome.stderr == ""
    assert "<Table of 8 runs" in outcome.stdout
    # the block is 1.3 m ahead: faster robots hit it
    assert "it has hit the block" in outcome.stdout


@pytest.mark.parametrize(("function", "package"), [("optimise", "optuna"), ("log", "mlflow"), ("means", "polars")])
def test_other_packages(tmp_path, monkeypatch, function, package):
    if importlib.util.find_spec(package) is None:
        return  # an optional package, which MORSE does not install
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.py").write_text(STUDY)
    from morse.many.sources import imported

    study, functions = imported(str(tmp_path / "study.py")).study, {}
    exec(OTHERS, functions)
    if function == "optimise":
        assert 0.5 <= functions["optimise"](study, 3)["speed"] <= 2.0
    elif function == "log":
        functions["log"](study.run("results", workers=0))
    else:
        table = study.run("results", workers=0)
        means = functions["means"](table)
        assert means["runs"].sum() == len(table) - len(table.failures)
        assert means.columns == [*study.axes, "x", "runs"]
