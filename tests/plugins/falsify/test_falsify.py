"""Falsification of whole scenarios, whose failures are known from kinematics; resumption, and what goes wrong."""

import errno
import json
import os
import signal
import subprocess
import sys
import xml.etree.ElementTree
from concurrent.futures import ProcessPoolExecutor

import pytest

from morse.many import Scenario, read_scenario, uniform
from morse.many.sources import imported
from morse.plugins.falsify import command as falsify_command
from morse.plugins.falsify.campaign import kinds_of
from morse.plugins.falsify.expressions import RequirementError
from tests.kit.programs import python
from tests.kit.waiting import wait_until

pytestmark = pytest.mark.long

#: a robot drives for 1 s, which is v m, and turns away from a wall that it believes at a distance
SCENE = """
import os, time
from morse.many import Scenario, choice, uniform

def scene():
    from morse.builder import Environment, MotionVW, Pose, Robot
    robot = Robot(name="robot")
    for part in (MotionVW("motion"), Pose("pose")):
        robot.append(part)
    Environment("empty")
"""
DRIVE = '''
GAIN = 1.0

def run(sim, speed=0.5, load=0.0, floor="dry"):
    sim.robot.motion.publish({"v": GAIN * speed * (1.0 + load if floor == "wet" else 1.0)})
    sim.step(60)
    return {"x": sim.robot.pose.data["x"]}

scenario = Scenario(
    scene, run, speed=uniform(0.1, 2.0), load=uniform(0.0, 0.4), floor=choice("dry", "wet"), seed=range(20)
)
scenario.always("robot.pose.x < 1.2")
'''  # fmt: skip


@pytest.fixture
def script(tmp_path):
    """Writes a file with a scenario, and returns the scenario."""

    def write(text, name="driving"):
        file = tmp_path / f"{name}.py"
        file.write_text(SCENE + text)
        return read_scenario(file)

    return write


def test_the_smallest_case_is_at_the_boundary_and_everything_is_written(script, tmp_path):
    found = script(DRIVE).falsify(tmp_path / "r", runs=400, workers=2)
    (failure,) = found.failures
    assert failure is found.smallest
    # x = v t: the robot is at 1.2 m after 1 s with 1.2 m/s
    assert (failure.parameters["load"], failure.parameters["floor"], failure.parameters["seed"]) == (0.0, "dry", 0)
    assert 1.15 < failure.parameters["speed"] < 1.25
    boundary = failure.boundaries["speed"]
    assert boundary.passes < boundary.fails <= boundary.passes + 0.02
    assert failure.repeats is True
    assert failure.runs > 1
    assert "robot.pose.x < 1.2: violated at 1.00 s, by 0.0" in failure.what[0]
    folder = tmp_path / "r"
    assert (folder / failure.recording).stat().st_size > 0
    assert b"<html" in (folder / failure.page).read_bytes()[:2000].lower()
    page = (folder / "report.html").read_text()
    assert "<svg" in page
    assert "robot.pose.x &lt; 1.2" in page
    assert len((folder / "runs.csv").read_text().splitlines()) == 1 + len(found.rows)
    suite = xml.etree.ElementTree.parse(folder / "junit.xml").getroot()
    assert (suite.get("tests"), suite.get("failures")) == ("1", "1")
    # the scene has no noise; loads count on wet floors alone
    assert [remark[:34] for remark in found.remarks] == ["the parameter 'seed' has no effect"]


