"""Radio waves and sound in weather: how they fade, and the echo of rain in a radar.

Sources of the formulas:

* rain on radio waves: Recommendation ITU-R P.838-3;
* water in radio waves: H. Liebe, G. Hufford, T. Manabe, Int. J. Infrared and Millimeter Waves 12 (1991);
* backscatter of a sphere: C. Bohren, D. Huffman, Absorption and Scattering of Light by Small Particles (1983),
  chapter 4;
* sound in air: ISO 9613-1.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

from morse.plugins.weather.medium import drops_of

if TYPE_CHECKING:
    from morse.plugins.weather.medium import Conditions

LIGHT = 299_792_458.0
#: coefficients a, b, c of log10 k and of alpha in P.838-3, equations (2) and (3), for horizontal polarisation
_LOG_K = (
    (-5.33980, -0.10008, 1.13098), (-0.35351, 1.26970, 0.45400), (-0.23789, 0.86036, 0.15354),
    (-0.94158, 0.64552, 0.16817),
)  # fmt: skip
_ALPHA = (
    (-0.14318, 1.82442, -0.55187), (0.29591, 0.77564, 0.19822), (0.32177, 0.63773, 0.13164),
    (-5.37610, -0.96230, 1.47828), (16.1721, -3.29980, 3.43990),
)  # fmt: skip
#: step of the sizes of drops, mm, and the largest drops, which are torn apart in the air
_STEP, _LARGEST = 0.1, 6.0
#: temperature of the drops, K
_TEMPERATURE = 283.15


def attenuation(conditions: Conditions, frequency: float) -> float:
    """Return the attenuation of radio waves by rain, dB/km, one way, for horizontal polarisation.

    Args:
        conditions: the weather.
        frequency: Hz; beyond 1 GHz to 1 THz, for which the Recommendation holds, that of the nearer end.
    """
    if not conditions.rain:
        return 0.0
    x = math.log10(min(max(frequency / 1e9, 1.0), 1000.0))
    log_k = sum(a * math.exp(-(((x - b) / c) ** 2)) for a, b, c in _LOG_K) - 0.18961 * x + 0.71147
    alpha = sum(a * math.exp(-(((x - b) / c) ** 2)) for a, b, c in _ALPHA) + 0.67849 * x - 1.95537
    return float(10.0**log_k * conditions.rain**alpha)


def echo_of_rain(conditions: Conditions, frequency: float) -> float:
    """Return the radar reflectivity of the rain: cross-section per volume, m²/m³."""
    total = 0.0
    if conditions.rain:
        drops = drops_of(conditions)[0]
        for number, cross_section in enumerate(_of_drops(frequency)):
            diameter = (number + 0.5) * _STEP
            total += drops.intercept * math.exp(-drops.slope * diameter) * cross_section * _STEP
    return total


@lru_cache(32)
def _of_drops(frequency: float) -> tuple[float, ...]:
    """Return the backscattering cross-sections of drops, m², for diameters in steps of `_STEP`."""
    wavelength = LIGHT / min(max(frequency, 1e8), 1e12)
    index = refractive_index_of_water(frequency)
    count = round(_LARGEST / _STEP)
    return tuple(backscatter(1e-3 * (number + 0.5) * _STEP, wavelength, index) for number in range(count))


def refractive_index_of_water(frequency: float, temperature: float = _TEMPERATURE) -> complex:
    """Return the complex refractive index of water; the imaginary part absorbs.

    Args:
        frequency: Hz, at most 1 THz.
        temperature: K.
    """
    gigahertz = min(max(frequency, 1e8), 1e12) / 1e9
    inverse = 300.0 / temperature - 1.0
    static = 77.66 + 103.3 * inverse
    middle, high = 0.0671 * static, 3.52
    first = 20.20 - 146.0 * inverse + 316.0 * inverse**2
    second = 39.8 * first
    permittivity = static - gigahertz * (
        (static - middle) / (gigahertz + 1j * first) + (middle - high) / (gigahertz + 1j * second)
    )
    root = permittivity**0.5
    return complex(root.real, abs(root.imag))


def backscatter(diameter: float, wavelength: float, index: complex) -> float:
    """Return the radar cross-section of a sphere, m², by the theory of Mie: that of the same power in all directions.

    Args:
        diameter: m.
        wavelength: m.
        index: complex refractive index, with a positive imaginary part.
    """
    x = math.pi * diameter / wavelength
    last = int(x + 4.05 * x ** (1.0 / 3.0) + 2.0)
    mx = index * x
    # the logarithmic derivative of psi, by downward recurrence
    derivative = [0j] * (last + 1)
    value = 0j
    for n in range(max(last, int(abs(mx))) + 16, 0, -1):
        if n <= last:
            derivative[n] = value
        value = n / mx - 1.0 / (value + n / mx)
    psi_before, psi, chi_before, chi = math.cos(x), math.sin(x), -math.sin(x), math.cos(x)
    amplitude = 0j
    for n in range(1, last + 1):
        psi_before, psi = psi, (2 * n - 1) * psi / x - psi_before
        chi_before, chi = chi, (2 * n - 1) * chi / x - chi_before
        xi_before, xi = complex(psi_before, -chi_before), complex(psi, -chi)
        inside_a = derivative[n] / index + n / x
        inside_b = derivative[n] * index + n / x
        a = (inside_a * psi - psi_before) / (inside_a * xi - xi_before)
        b = (inside_b * psi - psi_before) / (inside_b * xi - xi_before)
        amplitude += (2 * n + 1) * (-1) ** n * (a - b)
    return float(wavelength**2 / (4.0 * math.pi) * abs(amplitude) ** 2)


def attenuation_of_sound(frequency: float, temperature: float, humidity: float) -> float:
    """Return the attenuation of sound by the air at a pressure of 101.325 kPa, dB/m.

    Args:
        frequency: Hz.
        temperature: °C.
        humidity: relative, 0 to 1.
    """
    kelvin = temperature + 273.15
    ratio = kelvin / 293.15
    # molar concentration of water vapour, %
    water = 100.0 * humidity * 10.0 ** (4.6151 - 6.8346 * (273.16 / kelvin) ** 1.261)
    oxygen = 24.0 + 4.04e4 * water * (0.02 + water) / (0.391 + water)
    nitrogen = ratio**-0.5 * (9.0 + 280.0 * water * math.exp(-4.170 * (ratio ** (-1.0 / 3.0) - 1.0)))
    square = frequency * frequency
    classical = 1.84e-11 * math.sqrt(ratio)
    of_oxygen = 0.01275 * math.exp(-2239.1 / kelvin) / (oxygen + square / oxygen)
    of_nitrogen = 0.1068 * math.exp(-3352.0 / kelvin) / (nitrogen + square / nitrogen)
    return float(8.686 * square * (classical + ratio**-2.5 * (of_oxygen + of_nitrogen)))
