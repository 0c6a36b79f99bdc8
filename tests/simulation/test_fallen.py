"""Robots that fall below the world are named once."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    import pytest

    from morse.simulation.simulation import Simulation

    Load = Callable[..., Simulation]


def falls(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [line for line in caplog.messages if " falls: " in line]


def test_a_robot_beyond_the_edge_of_the_floor_is_named_once(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    # the floor of 'empty' ends at 20 m (spec: a slab of 40 m x 40 m)
    simulation = load(
        """
        on, off = ATRV(), ATRV()
        on.translate(19, 0, 0.1)
        off.translate(21, 0, 0.1)
        env = Environment("empty", fastmode=True)
        """,
        sockets=False,
    )
    simulation.step(120)
    (line,) = falls(caplog)
    assert line.startswith("off falls: it is at z = -")
    assert "below the floor of 'empty'" in line
    simulation.restart()
    simulation.step(120)
    assert len(falls(caplog)) == 2


def test_a_fall_onto_the_floor_is_not_reported(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    simulation = load(
        """
        robot = ATRV()
        robot.translate(0, 0, 30)
        env = Environment("empty", fastmode=True)
        """,
        sockets=False,
    )
    simulation.step(180)
    assert falls(caplog) == []
