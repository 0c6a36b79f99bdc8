"""Sound in water against published values."""

import math

import pytest

from morse.plugins.senses.water import absorption, chord, refracted, sound_speed, transmission_loss


def test_the_speed_of_sound_is_that_of_mackenzie():
    """The check value of Mackenzie (1981)."""
    assert sound_speed(25.0, 35.0, 1000.0) == pytest.approx(1550.744, abs=5e-4)


@pytest.mark.parametrize(("frequency", "per_km"), [(10e3, 1.0), (100e3, 35.0)])
def test_the_absorption_is_near_the_curves_of_textbooks(frequency, per_km):
    """About 1 dB/km at 10 kHz and 35 dB/km at 100 kHz, at 10 °C and 35 parts per thousand."""
    assert absorption(frequency, 10.0, 35.0) * 1000.0 == pytest.approx(per_km, rel=0.15)


def test_absorption_in_fresh_water_is_viscous():
    """0.00049 f² exp(-T/27) dB/km."""
    assert absorption(500e3, 10.0, 1e-9) * 1000.0 == pytest.approx(0.00049 * 500.0**2 * math.exp(-10 / 27), rel=1e-3)


def test_the_loss_is_spreading_and_absorption():
    assert transmission_loss(1000.0, 0.01) == pytest.approx(60.0 + 10.0)
    assert transmission_loss(200.0, 0.0) - transmission_loss(100.0, 0.0) == pytest.approx(6.0206, abs=1e-4)


def test_a_bent_ray_obeys_snells_law():
    """A chord of a circle leads to the depth at which Snell's law gives the angle of the end of the arc."""
    speed, gradient, grazing, length = 1500.0, 0.5, 0.6, 300.0
    end = grazing - gradient * math.cos(grazing) / speed * length
    turn = grazing - end
    straight = 2.0 * length / turn * math.sin(turn / 2.0)
    depth = straight * math.sin(chord(grazing, length, speed, gradient))
    assert refracted(grazing, speed, speed + gradient * depth) == pytest.approx(end, abs=1e-9)


def test_a_ray_that_turns_is_horizontal():
    assert refracted(0.1, 1500.0, 1520.0) == 0.0
