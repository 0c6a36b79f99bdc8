"""Reads robots from MJCF files, the models of MuJoCo."""

from morse.assets.mjcf.reader import read_mjcf

__all__ = ["read_mjcf"]
