"""The suite ``front``: the advancing front beside others that march, and beside Voronoi-segment insertion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .meshers import MESHERS as PLANAR
from .meshers import Meshed, Mesher, find, holed_square
from .planar import task
from .regions import graded
from .run import Workers, measured

# work -> kinds and rough numbers of triangles
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "uniform": {"holed square": (10**4, 10**5, 10**6)},
    "graded": {"holed square": (10**5,)},
}
PEERS = {"Gmsh 6", "Netgen"}
__all__ = ["MESHERS", "PLAN", "run", "task", "warm_up"]


def _front(finish: bool) -> Callable[[], Callable[[float | None], Meshed]]:
    def prepare() -> Callable[[float | None], Meshed]:
        from unstruct import advancing_front

        def run(edge: float | None) -> Meshed:
            mesh = advancing_front(holed_square(), graded if edge is None else edge, finish=finish)
            return mesh.points, mesh.simplices

        return run

    return prepare


def _segments() -> Callable[[float | None], Meshed]:
    from unstruct import voronoi_segment

    def run(edge: float | None) -> Meshed:
        mesh = voronoi_segment(holed_square(), graded if edge is None else edge)
        return mesh.points, mesh.simplices

    return run


MESHERS = [
    *(
        Mesher(name, "unstruct", work, prepare)
        for work in PLAN
        for name, prepare in (
            ("unstruct", _front(True)),
            ("unstruct, unfinished", _front(False)),
            ("voronoi_segment", _segments),
        )
    ),
    *(mesher for mesher in PLANAR if mesher.name in PEERS and mesher.work in PLAN),
]


def warm_up(work: str) -> Any:
    """A small task of the same kind, which loads compiled code and makes lazy imports."""
    return None if work == "graded" else 0.1


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` triangles."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        for kind, sizes in kinds.items():
            expected = {mesher.name: 0.0 for mesher, _ in find(work, MESHERS)}
            for n in sizes:
                if n <= largest:
                    case = {"work": work, "kind": kind, "n": n, "suite": "front"}
                    rows += measured(workers, "meshed", case, expected, repeats)
    return rows
