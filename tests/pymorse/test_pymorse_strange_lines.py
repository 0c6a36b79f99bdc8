"""A client that is connected to a stream, where a server of services is expected."""

import logging

import pytest
from scripted_simulation import ScriptedSimulation

import pymorse


def test_lines_that_are_no_answers_are_reported_once(
    simulation: ScriptedSimulation, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.ERROR, "pymorse")
    with pymorse.Morse("127.0.0.1", simulation.port) as simu:
        for _ in range(20):
            simulation.rpc.send(b'{"x": 1.0}\n')
        # an answer that is sent after these lines
        assert simu.rpc("simulation", "list_robots") == ["robot1"]
    assert caplog.text.count("is not an answer") == 1
