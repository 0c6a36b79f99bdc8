"""Behaviour trees of py_trees as the function of a scenario."""

from __future__ import annotations

import inspect
import math
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import quoted
from morse.plugins.falsify.expressions import RequirementError
from morse.system.extras import install

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse import Simulation

#: simulated time after which a tree ends that neither succeeds nor fails, s
_LONGEST = 3600.0


def behaviour_tree(build: Callable[..., Any], period: float = 0.1, longest: float = _LONGEST) -> Callable[..., Any]:
    """Return the function of a scenario that ticks a tree of py_trees until it succeeds or fails.

    Args:
        build: ``build(simulation, **parameters)`` returns the root, a ``py_trees.behaviour.Behaviour``. Its parameters
            are those of the scenario.
        period: simulated time between two ticks of the tree, s.
        longest: simulated time after which the run ends with a tree that still goes on, s.

    Returns:
        A function whose results are ``tree``: "success", "failure" or "running", and ``tip``, the name of the behaviour
        that has decided.

    Raises:
        ValueError: a time is not a positive number.
        RequirementError: during the run: py_trees is not installed, or ``build`` returns something else.
    """
    for name, value in (("period", period), ("longest", longest)):
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} is a time in seconds, greater than 0, not {value!r:.60}")

    def run(simulation: Simulation, **parameters: Any) -> dict[str, str]:
        try:
            import py_trees
        except ImportError:
            raise RequirementError(f"behaviour trees need py_trees: {install('falsify')}") from None
        root = build(simulation, **parameters)
        if not isinstance(root, py_trees.behaviour.Behaviour):
            raise RequirementError(f"{build.__name__} returned {quoted(root)}, expected a py_trees behaviour")
        tree = py_trees.trees.BehaviourTree(root)
        tree.setup()
        end = simulation.time() + longest
        going_on = py_trees.common.Status.RUNNING
        try:
            while True:
                tree.tick()
                if root.status != going_on or simulation.time() >= end:
                    tip = root.tip()
                    return {"tree": root.status.name.lower(), "tip": root.name if tip is None else tip.name}
                simulation.sleep(period)
        finally:
            tree.shutdown()

    own = inspect.signature(build)
    vars(run).update(__signature__=own, __name__=getattr(build, "__name__", "tree"), __wrapped__=build)
    return run