def test_its_test_fails_until_the_software_is_mended(script, tmp_path):
    script(DRIVE).falsify(tmp_path / "r", runs=400, workers=0)
    words = ("-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path / "r"))
    broken = python(*words, folder=tmp_path)
    assert broken.returncode == 1
    assert "robot.pose.x < 1.2: violated" in broken.stdout
    (tmp_path / "driving.py").write_text(SCENE + DRIVE.replace("GAIN = 1.0", "GAIN = 0.4"))
    mended = python(*words, folder=tmp_path)
    assert mended.returncode == 0, mended.stdout


#: the same, which never fails
SAFE = DRIVE.replace('"robot.pose.x < 1.2"', '"robot.pose.x < 5"')


def test_it_continues_after_the_death_of_its_process(script, tmp_path):
    script(SAFE)
    words = ["falsify", str(tmp_path / "driving.py"), "-o", str(tmp_path / "r"), "--workers", "2"]
    program = [sys.executable, "-m", "morse", *words]
    rows = tmp_path / "r" / "rows.jsonl"
    with subprocess.Popen([*program, "--budget", "600"], stderr=subprocess.DEVNULL) as first:
        wait_until(lambda: rows.is_file() and rows.read_bytes().count(b"\n") >= 8, 60)
        os.kill(first.pid, signal.SIGKILL)
        first.wait()
    names = [json.loads(line)["run"] for line in rows.read_text().splitlines() if line.endswith("}")]
    done = subprocess.run([*program, "--runs", str(len(names) + 10)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    after = [json.loads(line)["run"] for line in rows.read_text().splitlines()]
    assert set(names) <= set(after)
    assert len(set(after)) == len(after), "a run was done twice"
    assert len(after) >= len(names) + 5


def test_results_of_another_scenario_are_not_mixed_with_these(script, tmp_path):
    script(DRIVE).falsify(tmp_path / "r", runs=3, workers=0)
    with pytest.raises(ValueError, match=r"r contains results of 'driving.py', not of other.py: use another folder"):
        script(DRIVE, "other").falsify(tmp_path / "r", runs=3, workers=0)
    (tmp_path / "r" / "scenario.json").write_text("{" * 9)
    with pytest.raises(ValueError, match=r"scenario.json is damaged"):
        script(DRIVE).falsify(tmp_path / "r", runs=3, workers=0)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('scenario.always("robt.pose.x < 1")', "'robt.pose.x': the scene has no robot 'robt'; did you mean 'robot'?"),
        ('scenario.always("robot.pos.x < 1")', "'robot.pos.x': robot has no 'pos'; did you mean 'pose'?"),
        ('scenario.always("robot.pose.xx < 1")', "robot.pose has no 'xx'"),
        ('scenario.always("robot.pose < 1")', "'robot.pose' is a component: name one of its fields"),
        ('scenario.always("xx < 1")', "the run returns no 'xx'; did you mean 'x'?"),
        ('scenario.eventually(lambda sim: "soon")', "returned 'soon', expected True, False"),
        ('scenario.always("word > 1")', "'word' is 'y', expected a number"),
    ],
)
def test_a_requirement_that_cannot_be_judged_is_named_with_its_line(script, tmp_path, line, message):
    text = DRIVE.replace('"x": sim', '"word": "y", "x": sim')
    scenario = script(text + line)
    with pytest.raises(RequirementError) as caught:
        scenario.falsify(tmp_path / "r", runs=5, workers=0)
    assert message in str(caught.value)
    number = (SCENE + text).count("\n") + 1
    assert f"driving.py:{number}" in str(caught.value)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('scenario.always("robot.pose.x <")', "is not an expression of Python"),
        ('scenario.always("open(1) < 2")', "calls 'open', which requirements do not know"),
        (
            'scenario.always("robot.pose.x < x")',
            "mixes robot.pose.x, which has a value in each tick, with the result 'x'",
        ),
        ('scenario.always("robot.pose.x < 1.2")', "there is a requirement 'robot.pose.x < 1.2' already"),
        ("scenario.always(3)", "a requirement is a text or a function, not 3"),
        ('scenario.eventually("x > 1", within=-1)', "within is a time in seconds"),
        ("Scenario(scene, run, sped=uniform(0.0, 1.0))", "no one uses the parameter 'sped'; did you mean 'speed'?"),
        ("Scenario(scene, run, speed=range(0))", "the parameter 'speed' has no values"),
        ("Scenario(scene, run, speed=uniform(3, 1))", "uniform: two finite limits, the lower one first"),
        ("Scenario(scene)", "either a function of a simulation, run, or a duration"),
        ("Scenario(scene, run, defaults={'sped': 1})", "there is no parameter 'sped'"),
        ("Scenario(scene, run, speed=uniform(0.0, 0.2))", "the default 0.5 of 'speed' is not from 0 to 0.2"),
        ("scenario.signal('1x', 'robot.pose.x')", "a signal cannot be called '1x'"),
        ("scenario.signal('d', 'robot.pose.x >')", "is not an expression of Python"),
    ],
)
def test_a_scenario_without_sense_is_refused_with_its_line(script, tmp_path, line, message):
    with pytest.raises(RequirementError) as caught:
        script(DRIVE + line)
    assert message in str(caught.value)
    number = (SCENE + DRIVE).count("\n") + 1
    assert f"line {number}" in str(caught.value)


