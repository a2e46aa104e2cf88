"""The classical front: the plain one step by step, valid meshes of any region, the record, the arguments."""

from __future__ import annotations

from math import frexp
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region

from unstruct import Domain, DomainMesh, InputError, check
from unstruct.generate.boundary.constrained import planar_complex
from unstruct.generate.front.classical import (
    CLASSICAL_ORDERS,
    SEARCHES,
    ClassicalRun,
    classical_front,
    classical_mesh,
)
from unstruct.plain import advancing_front as plain

ORDERS, FINDS = st.sampled_from(CLASSICAL_ORDERS), st.sampled_from(list(SEARCHES))


def size_of(domain: Domain, fraction: float) -> float:
    return float(fraction * np.ptp(domain.bounds, axis=0).max())


def marched(domain: Domain, size: Any, **options: Any) -> tuple[ClassicalRun, DomainMesh]:
    """A run, and its triangles as they were made."""
    complex_ = planar_complex(domain, size)
    run = classical_front(domain, complex_, size, **options)
    return run, classical_mesh(domain, complex_, size, run, finish=False)


# --- plain and fast -------------------------------------------------------------------------------


def plain_key(order: str, factor: float) -> Any:
    """The order of the fast front: lengths that differ by about a percent are equal."""

    def by_length(front: plain.Front, edge: tuple[int, int], size: Any) -> int:
        part, exponent = frexp(plain.distance(*plain.ends(front, edge)) * factor)
        return 64 * exponent + int(128 * part)

    return {"smallest": plain.smallest, "oldest": plain.oldest, "shortest": by_length}[order]


@settings(max_examples=10, deadline=None)
@given(
    st.sampled_from(sorted(set(KINDS) - {"wide exponents"})),
    st.integers(0, 10**6),
    ORDERS,
    st.sampled_from([0.4, 0.7]),
)
def test_the_plain_front_step_by_step(kind: str, seed: int, order: str, fraction: float) -> None:
    """Same edges, candidates and choices, bit for bit."""
    domain = random_region(seed, kind)
    size = size_of(domain, fraction)
    sampled = domain.sampled(size)
    if len(sampled.points) > 30:
        return
    complex_ = planar_complex(domain, size)
    run = classical_front(domain, complex_, size, order=order, search="barycenter", history=True)
    facets = sampled.piece < len(domain.facets)
    made = run.made.triangles
    inner = [
        tuple(ends)
        for ends in sampled.ends[~facets].tolist()
        if np.isin(made, ends).sum(axis=1).max(initial=0) == 2
    ]
    points, outer = sampled.points.tolist(), [tuple(ends) for ends in sampled.ends[facets].tolist()]
    key = plain_key(order, complex_.factor)
    steps = list(plain.advancing_front(points, outer, lambda x: size, inner=inner, key=key))
    assert [(*step.edge, step.chosen) for step in steps] == [tuple(cell) for cell in made.tolist()]
    assert run.steps is not None
    start = run.steps["start"]
    for i, step in enumerate(steps):
        tried = run.steps["vertex"][start[i] : start[i + 1]].tolist()
        assert tried == [-1 if c.vertex is None else c.vertex for c in step.candidates]


# --- any region -----------------------------------------------------------------------------------


@settings(max_examples=30, deadline=None)
@given(
    st.sampled_from(sorted(KINDS)),
    st.integers(0, 10**6),
    ORDERS,
    FINDS,
    st.sampled_from([0.06, 0.1, 0.3]),
    st.booleans(),
)
def test_any_region(kind: str, seed: int, order: str, search: str, fraction: float, graded: bool) -> None:
    """It ends with a valid mesh, whatever the region."""
    domain = random_region(seed, kind)
    size, low = size_of(domain, fraction), domain.bounds[0]
    scale = np.ptp(domain.bounds)
    field = (lambda x: size * (0.4 + np.linalg.norm((x - low) / scale, axis=1))) if graded else size
    run, mesh = marched(domain, field, order=order, search=search)
    assert check(mesh, domain=domain)
    assert (
        sum(run.counts[name] for name in ("new point", "near vertex", "wider search", "all vertices"))
        == mesh.size
    )


