"""The advancing front in space: valid meshes of any body, each step by its record, orders, options."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from interrupts import interrupt
from random_bodies import noisy
from scipy.spatial import ConvexHull
from solids import schoenhardt, torus, twisted_star

import unstruct
from unstruct import Domain, InputError, advancing_front, check, sizing
from unstruct.generate.space_front.ledger import APEX_ROOM, CELL_ACCEPT
from unstruct.generate.space_front.placing import LONGEST_LATERAL, SHORTEST_LATERAL
from unstruct.generate.space_front.run import SPACE_ORDERS, SPACE_PLACEMENTS, SPACE_REASONS
from unstruct.generate.space_front.steps import LEAST_VOLUME

REGULAR = np.sqrt(6.0) / 4.0
INWARD = ((1, 3, 2), (0, 2, 3), (0, 3, 1), (0, 1, 2))  # the face opposite vertex k, then k: positive
BODIES = {
    "box": Domain.box(),
    "ball": Domain.ball(size=0.3),
    "torus": Domain.torus(size=0.25),
    "star": Domain(*twisted_star(7, 5, 0.4)),
    "Schoenhardt": Domain(*schoenhardt()),
    "thin torus": Domain(*torus(14, 5)),
}
FEW_NEEDLES = 23, 27, 35, 49  # bodies of 484 to 660 triangles, many of them needles


def extent(domain: Domain) -> float:
    return float(np.ptp(domain.bounds, axis=0).max())


def hull(seed: int) -> Domain:
    """A convex body with corners by chance, some nearly in a plane."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 25)), 3)) * [1.0, 1.0, rng.choice([0.01, 0.3, 1.0])]
    found = ConvexHull(points)
    used, rows = np.unique(found.simplices, return_inverse=True)
    rows = rows.reshape(-1, 3)
    corners = points[used][rows]
    away = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = (away * (corners[:, 0] - points[used].mean(axis=0))).sum(axis=1) < 0
    rows[turned] = rows[turned, ::-1]
    return Domain(points[used], rows)


def quiet(*args: Any, **options: Any) -> unstruct.DomainMesh:
    """A mesh without warnings of what is not complete."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return advancing_front(*args, **options)


def fronts(mesh: unstruct.DomainMesh) -> Iterator[tuple[int, set[tuple[int, ...]]]]:
    """Each step's number and the front before it: faces, from which what is unfinished is on the left."""

    def turned(a: int, b: int, c: int) -> tuple[int, ...]:
        return (a, b, c) if a < b and a < c else ((b, c, a) if b < c else (c, a, b))

    marked = {tuple(sorted(face)) for face in mesh.faces.tolist()}
    sides = [[turned(*(cell[i] for i in face)) for face in INWARD] for cell in mesh.simplices.tolist()]
    front = {side for cell in sides for side in cell if tuple(sorted(side)) in marked}
    for i, cell in enumerate(sides):
        yield i, front
        for side in cell:
            back = turned(*side[::-1])
            if side in front:
                front.remove(side)
            elif tuple(sorted(side)) not in marked:
                assert back not in front, "a face entered the front twice"
                front.add(back)
    assert not front


def radius(x: np.ndarray) -> float:
    """The circumradius of a cell, by the system of its planes in the middle of edges."""
    edges = x[1:] - x[0]
    if np.linalg.matrix_rank(edges) < 3:
        return np.inf
    return float(np.linalg.norm(np.linalg.solve(2 * edges, (edges**2).sum(axis=1))))


def six_volumes(x: np.ndarray) -> Fraction:
    """The determinant of the edges from the first corner, by fractions."""
    rows = [[Fraction(float(v)) for v in p] for p in x]
    (a, b, c), (d, e, f), (g, h, i) = [[p[j] - rows[0][j] for j in range(3)] for p in rows[1:]]
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


