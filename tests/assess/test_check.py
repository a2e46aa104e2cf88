"""The validator: valid meshes pass, and every kind of defect is found with the right culprit."""

from fractions import Fraction
from itertools import combinations, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError, Mesh
from unstruct.assess.check import check
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.mesh.embedding import boundary_is_convex


def random_points(n, d, seed=0):
    return np.random.default_rng(seed).random((n, d))


def lattice(side, d):
    return np.stack(np.meshgrid(*[np.arange(side)] * d, indexing="ij"), axis=-1).reshape(-1, d) * 1.0


def mapped_grid(n=6, stretch=0.0):
    """A square grid of triangles; ``stretch`` sends it through a map that folds for large values."""
    g = lattice(n, 2) / (n - 1)
    x, y = g.T
    points = np.column_stack([x - stretch * x * (1 - x), y])
    v = np.arange(n * n).reshape(n, n)
    a, b, c, d = (w.ravel() for w in (v[:-1, :-1], v[1:, :-1], v[1:, 1:], v[:-1, 1:]))
    return points, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def spiral(turns=1.4, n=40, width=0.4):
    """A strip that winds about the origin on a circle and so overlaps itself after one turn."""
    angle = np.linspace(0, 2 * np.pi * turns, n)
    inner = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([inner, (1 + width) * inner])
    i = np.arange(n - 1)
    return points, np.concatenate(
        [np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])]
    )


def double_cover(n=7):
    """A star of 2 n triangles that winds twice about its center; every triangle is positive."""
    angle = 2 * np.pi * np.arange(2 * n) * 2 / (2 * n)
    around = np.column_stack([np.cos(angle), np.sin(angle)]) * (1 + 0.01 * np.arange(2 * n))[:, None]
    i = np.arange(2 * n)
    return np.vstack([[0, 0], around]), np.column_stack([np.zeros_like(i), i + 1, (i + 1) % (2 * n) + 1])


def kinds(report):
    return {problem.kind for problem in report.problems}


def culprits(report, kind):
    problem = next(p for p in report.problems if p.kind == kind)
    return problem.cells, problem.vertices


# ---------------------------------------------------------------------- well meshes


@pytest.mark.parametrize("d", [1, 2, 3, 4])
@pytest.mark.parametrize("make", [random_points, lambda n, d: lattice(max(2, round(n ** (1 / d))), d)])
def test_delaunay_meshes_are_valid(d, make):
    mesh = delaunay(make({1: 20, 2: 40, 3: 27, 4: 16}[d], d))
    report = check(mesh, delaunay=True, brute=True)
    assert report, report
    assert bool(report) is True and report.problems == [] and str(report).startswith("valid: <Mesh")
    assert check(mesh, brute=True) and boundary_is_convex(mesh)
    assert any("rational numbers" in name for name in report.passed) == (d > 1)


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=25))
@settings(deadline=None, max_examples=40)
def test_degenerate_planar_sets_with_duplicates(rows):
    points = np.array(rows, dtype=float)
    if np.linalg.matrix_rank(points - points[0]) < 2:
        return
    mesh = delaunay(points)
    assert check(mesh, delaunay=True, brute=True)
    assert len(mesh.duplicates) == len(rows) - len(set(rows))


def test_meshes_that_are_not_convex_and_not_delaunay():
    points, cells = mapped_grid(6, 0.5)
    assert check(Mesh(points, cells))
    points, cells = spiral(0.9)
    assert check(Mesh(points, cells))
    report = check(Mesh(points, cells), delaunay=True)
    assert "concave boundary" in kinds(report)


