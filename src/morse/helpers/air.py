"""What moves and dampens in the air, for all components: the wind, and the loss of radio waves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.world import World

    Wind = tuple[float, float, float]

#: most of a property of the environment, m/s
_FASTEST = 1e3


class Air:
    """The air of a simulation, ``context.server(Air)``; who simulates a weather sets it at the beginning of each tick.

    Attributes:
        wind: mean velocity in the world, m/s.
        gust: what is added to it at this tick, m/s.
        radio_loss: attenuation of radio waves along one way, dB/km, by their frequency, Hz.
    """

    def __init__(self, world: World) -> None:
        self.wind: Wind = (0.0, 0.0, 0.0)
        self.gust: Wind = (0.0, 0.0, 0.0)
        self.radio_loss: Callable[[float], float] = _none


def _none(frequency: float) -> float:
    return 0.0


def wind(context: Context, *, gusts: bool = True) -> Wind:
    """Return the velocity of the air in the axes of the world, m/s: it is the same everywhere.

    It is the wind of the weather (``env.weather(wind=(4, 0))``) plus ``wind_x`` and ``wind_y`` of
    ``env.properties(...)``.

    Args:
        context: of the component, ``self.context``.
        gusts: with the gusts of this tick, or the mean alone.
    """
    air = context.server(Air)
    x, y, z = (mean + gust for mean, gust in zip(air.wind, air.gust, strict=True)) if gusts else air.wind
    properties = context.scene.properties
    return x + _number(properties.get("wind_x")), y + _number(properties.get("wind_y")), z


def _number(value: object) -> float:
    if isinstance(value, (int, float)) and math.isfinite(value):
        return min(max(float(value), -_FASTEST), _FASTEST)
    return 0.0
