"""Ray casting for lasers, radars and other sensors, all rays of a tick in one call."""

from morse.physics.rays.bundle import RayBundle
from morse.physics.rays.rays import Rays

__all__ = ["RayBundle", "Rays"]
