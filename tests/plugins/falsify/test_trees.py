"""Behaviour trees of py_trees as the function of a scenario."""

import pytest

import morse
from morse.many import Scenario, uniform
from morse.plugins.falsify.expressions import RequirementError
from morse.plugins.falsify.trees import behaviour_tree
from tests.plugins.falsify.test_openscenario import scene

py_trees = pytest.importorskip("py_trees")
pytestmark = pytest.mark.long


class _Drive(py_trees.behaviour.Behaviour):
    """Drives until x is reached, and fails beyond 5 m."""

    def __init__(self, sim, name, goal, speed):
        super().__init__(name)
        self._robot, self._goal, self._speed = sim.car, goal, speed

    def update(self):
        x = self._robot.pose.data["x"]
        if x > 5.0:
            return py_trees.common.Status.FAILURE
        self._robot.motion.publish({"v": self._speed if x < self._goal else 0.0})
        return py_trees.common.Status.SUCCESS if x >= self._goal else py_trees.common.Status.RUNNING


def courses(sim, speed=1.0, goal=1.0):
    root = py_trees.composites.Sequence("there and on", memory=True)
    root.add_children([_Drive(sim, "first", goal, speed), _Drive(sim, "second", 2.0 * goal, speed)])
    return root


def test_a_tree_is_ticked_until_it_succeeds_or_fails():
    run = behaviour_tree(courses, period=0.1)
    with morse.load(scene) as sim:
        assert run(sim) == {"tree": "success", "tip": "second"}
        # 2 m at 1 m/s, in periods of 0.1 s
        assert sim.time() == pytest.approx(2.0, abs=0.25)
    with morse.load(scene) as sim:
        assert run(sim, speed=4.0, goal=2.6) == {"tree": "failure", "tip": "second"}
    with morse.load(scene) as sim:
        assert behaviour_tree(courses, longest=1.0)(sim)["tree"] == "running"
        assert sim.time() == pytest.approx(1.0, abs=0.11)


def test_its_parameters_are_those_of_a_search(tmp_path):
    scenario = Scenario(scene, behaviour_tree(courses), speed=uniform(0.5, 5.0), goal=uniform(0.5, 2.4))
    scenario.always(_succeeds)
    found = scenario.falsify(tmp_path / "r", runs=80, workers=0)
    smallest = found.smallest.parameters
    # it passes 5 m in one period of 0.1 s if it is fast and its goal near
    assert 2.0 * smallest["goal"] + 0.1 * smallest["speed"] >= 4.9


def _succeeds(results):
    return results["tree"] == "success"


def test_mistakes_are_named():
    with pytest.raises(ValueError, match="period is a time in seconds"):
        behaviour_tree(courses, period=0.0)
    with pytest.raises(ValueError, match="longest is a time"):
        behaviour_tree(courses, longest=float("inf"))
    with morse.load(scene) as sim, pytest.raises(RequirementError, match="expected a py_trees behaviour"):
        behaviour_tree(lambda sim: 3)(sim)
