"""What components do for the first time in a tick: each is loaded in a process of its own and observed.

Run as a program: ``first_uses.py NAME...``; prints a line of JSON per name: the name, and the events in its ticks.
"""

import json
import linecache
import os
import sys
from typing import Any

_FILES = ("import", "open")
_EVENTS = (*_FILES, "compile", "exec")
_TICKS = 61


class Watch:
    """An audit hook that collects events while it is on."""

    def __init__(self) -> None:
        self.on = False
        self.events: list[str] = []
        self.events_of = _EVENTS
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self.on and event in self.events_of:
            self.on = False
            what = arguments[0] if event != "exec" else arguments[0].co_filename
            import traceback

            where = [f"{f.filename.rpartition('/')[2]}:{f.lineno}" for f in traceback.extract_stack()[-9:-1]]
            self.events.append(f"{event} {what!r:.120} at {' '.join(where)}")
            self.on = True


def _observe(name: str, watch: Watch) -> list[str]:
    from morse.verification.contract.contract_world import LogCapture, set_up
    from morse.verification.contract.subjects import subjects

    (subject,) = subjects(name)
    with LogCapture() as said, set_up(subject, said) as stand:
        simulation = stand.simulation
        component = stand.component
        linecache.getlines(__file__)  # as of a component
        before = set(sys.modules)
        watch.on = True
        simulation.step(_TICKS)
        # the program that calls a service evaluates its annotations, without descriptors
        watch.events_of = _FILES
        simulation.rpc(stand.name, "get_properties")
        simulation.step(1)
        # an error of a component
        watch.events_of = _EVENTS
        component.default_action = lambda: [].missing  # type: ignore[attr-defined]
        component.active = True
        simulation.step(_TICKS)
        watch.on = False
        new = sorted(set(sys.modules) - before)
    return watch.events + [f"module {module}" for module in new]


def main(names: list[str]) -> None:
    """Observe components, one after the other."""
    import morse.launch.load  # noqa: F401 (as for all simulations)

    for name in names:
        child = os.fork()
        if not child:
            try:
                events = _observe(name, Watch())
            except BaseException as error:
                events = [f"{type(error).__name__}: {error}"]
            print(json.dumps([name, events]), flush=True)
            os._exit(0)
        os.waitpid(child, 0)


if __name__ == "__main__":
    main(sys.argv[1:])
