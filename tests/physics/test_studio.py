"""MuJoCo's own viewer is an extra."""

import sys

import pytest
from worlds import ground, world

from morse.physics.studio import Studio, StudioMissingError


def test_without_the_extra_the_line_to_install_it_is_given(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco.studio", None)
    with pytest.raises(StudioMissingError, match=r'pip install "mujoco-studio>=4.0,<4.1"'):
        Studio(world(ground()), "127.0.0.1")
