"""Regions: validation that names culprits, repairs, inside and outside, sampling. Oracles in fractions."""

from __future__ import annotations

import warnings
from fractions import Fraction
from itertools import combinations, pairwise
from unittest import mock

import numpy as np
import pytest
from fixtures import HARD_2D
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region

from unstruct import (
    Arc,
    Curve,
    Domain,
    InputError,
    UnstructError,
    circumcenter_insertion,
    refine,
    voronoi_segment,
)
from unstruct.geometry.segment_pairs import meetings
from unstruct.geometry.sweep import any_meeting
from unstruct.mesh.embedding import crossing_facets
from unstruct.predicates.batch import orient

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]
RING = [[0, 1], [1, 2], [2, 3], [3, 0]]

# ---------------------------------------------------------------------- the oracle


def exact(x) -> tuple[Fraction, Fraction]:
    return Fraction(float(x[0])), Fraction(float(x[1]))


def side(a, b, c) -> int:
    d = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (d > 0) - (d < 0)


def on_segment(p, a, b) -> bool:
    return (
        side(a, b, p) == 0
        and min(a[0], b[0]) <= p[0] <= max(a[0], b[0])
        and min(a[1], b[1]) <= p[1] <= max(a[1], b[1])
    )


def oracle_meet(points, s, t) -> bool:
    """Whether two segments meet in more than a common end."""
    p, q, a, b = (exact(points[v]) for v in (*s, *t))
    shared = set(s) & set(t)
    if len(shared) == 2:
        return True
    if len(shared) == 1:
        (v,) = shared
        one, two = (exact(points[next(w for w in r if w != v)]) for r in (s, t))
        return on_segment(one, a, b) or on_segment(two, p, q)
    if side(p, q, a) * side(p, q, b) < 0 and side(a, b, p) * side(a, b, q) < 0:
        return True
    return on_segment(p, a, b) or on_segment(q, a, b) or on_segment(a, p, q) or on_segment(b, p, q)


def oracle_inside(points, facets, x) -> bool | None:
    """Even-odd with fractions; None on a facet."""
    x, odd = exact(x), False
    for a, b in ((exact(points[v]) for v in row) for row in facets):
        if on_segment(x, a, b):
            return None
        if (a[1] <= x[1]) != (b[1] <= x[1]):
            odd ^= (side(a, b, x) > 0) == (b[1] > a[1])
    return odd


def oracle_area(points, facets) -> Fraction:
    """By slabs between all heights at which facets end or cross: trapezoids between odd and even."""
    rows = [tuple(sorted((exact(points[v]) for v in row), key=lambda p: p[1])) for row in facets]
    heights = {p[1] for row in rows for p in row}
    for (a, b), (c, d) in combinations(rows, 2):
        ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], d[0] - c[0], d[1] - c[1]
        if (cross := ux * vy - uy * vx) != 0:
            heights.add(a[1] + uy * ((c[0] - a[0]) * vy - (c[1] - a[1]) * vx) / cross)
    heights = sorted(heights)
    total = Fraction(0)
    for low, high in pairwise(heights):
        at = []
        for a, b in rows:
            if a[1] <= low and high <= b[1] and a[1] < b[1]:
                xs = [a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) for y in (low, high)]
                at.append((sum(xs), xs))
        at.sort()
        width = sum(two[0] - one[0] for one, two in zip(at[::2], at[1::2]))
        total += Fraction(width) / 2 * (high - low)
    return total


# ---------------------------------------------------------------------- faults

