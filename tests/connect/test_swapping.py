"""Diagonal swapping against the definition, against its plain version, and on everything that is hard."""

import os
import subprocess
import sys
from fractions import Fraction
from itertools import combinations
from math import comb

import numpy as np
import pytest
from fixtures import HARD_2D
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct.base.errors import DegenerateInputError, InputError, MeshError, UnstructError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.swapping import constraints, replay, swap_diagonals
from unstruct.examples.running import random_triangulation, running_region, sweep_triangulation
from unstruct.mesh.mesh import Mesh
from unstruct.mesh.topology import neighbors
from unstruct.plain.lawson import lawson, triangle
from unstruct.plain.predicates import orient as plain_orient
from unstruct.plain.triangulations import all_triangulations, is_delaunay
from unstruct.predicates.batch import in_sphere, orient

SMALL_SETS = {
    "hexagon": [(2, 0), (4, 0), (6, 2), (4, 4), (2, 4), (0, 2)],
    "parabola": [(i, i * i) for i in range(7)],
    "grid": [(x, y) for x in range(3) for y in range(3)],
    "star": [(0, 0), (5, 1), (1, 5), (-4, 2), (-3, -4), (3, -4), (1, 0)],
    "circle and center": [(1, 0), (0, 1), (-1, 0), (0, -1), (0, 0)],
    "collinear inside": [(0, 0), (4, 0), (1, 1), (2, 1), (3, 1), (2, 4)],
}


def cells(mesh):
    return {triangle(*t) for t in mesh.simplices.tolist()}


def double_area(points, simplices):
    """Twice the area, exactly."""
    exact = [[Fraction(x) for x in p] for p in np.asarray(points).tolist()]
    total = Fraction(0)
    for a, b, c in np.asarray(simplices).tolist():
        (ax, ay), (bx, by), (cx, cy) = exact[a], exact[b], exact[c]
        total += (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return total


def edge_set(simplices):
    return {frozenset(e) for t in np.asarray(simplices).tolist() for e in combinations(t, 2)}


def illegal_edges(mesh):
    """Inner edges with the far corner strictly inside the circle, by the public predicate."""
    T, N = mesh.simplices, neighbors(mesh.simplices)
    t, i = np.nonzero(N >= 0)
    s = N[t, i]
    j = np.argmax(N[s] == t[:, None], axis=1)
    signs = in_sphere(mesh.points[T[t]], mesh.points[T[s, j]])
    bad = signs > 0
    return {frozenset((int(T[a, (b + 1) % 3]), int(T[a, (b + 2) % 3]))) for a, b in zip(t[bad], i[bad])}


def same_region(before, after):
    """Same area, boundary and vertices, all triangles counterclockwise, adjacency right."""
    assert (orient(after.points[after.simplices]) > 0).all()
    assert double_area(before.points, before.simplices) == double_area(after.points, after.simplices)
    assert {tuple(e) for e in before.boundary.tolist()} == {tuple(e) for e in after.boundary.tolist()}
    assert set(before.simplices.ravel().tolist()) == set(after.simplices.ravel().tolist())
    assert (after.neighbors == neighbors(after.simplices)).all()


def spans(points):
    return any(plain_orient([points[0], p, q]) for p, q in combinations(points[1:], 2))


point_sets = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=24, unique=True)


# --- every triangulation of small sets -------------------------------------------------------------


@pytest.mark.parametrize("name", SMALL_SETS)
def test_every_triangulation_becomes_delaunay(name):
    points = SMALL_SETS[name]
    n = len(points)
    everything = list(all_triangulations(points))
    delaunay = {t for t in everything if is_delaunay(points, t)}
    reached = set()
    for start in everything:
        mesh = Mesh(np.array(points, dtype=float), sorted(start))
        result, swaps = swap_diagonals(mesh, history=True)
        assert frozenset(cells(result)) in delaunay
        same_region(mesh, result)
        plain, flips = lawson(points, start)
        assert frozenset(plain) in delaunay
        assert max(len(swaps), len(flips)) <= comb(n, 2)
        gone = [frozenset(old) for old, _ in flips]
        assert len(set(gone)) == len(gone) and not set(gone) & edge_set(sorted(plain))
        if start in delaunay:
            assert len(swaps) == 0 and not flips
        reached.add(frozenset(cells(result)))
    assert reached == delaunay  # with ties each of them is an end: where swapping starts, it stays


