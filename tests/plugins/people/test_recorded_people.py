"""People of recorded trajectories: the formats of the data sets, mistakes in their files, and how they walk."""

import json

import numpy as np
import pytest

import morse
from morse.plugins.people.recorded import Tracks, TrajectoryError, read

#: two people at 1.25 m/s along X and at 1 m/s against it, in rows 0.4 s apart
POINTS = [(k, person, x, y) for k in range(12) for person, x, y in ((1, 0.5 * k, 1.0), (7, 8.0 - 0.4 * k, 2.0))]
OBSMAT = "\n".join(f"{780 + 6 * k:.7e}  {p:.7e}  {x:.7e}  0  {y:.7e}  0  0  0" for k, p, x, y in POINTS)
ROWS = "\n".join(f"{10 * k}\t{p}\t{x}\t{y}" for k, p, x, y in POINTS)
PETRACK = "# framerate: 25\n# id frame x/m y/m z/m\n" + "\n".join(f"{p} {10 * k} {x} {y} 1.7" for k, p, x, y in POINTS)
TIMES = "id,time,x,y\n" + "\n".join(f"{p},{0.4 * k + 3.0},{x},{y}" for k, p, x, y in POINTS)
FRAMES = "frame, id, x, y\n" + "\n".join(f"{k},{p},{x},{y}" for k, p, x, y in POINTS)
TRAJNET = "\n".join(
    [json.dumps({"scene": {"id": 0, "p": 1, "s": 0, "e": 110, "fps": 2.5, "tag": [1, []]}})]
    + [json.dumps({"track": {"f": 10 * k, "p": p, "x": x, "y": y}}) for k, p, x, y in POINTS]
)


@pytest.mark.parametrize(
    "text",
    [OBSMAT, ROWS, ROWS.replace("\t", ","), PETRACK, TIMES, FRAMES, TRAJNET, "\ufeff" + ROWS.replace("\n", "\r\n")],
)
def test_the_formats_say_the_same(text):
    one, other = read(text.encode(), "file.txt")
    assert one == pytest.approx(np.array([(0.4 * k, 0.5 * k, 1.0) for k in range(12)]))
    assert other == pytest.approx(np.array([(0.4 * k, 8.0 - 0.4 * k, 2.0) for k in range(12)]))


