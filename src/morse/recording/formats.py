"""The files that topics are exported to: tables, trajectories, point clouds."""

from __future__ import annotations

import csv
import json
import struct
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from morse.core.reports.quoting import spreadsheet_cell
from morse.recording.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

#: numpy types of the fields of a `sensor_msgs/PointField`
_POINT_TYPES = {1: "i1", 2: "u1", 3: "<i2", 4: "<u2", 5: "<i4", 6: "<u4", 7: "<f4", 8: "<f8"}
#: largest number of values of a .npz file in memory
_MOST = 50_000_000
#: a LAS file has integers of 32 bits, in millimetres
_MILLIMETRE = 1e-3


class Sink(Protocol):
    """A file of one topic."""

    def write(self, rows: list[list[object]]) -> None:
        """Add rows: simulated time, the same without jumps, tick, and the fields of the message."""

    def close(self) -> None:
        """Complete the file."""


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_plain(inner) for inner in value]
    return value.tolist() if hasattr(value, "tolist") else value


class Csv:
    """RFC 4180, numbers with all their digits; lists as JSON; no text is a formula for a spreadsheet."""

    def __init__(self, path: Path, columns: Sequence[tuple[str, str]]) -> None:
        self._file = path.open("x", newline="", encoding="utf-8", errors="backslashreplace")
        self._writer = csv.writer(self._file)
        self._writer.writerow([spreadsheet_cell(name) for name, _ in columns])

    def write(self, rows: list[list[object]]) -> None:
        """See `Sink`."""
        self._writer.writerows([[self._cell(value) for value in row] for row in rows])

    @staticmethod
    def _cell(value: object) -> object:
        if isinstance(value, (list, dict)) or hasattr(value, "tolist"):
            return spreadsheet_cell(json.dumps(_plain(value)))
        return spreadsheet_cell(value)

    def close(self) -> None:
        """See `Sink`."""
        self._file.close()


class Parquet:
    """With the types of the messages."""

    def __init__(self, path: Path, columns: Sequence[tuple[str, str]]) -> None:
        import pyarrow
        from pyarrow import parquet

        self._arrow = pyarrow
        self._columns = columns
        self._schema = pyarrow.schema([(name, self._type(kind)) for name, kind in columns])
        if path.exists():
            raise FileExistsError(17, "File exists", str(path))
        self._writer = parquet.ParquetWriter(path, self._schema, compression="zstd")

    def _type(self, kind: str) -> object:
        if kind == "uint8[]":
            return self._arrow.binary()
        if kind.endswith("[]"):
            return self._arrow.list_(self._type(kind[:-2]))
        types = {"json": "string", "float32": "float32", "float64": "float64"}
        return getattr(self._arrow, {"bool": "bool_"}.get(kind, types.get(kind, kind)))()

    def write(self, rows: list[list[object]]) -> None:
        """See `Sink`."""
        columns = []
        for (_, kind), values in zip(self._columns, zip(*rows, strict=True), strict=True):
            column: list[object] = list(values)
            if kind == "uint8[]":
                column = [bytes(value) for value in values]
            elif kind == "json":
                column = [json.dumps(_plain(value)) for value in values]
            elif kind == "string":
                column = [value.encode("utf-8", "replace").decode() for value in values]
            columns.append(self._arrow.array(column, type=self._type(kind)))
        self._writer.write_table(self._arrow.table(columns, schema=self._schema))

    def close(self) -> None:
        """See `Sink`."""
        self._writer.close()


