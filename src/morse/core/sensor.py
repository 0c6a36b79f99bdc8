"""The base class of sensors.

Sensors that only need poses are rows (`morse.core.rows.rows`). Those that a model file declares and that ask
servers for rays or images are `OnDemand`: what nobody reads is neither cast nor rendered.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from morse.core.clients.budgets import LEAST_RATE
from morse.core.declarations import add_data, add_state, data_fields, fields_of_component
from morse.core.declarations.refused import numbers_in
from morse.core.guard import modify
from morse.core.object import Object
from morse.core.realism import measured
from morse.core.reports.quoting import closest
from morse.core.requests import serve
from morse.core.rows.marks import LazyData, is_on_read, is_overridden, known_data, present_data
from morse.core.services import service
from morse.core.streams.extent import check_fields
from morse.core.streams.functions import publish, waiting
from morse.core.validation.fields import spec_of_field
from morse.core.values import Fields, Value
from morse.scene.component import is_numeric

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.core.declarations.fields import DataField
    from morse.core.interfaces import Component
    from morse.core.realism import Noise, Realism
    from morse.core.robot import Robot
    from morse.scene.component import RealismModel

    Pose = tuple[Sequence[float], Sequence[float]]


class WatchedSpace(NamedTuple):
    """A cone around the X axis of a sensor, or a sphere around the sensor.

    Attributes:
        reach: largest distance, metres.
        angle: full opening angle, radians; 2 pi for a sphere.
        seen: names of the objects that the sensor detects now.
    """

    reach: float
    angle: float = 2.0 * math.pi
    seen: tuple[str, ...] = ()


class Sensor(Object):
    """Measures something and publishes it.

    Fill ``local_data`` in `measure`, or in ``default_action`` as in 1.4. Noise and delay are added afterwards, if the
    script declares them. `report` then computes the other fields from the measured fields, so that all fields are
    consistent with the noise.

    Attributes:
        realism: delay and noise, or None for an ideal sensor.
        capturing: whether a camera captures images at present; None for a sensor without images.
        on_demand: whether it measures only while somebody reads it, as sensors of model files do whose rays or images
            cost time.
        watched: whether the live view shows what it measures.
    """

    robot_parent: Robot
    local_data = LazyData()  # an attribute of the sensor has precedence

    add_data("timestamp", 0.0, "float", "Simulated time of the measurement", unit="s")

    add_state("realism", object, "Delay and noise: what was measured and is not published yet")

    realism: Realism | None = None
    on_demand: bool = False
    watched = False
    #: the remedy if ``noise()`` without a field changes no field
    noise_mend: ClassVar[str] = "because the sensor measures no numbers"
    #: fields that cannot have noise, although they are arrays of numbers
    without_noise: ClassVar[tuple[str, ...]] = ()
    #: whether the class overrides `report`
    _reports: ClassVar[bool] = False
    not_state: ClassVar[tuple[str, ...]] = ("observed", "observed_before", "watched")
    #: what `observe` has returned at the time of a measurement that is computed later, and of the measurement before
    observed: Value = None
    observed_before: Value = None

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls._reports = cls.report is not Sensor.report
        cls.acts_in_rows = is_on_read(cls)

    @service(changes=False)
    def get_local_data(self) -> Fields:
        """The present data of the sensor."""
        # clients may ask in each tick: of a sensor on demand, that would be beyond the budget of pixels
        entry = self._in_rows
        if isinstance(entry, OnDemand) and entry.is_fresh():
            return known_data(self)
        return present_data(self)

    def tick_random(self, purpose: str = "") -> np.random.Generator:
        """Return a generator of random numbers that depends only on the seed, this component, the tick and ``purpose``.

        A sensor that draws its noise from it has no state of random numbers: a measurement has the same noise in a
        batch, after a restored state, and whether or not somebody has read the measurements before it.
        """
        return self.context.random_at(f"{self.name()}/{purpose}", self.clock.tick)

    def watched_space(self) -> WatchedSpace | None:
        """The space that the sensor observes, for the live view; None if only its rays are shown."""
        return None

    def observe(self) -> Value:
        """Return what a measurement needs of the present moment besides the pose, such as the hits of rays.

        For a sensor that measures when its data are read, it is called in each tick in which the sensor is due.
        """
        return type(self).observe_all((self,))

    @classmethod
    def observe_all(cls, sensors: Sequence[Value]) -> Value:
        """Return what is the same for some sensors of the class, in place of `observe`: one call for all of them."""

    def observation(self) -> Value:
        """Return the result of `observe` at the time of the measurement."""
        return self.observe() if self.observed is None else self.observed

    def measure(self) -> None:
        """Fill the measured fields of ``local_data`` with the true values; noise is added afterwards."""

    def report(self) -> None:
        """Compute the fields that depend on measured fields (``add_data(..., follows=...)``).

        It is called after noise was added to the measured fields.
        """

    def remember(self) -> None:
        """Take note of the pose of a measurement, for a sensor whose next one depends on it (`morse.core.rows`)."""

    def placed(self) -> None:
        """Called after the robot was placed elsewhere, at rest: the next measurement does not contain this motion."""

    def look_again(self) -> None:
        """Called before a further measurement in the same tick, such as after the robot was placed elsewhere."""

    def rests(self) -> bool:
        """Whether its next actions change nothing but its own pose and time, as long as nobody outside of it acts."""
        is_idle = not self._active or not self.is_wanted()
        return is_idle and type(self).action is Sensor.action and not is_overridden(self)

    def is_wanted(self) -> bool:
        """Whether somebody reads the data: a stream with a reader, a page, a program; always, unless `on_demand`."""
        entry = self._in_rows
        # what nothing holds may be read by anybody
        if not self.on_demand or self._is_read or self.watched or not isinstance(entry, OnDemand) or entry.is_asked:
            return True
        return any((sign := waiting(function)) is None or bool(sign) for function in self.output_functions)

    def default_action(self) -> None:
        """One measurement."""
        self.measure()

    def sensor_setup(self) -> None:
        """Update the pose and the timestamp of a measurement."""
        self.position_3d.update(self.bge_object)
        self.local_data["timestamp"] = self.clock.time

    def action(self) -> None:
        """One measurement: pose, time, `default_action`, `report`, modifiers, streams."""
        if not self._active:
            return
        if self.on_demand:
            entry = self._in_rows or hold_on_demand(self)
            if isinstance(entry, OnDemand):
                entry.act()
                return
        self.act()

    def act(self) -> None:
        """`action` of a sensor that is active and that somebody reads."""
        if self.realism is not None:
            self.realism.act()
            return
        self.position_3d.update(self.bge_object)
        self.local_data["timestamp"] = self.clock.time
        self.default_action()
        if self._reports:
            self.report()
        if self._is_checked:
            check_fields(self)
        if self.output_modifiers and not modify(self, self.output_modifiers):
            return
        if self.output_functions:
            publish(self, self.output_functions)

    def measured_from(self) -> Pose:
        """Return position (3,) in m and rotation (9,), row by row, of the sensor in the world at its measurement."""
        return self.bge_object.world_pose()

    def make_realism(self, model: RealismModel) -> Realism:
        """Return the delay and the noise that the script declares."""
        from morse.core.realism import Realism

        return Realism(self, model)

    # -- noise -----------------------------------------------------------------------------

    def noisy_fields(self) -> tuple[str, ...]:
        """Return the fields that get noise if the script names no fields: all measured numbers and vectors."""
        follow = {name for name, field in data_fields(type(self)).items() if field.follows} | {"timestamp"}
        follow.update(self.without_noise)
        return tuple(name for name, value in self.local_data.items() if name not in follow and is_numeric(value))

    def add_noise(self, field: str, noise: Noise, before: object) -> None:
        """Add errors to a field, within its declared range. A lost value keeps the previous value.

        Args:
            before: value of the field before this measurement.
        """
        value = measured(self.local_data[field], noise)
        self.local_data[field] = before if noise.lost()[0] else value


class OnDemand:
    """Holds the data of a sensor that measures while somebody reads it.

    It measures at its rate while a stream has a reader, a page shows it, or a part of the simulation may have a
    reference to its data. Whoever reads its data at another time gets a measurement of the present moment.

    Attributes:
        is_changed: see `Entry`; not used.
    """

    is_changed = False

    def __init__(self, sensor: Sensor) -> None:
        self._sensor = sensor
        self._data: Fields = {}
        self._tick = -1
        #: whether it measures for a reader that is not a stream
        self.is_asked = False
        self.form()

    def form(self) -> None:
        """Begin to hold the data, unless somebody may have a reference to them."""
        sensor = self._sensor
        own = vars(sensor)
        if sensor.on_demand and not sensor._is_read and "local_data" in own and sensor._in_rows is None:
            self._data = own.pop("local_data")
            sensor._in_rows = self
            self._tick = -1

    def release(self) -> None:
        """Give the sensor its data."""
        sensor = self._sensor
        if sensor._in_rows is self:
            sensor._in_rows = None
            vars(sensor).setdefault("local_data", self._data)

    def is_fresh(self) -> bool:
        """Whether the last measurement for a reader is younger than the interval that the budget of pixels counts."""
        sensor = self._sensor
        clock = sensor.clock
        passed = clock.tick - self._tick
        return self._tick >= 0 and 0 <= passed < clock.frequency / max(sensor.frequency, LEAST_RATE) - 1e-9

    def kept_of(self, _member: Component) -> Fields:
        """Return the data of the last measurement."""
        return self._data

    def data_of(self, _member: Component) -> Fields:
        """Return the data of the present moment if nobody reads the sensor at its rate, else those of its rate."""
        sensor = self._sensor
        if sensor.active and not self.is_asked and not sensor.is_wanted() and self._tick != sensor.clock.tick:
            self._tick = sensor.clock.tick
            self.is_asked = True
            guard = sensor.context.guard
            try:
                serve((sensor,), guard)
                guard.each((sensor,), _act, guard.deactivate)
            finally:
                self.is_asked = False
        return self._data

    def act(self) -> None:
        """Let the sensor measure, if somebody reads it."""
        sensor = self._sensor
        if not sensor.is_wanted():
            return
        own = vars(sensor)
        own.setdefault("local_data", self._data)
        try:
            sensor.act()
        finally:
            if own.get("local_data") is self._data and not sensor._is_read:
                del own["local_data"]


def _act(sensor: Sensor) -> None:
    sensor.action()


def hold_on_demand(sensor: Sensor) -> OnDemand | None:
    """Hold the data of a sensor; None if its class has an action of its own, which would not know of readers."""
    cls = type(sensor)
    # with a delay, who reads it now would get what was measured before
    is_late = sensor.realism is not None and sensor.realism.delay
    is_plain = cls.action is Sensor.action and not is_overridden(sensor) and not is_late
    return OnDemand(sensor) if is_plain and isinstance(getattr(cls, "local_data", None), LazyData) else None


class Misfit(NamedTuple):
    """A data field that does not match its declaration.

    Attributes:
        field: name of the field.
        declared: whether the field is declared at all.
        text: what is wrong, for a message.
    """

    field: str
    declared: bool
    text: str


def misfits(component: Object, is_checked: Callable[[DataField], bool] = lambda field: True) -> Iterator[Misfit]:
    """Yield the fields of ``local_data`` that are not declared, and those of a sensor with another type or range.

    NaN and infinity are not reported.

    Args:
        is_checked: whether the values of a declared field are checked.
    """
    fields = fields_of_component(component)
    for name, value in component.local_data.items():
        if name not in fields:
            # the data of a compound sensor are those of its members
            if name not in component.context.components:
                near = closest(name, fields)
                hint = f"; did you mean '{near}'?" if near is not None else ""
                yield Misfit(name, False, f"it publishes '{name}' without declaring it: add_data('{name}', ...){hint}")
        elif isinstance(component, Sensor) and is_checked(fields[name]):
            try:
                text = _misfit(value, fields[name])
            except RecursionError:
                text = "is nested too deeply, or contains itself"
            except Exception as error:  # values are objects of any class of users, and their methods may fail
                text = f"cannot be read: {type(error).__name__}: {error!s:.80}"
            if text:
                yield Misfit(name, True, f"the data field '{name}' {text}")


def _misfit(value: object, field: DataField) -> str:
    """Return what is wrong with a value; empty if nothing is."""
    if hasattr(value, "__iter__") and not hasattr(value, "__len__"):
        return f"is {value!r:.80}, which can be read only once"
    if isinstance(value, np.ndarray) and value.dtype.kind in "fiub":
        is_finite = bool(np.isfinite(value).all())
    else:
        is_finite = all(map(math.isfinite, numbers_in(value)))
    if not is_finite:
        return ""
    try:
        spec_of_field(field, field.default).check()(value)
    except ValueError as error:
        return f"is {value!r:.80}, expected {error}"
    return ""
