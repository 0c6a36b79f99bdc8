"""Poses of bodies and of the nodes that they carry."""