FAULTS = {
    "crossing": (([[0, 0], [1, 1], [1, 0], [0, 1]], RING), r"facet 0 .*facet 2 .*cross at \(0\.5, 0\.5\)"),
    "overlap": (
        ([[0, 0], [2, 0], [1, 0], [3, 0], [1, 2], [2, 2]], [[0, 1], [1, 4], [4, 0], [2, 3], [3, 5], [5, 2]]),
        r"facet 0 .*facet 3 .*overlap",
    ),
    "zero length": ((SQUARE, [*RING, [2, 2]]), r"facet 4 = \[2, 2\] has zero length"),
    "vertex on a segment": (([*SQUARE, [2, 0]], RING), r"point 4 lies on facet 0 .*\(2, 0\)"),
    "duplicate points": (([*SQUARE, [4, 4]], RING), r"points 2 and 4 are equal"),
    "negative zero": (([*SQUARE, [-0.0, 0.0]], RING), r"points 0 and 4 are equal"),
    "index out of range": ((SQUARE, [*RING, [0, 7]]), r"facet 4 = \[0, 7\] .*outside 0\.\.3"),
    "negative index": ((SQUARE, [*RING, [0, -1]]), r"facet 4 = \[0, -1\]"),
    "open boundary": ((SQUARE, RING[:3]), r"open: 1 facet ends at point 0"),
    "odd vertex": ((SQUARE, [*RING, [0, 2]]), r"open: 3 facets meet at point 0"),
    "repeated segment": ((SQUARE, [*RING, [1, 0]]), r"facet 0 and facet 4 join the same points"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_named_and_mended(name: str) -> None:
    (points, facets), message = FAULTS[name]
    with pytest.raises(InputError, match=message) as error:
        Domain(points, facets)
    assert "resolve=True" in str(error.value)
    mended = Domain(points, facets, resolve=True)
    assert mended.repairs and all(str(r) and r.kind for r in mended.repairs)
    again = Domain(mended.points, mended.facets, inner=mended.inner)
    assert again.area == mended.area and not again.repairs


def test_repairs_give_an_account() -> None:
    bow = Domain(*FAULTS["crossing"][0], resolve=True, markers={"first": [0]})
    assert [r.kind for r in bow.repairs] == ["crossing"]
    assert bow.repairs[0].pieces == (0, 2) and bow.repairs[0].place == (0.5, 0.5)
    assert bow.origin.tolist() == [0, 1, 2, 3, -1] and bow.points[4].tolist() == [0.5, 0.5]
    assert sorted(bow.piece_origin.tolist()) == [0, 0, 1, 2, 2, 3]
    assert (bow.piece_origin[bow.markers["first"]] == 0).all() and len(bow.markers["first"]) == 2
    assert bow.area == 0.5


def test_an_open_boundary_is_closed_or_becomes_inner() -> None:
    gap = Domain(SQUARE, RING[:3], resolve=True)
    assert gap.area == 16 and gap.piece_origin.tolist() == [0, 1, 2, -1]
    wall = Domain(SQUARE, [*RING, [0, 2]], resolve=True)
    assert wall.area == 16 and wall.inner.tolist() == [[0, 2]] and wall.piece_origin[-1] == 4
    slit = Domain([*SQUARE, [1, 1], [2, 1]], [*RING, [0, 4], [4, 5]], resolve=True)
    assert slit.area == 16 and sorted(map(sorted, slit.inner.tolist())) == [[0, 4], [4, 5]]
    alone = Domain([*SQUARE, [1, 1], [3, 1]], [*RING, [4, 5]], resolve=True)  # one segment is no gap
    assert alone.inner.tolist() == [[4, 5]]
    assert all(r.kind == "open boundary" for d in (gap, wall, slit, alone) for r in d.repairs)


def test_equal_facets_cancel_two_by_two() -> None:
    rows = [*RING, [0, 1], [1, 0]]
    assert Domain(SQUARE, rows, resolve=True).area == 16  # three times: once
    joined = [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]]
    twice = [[0, 1], [1, 4], [4, 5], [5, 0], [1, 2], [2, 3], [3, 4], [4, 1]]  # the wall of two squares goes
    mended = Domain(joined, twice, resolve=True)
    assert mended.area == 2 and len(mended.facets) == 6
    walled = Domain(joined, twice, inner=[[1, 4]], resolve=True)
    assert walled.area == 2 and len(walled.inner) == 1


def test_inner_pieces_are_validated_too() -> None:
    with pytest.raises(InputError, match=r"facet 1 .*inner segment 0 .*cross"):
        Domain([*SQUARE, [2, 2], [6, 2]], RING, inner=[[4, 5]])
    with pytest.raises(InputError, match=r"facet 0 and inner segment 0 join the same points"):
        Domain(SQUARE, RING, inner=[[0, 1]])
    free = Domain([*SQUARE, [1, 1], [2, 2], [3, 1]], RING, inner=[[4, 5]])
    assert free.loose.tolist() == [6] and free.name(4) == "inner segment 0" and free.area == 16


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_meetings_agree_with_fractions(data: st.DataObject) -> None:
    side_length = data.draw(st.integers(2, 12))
    grid = st.tuples(st.integers(0, side_length), st.integers(0, side_length))
    different = data.draw(st.booleans())  # equal points are different vertices, and segments there meet
    drawn = data.draw(st.lists(grid, min_size=3, max_size=14, unique=different))
    pair = st.tuples(st.integers(0, len(drawn) - 1), st.integers(0, len(drawn) - 1))
    long = pair.filter(lambda r: r[0] < r[1] and drawn[r[0]] != drawn[r[1]])
    rows = data.draw(st.lists(long, max_size=14, unique=True)) if len(set(drawn)) > 1 else []
    points = np.array(drawn, dtype=float)
    points = points * data.draw(st.sampled_from([1.0, 1e-300, 2.0**600, 0.1]))
    segments = np.array(rows, dtype=int).reshape(-1, 2)
    tables = data.draw(st.sampled_from([((0.5, 1000),), ((4.0, 1000),), ((0.5, 0), (4.0, 2)), ()]))
    tables = tuple((*table, np.inf) for table in tables)
    with mock.patch("unstruct.geometry.segment_pairs.TABLES", tables):
        found = set(map(tuple, meetings(points, segments)[0].tolist()))
    wanted = {(i, j) for i, j in combinations(range(len(rows)), 2) if oracle_meet(points, rows[i], rows[j])}
    assert found == wanted
    assert any_meeting(points, segments) == bool(wanted)
    alone = [i for i in range(len(rows)) if all((j, i) not in wanted for j in range(i))]
    clean = [i for i in alone if all((i, j) not in wanted for j in alone)]
    assert not any_meeting(points, segments[clean])


def hedgehog(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Spikes, all close together: a line cuts very many at once."""
    angle = 2 * np.pi * np.arange(n) / n
    radius = np.where(np.arange(n) % 2 == 0, 1.0, 0.6)
    points = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return points, np.column_stack([np.arange(n), np.roll(np.arange(n), -1)])


def test_a_sweep_over_many_segments_at_once() -> None:
    points, segments = hedgehog(20_000)
    assert any_meeting(points, segments) is False
    rng = np.random.default_rng(0)
    for _ in range(20):  # a short segment across a spike, or beside it
        k = 2 * int(rng.integers(10_000))
        tip, root = points[k], points[(k + 1) % len(points)]
        middle, across = (tip + root) / 2, 1e-6 * np.array([tip[1], -tip[0]])
        extra = np.concatenate([segments, [[len(points), len(points) + 1]]])
        crossing = np.concatenate([points, [middle + across, middle - across]])
        assert any_meeting(crossing, extra) is True
        beyond = np.concatenate([points, [1.001 * tip, 1.002 * tip]])
        assert any_meeting(beyond, extra) is False
    assert (
        any_meeting(np.array([[0, 0], [2.0**-1074, 1], [2.0**1000, 0]]), np.array([[0, 1], [1, 2]])) is None
    )
    wide = Domain([[0, 0], [2.0**-1074, 1], [2.0**1000, 0]], [[0, 1], [1, 2], [2, 0]])  # decided all the same
    assert wide.contains([[1.0, 0.5]])[0]


def test_meetings_use_grid_and_tree_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(4)
    points = rng.random((300, 2)) * [1, 10.0 ** rng.uniform(-6, 0)]
    segments = rng.integers(0, 300, size=(400, 2))
    segments = segments[segments[:, 0] != segments[:, 1]]
    segments = segments[np.unique(np.sort(segments, axis=1), axis=0, return_index=True)[1]]
    by_grid, kinds = meetings(points, segments)
    monkeypatch.setattr("unstruct.geometry.segment_pairs.TABLES", ())
    by_last, same = meetings(points, segments)
    assert np.array_equal(by_grid, by_last) and np.array_equal(kinds, same)
    monkeypatch.setattr("unstruct.geometry.segment_pairs.LAST_TABLE", (4.0, -1))
    by_tree, same = meetings(points, segments)
    assert np.array_equal(by_grid, by_tree) and np.array_equal(kinds, same)
    assert np.array_equal(by_grid, crossing_facets(points, segments))


@pytest.mark.parametrize("longest", [0.01, 0.05, 1.0])
def test_a_table_of_fine_cells_finds_what_the_tree_finds(
    longest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(5)
    start = rng.random((1500, 2)) * [1, 0.3]
    length = longest * rng.random((1500, 1)) ** 3
    angle = rng.uniform(0, 2 * np.pi, 1500)
    end = start + length * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([start, end])
    segments = np.column_stack([np.arange(1500), 1500 + np.arange(1500)])
    rows = np.concatenate([segments, np.column_stack([segments[:-1, 1], segments[1:, 0]])[::50]])
    by_table, kinds = meetings(points, rows)
    assert len(by_table) > 20
    monkeypatch.setattr("unstruct.geometry.segment_pairs.TABLES", ())
    monkeypatch.setattr("unstruct.geometry.segment_pairs.LAST_TABLE", (4.0, -1))
    by_tree, same = meetings(points, rows)
    assert np.array_equal(by_table, by_tree) and np.array_equal(kinds, same)


def test_curves_that_cross_at_a_place_where_both_are_sampled() -> None:
    """Two vertices at one place are no common vertex."""
    corners = [(-2, -2), (2, -2), (2, 2), (-2, 2), (-1, -1), (1, 1), (-1, 1), (1, -1)]
    curves = {
        4: Curve(lambda t: np.stack([t, t**3], axis=-1), -1.0, 1.0),
        5: Curve(lambda t: np.stack([t, -(t**3)], axis=-1), -1.0, 1.0),
    }
    with pytest.raises(InputError, match="inner segment 0 and inner segment 1 cross or touch near"):
        Domain(corners, [(0, 1), (1, 2), (2, 3), (3, 0)], inner=[(4, 5), (6, 7)], curves=curves)


def test_near_crossings_are_decided_exactly() -> None:
    tip = np.nextafter(0.5, 0)
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [0.25, 0.25], [0.75, 0.25], [0.5, 0.5]]
    wedge = [[4, 5], [5, 6], [6, 4]]
    near = Domain([*points, [0.25, 0.75], [0.75, 0.75], [0.5, np.nextafter(0.5, 1)]],
                  [*RING, *wedge, [7, 8], [8, 9], [9, 7]])  # fmt: skip
    assert near.area == 1 - 0.0625 - 0.0625
    with pytest.raises(InputError, match="cross"):
        Domain([*points, [0.25, 0.75], [0.75, 0.75], [0.5, tip]], [*RING, *wedge, [7, 8], [8, 9], [9, 7]])


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_resolve_keeps_the_even_odd_region(seed: int) -> None:
    """Random closed chains of integer points, with everything wrong: inside stays inside."""
    rng = np.random.default_rng(seed)
    side_length, n = int(rng.integers(2, 9)), int(rng.integers(3, 14))
    points = rng.integers(0, side_length + 1, size=(n, 2)).astype(float)
    order = rng.permutation(n)
    rows = np.column_stack([order, np.roll(order, 1)])
    try:
        domain = Domain(points, rows, inner=rng.integers(0, n, size=(2, 2)), resolve=True)
    except InputError as error:  # a domain without facets could not be meshed
        assert oracle_area(points, rows) == 0 and "no facet is left" in str(error)
        return
    assert abs(Fraction(domain.area) - oracle_area(points, rows)) <= Fraction(1, 2**45)
    x = rng.integers(-1, 4 * side_length + 4, size=(30, 2)) / 4 + [1 / 64, 3 / 128]
    wanted = [oracle_inside(points, rows, p) for p in x]
    found = domain.contains(x)
    assert all(w is None or w == f for w, f in zip(wanted, found.tolist()))
    assert not Domain(domain.points, domain.facets, inner=domain.inner).repairs


def test_resolve_iterates_where_rounded_crossings_touch_others() -> None:
    rng = np.random.default_rng(0)
    points = rng.random((40, 2)) * [1, 2.0**-45] + [0, 1]  # few last bits in y: crossings collapse
    points = rng.permutation(np.unique(points, axis=0))
    ring = np.column_stack([np.arange(len(points)), np.roll(np.arange(len(points)), 1)])
    mended = Domain(points, ring, resolve=True)
    kinds = {r.kind for r in mended.repairs}
    assert len(mended.repairs) > len(points) and {"crossing", "vertex on a segment"} <= kinds
    assert not Domain(mended.points, mended.facets).repairs


# ---------------------------------------------------------------------- arguments


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[0, 0], [1, float("nan")], [1, 1]], [[0, 1], [1, 2], [2, 0]]), r"points\[1\]"),
        (([[0, 0, 0, 0]], []), r"shape \(n, 2\)"),
        ((SQUARE, [[0, 1, 2]]), r"facets must have shape \(s, 2\)"),
        ((SQUARE, [[0.0, 1.0]]), "facets must be integers"),
        ((SQUARE, [[0, 2**40]]), "beyond 32 bits"),
        ((SQUARE, [[0, 1], [1]]), "pairs of vertices"),
        ((SQUARE, np.ma.masked_equal(RING, 3)), r"facets\[2\] is masked"),
        (([], []), r"shape \(n, d\)"),
    ],
)
def test_bad_arrays(arguments: tuple, message: str) -> None:
    with pytest.raises(UnstructError, match=message):
        Domain(*arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"markers": {"a": [4]}}, r"markers\['a'\] names pieces outside 0\.\.3"),
        ({"markers": {"a": [[1]]}}, r"markers\['a'\] must be a list"),
        ({"curves": {9: Arc((0, 0), 1, 0, 1)}}, r"curves\[9\]"),
        ({"curves": {0: 3}}, r"curves\[0\] must have a method point"),
        ({"regions": {"a": [9, 9]}}, r"regions\['a'\]\[0\] = \[9.0, 9.0\] lies outside"),
        ({"regions": {"a": [2, 0]}}, r"regions\['a'\]\[0\] = \[2.0, 0.0\] lies on facet 0"),
        ({"regions": {"a": [[1, 1, 1]]}}, r"regions\['a'\] must have shape"),
        ({"regions": {"a": [[1, 1], [1]]}}, r"regions\['a'\] must be an array"),
        ({"regions": {"a": "middle"}}, r"regions\['a'\] must have shape"),
        ({"regions": [[1, 1]]}, "regions must be a dict"),
        ({"markers": {"a": [[1], [1, 2]]}}, r"markers\['a'\] must be a list"),
        ({"markers": [1]}, "markers must be a dict"),
        ({"markers": {"facets": [1]}}, r"markers\['facets'\]: meshes use this name"),
        ({"curves": [Arc((0, 0), 1, 0, 1)]}, "curves must be a dict"),
        ({"curves": {"a": Arc((0, 0), 1, 0, 1)}}, "curves has the key 'a'"),
    ],
)
def test_bad_options(options: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Domain(SQUARE, RING, **options)


def test_arrays_are_read_only_and_not_aliased_by_facets() -> None:
    facets = np.array(RING, dtype=np.int32)
    domain = Domain(np.array(SQUARE, dtype=float), facets)
    facets[0] = 3
    assert domain.facets[0].tolist() == [0, 1]
    with pytest.raises(ValueError, match="read-only"):
        domain.points[0] = 1


# ---------------------------------------------------------------------- inside, area, bounds


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([k for k in KINDS if k != "curves"]))
def test_inside_and_area_agree_with_fractions(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    domain = random_region(rng, kind)
    low, high = domain.bounds
    x = np.concatenate([low + rng.random((20, 2)) * (high - low), domain.points[:5]])
    wanted = [oracle_inside(domain.points, domain.facets, p) for p in x]
    assert domain.contains(x).tolist() == [w is None or w for w in wanted]
    if len(domain.facets) < 40:
        assert domain.area == float(oracle_area(domain.points, domain.facets))


def test_a_point_beside_a_facet_by_one_bit() -> None:
    triangle = Domain.polygon([[0, 0], [1, 1 / 3], [0, 1]])
    x = np.array([[0.75, 0.25], [0.75, np.nextafter(0.25, 0)], [0.75, np.nextafter(0.25, 1)]])
    wanted = [oracle_inside(triangle.points, triangle.facets, p) for p in x]
    assert triangle.contains(x).tolist() == [w is None or w for w in wanted] and not all(wanted)


def test_area_is_correctly_rounded() -> None:
    for scale in (1.0, 2.0**400, 2.0**-400, 1e150):
        far = Domain.polygon(np.array([[1e8, 1e8], [1e8 + 0.1, 1e8], [1e8, 1e8 + 0.1]]) * scale)
        assert far.area == float(oracle_area(far.points, far.facets))


def test_contains_takes_any_leading_shape_and_rejects_the_rest() -> None:
    square = Domain.polygon(SQUARE)
    assert square.contains([1, 1]) and square.contains(np.ones((2, 3, 2))).shape == (2, 3)
    with pytest.raises(InputError, match="shape"):
        square.contains([1, 2, 3])
    with pytest.raises(InputError, match="not finite"):
        square.contains([[np.nan, 0]])


def test_no_facets_no_inside() -> None:
    lines = Domain(SQUARE, [], inner=RING)
    assert lines.area == 0 and not lines.contains([[2, 2]])[0] and len(lines.sampled().ends) == 4


# ---------------------------------------------------------------------- subsegments


def check_sampled(domain: Domain, sampled, size=None) -> None:
    n = len(domain.points)
    assert np.array_equal(sampled.points[:n], domain.points)
    assert sampled.origin.tolist() == [*range(n), *[-1] * (len(sampled.points) - n)]
    assert len(meetings(sampled.points, sampled.ends)[0]) == 0
    assert np.array_equal(np.unique(sampled.piece), np.arange(len(domain.pieces)))
    for i in range(len(domain.pieces)):
        rows = np.nonzero(sampled.piece == i)[0]
        ends, span = sampled.ends[rows], sampled.span[rows]
        assert (ends[0, 0], ends[-1, 1]) == tuple(domain.pieces[i]) and span[0, 0] == 0 and span[-1, 1] == 1
        assert np.array_equal(ends[1:, 0], ends[:-1, 1]) and np.array_equal(span[1:, 0], span[:-1, 1])
        assert (np.diff(span, axis=1) > 0).all()
        assert np.array_equal(sampled.points[ends[:-1, 1]], domain.at(i, span[:-1, 1]))
    used = np.bincount(sampled.ends.ravel(), minlength=len(sampled.points))
    assert (used[n:] == 2).all()


@pytest.mark.parametrize("kind", KINDS)
def test_subsegments_of_random_regions(kind: str) -> None:
    for seed in range(12):
        domain = random_region(np.random.default_rng([seed, 1]), kind)
        check_sampled(domain, domain.sampled())
        wide = float(np.ptp(domain.bounds, axis=0).max())
        check_sampled(domain, domain.sampled(0.11 * wide))
        check_sampled(domain, domain.sampled(lambda x: 0.02 * wide + 0.2 * np.abs(x[:, 0]), step=1.5))  # noqa: B023


def test_equal_steps_of_a_constant_size() -> None:
    domain = Domain.rectangle((0, 0), (3, 1))
    sampled = domain.sampled(0.3)
    assert np.bincount(sampled.piece).tolist() == [10, 3, 10, 3]
    assert np.allclose(np.diff(sampled.span[sampled.piece == 0], axis=1), 0.1, rtol=1e-14)
    assert np.bincount(domain.sampled(0.3, step=np.sqrt(3)).piece).tolist() == [6, 2, 6, 2]


def test_steps_follow_a_graded_size() -> None:
    domain = Domain.rectangle((0, 0), (1, 1))

    def size(x):
        return 0.001 + 0.1 * x[:, 0]

    sampled = domain.sampled(size)
    bottom = sampled.points[sampled.ends[sampled.piece == 0]]
    length = np.diff(bottom[:, :, 0], axis=1)[:, 0]
    ratio = length / size(bottom.mean(axis=1))
    whole = np.log(101) / 0.1  # the integral of dx / (0.001 + 0.1 x)
    assert len(length) == round(whole) and abs(ratio - whole / len(length)).max() < 0.01


BAD_SIZES = [0, -1.0, np.nan, np.inf, lambda x: x[:, 0] - 0.5, lambda x: np.full(len(x), np.nan)]


@pytest.mark.parametrize("size", BAD_SIZES)
def test_bad_sizes(size) -> None:
    with pytest.raises(InputError, match="size"):
        Domain.rectangle().sampled(size)


def test_bad_steps() -> None:
    with pytest.raises(InputError, match="step"):
        Domain.rectangle().sampled(0.1, step=0)


def test_extreme_scales() -> None:
    for scale in (2.0**600, 2.0**-600, 2.0**1000):
        domain = Domain.polygon(scale * np.array(SQUARE, dtype=float))
        assert len(domain.sampled(scale * 0.5).ends) == 32


@pytest.mark.parametrize("scale", [2.0**-700, 2.0**700])
def test_extreme_scales_of_curves(scale: float) -> None:
    """No square of a coordinate is a double: every answer is that of the unit scale, without a warning."""
    x = np.random.default_rng(3).uniform(-1.2, 1.2, (500, 2))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        disc = Domain.disc((0, 0), scale)
        assert np.array_equal(disc.contains(scale * x), np.hypot(*x.T) <= 1)
        assert disc.area == (0.0 if scale < 1 else np.inf)
        bite = disc.with_holes(Domain.disc((0.9 * scale, 0), 0.5 * scale), resolve=True)
        plain = Domain.disc((0, 0), 1).with_holes(Domain.disc((0.9, 0), 0.5), resolve=True)
        assert np.array_equal(bite.facets, plain.facets) and len(bite.curves) == len(plain.curves)
        with pytest.raises(InputError, match="cross or touch"):
            disc.with_holes(Domain.disc((0.9 * scale, 0), 0.5 * scale))


def test_a_straight_piece_that_rounding_would_let_touch_stays_whole() -> None:
    """Cutting a slanted piece moves it by a last bit: onto a neighbor that is one bit away."""
    rng = np.random.default_rng(5)
    for _ in range(40):
        a, b = rng.random(2), 1 + rng.random(2)
        near = np.stack([a, b])
        near[:, 1] = np.nextafter(near[:, 1], 4)
        domain = Domain([a, b, *near], [], inner=[[0, 1], [2, 3]])
        check_sampled(domain, domain.sampled(0.1))


def test_many_segments_are_validated() -> None:
    """If each were compared with each, this would take hours."""
    n = 100_000
    angle = np.arange(n) / n * 2 * np.pi
    ring = (1 + 0.1 * np.cos(9 * angle))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    domain = Domain.polygon(ring)
    assert abs(domain.area - np.pi * (1 + 0.005)) < 1e-8
    matches = np.random.default_rng(1).random((n, 2))
    matches[1::2] = matches[::2] + np.random.default_rng(2).normal(0, 1e-3, (n // 2, 2))
    with pytest.raises(InputError, match="cross"):
        Domain(matches, [], inner=np.arange(n).reshape(-1, 2))


@pytest.mark.parametrize("name", sorted(HARD_2D))
def test_hard_points_as_loose_vertices_and_rings(name: str) -> None:
    """Any points: sorted by angle about their middle they are repaired to a region, or become inner."""
    points = HARD_2D[name]
    order = np.lexsort((points[:, 1], points[:, 0]))
    rows = np.column_stack([order, np.roll(order, 1)])
    try:
        mended = Domain(points, rows, resolve=True)
    except InputError as error:
        first, last = points[order[[0, -1]]]
        flat = [orient(np.array([first, last, x])) == 0 for x in points]
        assert "no facet is left" in str(error) and all(flat)
        return
    assert not Domain(mended.points, mended.facets, inner=mended.inner).repairs
    assert mended.area >= 0 and set(mended.origin[mended.origin >= 0]) <= set(range(len(points)))


def test_a_curve_may_bound_with_its_chord() -> None:
    half = Domain([[-1, 0], [1, 0]], [[0, 1], [1, 0]], curves={1: Arc((0, 0), 1, 0, np.pi)})
    assert abs(half.area - np.pi / 2) < 1e-15
    wavy = Curve(lambda t: np.column_stack([t, 0.1 * np.sin(2 * np.pi * t)]))
    with pytest.raises(InputError, match=r"facet 0 and facet 1 cross or touch near \(0\.5"):
        Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves={1: wavy})


def test_a_domain_keeps_its_own_points() -> None:
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    domain = Domain(points, RING)
    points[2] = -5.0
    assert domain.area == 1.0 and domain.points[2].tolist() == [1.0, 1.0]
    for wrong in (lambda: domain.contains("a"), lambda: domain.at(0, "a")):
        with pytest.raises(InputError, match="real numbers"):
            wrong()


def test_a_domain_without_pieces_has_nothing_to_cut():
    domain = Domain([(0, 0), (1, 0), (0, 1)], ())
    assert len(domain.sampled(0.1).ends) == 0 and len(domain.sampled().ends) == 0
    for method in (refine, voronoi_segment, circumcenter_insertion):
        with pytest.raises(InputError, match="no facets"):
            method(domain, 0.1)
