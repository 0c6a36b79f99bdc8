"""Pictures of a simulation for programs and notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from morse.physics import World
    from morse.rendering import Renderer
    from morse.viewer.notebook import Frame


class LiveView(Protocol):
    """What shows a simulation while it runs: the pages in browsers, or the viewer of MuJoCo."""

    @property
    def url(self) -> str:
        """The address for a browser."""

    def announce(self) -> None:
        """Log the address."""


class SimulationPictures:
    """The part of `morse.simulation.simulation.Simulation` that shows the world."""

    world: World
    view: LiveView | None
    #: what `picture` has read of the world
    _renderer: Renderer | None = None

    def _check_open(self) -> None:
        raise NotImplementedError

    def show(self, height: int = 480) -> Frame:
        """Return the live view as an HTML frame, which a notebook displays if it is the value of a cell.

        Args:
            height: height of the frame, px.

        Raises:
            RuntimeError: the simulation was not loaded with ``view="web"``, or is closed.
        """
        self._check_open()
        show: Callable[[int], Frame] | None = getattr(self.view, "show", None)
        if show is None:
            raise RuntimeError(
                "there is no live view: load the scene with morse.load(SCENE, view='web'), or draw it by sim.picture()"
            )
        return show(height)

    def picture(self, width: int = 960, height: int = 600, **view: Any) -> NDArray[np.uint8]:
        """Render an image of the present world, from the initial viewpoint of the live view.

        Args:
            width: pixels.
            height: pixels.
            view: ``location``, m, and ``rotation``, Euler angles in rad (``[0, 0, 0]`` looks straight down), of the
                camera; ``focal_length``, mm, of a sensor 32 mm wide.

        Returns:
            (height, width, 3) uint8, red, green and blue.

        Raises:
            ValueError: an argument is not valid for an image.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        from morse.rendering import Renderer, photograph

        if self._renderer is None:
            self._renderer = Renderer(self.world)
        return photograph(self.world, width, height, **view, renderer=self._renderer)
