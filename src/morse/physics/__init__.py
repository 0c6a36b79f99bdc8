"""The physics of a scene, on MuJoCo; the only package that depends on the physics engine."""

from morse.physics.objects.gameobject import GameObject
from morse.physics.stability import UnstableError
from morse.physics.world import World

__all__ = ["GameObject", "UnstableError", "World"]
