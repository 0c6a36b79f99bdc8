from __future__ import annotations

import pytest
from rig import Rig

from morse.core import context


@pytest.fixture
def rig(tmp_path):
    yield lambda script: Rig(script, tmp_path)
    context.set_current(None)
