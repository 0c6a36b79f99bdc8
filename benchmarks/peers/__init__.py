"""The same work in other simulators; each program is independent and needs its simulator installed."""
