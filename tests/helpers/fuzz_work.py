"""What `fuzz_regions` does to each region, and how it judges what comes of it.

Each function of `WORK` takes a domain and a generator and returns the name of what was done and came of it,
the mesh, what is wrong with it ("" for nothing), and the domain that the mesh is of.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from unstruct import (
    Domain,
    InputError,
    Mesh,
    MeshError,
    advancing_front,
    circumcenter_insertion,
    conforming_delaunay,
    constrained_delaunay,
    front_delaunay,
    predicates,
    refine,
    simplex,
    smooth,
    swap_diagonals,
    voronoi_segment,
)
from unstruct.base.jit import kernel
from unstruct.domain.domain import as_domain
from unstruct.generate.front.classical import CLASSICAL_ORDERS, SEARCHES
from unstruct.generate.front.run import ORDERS, PLACEMENTS
from unstruct.predicates.batch import scaled
from unstruct.predicates.kernels import incircle, orient2
from unstruct.studies import insert_without_breaking, skeleton_points

BUDGET = 20_000
Done = tuple[str, Mesh, str, Domain]


# --- judging ---------------------------------------------------------------------------------------


@kernel
def first_fault(P, T, N, fixed):
    """0 for none; else 1 turned, 2 neighbors, 3 overlap, 4 not Delaunay; and the cell."""
    for t in range(len(T)):
        a, b, c = P[T[t, 0]], P[T[t, 1]], P[T[t, 2]]
        if orient2(a[0], a[1], b[0], b[1], c[0], c[1]) <= 0:
            return 1, t
        for i in range(3):
            s = N[t, i]
            if s < 0:
                continue
            j = 0
            while j < 3 and N[s, j] != t:
                j += 1
            if j == 3:
                return 2, t
            if T[s, (j + 1) % 3] != T[t, (i + 2) % 3] or T[s, (j + 2) % 3] != T[t, (i + 1) % 3]:
                return 3, t
            q = P[T[s, j]]
            if not fixed[t, i] and incircle(a[0], a[1], b[0], b[1], c[0], c[1], q[0], q[1]) > 0:
                return 4, t
    return 0, -1


FAULTS = ("", "turned cell", "neighbors not mutual", "overlap", "not Delaunay")


def fixed_edges(mesh: Mesh) -> np.ndarray:
    """Which edges opposite corners belong to segments."""
    n = len(mesh.points)
    start, end = (np.roll(mesh.simplices, -k, axis=1).astype(np.int64) for k in (1, 2))
    rows = np.concatenate([mesh.markers["facets"], mesh.markers["inner"]]).astype(np.int64)
    keys = rows.min(axis=1) * n + rows.max(axis=1)
    return np.isin(np.minimum(start, end) * n + np.maximum(start, end), keys)


def extent_of(domain: Domain) -> float:
    """The root of the area of the box, but no less than a thirtieth of its longer side."""
    sides = np.ptp(domain.bounds, axis=0)
    longest = sides.max()
    return float(longest * max((sides.min() / longest) ** 0.5, 1 / 30))


def quick(mesh: Mesh, domain: Domain, delaunay: bool = True) -> str:
    """What is wrong with a mesh of a domain, as far as that is quickly seen; "" for nothing."""
    points, _ = scaled(mesh.points)
    fixed = fixed_edges(mesh)
    fault, cell = first_fault(
        points, mesh.simplices, mesh.neighbors, fixed if delaunay else np.ones_like(fixed)
    )
    if fault:
        return f"{FAULTS[fault]} at cell {cell}"
    if (mesh.neighbors[~fixed] < 0).any():
        return "a boundary edge is no part of a segment"
    sides = np.ptp(domain.bounds, axis=0)
    slack = 1e-12 * sides.prod() + 2.0**-47 * np.abs(domain.bounds).max() * sides.sum()  # of rounding
    if not domain.curves and abs(mesh.volume - domain.area) > slack:
        return f"area {mesh.volume} instead of {domain.area}"
    return ""


def promises(mesh: Mesh, min_angle: float, max_area: float | None) -> str:
    """Whether the cells that miss a limit are those that the mesh says it could not refine."""
    said = np.zeros(mesh.size, dtype=bool)
    said[mesh.unrefined] = True
    missed = mesh.quality("min_angle") < min_angle - 1e-6
    if max_area is not None:
        longest = simplex.edge_lengths(mesh.corners).max(axis=1)
        missed |= mesh.volumes > max_area * (1 + 1e-9) + 2.0**-50 * longest**2  # an area may be only rounding
    if (missed & ~said).any():
        return f"cell {int(np.argmax(missed & ~said))} misses a limit and is not in unrefined"
    if mesh.complete != (not said.any()):
        return "complete does not fit unrefined"
    return ""


# --- what is done to each region -------------------------------------------------------------------


def refined(domain: Domain, rng: np.random.Generator) -> Done:
    """A refinement with options at random: its name, the mesh, and what is wrong with it."""
    method = ("ruppert", "chew", "off-centers")[rng.integers(3)]
    angle = float(rng.choice([0, 15, 20, 25, 30, 33]))
    options: dict[str, Any] = {}
    which = rng.integers(4)
    extent = extent_of(domain)
    if which == 1:
        options["max_area"] = extent**2 * 10.0 ** -rng.uniform(1, 3)
    elif which == 2:
        options["size"] = extent * 10.0 ** -rng.uniform(0.5, 1.5)
    elif which == 3:
        x, y = domain.points[rng.integers(len(domain.points))]
        h = extent * 10.0 ** -rng.uniform(1, 2)
        options["size"] = lambda p: h + 0.3 * np.hypot(p[:, 0] - x, p[:, 1] - y)
    mesh = refine(domain, min_angle=angle, method=method, budget=BUDGET, **options)
    fault = quick(mesh, domain) or promises(mesh, angle, options.get("max_area"))
    reasons = sorted({str(reason).split(":")[0].split(" ")[0] for reason in mesh.reasons})
    return f"refine {method}: {'complete' if mesh.complete else ' + '.join(reasons)}", mesh, fault, domain


def constrained(domain: Domain, rng: np.random.Generator) -> Done:
    """The constrained Delaunay triangulation."""
    mesh = constrained_delaunay(domain)
    return "constrained_delaunay", mesh, quick(mesh, domain), domain


def conforming(domain: Domain, rng: np.random.Generator) -> Done:
    """Midpoints and shells until the boundary is there by itself: then Delaunay across every segment."""
    test = ("missing", "gabriel")[rng.integers(2)]
    shells = ("auto", True, False)[rng.integers(3)]
    extent = extent_of(domain)
    size = extent * 10.0 ** -rng.uniform(0.3, 1.3) if rng.random() < 0.3 else None
    mesh = conforming_delaunay(domain, size, test=test, shells=shells, budget=BUDGET // 10)
    fault = quick(mesh, domain)
    if mesh.complete and not fault:
        points, _ = scaled(mesh.points)
        kind, cell = first_fault(points, mesh.simplices, mesh.neighbors, np.zeros((mesh.size, 3), dtype=bool))
        fault = f"complete, but {FAULTS[kind]} across a segment at cell {cell}" if kind else ""
    elif not fault and (len(mesh.missing) == 0 or not all(mesh.why)):
        fault = "not complete, and it does not say why"
    why = "complete" if mesh.complete else " + ".join(sorted({w.split(" of ")[0][-24:] for w in mesh.why}))
    return f"conforming {test}, shells {shells}: {why}", mesh, fault, domain


def guarded(domain: Domain, rng: np.random.Generator) -> Done:
    """Points thrown at the box of the domain, those that would break its boundary turned away; a skeleton."""
    low, high = domain.bounds
    points = rng.uniform(low, high, (60, 2))
    result = insert_without_breaking(domain, points)
    fault = quick(result.mesh, domain)
    went = result.vertex >= 0
    if not (result.mesh.points[result.vertex[went]] == points[went]).all():
        fault = fault or "a point is not where it was given"
    skeleton = skeleton_points(domain, float((high - low).max()) / 8)
    return "guarded", result.mesh, fault or quick(skeleton.mesh, domain), domain


def centers(domain: Domain, rng: np.random.Generator) -> Done:
    """Circumcenters of worst triangles, by a size or a limit: exactly those that miss it must be listed."""
    split = rng.integers(2) == 0
    extent = extent_of(domain)
    name = ("circumradius", "alpha", "radius_edge", "min_angle", "radius_ratio", "area")[rng.integers(6)]
    if name == "min_angle" and rng.random() < 0.5:
        goal: dict[str, Any] = {"limit": float(rng.choice([10.0, 20.0, 30.0])), "budget": 2000}
    else:
        goal = {
            "size": extent * 10.0 ** -rng.uniform(0.5, 1.5),
            "step": float(rng.choice([0.75, 2.0, 100.0])),
        }
    mesh = circumcenter_insertion(domain, priority=name, split_boundary=split, **goal)
    if "size" in goal:
        missed = 3**0.5 * simplex.circumradius(mesh.corners) / goal["size"] - 1
    else:
        missed = goal["limit"] - mesh.quality("min_angle")
    said = np.zeros(mesh.size, dtype=bool)
    said[mesh.unrefined] = True
    wrong = (missed > 1e-6) & ~said | (missed < -1e-6) & said
    fault = quick(mesh, domain) or (
        f"cell {int(np.argmax(wrong))} is wrongly listed or not" if wrong.any() else ""
    )
    reasons = " + ".join(sorted({reason[-16:] for reason in mesh.reasons.tolist()}))
    return (
        f"centers, split {split}, {'size' if 'size' in goal else 'limit'}: {reasons or 'complete'}",
        mesh,
        fault,
        domain,
    )


def some_size(domain: Domain, rng: np.random.Generator) -> Any:
    """A constant size, or one that grows away from a vertex."""
    extent = extent_of(domain)
    if rng.random() < 0.5:
        return extent * 10.0 ** -rng.uniform(0.3, 1.3)
    x, y = domain.points[rng.integers(len(domain.points))]
    h = extent * 10.0 ** -rng.uniform(0.7, 1.7)
    return lambda p: h + 0.3 * np.hypot(p[:, 0] - x, p[:, 1] - y)


def segments(domain: Domain, rng: np.random.Generator) -> Done:
    """Rebay's insertion, finished or not."""
    finish = bool(rng.random() < 0.7)
    mesh = voronoi_segment(domain, some_size(domain, rng), finish=finish, budget=BUDGET)
    name = "voronoi_segment" + (" finished" if finish else "")
    return f"{name}: {'complete' if mesh.complete else 'incomplete'}", mesh, quick(mesh, domain), domain


