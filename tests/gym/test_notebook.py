"""The notebook from a scene to a policy and a sweep runs, cell by cell."""

import numpy as np
import pytest

from tests.kit.notebooks import run_cells


@pytest.mark.long
def test_the_notebook_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    values, _ = run_cells("many_simulations.ipynb")
    # the ATRV touches the wall if it drives more than 4 m in 3 s
    assert values["picture"].shape == (300, 480, 3)
    assert not values["touched"][:5].any()
    assert values["touched"][-5:].all()
    assert np.mean(values["curve"][-2:]) > values["curve"][0] + 10.0
    table = values["table"]
    assert len(table) == 12
    assert min(value for value in table["left"] if value is not None) < 0.2
    assert "<svg" in (tmp_path / "results" / "summary.html").read_text()
