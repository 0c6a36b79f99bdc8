"""Many simulations: batches that are stepped together, and studies of thousands of runs."""

from morse.many.batch import Batch, batch
from morse.many.parameters import Distribution, choice, loguniform, normal, uniform
from morse.many.results import Table
from morse.many.run import Run
from morse.many.study import Study

__all__ = ["Batch", "Distribution", "Run", "Study", "Table", "batch", "choice", "loguniform", "normal", "uniform"]
