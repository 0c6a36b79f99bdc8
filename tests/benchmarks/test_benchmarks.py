"""The work of the benchmarks has known results, and every benchmark runs and checks them."""

import math
from pathlib import Path
from xml.etree import ElementTree

import pytest

from benchmarks import report, work
from benchmarks.__main__ import SUITES
from benchmarks.plan import Plan
from benchmarks.plot import draw, speed_lines
from benchmarks.result import Result, at_least, at_most, failure
from benchmarks.suites.circles import check_planar, check_wheels
from benchmarks.trial import Program, TrialFailed, interleave

ROOT = Path(__file__).parents[2]
QUICK = Plan(quick=True, repeats=1)
#: one that compares programs, and one of MORSE alone
EVERYDAY = ("lockstep", "crowd")


# the work -----------------------------------------------------------------------------------


def test_the_circle_closes_and_has_its_radius() -> None:
    start = (1.0, 2.0, 0.0)
    around = math.tau / work.RATE
    assert work.on_circle(start, around)[:2] == pytest.approx(start[:2])
    x, y, yaw = work.on_circle(start, around / 2)
    assert (x, y) == pytest.approx((1.0, 2.0 + 2 * work.SPEED / work.RATE))
    assert yaw == pytest.approx(math.pi)


def test_the_speed_along_the_circle_is_that_of_the_command() -> None:
    start, step = (0.3, -0.2, 0.7), 1e-6
    here, there = work.on_circle(start, 2.0), work.on_circle(start, 2.0 + step)
    assert math.dist(here[:2], there[:2]) / step == pytest.approx(work.SPEED, rel=1e-6)
    assert math.atan2(there[1] - here[1], there[0] - here[0]) == pytest.approx(here[2], abs=1e-5)


def test_robots_start_apart_from_each_other_and_from_the_boxes() -> None:
    places = [pose[:2] for pose in work.starts(100)]
    assert min(math.dist(a, b) for i, a in enumerate(places) for b in places[:i]) == pytest.approx(work.SPACING)
    reach = math.hypot(*work.BOX[:2]) / 2 + work.RADIUS + 2 * work.SPEED / work.RATE
    assert all(math.dist(a, box[:2]) > work.RADIUS for a in places for box in work.boxes())
    assert all(math.dist((0.0, 0.0), box[:2]) > reach for box in work.boxes())


def test_a_scan_in_the_middle_sees_the_walls_where_they_are() -> None:
    ranges = work.scan((0.0, 0.0, 0.0), [])
    wall = work.SIZE / 2
    assert len(ranges) == work.SCAN_RAYS
    # to the right, ahead and to the left there is no box on the axis
    for beam, angle in ((0, -90), (90, 0), (180, 90)):
        assert ranges[beam] <= wall, angle
    assert max(ranges) <= math.hypot(wall, wall)


def test_a_scan_sees_another_robot_from_its_surface_on() -> None:
    ranges = work.scan((0.0, 0.0, 0.0), [(2.0, 0.0, 0.0)])
    assert ranges[90] == pytest.approx(2.0 - work.RADIUS)
    beside = math.degrees(math.asin(work.RADIUS / 2.0))
    assert ranges[90 + math.ceil(beside)] > 2.0


def test_a_turned_robot_scans_the_same_turned() -> None:
    straight = work.scan((0.5, 0.2, 0.0), [])
    turned = work.scan((0.5, 0.2, math.radians(10)), [])
    assert turned[:-10] == pytest.approx(straight[10:])


def test_a_panorama_sees_the_floor_where_it_looks_down() -> None:
    down = work.PANORAMA_VIEW / 2
    to_floor = work.PANORAMA_HEIGHT / math.sin(down)
    rays = work.panorama_rays()
    assert len(rays) == work.PANORAMA_ROWS * work.PANORAMA_COLUMNS
    ranges = work.panorama((0.0, 0.0, 0.0), every=work.PANORAMA_COLUMNS)
    assert len(ranges) == work.PANORAMA_ROWS
    assert ranges[0] == pytest.approx(to_floor)
    upward = [rays[-1][2], math.sin(down)]
    assert upward[0] == pytest.approx(upward[1])


def test_wheels_turn_as_the_command_asks() -> None:
    left, right = work.wheel_speeds()
    assert (left + right) / 2 * work.WHEEL_RADIUS == pytest.approx(work.SPEED)
    assert (right - left) * work.WHEEL_RADIUS / work.TRACK == pytest.approx(work.RATE)


# targets ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "wrong",
    [
        {"position_error_m": 0.5},
        {"position_error_m": math.nan},
        {"scan_error_m": 0.1},
        {"scan_bad_share": 0.3},
    ],
)
def test_wrong_work_counts_for_nothing(wrong: dict[str, float]) -> None:
    good = {"position_error_m": 1e-3, "scan_error_m": 1e-6, "scan_bad_share": 0.0, "seconds": 1.0}
    assert check_planar(good) is None
    assert check_planar({**good, **wrong}) is not None


