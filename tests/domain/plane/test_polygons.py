"""Holes are holes: an outer ring minus its holes, a domain minus others, or an error that names them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, check, constrained_delaunay
from unstruct.base.errors import InputError
from unstruct.geometry.curves import Arc

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
SMALL = [(1, 1), (2, 1), (2, 2), (1, 2)]
INSIDE = [(1.2, 1.2), (1.5, 1.2), (1.5, 1.5)]
BESIDE = [(5, 1), (6, 1), (5, 2)]


def test_holes_that_touch() -> None:
    """OGC allows rings that touch in points: corners on corners and corners on sides."""
    corner = Domain.polygon(SQUARE, [[(0, 0), (3, 1), (1, 3)]], inner=[[2, 6]], markers={"hole": [4]})
    assert corner.area == 12 and len(corner.points) == 6 and corner.inner.tolist() == [[2, 5]]
    assert corner.origin.tolist() == [0, 1, 2, 3, 5, 6] and corner.markers["hole"].tolist() == [4]
    side = Domain.polygon(SQUARE, [[(2, 0), (3, 1), (1, 1)]], markers={"bottom": [0]}, inner=[[2, 5]])
    assert side.area == 15 and side.piece_origin.tolist() == [0, 0, 1, 2, 3, 4, 5, 6, 7]
    assert side.markers["bottom"].tolist() == [0, 1] and not side.repairs
    both = Domain.polygon(SQUARE, [SMALL, [(2, 2), (3, 2), (3, 3), (2, 3)]])
    assert both.area == 14 and len(both.points) == 11
    for domain in (corner, side, both):
        assert check(constrained_delaunay(domain), domain=domain)


FAULTS = {
    "beside": ([BESIDE], r"holes\[0\] lies outside outer near", 16),
    "second beside": ([SMALL, BESIDE], r"holes\[1\] lies outside outer near", 15),
    "in a hole": ([SMALL, INSIDE], r"holes\[0\] and holes\[1\] overlap near", 15),
    "around": ([[(-1, -1), (5, -1), (5, 5), (-1, 5)], SMALL], r"holes\[0\] lies outside outer|overlap", None),
    "twice": ([SMALL, SMALL], "overlap near", 15),
    "crossing": ([[(3, 1), (5, 1), (5, 2), (3, 2)]], r"outer and holes\[0\] cross at \(4, [12]\)", 15),
    "holes that cross": (
        [SMALL, [(1.5, 1.5), (3, 1.5), (3, 3), (1.5, 3)]], r"holes\[0\] and holes\[1\] cross at", 13,
    ),
    "a side in common": ([[(1, 0), (2, 0), (2, 1)]], r"outer and holes\[0\] share a line near", 15.5),
    "holes side by side": ([SMALL, [(2, 1), (3, 1), (3, 2), (2, 2)]], r"share a line near", 14),
    "the whole": ([SQUARE], "lies outside|share a line", None),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_holes_that_are_none(name: str) -> None:
    holes, message, area = FAULTS[name]
    with pytest.raises(InputError, match=message):
        Domain.polygon(SQUARE, holes)
    if area is None:
        with pytest.raises(InputError, match="leave nothing of outer"):
            Domain.polygon(SQUARE, holes, resolve=True)
        return
    domain = Domain.polygon(SQUARE, holes, resolve=True)
    assert domain.area == area and domain.repairs and len(domain.loose) == 0
    assert check(constrained_delaunay(domain), domain=domain)
    origin = domain.origin[domain.origin >= 0]
    given = np.concatenate([SQUARE, *holes])
    assert (domain.points[domain.origin >= 0] == given[origin]).all()


def test_a_ring_that_repeats_a_corner_is_refused_with_holes_too() -> None:
    for holes in ([], [SMALL]):
        with pytest.raises(InputError, match="points 1 and 2 are equal"):
            Domain.polygon([(0, 0), (4, 0), (4, 0), (4, 4), (0, 4)], holes)
        assert Domain.polygon([(0, 0), (4, 0), (4, 0), (4, 4), (0, 4)], holes, resolve=True).area == 16 - len(
            holes
        )


def test_curved_holes() -> None:
    bump = {4: Arc.through((1, 1), (1.5, 0.5), (2, 1))} if hasattr(Arc, "through") else {}
    domain = Domain.polygon(SQUARE, [SMALL], curves=bump)
    assert domain.area <= 15 and check(constrained_delaunay(domain), domain=domain)
    curved: Any = Domain.smooth
    circle = np.column_stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6)])
    assert curved(2 * circle, [circle]).area == pytest.approx(3 * np.pi, rel=1e-2)
    for holes in ([np.add(circle, [5, 0])], [circle, 0.5 * circle], [circle, 0.5 * circle, 0.2 * circle]):
        with pytest.raises(InputError, match=r"holes\[\d\] lies outside outer or within another hole near"):
            curved(2 * circle, holes)
        domain = curved(2 * circle, holes, resolve=True)
        inside = sum(np.abs(h).max() < 1.5 for h in holes) > 0
        assert domain.area == pytest.approx((3 if inside else 4) * np.pi, rel=1e-2) and domain.repairs
        assert check(constrained_delaunay(domain), domain=domain)


def test_domains_minus_others() -> None:
    plate, disc = (
        Domain.polygon(SQUARE, markers={"bottom": [0]}),
        Domain.disc((2, 2), 1, markers={"rim": range(4)}),
    )
    ring = disc.with_holes(Domain.disc((2, 2), 0.5))
    assert plate.with_holes(disc).area == pytest.approx(16 - math.pi)
    assert plate.with_holes(ring, Domain.disc((2, 2), 0.2)).area == pytest.approx(
        16 - math.pi * (0.75 + 0.04)
    )
    for others, message in (
        ([disc, Domain.disc((8, 2), 1)], r"others\[1\] lies outside the domain"),
        ([disc, Domain.disc((2, 2), 0.5)], r"others\[1\] lies .* within another hole"),
        ([Domain.disc((2, 2), 8)], "lies outside the domain"),
    ):
        with pytest.raises(InputError, match=message):
            plate.with_holes(*others)
    domain = plate.with_holes(disc, Domain.disc((8, 2), 1), resolve=True)
    assert domain.area == pytest.approx(16 - math.pi) and domain.markers["rim"].tolist() == [4, 5, 6, 7]
    assert check(constrained_delaunay(domain), domain=domain) and domain.repairs[-1].kind == "hole outside"
    with pytest.raises(InputError, match="leave nothing of the domain"):
        plate.with_holes(Domain.disc((2, 2), 8), resolve=True)
    beside = Domain.polygon([(4, 1), (5, 1), (5, 3), (4, 3)])
    assert plate.with_holes(beside, resolve=True).area == 16
    over = plate.with_holes(Domain.polygon([(3, 1), (5, 1), (5, 3), (3, 3)]), resolve=True)
    assert over.area == 14 and over.markers["bottom"].tolist() == [0]
    flat = Domain.polygon([(1, 0), (3, 0), (3, 0.5), (1, 0.5)])
    with pytest.raises(InputError, match=r"share a side near .* beside curves"):
        plate.with_holes(disc, flat, Domain.polygon([(1, 0), (3, 0), (2, -1)]), resolve=True)


def rectangle(size: int) -> st.SearchStrategy[tuple[int, int, int, int]]:
    """Corners (x0, y0, x1, y1) on an integer grid."""
    pair = st.lists(st.integers(0, size), min_size=2, max_size=2, unique=True).map(sorted)
    return st.tuples(pair, pair).map(lambda xy: (xy[0][0], xy[1][0], xy[0][1], xy[1][1]))


def ring(box: tuple[int, int, int, int]) -> list[tuple[int, int]]:
    x0, y0, x1, y1 = box
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def cells(box: tuple[int, int, int, int]) -> set[tuple[int, int]]:
    return {(i, j) for i in range(box[0], box[2]) for j in range(box[1], box[3])}


@settings(max_examples=100)
@given(rectangle(7), st.lists(rectangle(7), min_size=1, max_size=4), st.booleans())
def test_rectangles_against_counted_cells(outer: tuple, holes: list, whole: bool) -> None:
    """What is accepted has the area outer minus holes, and with `resolve` everything is."""
    left = cells(outer) - set().union(*map(cells, holes))
    try:
        domain = Domain.polygon(ring(outer), [ring(h)[:: 1 if whole else -1] for h in holes])
        assert domain.area == len(left) and not domain.repairs
    except InputError as error:
        assert "holes[" in str(error) or "holes leave nothing" in str(error)
    for subtract in (
        lambda: Domain.polygon(ring(outer), [ring(h) for h in holes], resolve=True),
        lambda: Domain.polygon(ring(outer)).with_holes(
            *(Domain.polygon(ring(h)) for h in holes), resolve=True
        ),
    ):
        if not left:
            with pytest.raises(InputError, match="leave nothing"):
                subtract()
            continue
        domain = subtract()
        assert domain.area == len(left) and len(domain.loose) == 0
        assert check(constrained_delaunay(domain), domain=domain)