def test_number_of_ends_under_ties():
    """A regular hexagon's affine image on a circle has Catalan(4) = 14 Delaunay triangulations."""
    circle = [(5, 0), (4, 3), (-3, 4), (-5, 0), (-4, -3), (3, -4)]
    everything = list(all_triangulations(circle))
    assert len(everything) == 14 and all(is_delaunay(circle, t) for t in everything)


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=3, max_size=7, unique=True))
@settings(max_examples=40, deadline=None)
def test_every_triangulation_of_random_sets(points):
    assume(spans(points))
    everything = list(all_triangulations(points))
    delaunay = {t for t in everything if is_delaunay(points, t)}
    assert delaunay
    for start in everything:
        assert (
            frozenset(cells(swap_diagonals(Mesh(np.array(points, dtype=float), sorted(start))))) in delaunay
        )


# --- larger sets -----------------------------------------------------------------------------------


@given(point_sets, st.integers(0, 99))
@settings(max_examples=100, deadline=None)
def test_random_triangulations_become_delaunay(points, seed):
    assume(spans(points))
    start = random_triangulation(points, seed)
    result, swaps = swap_diagonals(start, history=True)
    same_region(start, result)
    assert is_delaunay(points, cells(result))
    assert len(swaps) <= comb(len(points), 2)
    plain, _ = lawson(points, start.simplices.tolist())
    assert is_delaunay(points, plain)


@pytest.mark.parametrize("name", HARD_2D)
def test_hard_sets(name):
    points = np.asarray(HARD_2D[name]() if callable(HARD_2D[name]) else HARD_2D[name])
    start = random_triangulation(points, 3)
    result, swaps = swap_diagonals(start, history=True)
    same_region(start, result)
    assert not illegal_edges(result)
    assert (result.points == points).all() and (result.duplicates == start.duplicates).all()
    used = np.unique(result.simplices)
    assert len(used) + len(result.duplicates) == len(points)
    assert not np.isin(result.duplicates[:, 0], used).any()
    assert (points[result.duplicates[:, 0]] == points[result.duplicates[:, 1]]).all()
    assert cells(replay(start, swaps)) == cells(result)


@pytest.mark.parametrize("reach", [500, 1000])
def test_exponents_too_wide_for_scaling(reach):
    """Doubles from 2^-reach to 2^reach: the kernels take the exact path throughout."""
    points = np.ldexp(
        [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (3, 1), (1, -1)], [[reach]] * 4 + [[-reach]] * 3
    )
    start = sweep_triangulation(points)
    result = swap_diagonals(start)
    same_region(start, result)
    assert is_delaunay(points.tolist(), cells(result))


def test_a_swap_that_only_the_last_bit_decides():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    start = [(0, 1, 2), (0, 2, 3)]
    assert len(swap_diagonals(Mesh(square, start), history=True)[1]) == 0  # a tie is left alone
    square[3] = (0.0, np.nextafter(1.0, 0.0))
    assert len(swap_diagonals(Mesh(square, start), history=True)[1]) == 1
    square[3] = (0.0, np.nextafter(1.0, 2.0))
    assert len(swap_diagonals(Mesh(square, start), history=True)[1]) == 0


def test_large_and_bad_start():
    points = np.random.default_rng(1).random((30_000, 2))
    start = sweep_triangulation(points)
    result, swaps = swap_diagonals(start, history=True)
    assert not illegal_edges(result) and len(illegal_edges(start)) > 20_000
    same_region(start, result)
    assert len(swaps) < 20 * len(points)
    again, none = swap_diagonals(result, history=True)
    assert len(none) == 0 and (again.simplices == result.simplices).all()


# --- histories -------------------------------------------------------------------------------------


def test_replay_ends_at_the_identical_mesh_and_passes_through_meshes():
    start = random_triangulation(np.random.default_rng(5).random((40, 2)), 5)
    result, swaps = swap_diagonals(start, history=True)
    whole = replay(start, swaps)
    assert (whole.simplices == result.simplices).all() and (whole.neighbors == result.neighbors).all()
    assert (replay(start, []).simplices == start.simplices).all()
    edges = edge_set(start.simplices)
    for k in range(1, len(swaps) + 1):
        state = replay(start, swaps[:k])
        same_region(start, state)
        later = edge_set(state.simplices)
        assert len(edges - later) == len(later - edges) == 1  # one edge goes, one comes
        edges = later


def test_swapped_edges_never_return():
    start = random_triangulation(np.random.default_rng(6).random((60, 2)), 6)
    _, swaps = swap_diagonals(start, history=True)
    gone, edges = set(), edge_set(start.simplices)
    for k in range(1, len(swaps) + 1):
        later = edge_set(replay(start, swaps[:k]).simplices)
        gone |= edges - later
        assert not gone & later
        edges = later
    assert len(gone) == len(swaps) > 100


