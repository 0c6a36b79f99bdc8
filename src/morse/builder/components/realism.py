"""Phase, delay and noise of sensors."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder.errors import checks
from morse.core import declarations
from morse.core.exceptions import MorseBuilderError
from morse.scene.realism import NoiseModel, RealismModel, is_numeric

if TYPE_CHECKING:
    from morse.core.values import Options


class RealisticSensor:
    """The part of the builder class of a sensor that sets phase, delay and noise.

    All errors depend only on the seed of the scene and the name of the sensor: other robots in the scene do not change
    them.
    """

    _realism = RealismModel()

    if TYPE_CHECKING:

        def component_class(self) -> type | None:
            """The class that runs."""

    def phase(self, seconds: float) -> None:
        """Set the time of the first measurement after the start, simulated seconds."""
        what = f"{type(self).__name__}.phase(seconds)"
        self._realism = replace(self._realism, phase=checks.number(seconds, what, minimum=0.0))

    def delay(self, seconds: float) -> None:
        """Set the time from a measurement until its data are published, simulated seconds.

        The time stamp is the time of the measurement.
        """
        what = f"{type(self).__name__}.delay(seconds)"
        self._realism = replace(self._realism, delay=checks.number(seconds, what, minimum=0.0))

    def noise(
        self,
        gaussian: float = 0.0,
        bias_walk: float = 0.0,
        quantization: float = 0.0,
        dropout: float = 0.0,
        field: str | None = None,
    ) -> None:
        """Add noise; call it again for other fields.

        Args:
            gaussian: standard deviation of white noise, in the unit of the field.
            bias_walk: standard deviation of the bias after one second.
            quantization: step of the values.
            dropout: probability, 0..1, that a value is lost. A lost value is replaced by the previous value; a lost
                beam of a scanner has no echo.
            field: a data field; None for all fields that are numbers or vectors (for a scanner, the distances; the
                points are computed from them).

        Raises:
            TypeError: a value is not a number.
            ValueError: a number that is negative or not finite.
            MorseBuilderError: the sensor has no such field, or the field is not numeric.
        """
        what = type(self).__name__ + ".noise"
        models = {"gaussian": gaussian, "bias_walk": bias_walk, "quantization": quantization, "dropout": dropout}
        values = {name: checks.number(value, f"{what}({name})", minimum=0.0) for name, value in models.items()}
        if values["dropout"] > 1.0:
            raise ValueError(f"{what}(dropout) takes a probability from 0 to 1, got {dropout:g}")
        if field is not None:
            self._check_field(checks.text(field, f"{what}(field)"), what)
        noise = {**self._realism.noise, field or "": NoiseModel(**values)}
        self._realism = replace(self._realism, noise=noise)

    def _check_field(self, field: str, what: str) -> None:
        cls = self.component_class()
        fields = {} if cls is None else declarations.data_fields(cls)
        measurements = {name: entry for name, entry in fields.items() if name != "timestamp" and not entry.follows}
        without = getattr(cls, "without_noise", ())
        names = [name for name, entry in measurements.items() if is_numeric(entry.default) and name not in without]
        if field in names or (cls is None):
            return
        if field in fields and fields[field].follows:
            followed = ", ".join(map(repr, fields[field].follows))
            raise MorseBuilderError(f"{what}(field): '{field}' is computed from {followed}, which can have noise")
        if field in fields:
            raise MorseBuilderError(
                f"{what}(field): '{field}' is not a measured number{checks.suggestion(field, names)}"
            )
        raise MorseBuilderError(
            f"{what}(field): {type(self).__name__} has no data field '{field}'{checks.suggestion(field, names)}"
        )

    def _scene_options(self) -> Options:
        """The part of the declaration that depends on the kind of component."""
        return {} if self._realism == RealismModel() else {"realism": self._realism}
