"""Names for what tasks, environments and learners pass to each other."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

#: arrays by name, one row (N, ...) for each environment: the data, the values and the infos of a task
Arrays: TypeAlias = dict[str, np.ndarray]
#: observations in the form of the observation space: an array, or a dictionary of arrays
Observation: TypeAlias = Any
#: what an environment tells besides observations, rewards and ends: Gymnasium leaves the types of the values open
Infos: TypeAlias = dict[str, Any]
#: (N,) observations, rewards, terminated, truncated, and infos
Outcome: TypeAlias = tuple[Observation, np.ndarray, np.ndarray, np.ndarray, Infos]
