"""Errors of odometry: wrong wheel radius and drift of the gyroscope."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.declarations import Option, add_state
from morse.core.modifier import AbstractModifier
from morse.core.services import service

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from morse.core.object import Object
    from morse.core.values import Options

_FULL_TURN = 2.0 * math.pi
#: the axes x, y and yaw of a covariance of six axes
_PLANE = (0, 1, 5)
_CERTAIN = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_LENGTHS = ("dS", "dx", "dy", "dz", "vx", "vy", "vz")


class OdometryNoiseModifier(AbstractModifier):
    """Scales each displacement by a factor and adds a drift to the heading; the errors accumulate.

    Each measurement draws a factor from N(``factor``, ``factor_sigma``) and a drift from N(``gyro_drift``,
    ``gyro_drift_sigma``), in radians per measurement. Displacements and velocities are multiplied by the factor. The
    drift is added to the change of the heading. The integrated level reports the resulting path.

    The covariance of the pose grows along the path as both standard deviations say, to first order; the mean errors
    ``factor`` and ``gyro_drift`` are not part of it.
    """

    _names = ("OdometryNoise",)
    _components = ("Odometry",)

    options: ClassVar[Mapping[str, Option]] = MappingProxyType(
        {
            "factor": Option(float, 1.05, "Measured length of a metre"),
            "factor_sigma": Option(float, 0.0, "Standard deviation of the measured length of a metre", low=0.0),
            "gyro_drift": Option(float, 0.0, "Drift of the heading in each measurement", unit="rad"),
            "gyro_drift_sigma": Option(
                float, 0.0, "Standard deviation of the drift of the heading", unit="rad", low=0.0
            ),
        }
    )

    add_state("_random", np.random.Generator, "Noise of the factor and of the drift")
    add_state("_true", tuple, "True x, y and yaw")
    add_state("_measured", tuple, "Measured x, y and yaw")
    add_state("_yaw_error", float, "Error of the yaw", unit="rad")
    add_state("_spread", tuple, "Covariance of the measured path: xx, xy, x yaw, yy, y yaw, yaw yaw")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        parameters = {
            name: float(self.parameter(name, default=option.default)) for name, option in self.options.items()
        }
        self._factor, self._factor_sigma = parameters["factor"], parameters["factor_sigma"]
        self._drift, self._drift_sigma = parameters["gyro_drift"], parameters["gyro_drift_sigma"]
        self._random = component_instance.context.random(f"{component_instance.name()}/{type(self).__name__}")
        #: the path of the measurements: true and measured x, y and yaw
        self._true, self._measured = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        self._yaw_error = 0.0
        self._spread = _CERTAIN
        if self._factor_sigma or self._drift_sigma:
            self.covariances = {"pose_covariance": self._of_pose, "twist_covariance": self._of_twist}

    def _of_pose(self) -> NDArray[np.float64]:
        xx, xy, xt, yy, yt, tt = self._spread
        matrix = np.zeros((6, 6))
        matrix[np.ix_(_PLANE, _PLANE)] = ((xx, xy, xt), (xy, yy, yt), (xt, yt, tt))
        return matrix

    def _of_twist(self) -> NDArray[np.float64]:
        matrix = np.zeros((6, 6))
        share = self._factor_sigma / self._factor if self._factor else 0.0
        velocity = np.array([self.data["vx"], self.data["vy"], self.data["vz"]]) * share
        matrix[:3, :3] = velocity[:, None] * velocity
        matrix[5, 5] = (self._drift_sigma * self.component_instance.frequency) ** 2
        return matrix

    @service
    def reset_noise(self) -> None:
        """Reset the accumulated errors."""
        self._yaw_error = 0.0
        self._measured = self._true
        self._spread = _CERTAIN

    def modify(self) -> None:
        """Add the errors."""
        data = self.data
        factor = self._random.normal(self._factor, self._factor_sigma) if self._factor_sigma else self._factor
        drift = self._random.normal(self._drift, self._drift_sigma) if self._drift_sigma else self._drift
        for name in _LENGTHS:
            if name in data:
                data[name] *= factor
        if "dyaw" in data:
            data["dyaw"] = math.remainder(data["dyaw"] + drift, _FULL_TURN)
        if "wz" in data:
            data["wz"] += drift * self.component_instance.frequency
        if "yaw" in data and "x" in data:
            self._follow(factor, drift)

    def _follow(self, factor: float, drift: float) -> None:
        """Add the displacement since the last measurement to the measured path."""
        data = self.data
        x, y, yaw = data["x"], data["y"], data["yaw"]
        dx, dy = factor * (x - self._true[0]), factor * (y - self._true[1])
        # the displacement is given in the axes of the measured body, whose heading has an error
        c, s = math.cos(self._yaw_error), math.sin(self._yaw_error)
        self._yaw_error = math.remainder(self._yaw_error + drift, _FULL_TURN)
        self._true = (x, y, yaw)
        measured_yaw = math.remainder(yaw + self._yaw_error, _FULL_TURN)
        dx, dy = c * dx - s * dy, s * dx + c * dy
        self._measured = (self._measured[0] + dx, self._measured[1] + dy, measured_yaw)
        if self.covariances:
            self._grow(dx, dy, self._factor_sigma / factor if factor else 0.0)
        data["x"], data["y"], data["yaw"] = self._measured

    def _grow(self, dx: float, dy: float, share: float) -> None:
        """Propagate the covariance of the path over a measured displacement whose length has a relative error."""
        xx, xy, xt, yy, yt, tt = self._spread
        ex, ey = share * dx, share * dy
        self._spread = (
            xx - 2.0 * dy * xt + dy * dy * tt + ex * ex,
            xy + dx * xt - dy * yt - dx * dy * tt + ex * ey,
            xt - dy * tt,
            yy + 2.0 * dx * yt + dx * dx * tt + ey * ey,
            yt + dx * tt,
            tt + self._drift_sigma * self._drift_sigma,
        )
