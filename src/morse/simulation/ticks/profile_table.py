"""Displays a profile in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group
from rich.live import Live
from rich.table import Table

from morse.core.reports.printing import console

if TYPE_CHECKING:
    from morse.simulation.ticks.profile import Cost, Profile

_ROWS = 20


def profile_table(profile: Profile) -> Group:
    """Return two tables: phases in order, components by cost; µs per tick and share of the tick."""
    tick = sum(cost.total for cost in profile.phases.values()) or 1e-12
    phases = _table("Phase")
    for name, cost in profile.phases.items():
        if cost.total:
            _row(phases, name, cost, tick, profile.ticks)
    components = _table("Component")
    ranked = sorted(profile.components.items(), key=lambda item: -item[1].total)
    for name, cost in ranked[:_ROWS]:
        _row(components, name, cost, tick, profile.ticks)
    if len(ranked) > _ROWS:
        components.add_row(f"... and {len(ranked) - _ROWS} more")
    return Group(phases, components)


def _table(title: str) -> Table:
    table = Table(title_justify="left")
    table.add_column(title)
    for heading in ("µs a tick", "share", "µs each", "worst µs"):
        table.add_column(heading, justify="right")
    return table


def _row(table: Table, name: str, cost: Cost, tick: float, ticks: int) -> None:
    table.add_row(
        name,
        f"{cost.total / max(ticks, 1) * 1e6:.1f}",
        f"{100 * cost.total / tick:.1f} %",
        f"{cost.mean * 1e6:.1f}",
        f"{cost.worst * 1e6:.0f}",
    )


class LiveProfile:
    """Keeps a table on the terminal up to date; on other outputs, prints it once at the end."""

    def __init__(self, profile: Profile) -> None:
        self._profile = profile
        self._console = console()
        self._live: Live | None = None
        if self._console.is_terminal:
            self._live = Live(
                get_renderable=lambda: profile_table(profile), console=self._console, refresh_per_second=2
            )
            self._live.start()

    def close(self) -> None:
        """Print the final table."""
        if self._live is not None:
            self._live.stop()
        else:
            self._console.print(profile_table(self._profile))