def test_what_a_search_does_not_take(script, tmp_path):
    scenario = script(DRIVE)
    for arguments, message in (
        ({"budget": -1.0}, "budget is a wall-clock time"),
        ({"budget": float("nan")}, "budget is a wall-clock time"),
        ({"runs": 0}, "runs is a number of runs"),
        ({"search": "guidd"}, "there is no search 'guidd'; did you mean 'guided'?"),
        ({"workers": -2}, "workers is a number of processes"),
    ):
        with pytest.raises(ValueError, match=message):
            scenario.falsify(tmp_path / "r", **arguments)
    with pytest.raises(ValueError, match="the scenario requires nothing"):
        script(DRIVE.partition("scenario.always")[0], "nothing").falsify(tmp_path / "r2")
    with pytest.raises(RequirementError, match=r"there is no file .*drivin.py; did you mean 'driving.py'"):
        read_scenario(tmp_path / "drivin.py")


def test_what_the_user_has_to_know(script, tmp_path):
    text = """
def run(sim, speed=0.5, colour=0.0):
    sim.robot.motion.publish({"v": speed})
    sim.step(6)
    return {"quotient": float("nan") if speed > 1.0 else 1.0}

scenario = Scenario(scene, run, speed=uniform(0.1, 2.0), colour=uniform(0.0, 1.0))
scenario.always("robot.pose.x < -1", name="never")
scenario.always("quotient > 0")
"""
    found = script(text).falsify(tmp_path / "r", runs=30, workers=0)
    remarks = "\n".join(found.remarks)
    assert "with the default parameters already, this fails: never: violated at 0.02 s, by 1" in remarks
    assert remarks.count("with the default parameters already") == 1
    assert f"'never' holds in none of {len(found.rows)} runs: is it what you mean?" in remarks
    assert "'quotient > 0' is not a number in " in remarks
    assert "the parameter 'colour' has no effect" in remarks
    assert "the parameter 'speed'" not in remarks
    quotient = next(failure for failure in found.failures if failure.kind == "quotient > 0")
    assert 1.0 < quotient.parameters["speed"] <= 1.02
    assert "quotient > 0: violated, it is not a number" in quotient.what


def test_kinds_of_failures_are_told_apart(script, tmp_path):
    text = """
def run(sim, speed=0.0):
    sim.robot.motion.publish({"v": speed})
    sim.step(60)
    x = sim.robot.pose.data["x"]
    if speed > 1.8:
        raise RuntimeError(f"the motor has burnt at {x:.2f} m")
    return {"hit": "right wall" if x > 1.0 else "left wall" if x < -1.0 else "", "distance": 1.0 - abs(x)}

scenario = Scenario(scene, run, speed=uniform(-2.0, 2.0))
scenario.always("distance > 0")
"""
    found = script(text).falsify(tmp_path / "r", runs=120, workers=0, whole_budget=True)
    smallest = {failure.kind: failure.parameters["speed"] for failure in found.failures}
    assert set(smallest) == {
        "distance > 0 (hit=right wall)",
        "distance > 0 (hit=left wall)",
        "RuntimeError: the motor has burnt at # m",
    }
    assert smallest["distance > 0 (hit=right wall)"] == pytest.approx(1.0, abs=0.05)
    assert smallest["distance > 0 (hit=left wall)"] == pytest.approx(-1.0, abs=0.05)
    assert smallest["RuntimeError: the motor has burnt at # m"] == pytest.approx(1.8, abs=0.05)
    burnt = next(failure for failure in found.failures if failure.kind.startswith("RuntimeError"))
    assert "driving.py" in burnt.what[0]


def test_texts_that_differ_in_each_run_are_not_a_thousand_kinds(script, tmp_path, monkeypatch):
    monkeypatch.setattr("morse.plugins.falsify.report._MOST_PAGES", 0)
    text = DRIVE.replace('return {"x"', 'return {"at": str(speed), "x"').replace("speed=0.5", "speed=1.5")
    text = text.replace("uniform(0.1, 2.0)", "uniform(1.3, 2.0)")
    scenario = script(text + 'scenario.always("x < 0.0")\n')
    found = scenario.falsify(tmp_path / "r", runs=40, whole_budget=True, workers=0)
    assert 20 <= len(found.failures) <= 21
    assert {one.kind.partition(" (")[0] for one in found.failures} == {"robot.pose.x < 1.2", "x < 0.0"}
    assert any("failed in other ways than the first 20: they are in the table alone" in one for one in found.remarks)


