"""The middlewares by which robot controllers connect to the simulation."""

from morse.core.datastream import AbstractDatastream

__all__ = ["AbstractDatastream"]
