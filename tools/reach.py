"""Tries robots and worlds of others: what loads, stands or holds, and drives.

``python -m tools reach FOLDER... [--json FILE] [--md FILE] [--only PART] [--each NUMBER]``: every URDF, xacro, SDF and
MJCF file below the folders, each in a process of its own, with a line of output for each. ``--only`` takes files whose
path contains the text; ``--each 3`` takes every third file.

A model is compared with what MuJoCo's own parser makes of the same file: of an MJCF file all, of a URDF file the joints
and masses (its shapes are left out, since that parser reads few meshes).

| column | |
|---|---|
| loads | `Robot(FILE)` or `Environment(FILE)` gives a simulation |
| joints, mass | number of moving joints, and mass, in the other engine and here |
| places | largest distance of a joint from its place in the other engine, with all joints at 0, m |
| rests | no body is faster than 0.05 m/s from 2.5 to 3 s: it stands or holds, with its motors at the start. An arm that
  topples, which is one whose base carries one joint, is tried again with its base fixed. What has no collision shapes
  is not judged. An MJCF file is compared with MuJoCo alone, with the same step, commands and start: on a floor if the
  file has none, and on top of it if the file begins below it. One that MuJoCo refuses is not judged |
| drives | m of 1.2 m in 4 s at 0.3 m/s, and rad of 1 rad in 2 s at 0.5 rad/s, from rest, by wheels of the file; in a
  world, m in 4 s of an ATRV that is told to drive at 0.5 m/s, from the best of five places, each on the lowest surface
  with 1 m of room above it. A world without such a surface is not judged |
"""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