def test_a_run_that_returns_everything_is_refused(script, tmp_path):
    scenario = script(DRIVE.replace('return {"x"', 'return {"all": [0.0] * 100_000, "x"'))
    with pytest.raises(
        RequirementError, match=r"returns [\d,]+ characters, more than 65,536.*write the rest to a file"
    ):
        scenario.falsify(tmp_path / "r", runs=40, workers=0)


@pytest.mark.parametrize("name", ["error", "requirements", "seed"])
def test_a_result_of_the_name_of_a_column_is_no_failure_of_the_software(script, tmp_path, name):
    scenario = script(DRIVE.replace('return {"x"', f'return {{"{name}": 1.0, "x"'))
    with pytest.raises(RequirementError, match=f"a result cannot be called '{name}'"):
        scenario.falsify(tmp_path / "r", runs=40, workers=0)


def test_a_controller_that_hangs_is_a_failure(script, tmp_path):
    text = """
def run(sim, speed=0.0):
    while speed > 1.5:
        pass
    sim.step()

scenario = Scenario(scene, run, speed=uniform(0.0, 2.0), timeout=0.5)
scenario.always("robot.pose.z < 5")
"""
    found = script(text).falsify(tmp_path / "r", runs=4, workers=0)
    (failure,) = found.failures
    assert failure.kind.startswith("RunTimeout: the run has taken longer than # s")
    assert failure.parameters["speed"] == pytest.approx(1.5, abs=0.05)


def test_something_has_to_happen_in_time(script, tmp_path):
    text = """
def run(sim, speed=2.0):
    sim.robot.motion.publish({"v": speed})
    sim.step(120)

scenario = Scenario(scene, run, speed=uniform(0.5, 2.0))
scenario.eventually("robot.pose.x > 1", within=1.0)
"""
    found = script(text).falsify(tmp_path / "r", runs=60, workers=0)
    assert found.smallest.kind == "eventually robot.pose.x > 1 within 1 s"
    # it is at 1 m after 1 s with 1 m/s
    assert found.smallest.parameters["speed"] == pytest.approx(1.0, abs=0.05)


def test_a_formula_of_temporal_logic(script, tmp_path):
    pytest.importorskip("rtamt")
    text = """
def run(sim, speed=0.2):
    sim.robot.motion.publish({"v": speed})
    sim.step(60)
    sim.robot.motion.publish({"v": -speed})
    sim.step(60)

scenario = Scenario(scene, run, speed=uniform(0.1, 3.0))
scenario.signal("d", "1.5 - robot.pose.x")
scenario.require("always[0:2] ((d < 0.5) implies (eventually[0:1] (d > 0.6)))")
scenario.require("always (robot.pose.x < 2)", name="near")
"""
    found = script(text).falsify(tmp_path / "r", runs=80, workers=0)
    smallest = {failure.kind: failure.parameters["speed"] for failure in found.failures}
    assert smallest["near"] == pytest.approx(2.0, abs=0.06)
    # a formula is judged as a whole: no tick of the run is that of its violation
    near = next(failure for failure in found.failures if failure.kind == "near")
    assert near.what[-1].startswith("near: violated, by ")
    assert len(smallest) == 2
    other = next(speed for kind, speed in smallest.items() if kind != "near")
    # from 1 m on it has to be back at 0.9 m within 1 s: it is at v (2 - t) then
    assert 1.0 <= other <= 2.1
    with pytest.raises(RequirementError, match=r"wrong.py:\d+: rtamt refuses 'always \[ d'"):
        script(text + 'scenario.require("always [ d")', "wrong").falsify(tmp_path / "w", runs=2, workers=0)
    with pytest.raises(RequirementError, match=r"there is no signal and no result 'dd'"):
        script(text + 'scenario.require("always (dd > 1)")', "other").falsify(tmp_path / "o", runs=2, workers=0)


def test_failures_that_the_last_runs_find_become_plain_too(script, tmp_path):
    text = """
def run(sim, speed=0.2, colour=0.0):
    sim.robot.motion.publish({"v": speed})
    sim.step(60)
    x = sim.robot.pose.data["x"]
    return {"distance": abs(x - 1.2) - 0.3, "hit": ""}

scenario = Scenario(scene, run, speed=uniform(0.1, 2.0), colour=uniform(0.0, 1.0))
scenario.always("distance > 0")
"""
    # the ends pass: what fails lies between, where it is tried whether the colour has an effect
    (failure,) = script(text).falsify(tmp_path / "r", runs=1, workers=0).failures
    assert failure.kind == "distance > 0"
    assert failure.parameters == {"speed": pytest.approx(0.9, abs=0.02), "colour": 0.0, "seed": 0}
    assert failure.boundaries["speed"].passes < 0.9


