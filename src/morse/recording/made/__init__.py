"""Descriptions of a scene and of the objects that were spawned in it: plain data, no program."""
