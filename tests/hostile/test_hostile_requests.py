"""A request may name any number of things: what it costs is limited."""

import itertools
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW
from morse.middleware.foxglove import parameters as of_foxglove
from morse.middleware.foxglove.client import FoxgloveClient
from morse.middleware.ros2 import parameters as of_ros2
from morse.middleware.rosbridge.client import Parts, Puzzle, parse
from morse.simulation.simulation import Simulation

MANY = 20_000


def scene() -> None:
    robot = ATRV("robot")
    robot.append(MotionVW("motion"))
    Environment("empty")


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with morse.load(scene) as loaded:
        yield loaded


def foxglove(simulation: Any) -> tuple[of_foxglove.Parameters, list[Any]]:
    changes: list[Any] = []
    context = simulation.context
    return of_foxglove.Parameters(context, lambda: ["robot.motion"], lambda *words: changes.append(words)), changes


def test_foxglove_answers_a_name_once(simulation: Any) -> None:
    parameters, _ = foxglove(simulation)
    names = ["robot.motion.ControlType", "nothing"] * MANY
    assert [one["name"] for one in parameters.read(names)] == ["robot.motion.ControlType"]


def test_foxglove_explains_and_changes_a_few_parameters(simulation: Any) -> None:
    parameters, changes = foxglove(simulation)
    names, refusals = parameters.write({"name": f"robot.motion.p{number}", "value": 1} for number in range(MANY))
    assert names == []
    assert len(refusals) < 20
    assert "more than" in refusals[-1]
    same = {"name": "robot.motion.ControlType", "value": "Velocity"}
    parameters.write(itertools.repeat(same, MANY))
    assert len(changes) == of_foxglove.MOST


def test_ros_2_changes_a_few_parameters(simulation: Any) -> None:
    calls: list[Any] = []
    handlers: dict[str, Any] = {}
    backend: Any = SimpleNamespace(service=lambda name, kind: handlers.setdefault(kind.rpartition("/")[2], object()))
    parameters = of_ros2.Parameters(
        simulation.context, backend, lambda: ["robot.motion"], lambda *words: calls.append(words)
    )
    given = {"name": "robot.motion.ControlType", "value": {"type": 4, "string_value": "Velocity"}}
    answers: list[Any] = []
    parameters._set({"parameters": [given] * MANY}, answers.append)
    assert len(answers[0]["results"]) == MANY
    assert len(calls) == of_ros2.MOST
    assert "up to" in answers[0]["results"][-1]["reason"]
    parameters._set_together({"parameters": [given] * MANY}, answers.append)
    assert not answers[1]["result"]["successful"]
    assert len(calls) == of_ros2.MOST
    parameters._get({"names": ["robot.motion.ControlType", "x"] * MANY}, answers.append)
    assert [value["type"] for value in answers[2]["values"]] == [4, 0] * MANY


def test_watched_names_are_charged_and_released() -> None:
    left = 500
    client = FoxgloveClient.__new__(FoxgloveClient)
    client.watched, client._watched_values = frozenset(), {}

    def keep(count: int, what: str) -> None:
        nonlocal left
        if not left:
            raise ValueError(what)
        left -= 1

    def release(count: int) -> None:
        nonlocal left
        left += 1

    client.keep, client.release = keep, release  # type: ignore[method-assign]
    message = {"parameterNames": [f"p{number}" for number in range(MANY)]}
    with pytest.raises(ValueError, match="a watched parameter"):
        client._watch_more(message)
    assert (len(client.watched), left) == (500, 0)
    client._watch_less(message)
    assert (len(client.watched), left) == (0, 500)


def test_parts_are_made_one_by_one_and_put_together_again() -> None:
    text = '{"op":"publish","topic":"/a","msg":{"data":"' + "\u2028ä\U0001f600" * 3000 + '"}}'
    parts = Parts(text, 1.0)
    assert len(parts) == len(text)
    assert next(iter(parts)).startswith('{"op":"fragment"')
    puzzle = Puzzle()
    *some, last = [puzzle.add(parse(part)) for part in parts]
    assert set(some) == {None}
    assert last == text
    assert list(Parts("short", 1e308)) == ["short"]
