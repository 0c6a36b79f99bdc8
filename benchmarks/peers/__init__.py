"""The same work by other simulators; each program stands on its own and needs its simulator installed."""
