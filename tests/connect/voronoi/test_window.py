"""Windows of all kinds: the cells fill them, by rational arithmetic that knows nothing of triangulations."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import exact_areas, signed

from unstruct import Domain, InputError, voronoi
from unstruct.connect.voronoi.window import as_window
from unstruct.plain.predicates import orient

SITES = [(0.25, 0.5), (0.75, 0.5), (0.5, 0.9)]
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
BEND = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
grid = st.lists(st.tuples(*[st.integers(0, 5)] * 2), min_size=1, max_size=9)
rings = st.lists(st.tuples(*[st.integers(-2, 6)] * 2), min_size=3, max_size=9, unique=True)
some = settings(max_examples=60, deadline=None)


class Geometry:
    """What shapely's geometry looks like."""

    def __init__(self, kind, coordinates):
        self.__geo_interface__ = {"type": kind, "coordinates": coordinates}


def is_simple(ring):
    """Whether no two sides have a point in common, but neighbors their corner."""
    sides = list(zip(ring, [*ring[1:], *ring[:1]]))
    n = len(ring)
    for i, j in combinations(range(n), 2):
        (a, b), (c, d) = sides[i], sides[j]
        if j - i in (1, n - 1):
            shared, (p, q) = (b, (a, d)) if j - i == 1 else (a, (b, c))
            inner = sum((x - s) * (y - s) for x, y, s in zip(p, q, shared))
            if orient([shared, p, q]) == 0 and inner > 0:
                return False
        elif meet(a, b, c, d):
            return False
    return True


def meet(a, b, c, d):
    signs = [orient([a, b, c]), orient([a, b, d]), orient([c, d, a]), orient([c, d, b])]
    if not any(signs):
        return all(
            max(min(a[k], b[k]), min(c[k], d[k])) <= min(max(a[k], b[k]), max(c[k], d[k])) for k in (0, 1)
        )
    return signs[0] * signs[1] <= 0 and signs[2] * signs[3] <= 0


def parts_of(diagram, window):
    """For each region its polygons, and their areas."""
    cells = diagram.clip(window)
    cells = cells if isinstance(cells[0], list) else [[cell] if len(cell) else [] for cell in cells]
    return cells, [sum(signed(part.tolist()) / 2 for part in cell) for cell in cells]


@some
@given(grid, rings)
def test_any_polygon_is_filled_or_refused(points, ring):
    sites = list(dict.fromkeys(points))
    diagram = voronoi(np.array(sites, dtype=float))
    try:
        areas = diagram.areas(clip=ring)
    except InputError as error:
        assert not is_simple(ring), error
        assert any(word in str(error) for word in ("cross", "overlap", "collinear"))
        return
    total = float(sum(areas))
    if is_simple(ring):
        assert np.allclose(areas, np.array(exact_areas(sites, [ring]), dtype=float), rtol=0, atol=1e-12)
        cells, sums = parts_of(diagram, ring)
        assert np.allclose(sums, areas, rtol=0, atol=1e-12)
        for part in (part for cell in cells for part in cell):
            assert len(part) >= 3 and signed(part.tolist()) > 0
    for same in (ring[::-1], [*ring, ring[0]], [x for x in ring for _ in range(2)], ring[2:] + ring[:2]):
        assert diagram.areas(clip=same).sum() == pytest.approx(total, abs=1e-12)


@pytest.mark.parametrize(
    "ring",
    [
        [*SQUARE, SQUARE[0]],
        [*SQUARE[::-1], SQUARE[-1]],
        [(0, 0), (0.5, 0), (1, 0), (1, 0), (1, 0.25), (1, 1), (0, 1)],
        [(0.5, 0), *SQUARE[1:], SQUARE[0], (0.5, 0)],
        [(0.0, -0.0), (1, 0), (1, 1), (-0.0, 1), (0, 0)],
    ],
)
def test_repeated_and_straight_corners(ring):
    diagram = voronoi(SITES)
    box = diagram.areas(clip=((0, 0), (1, 1)))
    assert diagram.areas(clip=ring).sum() == 1.0
    assert np.array_equal(diagram.areas(clip=ring), box)
    assert [len(c) for c in diagram.clip(ring)] == [len(c) for c in diagram.clip(((0, 0), (1, 1)))]
    moved = diagram.relax(1, clip=ring).voronoi.points
    assert np.allclose(moved, diagram.relax(1, clip=((0, 0), (1, 1))).voronoi.points, rtol=0, atol=1e-15)


