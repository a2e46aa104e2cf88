"""refine in space: valid meshes of the domain, limits met, and the truth about those that are not."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
import solids
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import (
    Domain,
    DomainMesh,
    IncompleteWarning,
    InputError,
    check,
    circumcenter_insertion,
    delaunay,
    improve,
    refine,
    sizing,
    voronoi_segment,
)
from unstruct.simplex import circumradius, volume

KEPT = 1 + 1e-9


def refined(domain: Domain, *args: Any, **options: Any) -> DomainMesh:
    """The mesh, after `check`; cells that are not listed meet the limits."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = refine(domain, *args, **options)
    report = check(mesh, domain=domain)
    assert report, report
    fine = np.setdiff1d(np.arange(mesh.size), mesh.unrefined)
    assert mesh.quality("radius_edge")[fine].max(initial=0.0) <= options.get("radius_edge", 2.0) * KEPT
    if args and isinstance(args[0], float):
        assert circumradius(mesh.corners[fine]).max(initial=0.0) <= args[0] / np.sqrt(2) * KEPT
    return mesh


def prism(angle: float) -> Domain:
    """A wedge of so many degrees."""
    turn = np.radians(angle)
    low = [(0.0, 0.0), (1.0, 0.0), (np.cos(turn), np.sin(turn))]
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in low])
    return Domain(points, [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)])


@pytest.mark.parametrize("h", [0.5, 0.2])
def test_a_box(h: float) -> None:
    mesh = refined(Domain.box(), h)
    assert mesh.complete
    ends = mesh.points[mesh.edges]
    length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    assert length.max() <= np.sqrt(2) * h * KEPT and length.min() > 0.2 * h
    assert improve(mesh).quality("min_dihedral").min() > 15


@pytest.mark.parametrize(
    "domain",
    [Domain.ball(size=0.3), Domain.torus(size=0.25), Domain.cylinder(size=0.3), Domain(*solids.cube(3))],
    ids=["ball", "torus", "cylinder", "gridded cube"],
)
def test_round_bodies(domain: Domain) -> None:
    extent = float(np.ptp(domain.points, axis=0).max())
    mesh = refined(domain, extent / 8)
    assert len(mesh.unrefined) < 0.01 * mesh.size
    assert mesh.steiner.size == mesh.counts["segment points"] + mesh.counts["facet points"]


def test_volume_dihedral_and_sizes_that_vary() -> None:
    box = Domain.box()
    mesh = refined(box, max_volume=1e-3)
    assert mesh.complete and volume(mesh.corners).max() <= 1e-3 * KEPT
    mesh = refined(box, 0.25, min_dihedral=8.0)
    fine = np.setdiff1d(np.arange(mesh.size), mesh.unrefined)
    assert mesh.quality("min_dihedral")[fine].min() >= 8.0 / KEPT and len(fine) > 0.99 * mesh.size

    def size(x: np.ndarray) -> np.ndarray:
        return 0.05 + 0.4 * x[:, 0]

    mesh = refined(box, size)
    wanted = size(mesh.corners.mean(axis=1)) / np.sqrt(2)
    assert len(mesh.unrefined) < 3 and np.sort(circumradius(mesh.corners) / wanted)[-3] < 1.06  # of the table


def test_regions_segments_points_names_and_cavities() -> None:
    outer, inner = Domain.box((0, 0, 0), (2, 1, 1)), Domain.box((1.2, 0.3, 0.3), (1.5, 0.6, 0.6))
    middle = np.array([(1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 1.0)])
    more = np.array([(0.3, 0.3, 0.3), (0.6, 0.7, 0.8), (0.2, 0.8, 0.4)])
    points = np.vstack([outer.points, inner.points, middle, more])
    sides = [*outer.facets.tolist()] if hasattr(outer.facets, "tolist") else [list(f) for f in outer.facets]
    mended = Domain(
        points,
        sides + [[8 + v for v in f] for f in sides],
        inner=[(16, 17, 18, 19), (20, 21)],
        markers={"wall": [12], "wire": [13]},
        regions={"left": (0.5, 0.5, 0.5), "right": (1.8, 0.5, 0.5)},
        resolve=True,
    )
    mesh = refined(mended, {"left": 0.4, None: 0.2})
    left = mesh.markers["region"] == mesh.regions["left"]
    radius = circumradius(mesh.corners)
    assert radius[~left].max() < 0.2 and radius[left].max() > 0.2
    assert np.isclose(np.abs(volume(mesh.corners)).sum(), 2 - 0.027)
    assert len(mesh.segments) and set(mesh.markers["wire"].ravel()) <= set(mesh.segments.ravel())
    with pytest.raises(InputError, match="names region"):
        refine(mended, {"middle": 0.2})


