"""`check(mesh, domain=...)`: passes good meshes, and catches every kind of damage by its name."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from regions import KINDS, random_region

from unstruct import (
    Arc,
    Domain,
    DomainMesh,
    InputError,
    Mesh,
    check,
    constrained_delaunay,
    refine,
    voronoi_segment,
)
from unstruct.assess.region import scatter_of
from unstruct.examples import running_domain, running_size
from unstruct.geometry import parity
from unstruct.geometry.parity import cells_area, enclosed_area
from unstruct.mesh.topology import boundary, neighbors

WIDE = [[0, 0], [4, 0], [4, 4], [0, 4], [1, 1], [2, 1], [2, 2], [1, 2], [3, 3]]
FACETS = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]


def region() -> Domain:
    """A square with a square hole, a wall inside, a loose vertex, an arc for a side, names."""
    return Domain(
        [*WIDE, [3.5, 1]],
        FACETS,
        inner=[[1, 5]],
        curves={1: Arc.through((4, 0), (4.5, 2), (4, 4))},
        markers={"arc": [1], "wall": [8]},
        regions={"water": [0.5, 3]},
    )


@pytest.fixture(scope="module")
def good() -> tuple[Mesh, Domain]:
    domain = region()
    return refine(domain, 0.6, min_angle=20), domain


def remade(mesh: Mesh, **changes) -> Mesh:
    """The same mesh with other arrays; neighbors are computed anew unless given."""
    arrays = {
        "points": np.array(mesh.points),
        "simplices": np.array(mesh.simplices),
        "origin": np.array(mesh.origin),
        "markers": {name: np.array(rows) for name, rows in mesh.markers.items()},
    }
    return Mesh(**{**arrays, **changes})


def kinds(mesh: Mesh, domain: Domain) -> set[str]:
    report = check(mesh, domain=domain)
    assert bool(report) == (not report.problems)
    return {each.kind for each in report.problems}


def without(mesh: Mesh, cells) -> Mesh:
    """The mesh without some cells, vertices kept."""
    keep = ~np.isin(np.arange(mesh.size), cells)
    markers = {n: np.array(r[keep] if r.ndim == 1 else r) for n, r in mesh.markers.items()}
    return remade(mesh, simplices=mesh.simplices[keep], markers=markers)


def with_markers(mesh: Mesh, **changes) -> Mesh:
    return remade(mesh, markers={**{n: np.array(r) for n, r in mesh.markers.items()}, **changes})


def test_a_good_mesh_passes(good) -> None:
    mesh, domain = good
    report = check(mesh, domain=domain, delaunay="constrained")
    assert report and not report.skipped, report
    assert any("true curves" in name for name in report.passed)
    assert any("even-odd" in name for name in report.passed)


@pytest.mark.parametrize("kind", KINDS)
def test_good_meshes_of_random_regions_pass(kind: str) -> None:
    for seed in range(15):
        domain = random_region(np.random.default_rng([seed, 2]), kind)
        mesh = constrained_delaunay(domain)
        report = check(mesh, domain=domain, delaunay="constrained")
        assert report, f"{kind} {seed}\n{report}"
        fine = refine(domain, min_angle=15, budget=400)
        assert check(fine, domain=domain, delaunay="constrained"), f"refined {kind} {seed}"


@pytest.mark.parametrize("kind", range(4))
def test_repaired_random_input_passes(kind: int) -> None:
    """Random segments on few points: integers, doubles, a strip of sixteen last bits, multiples of 0.1."""
    meshed = 0
    for seed in range(40):
        rng = np.random.default_rng([kind, seed])
        m = int(rng.integers(3, 20))
        points = [
            rng.integers(0, 6, size=(m, 2)).astype(float),
            rng.random((m, 2)),
            rng.random((m, 2)) * [1, 2.0**-48] + 1,
            rng.integers(0, 4, size=(m, 2)) * 0.1,
        ][kind]
        order = rng.permutation(m)
        ring = np.column_stack([order, np.roll(order, -1)])
        rows = ring if seed % 2 else rng.integers(0, m, size=(int(rng.integers(1, 15)), 2))
        try:
            domain = Domain(points, rows, inner=rng.integers(0, m, size=(4, 2)), resolve=True)
        except InputError as error:
            assert "no facet is left" in str(error), seed
            continue
        mesh = constrained_delaunay(domain)
        assert check(mesh, domain=domain, delaunay="constrained"), seed
        meshed += 1
    assert meshed >= 15


def test_every_cell_is_needed(good) -> None:
    mesh, domain = good
    for cell in range(0, mesh.size, 7):
        assert not check(without(mesh, [cell]), domain=domain), f"cell {cell} is not missed"


def inside_cell(mesh: Mesh) -> int:
    """A cell off the boundary, none of whose edges is marked."""
    known = np.zeros(len(mesh.points), dtype=bool)
    known[np.unique(mesh.boundary)] = True
    known[np.unique(mesh.markers["inner"])] = True
    return int(np.nonzero(~known[mesh.simplices].any(axis=1))[0][0])


def test_a_hole_that_is_not_in_the_domain(good) -> None:
    mesh, domain = good
    assert "boundary" in kinds(without(mesh, [inside_cell(mesh)]), domain)


def test_a_hole_that_is_filled() -> None:
    domain = Domain.polygon(WIDE[:4], [WIDE[4:8]])
    mesh = constrained_delaunay(domain)
    filled = remade(mesh, simplices=np.concatenate([mesh.simplices, [[4, 5, 6], [4, 6, 7]]]),
                    markers={"facets": mesh.markers["facets"]})  # fmt: skip
    assert check(filled)
    assert "facet" in kinds(filled, domain)
    outer = with_markers(filled, facets=boundary(filled.simplices, neighbors(filled.simplices)))
    assert kinds(outer, domain) == {"missing piece"}


def test_a_vertex_that_left_its_curve(good) -> None:
    mesh, domain = good
    arc = np.unique(mesh.markers["arc"])
    new = arc[mesh.origin[arc] < 0][0]
    for factor, well in ((2.0**-51, True), (2.0**-45, False), (1e-3, False)):
        points = np.array(mesh.points)
        away = points[new] - domain.curves[1].center
        points[new] += factor * away
        found = kinds(remade(mesh, points=points), domain)
        assert found == (set() if well else {"off the curve"}), (factor, found)


def test_a_vertex_that_left_its_segment(good) -> None:
    mesh, domain = good
    bottom = np.nonzero((mesh.points[:, 1] == 0) & (mesh.origin < 0))[0][0]
    points = np.array(mesh.points)
    points[bottom, 1] = 1e-9
    assert kinds(remade(mesh, points=points), domain) == {"off the curve"}


def test_a_domain_vertex_that_moved(good) -> None:
    mesh, domain = good
    points = np.array(mesh.points)
    corner = int(np.nonzero(mesh.origin == 8)[0][0])
    points[corner] = np.nextafter(points[corner], 9)
    assert kinds(remade(mesh, points=points), domain) == {"moved"}


def test_a_wrong_order_along_a_piece() -> None:
    """Two new vertices of a side exchanged: the cells between are turned too, so a needle is added."""
    domain = Domain.polygon([[0, 0], [4, 0], [0, 4]])
    points = np.array([[0, 0], [4, 0], [0, 4], [3, 0], [1, 0.0]])
    folded = Mesh(
        points,
        [[0, 3, 2], [3, 4, 2], [4, 1, 2]],
        origin=[0, 1, 2, -1, -1],
        markers={"facets": [[0, 3], [3, 4], [4, 1], [1, 2], [2, 0]]},
    )
    assert not check(folded, domain=domain)
    # geometry is tested before; the order itself is tested on a chain whose cells are valid
    from unstruct.assess.chains import Chains
    from unstruct.assess.region import _curves_met
    from unstruct.base.report import Report

    report = Report("order")
    chains = Chains(np.array([0, 4]), np.array([0, 3, 4, 1]), np.array([0]))
    _curves_met(folded, domain, chains, report)
    assert {p.kind for p in report.problems} == {"order"} and report.problems[0].vertices == (3, 4)


def more(mesh: Mesh, name: str, rows) -> Mesh:
    return with_markers(mesh, **{name: np.concatenate([mesh.markers[name], rows])})


def fewer(mesh: Mesh, name: str) -> Mesh:
    return remade(mesh, markers={n: rows for n, rows in mesh.markers.items() if n != name})


def one_cell_elsewhere(mesh: Mesh) -> np.ndarray:
    return np.where(np.arange(mesh.size) == 3, 7, mesh.markers["region"])


MARKS: dict[str, tuple[Callable[[Mesh], Mesh], str]] = {
    "facet missing": (lambda m: with_markers(m, facets=m.markers["facets"][1:]), "boundary"),
    "facet twice": (lambda m: more(m, "facets", m.markers["facets"][:1]), "marked twice"),
    "inner missing": (lambda m: with_markers(m, inner=m.markers["inner"][1:]), "chain"),
    "no inner": (lambda m: with_markers(m, inner=np.empty((0, 2), dtype=int)), "missing piece"),
    "inner too many": (lambda m: more(m, "inner", loose_edge(m)), "chain"),
    "inner no edge": (lambda m: more(m, "inner", [[0, 2]]), "inner"),
    "facet as inner": (
        lambda m: with_markers(m, inner=m.markers["facets"][:1], facets=m.markers["facets"][1:]),
        "inner",
    ),
    "no marks": (lambda m: remade(m, markers={}), "boundary"),
    "name missing": (lambda m: fewer(m, "arc"), "marker"),
    "name elsewhere": (lambda m: with_markers(m, arc=m.markers["wall"]), "marker"),
    "name partly": (lambda m: with_markers(m, arc=m.markers["arc"][:-1]), "marker"),
    "region elsewhere": (lambda m: with_markers(m, region=one_cell_elsewhere(m)), "region"),
    "regions exchanged": (lambda m: with_markers(m, region=5 - m.markers["region"]), "region"),
    "no region": (lambda m: fewer(m, "region"), "region"),
}


def loose_edge(mesh: Mesh) -> np.ndarray:
    return mesh.simplices[inside_cell(mesh)][None, :2]


@pytest.mark.parametrize("name", MARKS)
def test_wrong_markers(good, name: str) -> None:
    mesh, domain = good
    damage, kind = MARKS[name]
    assert kind in kinds(damage(mesh), domain)


def test_one_cell_in_the_wrong_region_is_named_alone() -> None:
    """Not all others, where that cell happens to be the first of its part."""
    domain = Domain.rectangle()
    mesh = refine(domain, 0.3)
    region = np.array(mesh.markers["region"])
    region[0] = 5
    report = check(with_markers(mesh, region=region), domain=domain)
    assert next(p.cells for p in report.problems if p.kind == "region") == (0,)


def test_wrong_origins(good) -> None:
    mesh, domain = good
    for value, kind in ((99, "origin"), (-2, "origin"), (0, "origin"), (-1, "chain")):
        origin = np.array(mesh.origin)
        origin[np.nonzero(origin == 4)[0]] = value
        found = kinds(remade(mesh, origin=origin), domain)
        assert kind in found or (value == -1 and found), (value, found)


def test_loose_vertices() -> None:
    square = Domain([[0, 0], [4, 0], [4, 4], [0, 4], [1, 2], [9, 9]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    mesh = constrained_delaunay(square)
    assert check(mesh, domain=square) and 5 not in mesh.origin
    plain = constrained_delaunay(Domain.polygon(square.points[:4]))
    assert kinds(plain, square) == {"missing vertex"}


def test_names_of_missing_pieces(good) -> None:
    mesh, _ = good
    more = Domain([*WIDE, [3.5, 1], [3.4, 3.5]], FACETS, inner=[[1, 5], [8, 10]], curves=region().curves)
    assert "inner segment 1 = [8, 10]" in str(check(mesh, domain=more))


def test_inner_pieces_outside_are_not_asked_for() -> None:
    domain = Domain([*WIDE, [6, 6], [7, 7]], FACETS, inner=[[9, 10]])
    assert check(constrained_delaunay(domain), domain=domain)


def test_two_curves_with_the_same_ends() -> None:
    arcs = {0: Arc.through((0, 0), (0.5, 0.5), (1, 0)), 1: Arc.through((0, 0), (0.5, -0.2), (1, 0))}
    lens = Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves=arcs, markers={"top": [0], "bottom": [1]})
    mesh = refine(lens, 0.1)
    assert check(mesh, domain=lens)
    swapped = with_markers(mesh, top=mesh.markers["bottom"], bottom=mesh.markers["top"])
    assert kinds(swapped, lens) == {"marker"}


def test_pinched_vertices_of_the_domain_are_allowed_and_no_others() -> None:
    corner = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 1], [2, 2], [1, 2]]
    facets = [[0, 1], [1, 2], [2, 3], [3, 0], [2, 4], [4, 5], [5, 6], [6, 2]]
    domain = Domain(corner, facets)
    mesh = constrained_delaunay(domain)
    assert not check(mesh) and check(mesh, domain=domain)
    lone = Domain(corner, facets[:4], inner=facets[4:])
    assert "pinched vertex" in {p.kind for p in check(mesh, domain=lone).problems}


def test_areas_are_summed_without_error() -> None:
    rng = np.random.default_rng(0)
    domain = Domain.polygon(1e8 + rng.random((3, 2)) * 1e-3)
    mesh = refine(domain, 1e-4)
    assert cells_area(mesh.points, mesh.simplices) == enclosed_area(mesh.points, mesh.boundary)
    for scale in (2.0**600, 2.0**-400):
        far = Domain.polygon(scale * np.array([[0, 0], [3, 0], [0, 1]]))
        assert check(constrained_delaunay(far), domain=far)


def test_space_and_other_cells_are_refused() -> None:
    square = Domain.rectangle()
    tetra = Mesh(np.vstack([np.zeros(3), np.eye(3)]), [[0, 1, 2, 3]])
    assert {p.kind for p in check(tetra, domain=square).problems} == {"domain"}
    quad = Mesh(square.points, cells={"quad": [[0, 1, 2, 3]]})
    assert "boundary" in {p.kind for p in check(quad, domain=square).problems}, "no edges are marked"
    plain = Domain.polygon(square.points)
    assert check(Mesh(square.points, cells=quad.cells, markers={"facets": quad.boundary}), domain=plain)


def test_a_domain_without_facets() -> None:
    lines = Domain([[0, 0], [4, 0], [4, 4], [0, 4]], [], inner=[[0, 2]])
    mesh = constrained_delaunay(lines, hull=True)
    report = check(mesh, domain=lines)
    assert {p.kind for p in report.problems} == {"boundary"}  # the hull is not what the domain bounds


def test_areas_of_very_many_exponents() -> None:
    """Found by fuzzing: more than 64 partial sums, which were written beyond their array."""
    rng = np.random.default_rng(3)
    size = np.sort(rng.integers(-500, 0, (4000, 1, 1)), axis=0)  # from the smallest: each stays by itself
    corners = np.ldexp(rng.random((4000, 3, 2)) - 0.5, size - rng.integers(0, 20, (4000, 3, 2)))
    turned = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    corners[turned] = corners[turned, ::-1]
    exact = Fraction(0)
    for (ax, ay), (bx, by), (cx, cy) in corners.tolist():
        a, b, c, d = (Fraction(p) - Fraction(q) for p, q in ((bx, ax), (cy, ay), (by, ay), (cx, ax)))
        exact += a * b - c * d
    points, cells = corners.reshape(-1, 2), np.arange(12000, dtype=np.int32).reshape(-1, 3)
    assert parity._twice_area(points, cells, np.zeros(2200)) > 200
    found = cells_area(points, cells)
    assert found == float(exact / 2)


def test_functions_for_curves_may_scatter() -> None:
    """The shore of the lake scatters by 118 units of rounding; that is no fault of a vertex on it."""
    domain = running_domain()
    piece = np.repeat(list(domain.curves), 500)
    t = np.random.default_rng(0).random(len(piece))
    x = domain.points_at(piece, t)
    scatter = scatter_of(domain, piece, t)
    assert 50 * 2.0**-53 < scatter.max() < 1e-13
    mesh = voronoi_segment(domain, running_size)
    assert check(mesh, domain=domain)
    moved = mesh.points.copy()
    new = np.setdiff1d(mesh.segments[mesh.piece == 5], np.flatnonzero(mesh.origin >= 0))[3]
    moved[new] += 1e-12
    options = {"markers": mesh.markers, "segments": mesh.segments, "piece": mesh.piece, "span": mesh.span}
    off = DomainMesh(moved, mesh.simplices, origin=mesh.origin, regions=mesh.regions, **options)
    assert [p.kind for p in check(off, domain=domain).problems] == ["off the curve"]
    assert np.isfinite(x).all()


def test_two_arcs_of_nearly_one_circle_between_the_same_vertices() -> None:
    """One of them is a single chord: it fits both, so that the other one chooses first."""
    arcs = {0: Arc.through((0, 0), (0.5, 0.4642), (1, 0)), 1: Arc.through((0, 0), (0.5, -0.5396), (1, 0))}
    domain = Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves=arcs)
    mesh = voronoi_segment(domain, 1.08)
    assert sorted(np.bincount(mesh.piece)) == [1, 2]
    assert check(mesh, domain=domain)