def fronts(domain: Domain, rng: np.random.Generator) -> Done:
    """An advancing front in any order, finished or not."""
    options: dict[str, Any] = {"order": str(rng.choice(ORDERS)), "placement": str(rng.choice(PLACEMENTS))}
    finish = bool(rng.random() < 0.7)
    mesh = advancing_front(domain, some_size(domain, rng), finish=finish, budget=BUDGET, **options)
    name = "advancing_front" + (" finished" if finish else "")
    improved = finish and "budget" not in mesh.reasons  # of what a front leaves nothing is improved
    fault = quick(mesh, domain, delaunay=improved)
    outcome = f"{name}: {'complete' if mesh.complete else 'incomplete'}"
    return outcome, mesh if improved or fault else swap_diagonals(mesh), fault, domain


def marched(domain: Domain, rng: np.random.Generator) -> Done:
    """The classical front: raw, so that only its own tests make it valid."""
    options = {"order": str(rng.choice(CLASSICAL_ORDERS)), "search": str(rng.choice(list(SEARCHES)))}
    size = some_size(domain, rng)
    mesh = advancing_front(domain, size, method="classical", finish=False, budget=BUDGET, **options)
    fault = quick(mesh, domain, delaunay=False)
    return f"classical front, {options['search']}", mesh if fault else swap_diagonals(mesh), fault, domain