def test_nothing_is_run_after_ctrl_c(script, tmp_path):
    done = []

    def interrupt(line):
        done.append(int(line.split()[0]))
        raise KeyboardInterrupt

    found = script(SAFE).falsify(tmp_path / "r", workers=0, progress=interrupt)
    assert len(found.rows) == done[0]
    assert found.remarks == ["the search was interrupted: the same call continues"]


def test_a_scene_that_cannot_be_loaded_is_told_with_its_line(tmp_path):
    file = tmp_path / "driving.py"
    file.write_text(SCENE.replace("Robot\n", "Robott\n") + DRIVE)
    with pytest.raises(RequirementError, match=r"driving.py:6: there is no 'Robott' in 'morse.builder'") as told:
        read_scenario(file).falsify(tmp_path / "r", runs=2, workers=0)
    assert "script.py" not in str(told.value)


def test_a_case_that_does_not_repeat_is_told_with_both_recordings(script, tmp_path):
    text = """
import itertools
COUNT = itertools.count()

def run(sim, speed=0.2):
    sim.robot.motion.publish({"v": speed + 1e-3 * next(COUNT)})
    sim.step(6)

scenario = Scenario(scene, run, speed=uniform(0.1, 3.0))
scenario.always("robot.pose.x < 0.2")
"""
    found = script(text).falsify(tmp_path / "r", runs=40, workers=0)
    assert found.smallest.repeats is False
    assert "a case does not repeat" in "\n".join(found.remarks)
    for recording in (found.smallest.recording, found.smallest.others):
        assert (tmp_path / "r" / recording).stat().st_size > 0
    assert "it does not repeat" in (tmp_path / "r" / "report.html").read_text()


def test_few_cases_are_all_tried(script, tmp_path):
    text = """
def run(sim, speed=0.2):
    sim.robot.motion.publish({"v": speed})
    sim.step(6)

scenario = Scenario(scene, run, speed=[0.2, 0.4, 0.6], seed=[1, 2])
scenario.always("robot.pose.x < 2")
"""
    found = script(text).falsify(tmp_path / "r", workers=0)
    assert found.is_complete
    assert len(found.rows) == 6
    assert not found.failures
    assert str(found) == "no failure in 6 runs"
    with pytest.raises(LookupError, match="nothing has failed in 6 runs"):
        print(found.smallest)
    assert not list((tmp_path / "r").glob("test_*.py"))


def test_a_scenario_without_parameters_is_one_run(tmp_path):
    scenario = Scenario(imported_scene(tmp_path), duration=0.5)
    scenario.always("robot.pose.x < 2")
    assert len(scenario.falsify(tmp_path / "r", workers=0).rows) == 1


def imported_scene(tmp_path):
    file = tmp_path / "scene.py"
    file.write_text(SCENE)
    return imported(str(file)).scene


def test_functions_and_a_scenario_of_another_function(tmp_path):
    """A scenario that only this process has; requirements as functions."""

    def run(sim, speed=0.5):
        sim.robot.motion.publish({"v": speed})
        sim.step(60)
        return {"x": sim.robot.pose.data["x"]}

    scenario = Scenario(imported_scene(tmp_path), run, speed=uniform(0.1, 2.0))
    scenario.always(lambda sim: 1.0 - sim.robot.pose.data["x"], name="near")
    scenario.always(lambda results: results["x"] < 1.5, name="not far")
    found = scenario.falsify(tmp_path / "r", runs=80, workers=2)
    smallest = {failure.kind: failure.parameters["speed"] for failure in found.failures}
    assert smallest["near"] == pytest.approx(1.0, abs=0.03)
    assert smallest["not far"] == pytest.approx(1.5, abs=0.03)


def test_any_executor_does_the_runs(script, tmp_path):
    with ProcessPoolExecutor(1) as executor:
        found = script(DRIVE).falsify(tmp_path / "r", runs=60, executor=executor)
    assert found.smallest.parameters["speed"] == pytest.approx(1.2, abs=0.05)