SUFFIXES = (".urdf", ".xacro", ".sdf", ".world", ".xml")
_LONGEST = 240.0
_RESTING = 0.05
_PLACES = ((0.0, 0.0), (2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (3.0, -3.0))
#: height from which floors are searched; shapes on the way; room that a robot needs, m
_HIGH, _MOST_SURFACES, _ROOM = 1000.0, 1000, 1.0
_MARK = "reach: "

Row = dict[str, Any]


def kind_of(path: Path) -> str:
    """What a file is: ``urdf``, ``mjcf``, ``sdf``, ``world``, or empty for anything else."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
        root = ET.fromstring(re.sub(r"^\s*(<\?xml[^>]*\?>)?", "", text)).tag
    except (ET.ParseError, OSError):
        return ""
    if root == "mujoco":
        return "mjcf" if re.search(r"<body[\s>]", text) and re.search(r"<(free)?joint[\s/>]", text) else ""
    if root == "robot":
        # a file of macros is no robot
        links = "<link" in re.sub(r"<xacro:macro.*?</xacro:macro>", "", text, flags=re.S)
        return "urdf" if path.suffix in (".urdf", ".xacro") and links else ""
    if root == "sdf":
        return "world" if "<world" in text else "sdf"
    return ""


def files_of(folders: list[Path]) -> list[tuple[str, Path]]:
    """The models and worlds below some folders; files that others include are parts of these."""
    found = (path for folder in folders for path in (sorted(folder.rglob("*")) if folder.is_dir() else [folder]))
    files = [path for path in found if path.suffix in SUFFIXES]
    parts = {
        name.rpartition("/")[2]
        for path in files
        if path.suffix in (".xacro", ".xml")
        for name in re.findall(
            r"<(?:xacro:)?include\s[^>]*?file(?:name)?=[\"']([^\"']+)", path.read_text("utf-8", "replace")
        )
    }
    return [(kind, path) for path in files if path.name not in parts and (kind := kind_of(path))]


# -- one file, in a process of its own ---------------------------------------------------------------------------------


def measured(kind: str, path: Path) -> Row:
    """Try one file."""
    row: Row = {"file": str(path), "kind": kind}
    other = _other_engine(kind, path)
    if isinstance(other, str):
        row["other"] = other
    else:
        row |= _facts(other)
    try:
        row |= _world(path) if kind == "world" else _robot(path, other)
        row["loads"] = True
    except Exception as error:
        row["loads"], row["error"] = False, str(error).splitlines()[0][:300] if str(error) else repr(error)
    return row


def _other_engine(kind: str, path: Path) -> Any:
    """The model that MuJoCo's own parser makes of a file, or why it makes none."""
    import mujoco

    try:
        if kind == "mjcf":
            return mujoco.MjModel.from_xml_path(str(path))
        if kind == "urdf" and path.suffix == ".urdf":
            root = ET.fromstring(
                re.sub(r"^\s*(<\?xml[^>]*\?>)?", "", path.read_text(encoding="utf-8", errors="replace"))
            )
            for link in root.iter("link"):
                for part in [*link.findall("visual"), *link.findall("collision")]:
                    link.remove(part)
            for name in ("gazebo", "transmission", "ros2_control", "material", "mujoco"):
                for part in root.findall(name):
                    root.remove(part)
            root.append(
                ET.fromstring('<mujoco><compiler balanceinertia="true" boundmass="1e-6" boundinertia="1e-9"/></mujoco>')
            )
            return mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    except (ValueError, ET.ParseError, OSError) as error:
        return str(error).splitlines()[0][:200]
    return "not read by another engine"


def _facts(model: Any) -> Row:
    free = sum(1 for kind in model.jnt_type.tolist() if kind == 0)
    return {"joints": model.njnt - free, "mass": _moving_mass(model)}


def _moving_mass(model: Any) -> float:
    """The mass that joints move, kg; that of a base is not in the model of a URDF file of the other engine."""
    moved = [False] * model.nbody
    for body in range(1, model.nbody):
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        has_joint = any(model.jnt_type[joint] for joint in range(first, first + count))
        moved[body] = has_joint or moved[model.body_parentid[body]]
    return round(float(model.body_mass[moved].sum()), 6)


def _robot(path: Path, other: Any) -> Row:
    import morse

    def scene() -> None:
        from morse.builder import Environment, MotionVWDiff, Pose, Robot

        robot = Robot(str(path))
        if drive and "motion" not in robot.actuators:
            robot.append(MotionVWDiff("motion"))
        if is_fixed:
            robot.set_physics_type("STATIC")
        robot.append(Pose("spot"))
        Environment("empty", fastmode=True)

    row: Row = {}
    drive = is_fixed = False
    with morse.load(scene) as sim:
        world = sim.world
        row["joints_here"] = sum(1 for node in world.scene.nodes() for bone in node.bones if bone.kind != "fixed")
        row["mass_here"] = _moving_mass(world.model)
        if not isinstance(other, str):
            row["places"] = _apart(world.model, other)
        row["collides"] = bool(world.model.geom_contype[world.model.geom_bodyid > 0].any())
        is_arm = _is_free_arm(world.model)
        start = _start(world)
        row["rests"] = _rests(sim)
        row["failures"] = [str(one)[:200] for one in sim.failures]
    if not row["rests"] and is_arm:
        is_fixed = True
        with morse.load(scene) as sim:
            row["rests_fixed"] = _rests(sim)
        is_fixed = False
    if not isinstance(other, str) and other.nq and kind_of(path) == "mjcf":
        row["rests_there"] = _rests_alone(path, start)
    drive = True
    try:
        with morse.load(scene) as sim:
            row["drives"] = _driven(sim)
    except Exception as error:
        if "has no wheels to drive" not in str(error):
            row["drives_not"] = str(error).splitlines()[0][:200]
    return row


def _start(world: Any) -> tuple[float, dict[str, float], dict[str, tuple[float, bool]]]:
    """The step, s, the heights of free bodies, m, and the commands of motors, with whether they act on a position."""
    model, data = world.model, world.data
    commands = {
        model.actuator(number).name.partition("/")[2]: (
            float(data.ctrl[number]),
            bool(model.actuator_biasprm[number][1:3].any()),
        )
        for number in range(model.nu)
    }
    return float(model.opt.timestep), {name: float(data.qpos[place]) for name, place in _free(model)}, commands


def _free(model: Any) -> list[tuple[str, int]]:
    """The free bodies, and where their heights are among the positions."""
    joints = [joint for joint in range(model.njnt) if model.jnt_type[joint] == 0]
    return [
        (model.body(int(model.jnt_bodyid[joint])).name.rpartition("/")[2], int(model.jnt_qposadr[joint]) + 2)
        for joint in joints
    ]


def _rests_alone(path: Path, start: tuple[float, dict[str, float], dict[str, tuple[float, bool]]]) -> bool:
    """Whether the bodies of an MJCF file rest in MuJoCo alone, from the same start."""
    import mujoco

    step, heights, commands = start
    spec = mujoco.MjSpec.from_file(str(path))
    if not any(geom.type == mujoco.mjtGeom.mjGEOM_PLANE for geom in spec.worldbody.geoms):
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50.0, 50.0, 1.0])
    spec.option.timestep = step
    alone = spec.compile()
    data = mujoco.MjData(alone)
    for name, place in _free(alone):
        data.qpos[place] = max(data.qpos[place], heights.get(name, data.qpos[place]))
    for number in range(alone.nu):
        name = alone.actuator(number).name
        if f"{name} actuator" in commands:
            data.ctrl[number] = commands[f"{name} actuator"][0]
            continue
        # motors of joints have the names of these, and their gears and gains are applied
        command, holds = commands.get(alone.joint(int(alone.actuator_trnid[number][0])).name, (0.0, False))
        gear = float(alone.actuator_gear[number][0])
        data.ctrl[number] = command * gear if holds else command / (gear * alone.actuator_gainprm[number][0] or 1.0)
    mujoco.mj_step(alone, data, round(2.5 / step))
    before = data.xpos.copy()
    mujoco.mj_step(alone, data, round(0.5 / step))
    return bool(abs(data.xpos - before).max() / 0.5 < _RESTING)


