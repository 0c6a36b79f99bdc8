"""The base class of sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.declarations import add_data
from morse.core.noise import measured
from morse.core.object import Object
from morse.core.services import service
from morse.scene.realism import is_numeric

if TYPE_CHECKING:
    from morse.core.noise import Noise
    from morse.core.realism import Realism


class Sensor(Object):
    """Measures something and publishes it: fill ``local_data`` in ``default_action``.

    Attributes:
        rays: the rays that it looks along (`morse.physics.RayBundle`), or None, see `add_rays`.
        realism: its delay and noise, or None for an ideal sensor.
    """

    add_data("timestamp", 0.0, "float", "Simulated time of the measurement", unit="s")

    rays: Any = None
    realism: Realism | None = None

    @service
    def get_local_data(self) -> dict[str, Any]:
        """The present data of the sensor."""
        return self.local_data

    def add_rays(self, directions: Any, reach: float, origins: Any = None, *, upright: bool = False) -> None:
        """Look along rays; call it in ``__init__``.

        They are cast together with those of all other sensors, before ``default_action``, which finds what they
        met in ``self.rays``: ``distances``, ``points``, ``hit``, ``object_of(i)``, ``remissions``. They pass
        through the own robot and through everything that does not collide.

        Args:
            directions: (N, 3) vectors in the frame of the sensor.
            reach: metres.
            origins: (N, 3) metres in the frame of the sensor; None if all rays start at its origin.
            upright: directions and origins are along the axes of the world, however the sensor is turned.

        Raises:
            ValueError: arrays of another shape, numbers that are not finite, directions of no length, no reach.
        """
        self.rays = self.context.world.rays.bundle(self.bge_object, directions, reach, origins, upright=upright)

    def sensor_setup(self) -> None:
        """Take the pose and the time of a measurement."""
        self.position_3d.update(self.bge_object)
        self.local_data["timestamp"] = self.clock.time

    def action(self) -> None:
        """One measurement: pose, time, `default_action`, modifiers, streams."""
        if not self._active:
            return
        if self.realism is not None:
            self.realism.act()
            return
        self.position_3d.update(self.bge_object)
        self.local_data["timestamp"] = self.clock.time
        self.default_action()
        for modifier in self.output_modifiers:
            modifier.modify()
        for publish in self.output_functions:
            publish(self)

    # -- noise -----------------------------------------------------------------------------

    def noisy_fields(self) -> tuple[str, ...]:
        """The fields that get the noise for which a script names no field: all numbers and vectors."""
        return tuple(name for name, value in self.local_data.items() if name != "timestamp" and is_numeric(value))

    def add_noise(self, field: str, noise: Noise, before: Any) -> None:
        """Add errors to a field. A value that is lost stays as it was before.

        Args:
            before: what the field held until this measurement.
        """
        value = measured(self.local_data[field], noise)
        self.local_data[field] = before if noise.lost()[0] else value
