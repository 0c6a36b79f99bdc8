"""Compiles the interfaces of a ROS 2 package of which there is no wheel, for the Python that runs this file.

    .venv-ros/bin/python .ci/ros2_messages.py tests/middleware/ros2/control_msgs

The steps are those of rosidl_default_generators, without CMake: interfaces become IDL, type hashes, C, and Python.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from rosidl_adapter.action import convert_action_to_idl
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.srv import convert_srv_to_idl
from rosidl_generator_c import generate_c
from rosidl_generator_py import generate_py
from rosidl_generator_type_description import generate_type_hash
from rosidl_typesupport_c import generate_c as generate_dispatch
from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
from rosidl_typesupport_introspection_c import generate_c as generate_introspection

PREFIX = Path(sys.prefix)
NEEDED = (
    "action_msgs", "builtin_interfaces", "geometry_msgs", "service_msgs", "std_msgs", "trajectory_msgs",
    "unique_identifier_msgs",
)  # fmt: skip
SUPPORTS = ("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c")
CONVERSIONS = {"msg": convert_msg_to_idl, "srv": convert_srv_to_idl, "action": convert_action_to_idl}


def generate(source: Path, out: Path) -> list[Path]:
    """Write all sources; returns those in C and C++."""
    name = source.name
    include, package, other = out / "include" / name, out / "package" / name, out / "introspection" / name
    files = [file for kind in CONVERSIONS for file in sorted((source / kind).glob(f"*.{kind}"))]
    for file in files:
        kind = file.parent.name
        (include / kind).mkdir(parents=True, exist_ok=True)
        CONVERSIONS[kind](source, name, Path(kind) / file.name, include / kind)
    idl = [f"{file.parent.name}/{file.stem}.idl" for file in files]
    descriptions = {"type_description_tuples": [f"{one}:{(include / one).with_suffix('.json')}" for one in idl]}

    def arguments(generator: str, folder: Path, **more: object) -> str:
        path = out / f"{generator}.json"
        entries = {
            "package_name": name,
            "output_dir": str(folder),
            "template_dir": str(PREFIX / "share" / generator / "resource"),
            "idl_tuples": [f"{include}:{one}" for one in idl],
            "include_paths": [f"{one}:{PREFIX / 'share' / one}" for one in NEEDED],
            "ros_interface_dependencies": [],
            "target_dependencies": [],
        }
        path.write_text(json.dumps({**entries, **more}))
        return str(path)

    generate_type_hash(arguments("rosidl_generator_type_description", include))
    generate_c(arguments("rosidl_generator_c", include, **descriptions))
    generate_typesupport_fastrtps_c(arguments("rosidl_typesupport_fastrtps_c", include, **descriptions))
    # it writes files with the names of those of rosidl_generator_c
    generate_introspection(arguments("rosidl_typesupport_introspection_c", other, **descriptions))
    generate_dispatch(arguments("rosidl_typesupport_c", include, **descriptions), list(SUPPORTS))
    for generator in ("rosidl_generator_c", *SUPPORTS):
        file = f"{generator}__visibility_control.h"
        text = (PREFIX / "share" / generator / "resource" / f"{file}.in").read_text()
        text = text.replace("@PROJECT_NAME@", name).replace("@PROJECT_NAME_UPPER@", name.upper())
        (include / "msg" / file).write_text(text)
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    generate_py(arguments("rosidl_generator_py", package), ["rosidl_typesupport_c"])
    return [file for end in ("*.c", "*.cpp") for file in sorted(out.rglob(end))]


def compile_all(sources: list[Path], out: Path, library: Path) -> None:
    """Compile the sources into one library."""
    headers = [out / "include", out / "introspection", out / "package", sysconfig.get_path("include"), np.get_include()]
    headers += [PREFIX / "include", *sorted((PREFIX / "include").iterdir())]
    flags = [*(f"-I{folder}" for folder in headers), "-O0", "-fPIC", "-w", "-c"]
    objects = [str(out / f"{number}.o") for number in range(len(sources))]

    def compile_one(source: Path, target: str) -> None:
        compiler = ["g++", "-std=c++17"] if source.suffix == ".cpp" else ["gcc"]
        subprocess.run([*compiler, *flags, str(source), "-o", target], check=True)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compile_one, sources, objects))
    libraries = [
        f"-l{package}__{end}"
        for package in NEEDED
        for end in ("rosidl_generator_c", "rosidl_generator_py", "rosidl_typesupport_c", *SUPPORTS)
        if (PREFIX / "lib" / f"lib{package}__{end}.so").exists()
    ]
    libraries += ["-lrosidl_typesupport_c", "-lrosidl_runtime_c", "-lrcutils", "-lrmw", "-lfastcdr"]
    libraries += ["-lrosidl_typesupport_introspection_c", "-lrosidl_typesupport_fastrtps_c"]
    libraries += ["-lrosidl_typesupport_fastrtps_cpp", f"-L{PREFIX}/lib", f"-Wl,-rpath,{PREFIX}/lib"]
    subprocess.run(["g++", "-shared", *objects, "-o", str(library), *libraries], check=True)


def main() -> None:
    """Install the package into the Python that runs this file."""
    source = Path(sys.argv[1]).resolve()
    name, site = source.name, Path(sysconfig.get_path("purelib"))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        sources = generate(source, out)
        library = out / "package" / name / f"{name}_s__rosidl_typesupport_c.so"
        compile_all(sources, out, library)
        for file in (out / "package").rglob("*"):
            if file.suffix in (".py", ".so"):
                target = site / file.relative_to(out / "package")
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(file.read_bytes())
    # the names by which rosidl_typesupport_c looks for the parts of the library
    for support in SUPPORTS:
        link = PREFIX / "lib" / f"lib{name}__{support}.so"
        link.unlink(missing_ok=True)
        link.symlink_to(site / name / library.name)


main()
