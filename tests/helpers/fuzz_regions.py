"""Mesh very many small random regions and judge every mesh.

``python tests/helpers/fuzz_regions.py COUNT --seed S`` runs it.
Region i of seed S is `regions.random_region` of the pair (S, i), so that ``--first i --count 1`` repeats it.
Each mesh is judged by a compiled check (adjacency, orientation and empty circles by exact signs, area, every
limit that the mesh claims to keep), and now and then, and wherever that finds a fault, by `unstruct.check`.
"""

from __future__ import annotations

import argparse
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from regions import KINDS

from unstruct import (
    Domain,
    Mesh,
    UnstructError,
    advancing_front,
    check,
    circumcenter_insertion,
    conforming_delaunay,
    constrained_delaunay,
    refine,
    simplex,
    voronoi_segment,
)
from unstruct.base.jit import kernel
from unstruct.generate.front.run import ORDERS, PLACEMENTS
from unstruct.predicates.batch import scaled
from unstruct.predicates.kernels import incircle, orient2
from unstruct.studies import insert_without_breaking, skeleton_points

SECONDS = 20  # of the processor, for one mesh
SAMPLE = 50  # one mesh in so many gets the full check
BUDGET = 20_000
LARGEST = 3000  # cells, for the full check where nothing is suspicious


class TooLong(Exception):
    """A mesh took longer than `SECONDS`."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TooLong` when so much processor time is used up."""

    def stop(*_: Any) -> None:
        raise TooLong(f"more than {seconds} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


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
    return float(max(sides.prod() ** 0.5, sides.max() / 30))


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
        missed |= mesh.volumes > max_area * (1 + 1e-9)
    if (missed & ~said).any():
        return f"cell {int(np.argmax(missed & ~said))} misses a limit and is not in unrefined"
    if mesh.complete != (not said.any()):
        return "complete does not fit unrefined"
    return ""


# --- what is done to each region -------------------------------------------------------------------


def refined(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
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
    return f"refine {method}: {'complete' if mesh.complete else ' + '.join(reasons)}", mesh, fault


def constrained(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
    """The constrained Delaunay triangulation."""
    mesh = constrained_delaunay(domain)
    return "constrained_delaunay", mesh, quick(mesh, domain)


def conforming(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
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
    return f"conforming {test}, shells {shells}: {why}", mesh, fault


def guarded(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
    """Points thrown at the box of the domain, those that would break its boundary turned away; a skeleton."""
    low, high = domain.bounds
    points = rng.uniform(low, high, (60, 2))
    result = insert_without_breaking(domain, points)
    fault = quick(result.mesh, domain)
    went = result.vertex >= 0
    if not (result.mesh.points[result.vertex[went]] == points[went]).all():
        fault = fault or "a point is not where it was given"
    skeleton = skeleton_points(domain, float((high - low).max()) / 8)
    return "guarded", result.mesh, fault or quick(skeleton.mesh, domain)


def centers(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
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
    )


def some_size(domain: Domain, rng: np.random.Generator) -> Any:
    """A constant size, or one that grows away from a vertex."""
    extent = extent_of(domain)
    if rng.random() < 0.5:
        return extent * 10.0 ** -rng.uniform(0.3, 1.3)
    x, y = domain.points[rng.integers(len(domain.points))]
    h = extent * 10.0 ** -rng.uniform(0.7, 1.7)
    return lambda p: h + 0.3 * np.hypot(p[:, 0] - x, p[:, 1] - y)


def segments(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
    """Rebay's insertion, finished or not."""
    finish = bool(rng.random() < 0.7)
    mesh = voronoi_segment(domain, some_size(domain, rng), finish=finish, budget=BUDGET)
    name = "voronoi_segment" + (" finished" if finish else "")
    return f"{name}: {'complete' if mesh.complete else 'incomplete'}", mesh, quick(mesh, domain)


def fronts(domain: Domain, rng: np.random.Generator) -> tuple[str, Mesh, str]:
    """An advancing front in any order, finished or not."""
    options: dict[str, Any] = {"order": str(rng.choice(ORDERS)), "placement": str(rng.choice(PLACEMENTS))}
    finish = bool(rng.random() < 0.7)
    mesh = advancing_front(domain, some_size(domain, rng), finish=finish, budget=BUDGET, **options)
    name = "advancing_front" + (" finished" if finish else "")
    return (
        f"{name}: {'complete' if mesh.complete else 'incomplete'}",
        mesh,
        quick(mesh, domain, delaunay=finish),
    )


WORK: dict[str, Callable[[Domain, np.random.Generator], tuple[str, Mesh, str]]] = {
    "centers": centers,
    "conforming": conforming,
    "guarded": guarded,
    "refine": refined,
    "constrained": constrained,
    "segments": segments,
    "fronts": fronts,
}


def one(seed: int, i: int, names: list[str]) -> tuple[str, list[str], list[str]]:
    """Region i: its kind, what came of it, and the faults."""
    rng = np.random.default_rng([seed, i])
    kind = list(KINDS)[i % len(KINDS)]
    outcomes, faults = [], []
    try:
        with limited(SECONDS):
            domain = KINDS[kind](rng)
    except (UnstructError, TooLong) as error:
        return kind, [f"domain: {type(error).__name__}"], [f"domain: {error}"]
    for name in names:
        try:
            with limited(SECONDS):
                outcome, mesh, fault = WORK[name](domain, np.random.default_rng([seed, i, *name.encode()]))
            if fault or (i % SAMPLE == 0 and mesh.size < LARGEST):
                report = check(mesh, domain=domain, delaunay="constrained")
                fault = fault or ("" if report else str(report))
            outcomes.append(outcome)
            if fault:
                faults.append(f"{outcome}: {fault}")
        except TooLong as error:
            faults.append(f"{name}: {error}")
        except Exception as error:
            faults.append(f"{name}: {type(error).__name__}: {error}\n{traceback.format_exc(limit=-3)}")
    return kind, outcomes, faults


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, mesh, print the totals; 1 where anything was at fault."""
    parser = argparse.ArgumentParser(prog="python tests/helpers/fuzz_regions.py", description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first region")
    parser.add_argument("--work", nargs="*", choices=sorted(WORK), default=sorted(WORK))
    options = parser.parse_args(arguments)
    kinds: Counter[str] = Counter()
    outcomes: Counter[str] = Counter()
    faults = slowest = 0
    for name in options.work:  # to have all compiled: an alarm within the compiler leaves half a function
        for kind in KINDS.values():
            check(WORK[name](kind(np.random.default_rng(1)), np.random.default_rng(1))[1])
    begin = time.perf_counter()
    for i in range(options.first, options.first + options.count):
        start = time.process_time()
        kind, came, wrong = one(options.seed, i, options.work)
        took = time.process_time() - start
        slowest = max(slowest, took)
        if took > 5:
            print(f"region {i} ({kind}) took {took:.1f} s: {came}", flush=True)
        kinds[kind] += 1
        outcomes.update(came)
        faults += len(wrong)
        for text in wrong:
            print(f"region {i} ({kind}): {text}", flush=True)
    seconds = time.perf_counter() - begin
    print(f"seed {options.seed}, regions {options.first} to {i}: {dict(kinds)}")
    for outcome, number in sorted(outcomes.items()):
        print(f"{number:8d}  {outcome}")
    print(f"{faults} faults in {seconds:.0f} s, the slowest region {slowest:.2f} s")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
