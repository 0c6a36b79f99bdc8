"""The simulation of a sweep on a cluster."""

from benchmarks.programs.cluster import PROCESSORS, Sweep, simulate


def test_without_failures_the_processors_work_nearly_all_the_time():
    done = simulate(Sweep(20_000, 20.0, 1, 0.0))
    assert done["lost"] == 0.0
    assert done["ideal"] < done["wall"] < 1.1 * done["ideal"]
    # the speeds differ around that of one processor
    assert 0.3 < done["ideal"] * PROCESSORS / (20_000 * 20.0) < 3.0


def test_what_a_failed_node_has_lost_is_done_again():
    good, bad = (simulate(Sweep(5_000, 20.0, 2, failures)) for failures in (0.0, 20.0))
    assert bad["packs"] > good["packs"]
    assert bad["lost"] > 0.0
    assert bad["wall"] > good["wall"]


def test_packs_relieve_the_driver():
    packed, single = (simulate(Sweep(50_000, 0.01, 2, 0.0, packed=packed)) for packed in (True, False))
    # 1.25 ms for each of 50,000 messages
    assert single["wall"] > 62.0
    assert packed["wall"] < single["wall"] / 3
