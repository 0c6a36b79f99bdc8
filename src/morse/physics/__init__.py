"""The physics of a scene, on MuJoCo: the only room that knows the engine."""

from morse.physics.gameobject import GameObject
from morse.physics.stability import UnstableError
from morse.physics.world import World

__all__ = ["GameObject", "UnstableError", "World"]
