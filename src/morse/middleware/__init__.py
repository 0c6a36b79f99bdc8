"""The ways in which robot controllers reach the simulation."""

from morse.core.datastream import AbstractDatastream

__all__ = ["AbstractDatastream"]
