"""The suite ``space_front``: the advancing front in space beside others that march, and our other methods.

All mesh the same surfaces, those of the suite ``volume``, and our time includes the checks of the `Domain`.
"By the front" are the cells that were accepted in a step of the front, neither "forced" nor with a
circumcenter; the finishing pass changes some of them afterwards.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

from . import bodies, parts
from .meshers import Mesher, find
from .planar_report import ratio, speed, times
from .report import OURS, figures, grid, page, relative
from .run import Workers, measured
from .volume import CELLS, PACE
from .volume import task as body_of
from .volume import warm_up as small_body
from .volume_meshers import Given, gmsh_in_space, netgen_in_space
from .volume_quality import measures as quality_of

# work -> kind -> the rough number of cells
BODIES = ("ball", "torus", "gridded cube", "noisy 1", "noisy 2", "bone", "pipe tee")
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "good bodies": {name: (CELLS,) for name in BODIES} | {"ball": (10_000, CELLS, 1_000_000)},
    "machine parts": dict.fromkeys(parts.PARTS, (CELLS,)),
    "graded bodies": dict.fromkeys(bodies.GRADED, (CELLS,)),
}
WORKS = {"good bodies": "good", "machine parts": "parts", "graded bodies": "graded"}  # as `volume` has them
PLACED = ("new point", "small enough", "empty sphere", "near apex", "angle", "closed")
AT_LAST = ("circumcenter", "forced")
SLOWEST = 3e5  # cells that those who make a few thousand in a second are asked for
Result = tuple[NDArray, NDArray, dict[str, int]]

__all__ = ["MESHERS", "PLAN", "markdown", "measures", "plot", "run", "task", "warm_up"]


def _ours(method: str, **options: Any) -> Callable[[], Callable[[Given], Result]]:
    def prepare() -> Callable[[Given], Result]:
        import warnings

        import unstruct

        def run(given: Given) -> Result:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                domain = unstruct.Domain(given.points, given.triangles)
                mesh = getattr(unstruct, method)(domain, given.size, **options)
            return mesh.points, mesh.simplices, mesh.counts

        return run

    return prepare


def _peer(prepare: Callable[[], Any]) -> Callable[[], Callable[[Given], Result]]:
    def prepared() -> Callable[[Given], Result]:
        mesher = prepare()
        return lambda given: (*mesher(given), {})

    return prepared


MESHERS = [
    Mesher(name, package, work, prepare)
    for work in PLAN
    for name, package, prepare in (
        ("unstruct", "unstruct", _ours("advancing_front")),
        ("unstruct, unfinished", "unstruct", _ours("advancing_front", finish=False)),
        ("tetrahedralize", "unstruct", _ours("tetrahedralize")),
        ("voronoi_segment", "unstruct", _ours("voronoi_segment", split_boundary=False)),
        ("Gmsh frontal", "gmsh", _peer(gmsh_in_space(4, 0))),
        ("Netgen", "netgen-mesher", _peer(netgen_in_space)),
    )
    if work != "graded bodies" or package in ("unstruct", "gmsh")  # Netgen takes no formula
]


def task(work: str, kind: str, n: int) -> Given | None:
    """A surface and a size."""
    return body_of(WORKS[work], kind, n)


def warm_up(work: str) -> Given:
    """A small task of the same kind."""
    return small_body(WORKS[work])


def measures(
    points: NDArray, cells: NDArray, counts: dict[str, int], work: str, given: Given
) -> dict[str, Any]:
    """How good a mesh is, and how many cells the front has placed, for what reason."""
    found = quality_of(points, cells, WORKS[work], given)
    del found["angles"]
    reasons = {name: counts[name] for name in (*PLACED, *AT_LAST) if name in counts}
    if reasons:
        found["by_front"] = round(sum(reasons.get(name, 0) for name in PLACED) / sum(reasons.values()), 5)
        found["reasons"] = reasons
    return found


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` cells."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        for kind, sizes in kinds.items():
            for n in sizes:
                if n > largest:
                    continue
                pace = PACE | {"Gmsh frontal": PACE["Netgen"]}
                expected = {mesher.name: n * pace.get(mesher.name, 0.0) for mesher, _ in find(work, MESHERS)}
                expected = {name: time for name, time in expected.items() if time == 0.0 or n < SLOWEST}
                case = {"suite": "space_front", "work": work, "kind": kind, "n": n}
                rows += measured(workers, "meshed", case, expected, repeats)
    return rows


# ---------------------------------------------------------------------- the report


def table(rows: list[dict[str, Any]], work: str) -> str:
    """A line for each case and contestant; **bold** if a peer is faster, by cells per second."""
    head = ["body", "by", "cells", "seconds", "1000 cells/s", f"{OURS} ÷ it", "by the front"]
    head += ["least dihedral", "below 20°", "mean 3r/R", "valid"]
    lines = []
    for (name, kind, _), case in times(rows).items():
        if name != work or OURS not in case:
            continue
        for peer, row in case.items():
            share = f"{100 * row['by_front']:.1f} %" if "by_front" in row else "–"
            lines.append([
                kind, peer, str(row["cells"]), figures(row["seconds"]), figures(speed(row) / 1e3),
                "" if peer == OURS else relative(ratio(case, peer)), share, f"{row['min_dihedral']:.1f}°",
                f"{100 * row['sharp']:.3f} %", f"{row['mean_3r_R']:.3f}", "yes" if row["valid"] else "no",
            ])  # fmt: skip
    return grid(head, 2, lines)


def reasons(rows: list[dict[str, Any]]) -> str:
    """A line for each of our meshes: how many cells were accepted for which reason, in percent."""
    lines = []
    for (_, kind, _), case in times(rows).items():
        found = case.get(OURS, {}).get("reasons")
        if found:
            total = sum(found.values())
            lines.append([kind, str(total), *(f"{100 * found[name] / total:.2f}" for name in found)])
    return grid(["body", "cells", *PLACED, *AT_LAST], 1, lines)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = [work for work in PLAN if work in {row["work"] for row in rows}]
    sections = {work.capitalize(): table(rows, work) for work in done}
    return page(result, sections | {"Why cells were accepted, in percent": reasons(rows)})


def plot(rows: list[dict[str, Any]]) -> Any:
    """No picture: the tables say it."""
    del rows
