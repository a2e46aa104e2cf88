"""Prismatic layers: wedges along the walls of a body, of which not one is inverted (12.5)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_count, as_flag, as_flags, as_mapping, as_seed, finite
from ...base.arrays import frozen
from ...base.errors import DomainError, HiddenVertexWarning, InputError
from ...domain.space.by_part import size_by_part
from ...mesh.domain_mesh import DomainMesh, noticed
from ...mesh.mesh import Mesh
from ...sizing.field import as_size
from ...sizing.stretching import Layers
from .alone import layers_of_columns
from .beyond import filled_beyond
from .cells import in_one_fan
from .closing import closed_in_planes
from .columns import scaled_columns
from .directions import NORMALS
from .fans import NO_APEXES, fan_quality
from .flat_sides import as_pieces_of, with_flat_sides
from .growing import grown_layers, in_tetrahedra
from .records import HIDDEN_RAY, RAY_REASONS
from .remainder import Grown
from .run import PrismOptions, PrismRun
from .several import run_with_fans
from .stop_run import StopRun
from .walls import WALL_SIDES, base_of, must_end_on_facets

__all__ = ["layers_alone", "prismatic_layers"]

NO_LAYERS = "no layer is possible anywhere: the walls are too close to each other, or seen from nowhere"
NEAREST_DOUBLES = 2.0**-52  # how far they are apart, by their size
ROOM_BEYOND = 0.4  # how much higher layers could be before they meet something; unit: their height
MOST_SMOOTHING = 1000
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
        plane; the layers end there. With a size, polygons close it there, named "end 0", "end 1", ...
    size : number, function (k, 3) -> (k,), SizeField, or dict of region name to one, optional
        What the layers leave of the body is filled with tetrahedra of this size, as by `tetrahedralize`: the
        mesh is one of the whole body. Without it there are layers only.
    layers : Layers
        The heights of the layers, with an end (give a count).
    walls : str, int, or list of these, optional
        Names of markers, or pieces, along which there are layers; by default all facets. Facets beside walls
        must be plane: layers end there, on those with an edge of a wall. Those that are cut into triangles
        in such a plane are taken as one polygon, if they have the same names, without points on straight
        edges between two polygons.
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
        Whether vertices of sharp convex creases get several rays, where these raise the least scaled
        Jacobian of all cells there, as they are in the mesh. That of the whole mesh is never lower than with
        one ray. See the notes. Only with ``recompute=False`` and ``stop="squeeze"``.
    stop : "squeeze" or "stop"
        Where there is no room: all layers become thinner, or there are fewer of them, with numbers that
        differ by at most 1 along each edge; pyramids and tetrahedra are then on top of wedges, and the cap
        has triangles only.
    cells : "wedge" or "tetrahedron"
        With "tetrahedron" all cells are divided, quadrilaterals from their lowest vertex, so that they fit;
        heights are lowered until each tetrahedron is positive.
    fill_options : dict, optional
        ``optimize`` and ``split_boundary`` (None or False) of `tetrahedralize`.
    seed : int
        Of its random numbers.
    budget : int, optional
        With a size, how many points it may add beyond the layers; as for `tetrahedralize`.
    progress : bool
        Show progress bars.

    Returns
    -------
    DomainMesh
        Cells "wedge", "pyramid" and "tetra", all positive: exactly, on the whole of each. ``markers`` has the
        names of the surface on the faces of the base, and of the sides in planes (rows of four, triangles
        padded by -1, where there are quadrilaterals), and "cap", the faces on top of the layers (with
        ``several`` and no size, too, rows of four where there are quadrilaterals). With a size
        the cells of the layers come first among those of each kind, "tetra" is the last kind, and ``faces``
        has quadrilaterals as two triangles. ``steps`` has one row for each ray: "vertex" (a
        row of ``points``, -1 if no cell is left there), "place" (r, 3), "direction" (r, 3), "level" (how many
        layers), "height" (their total), "wanted", and "reason", why it is not more: "full" (it is as wanted),
        "column" (a cell would not be positive), "crossing" (the layers would meet others, or the surface),
        "gradation" or "step" (a neighbor is lower), "hidden" (no direction sees all triangles there).
        "cell_layer" has for each cell of the layers its layer from 1 on (that of pyramids on hexahedra is one
        more than there are layers), "cap" (t, 3) or (t, 4) the faces on top.
        ``counts``: "rays", "wedges", "pyramids", "tetrahedra" (of the layers), "hidden", "limited: ..." for
        each reason, "collapsed" (columns without cells; without a size also those beside rays of no height,
        which are left out), "rounds" of lowering; with ``several`` "hexahedra", "creases with fans" and
        "creases with one ray" (sharp convex ones). ``figures``: "share of full heights", "least scaled
        Jacobian" (of wedges and hexahedra, before any are cut); with a size "jump of volume at the cap,
        median" (the volume of the tetrahedron beyond over that of the cell below) and "..., largest" (up or
        down), "least dihedral angle beyond".

    Raises
    ------
    InputError
        For layers without an end, unknown names, walls that touch themselves, borders that are not plane,
        surfaces that are turned against themselves; and as `Domain` does. If no layer is possible. With a
        size, for walls that end where the body is concave, for inner pieces that end at walls, for these and
        loose points in the layers, and as `tetrahedralize` does.

    Notes
    -----
    A direction sees a triangle if it is within a right angle of its normal. "visible" is the direction whose
    largest angle with the normals at a vertex is smallest: it sees all triangles there whenever any direction
    does. "staged": weighted by angles, but on geometric edges the mean of both sides. "angle", "area": sums
    with such weights. Where one of these does not see all, the first is taken.

    *Heights* are at most .7 of what keeps the Jacobian of a whole column positive, differ by at most the
    length of an edge along it, and are lowered by a factor .7 where a wedge, as rounded, is not positive, or
    where cap, base, sides and the rest of the surface meet, until nothing is wrong. All this is decided by
    exact signs; so the layers do not overlap (see the book, chapter 5). With a size, caps two fifths
    higher would not meet anything either, so that tetrahedra find room between them. If the rest cannot be
    filled with the cap kept, triangle by triangle, by any of three seeds, a warning says where; then the mesh
    is not one of the body, and ``complete`` is False. Layers that are lower than wanted, or missing, do not
    count there: see ``figures``, ``counts`` and ``steps``.

    *Several* rays, one in 45 degrees, start at vertices of convex creases, where a wall turns by more than
    50 degrees. Wedges lying on their side are over the edges, hexahedra above. With a size, pyramids stand on
    these, half as high as edges of the crease are long, or lower where there is no room. Where three or more
    creases meet, tetrahedra are at the corner and wedges above. A crease is a chain of edges between such
    corners; it gets fans only if the least scaled Jacobian of the cells at its vertices is then higher, and
    of no others lower than anywhere before, if the layers are at least half as high, and if it is closed, or
    ends at corners or in planes. With a size the whole mesh is made with fans and without, and the better
    one returned: tetrahedra on the cap over a crease are as narrow as the layers are high. In tetrahedra,
    several rays are rarely better: only if the first layer is about as high as edges are long. Where a
    crease ends within a wall there is only one ray, and cells between several rays and one would be thinner
    than those they replace.

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
    if not 0.0 <= ridge <= 180.0:
        raise InputError(f"ridge = {ridge:.6g} must be an angle from 0 to 180 degrees: 40, for instance")
    if smoothing > MOST_SMOOTHING:
        raise InputError(f"smoothing = {smoothing} must be at most {MOST_SMOOTHING} rounds: 10, for instance")
    if several and (recompute or stop != "squeeze"):
        raise InputError(
            'several rays at a vertex are for recompute=False and stop="squeeze": all of a fan have the same '
            "number of layers, along straight lines; leave one of these out"
        )
    try:
        closed = closed_in_planes(surface) if isinstance(surface, Mesh) and size is not None else None
    except DomainError:
        base_of(surface, None, side)  # says what is wrong with the surface itself
        raise
    if closed is not None:
        surface, walls = closed.domain, closed.walls if walls is None else walls
    surface, walls, parts = with_flat_sides(surface, walls)
    base = base_of(surface, walls, side)
    fill = _fill_options(size, side, fill_options, seed, budget, progress)
    if size is not None:
        must_end_on_facets(base)
    room = 0.0 if size is None else ROOM_BEYOND
    options = PrismOptions(normals, ridge, smoothing, recompute, progress, cells, room)
    fanned = run_with_fans(base, layers, options) if several else None
    if fanned is not None:
        run = fanned.run
    else:
        run = (StopRun if stop == "stop" else PrismRun)(base, layers, options)
        run.advance()
    _tell_hidden(run)
    mesh, lacking = _made(run, size, fill)
    if fanned is not None:
        many = [fanned.fanned, fanned.single]
        if fanned.fanned:
            other, other_lacking = _made(fanned.without, size, fill)
            if (not other_lacking, _least(other)) > (not lacking, _least(mesh)):
                mesh, lacking, many = other, other_lacking, [0, sum(many)]
        mesh.counts.update({"creases with fans": many[0], "creases with one ray": many[1]})
    if parts is not None:
        as_pieces_of(mesh, parts)
    if closed is not None:
        origin = np.asarray(mesh.origin)
        mesh.origin = frozen(np.where(origin >= 0, closed.origin[origin], -1).astype(np.int32))
    return noticed(mesh, lacking)


def _fill_options(size: Any, side: str, given: Any, seed: Any, budget: Any, progress: bool) -> dict[str, Any]:
    """The arguments for what is beyond, checked."""
    more = dict(as_mapping({} if given is None else given, "fill_options"))
    unknown = sorted(set(map(str, more)) - {"optimize", "split_boundary"})
    if unknown:
        raise InputError(f"fill_options may have 'optimize' and 'split_boundary', not {unknown[0]!r}")
    optimize, split = as_flag(more.get("optimize", True), "optimize"), more.get("split_boundary")
    if split is not None and as_flag(split, "split_boundary"):
        raise InputError("split_boundary=True would divide the triangles of the cap: leave it out, or False")
    if size is not None and side != "inside":
        raise InputError(
            'size is for a body that the layers leave, but side="outside" has no end: give a body, for '
            "instance Domain.box(...).with_holes(body), with the layers inside"
        )
    return {
        "optimize": optimize,
        "split_boundary": split,
        "seed": as_seed(seed),
        "budget": None if budget is None else as_count(budget, "budget"),
        "progress": progress,
    }


def _tell_hidden(run: PrismRun) -> None:
    """Warn of vertices without any layer: no direction sees all triangles there, or there is no room."""
    none = run.rays.level == 0
    hidden = none & (run.rays.reason == HIDDEN_RAY)
    for rows, why in ((hidden, "no direction sees all triangles"), (none & ~hidden, "there is no room")):
        many = int(rows.sum())
        if many:
            v = int(run.base_row[np.argmax(rows)])
            x, y, z = run.base.others.points[v].tolist()
            warnings.warn(
                f"at {many} {'vertex' if many == 1 else 'vertices'} of the walls {why}, so that there are no "
                f"layers: the first is point {v} at ({x:.6g}, {y:.6g}, {z:.6g}); see mesh.steps",
                HiddenVertexWarning,
                stacklevel=3,
            )


def _why_none(run: PrismRun) -> str:
    """Why there are no layers at all."""
    least = float((np.diff(run.shares, axis=1).min(axis=1) * run.total).min())
    farthest = float(np.abs(run.base.walls.points).max())
    first = float((run.shares[:, 1] * run.total).min())
    if least < NEAREST_DOUBLES * farthest:
        return (
            f"no layer is possible: the thinnest is {least:.3g}, but numbers as large as these coordinates, "
            f"{farthest:.3g}, are {NEAREST_DOUBLES * farthest:.1g} apart; give thicker "
            "layers, or move the body to the origin"
        )
    if isinstance(run, StopRun):
        return f'{NO_LAYERS}, for a first layer of {first:.3g}: give less, or stop="squeeze" (thinner ones)'
    return NO_LAYERS


def layers_alone(run: PrismRun) -> DomainMesh:
    """The mesh of layers with its account."""
    with_layers: NDArray[np.bool_] = run.rays.level > 0
    kept = in_one_fan(run.stars, run.base.walls.triangles, with_layers[run.columns].min(axis=1))
    if not kept.any():
        raise InputError(_why_none(run))
    grown = _grown(run)
    kept = np.concatenate([kept, np.ones(len(grown.cap) - len(kept), dtype=bool)])
    found = layers_of_columns(run.base, grown, kept)
    return _with_account(
        run,
        found.grown,
        found.vertex,
        DomainMesh(
            found.grown.points,
            None,
            cells=found.grown.cells,
            origin=found.origin,
            markers=found.markers,
            faces=found.faces,
            face_piece=found.face_piece,
        ),
        int((~kept).sum()),
    )


def _made(run: PrismRun, size: Any, fill: Mapping[str, Any]) -> tuple[DomainMesh, str]:
    return (layers_alone(run), "") if size is None else _layers_and_beyond(run, size, fill)


def _least(mesh: DomainMesh) -> float:
    return float(mesh.quality("scaled_jacobian").min())


def _layers_and_beyond(run: PrismRun, size: Any, fill: Mapping[str, Any]) -> tuple[DomainMesh, str]:
    """The mesh of the whole body, and what is missing."""
    domain = run.base.domain
    assert domain is not None
    if not (run.rays.level > 0).any():
        raise InputError(_why_none(run))
    grown = _grown(run)
    field = as_size(size_by_part(domain, size))
    mesh, lacking = filled_beyond(domain, grown, field, dict(fill))
    vertex = np.arange(len(run.base.walls.points))
    return _with_account(run, grown, vertex, mesh, int((grown.base == grown.cap).all(axis=1).sum())), lacking


def _grown(run: PrismRun) -> Grown:
    rays = run.rays
    rows = run.columns, run.fans, run.how, run.apexes
    grown = grown_layers(run.base.walls, rays.base, rays.level, run.places, *rows)
    return in_tetrahedra(grown) if run.options.cells == "tetrahedron" else grown


def _with_account(
    run: PrismRun, grown: Grown, vertex: NDArray[np.integer], mesh: DomainMesh, collapsed: int
) -> DomainMesh:
    """A mesh with a record of its rays; ``vertex`` has for each vertex of a wall that of the mesh."""
    rays = run.rays
    mesh.steps = {
        "vertex": vertex[rays.base].astype(np.int32),
        "place": run.base.walls.points[rays.base],
        "direction": rays.direction,
        "level": rays.level,
        "height": rays.height,
        "wanted": rays.wanted,
        "reason": np.array(RAY_REASONS)[rays.reason],
        "cell_layer": (grown.layer + 1).astype(np.int32),
        "cap": grown.cap.astype(np.int32),
    }
    mesh.counts.update(_counts(run, grown.cells, collapsed))
    full = float((rays.height >= rays.wanted).sum()) / max(len(rays.height), 1)
    least = scaled_columns(run.places, run.columns, rays.level).min(initial=np.inf)
    least = min(least, fan_quality(run.fans, run.places, "whole", NO_APEXES).min(initial=np.inf))
    mesh.figures.update({"share of full heights": full, "least scaled Jacobian": float(least)})
    return mesh


def _counts(run: PrismRun, kinds: Mapping[str, Any], collapsed: int) -> dict[str, int]:
    """How many there are of what."""
    many = np.bincount(run.rays.reason, minlength=len(RAY_REASONS)).tolist()
    names = {"wedge": "wedges", "pyramid": "pyramids", "tetra": "tetrahedra"}
    if len(run.fans.quads):
        names["hexahedron"] = "hexahedra"
    return {
        "rays": len(run.rays.height),
        **{word: len(kinds.get(kind, ())) for kind, word in names.items()},
        "hidden": many[HIDDEN_RAY],
        **{f"limited: {name}": many[i] for i, name in enumerate(RAY_REASONS) if i},
        "collapsed": collapsed,
        "rounds": run.rounds,
    }
