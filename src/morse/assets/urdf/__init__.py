"""Reads robots from URDF files."""

from morse.assets.urdf.reader import read_urdf

__all__ = ["read_urdf"]
