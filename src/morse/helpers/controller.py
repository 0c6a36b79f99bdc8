"""Feedback controllers."""

from __future__ import annotations

_JUMP = 0.1  # a larger change of the setpoint starts a new motion


class PIDController:
    """A discrete PID controller that is updated at a fixed rate; its gains are per update, not per second.

    Attributes:
        kp: gain of the error.
        kd: gain of the change of the error since the last update.
        ki: gain of the sum of the errors.
        limits_integrator: largest magnitude of the sum of the errors.
    """

    def __init__(self, kp: float = 1.0, kd: float = 1.0, ki: float = 1.0, limits_integrator: float = 10.0) -> None:
        if not limits_integrator >= 0.0:
            raise ValueError(f"PIDController: limits_integrator cannot be negative, given {limits_integrator!r}")
        self.kp = kp
        self.kd = kd
        self.ki = ki
        self.limits_integrator = limits_integrator
        self._setpoint = 0.0
        self._last_error = 0.0
        self._integral = 0.0

    @property
    def setpoint(self) -> float:
        """The setpoint. A change of more than 0.1 resets the past errors."""
        return self._setpoint

    @setpoint.setter
    def setpoint(self, value: float) -> None:
        if abs(value - self._setpoint) > _JUMP:
            self.reset()
        self._setpoint = value

    def reset(self) -> None:
        """Reset the past errors."""
        self._last_error = 0.0
        self._integral = 0.0

    def update(self, current: float) -> float:
        """Return the command for the present value, in the unit of the gains times the unit of the value."""
        error = self._setpoint - current
        change = error - self._last_error
        self._last_error = error
        limit = self.limits_integrator
        self._integral = min(max(self._integral + error, -limit), limit)
        return self.kp * error + self.kd * change + self.ki * self._integral