def wrapped(domain: Domain, rng: np.random.Generator) -> Done:
    """Cell by cell by the empty circle, with points of its own, or with points on a grid or at random."""
    if rng.random() < 0.4:
        finish = bool(rng.random() < 0.5)
        mesh = front_delaunay(domain, some_size(domain, rng), finish=finish, budget=BUDGET)
        name = "front_delaunay, a size" + (", finished" if finish else "")
        return name, mesh, quick(mesh, domain), domain
    low, high = domain.bounds
    unit = rng.random((60, 2)) if rng.random() < 0.5 else np.unique(rng.integers(0, 9, (60, 2)), axis=0) / 8
    points = low + (high - low) * unit
    while True:
        try:
            mesh = front_delaunay(domain, points)
            break
        except InputError as error:
            if not str(error).startswith("points["):
                raise
            points = np.delete(points, int(str(error)[7:].split("]")[0]), axis=0)
    together = np.concatenate([domain.points, points])
    oracle = constrained_delaunay(Domain(together, domain.facets, inner=domain.inner, curves=domain.curves))
    same = (mesh.size, len(mesh.points)) == (oracle.size, len(oracle.points))
    fault = quick(mesh, domain) or ("" if same else "not as the oracle")
    return "front_delaunay, points", mesh, fault, domain