def test_surfaces_and_a_warning_about_what_is_skipped():
    points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    octahedron = [[a, b, c] if (a + b + c) % 2 else [a, c, b] for a in (0, 1) for b in (2, 3) for c in (4, 5)]
    report = check(Mesh(points, octahedron))
    assert report and "whether the surface meets itself" in report.skipped
    turned = [*octahedron[:-1], octahedron[-1][::-1]]
    report = check(Mesh(points, turned))
    assert kinds(report) == {"orientation"} and 7 in culprits(report, "orientation")[0]
    flat = Mesh([[0, 0, 0], [1, 1, 1], [2, 2, 2], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    assert culprits(check(flat), "flat cell")[0] == (0,)


# ---------------------------------------------------------------------- defects, each with its culprit


def test_arrays_written_to_afterwards():
    points, cells = (np.array(a) for a in mapped_grid())
    cells = cells.astype(np.int32)
    mesh = Mesh(points, cells)
    points[7, 1] = np.nan
    assert culprits(check(mesh), "points") == ((), (7,))
    points[7, 1] = 0.2
    cells[3, 1] = 99
    assert culprits(check(mesh), "index") == ((3,), ())
    cells[3] = [1, 2, 1]
    assert culprits(check(mesh), "repeated vertex") == ((3,), ())


def test_no_cells():
    assert kinds(check(Mesh([[0.0, 0.0]], np.empty((0, 3), dtype=int)))) >= {"empty"}


def test_unused_vertices_and_wrong_duplicates():
    points, cells = mapped_grid()
    extra = np.vstack([points, points[4], [9, 9]])
    assert culprits(check(Mesh(extra, cells)), "unused vertex")[1] == (36, 37)
    assert culprits(check(Mesh(extra, cells, duplicates=[[36, 4]])), "unused vertex")[1] == (37,)
    report = check(Mesh(extra, cells, duplicates=[[36, 4], [37, 5]]))
    assert kinds(report) == {"duplicate"} and culprits(report, "duplicate")[1] == (37,)
    report = check(Mesh(points, cells, duplicates=[[3, 4]]))
    assert culprits(report, "duplicate")[1] == (3,)


def test_three_cells_at_an_edge():
    mesh = Mesh([[0, 0], [1, 0], [0, 1], [0, -1], [1, 1]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert culprits(check(mesh), "facet") == ((0, 1, 2), (0, 1))


def test_wrong_neighbors():
    points, cells = mapped_grid()
    right = Mesh(points, cells).neighbors
    wrong = right.copy()
    t = int(np.nonzero((right >= 0).all(axis=1))[0][3])
    wrong[t] = np.roll(right[t], 1)
    report = check(Mesh(points, cells, neighbors=wrong))
    assert kinds(report) == {"neighbors"} and culprits(report, "neighbors")[0] == (t,)


def test_a_turned_and_a_flat_cell():
    points, cells = mapped_grid()
    cells[11] = cells[11, ::-1]
    report = check(Mesh(points, cells))
    assert 11 in culprits(report, "orientation")[0]
    one = Mesh([[0, 0], [0, 1], [1, 0], [5, 5], [6, 6], [7, 7]], [[0, 1, 2], [3, 4, 5]])
    report = check(one)
    assert culprits(report, "negative cell")[0] == (0,) and culprits(report, "flat cell")[0] == (1,)


def test_one_unit_in_the_last_place_turns_a_cell():
    """0.1, 0.3 and a point off their line by one bit: exact signs see it."""
    mesh = Mesh([[0.1, 0.1], [0.3, 0.3], [0.2, np.nextafter(0.2, 1)]], [[0, 1, 2]])
    assert check(mesh)
    mesh = Mesh([[0.1, 0.1], [0.3, 0.3], [0.2, np.nextafter(0.2, 0)]], [[0, 1, 2]])
    assert kinds(check(mesh)) == {"negative cell"}


def test_a_folded_grid():
    points, cells = mapped_grid(8, 1.6)
    report = check(Mesh(points, cells))
    assert "negative cell" in kinds(report)
    folded = set(np.nonzero(Mesh(points, cells).volumes < 0)[0].tolist())
    assert set(culprits(report, "negative cell")[0]) == folded


def test_pinched_vertex():
    mesh = Mesh([[0, 0], [1, -1], [1, 1], [-1, 1], [-1, -1]], [[0, 1, 2], [0, 3, 4]])
    assert culprits(check(mesh), "pinched vertex")[1] == (0,)


def test_pinched_edge_and_vertex_in_space():
    points = [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]]
    mesh = Mesh(points, [[0, 2, 3, 1], [0, 4, 5, 1]])
    assert culprits(check(mesh), "pinched edge")[1] == (0, 1)
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
    mesh = Mesh(points, [[0, 1, 2, 3], [0, 5, 4, 6]])
    assert culprits(check(mesh.oriented()), "pinched vertex")[1] == (0,)


def test_a_cone_over_a_torus_has_a_bad_link():
    """Seven vertices make a torus (Moebius, Csaszar); an eighth joined to all is no ball at the apex."""
    torus = [[i, (i + 1) % 7, (i + 3) % 7] for i in range(7)] + [
        [i, (i + 3) % 7, (i + 2) % 7] for i in range(7)
    ]
    mesh = Mesh(random_points(8, 3), [[*row, 7] for row in torus])
    assert 7 in culprits(check(mesh), "link")[1]


def test_two_sheets_over_one_center():
    """Each triangle positive, all facets right, chi = 1: only the winding at vertex 0 is wrong."""
    points, cells = double_cover()
    report = check(Mesh(points, cells))
    assert kinds(report) == {"overlap"} and 0 in culprits(report, "overlap")[1]
    assert "overlap" in kinds(check(Mesh(points, cells), delaunay=True))


def test_two_sheets_over_an_edge_in_space():
    points, cells = double_cover()
    n = len(points)
    points = np.vstack([np.column_stack([points, np.zeros(n)]), [0, 0, 1]])
    mesh = Mesh(points, np.column_stack([cells, np.full(len(cells), n)])).oriented()
    report = check(mesh)
    assert kinds(report) == {"overlap"} and {0, n} <= set(culprits(report, "overlap")[1])


@pytest.mark.parametrize("brute", [False, True])
def test_a_strip_over_itself(brute):
    """Locally one-to-one everywhere: only the boundary shows the overlap."""
    points, cells = spiral(1.4)
    report = check(Mesh(points, cells), brute=brute)
    assert kinds(report) == {"crossing", "overlap"}
    assert check(Mesh(points, cells), delaunay=True).problems


@pytest.mark.parametrize("brute", [False, True])
def test_one_piece_inside_another(brute):
    """Boundaries that do not meet, yet cells overlap."""
    points = [[0, 0], [9, 0], [0, 9], [1, 1], [2, 1], [1, 2]]
    report = check(Mesh(points, [[0, 1, 2], [3, 4, 5]]), brute=brute)
    assert kinds(report) == {"overlap"}
    assert culprits(report, "overlap") == ((0,), (3, 4, 5))


def test_pieces_that_cross_without_holding_vertices():
    """A star of David of two triangles."""
    points = [[0, 2], [-2, -1], [2, -1], [0, -2], [2, 1], [-2, 1]]
    report = check(Mesh(points, [[0, 1, 2], [3, 4, 5]]))
    assert kinds(report) == {"crossing"} and culprits(report, "crossing")[1] == (0, 1, 2, 3, 4, 5)


def test_tetrahedra_that_cross():
    tetra = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    for shift in ([0.2, 0.2, -0.5], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.25, 0.25, 0.0]):
        both = Mesh(np.vstack([tetra, tetra + shift]), [[0, 1, 2, 3], [4, 5, 6, 7]])
        for brute in (False, True):
            assert not check(both, brute=brute), shift
    for shift in ([2, 0, 0], [-1.5, 0.25, 0.25], [0, 0, 1.0000001]):
        both = Mesh(np.vstack([tetra, tetra + shift]), [[0, 1, 2, 3], [4, 5, 6, 7]])
        assert check(both), shift


def test_touching_cells_are_told_from_separate_ones_by_the_last_bit():
    """Vertex 3 lies next to the edge from 0 to 1 of the other cell, within rounding."""
    third = 1 / 3
    points = [[0, 0], [1, third], [0, 1], [third, third * third], [1, -1], [2, 0]]
    report = check(Mesh(points, [[0, 1, 2], [3, 4, 5]]))
    above = Fraction(third * third) >= Fraction(third) * Fraction(third)
    assert bool(report) is not above
    points[3][1] = np.nextafter(points[3][1], -1 if above else 1)
    assert bool(check(Mesh(points, [[0, 1, 2], [3, 4, 5]]))) is above


def test_a_concave_boundary_is_named():
    mesh = Mesh([[0, 0], [2, 1], [4, 0], [2, 4]], [[0, 1, 3], [1, 2, 3]])
    assert check(mesh)
    report = check(mesh, delaunay=True)
    assert 1 in culprits(report, "concave boundary")[1]
    assert not boundary_is_convex(mesh)


def test_two_pieces_are_no_hull():
    points = [[0, 0], [1, 0], [0, 1], [5, 5], [6, 5], [5, 6]]
    mesh = Mesh(points, [[0, 1, 2], [3, 4, 5]])
    assert check(mesh)
    assert culprits(check(mesh, delaunay=True), "pieces")[0] == (1,)


@pytest.mark.parametrize("brute", [False, True])
def test_one_flipped_diagonal(brute):
    points = random_points(60, 2, seed=4)
    mesh = delaunay(points)
    for t, i in np.argwhere(mesh.neighbors > np.arange(mesh.size)[:, None]).tolist():
        s = int(mesh.neighbors[t, i])
        a, b, c = np.roll(mesh.simplices[t], -i).tolist()
        q = int(next(v for v in mesh.simplices[s].tolist() if v not in (a, b, c)))
        flipped = Mesh(points, np.vstack([np.delete(mesh.simplices, [t, s], axis=0), [a, b, q], [a, q, c]]))
        if (flipped.volumes > 0).all():
            break
    assert check(flipped)
    report = check(flipped, delaunay=True, brute=brute)
    assert kinds(report) == {"not Delaunay"}
    assert set(culprits(report, "not Delaunay")[0]) & {mesh.size - 2, mesh.size - 1}


def test_marked_facets_are_opaque():
    points = np.array([[0.0, 0.0], [4.0, 0.0], [2.0, 0.5], [2.0, -0.5]])
    cells = [[0, 1, 2], [0, 3, 1]]
    free = Mesh(points, cells)
    assert kinds(check(free, delaunay=True)) == kinds(check(free, delaunay="constrained")) == {"not Delaunay"}
    held = Mesh(points, cells, markers={"wall": [[1, 0]]})
    assert check(held, delaunay="constrained")
    assert kinds(check(held, delaunay=True)) == {"not Delaunay"}


@pytest.mark.parametrize("d", [2, 3])
@given(data=st.data())
@settings(deadline=None, max_examples=25)
def test_local_and_brute_force_agree_after_a_vertex_moves(d, data):
    """Moving a vertex of a Delaunay mesh may or may not spoil it: both ways of looking must agree."""
    mesh = delaunay(random_points(14, d, seed=data.draw(st.integers(0, 50))))
    points = mesh.points.copy()
    v = data.draw(st.integers(0, len(points) - 1))
    points[v] += np.array(data.draw(st.lists(st.integers(-8, 8), min_size=d, max_size=d))) / 64
    moved = Mesh(points, mesh.simplices)
    fast, slow = check(moved, delaunay=True, brute=False), check(moved, delaunay=True, brute=True)
    assert bool(fast) == bool(slow)
    overlap = check(moved, brute=False)
    assert bool(overlap) == bool(check(moved, brute=True))
    assert bool(overlap) or not fast


def test_the_kuhn_cube_in_four_dimensions_and_a_spoiled_one():
    cube = np.array(list(np.ndindex(2, 2, 2, 2)), dtype=float)
    cells = []
    for p in permutations(range(4)):
        path = [0]
        for axis in p:
            path.append(path[-1] + (8 >> axis))
        cells.append(path)
    mesh = Mesh(cube, cells).oriented()
    assert check(mesh, delaunay=True, brute=True) and mesh.volume == pytest.approx(1)
    report = check(mesh.select(np.arange(24) != 5), delaunay=True)
    assert "concave boundary" in kinds(report)


# ---------------------------------------------------------------------- mixed cells


def quads(n=4, fold=None):
    points = lattice(n, 2)
    if fold is not None:
        points[fold] += [1.6, 1.6]
    v = np.arange(n * n).reshape(n, n)
    corners = (v[:-1, :-1], v[1:, :-1], v[1:, 1:], v[:-1, 1:])
    return Mesh(points, cells={"quad": np.column_stack([w.ravel() for w in corners])})


def test_quadrilaterals():
    assert check(quads())
    report = check(quads(fold=5))
    assert 4 in culprits(report, "negative cell")[0]


@pytest.mark.parametrize(
    ("polygons", "kind"),
    [
        ([[0, 1, 2, 3], [1, 4, 5, 2]], None),
        ([[0, 1, 2, 3], [1, 2, 5, 4]], "orientation"),
        ([[3, 2, 1, 0], [2, 5, 4, 1]], "negative cell"),
        ([[0, 1, 3, 2], [1, 4, 5, 2]], "negative cell"),
        ([[0, 1, 2, 3], [1, 4, 5, 2], [2, 1, 5]], "facet"),
        ([[0, 1, 2, 3], [0, 4, 5]], "crossing"),
        ([[0, 4, 5, 3], [6, 7, 8]], "overlap"),
    ],
)
def test_polygons(polygons, kind):
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1], [0.2, 0.2], [0.4, 0.2], [0.2, 0.4]])
    used, rows = np.unique(np.concatenate(polygons), return_inverse=True)
    rows = np.split(rows, np.cumsum([len(p) for p in polygons])[:-1])
    report = check(Mesh(points[used], cells={"polygon": rows}))
    assert report if kind is None else kind in kinds(report), report


