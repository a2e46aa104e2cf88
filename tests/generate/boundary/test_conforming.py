"""Boundary recovery: midpoints against the definition, fans that never end, shells."""

from fractions import Fraction
from itertools import combinations, islice, pairwise
from math import atan2, cos, pi, sin

import numpy as np
import pytest
from fans import TEN, fan_domain, random_polygon
from fuzz_work import conforming, guarded
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from regions import KINDS

from unstruct.assess.check import check
from unstruct.base.errors import InputError, MeshError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.connect.swapping import swap_diagonals
from unstruct.domain.domain import Domain
from unstruct.examples.running import flip_at_random, running_region
from unstruct.generate.boundary.conforming import conforming_delaunay
from unstruct.generate.boundary.constrained import constrained_delaunay
from unstruct.generate.boundary.fans import never_ends
from unstruct.geometry.curves import Arc
from unstruct.mesh.mesh import Mesh
from unstruct.plain import bowyer_watson as bw
from unstruct.plain import conforming as plain
from unstruct.plain.predicates import in_sphere, orient

TWELVE = [(100, 0), (61, 35), (50, 87), (0, 70), (-50, 87), (-61, 35), (-100, 0), (-61, -35), (-50, -87),
          (0, -70), (50, -87), (61, -35)]  # fmt: skip
SIX = [(3, 2), (4, 3), (-4, 3), (-2, 1), (-1, -3), (-1, -4)]
FANS = {"ten": TEN, "twelve": TWELVE, "six": SIX}


def equal_fan(n, ratio):
    return [
        (r * cos(2 * pi * i / n), r * sin(2 * pi * i / n)) for i in range(n) for r in [ratio if i % 2 else 1]
    ]


def plain_result(domain, test=plain.missing, limit=60):
    points, segments = domain.points.tolist(), [tuple(s) for s in domain.pieces.tolist()]
    history = list(islice(plain.rounds(points, segments, test), limit))
    assert len(history) < limit
    return history[-1]


def vertices(mesh):
    return {tuple(p) for p in mesh.points.tolist()}


def conforms(mesh, domain):
    """Complete, valid, and every subsegment an edge of a Delaunay triangulation of all vertices."""
    assert mesh.complete and len(mesh.missing) == 0
    assert check(mesh, domain=domain, delaunay="constrained")
    for name in ("facets", "inner"):
        edges = {frozenset(e) for e in mesh.edges.tolist()}
        assert {frozenset(e) for e in mesh.markers[name].tolist()} <= edges
    free = Mesh(mesh.points, mesh.simplices)
    assert len(swap_diagonals(free, history=True)[1]) == 0  # Delaunay across the inner segments, too


# --- the plain version ------------------------------------------------------------------------------


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=4, max_size=9, unique=True))
@settings(max_examples=60, deadline=None)
def test_missing_is_missing_from_every_delaunay_triangulation(points):
    assume(any(orient([points[0], p, q]) for p, q in combinations(points[1:], 2)))
    cells = bw.triangulate(points)
    edges = {frozenset(e) for t in cells for e in combinations(t, 2)}
    for i, j in combinations(range(len(points)), 2):
        u, v = points[i], points[j]
        if frozenset((i, j)) in edges:
            assert not plain.missing(points, u, v)
        else:  # absent: then missing, unless it is a chord of an empty circle
            around = [t for t in cells if i in t]
            tie = any(in_sphere([points[w] for w in t], v) == 0 for t in around)
            assert plain.missing(points, u, v) != tie
        if plain.missing(points, u, v):
            assert plain.encroached(points, u, v) or any(orient([u, v, p]) == 0 for p in points)


@pytest.mark.parametrize("test", ["missing", "gabriel"])
@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_the_same_points_as_the_plain_rounds(test, seed):
    """The order does not matter, nor which missing segment is looked at: one closure."""
    domain = Domain.polygon(random_polygon(np.random.default_rng(seed), 8, 60))
    mesh = conforming_delaunay(domain, test=test, shells=False, budget=300)
    assume(test == "missing" or mesh.complete)  # with diametral circles sharp corners may never end
    conforms(mesh, domain)
    points, _, bad = plain_result(domain, plain.encroached if test == "gabriel" else plain.missing)
    assert not bad and vertices(mesh) == set(map(tuple, points))
    assert mesh.added.sum() == mesh.counts["splits"] == len(points) - len(domain.points)