@settings(max_examples=8, deadline=None)
@given(st.sampled_from(["grid", "holes", "curves", "cracks"]), st.integers(0, 10**6))
def test_finished(kind: str, seed: int) -> None:
    """Finished as `voronoi_segment` is: constrained Delaunay, no small angle that is not listed."""
    domain = random_region(seed, kind)
    size = size_of(domain, 0.1)
    complex_ = planar_complex(domain, size)
    run = classical_front(domain, complex_, size)
    mesh = classical_mesh(domain, complex_, size, run)
    assert check(mesh, domain=domain, delaunay="constrained")
    rest = np.setdiff1d(np.arange(mesh.size), mesh.unrefined)
    assert mesh.quality("min_angle")[rest].min(initial=90) >= 25 - 1e-9
    assert mesh.figures["triangles before"] == len(run.made.triangles)


def test_two_regions_keep_their_names() -> None:
    square = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [0.5, 1]]
    facets = [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0]]
    seeds = {"left": [[0.2, 0.5]], "right": [[0.8, 0.5]]}
    domain = Domain(square, facets, inner=[[4, 5]], regions=seeds, markers={"wall": [6]})
    _, mesh = marched(domain, 0.1)
    x = mesh.points[mesh.simplices].mean(axis=1)[:, 0]
    assert (mesh.markers["region"] == (x > 0.5)).all() and mesh.regions == {"left": 0, "right": 1}
    assert len(mesh.markers["wall"]) == 10


def test_a_prefix_is_a_state() -> None:
    """After k triangles the sides that belong to one of them, and no subsegment beyond, are the front."""
    domain = Domain.rectangle()
    _, mesh = marched(domain, 0.2)
    for k in (1, 7, mesh.size // 2):
        sides: dict[tuple[int, int], int] = {}
        for cell in mesh.simplices[:k].tolist():
            for i in range(3):
                side = cell[i], cell[(i + 1) % 3]
                assert side not in sides
                sides[side] = 1
        loose = [side for side in sides if side[::-1] not in sides]
        assert sorted(a for a, _ in loose) == sorted(b for _, b in loose)


def test_quality_and_growth_of_candidates() -> None:
    """The candidates of a step are few, and do not grow with the mesh; the triangles are round."""
    counts = []
    for size in (0.04, 0.01):
        run, mesh = marched(Domain.disc(), size, order="shortest")
        counts.append(run.counts["candidates"] / mesh.size)
        assert mesh.figures["mean 2r/R"] > 0.96
    assert max(counts) < 1.2


def test_the_record() -> None:
    run, mesh = marched(Domain.rectangle(), 0.2, search="barycenter", history=True)
    steps = mesh.steps
    assert steps is not None and run.steps is not None
    assert (np.column_stack([steps["edge"], steps["apex"]]) == mesh.simplices).all()
    last = steps["start"][1:] - 1
    assert (steps["verdict"][last] == "valid").all()
    new = steps["reason"] == "new point"
    assert (steps["vertex"][last][new] == -1).all() and (
        steps["vertex"][last][~new] == steps["apex"][~new]
    ).all()
    assert (mesh.points[steps["apex"][new]] == steps["ideal"][new]).all()
    assert np.allclose(steps["size"], 0.2)


def test_a_budget() -> None:
    """Without points left the mesh is completed with the vertices that there are, and says so."""
    run, mesh = marched(Domain.rectangle(), 0.1, budget=5)
    assert check(mesh, domain=Domain.rectangle()) and run.spent
    assert (mesh.origin < 0).sum() == 36 + 5 and not mesh.complete and set(mesh.reasons) == {"budget"}


@pytest.mark.parametrize("wrong", [{"order": "widest"}, {"placement": "angle"}, {"search": "far"}])
def test_arguments(wrong: dict[str, str]) -> None:
    domain = Domain.rectangle()
    with pytest.raises(InputError, match=next(iter(wrong.values()))):
        classical_front(domain, planar_complex(domain, 0.5), 0.5, **wrong)