def smoothed(domain: Domain, rng: np.random.Generator) -> Done:
    """A mesh with its inner vertices moved."""
    size = some_size(domain, rng)
    mesh = voronoi_segment(domain, size, finish=False, budget=BUDGET // 4)
    method, swap = ("laplace", "optimal", "centroid", "search")[rng.integers(4)], bool(rng.random() < 0.7)
    try:
        moved = smooth(mesh, method, rounds=3, smart=bool(rng.integers(2)), swap=swap)
    except MeshError as error:
        told = "too many exponents" in str(error)
        return "smooth: too many exponents", mesh, "" if told else f"smooth: {error}", domain
    fault = quick(moved, domain, delaunay=swap)
    if not fault and len(moved.points) != len(mesh.points):
        fault = "smoothing has changed the number of points"
    if not swap and not fault:
        moved = swap_diagonals(moved)
    return f"smooth {method}", moved, fault, domain


def again(domain: Domain, rng: np.random.Generator) -> Done:
    """A mesh refined once more: of straight pieces, since a mesh knows no curves."""
    if domain.curves:
        domain = as_domain(domain.sampled(some_size(domain, rng)))
    which = rng.integers(3)
    if which == 0:
        first: Mesh = constrained_delaunay(domain)
    elif which == 1:
        first = refine(domain, some_size(domain, rng), min_angle=20, budget=BUDGET)
    else:
        first = voronoi_segment(domain, some_size(domain, rng), budget=BUDGET // 4)
    angle = float(rng.choice([0, 20, 28]))
    area = float(first.volume) * 10.0 ** -rng.uniform(0.5, 2.5) if rng.random() < 0.5 else None
    area = area or None  # an area below all doubles limits nothing
    mesh = refine(first, min_angle=angle, max_area=area, budget=BUDGET)
    outcome = f"refine again: {'complete' if mesh.complete else 'incomplete'}"
    return outcome, mesh, quick(mesh, domain) or promises(mesh, angle, area), domain


def resolved(domain: Domain, rng: np.random.Generator) -> Done:
    """A ring and segments thrown over the region, duplicates among the points, and all of it mended."""
    low, high = domain.bounds
    n, facets, curves = len(domain.points), domain.facets.tolist(), dict(domain.curves)
    new = low + rng.integers(0, 9, (int(rng.integers(3, 7)), 2)) / 8 * (high - low)
    inner = domain.inner.tolist()
    moved = {len(facets) + i: i for i in range(len(inner))}  # inner pieces are numbered after the facets
    ring = n + np.arange(3)
    facets += np.column_stack([ring, np.roll(ring, -1)]).tolist()
    curves = {(k + 3 if k in moved else k): curve for k, curve in curves.items()}
    points = np.concatenate([domain.points, new])
    inner += [rng.choice(len(points), 2, replace=False).tolist() for _ in range(int(rng.integers(0, 4)))]
    if rng.random() < 0.3:  # a vertex that is there twice
        points = np.concatenate([points, points[:1]])
        inner.append([len(points) - 1, int(rng.integers(1, len(points) - 1))])
    try:
        result = Domain(points, facets, inner=inner, curves=curves, resolve=True)
    except InputError as error:
        empty = "no facets" in str(error) or "nothing" in str(error)
        fault = "" if curves or empty else f"not resolved: {error}"
        return "resolve: refused", constrained_delaunay(domain), fault, domain
    mesh = constrained_delaunay(result)
    fault = quick(mesh, result)
    x = rng.uniform(low, high, (200, 2))
    wrong = result.contains(x) ^ domain.contains(x) ^ _in_ring(x, new[:3])
    if not fault and wrong.sum() > 2 and np.abs(domain.points).max() > 1e-300:  # below, points fall on sides
        fault = f"{wrong.sum()} of 200 points are on the wrong side, the first {x[np.argmax(wrong)]}"
    return f"resolve: {'repaired' if result.repairs else 'as it was'}", mesh, fault, result


def _in_ring(x: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """Which points lie in a triangle; in none that is flat."""
    turn = predicates.orient(ring)
    signs = [
        predicates.orient(np.stack(np.broadcast_arrays(ring[i], ring[(i + 1) % 3], x), axis=1))
        for i in range(3)
    ]
    return (turn != 0) & (np.array(signs) == turn).all(axis=0)


WORK: dict[str, Callable[[Domain, np.random.Generator], Done]] = {
    "again": again,
    "centers": centers,
    "conforming": conforming,
    "guarded": guarded,
    "refine": refined,
    "resolve": resolved,
    "constrained": constrained,
    "segments": segments,
    "fronts": fronts,
    "classical": marched,
    "wrapped": wrapped,
    "smooth": smoothed,
}