def test_unused_vertices_of_mixed_meshes():
    mesh = Mesh([[0, 0], [1, 0], [1, 1], [0, 1], [5, 5]], cells={"quad": [[0, 1, 2, 3]]})
    assert culprits(check(mesh), "unused vertex")[1] == (4,)


def test_solids():
    points = np.array(list(np.ndindex(2, 2, 2)), dtype=float)[:, ::-1]
    cube = [0, 1, 3, 2, 4, 5, 7, 6]
    assert check(Mesh(points, cells={"hexahedron": [cube]}))
    points[7] = [-0.5, -0.5, 0.4]
    assert culprits(check(Mesh(points, cells={"hexahedron": [cube]})), "negative cell")[0] == (0,)
    stack = np.vstack([np.array(list(np.ndindex(3, 2, 2)), dtype=float)])[:, ::-1]
    two = [cube, [4, 5, 7, 6, 8, 9, 11, 10]]
    assert check(Mesh(stack, cells={"hexahedron": two}))
    mirrored = [cube, [8, 9, 11, 10, 4, 5, 7, 6]]
    assert "orientation" in kinds(check(Mesh(stack, cells={"hexahedron": mirrored})))


# ---------------------------------------------------------------------- the report


def test_the_report_reads_well():
    points, cells = mapped_grid(20, 1.6)
    text = str(check(Mesh(points, cells)))
    assert text.startswith("not valid: <Mesh: 400 points") and "in all)" in text
    assert "skipped" in text and repr(check(Mesh(points, cells))) == text


