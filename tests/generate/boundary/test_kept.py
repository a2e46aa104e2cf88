"""One choice, three methods: on which pieces vertices may be put."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from unstruct import (
    Arc,
    Domain,
    DomainMesh,
    InputError,
    advancing_front,
    check,
    circumcenter_insertion,
    refine,
    voronoi_segment,
)
from unstruct.generate.boundary.kept import kept_pieces

# A room with a bulging wall and two cracks side by side in it: all methods split something here.
POINTS = [(0, 0), (6, 0), (6, 2), (0, 2), (3, 1), (5, 1.2), (2.9, 0.93), (5.1, 1.15)]
ROOM = Domain(
    POINTS,
    [(0, 1), (1, 2), (2, 3), (3, 0)],
    inner=[(4, 5), (6, 7)],
    curves={1: Arc.through((6, 0), (6.5, 1), (6, 2))},
)
METHODS: dict[str, Callable[..., DomainMesh]] = {
    "refine by angle": lambda **o: refine(ROOM, min_angle=25, **o),
    "refine by area": lambda **o: refine(ROOM, max_area=0.02, method="ruppert", **o),
    "circumcenters": lambda **o: circumcenter_insertion(ROOM, 0.25, step=100.0, **o),
    "front": lambda **o: advancing_front(ROOM, lambda x: 0.1 + 0.3 * np.abs(x[:, 1] - 1), **o),
    "Voronoi segments": lambda **o: voronoi_segment(ROOM, lambda x: 0.1 + 0.3 * np.abs(x[:, 1] - 1), **o),
}


def added(mesh: DomainMesh, method: str) -> tuple[int, int]:
    """How many subsegments facets and inner pieces have become."""
    facets = mesh.piece < len(ROOM.facets)
    return int(facets.sum()), int((~facets).sum())


def at_first(method: str) -> tuple[int, int]:
    """The same before the run: pieces as they are cut by the size, or for the safety of curves."""
    graded = lambda x: 0.1 + 0.3 * np.abs(x[:, 1] - 1)  # noqa: E731
    size = {"circumcenters": 0.25, "front": graded, "Voronoi segments": graded}.get(method)
    sampled = ROOM.sampled(size, step=100.0 if method == "circumcenters" else 1.0)
    facets = sampled.piece < len(ROOM.facets)
    return int(facets.sum()), int((~facets).sum())


@pytest.mark.parametrize("method", METHODS)
def test_vertices_come_only_where_they_may(method: str) -> None:
    start = at_first(method)
    for choice in (True, "inner", False):
        mesh = METHODS[method](split_boundary=choice)
        assert check(mesh, domain=ROOM, delaunay="constrained")
        facets, inner = added(mesh, method)
        assert facets == start[0] if choice is not True else facets >= start[0]
        assert inner == start[1] if choice is False else inner >= start[1]
        if not mesh.complete:
            assert (mesh.reasons != "").all()
    free = METHODS[method](split_boundary=True)
    assert np.array_equal(free.simplices, METHODS[method]().simplices), "True is the default"


def test_the_choice_matters() -> None:
    split, inner, kept = (METHODS["refine by angle"](split_boundary=c) for c in (True, "inner", False))
    assert split.complete and not kept.complete and added(split, "")[0] > added(inner, "")[0]
    assert added(inner, "")[1] > added(kept, "")[1] == len(ROOM.inner)
    assert any("must not be split" in reason for reason in kept.reasons)


def test_a_mesh_keeps_its_edges() -> None:
    coarse = refine(ROOM, min_angle=0)
    fine = refine(coarse, max_area=0.01, split_boundary=False)
    assert len(fine.markers["facets"]) == len(coarse.markers["facets"])
    assert len(fine.markers["inner"]) == len(coarse.markers["inner"])
    assert fine.size > 10 * coarse.size


@pytest.mark.parametrize("choice", ["outer", 0, 1, "split"])
@pytest.mark.parametrize("method", METHODS)
def test_other_choices_are_refused(method: str, choice: object) -> None:
    with pytest.raises(InputError, match="split_boundary must be True, False or 'inner'"):
        METHODS[method](split_boundary=choice)


def test_pieces_by_choice() -> None:
    assert kept_pieces(True, 2, 5).tolist() == [0, 0, 0, 0, 0]
    assert kept_pieces("inner", 2, 5).tolist() == [1, 1, 0, 0, 0]
    assert kept_pieces(False, 2, 5).tolist() == [1, 1, 1, 1, 1]
