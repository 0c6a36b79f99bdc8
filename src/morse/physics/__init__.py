"""The physics of a scene, on MuJoCo; the only package that depends on the physics engine."""

try:
    import mujoco as _mujoco  # noqa: F401 - here, since all that needs it imports this package
except (ImportError, OSError) as _error:
    raise ImportError(
        f"MuJoCo cannot be loaded: {_error}. `morse check` says what is wrong with the installation", name="mujoco"
    ) from _error

from morse.physics.objects.gameobject import GameObject
from morse.physics.stability import UnstableError
from morse.physics.world import World

__all__ = ["GameObject", "UnstableError", "World"]
