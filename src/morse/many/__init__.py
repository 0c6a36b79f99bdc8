"""Many simulations: batches that are stepped together, and studies of thousands of runs.

A package adds names to this module by the entry points of ``morse.many``, for what it does with many simulations.
"""

from typing import Any

from morse.many.batch import Batch, batch
from morse.many.parameters import Distribution, choice, loguniform, normal, uniform
from morse.many.results import Table
from morse.many.run import Run
from morse.many.study import Study

__all__ = ["Batch", "Distribution", "Run", "Study", "Table", "batch", "choice", "loguniform", "normal", "uniform"]


def __getattr__(name: str) -> Any:
    # asked for each import of a part of this package, too
    if not name.startswith("_"):
        from morse.core.classes.plugins import entry_points, load

        for point in entry_points("morse.many"):
            if point.name == name:
                found: object = load(point, lambda value: value)
                return found
    raise AttributeError(f"module 'morse.many' has no attribute '{name}'", name=name)