# --- any body --------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 10**6), st.booleans(), st.sampled_from([0.15, 0.25, 0.4, 2.0]), st.booleans(),
    st.sampled_from(SPACE_ORDERS), st.sampled_from(SPACE_PLACEMENTS), st.sampled_from([None, False]),
)  # fmt: skip
def test_any_body(
    seed: int, needles: bool, part: float, varies: bool, order: str, placement: str, split: bool | None
) -> None:
    try:
        domain = Domain(*noisy(FEW_NEEDLES[seed % len(FEW_NEEDLES)])) if needles else hull(seed)
    except unstruct.DomainError:
        return
    h = part * extent(domain)
    low = domain.bounds[0]
    size = (lambda x: h * (0.5 + np.linalg.norm(x - low, axis=1) / extent(domain))) if varies else h
    options: dict[str, Any] = {"order": order, "placement": placement, "split_boundary": split}
    raw = quiet(domain, size, finish=False, budget=4000, **options)
    mesh = quiet(domain, size, budget=4000, **options)
    if raw.counts["missing triangles"] + raw.counts["missing segments"] == 0:
        assert check(raw, domain=domain) and check(mesh, domain=domain)
    assert mesh.complete == (len(mesh.unrefined) == 0)


@pytest.mark.parametrize("shape", BODIES)
@pytest.mark.parametrize("order", SPACE_ORDERS)
def test_each_order(shape: str, order: str) -> None:
    domain = BODIES[shape]
    mesh = quiet(domain, 0.14 * extent(domain), order=order, finish=False)
    assert check(mesh, domain=domain)
    assert sum(mesh.counts[reason] for reason in SPACE_REASONS) == mesh.size


@pytest.mark.parametrize("shape", ["box", "ball", "torus"])
@pytest.mark.parametrize("placement", SPACE_PLACEMENTS)
def test_rounder_cells(shape: str, placement: str) -> None:
    """What the benchmarks measure, in the small: by the front, and 20 degrees at least."""
    domain, h = BODIES[shape], {"box": 0.12, "ball": 0.2, "torus": 0.16}[shape]
    domain = {"ball": Domain.ball(size=h), "torus": Domain.torus(size=h)}.get(shape, domain)
    raw = advancing_front(domain, h, placement=placement, finish=False)
    mesh = advancing_front(domain, h, placement=placement)
    assert check(mesh, domain=domain) and mesh.complete
    assert raw.counts["forced"] + raw.counts["circumcenter"] < 0.05 * raw.size
    assert mesh.quality("min_dihedral").min() > 20
    assert abs(np.log(mesh.size / (domain.volume / (0.116 * h**3)))) < np.log(1.6)


def test_names_regions_and_inner_pieces() -> None:
    points = np.array(Domain.box().points)
    loose = [[0.2, 0.3, 0.3], [0.2, 0.7, 0.6]]
    domain = Domain(
        np.vstack([points, loose]), [list(row) for row in Domain.box().facets], inner=[[8, 9]],
        markers={"floor": [0]}, regions={"all": [0.9, 0.9, 0.9]},
    )  # fmt: skip
    for finish in (False, True):
        mesh = advancing_front(domain, 0.2, finish=finish)
        assert check(mesh, domain=domain)
        assert mesh.regions == {"all": 0} and {8, 9} <= set(mesh.origin.tolist())
        assert len(mesh.markers["floor"]) > 10
        chain = mesh.points[mesh.segments]
        lengths = np.linalg.norm(chain[:, 1] - chain[:, 0], axis=1)
        assert abs(lengths.sum() - np.linalg.norm(np.subtract(*loose))) < 1e-12


# --- the record ------------------------------------------------------------------------------------