class Numpy:
    """A .npz file with an array for each column; lists of the same length are an array with several dimensions."""

    def __init__(self, path: Path, columns: Sequence[tuple[str, str]]) -> None:
        self._file = path.open("xb")
        self._names = [name for name, _ in columns]
        self._columns: list[list[object]] = [[] for _ in columns]
        self._count = 0

    def write(self, rows: list[list[object]]) -> None:
        """See `Sink`."""
        for column, values in zip(self._columns, zip(*rows, strict=True), strict=True):
            self._count += sum(len(value) if hasattr(value, "__len__") else 1 for value in values)
            column.extend(values)
        if self._count > _MOST:
            raise RecordingError(
                f"a .npz file of more than {_MOST:,} values is not written: export Parquet, or fewer topics"
            )

    def close(self) -> None:
        """See `Sink`."""
        with self._file:
            arrays = {name: self._array(values) for name, values in zip(self._names, self._columns, strict=True)}
            np.savez_compressed(self._file, allow_pickle=False, **arrays)

    @staticmethod
    def _array(values: list[object]) -> Any:
        try:
            array = np.array([_plain(value) if isinstance(value, (list, dict)) else value for value in values])
        except ValueError:
            array = np.array(None)
        # objects would be executed when they are read
        return array if array.dtype.kind in "biufU" else np.array([json.dumps(_plain(value)) for value in values])


class Trajectory:
    """Positions and orientations as text, a line for each: formats that tools for trajectories read.

    Args:
        form: ``tum``: time, x, y, z, quaternion x, y, z, w (Sturm et al. 2012); ``kitti``: the first three rows of the
            matrix (Geiger et al. 2012); ``euroc``: time in ns, x, y, z, quaternion w, x, y, z (Burri et al. 2016).
    """

    def __init__(self, path: Path, columns: Sequence[tuple[str, str]], form: str) -> None:
        self._form = form
        names = [name for name, _ in columns]
        self._places = pose_columns(names)
        if not self._places:
            raise RecordingError("its messages have no position with an orientation")
        self._file = path.open("x", encoding="ascii")
        if form == "euroc":
            self._file.write(
                "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
            )

    def write(self, rows: list[list[object]]) -> None:
        """See `Sink`."""
        for row in rows:
            x, y, z, qx, qy, qz, qw = (float(row[place]) for place in self._places)  # type: ignore[arg-type]
            time = float(row[1])  # type: ignore[arg-type]
            if self._form == "tum":
                words = [f"{time:.9f}", *map(repr, (x, y, z, qx, qy, qz, qw))]
            elif self._form == "euroc":
                self._file.write(",".join([f"{round(1e9 * time)}", *map(repr, (x, y, z, qw, qx, qy, qz))]) + "\n")
                continue
            else:
                size = qx * qx + qy * qy + qz * qz + qw * qw or 1.0
                s = 2.0 / size
                matrix = (
                    (1.0 - s * (qy * qy + qz * qz), s * (qx * qy - qz * qw), s * (qx * qz + qy * qw), x),
                    (s * (qx * qy + qz * qw), 1.0 - s * (qx * qx + qz * qz), s * (qy * qz - qx * qw), y),
                    (s * (qx * qz - qy * qw), s * (qy * qz + qx * qw), 1.0 - s * (qx * qx + qy * qy), z),
                )
                words = [repr(number) for line in matrix for number in line]
            self._file.write(" ".join(words) + "\n")

    def close(self) -> None:
        """See `Sink`."""
        self._file.close()


def pose_columns(names: Sequence[str]) -> list[int]:
    """The columns of x, y, z and of the quaternion x, y, z, w; empty for a message without a pose."""
    for name in names:
        if name == "position.x" or name.endswith(".position.x"):
            prefix = name.removesuffix("position.x")
            wanted = [f"{prefix}position.{axis}" for axis in "xyz"] + [f"{prefix}orientation.{axis}" for axis in "xyzw"]
            if all(one in names for one in wanted):
                return [list(names).index(one) for one in wanted]
    return []


