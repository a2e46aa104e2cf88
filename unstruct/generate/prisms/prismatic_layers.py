"""Prismatic layers: wedges along the walls of a body, of which not one is inverted (12.5)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_count, as_flags, as_mapping, as_seed, finite
from ...base.errors import HiddenVertexWarning, InputError
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.stretching import Layers
from .cells import cells_of, in_one_fan
from .directions import NORMALS
from .records import HIDDEN_RAY, RAY_REASONS
from .run import PrismOptions, PrismRun
from .walls import WALL_SIDES, base_of

__all__ = ["layers_alone", "prismatic_layers"]

STOPPING, PRISM_CELLS = ("squeeze", "stop"), ("wedge", "tetrahedron")


def prismatic_layers(
    surface: Any,
    size: Any = None,
    *,
    layers: Layers,
    walls: Any = None,
    side: str | None = None,
    normals: str = "visible",
    ridge: float = 40.0,
    smoothing: int = 10,
    recompute: bool = False,
    several: bool = False,
    stop: str = "squeeze",
    cells: str = "wedge",
    fill_options: Mapping[str, Any] | None = None,
    seed: int = 0,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Layers of thin wedges along the walls of a body in space.

    Parameters
    ----------
    surface : Domain or Mesh
        A body, or a surface of triangles in space. A mesh may be open if each loop of its border lies in a
        plane; the layers end there.
    size : number, function (k, 3) -> (k,), or SizeField, optional
        The domain beyond the layers is filled with tetrahedra of this size; without it there are layers only.
    layers : Layers
        The heights of the layers, with an end (give a count).
    walls : str, int, or list of these, optional
        Names of markers, or pieces, along which there are layers; by default all facets. Facets beside walls
        must be plane: layers end there.
    side : "inside" or "outside", optional
        On which side of the surface the layers are; "inside" by default where there is a size, else
        "outside". Of an open mesh, "outside" is where its normals point.
    normals : "visible", "staged", "angle" or "area"
        The directions of rays; see the notes.
    ridge : float
        The angle between normals, in degrees, from which on an edge is a geometric one ("staged").
    smoothing : int
        Rounds in which directions are smoothed.
    recompute : bool
        Whether directions are computed anew on each layer.
    several : bool
        Whether sharp convex creases get several rays at a vertex.
    stop : "squeeze" or "stop"
        Where there is no room: all layers become thinner, or there are fewer of them.
    cells : "wedge" or "tetrahedron"
        Whether cells of the layers are divided.
    fill_options : dict, optional
        More arguments of `tetrahedralize`.
    seed : int
        Of its random numbers.
    budget : int, optional
        How many points it may add.
    progress : bool
        Show progress bars.

    Returns
    -------
    DomainMesh
        Cells "wedge", all positive: exactly, on the whole of each. ``markers`` has the names of the surface
        on the faces of the base, and "cap", the outer faces. ``steps`` has one row for each ray: "vertex" (a
        row of ``points``, -1 if no cell is left there), "place" (r, 3), "direction" (r, 3), "level" (how many
        layers), "height" (their total), "wanted", and "reason", why it is not more: "full" (it is as wanted),
        "column" (a cell would not be positive), "crossing" (the layers would meet others, or the surface),
        "gradation" (a neighbor is lower), "hidden" (no direction sees all triangles there). "cell_layer" has
        for each cell its layer from 1 on, "cap" (t, 3) the outer faces.
        ``counts``: "rays", "wedges", "hidden", "limited: ..." for each reason, "collapsed" (columns beside
        rays of no height, which are left out), "rounds" of lowering. ``figures``: "share of full heights",
        "least scaled Jacobian".

    Raises
    ------
    InputError
        For layers without an end, unknown names, walls that touch themselves, borders that are not plane,
        surfaces that are turned against themselves; and as `Domain` does.

    Notes
    -----
    A direction sees a triangle if it is within a right angle of its normal. "visible" is the direction whose
    largest angle with the normals at a vertex is smallest: it sees all triangles there whenever any direction
    does. "staged": weighted by angles, but on geometric edges the mean of both sides. "angle", "area": weighted
    sums. Where one of these does not see all, the first is taken.

    *Heights* are at most .7 of what keeps the Jacobian of a whole column positive, differ by at most the
    length of an edge along it, and are lowered by a factor .7 where a wedge, as rounded, is not positive, or
    where cap, base, sides and the rest of the surface meet, until nothing is wrong. All this is decided by
    exact signs; so the layers do not overlap (see the book, chapter 5).

    O(t k + t log t) for t triangles and k layers, in practice. Book: 5.
    """
    as_flags(recompute=recompute, several=several, progress=progress)
    if not isinstance(layers, Layers):
        raise InputError(f"layers must be Layers(first=..., count=...), not {type(layers).__name__}")
    if layers.count is None and not layers.varies:
        raise InputError("these layers have no end: give count, Layers(first=..., growth=..., count=20)")
    side = ("outside" if size is None else "inside") if side is None else side
    for name, value, known in (
        ("side", side, WALL_SIDES), ("normals", normals, NORMALS), ("stop", stop, STOPPING),
        ("cells", cells, PRISM_CELLS),
    ):  # fmt: skip
        if not isinstance(value, str) or value not in known:
            raise InputError(f"{name} must be one of {', '.join(map(repr, known))}, not {value!r}")
    ridge, smoothing = finite(ridge, "ridge"), as_count(smoothing, "smoothing")
    as_mapping({} if fill_options is None else fill_options, "fill_options")
    as_seed(seed)
    if budget is not None:
        as_count(budget, "budget")
    base = base_of(surface, walls, side)
    run = PrismRun(base, layers, PrismOptions(normals, ridge, smoothing, recompute, progress))
    run.advance()
    _tell_hidden(run)
    return noticed(layers_alone(run))