def test_wheels_may_slip_but_not_spin() -> None:
    assert check_wheels({"position_error_m": 0.1, "seconds": 10.0}) is None
    assert check_wheels({"position_error_m": 2.0, "seconds": 10.0}) is not None


def test_a_program_that_breaks_down_fails_with_what_it_said() -> None:
    program = Program("morse", "benchmarks.programs.circles", ("--n", "many"))
    with pytest.raises(TrialFailed, match="invalid int value: 'many'"):
        interleave([program], 1)


def test_another_simulator_that_breaks_down_is_left_out_and_the_line_says_so() -> None:
    good = Program("imports", "benchmarks.programs.imports", ("pymorse",))
    broken = Program("other", "benchmarks.programs.circles", ("--n", "many"), is_optional=True)
    trials = interleave([good, broken], 2)
    assert len(trials["imports"].records) == 2
    assert "invalid int value: 'many'" in trials["other"].trouble
    result = Result("W1", "1 robot", 0.7, "x bare loop", left_out={"other": trials["other"].trouble})
    (cells,) = [line for line in report.markdown([result], QUICK).splitlines() if "| W1 |" in line]
    assert "other left out (" in cells
    assert "invalid int value: 'many') |" in cells


def test_a_program_that_needs_a_missing_package_is_not_installed() -> None:
    assert not Program("none", "benchmarks.peers.none", needs="no_such_package_at_all").is_installed
    assert Program("morse", "benchmarks.programs.circles", needs="numpy").is_installed


def test_values_are_held_to_what_is_wanted() -> None:
    assert Result("b", "c", 0.6, "x", at_least(0.5)).is_good is True
    assert Result("b", "c", 0.6, "x", at_most(0.5)).is_good is False
    assert Result("b", "c", 0.6, "x").is_good is None


# pictures -----------------------------------------------------------------------------------


def test_depths_are_taken_evenly_and_what_is_too_far_is_nothing() -> None:
    # a plane that gets farther to the right, by a metre a column
    depths = [[float(column + 1) for column in range(160)] for _ in range(120)]
    grid = work.depth_grid(depths)
    assert grid[:4] == [6.0, 16.0, 26.0, 36.0]
    assert grid[12:16] == [0.0] * 4
    assert len(grid) == 16 * 12


def test_pictures_that_differ_are_found_out() -> None:
    assert work.depth_disagreement([1.0, 2.0, 0.0, 4.0], [1.001, 2.0, 0.0, 4.5]) == 0.25
    assert work.depth_disagreement([1.0], [1.0, 2.0]) == 1.0


# the plot -----------------------------------------------------------------------------------


def test_the_plot_has_a_line_for_each_simulator() -> None:
    def result(n: int, sensors: str) -> Result:
        details = {"morse": 300.0 / n, "count": n, "sensors": sensors}
        return Result("W1", "", 1.0, "x", peers={"bare <loop>": 500.0 / n}, details=details)

    # other work is not a point of the same line
    lines = speed_lines([*(result(n, "scan") for n in (10, 1, 100)), result(1000, "pose")])
    assert lines["morse"] == [(1, 300.0), (10, 30.0), (100, 3.0)]
    picture = ElementTree.fromstring(draw(lines))
    assert len(picture.findall("{http://www.w3.org/2000/svg}polyline")) == 2


def test_nothing_to_draw_is_told() -> None:
    with pytest.raises(ValueError, match="nothing to plot"):
        draw({})


# a short run of everything ------------------------------------------------------------------


@pytest.mark.timeout(1800)  # a machine may have other work
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in EVERYDAY else pytest.mark.slow) for name in SUITES]
)
def test_every_benchmark_runs_and_does_its_work(name: str) -> None:
    results = list(SUITES[name](QUICK))
    assert results
    assert not [f"{result.case}: {result.trouble}" for result in results if result.failed]
    assert all(result.value is not None and math.isfinite(result.value) for result in results)


def test_the_table_for_a_page_says_what_the_one_on_the_screen_says() -> None:
    results = [
        Result("W1", "10 robots, scan", 0.84, "x bare loop", at_least(0.8), {"mujoco": 115.2}, {"morse": 96.8}),
        Result("W6", "sockets", 0.3, "x bare loop", at_least(0.5)),
        failure("W3", "a | b", "it broke down"),
    ]
    head, _, first, second, third, *rest = report.markdown(results, Plan(repeats=5)).splitlines()
    assert head.count("|") == first.count("|") == 7
    assert [cell.strip() for cell in first.split("|")[1:-1]] == [
        "W1",
        "10 robots, scan",
        ">= 0.8",
        "0.84 x bare loop",
        "ok",
        "morse 96.8, mujoco 115",
    ]
    assert "short" in second
    assert r"a \| b" in third
    assert "FAILED" in third
    assert "it broke down" in third
    assert "Medians of 5" in rest[-1]
