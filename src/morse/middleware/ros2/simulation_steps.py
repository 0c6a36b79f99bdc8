"""The action ``simulation_interfaces/SimulateSteps``: ticks of a paused simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.status import FAILED, SUCCESS
from morse.middleware.ros2 import NODE
from morse.middleware.ros2.actions import ActionServer
from morse.rosmsgs.actions import PERIOD

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.request_manager import Outcome
    from morse.rosmsgs.topics.backend import Backend, RosClass, RosObject

#: name of the action below the name of the node
NAME = "simulate_steps"
#: constants of simulation_interfaces/Result
_OK, _INCORRECT_STATE, _FAILED = 1, 3, 4
_NOT_PAUSED = "the simulation is not paused"


def action_type() -> RosClass | None:
    """The class of the action; None if its package is not installed, or does not have it."""
    try:
        from simulation_interfaces.action import SimulateSteps
    except ImportError:
        return None
    action: RosClass = SimulateSteps
    return action


class StepsServer(ActionServer):
    """Serves the action, one goal at a time.

    Args:
        context: of the simulation.
        backend: provides typed services.
        kind: class of the action.
        call: calls a service of MORSE: component, service, arguments, and a callback for the outcome.
        abort: ends a call.
    """

    def __init__(
        self,
        context: Context,
        backend: Backend,
        kind: RosClass,
        call: Callable[..., Any],
        abort: Callable[[Any], object],
    ) -> None:
        self._context, self._call, self._backend = context, call, backend
        self._progress = _Progress(context, lambda fields: backend.filled(kind.Feedback(), fields))
        super().__init__(backend, f"/{NODE}/{NAME}", kind, self._begin_steps, abort, self._progress)

    def accepts(self, goal: RosObject) -> bool:
        """See `ActionServer.accepts`."""
        return not self._progress.is_running

    def arguments(self, goal: RosObject) -> list[object]:
        """See `ActionServer.arguments`."""
        return [int(self.plain(goal)["steps"])]

    def _begin_steps(self, arguments: list[int], ended: Callable[[Outcome], object]) -> Any:
        if not self._context.paused():
            ended((FAILED, _NOT_PAUSED))
            return None

        def over(outcome: Outcome) -> None:
            self._progress.end()
            ended(outcome)

        self._progress.begin(arguments[0])
        return self._call("simulation", "step", arguments, over)

    def result(self, outcome: Outcome, *, is_canceled: bool) -> RosObject:
        """See `ActionServer.result`."""
        state, text = outcome
        code = _OK if state == SUCCESS else _INCORRECT_STATE if text == _NOT_PAUSED else _FAILED
        words = "" if state == SUCCESS else str(text or "the steps were ended")
        result: RosObject = self._backend.filled(
            self.result_class(), {"result": {"result": code, "error_message": words}}
        )
        return result


class _Progress:
    """The feedback of the goal that runs."""

    def __init__(self, context: Context, make: Callable[[dict[str, object]], Any]) -> None:
        self._context, self._make = context, make
        self.is_running = False
        self._first = self._steps = 0
        self._told = -PERIOD

    def begin(self, steps: int) -> None:
        """A goal begins."""
        self.is_running, self._first, self._steps = True, self._context.clock.tick, steps

    def end(self) -> None:
        """It has ended."""
        self.is_running = False

    def is_due(self, stamp: int) -> bool:
        """See `morse.rosmsgs.actions.Feedback.is_due`."""
        if 0 <= stamp - self._told < PERIOD:
            return False
        self._told = stamp
        return True

    def message(self, begun: int, stamp: int) -> Any:
        """See `morse.rosmsgs.actions.Feedback.message`."""
        done = max(0, min(self._context.clock.tick - self._first, self._steps))
        return self._make({"completed_steps": done, "remaining_steps": self._steps - done})