@given(st.integers(0, 10**6), st.integers(2, 6))
@settings(max_examples=12, deadline=None)
def test_random_inner_segments(seed, count):
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(1, 40, (2 * count, 2)), axis=0).astype(float)
    points = rng.permutation(points)
    inner, used = [], []
    for i, j in combinations(range(len(points)), 2):
        a, b = points[i], points[j]
        clear = all(orient([a, b, p]) != 0 for k, p in enumerate(points) if k not in (i, j))
        for c, d in used:
            free = len({tuple(a), tuple(b), tuple(c), tuple(d)}) == 4
            clear &= (
                not free
                or orient([a, b, c]) * orient([a, b, d]) > 0
                or orient([c, d, a]) * orient([c, d, b]) > 0
            )
        if clear and rng.random() < 0.7:
            used.append((a, b))
            inner.append((i + 4, j + 4))
    assume(inner)
    box = [(-30, -30), (70, -30), (70, 70), (-30, 70)]
    domain = Domain(np.vstack([box, points]), [(0, 1), (1, 2), (2, 3), (3, 0)], inner=inner)
    for shells in (True, "auto"):
        for test in ("missing", "gabriel"):
            conforms(conforming_delaunay(domain, test=test, shells=shells), domain)


def test_the_two_hundred_and_fifty_polygons():
    """Two segments at a vertex: midpoints end (proved); here in at most 20 rounds."""
    rng, worst, most = np.random.default_rng(14), 0, 0
    for _ in range(250):
        domain = Domain.polygon(random_polygon(rng, int(rng.integers(5, 14))))
        mesh = conforming_delaunay(domain, shells=False)
        conforms(mesh, domain)
        worst, most = max(worst, mesh.counts["rounds"]), max(most, mesh.counts["splits"])
    assert worst <= 20 and most >= 10


@pytest.mark.parametrize("degrees", [1e-6, 0.01, 1.0, 10.0, 29.9])
def test_wedges(degrees):
    """Two sides at a tiny angle, and the third point close to one of them."""
    tan = np.tan(np.radians(degrees))
    domain = Domain.polygon([(0, 0), (1, 0), (0.7, 0.7 * tan)])
    mesh = conforming_delaunay(domain, shells=False)
    conforms(mesh, domain)
    if degrees >= 1:  # of discs as thin as the wedge it takes very many
        conforms(conforming_delaunay(domain, test="gabriel"), domain)
    dart = [(0.0, 0.0), (1.0, 0.0), (0.9, 0.5 * tan), (0.7, 0.7 * tan)]
    conforms(conforming_delaunay(Domain.polygon(dart)), Domain.polygon(dart))


# --- where midpoints never end ----------------------------------------------------------------------


@pytest.mark.parametrize("name", FANS)
def test_the_spokes(name):
    spokes = FANS[name]
    states = plain.fan(spokes)
    assert plain.period(states) and never_ends((0, 0), spokes)
    domain = fan_domain(spokes)
    midpoints = conforming_delaunay(domain, shells=False, budget=300)
    assert not midpoints.complete and midpoints.endless.tolist() == [0]
    assert len(midpoints.missing) and len(midpoints.unrefined) and check(midpoints, delaunay="constrained")
    assert all("beside it was not split" in reason for reason in midpoints.reasons)
    assert midpoints.counts["rounds"] > 25
    for shells in ("auto", True):
        mesh = conforming_delaunay(domain, shells=shells)
        conforms(mesh, domain)
        assert 0 in mesh.apices and mesh.counts["splits"] < 4 * len(spokes)
        assert mesh.endless.tolist() == [0] and mesh.added.sum() == mesh.counts["splits"]
    conforms(conforming_delaunay(domain, test="gabriel"), domain)


