"""Sound in water: its speed, its loss, its way."""

from __future__ import annotations

import math


def sound_speed(temperature: float, salinity: float, depth: float) -> float:
    """Return the speed of sound, m/s.

    K. Mackenzie, "Nine-term equation for sound speed in the oceans", J. Acoust. Soc. Am. 70, 1981.

    Args:
        temperature: °C, 2 to 30.
        salinity: parts per thousand, 25 to 40.
        depth: m, 0 to 8,000.
    """
    t, s, d = temperature, salinity - 35.0, depth
    return (
        1448.96 + 4.591 * t - 5.304e-2 * t**2 + 2.374e-4 * t**3 + 1.340 * s + 1.630e-2 * d + 1.675e-7 * d**2
        - 1.025e-2 * t * s - 7.139e-13 * t * d**3
    )  # fmt: skip


def absorption(frequency: float, temperature: float = 10.0, salinity: float = 35.0, depth: float = 0.0) -> float:
    """Return the absorption of sound in sea water with a pH of 8, dB/m.

    M. Ainslie, J. McColm, "A simplified formula for viscous and chemical absorption in sea water", J. Acoust. Soc. Am.
    103, 1998.

    Args:
        frequency: Hz.
        temperature: °C.
        salinity: parts per thousand.
        depth: m.
    """
    f, t, z = frequency / 1000.0, temperature, depth / 1000.0
    boric = 0.78 * math.sqrt(salinity / 35.0) * math.exp(t / 26.0)
    magnesium = 42.0 * math.exp(t / 17.0)
    per_km = (
        0.106 * boric * f**2 / (boric**2 + f**2)
        + 0.52 * (1.0 + t / 43.0) * (salinity / 35.0) * magnesium * f**2 / (magnesium**2 + f**2) * math.exp(-z / 6.0)
        + 0.00049 * f**2 * math.exp(-(t / 27.0 + z / 17.0))
    )
    return per_km / 1000.0


def transmission_loss(distance: float, alpha: float) -> float:
    """Return the loss along one way, dB relative to 1 m: 20 log r + α r.

    R. Urick, "Principles of Underwater Sound", 3rd edition, chapter 5.

    Args:
        distance: r, m.
        alpha: absorption, dB/m.
    """
    return 20.0 * math.log10(max(distance, 1e-3)) + alpha * distance


def refracted(grazing: float, speed: float, other: float) -> float:
    """Return the grazing angle of a ray at another depth by Snell's law, cos θ / c = constant; 0 where it turns.

    Args:
        grazing: angle below the horizontal, rad.
        speed, other: speeds of sound at the two depths, m/s.
    """
    return math.copysign(math.acos(min(math.cos(grazing) * other / speed, 1.0)), grazing)


def chord(grazing: float, length: float, speed: float, gradient: float) -> float:
    """Return the angle below the horizontal of the straight line between the ends of a bent ray, rad.

    If the speed of sound changes with the depth by a constant gradient, rays are circles: dθ/ds = -g cos θ₀ / c₀
    (Urick, section 5.6).

    Args:
        grazing: angle of the ray at its begin, below the horizontal, rad.
        length: of the ray, m.
        speed: at its begin, m/s.
        gradient: of the speed downwards, 1/s.
    """
    return grazing - gradient * math.cos(grazing) / speed * length / 2.0
