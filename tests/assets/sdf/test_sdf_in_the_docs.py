"""The lines for SDF files in the chapter on models work as they stand there."""

import re
from pathlib import Path

import pytest
import test_sdf_plugins as plugins
import test_sdf_worlds as worlds

import morse

CHAPTER = Path(__file__).parents[3] / "docs" / "models.md"


def test_the_lines_of_the_chapter_load_and_stand(tmp_path) -> None:
    text = CHAPTER.read_text().split("\n## SDF\n")[1].split("\n## ")[0]
    lines = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0]
    assert len(lines.strip().splitlines()) <= 5
    worlds.model(tmp_path / "my_models", "cart", plugins.CART)
    worlds.model(tmp_path / "my_models", "table", worlds.CRATE)
    (tmp_path / "my_worlds").mkdir()
    (tmp_path / "my_worlds" / "warehouse.sdf").write_text(
        f'<sdf version="1.9"><world name="w">{worlds.GROUND}</world></sdf>'
    )
    lines = lines.replace("env =", "table.translate(x=3.0, z=0.5)\npose = Pose()\nrobot.append(pose)\nenv =")
    (tmp_path / "scene.py").write_text(f"from morse.builder import *\n{lines}")
    with morse.load(tmp_path / "scene.py") as simulation:
        simulation.step(180)
        assert simulation.robot.pose.get()["z"] == pytest.approx(0.0, abs=5e-3)
        assert "motion" in dir(simulation.robot)


def test_a_sensor_of_a_file_that_cannot_work_is_left_out(tmp_path, caplog) -> None:
    text = plugins.CART.replace('<link name="left">', '<link name="left"><sensor name="m" type="magnetometer"/>')
    text = text.replace('<link name="right">', '<link name="right"><sensor name="b" type="air_pressure"/>')
    (tmp_path / "cart.sdf").write_text(text)
    (tmp_path / "scene.py").write_text(
        "from morse.builder import *\nrobot = Robot('cart.sdf')\nrobot.translate(z=0.01)\nenv = Environment('empty')\n"
    )
    with morse.load(tmp_path / "scene.py") as simulation:
        simulation.step(10)
        assert simulation.robot.b.get()["pressure"] == pytest.approx(101325.0, rel=1e-3)
    (line,) = (record.message for record in caplog.records if "left out: sensor 'robot.m'" in record.message)
    assert "\n" not in line
    # with a place on the Earth, it works
    script = tmp_path / "scene.py"
    script.write_text(script.read_text() + "env.properties(longitude=8.5, latitude=47.5, altitude=400.0)\n")
    with morse.load(script) as simulation:
        simulation.step(10)
        # the field points downwards in the north, with some 45,000 nT in Europe
        assert 40_000.0 < simulation.robot.m.get()["z"] < 50_000.0
