"""Inertial measurement unit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, TypedDict

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.realism import generator_state, set_generator_state
from morse.core.rows.marks import on_read
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.helpers.geodesy import has_place
from morse.mathutils.rotations import turn_back
from morse.sensors.magnetometer import field_around
from morse.sensors.motion_sensor import Motion, MotionSensor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np

    from morse.core.realism import GeneratorState
    from morse.core.robot import Robot
    from morse.core.world import Body


#: the largest Allan deviation of a first-order Gauss-Markov process, in units of its standard deviation
_GAUSS_MARKOV_PEAK = 0.6175
#: time between two measurements, s
_SHORTEST = 1e-6


class ErrorTerms(NamedTuple):
    """The error terms of one kind of sensor, for a quantity whose unit is u.

    Attributes:
        density: density of the white noise of each axis, u/√Hz, equal to the Allan deviation at 1 s.
        instability: in-run bias instability, u, the minimum of the Allan deviation as in data sheets.
        random_walk: random walk of the bias, u/√s, its standard deviation after one second.
        correlation_time: correlation time of the bias, s.
    """

    density: tuple[float, float, float]
    instability: float
    random_walk: float
    correlation_time: float

    @property
    def spread(self) -> float:
        """Standard deviation of the bias with a correlation time, u."""
        return self.instability / _GAUSS_MARKOV_PEAK

    def deviations(self, frequency: float) -> dict[str, list[float] | float]:
        """Return the errors of measurements with a frequency, Hz, like `AbstractModifier.changes`."""
        white = [math.hypot(density * math.sqrt(frequency), self.spread) for density in self.density]
        return {"stddev": white, "walk": self.random_walk}


def terms_of(values: Mapping[str, float | None]) -> tuple[ErrorTerms, ErrorTerms]:
    """Return the errors of the gyroscope and of the accelerometer from the properties of an `IMU`."""

    def terms(kind: str, last: float | None = None) -> ErrorTerms:
        density, instability, walk = (
            values[f"{kind}{name}"] or 0.0 for name in ("NoiseDensity", "BiasInstability", "RandomWalk")
        )
        densities = (density, density, density if last is None else last)
        return ErrorTerms(densities, instability, walk, values["BiasCorrelationTime"] or 0.0)

    return terms("Gyro"), terms("Accel", values["AccelNoiseDensityZ"])


class _NoiseState(TypedDict):
    random: GeneratorState
    bias: list[float]
    walk: list[float]


class InertialErrors:
    """Errors of three axes: white noise, a bias with a correlation time, and a bias with a random walk.

    The bias with a correlation time is a first-order Gauss-Markov process. Its Allan deviation has its maximum, which
    equals the bias instability, at 1.89 times the correlation time. See IEEE Std 952-1997, annex C.

    Args:
        random: generator of random numbers.
        terms: magnitudes of the errors.
    """

    def __init__(self, random: np.random.Generator, terms: ErrorTerms) -> None:
        self._random = random
        self.terms = terms
        start = terms.spread
        self._bias = [start * float(x) for x in random.standard_normal(3)] if start else [0.0, 0.0, 0.0]
        self._walk = [0.0, 0.0, 0.0]

    def added(self, truth: Sequence[float], dt: float) -> list[float]:
        """Return the measured values, ``dt`` seconds after the last measurement."""
        dt = max(dt, _SHORTEST)
        white_x, white_y, white_z, *others = self._random.standard_normal(9).tolist()
        wander_x, wander_y, wander_z, walk_x, walk_y, walk_z = others
        terms = self.terms
        # a measurement is the mean over the time since the last measurement
        sigma_x, sigma_y, sigma_z = (density / math.sqrt(dt) for density in terms.density)
        keep = math.exp(-dt / terms.correlation_time)
        push = terms.spread * math.sqrt(1.0 - keep * keep)
        stride = terms.random_walk * math.sqrt(dt)
        (x, y, z), (bias_x, bias_y, bias_z), (drift_x, drift_y, drift_z) = truth, self._bias, self._walk
        bias_x = keep * bias_x + push * wander_x
        bias_y = keep * bias_y + push * wander_y
        bias_z = keep * bias_z + push * wander_z
        drift_x, drift_y, drift_z = drift_x + stride * walk_x, drift_y + stride * walk_y, drift_z + stride * walk_z
        self._bias, self._walk = [bias_x, bias_y, bias_z], [drift_x, drift_y, drift_z]
        return [
            x + bias_x + drift_x + sigma_x * white_x,
            y + bias_y + drift_y + sigma_y * white_y,
            z + bias_z + drift_z + sigma_z * white_z,
        ]

    def get_state(self) -> _NoiseState:
        """Return the state that determines the future errors."""
        return {"random": generator_state(self._random), "bias": list(self._bias), "walk": list(self._walk)}

    def set_state(self, state: _NoiseState) -> None:
        """Restore a state that `get_state` returned."""
        set_generator_state(self._random, state["random"])
        self._bias, self._walk = list(state["bias"]), list(state["walk"])


_ZERO = [0.0, 0.0, 0.0]
_VISUAL = Visual("cube", (0.04, 0.04, 0.02), (0.3, 0.9, 0.6))
#: the g of data sheets, m/s^2
_G = 9.80665


def _has_magnetometer(imu: IMU) -> bool:
    return imu.has_magnetometer


class IMU(MotionSensor):
    """Measures angular velocity and specific force, which is +9.81 m/s^2 along Z at rest on level ground.

    If the IMU is not at the origin of the robot, rotation adds a tangential and a centripetal acceleration. If the
    environment declares its position on the earth (``env.properties(longitude=..., latitude=..., altitude=...)``), the
    IMU also has a magnetometer; see `Magnetometer`.

    It is ideal, unless properties set its errors by the quantities of a data sheet: density of the white noise, in-run
    bias instability, and random walk of the bias (IEEE Std 952-1997, annex C).
    """

    _name = "IMU"
    _short_desc = "An inertial measurement unit returning angular velocity, linear acceleration and magnetic field"
    _source = "specific force; noise in the terms of IEEE Std 952-1997"
    _builder = BuilderDefaults(visual=_VISUAL)
    _products = (
        BuilderDefaults(
            "ADIS16448",
            properties={
                "GyroNoiseDensity": math.radians(0.0135),
                "GyroBiasInstability": math.radians(14.5 / 3600.0),
                "AccelNoiseDensity": 0.23e-3 * _G,
                "AccelBiasInstability": 0.25e-3 * _G,
            },
            visual=_VISUAL,
            doc="An IMU with the noise of an Analog ADIS16448: 0.0135 deg/s/√Hz, 14.5 deg/h; 230 µg/√Hz, 0.25 mg.",
            source="data sheet of the ADIS16448 (Analog Devices); the terms are those of IEEE Std 952-1997",
        ),
        BuilderDefaults(
            "BMI088",
            properties={
                "GyroNoiseDensity": math.radians(0.014),
                "GyroBiasInstability": math.radians(2.0 / 3600.0),
                "AccelNoiseDensity": 160e-6 * _G,
                "AccelNoiseDensityZ": 190e-6 * _G,
            },
            visual=_VISUAL,
            doc="An IMU with the noise of a Bosch BMI088: 0.014 deg/s/√Hz, 2 deg/h; 160 µg/√Hz in X and Y, 190 µg/√Hz "
            "in Z.",
            source="data sheet of the BMI088 (Bosch Sensortec); the terms are those of IEEE Std 952-1997",
        ),
        BuilderDefaults(
            "VN100",
            properties={
                "GyroNoiseDensity": math.radians(0.0035),
                "GyroBiasInstability": math.radians(5.0 / 3600.0),
                "AccelNoiseDensity": 0.14e-3 * _G,
                "AccelBiasInstability": 0.04e-3 * _G,
            },
            visual=_VISUAL,
            doc="An IMU with the noise of a VectorNav VN-100: 0.0035 deg/s/√Hz, 5 deg/h; 140 µg/√Hz, 0.04 mg.",
            source="data sheet of the VN-100 (VectorNav); the terms are those of IEEE Std 952-1997",
        ),
    )

    add_data("angular_velocity", _ZERO, "vec3<float>", "Angular velocity", unit="rad/s", frame="own", shape=3)
    add_data("linear_acceleration", _ZERO, "vec3<float>", "Specific force", unit="m/s^2", frame="own", shape=3)
    add_data(
        "magnetic_field",
        _ZERO,
        "vec3<float>",
        "Magnetic field towards north, east and down, rotated as if these were the axes of the world; 0 if the "
        "environment does not declare its position on the earth",
        unit="nT",
        frame="ned_as_world",
        shape=3,
    )
    add_property(
        "_gyro_density",
        0.0,
        "GyroNoiseDensity",
        "float",
        "White noise of the angular velocity",
        unit="rad/s/√Hz",
        low=0.0,
    )
    add_property(
        "_gyro_instability",
        0.0,
        "GyroBiasInstability",
        "float",
        "In-run bias instability of the angular velocity",
        unit="rad/s",
        low=0.0,
    )
    add_property("_gyro_walk", 0.0, "GyroRandomWalk", "float", "Random walk of the bias", unit="rad/s/√s", low=0.0)
    add_property(
        "_accel_density",
        0.0,
        "AccelNoiseDensity",
        "float",
        "White noise of the specific force",
        unit="m/s^2/√Hz",
        low=0.0,
    )
    add_property(
        "_accel_density_z",
        None,
        "AccelNoiseDensityZ",
        "float",
        "White noise of the specific force along Z; none for that of X and Y",
        unit="m/s^2/√Hz",
        low=0.0,
        allow=("none",),
    )
    add_property(
        "_accel_instability",
        0.0,
        "AccelBiasInstability",
        "float",
        "In-run bias instability of the specific force",
        unit="m/s^2",
        low=0.0,
    )
    add_property("_accel_walk", 0.0, "AccelRandomWalk", "float", "Random walk of the bias", unit="m/s^2/√s", low=0.0)
    add_property(
        "_correlation_time", 100.0, "BiasCorrelationTime", "float", "Correlation time of the biases", unit="s", low=1e-3
    )
    velocity_fields = frozenset(("angular_velocity",))
    add_kind("imu", angular_velocity="angular_velocity", linear_acceleration="linear_acceleration")
    add_kind("magnetic_field", topic="mag", when=_has_magnetometer, field="magnetic_field")

    add_state("_accel_errors", InertialErrors, "Errors of the accelerometer")
    add_state("_gyro_errors", InertialErrors, "Errors of the gyroscope")
    add_state("_measured", float, "Time of the last measurement", unit="s")

    _gyro_density: float
    _gyro_instability: float
    _gyro_walk: float
    _accel_density: float
    _accel_density_z: float | None
    _accel_instability: float
    _accel_walk: float
    _correlation_time: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._measured = self.clock.time
        self.begin_anew()
        self._field = field_around(self) if has_place(self.context.scene.properties) else None

    def begin_anew(self) -> None:
        """Draw the errors at the start."""
        self._gyro_errors = InertialErrors(self.context.random(f"{self.name()}/gyro"), self._gyro_terms())
        self._accel_errors = InertialErrors(self.context.random(f"{self.name()}/accelerometer"), self._accel_terms())

    @property
    def has_magnetometer(self) -> bool:
        """Whether the environment has a magnetic field."""
        return self._field is not None

    def _gyro_terms(self) -> ErrorTerms:
        return ErrorTerms((self._gyro_density,) * 3, self._gyro_instability, self._gyro_walk, self._correlation_time)

    def _accel_terms(self) -> ErrorTerms:
        x, z = self._accel_density, self._accel_density_z
        density = (x, x, x if z is None else z)
        return ErrorTerms(density, self._accel_instability, self._accel_walk, self._correlation_time)

    @property
    def field_changes(self) -> Mapping[str, Mapping[str, object]]:
        """Return the errors of angular velocity and specific force."""
        return {
            "angular_velocity": self._gyro_terms().deviations(self.frequency),
            "linear_acceleration": self._accel_terms().deviations(self.frequency),
        }

    @property
    def _has_gyro_errors(self) -> bool:
        return bool(self._gyro_density or self._gyro_instability or self._gyro_walk)

    @property
    def _has_accel_errors(self) -> bool:
        return bool(self._accel_density or self._accel_density_z or self._accel_instability or self._accel_walk)

    def may_wait(self) -> bool:
        """Return False with errors, which depend on all earlier measurements."""
        return super().may_wait() and not (self._has_gyro_errors or self._has_accel_errors)

    @on_read
    def measure(self) -> None:
        """Measure angular velocity, specific force and magnetic field."""
        motion = self.motion()
        self.local_data.update(self._felt(motion, self.position_3d.get_pose()))
        self._add_errors()

    def _felt(self, motion: Motion, pose: tuple[Sequence[float], Sequence[float]]) -> dict[str, list[float]]:
        """Return the measurement of an ideal sensor."""
        position, rotation = pose
        x, y, z = motion.acceleration
        forces = {
            "angular_velocity": list(turn_back(rotation, motion.angular)),
            "linear_acceleration": list(turn_back(rotation, (x, y, z + self.context.scene.settings.gravity))),
        }
        if self._field is not None:
            forces["magnetic_field"] = list(turn_back(rotation, self._field.north_east_down(position)))
        return forces

    def _add_errors(self) -> None:
        data = self.local_data
        now = data["timestamp"]
        dt, self._measured = now - self._measured, now
        if self._has_gyro_errors:
            self._gyro_errors.terms = self._gyro_terms()
            data["angular_velocity"] = self._gyro_errors.added(data["angular_velocity"], dt)
        if self._has_accel_errors:
            self._accel_errors.terms = self._accel_terms()
            data["linear_acceleration"] = self._accel_errors.added(data["linear_acceleration"], dt)