@pytest.mark.parametrize("angle", [60.0, 30.0, 5.0, 1.0])
def test_wedges(angle: float) -> None:
    """Facets that meet at a small angle leave each other alone: so the number of points stays small."""
    mesh = refined(prism(angle), 0.25)
    assert mesh.size < 4000
    assert angle < 30 or len(mesh.unrefined) < 0.02 * mesh.size
    alone = refined(prism(angle))
    assert alone.size < 1000 and (angle >= 30) == alone.complete
    assert alone.complete or any(reason.startswith(("input angle", "narrow")) for reason in alone.reasons)


def test_a_needle_and_bodies_without_tetrahedra() -> None:
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 0.001, 0), (0, 0, 0.001)], dtype=float)
    needle = Domain(points, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    assert refined(needle).size < 1000
    for body in (solids.schoenhardt(), solids.six_points()):
        assert refined(Domain(*body)).size < 3000


def plates(gap: float, parts: int = 1) -> Domain:
    """A box with two inner squares, cut into triangles, at a distance from each other."""
    box, n = Domain.box(), parts + 1
    grid = 0.2 + 0.6 * np.array([(i, j) for j in range(n) for i in range(n)]) / parts
    both = np.vstack([np.column_stack([grid, np.full(n * n, z)]) for z in (0.5, 0.5 + gap)])
    low = np.array([j * n + i for j in range(parts) for i in range(parts)])
    halves = np.concatenate([low[:, None] + [0, 1, n + 1], low[:, None] + [0, n + 1, n]])
    inner = np.concatenate([8 + halves, 8 + n * n + halves])
    return Domain(np.vstack([box.points, both]), [list(f) for f in box.facets], inner=inner.tolist())


def fan(angle: float, count: int) -> Domain:
    """Inner rectangles that meet at a line, each so many degrees from the next."""
    box, turn = Domain.box((-1, -1, -1), (2, 1, 1)), np.radians(angle) * np.arange(count)
    points = [(0.0, 0.0, -0.5), (0.0, 0.0, 0.5)]
    points += [(np.cos(t), np.sin(t), z) for t in turn for z in (-0.5, 0.5)]
    inner = [(8, 10 + 2 * k, 11 + 2 * k, 9) for k in range(count)]
    return Domain(np.vstack([box.points, points]), [list(f) for f in box.facets], inner=inner)


@pytest.mark.parametrize("gap", [1e-3, 1e-9])
@pytest.mark.parametrize("parts", [1, 4])
def test_narrow_gaps(gap: float, parts: int) -> None:
    """Nothing is divided because of what is across a narrow gap; without it there would be 40,000 cells."""
    body = plates(gap, parts)
    mesh = refined(body, 0.25)
    assert mesh.size < 5000 and any(reason.startswith("narrow") for reason in mesh.reasons)
    inside = np.abs(mesh.corners.mean(axis=1)[mesh.unrefined, 2] - 0.5) < 0.05
    assert inside.mean() > 0.5
    assert refined(body).size < 5000
    with pytest.warns(IncompleteWarning, match="budget"):
        assert len(refine(body, 0.25, budget=1500).points) == 1500  # with a budget, all is tried


@pytest.mark.parametrize("thickness", [1e-2, 1e-6])
def test_thin_plates(thickness: float) -> None:
    plate = Domain.box((0, 0, 0), (1, 1, thickness))
    for options in ((0.25,), ()):
        mesh = refined(plate, *options)
        assert mesh.size < 500 and any("narrow" in reason for reason in mesh.reasons)
    assert refined(Domain.box((0, 0, 0), (1, 1, 0.1)), 0.25).complete  # this is not narrow


@pytest.mark.parametrize(("angle", "most"), [(20.0, 12_000), (5.0, 15_000), (1.0, 25_000)])
def test_fans(angle: float, most: int) -> None:
    mesh = refined(fan(angle, 4), 0.25)
    assert mesh.size < most
    assert all(reason.split(":")[0] != "budget" for reason in mesh.reasons)


def test_small_angles_do_not_take_sizes_for_shapes() -> None:
    """Segments of a sharp wedge were divided without end, for cells that are too large and badly shaped."""
    assert refined(prism(0.1), 0.1).size < 4000


def test_something_small_beside_something_large_is_no_gap() -> None:
    """A fine cavity very near to a wall: the wall is divided as finely as that asks for."""
    box, hole = Domain.box(), Domain.box((0.4, 0.4, 0.004), (0.41, 0.41, 0.01))
    sides = [list(f) for f in box.facets]
    body = Domain(np.vstack([box.points, hole.points]), sides + [[8 + v for v in f] for f in sides])
    mesh = refined(body)
    assert mesh.complete and mesh.size < 5000


def test_segments_and_facets_are_divided_as_often_as_the_size_asks_for() -> None:
    """The limits on points for the shape's sake alone are no limits on those for the size's sake."""
    box = Domain.box((-1, -1, -1), (1, 1, 1))
    points = np.vstack([box.points, [(0.0, 0.0, -0.5), (0.0, 0.0, 0.5)]])
    body = Domain(points, [list(f) for f in box.facets], inner=[(8, 9)])

    def size(x: np.ndarray) -> np.ndarray:
        away = np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2 + np.maximum(np.abs(x[:, 2]) - 0.5, 0) ** 2)
        return 5e-3 + 0.9 * away

    mesh = refined(body, size)
    assert len(mesh.segments) > 140
    assert not any("often" in reason for reason in mesh.reasons)


