"""A simulation that is restarted repeatedly."""

import pytest
from victims import Victim
from wire import Footprint

from tests.kit.programs import Line

pytestmark = pytest.mark.skipif(not Footprint.possible(), reason="the system does not tell")


def reset(victim: Victim, times: int, *, before: int = 500) -> None:
    """Reset a simulation; ``before`` times first, until its memory has grown to its maximum."""
    services = Line(victim.port, timeout=120.0)
    pose = Line(victim.streams["anna.pose"])
    services.call("simulation", "pause")
    footprint = Footprint(victim.process.pid)

    def once(seed: int) -> bytes:
        services.call("simulation", "reset", seed)
        services.call("simulation", "step", 2)
        pose.read()
        return pose.read()

    for seed in range(before):
        first = once(seed)
    memory, descriptors = footprint.memory, footprint.descriptors
    for seed in range(times):
        assert once(seed) == first  # nothing is random here
    assert footprint.descriptors == descriptors
    assert footprint.memory < 1.02 * memory
    services.call("simulation", "resume")
    services.close()
    pose.close()


def test_resets_leave_nothing_behind(victim: Victim) -> None:
    reset(victim, 100, before=200)


@pytest.mark.soak
def test_two_thousand_resets_leave_nothing_behind(victim: Victim) -> None:
    reset(victim, 2000)
