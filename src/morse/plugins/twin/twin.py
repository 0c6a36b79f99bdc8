"""A scene and a log of the same robot: how far they are apart, and the parameters with which they are nearest."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest, quoted
from morse.launch.load import described
from morse.plugins.twin.comparison import LONGEST_DELAY, Comparison, align
from morse.plugins.twin.fit import Fit
from morse.plugins.twin.log import Log, read_log, summary
from morse.plugins.twin.manoeuvres import Manoeuvre, propose
from morse.plugins.twin.mapping import Link, links_of, read_table, samples_of, table_text
from morse.plugins.twin.parameters import Parameter, ParameterError, Parameters, preset_text, read_preset
from morse.plugins.twin.replay import Probe, Simulations, probe, without_noise
from morse.plugins.twin.statistics import rms
from morse.simulation.options import RunOptions
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.plugins.twin.comparison import Channel
    from morse.plugins.twin.problem import Result
    from morse.plugins.twin.replay import Samples
    from morse.scene import Scene

#: names of the files of a fit
PAGE, PRESET, TABLE = "twin.html", "preset.json", "mapping.toml"
#: longest log, s: a replay takes about 1 % of it
_LONGEST = 36_000.0
#: how much larger than those of the fit the errors of its test may be
_ROOM = 1.2


class TwinError(MorseError):
    """A log and a scene cannot be compared."""


class Twin:
    """A scene, and a log of the robot that it describes.

    Args:
        log: path of a file in MCAP (of MORSE or ROS 2), a bag of ROS 1 or 2, a log of PX4 (``.ulg``) or ArduPilot
            (``.bin``), or a table (``.csv``).
        scene: a scene as for `morse.load`.
        fit: names of the parameters that are fitted, such as ``robot.mass``, ``imu.bias``; none for a comparison alone.
        table: path of a table in TOML that says which topic is which component; None to find them by type and name.
        preset: path of a file with values of parameters, of an earlier fit.
        arguments: ``sys.argv[1:]`` of a scene script.

    Attributes:
        log: what was read.
        scene: plain data.
        links: the components and their topics.
        unmapped: topics of no component.
        parameters: those that are fitted.

    Raises:
        LogError: the log cannot be read.
        TwinError: the log has no commands for the scene, or no measurement of one of its sensors.
        ParameterError: there is no such parameter, or the log has no measurements of its sensor.
        MappingError: the table is wrong.
        MorseError: the scene cannot be loaded.
    """

    def __init__(
        self,
        log: str | os.PathLike[str],
        scene: str | os.PathLike[str] | Callable[[], object] | Scene,
        *,
        fit: Sequence[str] = (),
        table: str | os.PathLike[str] | None = None,
        preset: str | os.PathLike[str] | None = None,
        arguments: Sequence[str] = (),
    ) -> None:
        if isinstance(fit, str):
            raise TypeError(f"fit is a list of names, such as [{fit!r:.60}]")
        self.log: Log = read_log(log)
        self._source = os.fspath(scene) if isinstance(scene, (str, os.PathLike)) else ""
        self._table, self._preset = table, preset
        self._arguments = list(arguments)
        self.scene = described(scene, RunOptions(arguments=list(arguments)))
        self._probe: Probe = probe(self.scene)
        if preset is not None:
            self.scene = self._all_of(self.scene).scene_of(read_preset(preset))
        self._named = self._all_of(self.scene)
        self._all = self._all_of(without_noise(self.scene))
        robots = [one.name for one in self.scene.robots()]
        if table is not None:
            self.links: list[Link] = read_table(table, self.log, self.scene, self._probe)
            used = {link.topic for link in self.links}
            self.unmapped = [topic for topic in self.log.series if topic not in used]
        else:
            self.links, self.unmapped = links_of(self.log, self.scene, self._probe, robots)
        self._check()
        self.commands: dict[str, Samples] = {}
        measured: dict[str, Samples] = {}
        for link in self.links:
            (self.commands if link.is_command else measured)[link.component] = samples_of(
                link, self.log, self._probe.fields[link.component]
            )
        self.duration = max(float(one.times[-1]) for one in measured.values())
        if self.duration > _LONGEST:
            raise TwinError(self._too_long(measured))
        self._comparison = Comparison.of(measured, self._probe)
        self.parameters = self._found(fit)

    def _all_of(self, scene: Scene) -> Parameters:
        return Parameters(scene, self._probe.wheels, self._probe.fields)

    def _check(self) -> None:
        topics = "; ".join(summary(self.log)[:12])
        components = [one for one in self.scene.components if one.kind in ("actuator", "sensor")]
        mend = f"write a table: morse twin … --map {TABLE}"
        if not any(link.is_command for link in self.links):
            actuators = ", ".join(one.name for one in components if one.kind == "actuator") or "none"
            raise TwinError(
                f"{self.log.path} has no commands for the actuators of the scene ({actuators}): a replay needs what "
                f"the robot was told. The log has {topics}. If one of these has the commands, {mend}"
            )
        if all(link.is_command for link in self.links):
            sensors = ", ".join(one.name for one in components if one.kind == "sensor") or "none"
            raise TwinError(
                f"{self.log.path} has no measurements of the sensors of the scene ({sensors}). The log has {topics}. "
                f"If one of these has them, {mend}"
            )

    def _too_long(self, measured: dict[str, Samples]) -> str:
        name, last = max(measured.items(), key=lambda one: float(one[1].times[-1]))
        gaps = np.diff(last.times, prepend=0.0)
        place = int(np.argmax(gaps))
        text = f"{self.log.path} lasts {self.duration:,.0f} s, more than {_LONGEST:,.0f} s: cut it into parts"
        if gaps[place] > 0.5 * self.duration:
            text += (
                f", or correct its times: {name} has no measurement in the {gaps[place]:,.0f} s before "
                f"{last.times[place]:,.0f} s"
            )
        return text

    def _found(self, names: Sequence[str]) -> list[Parameter]:
        measured = {(channel.sensor, channel.field, channel.item) for channel in self._comparison.channels}
        sensors = {channel.sensor for channel in self._comparison.channels}
        found: dict[str, Parameter] = {}
        for name in names:
            matches = self._named.find([name])
            seen = [
                one
                for one in matches
                if one.correction is None
                or (one.correction.what == "delay" and one.component in sensors)
                or (one.component, one.correction.field, one.correction.item) in measured
            ]
            if not seen:
                raise ParameterError(
                    f"{matches[0].name} cannot be fitted: the log has no measurements of {matches[0].component}"
                    f"{nearest(matches[0].component, sorted(sensors), say='it has those of')}"
                )
            found.update({one.name: one for one in seen})
        return list(found.values())

    def _corrections(self) -> list[Parameter]:
        """The corrections of sensors that the scene has."""
        neutral = {"gain": 1.0}
        return [
            one
            for one in self._named
            if one.correction is not None and one.value != neutral.get(one.correction.what, 0.0)
        ]

    def table(self) -> str:
        """The table of components and topics as TOML, to be corrected."""
        return table_text(self.links, self.unmapped, self.log)

    def fit(
        self, *, workers: int | None = None, manoeuvre: bool = True, progress: Callable[[str], object] | None = None
    ) -> Fitted:
        """Replay the commands, compare, and fit the parameters.

        Args:
            workers: number of processes; by default that of the processors, 0 for this process.
            manoeuvre: whether to propose a manoeuvre if the log does not tell all parameters.
            progress: called with a line about the progress, from time to time.

        Raises:
            FitError, ReplayError: the scene cannot be simulated with the commands.
        """
        if workers is None:
            workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        sensors = {link.component: list(link.sources) for link in self.links if not link.is_command}
        tell = progress or (lambda line: None)
        with Simulations(self._all, [self.commands], sensors, workers) as simulations:
            (traces,) = simulations.each([{}], self.duration)
            align(self._comparison, traces, fitted=self._delayed())
            result = Fit(
                self.parameters, self._comparison, simulations, self.duration, tell, fixed=self._corrections()
            ).run()
        proposal = None
        if manoeuvre and not all(map(result.is_known, range(len(result.parameters)))):
            tell("searches a manoeuvre that tells more")
            most = simulations.seconds
            proposal = propose(result, self._all, self._comparison, self.commands, sensors, self._probe, workers, most)
        return Fitted(self, result, self._comparison, proposal, self._remarks())

    def _delayed(self) -> set[str]:
        """The sensors whose delay, or that of their robot, is fitted."""
        sensors = {channel.sensor for channel in self._comparison.channels}
        late = [one for one in self.parameters if one.name in (f"{one.component}.delay", f"{one.component}.lag")]
        if any(one.correction is None for one in late):
            return sensors
        return sensors & {one.component for one in late}

    def _is_as_late_as_all(self, sensor: str) -> bool:
        """Whether commands that take effect later would explain the times of a sensor: all others are as late."""
        clocks = self._comparison.clocks
        late = clocks[sensor].delay
        # measurements are not before their commands, and no command takes longer
        return 0.0 < late < LONGEST_DELAY and all(
            abs(one.delay - late) < 0.05 for one in clocks.values() if one.correlation > 0.5
        )

    def _remarks(self) -> list[str]:
        remarks = [*self.log.remarks]
        for sensor, clock in self._comparison.clocks.items():
            if clock.is_applied:
                drift = f", and drifts by {1e6 * clock.drift:.0f} µs/s" if clock.drift else ""
                remarks.append(f"the clock of {sensor} is {clock.delay:+.3f} s off{drift}: its times were corrected")
                if not clock.drift and self._is_as_late_as_all(sensor):
                    remarks.append(
                        f"this log cannot tell an offset of the clock of {sensor} from a delay of the commands: no "
                        "sensor is less late. If it is a delay, fit that of the actuator"
                    )
            elif abs(clock.delay) > 0.05 and sensor not in self._delayed():
                remarks.append(
                    f"{sensor} is {clock.delay:+.3f} s later than in the simulation: fit its delay, or a lag"
                )
        return remarks + [f"the topic {quoted(topic)} is that of no component" for topic in self.unmapped]


@dataclass
class Fitted:
    """What a fit has found.

    Attributes:
        twin: the scene and the log.
        result: values, spreads and errors.
        comparison: the measurements.
        manoeuvre: that would tell more, or None.
        remarks: what the user should know.
    """

    twin: Twin
    result: Result
    comparison: Comparison
    manoeuvre: Manoeuvre | None = None
    remarks: list[str] = field(default_factory=list)

    @property
    def values(self) -> dict[str, float]:
        """The values of the parameters that the log tells."""
        return self._of(self.result.values)

    @property
    def spreads(self) -> dict[str, float]:
        """The standard deviations of these values."""
        return self._of(self.result.spreads)

    def _of(self, numbers: np.ndarray) -> dict[str, float]:
        known = [number for number in range(len(self.result.parameters)) if self.result.is_known(number)]
        return {self.result.parameters[number].name: float(numbers[number]) for number in known}

    @property
    def errors(self) -> dict[str, float]:
        """The root mean square of the errors of each number that a sensor measures, after the fit."""
        return self._errors(self.result.after.errors)

    @property
    def errors_before(self) -> dict[str, float]:
        """The same with the values in the scene."""
        return self._errors(self.result.before.errors)

    def _errors(self, errors: Sequence[np.ndarray]) -> dict[str, float]:
        return {one.name: rms(error) for one, error in zip(self.comparison.channels, errors, strict=True)}

    def channel(self, name: str) -> Channel:
        """One of the numbers that sensors measure, by its name."""
        for one in self.comparison.channels:
            if one.name == name:
                return one
        raise KeyError(f"there is no {quoted(name)}{nearest(name, [one.name for one in self.comparison.channels])}")

    def lines(self) -> list[str]:
        """What was found, in words: a line for each parameter, each relation and each remark."""
        lines = []
        for number, one in enumerate(self.result.parameters):
            before, value, spread = (
                float(values[number]) for values in (self.result.start, self.result.values, self.result.spreads)
            )
            unit = f" {one.unit}" if one.unit else ""
            if self.result.is_known(number):
                lines.append(f"{one.name} = {value:.6g} ± {spread:.2g}{unit} (in the scene {before:.6g})")
            else:
                lines.append(f"{one.name} is not known from this log; it stays {before:.6g}{unit}")
        lines += self.result.relations + self.result.remarks
        if self.manoeuvre is not None:
            lines.append(f"a manoeuvre that would tell more: {self.manoeuvre.text}")
        elif not all(map(self.result.is_known, range(len(self.result.parameters)))):
            lines.append("no manoeuvre of these actuators was found that would tell the rest")
        return lines + self.remarks

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def write(
        self,
        *,
        report: str | os.PathLike[str] | None = None,
        preset: str | os.PathLike[str] | None = None,
        test: str | os.PathLike[str] | None = None,
    ) -> None:
        """Write a page, a preset for the scene, and a test that the errors do not grow; those that are given a path.

        Raises:
            OSError: a file cannot be written.
        """
        from morse.plugins.twin.report import page

        if preset is not None:
            facts = {"log": Path(self.twin.log.path).name, "scene": Path(self.twin._source).name}
            write_whole(Path(preset), preset_text(self.values, self.spreads, facts))
        if report is not None:
            write_whole(Path(report), page(self))
        if test is not None:
            write_whole(Path(test), self._test(Path(test), preset))

    def _test(self, path: Path, preset: str | os.PathLike[str] | None) -> str:
        if not self.twin._source:
            raise TwinError("a test needs the path of a scene script: this scene is a function")
        if self.values and preset is None:
            raise TwinError("a test needs the preset: give its path, too")
        here = path.resolve().parent

        def beside(other: str | os.PathLike[str]) -> str:
            try:
                return f"HERE / {os.path.relpath(other, here)!r}"
            except ValueError:  # another drive
                return f"Path({os.fspath(other)!r})"

        more = f", table={beside(self.twin._table)}" if self.twin._table is not None else ""
        more += f", preset={beside(preset)}" if self.values and preset is not None else ""
        more += f", arguments={self.twin._arguments!r}" if self.twin._arguments else ""
        errors = "\n".join(
            f"    {name!r}: {_ROOM * error:.4g}," for name, error in self.errors.items() if math.isfinite(error)
        )
        return _TEST.format(
            log=beside(self.twin.log.path), scene=beside(self.twin._source), more=more, errors=errors, room=_ROOM
        )


_TEST = '''"""The simulation measures what the log has, with errors of at most these; written by morse twin."""

from pathlib import Path

import pytest

from morse.many import Twin

HERE = Path(__file__).resolve().parent
#: root mean squares, {room} times those of the fit
LIMITS = {{
{errors}
}}


@pytest.fixture(scope="module")
def errors():
    return Twin({log}, {scene}{more}).fit(workers=0).errors


@pytest.mark.parametrize("name", LIMITS)
def test_the_simulation_measures_what_the_log_has(errors, name):
    assert errors[name] <= LIMITS[name]
'''
