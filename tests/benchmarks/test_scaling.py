"""The speed of N workers, from the costs of the processes."""

import pytest

pytest.importorskip("gymnasium")


from benchmarks.programs.scaling import Costs, lines


def test_workers_that_cost_nothing_else_are_as_fast_as_they_are_many():
    for line in lines(Costs(row=1e-9, run=0.0, work=1.0, step=0.0, worker=0.0)).values():
        assert all(speed == pytest.approx(count) for count, speed in line)


def test_the_driver_limits_sweeps_and_the_messages_limit_vectors():
    curves = lines(Costs(row=1e-3, run=0.0, work=0.9, step=0.09, worker=0.01))
    assert dict(curves["runs of 0.05 s"])[1000.0] == pytest.approx(0.05 / 1e-3)
    assert dict(curves["runs of 1 s"])[512.0] == pytest.approx(512.0)
    # a step of N workers takes 0.99 + 0.01 N
    (vector,) = (line for name, line in curves.items() if name.startswith("vector"))
    assert dict(vector)[64.0] == pytest.approx(64.0 / 1.63)
