"""Faults of bodies in space: each kind is found and named, in every position; sound bodies have none."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from unstruct import Domain, DomainError, InputError, UnstructError

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def cubes(*offsets: tuple[float, float, float]) -> tuple[np.ndarray, list[list[int]]]:
    """Unit cubes at these places."""
    points = np.concatenate([CORNERS + offset for offset in offsets])
    return points, [[8 * i + v for v in side] for i in range(len(offsets)) for side in SIDES]


def framed() -> tuple[np.ndarray, list]:
    """A square plate with a square hole: two facets have holes."""
    rings = [(0, 0), (3, 0), (3, 3), (0, 3), (1, 1), (2, 1), (2, 2), (1, 2)]
    points = np.array([(*p, z) for z in (0.0, 1.0) for p in rings])
    facets: list = [[[0, 3, 2, 1], [4, 5, 6, 7]], [[8, 9, 10, 11], [12, 15, 14, 13]]]
    for k in range(4):
        n = (k + 1) % 4
        facets += [[k, n, 8 + n, 8 + k], [4 + k, 12 + k, 12 + n, 4 + n]]
    return points, facets


FAULTS = {
    "open boundary": (CORNERS, SIDES[:-1], "1 facet ends at the edge 1-3"),
    "repeated facet": (CORNERS, [*SIDES, SIDES[0][::-1]], "facet 0 and facet 6 have the same points"),
    "crossing itself": (CORNERS, [(0, 1, 2, 3), *SIDES[1:]], "facet 0 crosses or touches itself"),
    "vertex on a facet": (np.vstack([CORNERS, [0.5, 0.5, 0]]), SIDES, r"point 8 lies on facet 4"),
    "duplicate points": (np.vstack([CORNERS, CORNERS[0]]), SIDES, "points 0 and 8 are equal"),
    "crossing": (*cubes((0, 0, 0), (0.5, 0.5, 0.5)), "crosses facet .* unite the bodies"),
    "vertex on an edge": (*cubes((0, 0, 0), (0.5, 0, 0)), "lies on an edge of facet"),
    "index out of range": (CORNERS, [(0, 1, 3, 9), *SIDES], r"facet 0 refers to points outside 0..7: 9"),
    "repeated vertex": (CORNERS, [(0, 1, 1, 2), *SIDES], "facet 0 has point 1 twice"),
    "not flat": (
        CORNERS + [[0.2 * (i == 0), 0, 0] for i in range(8)],
        SIDES,
        "do not lie in a plane: point 0",
    ),
    "zero area": (
        [(0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 1, 0)],
        [(0, 1, 2), (0, 1, 3)],
        "facet 0 = .* no area",
    ),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_each_fault_is_named(kind: str) -> None:
    points, facets, message = FAULTS[kind]
    with pytest.raises(DomainError, match=message) as caught:
        Domain(points, facets)
    assert kind in {fault.kind for fault in caught.value.faults}


@pytest.mark.parametrize("kind", FAULTS)
@pytest.mark.parametrize("seed", range(3))
def test_faults_do_not_depend_on_the_position(kind: str, seed: int) -> None:
    """Axes exchanged and turned, numbers of points permuted, facets in another order and direction."""
    points, facets, _ = FAULTS[kind]
    rng = np.random.default_rng(seed)
    points = np.asarray(points, dtype=float)
    order = rng.permutation(len(points))
    number = [*np.argsort(order).tolist(), *range(len(points), 20)]
    moved = points[order][:, rng.permutation(3)] * rng.choice([-4.0, 0.5, 1.0], 3)
    rows = [[number[v] for v in row][:: rng.choice([-1, 1])] for row in facets]
    with pytest.raises(DomainError) as caught:
        Domain(moved, [rows[i] for i in rng.permutation(len(rows))])
    assert kind in {fault.kind for fault in caught.value.faults}


def test_sound_bodies() -> None:
    assert Domain(CORNERS, SIDES).volume == 1.0
    plate = Domain(*framed(), regions={"plate": (0.5, 0.5, 0.5)}, markers={"top": [1]})
    assert plate.volume == 8.0
    assert plate.contains([(1.5, 1.5, 0.5), (0.5, 0.5, 0.5), (1, 1, 0), (5, 5, 5)]).tolist() == [0, 1, 1, 0]
    shell = Domain(*cubes((0, 0, 0), (2, 0, 0)))
    assert shell.volume == 2.0 and shell.bounds.tolist() == [[0, 0, 0], [3, 1, 1]]


def test_inner_pieces_and_seeds() -> None:
    with pytest.raises(DomainError, match="inner segment 0 and inner segment 1 cross"):
        Domain(CORNERS, SIDES, inner=[(0, 7), (1, 6)])
    with pytest.raises(InputError, match="lies on inner segment 0"):
        Domain(CORNERS, SIDES, inner=[(0, 7)], regions={"a": (0.5, 0.5, 0.5)})
    with pytest.raises(InputError, match="outside the body"):
        Domain(CORNERS, SIDES, regions={"a": (5, 5, 5)})
    middle = Domain(CORNERS, SIDES, inner=[(0, 1, 7, 6), (2, 4)][:1])
    assert middle.name(6) == "inner facet 0" and middle.volume == 1.0


@pytest.mark.parametrize(
    ("facets", "message"),
    [
        ("abc", "facets"),
        ([[0, 1]], "a facet needs three"),
        ([0, 1, 2], "must be a row of vertices"),
        ([[0, 1, 2], ["a"]], "must be integers"),
        ([[0.5, 1, 2]], "must be integers"),
        ([[0, 1, 2], []], "has no vertices|needs three"),
        (np.zeros((2, 3, 3), dtype=int), "must have shape"),
        (None, "facets"),
        ([[0, 1, 2**40]], "beyond 32 bits"),
    ],
)
def test_bad_rows(facets: object, message: str) -> None:
    with pytest.raises(UnstructError, match=message):
        Domain(CORNERS, facets)
