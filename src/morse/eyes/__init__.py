"""Pictures of any model of MuJoCo, without OpenGL, a display or a graphics card.

::

    import mujoco, morse

    renderer = morse.Renderer(model, height=480, width=640)  # as mujoco.Renderer
    renderer.update_scene(data, camera="front")
    rgb = renderer.render()
"""

from morse.eyes.renderer import Renderer

__all__ = ["Renderer"]
