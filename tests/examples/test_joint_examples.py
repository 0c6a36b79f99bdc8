"""The programs of `examples/joints`, by physics."""

import runpy
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "joints"
GRAVITY = 9.81

pytestmark = pytest.mark.long


def run(name: str, *arguments: str) -> Any:
    return runpy.run_path(str(FOLDER / name))["main"](*arguments)


def test_a_dog_trots(tmp_path: Path) -> None:
    way, lowest, tilt, weight = run("trot.py", str(tmp_path / "dog.webp"))
    assert way > 1.0, "in 10 s"
    assert lowest > 0.2, "the trunk is 5.5 cm thick below its middle"
    assert tilt < 0.5
    # the masses of its file: trunk, head, four legs
    assert weight == pytest.approx((5.6 + 0.3 + 4 * (0.15 + 0.45 + 0.12 + 0.05)) * GRAVITY, rel=1e-3)
    assert (tmp_path / "dog.webp").stat().st_size > 1000


def test_an_arm_picks_a_box_and_weighs_it() -> None:
    place, height, weight = run("pick.py")
    assert place == pytest.approx((0.3, -0.3, 0.025), abs=0.01)
    assert height == pytest.approx(0.2, abs=0.02)
    assert weight == pytest.approx(0.3 * GRAVITY, rel=0.01)


def test_a_hand_holds_a_ball() -> None:
    lifted, slip, load = run("hold.py")
    assert lifted > 0.2
    assert abs(slip) < 1e-3
    # what the ball does to the fingers
    assert load == pytest.approx(-0.1 * GRAVITY, rel=0.01)


def test_a_humanoid_is_pushed_and_stands_again(tmp_path: Path) -> None:
    results = run("stand.py", str(tmp_path / "stand.webp"))
    start = results[0][3]
    for farthest, left, tilt, height in results[1:]:
        # the speed after the push, and the inverted pendulum without feet, would take it farther than its feet are long
        assert 0.03 < farthest < 0.11
        assert left < 0.02, "it is back at its place"
        assert tilt < 0.05
        assert height == pytest.approx(start, abs=0.01)
    assert (tmp_path / "stand.webp").stat().st_size > 1000


def test_without_its_ankles_the_humanoid_falls() -> None:
    main = runpy.run_path(str(FOLDER / "stand.py"))["main"]
    main.__globals__["ANKLE"] = 0.0
    _, (_, _, tilt, height) = main(None, [(-70.0, 0.0)])
    assert tilt > 1.0
    assert height < 0.3


def test_the_first_lines_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    root = FOLDER.parents[1]
    monkeypatch.chdir(root)
    block = (root / "docs" / "joints.md").read_text(encoding="utf-8").split("```")[1].removeprefix("python\n")
    look = "place = next(one for one in sim.world.objects() if one.node.plain_name == 'hand').world_pose()[0]"
    names: dict[str, Any] = {}
    exec(block.replace("sim.step(60)", f"sim.step(60)\n    {look}"), names)
    assert names["place"] == pytest.approx((0.4, 0.1, 0.2), abs=1e-3)
