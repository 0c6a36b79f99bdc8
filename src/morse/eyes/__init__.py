"""Pictures of any model of MuJoCo, without OpenGL, a display or a graphics card.

::

    import mujoco, morse

    renderer = morse.Renderer(model, height=480, width=640)  # as mujoco.Renderer
    renderer.update_scene(data, camera="front")
    rgb = renderer.render()

For programs that call MuJoCo's own renderer: ``morse.eyes.install()``, first of all.
"""

import re

import mujoco

#: the first version of MuJoCo whose scenes are read, and the first one whose are not known
_FIRST, _BEYOND = (3, 3), (4, 1)


def check_version(version: str | None) -> None:
    """Check the version of MuJoCo.

    Raises:
        ImportError: it is not supported, or None.
    """
    found = re.match(r"(\d+)\.(\d+)", version or "")
    if found is not None and _FIRST <= (int(found[1]), int(found[2])) < _BEYOND:
        return
    place = next(iter(getattr(mujoco, "__path__", ())), "an unknown place")
    first, beyond = (".".join(map(str, numbers)) for numbers in (_FIRST, _BEYOND))
    raise ImportError(
        f"morse.eyes (Renderer, Rays, install) draws models of MuJoCo from {first} to before {beyond}; installed is "
        f"{'an incomplete MuJoCo' if version is None else version}, in {place}. "
        f'Install a version that is supported: pip install "mujoco>={first},<{beyond}"'
    )


# before the imports of modules that use the names of MuJoCo
check_version(getattr(mujoco, "__version__", None))

from morse.eyes.batch import BatchRenderer  # noqa: E402
from morse.eyes.opengl import install, uninstall  # noqa: E402
from morse.eyes.rays import RayHits, Rays  # noqa: E402
from morse.eyes.renderer import Renderer  # noqa: E402

__all__ = ["BatchRenderer", "RayHits", "Rays", "Renderer", "install", "uninstall"]
