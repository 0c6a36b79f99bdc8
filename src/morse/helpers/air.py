"""What moves, dampens and shows in the air, for all components: the wind, rain in the way of radio waves, haze."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.world import Body, World

    Floats = NDArray[np.float64]

    Wind = tuple[float, float, float]

#: most of a property of the environment, m/s
_FASTEST = 1e3


class Look(NamedTuple):
    """How the air of a part of the world looks, for views of it.

    Attributes:
        color: red, green and blue of the light that it scatters, as codes from 0 to 1.
        extinction: of light, 1/m.
        overhead: optical depth of all air above.
        rain, snow: what falls, mm/h of water.
        corners: (x, y) of the convex base of the part, counterclockwise, m; empty for the whole world.
        top: upper end of the part, m; None for none.
    """

    color: tuple[float, float, float]
    extinction: float = 0.0
    overhead: float = 0.0
    rain: float = 0.0
    snow: float = 0.0
    corners: tuple[tuple[float, float], ...] = ()
    top: float | None = None


class Air:
    """The air of a simulation, ``context.server(Air)``; who simulates a weather sets it at the beginning of each tick.

    Attributes:
        wind: mean velocity in the world, m/s.
        gust: what is added to it at this tick, m/s.
        radio_loss: returns the attenuation (N,) of radio waves on the ways from a place (3,) to others (N, 3), dB, for
            their frequency, Hz; None if the air absorbs none.
        radio_echo: returns the radar cross-section of a volume of air, m²/m³, for a frequency, Hz, and a place (3,);
            None if it has none.
        looks: how it looks; the first one is that of the whole world but for the others. Empty for clear air.
        wet, snow_cover: share of the ground with water and with snow, 0 to 1.
        thrust: returns the thrust of the rotors of a robot as a share of that in free air; None if that is 1.
    """

    def __init__(self, world: World) -> None:
        self.wind: Wind = (0.0, 0.0, 0.0)
        self.gust: Wind = (0.0, 0.0, 0.0)
        self.radio_loss: Callable[[float, Floats, Floats], Floats] | None = None
        self.radio_echo: Callable[[float, Sequence[float]], float] | None = None
        self.looks: tuple[Look, ...] = ()
        self.wet = self.snow_cover = 0.0
        self.thrust: Callable[[Body], float] | None = None


def thrust(context: Context, body: Body) -> float:
    """Return the thrust of the rotors of a robot as a share of that in free air: more than 1 near the ground."""
    share = context.server(Air).thrust
    return 1.0 if share is None else share(body)


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
