"""The middlewares by which robot controllers connect to the simulation."""

from pathlib import Path

from morse.core.datastream import AbstractDatastream

# scripts of MORSE 1.4 name modules of this package, such as `morse.middleware.socket_datastream`
__path__.append(str(Path(__file__).parent / "legacy"))

__all__ = ["AbstractDatastream"]
