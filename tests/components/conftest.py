from __future__ import annotations

import pytest
from rig import Rig


@pytest.fixture
def rig(tmp_path):
    made = []

    def make(script):
        made.append(Rig(script, tmp_path))
        return made[-1]

    yield make
    for one in made:
        one.simulation.close()