@pytest.mark.parametrize("placement", SPACE_PLACEMENTS)
@pytest.mark.parametrize("shape", ["ball", "torus", "star", "box"])
def test_record(shape: str, placement: str) -> None:
    """Every step is what its row says, by an oracle that knows only the cells in their order."""
    domain = BODIES[shape]
    h = 0.13 * extent(domain)
    mesh = quiet(domain, h, placement=placement, finish=False, history=True, split_boundary=False)
    assert check(mesh, domain=domain) and mesh.steps is not None
    x, steps = mesh.points, {name: column.tolist() for name, column in mesh.steps.items()}
    seen = set(mesh.faces.ravel().tolist())
    ends = x[mesh.faces]
    shortest = min(np.linalg.norm(ends[:, i] - ends[:, i - 1], axis=1).min() for i in range(3))
    for i, front in fronts(mesh):
        (a, b, c), apex, reason = steps["face"][i], steps["apex"][i], steps["reason"][i]
        assert sorted(mesh.simplices[i].tolist()) == sorted([a, b, c, apex])
        assert {(a, b, c), (b, c, a), (c, a, b)} & front
        assert six_volumes(x[[a, b, c, apex]]) > 0
        corners, ideal = x[[a, b, c]], np.array(steps["ideal"][i])
        sides = [float(np.linalg.norm(corners[j] - corners[j - 1])) for j in range(3)]
        mean = float(np.sqrt(np.mean(np.square(sides))))
        side = min(max(h, SHORTEST_LATERAL * mean), LONGEST_LATERAL * mean)
        small = CELL_ACCEPT * REGULAR * min(h, side)
        own = radius(x[[a, b, c, apex]])
        if reason in ("new point", "circumcenter"):
            assert apex not in seen and np.allclose(x[apex], ideal, rtol=0, atol=1e-15)
            away = np.linalg.norm(corners - x[apex], axis=1)
            assert away.min() >= APEX_ROOM * min(h, side) * (1 - 1e-9)
            assert float(six_volumes(x[[a, b, c, apex]])) >= LEAST_VOLUME * mean**3 * (1 - 1e-9)
            assert steps["radius"][i] >= small * (1 - 1e-9)
        elif reason in ("small enough", "closed"):
            assert own < small * (1 + 1e-9)
            if reason == "closed":
                cell = mesh.simplices[i].tolist()
                faces = [[cell[j] for j in face] for face in INWARD]
                there = [{(p, q, r), (q, r, p), (r, p, q)} & front for p, q, r in faces]
                assert sum(bool(one) for one in there) >= 3
        elif reason == "near apex":
            assert steps["near"][i] == apex
            assert np.linalg.norm(ideal - x[apex]) < APEX_ROOM * min(h, side) * (1 + 1e-9)
        elif reason == "empty sphere":
            edges = x[[b, c, apex]] - x[a]
            center = x[a] + np.linalg.solve(2 * edges, (edges**2).sum(axis=1))
            assert np.linalg.norm(ideal - center) >= own * (1 - 1e-6)
        elif reason == "angle":
            assert placement == "angle"
        else:
            assert reason == "forced" and np.isnan(ideal).all()
        seen.add(apex)
    ends = x[mesh.simplices]
    for i in range(4):
        for j in range(i):  # no edge is shorter than the theorem says
            assert np.linalg.norm(ends[:, i] - ends[:, j], axis=1).min() >= 0.999 * min(0.75 * h, shortest)


def test_a_prefix_is_the_state_when_it_was_made() -> None:
    """The same run with a smaller budget: the same first cells, and a valid mesh of the whole body."""
    domain = BODIES["torus"]
    whole = advancing_front(domain, 0.2, finish=False, history=True)
    assert whole.steps is not None
    made = 0
    for budget in (0, 1, 7, 30):
        mesh = quiet(domain, 0.2, finish=False, history=True, budget=budget)
        assert check(mesh, domain=domain) and mesh.steps is not None
        count = len(mesh.steps["apex"])
        assert sum(mesh.counts[reason] for reason in SPACE_REASONS) == count >= made
        assert (mesh.unrefined == np.arange(count, mesh.size)).all() and set(mesh.reasons) == {"budget"}
        np.testing.assert_array_equal(
            mesh.points[mesh.simplices[:count]], whole.points[whole.simplices[:count]]
        )
        assert mesh.counts["new point"] <= budget
        made = count


def test_same_mesh_again_and_with_a_record() -> None:
    domain = BODIES["star"]
    one = quiet(domain, 0.15 * extent(domain))
    two = quiet(domain, 0.15 * extent(domain), history=True)
    np.testing.assert_array_equal(one.points, two.points)
    np.testing.assert_array_equal(one.simplices, two.simplices)
    assert one.steps is None and two.steps is not None


