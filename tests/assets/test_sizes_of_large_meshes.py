"""The collision shapes of a large mesh that moves are computed once, and stretched for its other sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from morse.assets import collision
from morse.assets.shape_cache import ShapeCache
from morse.scene import Mesh, Node, PhysicsType, Scene
from morse.scene.body import BodySettings

if TYPE_CHECKING:
    from numpy.typing import NDArray


def bumpy(rows: int = 24) -> Mesh:
    """A closed surface of several dents, about 1 m in radius."""
    columns = 2 * rows
    t = np.pi * np.arange(rows + 1)[:, None] / rows
    p = 2 * np.pi * np.arange(columns)[None, :] / columns
    r = 1 + 0.3 * np.sin(5 * t) * np.cos(4 * p)
    points = np.stack([r * np.sin(t) * np.cos(p), r * np.sin(t) * np.sin(p), r * np.cos(t) + 0 * p], axis=-1)
    a = np.arange(rows)[:, None] * columns + np.arange(columns)[None, :]
    b = np.arange(rows)[:, None] * columns + (np.arange(columns)[None, :] + 1) % columns
    upper, lower = [a, a + columns, b], [b, a + columns, b + columns]
    triangles = np.concatenate([np.stack(one, axis=-1).reshape(-1, 3) for one in (upper, lower)])
    flat = np.zeros(len(triangles), dtype=np.int32)
    return Mesh("bumpy", points.reshape(-1, 3).astype(np.float32), triangles.astype(np.int32), flat)


def hulls(mesh: Mesh, scale: tuple[float, float, float]) -> list[NDArray[np.float64]]:
    node = Node("bumpy", mesh=mesh, scale=[*scale], body=BodySettings(type=PhysicsType.RIGID_BODY))
    collision.resolve_shapes(Scene(roots=[node]))
    assert node.shapes
    found = [shape.vertices for shape in node.shapes]
    return [one for one in found if one is not None]


def test_another_size_is_not_computed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    compute: Any = collision.few_parts
    monkeypatch.setattr(collision, "_EARLIER", ShapeCache())
    monkeypatch.setattr(collision, "load_shapes", lambda key: None)
    monkeypatch.setattr(collision, "store_shapes", lambda key, shapes: None)
    monkeypatch.setattr(collision, "few_parts", lambda *given: calls.append(1) or compute(*given))
    monkeypatch.setattr(collision, "_LARGE", 1000)
    mesh = bumpy()
    own = hulls(mesh, (1.0, 1.0, 1.0))
    for scale in [(2.0, 2.0, 2.0), (1.5, 0.5, 0.7), (0.1, 3.0, 1.0)]:
        stretched = hulls(mesh, scale)
        assert len(stretched) == len(own)
        for part, twin in zip(own, stretched, strict=True):
            assert twin == pytest.approx(part * np.array(scale), abs=1e-3)
        low, high = np.concatenate(stretched).min(axis=0), np.concatenate(stretched).max(axis=0)
        points = np.asarray(mesh.vertices) * np.array(scale)
        assert low == pytest.approx(points.min(axis=0), abs=0.05)
        assert high == pytest.approx(points.max(axis=0), abs=0.05)
    assert len(calls) == 1
    # in a small mesh, a primitive may have become something else
    monkeypatch.setattr(collision, "_LARGE", 10**9)
    hulls(mesh, (3.0, 1.0, 1.0))
    assert len(calls) == 2
