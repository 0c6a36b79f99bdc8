"""Rays: what lasers, radars and eyes see, cast all at once."""

from morse.physics.rays.bundle import RayBundle
from morse.physics.rays.rays import Rays

__all__ = ["RayBundle", "Rays"]