@pytest.mark.parametrize("name", ["ten", "twelve"])
def test_the_run_follows_the_forced_states(name):
    """Ten rounds of the plain process: the parts next to the center are halved at least as the fan says."""
    spokes = FANS[name]
    domain = fan_domain(spokes)
    process = plain.rounds(domain.points.tolist(), [tuple(s) for s in domain.pieces.tolist()])
    for _ in range(7):
        points, segments, bad = next(process)
        assert bad
    near = {v for s in segments if 0 in s for v in s} - {0}
    first, second = (min(abs(points[v][0]) + abs(points[v][1]) for v in near) for near in (near, {1}))
    assert first <= second / 8


@pytest.mark.parametrize("n", [6, 8, 10, 12, 14])
def test_two_lengths_at_equal_angles(n):
    """Such a fan never ends exactly if max(r, 1 / 2r) < cos(360 / n), r in (1/2, 1]: from ten spokes on."""
    looping = 0
    for ratio in np.linspace(0.51, 1.0, 25):
        limit = max(ratio, 1 / (2 * ratio)) - cos(2 * pi / n)
        if abs(limit) > 1e-9:
            spokes = equal_fan(n, ratio)
            assert never_ends((0, 0), spokes) == bool(plain.period(plain.fan(spokes))) == (limit < 0)
            looping += limit < 0
    assert (looping > 0) == (n >= 10)


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=2, max_size=9, unique=True))
@settings(max_examples=80, deadline=None)
def test_fans_are_judged_alike(spokes):
    directions = {(Fraction(x, abs(x) + abs(y)), Fraction(y, abs(x) + abs(y))) for x, y in spokes if x or y}
    assume((0, 0) not in spokes and len(directions) == len(spokes))
    states = plain.fan(spokes, limit=60)
    fast = never_ends((0, 0), spokes)
    if plain.period(states):
        assert fast
    if len(states) < 60 and not plain.period(states):
        assert not fast
    turns = sorted(atan2(y, x) for x, y in spokes)
    gaps = [b - a for a, b in pairwise(turns)] + [turns[0] + 2 * pi - turns[-1]]
    if max(gaps) > pi - 1e-9:
        assert not fast  # a gap of 180 degrees: proved to end


@given(st.lists(st.tuples(st.integers(-60, 60), st.integers(-60, 60)), min_size=3, max_size=5, unique=True))
@settings(max_examples=150, deadline=None)
def test_five_spokes_always_end(spokes):
    """Proved in the book: six are needed. Narrow pairs are tried, too."""
    narrow = [(8 * x + 1, 8 * y) for x, y in spokes[:2]]
    for some in (spokes, [*spokes[:3], *narrow]):
        directions = {(Fraction(x, abs(x) + abs(y)), Fraction(y, abs(x) + abs(y))) for x, y in some if x or y}
        if len(directions) == len(some):
            states = plain.fan(some)
            assert not never_ends((0, 0), some) and not plain.period(states) and len(states) < 1000


def test_a_part_of_a_fan_may_loop():
    assert all(never_ends((0, 0), [*TEN, extra]) for extra in [(1, 900), (950, 310), (-1, 1000)])


def test_two_spokes_and_diametral_circles():
    """With diametral circles two segments are enough: lengths 1 and 0.7 below 45 degrees, 0.7 < cos."""
    assert never_ends((0, 0), [(10, 0), (6.5, 2.6)], encroached=True)
    assert not never_ends((0, 0), [(10, 0), (6.5, 2.6)])
    assert not never_ends((0, 0), [(10, 0), (4.9, 5.0)], encroached=True)
    domain = Domain.polygon([(0, 0), (10, 0), (6.5, 2.6)])
    assert not conforming_delaunay(domain, test="gabriel", shells=False, budget=200).complete
    conforms(conforming_delaunay(domain, test="gabriel"), domain)
    conforms(conforming_delaunay(domain), domain)


def test_shells_lie_on_powers_of_two():
    mesh = conforming_delaunay(fan_domain(TEN), shells=True)
    new = mesh.points[mesh.origin < 0]
    radius = np.log2(np.hypot(*new.T))
    near = np.abs(radius - np.round(radius)) < 1e-9
    assert near.sum() >= 10 and len(new) == mesh.counts["splits"]
    assert plain.shell_point((0, 0), (1000, 0)) == (512.0, 0.0)
    assert plain.shell_point((0, 0), (3, 0)) == (2.0, 0.0) and plain.shell_point((1, 1), (1, 2)) == (1, 1.5)


