"""Good surfaces, spoiled by seed: `prismatic_layers` must refuse each, and name a part that was spoiled."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Triangles = NDArray[np.int32]
Spoiled = tuple[Array, Triangles, set[int], set[int]]  # points, triangles, spoiled points, spoiled triangles
KINDS_OF_BODIES = 3
WORDS = "point|vertex|vertices|facet|row|edge|triangle|cell|simplice"
NAMED = re.compile(rf"(?:{WORDS})s?[ \[]+(\d+)(?:\s*(?:-|and|,)\s*(\d+))?")


def good(seed: int) -> tuple[Array, Triangles]:
    """A surface without faults."""
    from unstruct import Domain, examples

    kind = seed % KINDS_OF_BODIES
    if kind == 0:
        body = Domain.ball(size=0.45)
    elif kind == 1:
        body = examples.level_surface(examples.merged_body(seed), 0.25)
    else:
        body = examples.meshed_sides(Domain.box(), 0.35)
    return body.points.copy(), np.array(body.facets, dtype=np.int32)


# ---------------------------------------------------------------------- ways to spoil


def torn(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """Triangles around a vertex are missing: the border is in no plane."""
    v = int(rng.integers(len(points)))
    gone = (t == v).any(axis=1)
    used, number = np.unique(t[~gone], return_inverse=True)
    border = np.flatnonzero(np.isin(used, t[gone]))
    return points[used], number.reshape(-1, 3).astype(np.int32), set(border.tolist()), set()


def missing(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """One triangle is missing."""
    i = int(rng.integers(len(t)))
    return points, np.delete(t, i, axis=0), set(t[i].tolist()), set()


def crossing(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A vertex is moved inward, through the body and far beyond it."""
    v = int(rng.integers(len(points)))
    x = points.copy()
    p, q, r = (points[t[(t == v).any(axis=1)][:, k]] for k in range(3))
    normal = np.cross(q - p, r - p).sum(axis=0)
    x[v] -= 20.0 * normal / np.sqrt((normal**2).sum())
    return x, t, {v}, set(np.flatnonzero((t == v).any(axis=1)).tolist())


