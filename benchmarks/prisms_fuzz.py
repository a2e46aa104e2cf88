"""Random closed bodies with thirty prismatic layers, judged exactly, and good surfaces that are spoiled.

``python -m benchmarks.prisms_fuzz --count 1000`` makes layers on unions of balls, boxes and cylinders, on
noisy balls, boxes with notches, pairs of bodies beside and within each other, by seed. Each mesh is judged by
`check`, by the exact signs of its wedges, by fractions for some of them, and by a search for edges of its
boundary that meet triangles of it. ``--spoiled 200`` opens, crosses, doubles, turns and tears good surfaces,
which must be refused with the name of a part that was spoiled. ``--several`` asks for several rays at sharp
creases, and that the least scaled Jacobian of no mesh is lower than with one ray.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Triangles = NDArray[np.int32]
LAYERS = 30
FRACTIONS = 12  # wedges of each mesh that are judged by fractions, too
GRAZED = 1e-9  # the gap of some pairs of bodies


class Task(NamedTuple):
    """What layers are made of."""

    name: str
    domain: Any
    layers: Any
    options: dict[str, Any]


# ---------------------------------------------------------------------- bodies


def _merged(rng: np.random.Generator, h: float) -> Any:
    from unstruct import examples

    body = examples.merged_body(int(rng.integers(1 << 30)), parts=int(rng.integers(2, 8)))
    return examples.level_surface(body, h, rounds=int(rng.integers(0, 13)))


def _noisy(rng: np.random.Generator, h: float) -> Any:
    from unstruct import examples

    height, waves = float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.4, 1.0))
    body = examples.noisy_ball(int(rng.integers(1 << 30)), height=height, shortest=waves)
    return examples.level_surface(body, h)


def _notched(rng: np.random.Generator, h: float) -> Any:
    from unstruct import examples

    body = examples.notched_box(float(rng.uniform(0.02, 0.9)), float(rng.uniform(0.1, 1.9)))
    return examples.meshed_sides(body, 1.5 * h)


def _coarse(rng: np.random.Generator, h: float) -> Any:
    """A convex hull of few points: needles, sharp corners, vertices of many triangles."""
    from unstruct import Domain, delaunay

    points = rng.normal(size=(int(rng.integers(5, 40)), 3))
    hull = delaunay(points).boundary
    used, number = np.unique(hull, return_inverse=True)
    return Domain(points[used], number.reshape(-1, 3))


def _gridded(rng: np.random.Generator, h: float) -> Any:
    """Cubes of a grid, joined by their sides: all corners are right angles, convex and concave."""
    from unstruct import Domain

    while True:
        filled = np.zeros((5, 5, 5), dtype=bool)
        filled[1:4, 1:4, 1:4] = rng.random((3, 3, 3)) < 0.6
        quads = _faces_of(filled)
        if not len(quads):
            continue
        corners, number = np.unique(quads.reshape(-1, 3), axis=0, return_inverse=True)
        rows = number.reshape(-1, 4)
        turn = rng.random(len(rows)) < 0.5
        rows = np.where(turn[:, None], np.roll(rows, 1, axis=1), rows)
        triangles = np.concatenate([rows[:, [0, 1, 2]], rows[:, [0, 2, 3]]])
        ends = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        if np.unique(ends, axis=0, return_counts=True)[1].max() == 2:  # else it is refused by name
            return Domain(corners.astype(float), triangles)


def _faces_of(filled: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The outward squares of cubes, as corners (k, 4, 3)."""
    found = []
    for axis in range(3):
        for step in (-1, 1):
            beyond = np.roll(filled, -step, axis=axis)
            cubes = np.argwhere(filled & ~beyond)
            u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
            first = cubes + (step > 0) * np.eye(3, dtype=int)[axis]
            ring = np.stack([first, first + u, first + u + v, first + v], axis=1)
            found.append(ring if step > 0 else ring[:, ::-1])
    return np.concatenate(found)


def _pair(rng: np.random.Generator, h: float) -> Any:
    """Two bodies beside each other, with a gap that may be very small; or one in a cavity of the other."""
    from unstruct import Domain

    a, b = Domain.ball(size=1.5 * h), Domain.ball((0, 0, 0), 0.6, size=1.5 * h)
    facets = np.concatenate([np.asarray(a.facets), np.asarray(b.facets) + len(a.points)])
    if rng.random() < 0.4:
        moved = b.points + rng.uniform(-0.2, 0.2, 3)
        return Domain(np.concatenate([a.points, moved]), facets)
    gap = float(rng.choice([GRAZED, 1e-4, 0.02, 0.3]))
    direction = rng.normal(size=3)
    direction /= np.sqrt((direction**2).sum())
    reach = (a.points @ direction).max() - (b.points @ direction).min() + gap
    moved = b.points + reach * direction
    return Domain(np.concatenate([a.points, moved]), facets)