def test_replay_refuses_another_mesh():
    start = random_triangulation(np.random.default_rng(5).random((20, 2)), 5)
    t, i = np.argwhere(start.neighbors < 0)[0]
    for wrong in ([3 * start.size], [-1], [3 * t + i], [[0]], [0.5]):
        with pytest.raises(InputError, match="swaps"):
            replay(start, wrong)


# --- regions that are not convex, and constraints --------------------------------------------------


@given(st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_holes_and_bays(seed):
    """Any part of a triangulation keeps its outline; afterwards every inner edge is legal."""
    rng = np.random.default_rng(seed)
    start = random_triangulation(rng.integers(0, 20, (40, 2)), seed)
    part = start.select(rng.random(start.size) < 0.7)
    result = swap_diagonals(part)
    same_region(part, result)
    assert not illegal_edges(result)


@given(st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_constrained_edges_stay(seed):
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 30, (30, 2))
    start = random_triangulation(points, seed)
    kept = start.edges[rng.random(len(start.edges)) < 0.2]
    mesh = Mesh(
        start.points, start.simplices, markers={"segments": kept[:, ::-1]}, duplicates=start.duplicates
    )
    result = swap_diagonals(mesh, constrained="segments")
    segments = {frozenset(e) for e in kept.tolist()}
    assert segments <= edge_set(result.simplices)
    assert illegal_edges(result) <= segments
    same_region(mesh, result)
    assert (result.markers["segments"] == kept[:, ::-1]).all()
    exact, flips = lawson(points.tolist(), start.simplices.tolist(), [tuple(e) for e in kept.tolist()])
    assert segments <= edge_set(sorted(exact)) and not {frozenset(old) for old, _ in flips} & segments
    free = swap_diagonals(Mesh(start.points, start.simplices))
    assert not illegal_edges(free)


def test_constrained_delaunay_is_unique_without_ties():
    """Two different starts with the same segments end at the same triangles."""
    points = np.random.default_rng(8).random((60, 2))
    segment = np.array([[int(points[:, 0].argmin()), int(points[:, 0].argmax())]])
    ends = []
    for seed in range(200):
        start = random_triangulation(points, seed)
        if frozenset(segment[0].tolist()) in edge_set(start.simplices):
            ends.append(cells(swap_diagonals(Mesh(points, start.simplices, markers={"s": segment}))))
    if len(ends) < 2:  # bring the edge in by hand: a fan start in two halves
        segment = sweep_triangulation(points).edges[40:41]
        for seed in range(200):
            start = random_triangulation(points, seed, swaps=60)
            if frozenset(segment[0].tolist()) in edge_set(start.simplices):
                ends.append(cells(swap_diagonals(Mesh(points, start.simplices, markers={"s": segment}))))
    assert len(ends) >= 2 and all(e == ends[0] for e in ends)


def test_values_of_cells_stay_in_their_region():
    points = np.random.default_rng(2).random((200, 2))
    start = random_triangulation(points, 2)
    center = start.points[start.simplices].mean(axis=1)
    lake, land = 3, 7
    region = np.where(center[:, 0] + center[:, 1] < 1, lake, land)
    mesh = Mesh(points, start.simplices, markers={"region": region}, regions={"lake": lake, "land": land})
    result = swap_diagonals(mesh)
    for number in (lake, land):
        before, after = (m.simplices[m.markers["region"] == number] for m in (mesh, result))
        assert double_area(points, before) == double_area(points, after)
    assert not illegal_edges(result.select(result.markers["region"] == lake))
    assert illegal_edges(result)  # the interface holds some illegal edges
    assert "region" not in swap_diagonals(mesh, constrained=()).markers


def test_marked_triangles_and_vertices_stay():
    points = np.random.default_rng(3).random((100, 2))
    start = random_triangulation(points, 3)
    mesh = Mesh(points, start.simplices, markers={"keep": start.simplices[:5], "corner": [[4], [7]]})
    result = swap_diagonals(mesh)
    assert {triangle(*t) for t in start.simplices[:5].tolist()} <= cells(result)
    assert (result.markers["corner"] == [[4], [7]]).all() and (
        result.markers["keep"] == start.simplices[:5]
    ).all()


def test_origin_and_duplicates_are_kept():
    points = np.array([(0, 0), (2, 0), (2, 1), (0, 1), (0, 0)], dtype=float)
    mesh = Mesh(points, [(0, 1, 2), (0, 2, 3)], origin=[7, 8, 9, -1, 3], duplicates=[(4, 0)])
    result = swap_diagonals(mesh)
    assert (result.origin == mesh.origin).all() and (result.duplicates == mesh.duplicates).all()


def test_running_region_with_its_boundary_kept():
    boundary, segments = running_region(0.3)
    assert len(segments) == len(boundary)
    start = sweep_triangulation(boundary)
    there = edge_set(start.simplices)
    present = np.array([s for s in segments.tolist() if frozenset(s) in there])
    mesh = Mesh(boundary, start.simplices, markers={"shore": present})
    result = swap_diagonals(mesh)
    assert {frozenset(s) for s in present.tolist()} <= edge_set(result.simplices)


# --- bad input -------------------------------------------------------------------------------------

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        (lambda: Mesh(SQUARE, [(0, 1, 2), (0, 3, 2)]), r"simplices\[1\]"),
        (lambda: Mesh(SQUARE, [(0, 2, 1)]), r"simplices\[0\]"),
        (lambda: Mesh(np.array([(0, 0), (1, 1), (2, 2.0)]), [(0, 1, 2)]), r"simplices\[0\]"),
        (lambda: Mesh(np.array([(0, 0), (1, 0), (0, 1), (0.2, 0.9)]), [(0, 1, 2), (0, 1, 3)]), "overlaps"),
        (lambda: Mesh(np.eye(3), [(0, 1, 2)]), "plane"),
        (lambda: None, "not None"),
        (lambda: Mesh(np.vstack([np.zeros(3), np.eye(3)]), [(0, 1, 2, 3)]), "plane"),
        (lambda: Mesh(SQUARE, cells={"quad": [(0, 1, 2, 3)]}), "plane"),
        (lambda: Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], markers={"s": [(1, 3)]}), r"\[1, 3\] is not an edge"),
    ],
)
def test_bad_meshes(mesh, words):
    with pytest.raises(MeshError, match=words):
        swap_diagonals(mesh())


