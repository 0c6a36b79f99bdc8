"""The world around the robots, and the settings of the simulation."""

from morse.builder.environment.environment import Environment

__all__ = ["Environment"]