# --- curves, budgets, bad input -----------------------------------------------------------------------


def test_curves_are_split_on_the_curve():
    half = Arc((0.0, 0.0), 1.0, 0.0, pi)
    domain = Domain(
        [(1, 0), (-1, 0), (0.0, 0.5), (0.1, 0.99)], [(0, 1), (1, 0)], curves={0: half}, inner=[(2, 3)]
    )
    for test in ("missing", "gabriel"):
        mesh = conforming_delaunay(domain, test=test)
        assert mesh.complete and check(mesh, delaunay="constrained")
        on = np.unique(mesh.segments[mesh.piece == 0])
        np.testing.assert_allclose(np.hypot(*mesh.points[on].T), 1.0, rtol=1e-12)
    assert mesh.added[0] > 0


def test_shells_on_arcs():
    """Two arcs that leave a vertex at a small angle, both cut at the same distances."""
    domain = Domain([(0, 0), (1, 0), (0.8, 0.02)], [(0, 1), (1, 2), (2, 0)],
                    curves={0: Arc((0.5, 2.0), float(np.hypot(0.5, 2)), float(np.arctan2(-2, -0.5)),
                                   float(2 * np.arctan2(0.5, 2)))})  # fmt: skip
    mesh = conforming_delaunay(domain, test="gabriel", shells=True)
    assert mesh.complete and check(mesh, delaunay="constrained") and 0 in mesh.apices


@pytest.mark.parametrize("spacing", [0.4, 0.3, 0.2, 0.15, 0.1])
def test_the_lake(spacing):
    domain = Domain(*running_region(spacing))
    for test in ("missing", "gabriel"):
        conforms(conforming_delaunay(domain, test=test), domain)
    points, _, bad = plain_result(domain) if spacing > 0.35 else (None, None, None)
    assert points is None or (not bad and vertices(conforming_delaunay(domain)) == set(map(tuple, points)))


@pytest.mark.parametrize("kind", KINDS)
def test_nasty_regions(kind):
    """Whatever comes out is valid, Delaunay where it says complete, and says why where not."""
    for seed in range(6):
        rng = np.random.default_rng([77, seed])
        domain = KINDS[kind](rng)
        for work in (conforming, guarded):
            outcome, _, fault, _ = work(domain, rng)
            assert not fault, f"{outcome}: {fault}"


def test_a_budget_is_kept_and_told():
    domain = fan_domain(TEN)
    mesh = conforming_delaunay(domain, shells=True, budget=5)
    assert mesh.counts["splits"] == 5 and not mesh.complete
    assert set(mesh.why.tolist()) == {"the budget of 5 points is spent"}
    assert check(mesh, delaunay="constrained")
    for budget in (0, 1):
        assert conforming_delaunay(domain, budget=budget).counts["splits"] == budget


def test_ties_count_as_present():
    """The diagonals of a lattice's squares: each is in some Delaunay triangulation, so nothing is split."""
    points = [(x, y) for y in range(4) for x in range(4)]
    ring = [0, 1, 2, 3, 7, 11, 15, 14, 13, 12, 8, 4]
    inner = [(0, 5), (5, 10), (10, 15), (6, 11), (2, 5)]
    domain = Domain(np.array(points, float), [(a, b) for a, b in zip(ring, [*ring[1:], 0])], inner=inner)
    mesh = conforming_delaunay(domain)
    conforms(mesh, domain)
    assert mesh.counts["splits"] == 0 and len(mesh.markers["inner"]) == len(inner)


def test_nearly_touching_pieces():
    """A vertex a few units in the last place from a side: told, or conforming; never an invalid mesh."""
    for gap in (2.0**-30, 2.0**-44, 2.0**-52):
        points = [(0, 0), (1, 0), (1, 1), (0, 1), (0.3, gap), (0.7, 0.5)]
        domain = Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0)], inner=[(4, 5)])
        mesh = conforming_delaunay(domain)
        assert check(mesh, delaunay="constrained") and mesh.complete == (len(mesh.missing) == 0)
        assert mesh.complete or all(mesh.why)


