"""Meshes of simple solids, for scene scripts."""

from morse.assets.solids import cone, cube, cylinder, ico_sphere, plane, sphere, torus

__all__ = ["cone", "cube", "cylinder", "ico_sphere", "plane", "sphere", "torus"]
