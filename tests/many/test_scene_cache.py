"""Runs that use a compiled scene again have the data of runs that load it anew, whatever earlier runs have done."""

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from morse.many import scenes as module
from morse.many.run import run_once
from morse.many.scenes import SceneCache
from morse.many.study import Study
from tests.kit.effort import examples
from tests.many.many_scenes import crowded_arena


def room(lamp=1.0):
    """A robot with an arm and a lamp, and one on wheels with a scanner, beside a crate."""
    from morse.builder import (
        ATRV,
        Cube,
        Environment,
        KukaLWR,
        Light,
        MotionVW,
        MotionVWDiff,
        Odometry,
        Pose,
        SegwayRMP400,
        Sick,
    )  # fmt: skip

    robot = ATRV("robot")
    light = Light("lamp")
    light.properties(energy=lamp)
    odometry = Odometry("odometry")
    odometry.alter("Noise", pos_std=0.1)
    for part in (MotionVW("motion"), Pose("pose"), light, KukaLWR("arm"), odometry):
        robot.append(part)
    other = SegwayRMP400("other")
    other.translate(0.0, 3.0, 0.1)
    for part in (MotionVWDiff("motion"), Sick("laser")):
        other.append(part)
    crate = Cube("Crate")
    crate.scale, crate.location = (0.2, 0.4, 0.3), (1.5, 0.0, 0.3)
    crate._bpy_object.game.physics_type = "RIGID_BODY"
    Environment("empty")


def _subscribe(sim):
    sim.robot.pose.subscribe(lambda data: sim.robot.motion.publish({"v": -1.0}))


def _observe(sim):
    sim.before_physics(lambda: sim.context.components["robot.motion"].local_data.update(w=1.0))


def _fail(sim):
    raise ValueError("as it has to be")


def _paint_behind(sim):
    for node in sim.scene.nodes():
        node.color = (0.0, 0.5, 0.0, 1.0)


ACTS = {
    "nothing": lambda sim: None,
    "drive": lambda sim: sim.robot.motion.publish({"v": 2.0, "w": 0.2}),
    "contacts": lambda sim: sim.robot.contacts(),
    "subscribe": _subscribe,
    "observe": _observe,
    "color": lambda sim: sim.set_color("Crate", (1.0, 0.0, 0.0)),
    "light": lambda sim: sim.set_light("robot", 9.0),
    "mass": lambda sim: sim.set_mass("Crate", 50.0),
    "friction": lambda sim: sim.set_friction("Crate", 0.1),
    "place": lambda sim: sim.place("Crate", [4.0, 1.0, 0.3]),
    "arm": lambda sim: sim.rpc("robot.arm", "set_rotations", [0.5] * 7),
    "delete": lambda sim: sim.delete("other"),
    "robot": lambda sim: sim.robot.restart(7),
    "restart": lambda sim: sim.restart(9),
    "gravity": lambda sim: setattr(sim.scene.settings, "gravity", 1.0),
    "paint": _paint_behind,
    "fail": _fail,
}

#: acts that change the scene itself or its objects
GUILTY = ("delete", "robot", "gravity", "paint")
INNOCENT = sorted(set(ACTS) - set(GUILTY))


def mischief(sim, acts):
    """Do something to a simulation, and return what its sensors measure."""
    for act in acts:
        ACTS[act](sim)
        sim.step(7)
    sim.step(7)
    data = {name: repr(part.local_data) for name, part in sim.context.components.items()}
    return {"data": repr(data)}


def rows(study, cache):
    hidden = ("wall", "cpu")
    return [
        {key: value for key, value in run_once(study, run, None, cache).items() if key not in hidden}
        for run in study.runs()
    ]


@settings(max_examples=examples(3), deadline=None)
@given(st.lists(st.lists(st.sampled_from(sorted(ACTS)), max_size=3), min_size=4, max_size=6))
def test_runs_are_those_of_new_loads(acts):
    study = Study(room, mischief, acts=[*acts, ["drive"]])
    assert rows(study, SceneCache()) == rows(study, None)


def test_no_act_reaches_the_next_run():
    # those that change the scene itself come last: the two runs after them describe it again
    acts = [[], *([act] for act in (*INNOCENT, *GUILTY) for act in (act, "drive"))]
    for here, anew in zip(
        *(rows(Study(room, mischief, acts=acts), cache) for cache in (SceneCache(), None)), strict=True
    ):
        assert here == anew


def test_noise_delays_and_cameras_follow_the_seed():
    study = Study(crowded_arena, mischief, acts=[[]], seeds=5)
    here = rows(study, SceneCache())
    assert here == rows(study, None)
    assert len({row["hash"] for row in here}) == 5


def count_compilations(monkeypatch):
    compilations = []
    compile_scene = module.compile_scene
    monkeypatch.setattr(module, "compile_scene", lambda scene: compilations.append(scene) or compile_scene(scene))
    return compilations


def test_a_scene_is_compiled_once_for_each_of_its_parameters(monkeypatch):
    compilations = count_compilations(monkeypatch)
    rows(Study(room, mischief, acts=[[act] for act in INNOCENT], lamp=[1.0, 2.0]), SceneCache())
    assert len(compilations) == 2


def test_a_scene_that_is_described_at_random_is_never_used_again(monkeypatch):
    compilations = count_compilations(monkeypatch)
    generator = random.Random(3)

    def arena():
        from morse.builder import ATRV, Environment, Pose

        robot = ATRV("robot")
        robot.append(Pose("pose"))
        robot.translate(generator.uniform(-1.0, 1.0))
        Environment("empty")

    study = Study(arena, lambda sim: {"x": sim.context.components["robot.pose"].position_3d.x}, seeds=5)
    assert len({row["x"] for row in rows(study, SceneCache())}) == 5
    assert not compilations


def test_the_modules_of_a_project_begin_anew_with_each_run(tmp_path):
    folder = tmp_path / "src" / "own" / "sensors"
    folder.mkdir(parents=True)
    (folder / "counting.py").write_text(
        "from morse.core.declarations import BuilderDefaults\n"
        "from morse.core.sensor import Sensor\n"
        "from morse.helpers.components import add_data\n"
        "COUNT = []\n"
        "class Counting(Sensor):\n"
        "    _builder = BuilderDefaults(frequency=60.0)\n"
        "    add_data('count', 0, 'int', 'Number of measurements since this module was imported')\n"
        "    def default_action(self):\n"
        "        COUNT.append(0)\n"
        "        self.local_data['count'] = len(COUNT)\n"
    )
    script = tmp_path / "scene.py"
    script.write_text(
        "from morse.builder import *\n"
        "from own.builder.sensors import Counting\n"
        "robot = ATRV()\n"
        "counter = Counting()\n"
        "robot.append(counter)\n"
        "env = Environment('empty')\n"
    )
    study = Study(script, _counted, seeds=5)
    assert [row["result"] for row in rows(study, SceneCache())] == [3] * 5


def _counted(sim):
    sim.step(3)
    return sim.robot.counter.data["count"]
