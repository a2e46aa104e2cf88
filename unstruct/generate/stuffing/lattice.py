"""The finest lattice over a box, where a function is asked, and the octree that is fine where its sign
changes.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import kernel
from ..tree.keys import Keys, keys_of
from ..tree.lookup import corners
from .sampling import CALLED_AT_ONCE, LevelSet

__all__ = ["Frame", "Samples", "frame_of", "marked_cells", "samples_of"]

Array = NDArray[np.float64]
MARGIN_CELLS = 4  # between a box and the sides of the root, on both sides together
NOT_ASKED = -2  # the sign of vertices in the layer around, until it is known that none is beside the body
SHARE_OF_CELL = 1e-9  # by which a box may be larger than a whole number of cells, by rounding


class Frame(NamedTuple):
    """A root of cubes around a box.

    Attributes
    ----------
    root : (2, 3) float64
    level : int
        The level whose cells have the wanted size.
    first, cells : (3,) int64
        The cells of that level that cover the box: ``first[a], ..., first[a] + cells[a] - 1`` along axis a.
    """

    root: Array
    level: int
    first: NDArray[np.int64]
    cells: NDArray[np.int64]


class Samples(NamedTuple):
    """Values at the corners and centers of the cells of a frame, and of one more layer of cells around them.

    Attributes
    ----------
    corner_values, center_values : float64, of shapes cells + 3 and cells + 2
    corner_signs, center_signs : int8
        1 inside, 0 on the surface, -1 outside.
    """

    corner_values: Array
    center_values: Array
    corner_signs: NDArray[np.int8]
    center_signs: NDArray[np.int8]


def frame_of(box: Array, cell: float, deepest: int) -> Frame:
    """The frame with cubes of side `cell`, in the middle of which the box lies.

    Raises
    ------
    InputError
        If that needs more levels than there may be.
    """
    extent = box[1] - box[0]
    count = np.maximum(1, np.ceil(extent / cell - SHARE_OF_CELL))
    level = int(np.ceil(np.log2(count.max() + MARGIN_CELLS)))
    spacing = float(np.spacing(np.abs(box).max()))
    if level > deepest or not cell > 2.0**20 * spacing:
        raise InputError(
            f"size = {cell} is too small for the box from {box[0].tolist()} to {box[1].tolist()}: it may be "
            f"divided {deepest} times, and a cell must have 2^20 spacings of doubles"
        )
    cells = count.astype(np.int64)
    first = ((1 << level) - cells) // 2
    low = box[0] + 0.5 * extent - (first + 0.5 * cells) * cell
    return Frame(np.stack([low, low + cell * (1 << level)]), level, first, cells)


def samples_of(body: LevelSet, frame: Frame) -> Samples:
    """The function at all vertices of the frame, each once.

    Raises
    ------
    InputError
        If the function is positive at the sides of the frame.
    """
    low, side = frame.root[0], frame.root[1] - frame.root[0]
    kinds = []
    for more, half in ((3, 0.0), (2, 0.5)):
        axes = []
        for a in range(3):
            i = frame.first[a] - 1 + np.arange(frame.cells[a] + more)
            x = corners(low[a], side[a], i, frame.level)
            if half:
                x = x + 0.5 * (corners(low[a], side[a], i + 1, frame.level) - x)
            axes.append(x)
        kinds.append(_asked(body, axes, 0 if half else 1))
    (v0, s0, axes), (v1, s1, _) = kinds
    at = np.full(3, -1, dtype=np.int64)
    if _beside_outside(s0, s1, at):
        place = [float(axes[a][at[a]]) for a in range(3)]
        raise InputError(
            f"the function is positive near {place}, beside the boundary of the box: take a larger box, or "
            "cap=True"
        )
    return Samples(v0, v1, np.maximum(s0, -1), np.maximum(s1, -1))


def _asked(body: LevelSet, axes: list[Array], skip: int) -> tuple[Array, NDArray[np.int8], list[Array]]:
    """Values and signs on a grid, except for so many of its outermost layers."""
    shape = tuple(map(len, axes))
    part = slice(skip, -skip or None)
    values, signs = np.full(shape, -1.0), np.full(shape, NOT_ASKED, dtype=np.int8)
    y, z = (plane.ravel() for plane in np.meshgrid(axes[1][part], axes[2][part], indexing="ij"))
    layers = max(1, CALLED_AT_ONCE // len(y))
    for i in range(skip, shape[0] - skip, layers):
        x = axes[0][i : min(i + layers, shape[0] - skip)]
        rows = np.empty((len(x), len(y), 3))
        rows[..., 0], rows[..., 1], rows[..., 2] = x[:, None], y, z
        found = body(rows.reshape(-1, 3)).reshape(len(x), shape[1] - 2 * skip, shape[2] - 2 * skip)
        values[i : i + len(x), part, part] = found
        signs[i : i + len(x), part, part] = np.sign(found).astype(np.int8)
    return values, signs, axes


@kernel
def _beside_outside(corner, center, at):
    """Whether a vertex inside has a neighbor that was not asked; `at` is the corner next to it."""
    nx, ny, nz = center.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                s = center[i, j, k]
                bad = False
                for c in range(8):
                    x, y, z = i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2)
                    t = corner[x, y, z]
                    bad |= (s > 0 and t == NOT_ASKED) or (t > 0 and s == NOT_ASKED)
                    for a in range(3):  # long edges between corners
                        if not (c >> a) & 1:
                            u = corner[x + (a == 0), y + (a == 1), z + (a == 2)]
                            bad |= (u > 0 and t == NOT_ASKED) or (t > 0 and u == NOT_ASKED)
                for a in range(3):
                    x, y, z = i + (a == 0), j + (a == 1), k + (a == 2)
                    if x < nx and y < ny and z < nz:
                        t = center[x, y, z]
                        bad |= (s > 0 and t == NOT_ASKED) or (t > 0 and s == NOT_ASKED)
                if bad:
                    at[0], at[1], at[2] = i, j, k
                    return True
    return False


@kernel
def _touched(corner, center, corner_touched, center_touched):
    """Flag the vertices on the surface, and the ends of edges at which the sign changes."""
    nx, ny, nz = center.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                s = center[i, j, k]
                if s == 0:
                    center_touched[i, j, k] = True
                for c in range(8):
                    x, y, z = i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2)
                    t = corner[x, y, z]
                    if t == 0:
                        corner_touched[x, y, z] = True
                    if s * t < 0:
                        center_touched[i, j, k] = True
                        corner_touched[x, y, z] = True
                    for a in range(3):
                        if not (c >> a) & 1:
                            p, q, r = x + (a == 0), y + (a == 1), z + (a == 2)
                            if corner[p, q, r] * t < 0:
                                corner_touched[x, y, z] = True
                                corner_touched[p, q, r] = True
                for a in range(3):
                    x, y, z = i + (a == 0), j + (a == 1), k + (a == 2)
                    if x < nx and y < ny and z < nz and s * center[x, y, z] < 0:
                        center_touched[i, j, k] = True
                        center_touched[x, y, z] = True


@kernel
def _around(corner_flags, center_flags, wanted):
    """Flag the cells with a flagged vertex, and those beside cells with a flagged center."""
    nx, ny, nz = center_flags.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                if center_flags[i, j, k]:
                    for face in range(7):
                        step = 1 if face & 1 else -1
                        x = i + (step if face >> 1 == 0 else 0)
                        y = j + (step if face >> 1 == 1 else 0)
                        z = k + (step if face >> 1 == 2 else 0)
                        if 0 <= x < nx and 0 <= y < ny and 0 <= z < nz:
                            wanted[x, y, z] = True
                for c in range(8):
                    if corner_flags[i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2)]:
                        wanted[i, j, k] = True


def marked_cells(frame: Frame, samples: Samples, everywhere: bool) -> tuple[Keys, Keys]:
    """Which cells of the frame's level a tree must have, and which have a vertex inside: two sorted arrays.

    A tetrahedron with a vertex on the surface, or at an edge that the surface crosses, lies in two cells of
    the first kind. So vertices that may move are vertices of the finest lattice alone. With `everywhere`,
    these are all cells with a tetrahedron that has a vertex inside.
    """
    shape = samples.center_signs.shape
    inside = np.zeros(shape, dtype=np.bool_)
    _around(samples.corner_signs > 0, samples.center_signs > 0, inside)
    wanted = inside
    if not everywhere:
        corner, center = np.zeros(samples.corner_signs.shape, np.bool_), np.zeros(shape, np.bool_)
        _touched(samples.corner_signs, samples.center_signs, corner, center)
        wanted = np.zeros(shape, dtype=np.bool_)
        _around(corner, center, wanted)
    keys = [np.sort(keys_of(np.argwhere(flags) + frame.first - 1)) for flags in (wanted, inside)]
    return keys[0], keys[1]
