"""Every component of MORSE is saved and restored to the bit, and nothing of it cannot be saved."""

from __future__ import annotations

import inspect

import pytest

import morse
import morse.builder
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.components.robot import Robot
from morse.builder.errors import ScriptError
from morse.core.actuator import Actuator
from morse.core.sensor import Sensor
from morse.simulation.loader import LoadError

COMPONENTS = sorted(
    name
    for name in morse.builder.__all__
    if inspect.isclass(found := getattr(morse.builder, name))
    and issubclass(found, (AbstractComponent, Sensor, Actuator))
    and not issubclass(found, Robot)
)


@pytest.mark.parametrize("name", COMPONENTS)
def test_a_component_goes_on_as_if_nothing_had_happened(name: str) -> None:
    def scene() -> None:
        robot = morse.builder.ATRV("robot")
        try:
            part = getattr(morse.builder, name)("part")
            robot.append(part)
        except Exception as error:
            pytest.skip(f"it needs more than a name: {error}")
        morse.builder.Environment("empty", fastmode=True)

    try:
        first = morse.load(scene, seed=1)
    except (LoadError, ScriptError) as error:
        pytest.skip(f"it needs another robot or world: {error}")
    with first, morse.load(scene, seed=1) as second:
        first.step(7)
        state = first.save()
        assert state.unsaved == ()
        second.restore(type(state).from_bytes(state.to_bytes()))
        assert second.state_hash() == state.hash()
        for each in (first, second):
            each.step(13)
        assert first.state_hash() == second.state_hash()
