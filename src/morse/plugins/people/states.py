"""Saved states of a crowd: arrays, one row for each person, and which values of them are possible."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.state import StateError
from morse.plugins.people.agenda import RECORDED, WORDS
from morse.plugins.people.riding import ON_FOOT

if TYPE_CHECKING:
    from morse.plugins.people.agenda import Agenda
    from morse.plugins.people.gait import Gait
    from morse.plugins.people.plan import Plan
    from morse.plugins.people.riding import Riding
    from morse.plugins.people.walking import Walkers

_PLACES = ("position", "feet", "goal", "ground", "target", "came", "planned")
_NOBODY = "where, or as, nobody can be"


class States:
    """Saves and restores people.

    Args:
        name: of the crowd, for messages.
        walkers, gait, agenda, riding: their arrays.
        plan: of the crowd.
    """

    def __init__(self, name: str, walkers: Walkers, gait: Gait, agenda: Agenda, riding: Riding, plan: Plan) -> None:
        self._name, self._walkers, self._riding, self._plan = name, walkers, riding, plan
        self._owners: tuple[tuple[object, tuple[str, ...]], ...] = (
            (walkers, ("position", "velocity", "free_speed", "group", "present", "planned")),
            (gait, ("phase", "stride", "feet", "heading", "stands", "hip", "goal", "ground")),
            (agenda, ("flow", "stage", "mode", "until", "target", "came", "rank", "alert", "leader")),
            (riding, ("area", "ride", "lift", "slot", "turn", "opened")),
        )

    def get(self) -> dict[str, Any]:
        """Return copies of all arrays by their names, and the ``lag`` of the steps, s."""
        found: dict[str, Any] = {name: getattr(owner, name).copy() for owner, names in self._owners for name in names}
        return found | {"lag": self._walkers.lag}

    def check(self, people: object, trails: object) -> dict[str, Any]:
        """Return the people of a state.

        Args:
            people: of the state.
            trails: of the state, which are possible.

        Raises:
            StateError: they are not those of the scene, or where nobody can be.
        """
        arrays = {name: getattr(owner, name) for owner, names in self._owners for name in names}
        if not isinstance(people, dict) or people.keys() != {*arrays, "lag"}:
            raise StateError(f"the people of {self._name} are missing")
        for name, present in arrays.items():
            given = people[name]
            fits = isinstance(given, np.ndarray) and given.dtype == present.dtype and given.shape == present.shape
            if not fits or not np.isfinite(given).all():
                raise StateError(f"the people of {self._name} have another '{name}'")
        if not self._can_be(people):
            self.refuse()
        leader, most = people["leader"], len(trails) if isinstance(trails, dict) else 0
        if (leader >= most).any() or (leader < -1).any():
            self.refuse()
        return people

    def refuse(self) -> None:
        """Raise the `StateError` of a state that is not possible."""
        raise StateError(f"the people of {self._name} are {_NOBODY}")

    def set(self, people: dict[str, Any]) -> None:
        """Set the people to those of a state that `check` has returned."""
        for owner, names in self._owners:
            for name in names:
                setattr(owner, name, people[name].copy())
        self._walkers.lag = people["lag"]

    def _can_be(self, people: dict[str, Any]) -> bool:
        """Whether the values of a state are possible."""
        flow, stage, group, lag = people["flow"], people["stage"], people["group"], people["lag"]
        stages = np.array([max(len(one["ways"]), 1) for one in self._plan.flows] + [1])
        heading = people["heading"]
        if not all(np.abs(people[name]).max(initial=0.0) < 1e6 for name in _PLACES):
            return False
        # cabins are elsewhere on the plane
        walks = people["present"] & (people["mode"] != RECORDED) & (people["ride"] == ON_FOOT)
        ground = self._plan.ground
        places = (people["position"][walks] - ground.origin) / ground.cell
        on_ground = ((places >= 0.0) & (places <= (ground.shape[1], ground.shape[0]))).all()
        bounds = {
            "mode": (0, len(WORDS) - 1),
            "stride": (0.05, 5.0),
            "free_speed": (0.0, 20.0),
            "alert": (0.0, 1.0),
            "hip": (0.0, 2.0),
        }
        within = all(((low <= people[name]) & (people[name] <= high)).all() for name, (low, high) in bounds.items())
        return bool(
            on_ground
            and within
            and ((flow >= -1) & (flow < len(self._plan.flows))).all()
            and ((stage >= 0) & (stage < stages[flow])).all()
            and ((group >= -1) & (group < len(group))).all()
            and (np.abs(people["rank"]) < 1e9).all()
            and self._riding.can_be(people)
            and (np.abs(heading) < 1.1).all()
            and (np.abs((heading * heading).sum(axis=1) - 1.0) < 1e-6).all()
            and (np.abs(people["velocity"]) < 1e3).all()
            and ((people["phase"] >= 0.0) & (people["phase"] < 1e9)).all()
            and isinstance(lag, float)
            and abs(lag) < 10.0
        )