def test_a_rate_is_that_of_the_frames():
    one, _ = read(ROWS.encode(), "file.txt", rate=25.0)
    assert one[1] == pytest.approx([0.4, 0.5, 1.0])
    one, _ = read(ROWS.encode(), "file.txt", rate=50.0)
    assert one[1] == pytest.approx([0.2, 0.5, 1.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no trajectories"),
        ("# nothing", "has no trajectories"),
        ("1 2 3", "file:1: expected 'frame id x y'"),
        ("0 1 0 0\n10 1 x 0", "file:2: expected"),
        ("0 1 0 0\n10 1 nan 0", "file:2: .*no place"),
        ("0 1 0 0\n10 1 1e300 0", "file:2: .*no place"),
        ("0 1 0 0\ninf 1 0 0", "file:2: .*no place"),
        ("0 1e400 0 0", "file:1: expected"),
        ("0 1 0 0\n10 1 900 0", "file:2: somebody walks at 2250 m/s: are the places in m"),
        ("0 1 0 0\n0 2 1 0", "nobody with two points"),
        ("a,b,c\n1,2,3", "expected the columns id, x, y"),
        ("id,time,x,y\n1,2,3", "file:2: expected id, time, x, y"),
        ("id,time,x,y\n1,2,3,four", "file:2: expected"),
        ('{"track": 5}', "file:1: expected"),
        ('{"track": {"f": 1}}', "file:1: expected"),
        ("{" * 5000, "file:1: expected"),
        ('{"scene": {"fps": []}}', "file:1: expected"),
        *(
            (TRAJNET.replace('"fps": 2.5', f'"fps": {fps}'), "frames in a second: expected 0.001 to 1e")
            for fps in ("0", "-2.5", "NaN", "Infinity", "1e-320", "1e308", '"nan"')
        ),
        (PETRACK.replace("rate: 25", "rate: 0.0000001"), "frames in a second: expected 0.001 to 1e"),
        ("id,time,x,y\n1,-1e9,0,0\n1,0,0,0\n1,1e-12,1,0", "file:[34]: a point at 1e.09 s"),
        ("id,time,x,y\n1,-1e9,0,0\n1,0,0,0\n1,1e-12,0,0", "file:[34]: a point at 1e.09 s"),
        ("id,time,x,y\n1,0,0," + "4" * 200_000, "file:2: field larger"),
        ("id,time,x,y," + "a" * 200_000, "file:1: field larger"),
        ('{"scene": {}}', "nobody with two points"),
        (b"\xff\xfe\x00", "is no text"),
        ("\n".join(f"{k} {p} 0 0" for k in (0, 1) for p in range(5001)), "5001 people: at most 5000"),
        ("\n".join(f"{k} 1 0 0" for k in range(500_001)), "500001 points: at most"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_a_file_that_makes_no_sense_is_refused_with_its_line(text, message):
    with pytest.raises(TrajectoryError, match=message):
        read(text if isinstance(text, bytes) else text.encode(), "file")


def test_people_come_through_all_points_with_continuous_velocities():
    random = np.random.default_rng(1)
    track = [[0.4 * k, *np.cumsum(random.normal(0, 0.3, (9, 2)), axis=0)[k]] for k in range(9)]
    tracks = Tracks([track, [[1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]])
    for time, x, y in track:
        assert tracks.at(time).position[0] == pytest.approx((x, y), abs=1e-12)
    step = 1e-4
    for time, _, _ in track[1:-1]:
        a, b, c = (tracks.at(time + shift).position[0] for shift in (-step, 0.0, step))
        assert (b - a) / step == pytest.approx((c - b) / step, abs=0.01)
    assert [tracks.at(time).present.tolist() for time in (0.5, 1.5, 3.0, 9.0)] == [
        [True, False],
        [True, True],
        [True, False],
        [False, False],
    ]


SCENE = """
from morse.builder import *
crowd = Crowd("people", recorded="walks.txt", repeat=6.0)
robot = FakeRobot("robot")
robot.translate(4, -2)
scan = Hokuyo("scan")
scan.translate(z=0.3)
robot.append(scan)
Environment("empty")
"""


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "walks.txt").write_text(ROWS, "utf-8")
    path = tmp_path / "scene.py"
    path.write_text(SCENE, "utf-8")
    return path


def test_they_walk_as_recorded_and_are_seen_by_lidars(scene):
    with morse.load(scene) as sim:
        for _ in range(5):
            sim.step(40)
            time = sim.context.clock.time
            data = sim.people.data
            assert data["positions"][0] == pytest.approx((1.25 * time, 1.0, 0.0), abs=1e-9)
            assert data["velocities"][:, 0] == pytest.approx([1.25, -1.0])
            assert data["present"].all()
            ranges = np.array(sim.robot.scan.get()["range_list"])
            gaps = np.hypot(*(data["positions"][:, :2] - (4.0, -2.0)).T)
            assert ranges.min() == pytest.approx(gaps.min(), abs=0.5)
        assert sim.people.ask(0).result()["state"] == "recorded"
        sim.step(90)
        assert not sim.people.data["present"].any()
        sim.step(120)
        assert sim.people.data["present"].all()


def test_a_restored_state_goes_on_with_the_same_bits(scene):
    with morse.load(scene) as sim:
        sim.step(50)
        state = sim.save()
        sim.step(330)
        digest = sim.state_hash()
        sim.restore(state)
        sim.step(330)
        assert sim.state_hash() == digest


@pytest.mark.parametrize("call", [("stop",), ("send", 0, 1.0, 1.0), ("call", 1.0, 1.0), ("resume",)])
def test_they_obey_nobody(scene, call):
    with morse.load(scene) as sim, pytest.raises(Exception, match="follows recorded trajectories"):
        getattr(sim.people, call[0])(*call[1:]).result()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('crowd = Crowd("people", recorded="nothing.txt")', r"scene\.py:3: .*nothing\.txt"),
        ('crowd = Crowd("people", recorded=".")', r"scene\.py:3: "),
        ('crowd = Crowd("people", recorded="walks.txt", rate=0)', r"scene\.py:3: .*rate"),
        ('crowd = Crowd("people", recorded="walks.txt", rate=1000)', r"scene\.py:3: .*somebody walks at"),
        ('crowd = Crowd("people", recorded="walks.txt")\ncrowd.start([(0, 0), (9, 9)])', r"scene\.py:4: .*begin where"),
        (
            "crowd = Crowd('people')\ncrowd.scene_node.properties['Plan'] = '{\"tracks\": [[1, 2]]}'",
            "people: the trajectories are no",
        ),
        (
            "crowd = Crowd('people')\ncrowd.scene_node.properties['Plan'] = '{\"tracks\": [[[0, 1, 2], [0, 1, 2]]]}'",
            "people: the times of a trajectory increase",
        ),
    ],
)
def test_a_script_is_told(scene, line, message):
    scene.write_text(f"from morse.builder import *\n\n{line}\nEnvironment('empty')\n", "utf-8")
    with pytest.raises(Exception, match=message):
        morse.load(scene)
