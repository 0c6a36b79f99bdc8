"""Reads models and worlds from SDF files, the format of Gazebo. See http://sdformat.org/spec."""

from morse.assets.sdf.reader import read_sdf

__all__ = ["read_sdf"]