def overlapping(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A second body, a moved copy, crosses the first."""
    n = len(points)
    moved = points + rng.uniform(0.1, 0.3, 3)
    return (
        np.concatenate([points, moved]),
        np.concatenate([t, t + n]),
        set(range(2 * n)),
        set(range(2 * len(t))),
    )


def doubled(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A triangle is given twice, from another corner on."""
    i = int(rng.integers(len(t)))
    more = np.roll(t[i], int(rng.integers(3)))
    return points, np.concatenate([t, more[None]]), set(t[i].tolist()), {i, len(t)}


def twice_a_point(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A point is given twice, and one triangle has the second."""
    i = int(rng.integers(len(t)))
    v = int(t[i, 0])
    t = t.copy()
    t[i, 0] = len(points)
    return np.concatenate([points, points[v : v + 1]]), t, {v, len(points)}, {i}


def fin(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A triangle stands on an edge."""
    i = int(rng.integers(len(t)))
    a, b = t[i, :2].tolist()
    tip = points[[a, b]].mean(axis=0) * 1.5 + 0.3
    return (np.concatenate([points, tip[None]]), np.concatenate([t, [[a, b, len(points)]]]).astype(np.int32),
            {a, b, len(points)}, {i, len(t)})  # fmt: skip


def four_at_an_edge(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A tetrahedron outside has an edge in common with the surface."""
    i = int(rng.integers(len(t)))
    a, b = t[i, :2].tolist()
    middle = points[[a, b]].mean(axis=0)
    out = middle - points.mean(axis=0)
    along = points[b] - points[a]
    side = np.cross(out, along)
    side *= 0.05 / np.sqrt((side**2).sum())
    out *= 0.3 / np.sqrt((out**2).sum())
    n = len(points)
    tips = np.stack([middle + out + side, middle + out - side])
    rows = [[a, b, n], [b, a, n + 1], [a, n, n + 1], [b, n + 1, n]]
    found = np.concatenate([t, rows]).astype(np.int32)
    spoiled = set(np.flatnonzero(np.isin(found, [a, b]).sum(axis=1) == 2).tolist())
    return np.concatenate([points, tips]), found, {a, b, n, n + 1}, spoiled


def touching(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A tetrahedron outside has a vertex in common with the surface."""
    v = int(rng.integers(len(points)))
    out = points[v] - points.mean(axis=0)
    out /= np.sqrt((out**2).sum())
    one = np.cross(out, np.eye(3)[int(np.argmin(np.abs(out)))])
    one /= np.sqrt((one**2).sum())
    two = np.cross(out, one)
    n = len(points)
    tips = points[v] + 0.5 * out + 0.02 * np.stack([one, two, -one - two])
    rows = [[v, n, n + 1], [v, n + 1, n + 2], [v, n + 2, n], [n, n + 2, n + 1]]
    return np.concatenate([points, tips]), np.concatenate([t, rows]).astype(np.int32), {v}, set()


def turned(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """One triangle is turned."""
    i = int(rng.integers(len(t)))
    t = t.copy()
    t[i] = t[i, ::-1]
    near = np.isin(t, t[i]).sum(axis=1) >= 2
    return points, t, set(t[i].tolist()), set(np.flatnonzero(near).tolist())


def not_a_number(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A coordinate is not finite."""
    v = int(rng.integers(len(points)))
    x = points.copy()
    x[v, int(rng.integers(3))] = rng.choice([np.nan, np.inf, -np.inf])
    return x, t, {v}, set()


def flat(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A triangle has a corner twice."""
    i = int(rng.integers(len(t)))
    t = t.copy()
    t[i, 1] = t[i, 0]
    return points, t, set(t[i].tolist()), {i}


def out_of_range(points: Array, t: Triangles, rng: np.random.Generator) -> Spoiled:
    """A triangle has a vertex that there is not."""
    i = int(rng.integers(len(t)))
    t = t.copy()
    t[i, 2] = len(points) + 3
    return points, t, {len(points) + 3}, {i}


WAYS: dict[str, Callable[[Array, Triangles, np.random.Generator], Spoiled]] = {
    "torn": torn, "missing": missing, "crossing": crossing, "overlapping": overlapping, "doubled": doubled,
    "twice a point": twice_a_point, "fin": fin, "four at an edge": four_at_an_edge, "touching": touching,
    "turned": turned, "not a number": not_a_number, "flat": flat, "out of range": out_of_range,
}  # fmt: skip


# ---------------------------------------------------------------------- the judgment


def spoiled(seed: int) -> dict[str, Any]:
    """Spoil a surface, and tell what was said: the error, and whether it names a part that was spoiled."""
    from unstruct import Domain, Layers, Mesh, UnstructError, prismatic_layers

    way = list(WAYS)[seed % len(WAYS)]
    rng = np.random.default_rng(seed)
    points, triangles, bad_points, bad_triangles = WAYS[way](*good(seed // len(WAYS)), rng)
    as_mesh = way == "turned" or rng.random() < 0.5
    row: dict[str, Any] = {"seed": seed, "way": way, "as": "Mesh" if as_mesh else "Domain"}
    try:
        if as_mesh:
            surface: Any = Mesh(points, None, cells={"triangle": triangles})
        else:
            surface = Domain(points, triangles)
        prismatic_layers(surface, layers=Layers(first=0.001, growth=1.1, count=10))
    except UnstructError as error:
        text = str(error)
        named = {int(k) for numbers in NAMED.findall(text) for k in numbers if k}
        places = bad_points | bad_triangles
        return row | {"error": type(error).__name__, "text": text, "named": bool(named & places)}
    except Exception as error:  # the wrong kind of error
        return row | {"error": f"WRONG {type(error).__name__}", "text": str(error), "named": False}
    return row | {"error": "NONE", "text": "", "named": False}


def spoiled_summary(count: int) -> str:
    """How many were refused, by way; and all that were not, or not by name."""
    rows = [spoiled(seed) for seed in range(count)]
    good_ = [row for row in rows if row["named"]]
    by_way = Counter(row["way"] for row in good_)
    lines = [f"{len(rows)} spoiled surfaces, {len(good_)} refused by name: "
             + ", ".join(f"{way} {n}" for way, n in by_way.items())]  # fmt: skip
    lines += [f"{row['way']} {row['seed']} ({row['as']}): {row['error']} {row['text'][:200]}"
              for row in rows if not row["named"]]  # fmt: skip
    return "\n".join(lines)
