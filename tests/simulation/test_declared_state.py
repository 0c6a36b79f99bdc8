"""The state of the components of MORSE is what they declare."""

from collections.abc import Iterator
from typing import Any

import pytest
import state_of_components as components

from morse.core.declarations import add_state, properties, state_variables
from morse.core.exceptions import MorseDeclarationError
from morse.core.state import StateError
from morse.core.state.attributes import is_state, replace, state_of
from morse.simulation.states.state import State

#: attributes that change and follow from the rest: images that are under way, caches, what was drawn last
_FOLLOWS = frozenset(
    {"group", "request", "requests", "rays", "noted", "on_completion", "input_functions", "output_functions"}
    | {"_taken_from", "_lens_of", "_table", "_shown", "_drawn", "_clamped", "_usual", "_told", "_values_at_first"}
    | {
        "_measured_from",
        "_hull",
        "_complaints",
        "_targets",
        "_looks",
        "_reach",
        "_arc",
        "_plane",
        "_command_limit",
        "_known_steps",
        "_has_steps",
    }
)


def parts(simulation: Any) -> Iterator[Any]:
    """Robots, sensors, actuators, overlays and modifiers."""
    context = simulation.context
    yield from (*context.robots.values(), *context.components.values(), *context.overlays.values())
    yield from simulation.loaded.modifier_objects


def constants(part: Any) -> dict[str, str]:
    """The attributes of a part that are not part of its state, as text."""
    without = _FOLLOWS | {"_is_read"}  # who has looked changes nothing
    values = {name: value for name, value in vars(part).items() if not is_state(type(part), name)}
    values = {name: value for name, value in values.items() if name not in without}
    return {
        name: repr(value) for name, value in values.items() if isinstance(value, (bool, int, float, str, tuple, list))
    }


@pytest.mark.parametrize("name", [*components.names()[::9], "IMU", "Waypoint", "PTU", "WheelEncoders"])
def test_what_changes_is_declared(name: str) -> None:
    check_what_changes(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", components.names())
def test_what_changes_in_any_component_is_declared(name: str) -> None:
    check_what_changes(name)


def check_what_changes(name: str) -> None:
    """Check that attributes which are not declared keep their values, and that declared ones have their types."""
    simulation, _carrier = components.load(name)
    with simulation:
        before = [constants(part) for part in parts(simulation)]
        components.go(simulation, name, 20)
        assert [constants(part) for part in parts(simulation)] == before
        for part in parts(simulation):
            declared = state_variables(type(part))
            for attribute, value in state_of(part).items():
                assert attribute in declared or attribute in properties(type(part)), (type(part), attribute)
                assert attribute not in declared or declared[attribute].accepts(value), (attribute, value)


class Ours:
    """Stands for a class of MORSE."""

    __module__ = "morse.sensors.ours"
    add_state("_count", int, "Number of measurements")
    add_state("_last", float | None, "Last value", unit="m")

    def __init__(self) -> None:
        self._count, self._last = 0, None
        self._table = [1, 2, 3]


class Users(Ours):
    """A class of a user, derived from it."""

    not_state = ("_plot",)

    def __init__(self) -> None:
        super().__init__()
        self._memory = {"seen": 1}
        self._plot = object()


def test_the_code_of_classes_is_read_for_classes_of_users_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(cls: type) -> frozenset[str]:
        raise AssertionError(f"the code of {cls} is read")

    monkeypatch.setattr("morse.core.state.attributes.assigned_by", refused)
    for name in ("Waypoint", "IMU", "VideoCamera", "PTU"):
        simulation, _carrier = components.load(name)
        with simulation:
            components.go(simulation, name, 7)
            state = State.from_bytes(simulation.save().to_bytes())
            simulation.step(5)
            wanted = simulation.state_hash()
            simulation.restore(state)
            simulation.step(5)
            assert simulation.state_hash() == wanted
    with pytest.raises(AssertionError, match="the code of"):
        state_of(type("Later", (Ours,), {"__module__": "lab"})())


def test_what_somebody_else_has_put_on_an_object_of_morse_is_no_state() -> None:
    part = Ours()
    part.note = 3  # type: ignore[attr-defined]
    vars(part)["_hidden"] = 4
    assert state_of(part) == {"_count": 0, "_last": None}
    with pytest.raises(StateError, match="not part of a saved state"):
        replace(part, (), {"note": 5})


def test_a_class_of_morse_saves_what_it_declares_and_a_class_of_a_user_everything() -> None:
    assert state_of(Ours()) == {"_count": 0, "_last": None}
    assert state_of(Users()) == {"_count": 0, "_last": None, "_memory": {"seen": 1}}


@pytest.mark.parametrize("wrong", [{"_count": "many"}, {"_last": [1.0]}, {"_table": [4]}])
def test_a_state_with_another_type_or_an_attribute_that_is_not_declared_is_refused(wrong: dict[str, object]) -> None:
    ours = Ours()
    with pytest.raises(StateError, match=next(iter(wrong))):
        replace(ours, (), wrong)
    assert ours._table == [1, 2, 3]
    assert (ours._count, ours._last) == (0, None)


@pytest.mark.parametrize(("type", "unit", "text"), [("float", "", "class"), (float, "furlong", "furlong")])
def test_a_declaration_that_means_nothing_is_refused(type: Any, unit: str, text: str) -> None:
    with pytest.raises(MorseDeclarationError, match=text):

        class Wrong:
            add_state("_x", type, "anything", unit=unit)
