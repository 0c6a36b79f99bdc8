"""Traffic: steady streams, waves in columns of cars, changes of lanes."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np
from figures import Figure, scene

from morse.plugins.traffic.driving import Driver, advance

if TYPE_CHECKING:
    from collections.abc import Iterator

_RING = "[(0, 0), (150, 0), (150, 50), (0, 50)]"
_SOURCE = "Treiber et al. 2000: s_e = (s0 + v T) / √(1 − (v / v0)⁴)"


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    for count in (10, 16, 40):
        yield stream(count)
    for acceleration in (0.73, 3.0):
        yield gain(acceleration)


def stream(count: int) -> Figure:
    """Measure the speed of a steady stream on a ring, whose gap is known, and compare the gap that belongs to it."""
    text = f"cars = Traffic()\ncars.road('ring', {_RING}, {count}, closed=True, speed=20.0)\n"
    with scene(text + 'Environment("empty", fastmode=True)\n') as simulation:
        simulation.step(60 * 240)
        speed = float(simulation.cars.data["speeds"].mean())
    gap = 400.0 / count - 4.6
    return Figure(
        f"IDM, {count} cars on a ring, {speed:.2f} m/s",
        "gap, m",
        Driver().equilibrium_gap(speed, 20.0),
        gap,
        0.02 * gap,
        _SOURCE,
    )


def gain(acceleration: float) -> Figure:
    """Measure how much a wave of 0.25 rad/s grows from car to car, and compare linear theory."""
    driver = Driver(headway=1.0, acceleration=acceleration)
    v, v0, omega, step = 10.0, 33.3, 0.25, 1.0 / 60.0
    s = driver.equilibrium_gap(v, v0)
    wanted, rate = driver.gap + v * driver.headway, 2.0 * math.sqrt(driver.acceleration * driver.deceleration)
    f_s = 2.0 * acceleration * wanted**2 / s**3
    f_l = 2.0 * acceleration * wanted / s**2 * v / rate
    f_v = -4.0 * acceleration * v**3 / v0**4 - 2.0 * acceleration * wanted / s**2 * (driver.headway + v / rate)
    expected = abs((f_s + 1j * omega * f_l) / (f_s - omega**2 - 1j * omega * f_v))
    speeds, places, waves = np.full(3, v), -np.arange(3) * (s + 4.6), np.zeros(3, dtype=complex)
    period = round(2.0 * math.pi / omega / step)
    for tick in range(16 * period):
        speeds[0] = v + 0.01 * math.sin(omega * tick * step)
        gaps = places[:-1] - places[1:] - 4.6
        change = driver.accelerations(speeds[1:], v0, gaps, speeds[1:] - speeds[:-1])
        places, speeds = advance(places, speeds, np.concatenate([[0.0], change]), step)
        if tick >= 12 * period:
            waves += (speeds - v) * cmath.exp(-1j * omega * tick * step)
    kind = "unstable" if f_v**2 - f_l**2 < 2.0 * f_s else "stable"
    return Figure(
        f"IDM, column of cars, T = 1 s, a = {acceleration:g} m/s²: string {kind}",
        "gain from car to car",
        expected,
        float(abs(waves[2] / waves[1])),
        0.02,
        "modulus of (f_s + iω f_l) / (f_s − ω² − iω f_v); criterion f_v² − f_l² > 2 f_s",
    )