def test_three_triangles_on_an_edge():
    points = np.array([(0, 0), (1, 0), (0, 1), (1, 1), (0.4, -1)])
    with pytest.raises(UnstructError, match="shared"):
        swap_diagonals(Mesh(points, [(0, 1, 2), (0, 1, 3), (1, 0, 4)]))


def test_unknown_marker():
    with pytest.raises(InputError, match="'shore'"):
        swap_diagonals(Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)]), constrained="shore")


def test_no_triangles():
    result, swaps = swap_diagonals(Mesh(SQUARE, np.empty((0, 3), dtype=int)), history=True)
    assert result.size == 0 and len(swaps) == 0


@pytest.mark.parametrize(
    ("points", "dimension"), [([(0, 0), (1, 1), (2, 2)], 1), ([(1, 1)] * 4, 0), ([(0, 0)], 0)]
)
def test_sweep_names_the_dimension(points, dimension):
    with pytest.raises(DegenerateInputError) as caught:
        sweep_triangulation(points)
    assert caught.value.dimension == dimension


def test_input_is_untouched_and_the_answer_repeats():
    start = random_triangulation(np.random.default_rng(4).random((50, 2)), 4)
    T, N = start.simplices.copy(), start.neighbors.copy()
    first, second = swap_diagonals(start), swap_diagonals(start, progress=True)
    assert (start.simplices == T).all() and (start.neighbors == N).all()
    assert (first.simplices == second.simplices).all()


def test_plain_python_does_the_same():
    """With numba switched off the same code gives the same swaps."""
    program = (
        "import numpy as np; from unstruct.examples import random_triangulation as r;"
        "from unstruct.connect.swapping import swap_diagonals as s;"
        "print(s(r(np.random.default_rng(4).random((50, 2)), 4), history=True)[1].tolist())"
    )
    answers = [
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "NUMBA_DISABLE_JIT": switch},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for switch in ("0", "1")
    ]
    assert answers[0] == answers[1] and len(answers[0]) > 50


def test_marked_edges_are_looked_up_without_sorting_the_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    """With all edges in one search, two million triangles took 16 seconds before the first swap."""
    mesh = delaunay(np.random.default_rng(5).random((2000, 2)))
    sizes: list[int] = []
    search = np.searchsorted
    monkeypatch.setattr(np, "searchsorted", lambda a, v: sizes.append(len(v)) or search(a, v))
    monkeypatch.setattr(np, "isin", None)  # it sorts, or hashes, both sides
    marked = Mesh(mesh.points, mesh.simplices, markers={"rim": mesh.boundary, "none": np.empty((0, 2), int)})
    _, locked = constraints(marked, None)
    assert (locked == (mesh.neighbors < 0)).all() and max(sizes) < mesh.size / 10
