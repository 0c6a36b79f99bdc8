"""Pictures of any model of MuJoCo, without OpenGL, a display or a graphics card.

::

    import mujoco, morse

    renderer = morse.Renderer(model, height=480, width=640)  # as mujoco.Renderer
    renderer.update_scene(data, camera="front")
    rgb = renderer.render()

For programs that call MuJoCo's own renderer: ``morse.eyes.install()``, first of all.
"""

from morse.eyes.opengl import install, uninstall
from morse.eyes.rays import RayHits, Rays
from morse.eyes.renderer import BatchRenderer, Renderer

__all__ = ["BatchRenderer", "RayHits", "Rays", "Renderer", "install", "uninstall"]