def test_bad_input():
    domain = Domain.rectangle()
    with pytest.raises(InputError, match="test"):
        conforming_delaunay(domain, test="other")
    with pytest.raises(InputError, match="budget"):
        conforming_delaunay(domain, budget=-1)
    with pytest.raises(InputError, match=r"budget = 1\.5 must be a whole number"):
        conforming_delaunay(domain, budget=1.5)
    with pytest.raises(InputError, match="shells = 'some' must be"):
        conforming_delaunay(domain, shells="some")
    with pytest.raises(InputError, match="domain must be a Domain, not list"):
        conforming_delaunay([(0, 0), (1, 0), (0, 1)])


# --- diagonal swapping on constrained triangulations ---------------------------------------------------


@given(st.integers(0, 10**6))
@settings(max_examples=20, deadline=None)
def test_a_constrained_delaunay_mesh_has_nothing_to_swap(seed):
    rng = np.random.default_rng(seed)
    domain = Domain.polygon(random_polygon(rng, 14))
    mesh = constrained_delaunay(domain)
    assert len(swap_diagonals(mesh, history=True)[1]) == 0
    shaken = Mesh(
        mesh.points, flip_at_random(mesh, 200, seed).simplices, markers={"facets": mesh.markers["facets"]}
    )
    after = swap_diagonals(shaken)
    marked = {frozenset(e) for e in mesh.markers["facets"].tolist()}
    assert marked <= {frozenset(e) for e in after.edges.tolist()}
    assert check(after, delaunay="constrained")


@pytest.mark.parametrize("name", FANS)
def test_swaps_leave_inner_segments_alone(name):
    """The spokes as constraints: nothing to swap; without the marks some of them go; with them, none."""
    mesh = constrained_delaunay(fan_domain(FANS[name]))
    assert len(swap_diagonals(mesh, history=True)[1]) == 0
    spokes = {frozenset(e) for e in mesh.markers["inner"].tolist()}
    free = swap_diagonals(Mesh(mesh.points, mesh.simplices))
    assert not spokes <= {frozenset(e) for e in free.edges.tolist()}
    kept = swap_diagonals(Mesh(mesh.points, mesh.simplices, markers={"wall": mesh.markers["inner"]}))
    assert spokes <= {frozenset(e) for e in kept.edges.tolist()}
    with pytest.raises(MeshError, match="is not an edge of the mesh"):
        swap_diagonals(Mesh(free.points, free.simplices, markers={"wall": mesh.markers["inner"]}))


def test_delaunay_of_the_vertices_shows_the_boundary():
    """Beyond the domain's own triangles: the plain Delaunay triangulation of all vertices has the edges."""
    domain = Domain(*running_region(0.3))
    mesh = conforming_delaunay(domain)
    edges = {frozenset(e) for e in delaunay(mesh.points).edges.tolist()}
    assert {frozenset(e) for e in mesh.segments.tolist()} <= edges
    before = {frozenset(e) for e in delaunay(domain.points).edges.tolist()}
    assert not {frozenset(e) for e in domain.facets.tolist()} <= before


@pytest.mark.parametrize("degrees", [60, 90, 150])
def test_many_small_angles_get_shells_by_default(degrees):
    """Forty spokes of unequal lengths within 90 degrees took 4,871 vertices with midpoints."""
    rng = np.random.default_rng(0)
    turn, length = np.radians(np.linspace(0, degrees, 40)), 1 - 0.6 * rng.random(40)
    tips = length[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.concatenate([[[-2, -2], [2, -2], [2, 2], [-2, 2], [0, 0]], tips])
    domain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=[[4, 5 + i] for i in range(40)])
    mesh = conforming_delaunay(domain)
    conforms(mesh, domain)
    assert len(mesh.points) == len(conforming_delaunay(domain, shells=True).points)
    assert len(mesh.points) <= {60: 900, 90: 600, 150: 400}[degrees]
