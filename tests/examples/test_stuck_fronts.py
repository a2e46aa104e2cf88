"""Bodies on whose faces a front sticks: valid, convex where that is said, and where the front sticks."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from unstruct import InputError, examples
from unstruct.plain import advancing_front_space as plain
from unstruct.plain.refilling import refills
from unstruct.predicates import orient

# The size, and how many cells there are and faces are left.
STUCK = {
    "twisted prism": (20.0, 0, 8), "convex": (2.0, 4, 8), "general": (2.0, 5, 8), "ten faces": (2.0, 11, 10),
}  # fmt: skip


@pytest.mark.parametrize("name", STUCK)
def test_the_front_sticks(name: str) -> None:
    """The plain front: so many cells, and no vertex serves any of the faces left."""
    domain = examples.stuck_body(name)
    inward = np.asarray(domain.facets)[:, [0, 2, 1]].tolist()
    steps = list(plain.advancing_front_in_space(domain.points.tolist(), inward, lambda x: STUCK[name][0]))
    front = plain.front_of(domain.points.tolist(), inward)
    for step in steps:
        front.points.extend([step.ideal] if step.chosen == len(front.points) else [])
        plain.without_cell(front, (*step.face, step.chosen))
    assert (len(steps), len(front.faces)) == STUCK[name][1:]
    for face in front.faces:
        for v in front.vertices() - set(face):
            cell = (*face, v)
            assert any(fails(front, cell) for fails in plain.SPACE_TESTS.values())


@pytest.mark.parametrize("name", ["convex", "general", "ten faces"])
def test_convex(name: str) -> None:
    """No vertex is in front of a facet; so the body has a tetrahedralization."""
    domain = examples.stuck_body(name)
    for a, b, c in np.asarray(domain.facets).tolist():
        rows = domain.points[[a, b, c]]
        assert all(orient([*rows, x]) <= 0 for x in domain.points)


def test_in_general_position_too() -> None:
    """No four points in a plane: a valid cell leaves a body that no cells of its vertices fill, counted."""
    domain = examples.stuck_body("general")
    points = [tuple(map(int, x)) for x in domain.points.tolist()]
    assert all(orient([points[v] for v in four]) != 0 for four in combinations(range(7), 4))
    inward = [plain.lowest(a, c, b) for a, b, c in np.asarray(domain.facets).tolist()]
    steps = list(plain.advancing_front_in_space(points, inward, lambda x: 2.0))
    assert all(step.chosen < 7 for step in steps)  # no points are made
    ways = [len(list(refills(points, frozenset(front)))) for front in (inward, *(s.front for s in steps))]
    assert ways == [25, 5, 1, 0, 0, 0]


def test_the_prism_has_no_cell() -> None:
    """Each four of its points have an edge that is no edge of the body and is outside of it."""
    domain = examples.stuck_body("twisted prism")
    facets = np.asarray(domain.facets)
    edges = {frozenset(pair) for row in facets.tolist() for pair in combinations(row, 2)}
    for four in combinations(range(6), 4):
        beyond = [pair for pair in combinations(four, 2) if frozenset(pair) not in edges]
        assert any(not domain.contains(domain.points[list(pair)].mean(axis=0)) for pair in beyond)


def test_wrong_name() -> None:
    with pytest.raises(InputError, match="octagon"):
        examples.stuck_body("octagon")
