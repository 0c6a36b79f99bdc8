"""Runs by Ray, on this machine or on a cluster."""

from morse.system.ray_cluster import RayExecutor

__all__ = ["RayExecutor"]