def _rests(sim: Any) -> bool:
    """Whether no body is fast any more after 2.5 s."""
    import mujoco

    model, data = sim.world.model, sim.world.data
    sim.step(150)
    before = data.xpos.copy()
    sim.step(30)
    mujoco.mj_kinematics(model, data)
    speed = float(abs(data.xpos - before).max()) / 0.5
    return math.isfinite(speed) and speed < _RESTING


def _is_free_arm(model: Any) -> bool:
    """Whether there is one free body, from which one chain of joints starts."""
    free = [int(model.jnt_bodyid[joint]) for joint in range(model.njnt) if model.jnt_type[joint] == 0]
    return len(free) == 1 and sum(1 for body in range(model.nbody) if model.body_parentid[body] == free[0]) == 1


def _apart(here: Any, other: Any) -> float | None:
    """The largest distance of joints of the same names, with all joints at 0, from the first of them, m."""
    import mujoco
    import numpy as np

    anchors = []
    for model in (here, other):
        data = mujoco.MjData(model)
        turning = [joint for joint in range(model.njnt) if model.jnt_type[joint] >= 2]
        data.qpos[model.jnt_qposadr[turning]] = 0.0
        mujoco.mj_kinematics(model, data)
        anchors.append({model.joint(joint).name.rpartition("/")[2]: data.xanchor[joint].copy() for joint in turning})
    both = [name for name in anchors[1] if name and name in anchors[0]]
    if not both:
        return None
    places = [np.array([found[name] - found[both[0]] for name in both]) for found in anchors]
    return float(abs(places[0] - places[1]).max())


def _driven(sim: Any) -> list[float]:
    """Distance, m, and angle, rad."""
    robot = sim.robot
    motion = robot.motion
    sim.step(60)
    start = robot.spot.get()
    _command(motion, 0.3, 0.0)
    sim.step(240)
    end = robot.spot.get()
    _command(motion, 0.0, 0.0)
    sim.step(60)
    yaw = robot.spot.get()["yaw"]
    _command(motion, 0.0, 0.5)
    sim.step(120)
    turned = math.remainder(robot.spot.get()["yaw"] - yaw, math.tau)
    return [round(math.hypot(end["x"] - start["x"], end["y"] - start["y"]), 3), round(turned, 3)]


def _command(motion: Any, forward: float, turn: float) -> None:
    """Command a drive with wheels, or one that also moves sideways."""
    try:
        motion.publish({"v": forward, "w": turn})
    except ValueError as error:
        if "no field 'v'" not in str(error):
            raise
        motion.publish({"x": forward, "y": 0.0, "w": turn})


def _world(path: Path) -> Row:
    import morse

    def scene(place: tuple[float, float, float] = (0.0, 0.0, _HIGH)) -> None:
        from morse.builder import ATRV, Environment, MotionVW, Pose

        robot = ATRV()
        robot.translate(*place)
        robot.append(MotionVW("motion"))
        robot.append(Pose("spot"))
        Environment(str(path), fastmode=True)

    with morse.load(scene) as sim:
        places = [(x, y, z + 0.1) for x, y in _PLACES if (z := _floor(sim.world, x, y)) is not None]
    best = 0.0
    for place in places:
        with morse.load(partial(scene, place)) as sim:
            sim.step(60)
            start = sim.robot.spot.get()
            sim.robot.motion.publish({"v": 0.5, "w": 0.0})
            sim.step(240)
            end = sim.robot.spot.get()
        if end["z"] > start["z"] - 1.0:
            best = max(best, math.hypot(end["x"] - start["x"], end["y"] - start["y"]))
        if best > 1.0:
            break
    return {"floor": bool(places)} | ({"drives": [round(best, 3)]} if places else {})


def _floor(world: Any, x: float, y: float) -> float | None:
    """The lowest of the surfaces above one another that have room for a robot, m."""
    import mujoco
    import numpy as np

    floor, above, seen = None, math.inf, set()
    point, geom = np.array([x, y, _HIGH - 10.0]), np.full(1, -1, dtype=np.int32)
    for _ in range(_MOST_SURFACES):
        distance = mujoco.mj_ray(world.model, world.data, point, np.array([0.0, 0.0, -1.0]), None, 1, -1, geom)
        if distance < 0.0:
            break
        point[2] -= distance
        shape, height = int(geom[0]), float(point[2])
        point[2] -= 1e-4
        collides = world.model.geom_contype[shape] or world.model.geom_conaffinity[shape]
        if not collides or world.model.body_weldid[world.model.geom_bodyid[shape]]:
            continue  # what moves is no floor
        # the first surface of a shape is its top, the next one its bottom
        if shape not in seen and above - height >= _ROOM:
            floor = height
        seen.add(shape)
        above = height
    return floor


