"""Optical flow between images."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.rendering.distortion import DistortedLens

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.rendering.lens import Lens
    from morse.rendering.picture import Picture

    Floats = NDArray[np.float64]


class Moment(NamedTuple):
    """The poses at the time of an image.

    Attributes:
        names: names of the nodes.
        models, eye, axes: as in `Picture`.
    """

    names: list[str]
    models: NDArray[np.float32]
    eye: NDArray[np.float32]
    axes: NDArray[np.float32]


def moment_of(picture: Picture) -> Moment:
    """The moment of an image."""
    return Moment(list(picture.names), picture.models, picture.eye, picture.axes)


def optical_flow(picture: Picture, lens: Lens, before: Moment) -> NDArray[np.float32]:
    """Return the displacement (H, W, 2) of the content of each pixel since another moment, px to the right and down.

    Pixels without a surface move like infinitely distant points. Pixels without depth, and points that did not exist or
    were behind the camera, have no flow: NaN.
    """
    directions = lens.directions[0] if isinstance(lens, DistortedLens) else lens.rays().astype(np.float64)
    axes, earlier = picture.axes.astype(np.float64), before.axes.astype(np.float64)
    world = _product(axes.T, directions)
    shows_surface = (picture.ids >= 0) & (picture.depth > 0)
    number = np.where(shows_surface, picture.ids, 0)
    scale = np.where(shows_surface, picture.depth, 1.0) / np.where(shows_surface, directions[..., 2], 1.0)
    places = picture.eye.astype(np.float64) + world * scale[..., None]
    moves, is_known = _moves(picture, before)
    then = _product(moves[number, :, :3], places) + moves[number, :, 3]
    own = np.where(
        shows_surface[..., None],
        _product(earlier, then - before.eye.astype(np.float64)),
        _product(earlier, world),
    )
    height, width = picture.ids.shape
    now = np.stack(np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5), axis=-1)
    flow = now - lens.project(own)
    flow[(picture.ids >= 0) & ~(shows_surface & is_known[number])] = np.nan
    return flow.astype(np.float32)


def _product(matrix: Floats, vectors: Floats) -> Floats:
    """Products (..., 3) of matrices (..., 3, 3) and vectors (..., 3), with the same order of sums on all machines."""
    return np.asarray(
        matrix[..., :, 0] * vectors[..., 0:1]
        + matrix[..., :, 1] * vectors[..., 1:2]
        + matrix[..., :, 2] * vectors[..., 2:3]
    )


def _moves(picture: Picture, before: Moment) -> tuple[Floats, NDArray[np.bool_]]:
    """(I, 3, 4) present poses of nodes to their former poses, in the world frame; and whether each node existed."""
    if not picture.names:
        return np.zeros((1, 3, 4)), np.ones(1, bool)
    numbers = {name: number for number, name in enumerate(before.names)}
    order = np.array([numbers.get(name, -1) for name in picture.names])
    was = np.concatenate([before.models, np.zeros((1, 12), np.float32)])[order].reshape(-1, 3, 4).astype(np.float64)
    now = picture.models.reshape(-1, 3, 4).astype(np.float64)
    # rows of the cofactors, divided by the determinant: the columns of the inverse
    rows = now[:, :, :3]
    cofactors = np.cross(np.roll(rows, -1, axis=1), np.roll(rows, -2, axis=1))
    volume = (rows[:, 0] * cofactors[:, 0]).sum(axis=1)
    is_known = (np.abs(volume) > 0) & was.any(axis=(1, 2))
    inverse = cofactors.transpose(0, 2, 1) / np.where(is_known, volume, 1.0)[:, None, None]
    moves = np.zeros_like(now)
    for column in range(3):
        moves[:, :, column] = _product(was[:, :, :3], inverse[:, :, column])
    moves[:, :, 3] = was[:, :, 3] - _product(moves[:, :, :3], now[:, :, 3])
    still = (was == now).all(axis=(1, 2)) & is_known
    moves[still] = np.eye(3, 4)
    return moves, is_known