BODIES: dict[str, Callable[[np.random.Generator, float], Any]] = {
    "merged": _merged, "noisy": _noisy, "notched": _notched, "coarse hull": _coarse, "cubes": _gridded,
    "pair": _pair,
}  # fmt: skip
SHARES = (0.5, 0.2, 0.1, 0.06, 0.08, 0.06)


def task(seed: int) -> Task:
    """A body, layers and options by seed."""
    from unstruct import Layers

    rng = np.random.default_rng(seed)
    kind = list(BODIES)[int(rng.choice(len(SHARES), p=SHARES))]
    h = float(rng.choice([0.14, 0.2, 0.27], p=[0.1, 0.4, 0.5]))
    domain = BODIES[kind](rng, h)
    growth = float(rng.uniform(1.0, 1.35))
    layers = Layers(thickness=h * float(rng.choice([2.0, 5.0, 10.0, 20.0])), growth=growth, count=LAYERS)
    options: dict[str, Any] = {"normals": str(rng.choice(["visible", "staged", "angle", "area"]))}
    options["side"] = "inside" if rng.random() < 0.2 else "outside"
    options["smoothing"] = int(rng.choice([0, 5, 10]))
    options["stop"] = str(rng.choice(["squeeze", "stop"], p=[0.7, 0.3]))
    options["cells"] = str(rng.choice(["wedge", "tetrahedron"], p=[0.8, 0.2]))
    return Task(f"{kind} {seed}", domain, layers, options)


# ---------------------------------------------------------------------- the judgment


def corner_signs(x: Array) -> NDArray[np.int8]:
    """The least of the exact signs of the Jacobian at the six corners of wedges (m, 6, 3)."""
    from unstruct.predicates import orient

    frames = [(0, 1, 2, 3), (1, 2, 0, 4), (2, 0, 1, 5), (3, 4, 5, 0), (4, 5, 3, 1), (5, 3, 4, 2)]
    signs = np.stack([orient(x[:, list(f)]) * (1 if k < 3 else -1) for k, f in enumerate(frames)], axis=1)
    return signs.min(axis=1)


def crossings(points: Array, triangles: Triangles) -> int:
    """How many edges of triangles meet another triangle outside of common vertices."""
    from unstruct.geometry.triangle_pairs import edges_of, meetings_in_space

    return len(meetings_in_space(points, triangles, edges_of(triangles)).kind)


def skin(mesh: Any) -> Triangles:
    """The base and the cap, as triangles, each once."""
    from unstruct.mesh.split import simplices_of_cells

    cap = mesh.steps["cap"]
    if cap.shape[1] == 4:
        quads = cap[:, 3] >= 0
        cap = np.concatenate([cap[~quads, :3], simplices_of_cells({"quad": cap[quads]})[0]])
    rows = np.concatenate([np.asarray(mesh.faces), cap]).astype(np.int32)
    return rows[np.unique(np.sort(rows, axis=1), axis=0, return_index=True)[1]]


def judged(mesh: Any, seed: int = 0) -> dict[str, Any]:
    """Everything that is wrong with layers, as counts; and how good they are."""
    from unstruct import check
    from unstruct.geometry.jacobians import wedge_signs
    from unstruct.plain.prisms import wedge_is_positive

    wedges = np.asarray(mesh.cells["wedge"]) if "wedge" in mesh.cells else np.empty((0, 6), dtype=int)
    x = mesh.points[wedges]
    corners, whole = corner_signs(x), wedge_signs(x)
    rng = np.random.default_rng(seed)
    some = rng.choice(len(x), min(FRACTIONS, len(x)), replace=False)
    worst = _least_jacobians(x)
    if len(x):
        some = np.concatenate([some, np.argsort(worst)[:FRACTIONS]])
    fractions = [bool(wedge_is_positive(x[i, :3].tolist(), x[i, 3:].tolist())) for i in some]
    report = check(mesh)
    return {
        "cells": int(mesh.size),
        "inverted": int((corners <= 0).sum()),
        "not positive inside": int(((corners > 0) & (whole != 1)).sum()),
        "fractions disagree": int((np.array(fractions, dtype=bool) != (whole[some] == 1)).sum()),
        "crossings": crossings(mesh.points, skin(mesh)),
        "check": [problem.kind for problem in report.problems],
        "least scaled Jacobian": float(worst.min()) if len(x) else 1.0,
        "below .01": float((worst < 0.01).mean()) if len(x) else 0.0,
        "full": float(mesh.figures["share of full heights"]),
        "counts": {name: int(n) for name, n in mesh.counts.items()},
        "reasons": dict(Counter(mesh.steps["reason"].tolist())),
        "lower": 0,
    }


