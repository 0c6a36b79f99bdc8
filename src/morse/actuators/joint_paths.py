"""Trajectories of dynamic joints, with tolerances as in ``control_msgs/FollowJointTrajectory``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from morse.actuators.dynamic_joints import DynamicJoints
from morse.core import status
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import async_service, interruptible, service
from morse.core.validation.arguments import Range
from morse.core.values import RosMessage
from morse.helpers.components import add_state
from morse.helpers.joint_trajectory import Plan, Trajectory, beyond, plan_of

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.values import Fields
    from morse.core.world import Body
    from morse.helpers.joint_trajectory import Bound
    from morse.scene import Control


_Gain = Annotated[float, Range(0.0, 1e9)]


class JointGains(DynamicJoints):
    """Motors whose gains scripts and clients set."""

    add_state("_gains", dict, "Gains that were set, by joint: stiffness and damping")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._gains: dict[str, list[float | None]] = {}
        settings = obj.node.articulation
        for name, stiffness, damping in settings.gains if settings is not None else ():
            if name in self.joints:
                self._set_gains(name, stiffness, damping)

    @service(changes=False)
    def get_gains(self) -> dict[str, dict[str, float]]:
        """Return the gains of the motors: name to ``stiffness`` (N·m/rad or N/m) and ``damping`` (N·m·s/rad or N·s/m).

        A motor for positions exerts stiffness * (setpoint - position) - damping * velocity, a motor for velocities
        damping * (setpoint - velocity), both up to the largest effort of the joint.
        """
        if self._motors is None:
            return {}
        gains = self._motors.gains(self.joints)
        return {name: {"stiffness": k, "damping": d} for name, (k, d) in zip(self.joints, gains, strict=True)}

    @service
    def set_gains(
        self, stiffness: _Gain | None = None, damping: _Gain | None = None, joints: list[str] | None = None
    ) -> None:
        """Set the gains of motors of dynamic joints; see `get_gains`. They stay when the control mode changes.

        Args:
            stiffness: N·m/rad or N/m, for motors that control a position; None to keep it.
            damping: N·m·s/rad or N·s/m, for motors that control a position or a velocity; None to keep it.
            joints: names of joints; None for all.
        """
        names = list(self.joints if joints is None else joints)
        for name in names:
            self._joint(name)
        if self._motors is None:
            raise MorseRPCInvokationError(
                f"{self.name()}: its joints are not dynamic and have no motors: "
                "set the property Dynamic to True in the script"
            )
        for name in names:
            self._set_gains(name, stiffness, damping)

    def _set_gains(self, name: str, stiffness: float | None, damping: float | None) -> None:
        before = self._gains.get(name, [None, None])
        gains = [before[0] if stiffness is None else stiffness, before[1] if damping is None else damping]
        self._gains[name] = gains
        if self._motors is not None:
            self._motors.set_gains(name, *gains)

    def _set_controls(self, controls: dict[str, Control]) -> None:
        super()._set_controls(controls)
        for name in controls:
            if name in self._gains and self._motors is not None:
                self._motors.set_gains(name, *self._gains[name])


#: what the outcome of a trajectory that has failed begins with: names of error codes of FollowJointTrajectory
PATH_VIOLATED, GOAL_VIOLATED = "PATH_TOLERANCE_VIOLATED", "GOAL_TOLERANCE_VIOLATED"
#: the time of a tick is a sum of fractions, s
_ROUNDING = 1e-9


class JointPaths(JointGains):
    """Moves some or all joints along trajectories; the other joints follow their setpoints."""

    add_state("_trajectory", Trajectory | None, "Trajectory that is followed")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._trajectory: Trajectory | None = None

    def default_action(self) -> None:
        """Move the joints by one tick."""
        if self._trajectory is not None:
            self._advance(self._trajectory)
        super().default_action()

    def _stop(self) -> None:
        if self._trajectory is not None:
            self._hold(self._trajectory)
        super()._stop()

    def _hold(self, trajectory: Trajectory) -> None:
        """End a trajectory at the present setpoints."""
        self._trajectory = None
        for name in trajectory.joints:
            self.local_data[name] = self._values[self.joints.index(name)]

    def _take_over(self, names: list[str]) -> None:
        if self._trajectory is not None and set(self._trajectory.joints) & set(names):
            self.interrupt()
        super()._take_over(names)

    # -- the service -----------------------------------------------------------------------

    def plan(self, trajectory: Fields) -> Plan:
        """Check a trajectory without following it.

        Raises:
            MorseRPCInvokationError: it is invalid, or a motor does not control a position.
        """
        try:
            plan = plan_of(trajectory, self.joints)
        except ValueError as error:
            raise MorseRPCInvokationError(f"{self.name()}: {error}") from None
        self._demand_positions(plan.joints)
        return plan

    @interruptible
    @async_service
    def trajectory(self, trajectory: RosMessage) -> None:
        """Move joints along a trajectory; the service ends at the time of the last point, or when the joints have
        arrived there.

        Between two points with velocities the trajectory is a polynomial of degree 3; with accelerations as well, it is
        of degree 5; otherwise it is a straight line. It starts at the present joint values, at rest. Points in the past
        are ignored. Another trajectory preempts it.

        The service fails, and the joints stop, if a joint is farther from the path than ``path_tolerance``
        (``PATH_TOLERANCE_VIOLATED``), or farther from the last point than ``goal_tolerance`` at
        ``goal_time_tolerance`` after its time (``GOAL_TOLERANCE_VIOLATED``).

        Args:
            trajectory: ``{"starttime": s, "joints": [...], "points": [{"positions": [...], "velocities": [...],
                "accelerations": [...], "time_from_start": s}, ...], "path_tolerance": {joint: rad or m},
                "goal_tolerance": {joint: rad or m}, "goal_time_tolerance": s}``, the numbers in the order of
                ``joints``, by default that of ``get_joints``. All but positions and times are optional. A tolerance is
                a number for all joints, or one for each: a number, or ``{"position": rad or m, "velocity": rad/s or
                m/s}``. Without a time, the joints may take as long as they need to arrive within the tolerance.
        """
        plan = self.plan(trajectory)
        self._take_over(list(plan.joints))
        values = dict(zip(self.joints, self._values, strict=True))
        self._trajectory = Trajectory(plan, self.clock.time, [values[name] for name in plan.joints])

    def _advance(self, trajectory: Trajectory) -> None:
        """Set the setpoints for this tick."""
        now = self.clock.time
        if now < trajectory.start:
            return
        if now < trajectory.end - _ROUNDING:
            if not self._leaves(trajectory, trajectory.tolerances.path, PATH_VIOLATED):
                self.local_data.update(zip(trajectory.joints, trajectory.positions(now), strict=True))
            return
        self.local_data.update(zip(trajectory.joints, trajectory.points[-1].positions, strict=True))
        self._arrive(trajectory, is_late=now >= trajectory.end + trajectory.tolerances.late - _ROUNDING)

    def _arrive(self, trajectory: Trajectory, *, is_late: bool) -> None:
        """End a trajectory whose time is over when the joints have arrived."""
        if self._is_near(trajectory):
            self._trajectory = None
            self._end(status.SUCCESS)
        elif is_late:
            self._leaves(trajectory, trajectory.tolerances.goal, GOAL_VIOLATED)

    def _end(self, outcome: str, text: str | None = None) -> None:
        """End the service, unless the trajectory was restored with a saved state, without its caller."""
        if self.on_completion is not None:
            self.completed(outcome, text)

    def _is_near(self, trajectory: Trajectory) -> bool:
        """Whether the joints have arrived; without tolerances, they have."""
        return not trajectory.tolerances.goal or self._beyond(trajectory, trajectory.tolerances.goal) is None

    def _leaves(self, trajectory: Trajectory, bounds: dict[str, Bound], code: str) -> bool:
        """End the trajectory with an error if a joint is outside of its bound."""
        if not bounds:
            return False
        worst = self._beyond(trajectory, bounds)
        if worst is None:
            return False
        name, quantity, error, tolerance = worst
        self._hold(trajectory)
        where = "the path" if code == PATH_VIOLATED else "the last point"
        text = f"{code}: the {quantity} of '{name}' differs by {error:.3g} from that of {where}, "
        self._end(status.FAILED, f"{text}{tolerance:g} allowed")
        return True

    def _beyond(self, trajectory: Trajectory, bounds: dict[str, Bound]) -> tuple[str, str, float, float] | None:
        setpoints, actual, speeds, present = self._followed(trajectory)
        names = trajectory.joints
        errors = {name: a - b for name, a, b in zip(names, setpoints, actual, strict=True)}
        if present is None:
            return beyond(bounds, errors, None)
        return beyond(bounds, errors, {name: a - b for name, a, b in zip(names, speeds, present, strict=True)})

    def _followed(
        self, trajectory: Trajectory
    ) -> tuple[tuple[float, ...], list[float], tuple[float, ...], list[float] | None]:
        """Return desired and measured positions, and desired and measured velocities, of the joints of a trajectory.

        The joints have been measured at the end of the last tick, to which the desired values belong.
        """
        time = self.clock.time - 1.0 / self.frequency
        places = [self.joints.index(name) for name in trajectory.joints]
        values, velocities = self.joint_values, self.joint_velocities
        return (
            trajectory.positions(time),
            [values[place] for place in places],
            trajectory.velocities(time),
            None if velocities is None else [velocities[place] for place in places],
        )

    def progress(self) -> dict[str, object]:
        """Return the measured joints, the setpoints and their differences; of a trajectory, for its joints."""
        trajectory = self._trajectory
        if trajectory is None:
            return super().progress()
        setpoints, actual, speeds, present = self._followed(trajectory)
        sides: dict[str, dict[str, list[float]]] = {
            "desired": {"positions": list(setpoints), "velocities": list(speeds)},
            "actual": {"positions": actual},
            "error": {"positions": [a - b for a, b in zip(setpoints, actual, strict=True)]},
        }
        if present is not None:
            sides["actual"]["velocities"] = present
            sides["error"]["velocities"] = [a - b for a, b in zip(speeds, present, strict=True)]
        return {"joint_names": list(trajectory.joints), **sides}

    def _steps(self) -> list[float]:
        steps = super()._steps()
        if self._trajectory is None or self.clock.time < self._trajectory.start:
            return steps
        # the path itself limits the speed
        names = set(self._trajectory.joints)
        return [float("inf") if name in names else step for name, step in zip(self.joints, steps, strict=True)]