@some
@given(grid, st.integers(1, 3), st.integers(1, 3))
def test_holes(points, x, y):
    sites = list(dict.fromkeys(points))
    window = [
        [(-1, -1), (6, -1), (6, 6), (-1, 6)],
        [(x, y), (x + 1, y), (x + 1, y + 2)],
        [(5, 5), (5, 6), (4, 6)],
    ]
    areas = voronoi(np.array(sites, dtype=float)).areas(clip=window[:2])
    assert np.allclose(areas, np.array(exact_areas(sites, window[:2]), dtype=float), rtol=0, atol=1e-12)
    touching = [window[0], window[1], [(5, 5), (4, 4), (5, 4)], [(6, 3), (5, 2), (5, 3)]]
    areas = voronoi(np.array(sites, dtype=float)).areas(clip=touching)
    assert areas.sum() == pytest.approx(49 - 2, abs=1e-12)


def test_the_window_may_be_of_many_types():
    diagram = voronoi([(0.5, 0.5), (3, 0.5), (0.5, 3), (9, 9)])
    exact = np.array(exact_areas(diagram.points.tolist(), [BEND]), dtype=float)
    assert exact.sum() == 7 and exact[3] == 0
    closed = [*BEND, BEND[0]]
    domain = Domain(BEND, [(i, (i + 1) % 6) for i in range(6)], inner=[(0, 3)])
    for window in (
        BEND,
        np.array(BEND),
        [BEND],
        [np.array(BEND)],
        domain,
        Geometry("Polygon", [closed]),
        Geometry("LinearRing", closed),
        {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [[(x, y, 7) for x, y in closed]]}},
        {"type": "Feature", "geometry": None},
        {"type": "MultiPolygon", "coordinates": [[closed], []]},
        {
            "type": "GeometryCollection",
            "geometries": [
                {"type": "Polygon", "coordinates": [[(0, 0), (4, 0), (4, 1), (0, 1)]]},  # they share a side
                {"type": "Polygon", "coordinates": [[(0, 1), (1, 1), (1, 4), (0, 4)]]},
            ],
        },
    ):
        if isinstance(window, dict) and window.get("geometry", 0) is None:
            with pytest.raises(InputError, match="no polygon"):
                diagram.areas(clip=window)
            continue
        assert np.allclose(diagram.areas(clip=window), exact, rtol=0, atol=1e-14)
        assert [len(cell) for cell in diagram.clip(window)][3] == 0
        assert np.allclose(parts_of(diagram, window)[1], exact, rtol=0, atol=1e-14)


def test_domains_with_holes_and_curves():
    diagram = voronoi(np.random.default_rng(3).random((40, 2)))
    ring = Domain.polygon([(0, 0), (2, 0), (2, 2), (0, 2)], holes=[[(0.5, 0.5), (1, 0.5), (1, 1), (0.5, 1)]])
    assert diagram.areas(clip=ring).sum() == pytest.approx(3.75, rel=1e-14)
    disc = Domain.disc((0.5, 0.5), 1).with_holes(Domain.disc((0.5, 0.5), 0.25))
    assert diagram.areas(clip=disc).sum() == pytest.approx(disc.area, rel=1e-4)
    assert len(as_window(Domain.disc()).start) == 2  # one convex piece


def test_relaxation_in_a_window_that_is_not_convex():
    points = np.random.default_rng(0).random((60, 2)) * 4
    result = voronoi(points).relax(6, clip=BEND)
    assert (np.diff(result.energies) <= 0).all()
    assert result.voronoi.areas(clip=BEND).sum() == pytest.approx(7, rel=1e-13)
    ring = [[(0, 0), (3, 0), (3, 3), (0, 3)], [(1, 1), (2, 1), (2, 2), (1, 2)]]
    alone = voronoi([(0.5, 0.5)]).relax(1, clip=ring)
    assert alone.voronoi.points.tolist() == [[1.5, 1.5]]  # in the hole: that is where the energy is least