def _tell_hidden(run: PrismRun) -> None:
    """Warn of vertices at which no direction sees all triangles."""
    hidden = np.flatnonzero(run.rays.reason == HIDDEN_RAY)
    if len(hidden):
        v = int(run.base.walls.vertex[hidden[0]])
        x, y, z = run.base.others.points[v].tolist()
        warnings.warn(
            f"at {len(hidden)} vertices of the walls no direction sees all triangles, so that there are no "
            f"layers: the first is point {v} at ({x:.6g}, {y:.6g}, {z:.6g}); see mesh.steps",
            HiddenVertexWarning,
            stacklevel=3,
        )


def _numbers(run: PrismRun) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """The vertex of each ray on each level, -1 for those that no cell has; and which columns are kept."""
    moves = run.rays.height > 0.0
    kept = in_one_fan(run.stars, run.columns, moves[run.columns].all(axis=1))
    used = np.zeros(len(moves), dtype=bool)
    used[run.columns[kept]] = True
    many = int(used.sum())
    number = np.full((run.levels + 1, len(moves)), -1, dtype=np.int32)
    number[:, used] = np.arange((run.levels + 1) * many, dtype=np.int32).reshape(-1, many)
    return number, kept


def layers_alone(run: PrismRun) -> DomainMesh:
    """The mesh of layers with its account."""
    base, rays = run.base, run.rays
    number, kept = _numbers(run)
    if not kept.any():
        raise InputError(
            "no layer is possible anywhere: the walls are too close to each other, or seen from nowhere"
        )
    columns = run.columns[kept]
    found = cells_of(columns, number)
    used = number[0] >= 0
    points = run.places[:, used].reshape(-1, 3)
    origin = np.full(len(points), -1, dtype=np.int32)
    origin[: int(used.sum())] = base.origin[base.walls.vertex[used]]
    bottom, cap, piece = number[0][columns], number[-1][columns], base.walls.piece[kept]
    markers: dict[str, Any] = {
        name: bottom[np.isin(piece, pieces)] for name, pieces in base.markers.items() if len(pieces)
    }
    markers = {name: rows for name, rows in markers.items() if len(rows)} | {"cap": cap}
    steps = {
        "vertex": number[0],
        "place": base.walls.points,
        "direction": rays.direction,
        "level": rays.level,
        "height": rays.height,
        "wanted": rays.wanted,
        "reason": np.array(RAY_REASONS)[rays.reason],
        "cell_layer": found.layer + 1,
        "cap": cap,
    }
    mesh = DomainMesh(
        points,
        None,
        cells=found.kinds,
        origin=origin,
        markers=markers,
        faces=bottom,
        face_piece=piece,
        steps=steps,
        counts=_counts(run, found.kinds, int((~kept).sum())),
    )
    full = float((rays.height >= rays.wanted).sum()) / max(len(rays.height), 1)
    mesh.figures.update({"share of full heights": full})
    return mesh


def _counts(run: PrismRun, kinds: Mapping[str, Any], collapsed: int) -> dict[str, int]:
    """How many there are of what."""
    many = np.bincount(run.rays.reason, minlength=len(RAY_REASONS)).tolist()
    names = {"wedge": "wedges", "pyramid": "pyramids", "tetra": "tetrahedra"}
    return {
        "rays": len(run.rays.height),
        **{word: len(kinds.get(kind, ())) for kind, word in names.items()},
        "hidden": many[HIDDEN_RAY],
        **{f"limited: {name}": many[i] for i, name in enumerate(RAY_REASONS) if i},
        "collapsed": collapsed,
        "rounds": run.rounds,
    }