def test_wrong_arguments():
    with pytest.raises(InputError, match="'constrained'"):
        check(quads(), delaunay="yes")
    with pytest.raises(InputError, match="mesh must be a Mesh, not NoneType"):
        check(None)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="domain must be a Domain, not int"):
        check(quads(), domain=5)  # type: ignore[arg-type]


def test_crossings_of_segments_against_rationals():
    """All pairs of segments on a small lattice, ties included, against an independent rule."""
    from unstruct.mesh.embedding import crossing_facets

    rng = np.random.default_rng(8)
    points = lattice(4, 2)
    for _ in range(150):
        p, q, a, b = rng.choice(16, 4, replace=True).tolist()
        if p == q or a == b or {p, q} == {a, b}:
            continue
        grid = [points[p] + (points[q] - points[p]) * k / 60 for k in range(61)]
        shared = {p, q} & {a, b}
        direction = points[b] - points[a]
        inside = 0
        for x in grid:  # on this lattice all crossings are at multiples of 1/60
            off = x - points[a]
            on = abs(direction[0] * off[1] - direction[1] * off[0]) < 1e-9
            inside += on and -1e-9 <= off @ direction <= direction @ direction + 1e-9
        meets = inside > len(shared)
        found = len(crossing_facets(points, np.array([[p, q], [a, b]]))) > 0
        exact_hit = inside > 0 or _proper(points[[p, q, a, b]])
        assert found == (meets if shared else exact_hit), (p, q, a, b)


def _proper(x):
    def turn(i, j, k):
        return np.sign(np.linalg.det([x[j] - x[i], x[k] - x[i]]).round(9))

    return turn(0, 1, 2) * turn(0, 1, 3) < 0 and turn(2, 3, 0) * turn(2, 3, 1) < 0


def test_fans_match_a_direct_count():
    """The wedges about each interior edge of a small mesh in space contain a random direction once."""
    from unstruct.mesh.embedding import RidgeFans

    mesh = delaunay(random_points(25, 3, seed=2))
    fans = RidgeFans(mesh.points, mesh.simplices, mesh.neighbors)
    assert len(fans.group) == mesh.size * 6 and len(fans.overlaps()) == 0
    signs = [
        np.linalg.det(mesh.points[[*r, a, b]][1:] - mesh.points[r[0]])
        for r, a, b in zip(fans.ridges, fans.a, fans.b)
    ]
    assert min(signs) > 0
    open_edges = {tuple(sorted(e)) for f in mesh.boundary.tolist() for e in combinations(f, 2)}
    assert {tuple(r) for r in fans.ridges[fans.starts].tolist()} == open_edges
