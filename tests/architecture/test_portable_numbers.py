"""What reaches data is computed without BLAS, LAPACK and the vector code of numpy, which round by the processor."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import morse

_SOURCES = Path(morse.__file__).parent
#: only people look at what the viewer computes
_NOT_DATA = ("viewer", "data")
_ROOMS = sorted(path.parent.name for path in _SOURCES.glob("*/__init__.py") if path.parent.name not in _NOT_DATA)
#: numpy's names of functions whose rounding depends on the processor; `numpy.linalg` but for `norm` along an axis
_ROUNDED_BY_THE_PROCESSOR = {
    *("matmul", "dot", "vdot", "inner", "tensordot", "convolve", "correlate", "polyfit", "cov", "corrcoef"),
    *("sin", "cos", "tan", "arcsin", "arccos", "arctan", "arctan2", "sinh", "cosh", "tanh"),
    *("exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "power", "float_power", "cbrt"),
}
#: what is computed about a run, after it: estimates for people, in which rounding is far below the spread
_ESTIMATES = ("plugins/twin/",)
_NO_ESTIMATES = ("plugins/twin/calibration.py", "plugins/twin/parameters.py", "plugins/twin/replay.py")
#: files with numpy whose products are those of `morse.mathutils.Matrix`
_PRODUCTS_OF_MATRICES = {
    "plugins/blend/evaluation.py": 2,
    "assets/mjcf/reader.py": 3,
    "assets/mjcf/shapes.py": 1,
    "assets/sdf/geometry.py": 2,
}


def _calls(tree: ast.AST) -> list[str]:
    calls = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = ast.unparse(node.func)
        if name == "np.linalg.norm" and any(keyword.arg == "axis" for keyword in node.keywords):
            continue
        if name.startswith("np.linalg.") or (
            name.startswith("np.") and name.removeprefix("np.") in _ROUNDED_BY_THE_PROCESSOR
        ):
            calls.append(f"{name}, line {node.lineno}")
        elif name.endswith("einsum") and any(keyword.arg == "optimize" for keyword in node.keywords):
            calls.append(f"{name} with 'optimize', line {node.lineno}")
    return calls


def _imports_numpy(tree: ast.AST) -> bool:
    return any(
        isinstance(node, ast.Import) and any(alias.name == "numpy" for alias in node.names) for node in ast.walk(tree)
    )


@pytest.mark.parametrize("room", _ROOMS)
def test_no_function_of_numpy_that_rounds_by_the_processor_is_called(room: str) -> None:
    faults = []
    for path in sorted((_SOURCES / room).rglob("*.py")):
        name, tree = path.relative_to(_SOURCES).as_posix(), ast.parse(path.read_text("utf-8"))
        if name.startswith(_ESTIMATES) and name not in _NO_ESTIMATES:
            continue
        faults += [f"{name}: {call}" for call in _calls(tree)]
        if not _imports_numpy(tree):
            continue
        products = [
            node.lineno
            for node in ast.walk(tree)
            if isinstance(node, (ast.BinOp, ast.AugAssign)) and isinstance(node.op, ast.MatMult)
        ]
        if len(products) > _PRODUCTS_OF_MATRICES.get(name, 0):
            faults.append(f"{name}: '@' in the lines {products}")
    assert not faults, "use morse.mathutils.portable:\n" + "\n".join(faults)


_SCENE = """
from morse.builder import *
for robot, number in ((SegwayRMP400("wheeled"), 0), (ATRV("driven"), 1)):
    robot.translate(2.3 * number, 0.7, 0.2)
    robot.rotate(z=0.37 + number)
    motion = MotionVW("motion") if number else MotionVWDiff("motion")
    robot.append(motion)
    for sensor in (Sick(), Velodyne(), IMU(), GPS(), Odometry(), Pose(), Magnetometer(), SemanticCamera()):
        sensor.translate(0.1, 0.05, 0.9)
        sensor.rotate(0.01, 0.02, 0.3)
        robot.append(sensor)
    arm = KukaLWR()
    arm.translate(z=0.9)
    robot.append(arm)
env = Environment("sandbox")
env.properties(longitude=1.4, latitude=43.6, altitude=150.0)
"""

_RUN = """
import json, sys
import morse
with morse.load(sys.argv[1], seed=5) as sim:
    hashes = []
    sim.wheeled.motion.publish({"v": 0.5, "w": 0.3})
    sim.driven.motion.publish({"v": 0.7, "w": -0.4})
    for _ in range(4):
        sim.step(15)
        hashes.append(sim.state_hash())
print(json.dumps(hashes))
"""

#: the choice of instructions by OpenBLAS and numpy, as on older processors
_PROCESSORS = {
    "an old BLAS": {"OPENBLAS_CORETYPE": "Nehalem"},
    "another BLAS": {"OPENBLAS_CORETYPE": "Haswell"},
    "numpy without AVX-512": {"NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL"},
    "numpy without AVX2": {"NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL"},
}


def _hashes(script: Path, variables: dict[str, str]) -> list[str]:
    inherited = {name: value for name, value in os.environ.items() if not name.startswith(("OPENBLAS_", "NPY_"))}
    command = [sys.executable, "-c", _RUN, str(script)]
    end = subprocess.run(command, env={**inherited, **variables}, capture_output=True, text=True, timeout=240)
    assert end.returncode == 0, end.stderr
    return list(json.loads(end.stdout.splitlines()[-1]))


def test_the_bits_do_not_depend_on_the_instructions_of_numpy_and_blas(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(_SCENE)
    expected = _hashes(script, {})
    for processor, variables in _PROCESSORS.items():
        assert _hashes(script, variables) == expected, processor