class Clouds:
    """A folder with a file for each point cloud.

    Args:
        form: ``pcd``: version 0.7 of the Point Cloud Library, binary; ``las``: version 1.2 of the ASPRS, format 0, in
            millimetres.
    """

    def __init__(self, path: Path, columns: Sequence[tuple[str, str]], form: str) -> None:
        self._form, self._path = form, path
        names = [name for name, _ in columns]
        wanted = ("fields", "point_step", "data", "width", "height")
        if not set(wanted) <= set(names):
            raise RecordingError("its messages are no sensor_msgs/PointCloud2")
        self._places = {name: names.index(name) for name in wanted}
        path.mkdir()
        self._count = 0

    def write(self, rows: list[list[object]]) -> None:
        """See `Sink`."""
        for row in rows:
            points = self._points(*(row[self._places[name]] for name in ("fields", "point_step", "data")))
            with open(self._path / f"{self._count:06d}.{self._form}", "xb") as file:
                file.write(_pcd(points) if self._form == "pcd" else _las(points))
            self._count += 1

    @staticmethod
    def _points(fields: Any, step: Any, data: Any) -> Any:
        try:
            known = [(str(one["name"]), _POINT_TYPES[int(one["datatype"])], int(one["offset"])) for one in fields]
            names, formats, offsets = zip(*known, strict=True)
            dtype = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": int(step)})
            return np.frombuffer(bytes(data), dtype)
        except (ValueError, LookupError, TypeError) as error:
            raise RecordingError(f"a point cloud is damaged: {error}") from None

    def close(self) -> None:
        """See `Sink`."""


def _pcd(points: Any) -> bytes:
    names = points.dtype.names
    packed = np.empty(len(points), np.dtype([(name, points.dtype[name].str) for name in names]))
    for name in names:
        packed[name] = points[name]
    kinds = {"f": "F", "i": "I", "u": "U"}
    head = [
        "# .PCD v0.7 - Point Cloud Data file format",
        "VERSION 0.7",
        f"FIELDS {' '.join(names)}",
        f"SIZE {' '.join(str(points.dtype[name].itemsize) for name in names)}",
        f"TYPE {' '.join(kinds[points.dtype[name].kind] for name in names)}",
        f"COUNT {' '.join('1' for _ in names)}",
        f"WIDTH {len(points)}",
        "HEIGHT 1",
        "VIEWPOINT 0 0 0 1 0 0 0",
        f"POINTS {len(points)}",
        "DATA binary",
    ]
    return ("\n".join(head) + "\n").encode("ascii", "replace") + packed.tobytes()


def _las(points: Any) -> bytes:
    """LAS 1.2, point data record format 0 (ASPRS, 2008); points that are not finite are left out."""
    if not {"x", "y", "z"} <= set(points.dtype.names):
        raise RecordingError("a point cloud without x, y and z is no LAS file")
    places = np.stack([points[axis].astype(float) for axis in "xyz"], axis=1)
    is_finite = np.isfinite(places).all(axis=1)
    places = places[is_finite]
    middle = np.round(places.mean(axis=0)) if len(places) else np.zeros(3)
    numbers = np.round((places - middle) / _MILLIMETRE)
    if np.abs(numbers).max(initial=0.0) >= 2.0**31:
        raise RecordingError("the points of a cloud are more than 2,000 km apart")
    records = np.zeros(
        len(places),
        np.dtype([("place", "<i4", 3), ("intensity", "<u2"), ("rest", "u1", 4), ("source", "<u2")]),
    )
    records["place"] = numbers
    records["rest"][:, 0] = 0b001001  # the first of one return
    if "intensity" in points.dtype.names:
        records["intensity"] = np.clip(np.nan_to_num(points["intensity"][is_finite].astype(float)), 0, 65535)
    low, high = (places.min(axis=0), places.max(axis=0)) if len(places) else (np.zeros(3), np.zeros(3))
    box = [number for pair in zip(high, low, strict=True) for number in pair]
    head = struct.pack(
        "<4sHH16sBB32s32sHHHIIBHI5I3d3d6d",
        b"LASF", 0, 0, b"", 1, 2, b"MORSE", b"MORSE", 1, 2000, 227, 227, 0, 0, 20, len(places),
        len(places), 0, 0, 0, 0, *[_MILLIMETRE] * 3, *middle, *box,
    )  # fmt: skip
    return head + records.tobytes()