# --- sizes -----------------------------------------------------------------------------------------


def test_a_size_that_varies() -> None:
    field = sizing.points([(0.3, 0.2, 0.1)], 0.04, growth=0.3, far=0.35)
    domain = Domain.ball(size=0.35)
    mesh = advancing_front(domain, field)
    assert check(mesh, domain=domain) and mesh.complete and mesh.quality("min_dihedral").min() > 15
    middle = mesh.corners.mean(axis=1)
    mean = np.sqrt(np.mean([((mesh.corners[:, i] - mesh.corners[:, j]) ** 2).sum(axis=1)
                            for i in range(4) for j in range(i)], axis=0))  # fmt: skip
    assert 0.85 < np.median(mean / field(middle)) < 1.2 and (mean / field(middle)).max() < 2


@pytest.mark.parametrize("h", [0.1, 0.15])
def test_a_fine_surface(h: float) -> None:
    """Cells grow from the surface inward by a share of its edges: there are no long ones on small faces."""
    domain = Domain.ball(size=h)
    mesh = advancing_front(domain, 0.6)
    assert check(mesh, domain=domain) and mesh.complete
    assert mesh.quality("min_dihedral").min() > 18


def test_sizes_by_region_and_a_coarse_surface() -> None:
    box = Domain.box(regions={"all": [0.5, 0.5, 0.5]})
    mesh = advancing_front(box, {"all": 0.2})
    assert check(mesh, domain=box)
    with pytest.warns(unstruct.IncompleteWarning, match="too large"):
        coarse = advancing_front(box, 0.2, split_boundary=False)
    assert check(coarse, domain=box) and len(coarse.steiner) == 0 and len(coarse.unrefined)
    with pytest.raises(InputError, match="all"):
        advancing_front(box, {"other": 0.2})


# --- options ---------------------------------------------------------------------------------------


def test_a_placement_of_the_caller() -> None:
    domain, h = BODIES["ball"], 0.25
    calls = []

    def above(a: np.ndarray, b: np.ndarray, c: np.ndarray, size: float) -> np.ndarray:
        normal = np.cross(b - a, c - a)
        calls.append(size)
        return (a + b + c) / 3 + 0.8 * size * normal / np.linalg.norm(normal)

    mesh = advancing_front(domain, h, placement=above)
    assert check(mesh, domain=domain) and mesh.counts["new point"] > 50
    np.testing.assert_allclose(calls, h, rtol=1e-12)
    closed = quiet(domain, h, placement=lambda a, b, c, h: None, finish=False)
    assert check(closed, domain=domain) and closed.counts["new point"] == 0
    assert closed.counts["angle"] > 0
    for wrong in ([0.0, 0.0], "up", [np.nan] * 3):
        with pytest.raises(InputError, match="placement returned"):
            advancing_front(domain, h, placement=lambda a, b, c, h, wrong=wrong: wrong)
    with pytest.raises(InputError, match="ZeroDivisionError"):
        advancing_front(domain, h, placement=lambda a, b, c, h: 1 / 0)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"order": "fastest"}, "order"), ({"placement": "circle"}, "placement"), ({"size": -1.0}, "size"),
        ({"split_boundary": "inner"}, "split_boundary"), ({"split_boundary": 3}, "split_boundary"),
        ({"method": "quick"}, "method"), ({"budget": -1}, "budget"), ({"finish": 2}, "finish"),
        ({"size": sizing.directional([1.0, 0.0], 0.1, 0.3)}, "SpaceMetric"),
    ],
)  # fmt: skip
def test_wrong_options(options: dict[str, Any], text: str) -> None:
    with pytest.raises(InputError, match=text):
        advancing_front(BODIES["box"], **({"size": 0.3} | options))


def test_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    work = lambda: advancing_front(Domain.ball(size=0.08), 0.08, progress=True, finish=False)  # noqa: E731
    assert max(interrupt(monkeypatch, work, "points")) <= 10_000
