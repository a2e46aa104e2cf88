"""``resolve=True`` on rings that are none, on vertices of curves, and on what is clean."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, check, refine
from unstruct.geometry.curves import Arc

SQUARE = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]

DEGENERATE = {
    "two corners": [(1, 1), (2, 1)],
    "two corners, closed": [(1, 1), (2, 1), (1, 1)],
    "one corner": [(1, 1)],
    "one corner three times": [(1, 1), (1, 1), (1, 1)],
    "on a line": [(1, 1), (2, 1), (3, 1)],
    "there and back": [(1, 1), (2, 1), (3, 1), (2, 1)],
    "folded": [(1, 1), (3, 1), (2, 1), (3, 1), (1, 1), (2, 1)],
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_rings_without_area_go_with_an_account(name: str) -> None:
    ring = DEGENERATE[name]
    domain = Domain.polygon(SQUARE, [ring], resolve=True)
    assert domain.area == 16 and len(domain.points) == len(domain.facets) == 4
    assert not len(domain.loose) and domain.origin.tolist() == [0, 1, 2, 3]
    assert domain.repairs and check(refine(domain, 1.0), domain=domain)
    with pytest.raises(InputError, match="no facet is left that bounds a region"):
        Domain.polygon(ring, resolve=True)
    with pytest.raises(InputError):
        Domain.polygon(SQUARE, [ring])


def test_repeated_corners_and_spikes() -> None:
    for ring, kinds in (
        ([SQUARE[0], *SQUARE, SQUARE[3], SQUARE[3]], {"duplicate points", "zero length"}),
        (
            [*SQUARE[:2], (6.0, 0.0), *SQUARE[1:]],
            {"duplicate points", "repeated segment", "vertex without pieces"},
        ),
        (
            [*SQUARE[:2], (6.0, -1.0), (7.0, 2.0), (6.0, -1.0), *SQUARE[1:]],
            {"duplicate points", "repeated segment", "vertex without pieces"},
        ),
    ):
        domain = Domain.polygon(ring, resolve=True)
        assert domain.area == 16 and len(domain.points) == len(domain.facets) == 4 and not len(domain.loose)
        assert {r.kind for r in domain.repairs} == kinds


def test_loose_vertices_of_the_input_stay() -> None:
    points, ring = [*SQUARE, (1, 1), (2, 2), (3, 3)], [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 4]]
    domain = Domain(points, ring, resolve=True)
    assert domain.points[domain.loose].tolist() == [[3, 3]] and domain.origin.tolist() == [0, 1, 2, 3, 6]
    assert [r.kind for r in domain.repairs] == ["repeated segment"] + ["vertex without pieces"] * 2
    both = Domain([*points, (1.0, 1.0)], ring, resolve=True)  # a copy of a dropped vertex is loose itself
    assert both.points[both.loose].tolist() == [[1, 1], [3, 3]]


def test_open_chains_alone_are_no_region() -> None:
    with pytest.raises(InputError, match=r"no facet is left .*give all segments as inner"):
        Domain(SQUARE, [[0, 1]], resolve=True)
    inner = Domain(SQUARE, [], inner=[[0, 2], [1, 3]], resolve=True)  # no facets were given
    assert len(inner.inner) == 4 and len(inner.facets) == 0


def test_what_is_clean_stays_as_it_is() -> None:
    curves = {0: Arc((2, 0), 2, np.pi, -np.pi)}
    parts = {
        "inner": [[4, 5]],
        "markers": {"a": [0, 4], "b": [4]},
        "regions": {"r": [2, 3]},
        "curves": curves,
    }
    points = [*SQUARE, (1, 3), (2, 3.5), (3, 3)]
    plain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], **parts)
    domain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], resolve=True, **parts)
    for name in ("points", "facets", "inner", "origin", "piece_origin"):
        assert np.array_equal(getattr(domain, name), getattr(plain, name))
        assert getattr(domain, name).dtype == getattr(plain, name).dtype
    assert domain.curves == plain.curves and not domain.repairs
    assert {name: list(rows) for name, rows in domain.markers.items()} == {"a": [0, 4], "b": [4]}


def test_names_follow_their_pieces() -> None:
    ring = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 4]]
    points = [*SQUARE, (3, 1), (5, 1), (5, 3)]
    markers = {"right": [1], "wedge": [4, 5, 6], "all": range(7), "none": []}
    domain = Domain(points, ring, markers=markers, resolve=True)
    for name, pieces in markers.items():
        assert set(domain.piece_origin[domain.markers[name]]) == set(pieces)
        assert np.isin(domain.piece_origin, list(pieces)).sum() == len(domain.markers[name])
