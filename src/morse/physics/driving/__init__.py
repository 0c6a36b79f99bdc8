"""Robots that are driven by velocity commands: what a command does to their bodies in a tick."""