@pytest.mark.parametrize(
    "window, words",
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "side 0 of clip .* crosses side 2"),
        ([(0, 0), (1, 1), (2, 2), (2, 0), (1, 1), (0, 2)], "crosses itself"),  # at a corner
        ([(0, 0), (2, 0), (2, 2), (3, 2), (2, 2), (0, 2)], "side 2 of clip .* overlaps side 3"),
        ([(0, 0), (1, 0), (2, 0), (1, 0)], "collinear"),
        ([(0, 0)] * 5, "three different"),
        ([(0, 0), (1, 1), (0, 0)], "three different"),
        ([SQUARE, [(2, 2), (3, 2), (3, 3)]], "hole 0 of clip is misplaced"),
        ([[(2, 2), (3, 2), (3, 3)], [(0, 0), (9, 0), (9, 9), (0, 9)]], "misplaced"),
        ([BEND, [(2, 2), (3, 2), (3, 3)]], "hole 0 of clip is misplaced"),
        ([SQUARE, SQUARE], "overlaps"),
        ([SQUARE, [(0.5, 0.5), (2, 0.5), (0.5, 0.75)]], "crosses"),
        ([SQUARE, [(0.1, 0.1), (0.9, 0.1), (0.1, 0.9)], [(0.2, 0.2), (0.3, 0.2), (0.2, 0.3)]], "hole 1"),
        ([SQUARE, [(0.1, np.nan), (0.9, 0.1), (0.1, 0.9)]], "corner 0 of hole 0"),
        (Geometry("MultiPolygon", [[SQUARE], [[(0.5, 0.5), (2, 0.5), (2, 2)]]]), "polygons 0 and 1"),
        (Geometry("MultiPolygon", [[SQUARE], [[(0.4, 0.4), (0.5, 0.4), (0.5, 0.5)]]]), "polygons 0 and 1"),
        (Geometry("LineString", SQUARE), "LineString"),
        (Geometry("Polygon", [[(0,), (1,)]]), "positions"),
        (Geometry("Polygon", ()), "no polygon"),
        ([[[0, 0], [1, 0]], "ab"], "real numbers"),
        (7.0, "shape"),
    ],
)
def test_windows_that_are_refused_by_name(window, words):
    with pytest.raises(InputError, match=words):
        voronoi(SITES).areas(clip=window)


@some
@given(
    st.lists(st.integers(0, 6), min_size=1, max_size=5), st.sampled_from([(1, 0), (0, 1), (1, 2), (-2, 1)])
)
def test_sites_on_a_line(steps, direction):
    sites = [tuple(s * x for x in direction) for s in steps]
    diagram = voronoi(sites)
    different = sorted(set(sites), key=lambda x: sites.index(x))
    exact = dict(zip(different, exact_areas(different, [BEND])))
    areas = diagram.areas(clip=BEND)[diagram.point_region]
    assert np.allclose(areas, [float(exact[x]) for x in sites], rtol=0, atol=1e-13)
    box = diagram.areas(clip=((-1, -1), (2, 3)))
    assert box.sum() == pytest.approx(12, rel=1e-14) and len(box) == len(different)
    assert all(diagram.nearest(x) == sites.index(x) for x in sites)
    ends = [k for k in range(len(different)) if len(diagram.neighbors(k)) < 2]
    assert len(ends) == min(2, len(different))
    moved = diagram.relax(2, clip=((-1, -1), (2, 3)))
    assert (np.diff(moved.energies) <= 1e-12).all()


def test_far_and_touching_windows():
    diagram = voronoi([(0, 0), (1, 0), (0, 1)])
    far = diagram.areas(clip=((1e6, 1e6), (1e6 + 1, 1e6 + 2)))
    assert far.sum() == pytest.approx(2, rel=1e-9) and far[0] == 0
    touching = diagram.areas(clip=[(0.5, 0.5), (2, 0.5), (2, 1)])  # a corner on the Voronoi vertex
    assert touching.tolist() == [0, 0.375, 0]
    assert voronoi([(5.0, 5.0)]).areas(clip=((0, 0), (1, 1))).tolist() == [1.0]


def test_many_pieces():
    """A comb with 200 teeth, and 3000 sites: far more pairs than cells."""
    k = np.arange(200)
    teeth = np.stack([np.stack([k + 0.5, k], axis=1).ravel(), np.tile([0.0, 9.0], 200)], axis=1)
    comb = np.concatenate([[(-1.0, -1.0), (200.0, -1.0)], teeth[::-1]])
    sites = np.random.default_rng(1).random((3000, 2)) * (200, 9)
    areas = voronoi(sites).areas(clip=comb)
    xs = [tuple(map(Fraction, x)) for x in comb.tolist()]
    assert areas.sum() == pytest.approx(float(signed(xs) / 2), rel=1e-12)
