"""Rays, as components see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from morse.core.serving import Server
    from morse.core.world.body import Body


class Sight(Protocol):
    """The results of a cast."""

    @property
    def distances(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; infinite for no hit."""

    @property
    def ranges(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; the reach for no hit."""

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) hit points in the frame of the sensor, m; [0, 0, 0] for no hit."""

    @property
    def hit(self) -> NDArray[np.int64]:
        """(N,) number of the solid at each hit; -1 for no hit; see `RayBundle.object_of`."""


class RayBundle(Sight, Protocol):
    """The rays of a sensor, and what they hit.

    Attributes:
        directions: (N, 3) unit vectors in the frame of the object; the array must not be modified.
        reach: largest distance of a hit, m.
    """

    directions: NDArray[np.float64]
    reach: float

    def __len__(self) -> int: ...

    @property
    def server(self) -> Server[Self]:
        """The server that casts these rays together with those of other sensors (see `morse.core.requests`)."""

    @property
    def sight(self) -> Sight:
        """The results of the last cast, which do not change."""

    def turn_to(self, directions: ArrayLike) -> None:
        """Set other directions: (N, 3) vectors of nonzero length, in the frame of the object."""

    def refresh(self) -> None:
        """Cast the rays now, unless no object has moved since the last cast."""

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) reflectance, 0..1: the ``specular`` of the material at each hit; 0 for no hit."""

    def object_of(self, ray: int) -> Body | None:
        """Return the object that a ray has hit; None for no hit, or if the object has been removed since."""

    def segments(self) -> NDArray[np.float32]:
        """Return (N, 7) origin, end (m, world frame) and 1 for a hit, 0 for no hit."""


class Rays(Protocol):
    """Casts rays."""

    def bundle(
        self,
        obj: Body,
        directions: ArrayLike,
        reach: float,
        origins: ArrayLike | None = None,
        *,
        upright: bool = False,
    ) -> RayBundle:
        """Create the rays of a sensor.

        Args:
            obj: the object of the sensor.
            directions: (N, 3) vectors in its frame, of nonzero length.
            reach: largest distance, m; may be infinite.
            origins: (N, 3) m in its frame; None if all rays start at its origin.
            upright: directions and origins are given along the axes of the world, independent of the orientation of the
                sensor.

        Raises:
            ValueError: an array has the wrong shape or contains a value that is not finite, or the reach is not
                positive.
        """