def test_a_folder_that_cannot_be_made_is_told(script, tmp_path):
    script(DRIVE)
    (tmp_path / "file").write_text("")
    with pytest.raises(falsify_command.FalsifyError) as info:
        falsify_command.command(str(tmp_path / "driving.py"), tmp_path / "file" / "results", runs=3, workers=0)
    text = str(info.value)
    assert text.startswith("the results cannot be written: ")
    assert "give another folder by -o" in text
    assert "\n" not in text
    assert "is kept" not in text


def test_the_command(script, tmp_path):
    script(DRIVE)
    done = python("-m", "morse", "falsify", "driving.py", "-o", "r", "--runs", "60", folder=tmp_path)
    assert done.returncode == 3, done.stderr
    assert "robot.pose.x < 1.2: fails with speed=1." in done.stdout
    assert "speed: passes at 1.1" in done.stdout or "speed: passes at 1.2" in done.stdout
    assert "morse replay r/recordings/" in done.stdout
    wrong = python("-m", "morse", "falsify", "drivin.py", "-o", "r", folder=tmp_path)
    assert wrong.returncode == 1
    assert "there is no file drivin.py; did you mean 'driving.py'?" in wrong.stderr
    assert "Traceback" not in wrong.stderr
    # a script that begins its search itself is one for the command, too
    with open(tmp_path / "driving.py", "a") as file:
        file.write('\nfound = scenario.falsify("own", runs=3)\nprint(len(found.rows))\n')
    own = python("driving.py", folder=tmp_path)
    assert (own.returncode, own.stderr) == (0, ""), own.stderr
    assert int(own.stdout) >= 3
    assert python("-m", "morse", "falsify", "driving.py", "-o", "r2", "--runs", "3", folder=tmp_path).returncode in (
        0,
        3,
    )


def test_a_full_disk_is_said(script, tmp_path, monkeypatch):
    script(DRIVE)

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("morse.many.results.Ledger.add", full)
    with pytest.raises(falsify_command.FalsifyError, match=r"(?s)No space left on device.*the same command continues"):
        falsify_command.command(str(tmp_path / "driving.py"), tmp_path / "r", runs=3, workers=0)


def test_files_of_a_folder_are_data(script, tmp_path):
    """Names of requirements and texts of results are foreign text in pages, tests and XML."""
    text = (
        """
def run(sim, speed=0.2):
    sim.robot.motion.publish({"v": speed})
    sim.step(6)
    return {"hit": "</script><script>alert(1)</script>\\x1b[31m\\n"""
        + "'" * 3
        + '''"}

scenario = Scenario(scene, run, speed=uniform(0.1, 3.0))
scenario.always("robot.pose.x < 0.2", name='"""\\nimport os\\nos.abort()\\n<script>\\x00')
'''
    )
    found = script(text).falsify(tmp_path / "r", runs=30, workers=0)
    assert found.failures
    page = (tmp_path / "r" / "report.html").read_text()
    assert "<script" not in page
    xml.etree.ElementTree.parse(tmp_path / "r" / "junit.xml")
    (test,) = (tmp_path / "r").glob("test_*.py")
    done = python("-m", "pytest", "-q", "-p", "no:cacheprovider", str(test), folder=tmp_path)
    assert done.returncode == 1, done.stdout
    assert "1 failed" in done.stdout
    # what a user has written beside is kept, and nothing is written through a link
    own, outside = tmp_path / "r" / "test_own.py", tmp_path / "outside.txt"
    own.write_text("# mine")
    outside.write_text("outside")
    (tmp_path / "r" / "report.html").unlink()
    (tmp_path / "r" / "report.html").symlink_to(outside)
    script(text).falsify(tmp_path / "r", runs=30, workers=0)
    assert own.read_text() == "# mine"
    assert outside.read_text() == "outside"


def test_names_of_packages_in_many():
    import morse.many

    assert morse.many.Scenario is Scenario
    with pytest.raises(ImportError, match="cannot import name 'Scenari'"):
        exec("from morse.many import Scenari")
    with pytest.raises(AttributeError, match=r"module 'morse.many' has no attribute 'Scenari'"):
        print(morse.many.Scenari)


def test_an_error_with_the_address_of_an_object_is_one_kind():
    errors = [f"TypeError: <object at {address}> is no number" for address in ("0x7fed59774030", "0x55c1a0be91f0")]
    assert kinds_of({"error": errors[0]}) == kinds_of({"error": errors[1]})