def _least_jacobians(x: Array) -> Array:
    """The least scaled Jacobian at the corners of each wedge; 1 for a right prism over an equal triangle."""
    least = np.full(len(x), np.inf)
    for k in range(6):
        low = 0 if k < 3 else 3
        i, j = low + (k - low + 1) % 3, low + (k - low + 2) % 3
        up = (k + 3) % 6
        a, b, c = (x[:, i] - x[:, k], x[:, j] - x[:, k], (x[:, up] - x[:, k]) * (1 if k < 3 else -1))
        size = np.sqrt((a**2).sum(axis=1) * (b**2).sum(axis=1) * (c**2).sum(axis=1))
        volume = (np.cross(a, b) * c).sum(axis=1)
        least = np.minimum(least, volume / np.maximum(size, 1e-300) * 2 / np.sqrt(3))
    return least


FAULTS = ("inverted", "not positive inside", "fractions disagree", "crossings", "check", "lower")
SAME_LEAST = 1.0 - 1e-12


def run(seeds: range, options: dict[str, Any] | None = None, tell: bool = True) -> list[dict[str, Any]]:
    """Judge many bodies; a row for each, with an "error" where there is no mesh."""
    import warnings

    from unstruct import UnstructError, prismatic_layers

    rows = []
    for seed in seeds:
        try:
            given = task(seed)
        except UnstructError as error:  # the surface touches itself: it is no task
            rows.append({"seed": seed, "name": f"no body {seed}", "no body": str(error)})
            continue
        row: dict[str, Any] = {"seed": seed, "name": given.name, "triangles": len(given.domain.facets)}
        begin = time.process_time()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                chosen = given.options | (options or {})
                mesh = prismatic_layers(given.domain, layers=given.layers, **chosen)
            row["seconds"] = time.process_time() - begin
            row |= judged(mesh, seed)
            if chosen.get("several"):
                row |= _compared(given, mesh, chosen)
        except UnstructError as error:
            row["refused"] = str(error)
        rows.append(row)
        if tell and any(row.get(fault) for fault in FAULTS):
            print("FAULT", {key: row[key] for key in ("name", *FAULTS)}, given.options, flush=True)
    return rows


def _compared(given: Task, mesh: Any, options: dict[str, Any]) -> dict[str, Any]:
    """Whether a mesh with several rays is worse than that with one, and the ratio where there are any."""
    import warnings

    from unstruct import prismatic_layers

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        one = prismatic_layers(given.domain, layers=given.layers, **options | {"several": False})
    before, after = (float(m.quality("scaled_jacobian").min()) for m in (one, mesh))
    some = mesh.counts["creases with fans"] > 0
    return {"lower": int(after < SAME_LEAST * before)} | ({"ratio": after / before} if some else {})


def summary(rows: list[dict[str, Any]]) -> str:
    """What was found, as text."""
    made = [row for row in rows if "cells" in row]
    reasons: Counter[str] = Counter()
    for row in made:
        reasons.update(row["reasons"])
    rays = sum(reasons.values())
    lines = [f"{len(made)} bodies, {sum(r['cells'] for r in made)} cells, "
             f"{sum('no body' in r for r in rows)} surfaces that touch themselves"]  # fmt: skip
    lines += [f"{fault}: {sum(bool(r[fault]) if fault == 'check' else r[fault] for r in made)}"
              for fault in FAULTS]  # fmt: skip
    lines += [f"refused: {row['name']}: {row['refused']}" for row in rows if "refused" in row]
    lines.append(", ".join(f"{name} {100 * n / rays:.2f} %" for name, n in reasons.most_common()))
    full = np.array([row["full"] for row in made])
    least = np.array([row["least scaled Jacobian"] for row in made])
    lines.append(f"share of full heights: mean {full.mean():.3f}, median {np.median(full):.3f}")
    lines.append(f"least scaled Jacobian: median {np.median(least):.2g}, worst {least.min():.2g}; "
                 f"cells below .01: {np.mean([r['below .01'] for r in made]):.2g}")  # fmt: skip
    lines.append(f"rounds: most {max(r['counts'].get('rounds', 0) for r in made)}; "
                 f"hidden rays: {sum(r['counts'].get('hidden', 0) for r in made)}, collapsed columns: "
                 f"{sum(r['counts'].get('collapsed', 0) for r in made)}; "
                 f"slowest {max(r['seconds'] for r in made):.2f} s")  # fmt: skip
    ratios = [row["ratio"] for row in made if "ratio" in row]
    if ratios:
        lines.append(f"several rays on {len(ratios)} bodies, the least scaled Jacobian times "
                     f"{np.median(ratios):.3f} (median), {max(ratios):.3g} at most")  # fmt: skip
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> None:
    """Judge bodies and spoil surfaces."""
    from .prisms_spoiled import spoiled_summary

    parser = argparse.ArgumentParser(prog="python -m benchmarks.prisms_fuzz", description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--spoiled", type=int, default=200)
    parser.add_argument("--several", action="store_true")
    options = parser.parse_args(arguments)
    more = {"several": True, "stop": "squeeze"} if options.several else None
    if options.count:
        print(summary(run(range(options.first, options.first + options.count), more)))
    if options.spoiled:
        print(spoiled_summary(options.spoiled))


if __name__ == "__main__":
    main()
