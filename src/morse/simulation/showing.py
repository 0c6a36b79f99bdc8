"""Pictures of a simulation for programs and notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.physics import World
    from morse.rendering import Renderer


class Showing:
    """The part of `morse.simulation.simulation.Simulation` that shows the world."""

    world: World
    view: Any
    #: what `picture` has read of the world
    _renderer: Renderer | None = None

    def _check_open(self) -> None:
        raise NotImplementedError

    def show(self, height: int = 480) -> Any:
        """Return the live view as an HTML frame, which a notebook displays if it is the value of a cell.

        Args:
            height: height of the frame, px.

        Raises:
            RuntimeError: the simulation was not loaded with ``view="web"``, or is closed.
        """
        self._check_open()
        show = getattr(self.view, "show", None)
        if show is None:
            raise RuntimeError(
                "there is no live view: load the scene with morse.load(SCENE, view='web'), or draw it by sim.picture()"
            )
        return show(height)

    def picture(self, width: int = 960, height: int = 600, **view: Any) -> Any:
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
