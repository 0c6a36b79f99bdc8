"""What a log tells about parameters: the spread of each, and which combinations of them matter."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.plugins.twin.parameters import Parameter

    Floats = NDArray[np.float64]

#: spread, relative to the scale of a parameter, from which it is not known
UNKNOWN = 0.5
#: the same for a combination of parameters; and the spread of what has no effect at all
VAGUE, WITHOUT_EFFECT = 0.3, 1e3
#: share in a direction from which a parameter is named
_NAMED = 0.2


def spreads_of(information: Floats) -> Floats:
    """The standard deviations of the scaled parameters: the Cramér-Rao bound; inf for what has no effect."""
    values, vectors = np.linalg.eigh(information)
    least = max(WITHOUT_EFFECT**-2, 1e-13 * max(float(values[-1]), 0.0)) if len(values) else 0.0
    is_flat = values <= least
    variances = (vectors[:, ~is_flat] ** 2 / values[~is_flat]).sum(axis=1)
    # what is part of a direction without effect is not known
    variances[(vectors[:, is_flat] ** 2).sum(axis=1) > 1e-6] = math.inf
    return np.asarray(np.sqrt(variances))


def relations(parameters: Sequence[Parameter], information: Floats) -> list[str]:
    """In words: what the log does not tell about the parameters, and what it tells instead."""
    if not parameters:
        return []
    values, vectors = np.linalg.eigh(information)
    silent = {number for number in range(len(parameters)) if information[number, number] <= WITHOUT_EFFECT**-2}
    lines = [f"{parameters[number].name} has no effect here" for number in sorted(silent)]
    for value, vector in zip(values, vectors.T, strict=True):
        if value > VAGUE**-2:
            break
        parts = [number for number in np.argsort(-np.abs(vector)) if abs(vector[number]) > _NAMED]
        parts = [number for number in parts if number not in silent]
        if len(parts) < 2:
            lines += [f"{parameters[number].name} hardly has an effect here" for number in parts]
            continue
        lines.append(_relation(parameters, vector, parts))
    return lines


def _relation(parameters: Sequence[Parameter], vector: Floats, parts: Sequence[int]) -> str:
    names = [parameters[number].name for number in parts]
    if len(parts) == 2:
        one, other = parts
        # what stays the same along the direction
        first, second = float(vector[other]), -float(vector[one])
        if first < 0.0:
            first, second = -first, -second
        if parameters[one].is_ratio and parameters[other].is_ratio:
            power = second / first
            if abs(abs(power) - 1.0) < 0.15:
                return f"only {names[0]} {'×' if power > 0.0 else '/'} {names[1]} matters here"
            return f"only {names[0]} × {names[1]}^{power:.2g} matters here"
        first, second = first / parameters[one].scale, second / parameters[other].scale
        share = second / first
        sign = "+" if share > 0.0 else "-"
        return f"only {names[0]} {sign} {abs(share):.3g} · {names[1]} matters here"
    return f"{', '.join(names[:-1])} and {names[-1]} cannot be told apart here"