def test_diagonals_of_a_gridded_part() -> None:
    """Recovery leaves points beside diagonals, and flat cells; both go (1,900 of 22,000 cells were left)."""
    n, rng = 6, np.random.default_rng(3)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]  # so that points are in a plane up to rounding only
    points, faces = solids.cube(n)
    body = Domain(np.asarray(points) @ turn, faces)
    extent = float(np.ptp(np.asarray(points), axis=0).max())
    mesh = refined(body, 0.5 * extent / n)
    assert len(mesh.unrefined) < 0.002 * mesh.size
    assert improve(mesh).quality("min_dihedral").min() > 10


def test_what_must_stay_stays() -> None:
    ball = Domain.ball(size=0.3)
    mesh = refined(ball, 0.2, split_boundary=False)
    assert not mesh.complete and not mesh.steiner.size
    assert any("kept" in reason for reason in mesh.reasons)
    with pytest.warns(IncompleteWarning, match="budget"):
        few = refine(Domain.box(), 0.1, budget=100)
    assert check(few, domain=Domain.box()) and len(few.points) == 100


def test_far_tiny_and_turned() -> None:
    """Points on facets are rounded, and the surface stays embedded and where it was."""
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    for factor, shift in ((1e-150, 0.0), (1e150, 0.0), (1.0, 1e6), (3.0, 1.0)):
        box = Domain.box()
        body = Domain((box.points @ turn) * factor + shift, box.facets)
        mesh = refined(body, 0.3 * factor)
        assert mesh.complete and mesh.counts["facet points"] > 10


def test_the_same_mesh_and_its_history() -> None:
    one, two = (refined(Domain.ball(size=0.4), 0.3, history=True) for _ in range(2))
    assert np.array_equal(one.points, two.points) and np.array_equal(one.simplices, two.simplices)
    assert one.steps is not None
    kind = one.steps["kind"]
    assert (kind == "circumcenter").sum() == one.counts["circumcenters"]
    assert (np.diff(one.steps["vertex"]) > 0).all()


def test_refused() -> None:
    box = Domain.box()
    for options, match in (
        ({"min_angle": 20}, "min_angle is for the plane"),
        ({"method": "chew"}, "method is for the plane"),
        ({"radius_edge": 0.5}, "at least 0.7"),
        ({"min_dihedral": 80}, "between 0 and 60"),
        ({"max_volume": -1.0}, "max_volume"),
        ({"size": 0.0}, "positive"),
    ):
        with pytest.raises(InputError, match=match):
            refine(box, **options)
    with pytest.raises(InputError, match="radius_edge is for space"):
        refine(Domain.rectangle(), 0.3, radius_edge=2.0)
    with pytest.raises(InputError, match="no facets"):
        refine(Domain(box.points, []), 0.3)


@settings(deadline=None, max_examples=25)
@given(
    st.lists(st.tuples(*[st.integers(0, 4)] * 3), min_size=5, max_size=9, unique=True),
    st.sampled_from([None, 0.7, 2.0]),
    st.sampled_from([1.0, 0.1, 1e-4]),
)
def test_hulls(points: list, size: float | None, flat: float) -> None:
    """Hulls of lattice points, flattened: small angles, needles, coplanar triangles."""
    rows = np.array(points, dtype=float) * [1, 1, flat]
    if np.linalg.matrix_rank(rows[1:] - rows[0]) < 3:
        return
    hull = delaunay(rows)
    refined(Domain(rows, hull.boundary), *([] if size is None else [size]), budget=300)


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 10**6))
def test_uneven_bodies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(6, 25)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = delaunay(points).boundary
    points *= np.exp(rng.normal(size=len(points)) * rng.choice([0.1, 0.5]))[:, None]
    points *= np.array([1, 1, rng.choice([1, 0.05])])
    refined(Domain(points, faces), budget=300)


@pytest.mark.parametrize("method", [refine, circumcenter_insertion, voronoi_segment])
def test_absurd_sizes_are_refused(method: Any) -> None:
    with pytest.raises(InputError, match=r"5e\+14 vertices or more.*give a larger size, or a budget"):
        method(Domain.box(), 1e-5)
    with pytest.raises(InputError, match=r"5e\+14"):
        method(Domain.box(), sizing.minimum(1e-5, 1.0))