# -- all files ---------------------------------------------------------------------------------------------------------


def tried(kind: str, path: Path) -> Row:
    """Try one file in a process of its own."""
    command = [sys.executable, "-m", "tools.reach", kind, str(path)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_LONGEST, cwd=Path(__file__).parents[1], check=False
        )
    except subprocess.TimeoutExpired:
        return {"file": str(path), "kind": kind, "loads": False, "error": f"takes more than {_LONGEST:g} s"}
    lines = [line for line in done.stdout.splitlines() if line.startswith(_MARK)]
    if not lines:
        return {
            "file": str(path),
            "kind": kind,
            "loads": False,
            "error": f"the process ended with status {done.returncode}",
        }
    row: Row = json.loads(lines[-1].removeprefix(_MARK))
    return row


def judged(row: Row) -> Row:
    """The answers to the questions of the table: True, False, or None for those that do not apply."""
    loads = bool(row.get("loads"))
    sound = loads or "joints" in row or row["kind"] in ("sdf", "world")
    same = None
    if loads and "joints" in row:
        same = row["joints_here"] >= row["joints"] and (row.get("places") or 0.0) < 1e-6
        # a link that moves has a mass of a gram here if the file has none, a robot without any mass 1 kg
        grams = 2e-3 * max(row["joints"], 1)
        weightless = row["mass"] <= 1e-3 * grams
        same = same and (weightless or math.isclose(row["mass_here"], row["mass"], rel_tol=1e-3, abs_tol=grams))
    stands = None
    if loads and row.get("collides"):
        if row["kind"] != "mjcf":
            stands = row["rests"] or row.get("rests_fixed", False)
        elif "rests_there" in row:
            stands = row["rests"] == row["rests_there"]
    drives: bool | None = None
    if loads and row["kind"] == "world":
        drives = row["drives"][0] > 1.0 if row["floor"] else None
    elif loads and "drives" in row:
        distance, turned = row["drives"]
        drives = abs(distance - 1.2) <= 0.024 and abs(turned - 1.0) <= 0.05
    return {"sound": sound, "loads": loads, "same": same, "stands": stands, "drives": drives}


def table(rows: list[Row], folders: list[Path]) -> str:
    """The table of the groups of files, by the folder in which they are, in Markdown."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        path = Path(row["file"])
        base = next((folder for folder in folders if path.is_relative_to(folder)), path.parent)
        parts = path.relative_to(base).parts
        groups.setdefault((parts[0] if len(parts) > 1 else base.name, row["kind"]), []).append(row)
    lines = [
        "| files | kind | number | loads | as the other engine | stands or holds | drives |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    total: dict[str, list[bool]] = {}
    for (name, kind), members in sorted(groups.items()):
        answers = [judged(row) for row in members]
        cells = []
        for question in ("loads", "same", "stands", "drives"):
            values = [
                one[question] for one in answers if one[question] is not None and (question != "loads" or one["sound"])
            ]
            total.setdefault(question, []).extend(values)
            cells.append(f"{sum(values)} of {len(values)}" if values else "")
        lines.append(f"| {name} | {kind} | {len(members)} | {' | '.join(cells)} |")
    cells = [f"{sum(values)} of {len(values)}" for values in total.values()]
    return "\n".join([*lines, f"| all | | {len(rows)} | {' | '.join(cells)} |", ""])


def main(arguments: list[str]) -> int:
    """Run the command; the result is the status of the process."""
    options = {"--json": "", "--md": "", "--only": "", "--each": "1"}
    folders = []
    words = iter(arguments)
    for word in words:
        if word in options:
            options[word] = next(words, "")
        else:
            folders.append(Path(word).resolve())
    if not folders:
        print(__doc__, file=sys.stderr)
        return 2
    files = [(kind, path) for kind, path in files_of(folders) if options["--only"] in str(path)][
        :: int(options["--each"])
    ]
    rows = []
    with ThreadPoolExecutor(2) as pool:
        for row in pool.map(lambda one: tried(*one), files):
            rows.append(row)
            print(json.dumps(row | {"answers": judged(row)}), flush=True)
    if options["--json"]:
        Path(options["--json"]).write_text(json.dumps(rows, indent=1), encoding="utf-8")
    text = table(rows, folders)
    if options["--md"]:
        Path(options["--md"]).write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    print(_MARK + json.dumps(measured(sys.argv[1], Path(sys.argv[2]))))
