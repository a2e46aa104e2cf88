"""Two triangles folded at their edge: what the picture says is what another computation finds."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.fold_states import FOLD_SHAPES, fold_state, folded

ANGLES = [*range(50, 151, 20), 110, 15, 165]
FOLDS = (0, 15, 45, 90, 120, 165, 180)


def depth(corners: np.ndarray, p: np.ndarray) -> float:
    """How far p is inside of the sphere whose center is in the plane, from three linear equations."""
    a, b, c = corners
    rows = np.array([b - a, c - a, np.cross(b - a, c - a)])
    center = a + np.linalg.solve(rows, [(b - a) @ (b - a) / 2, (c - a) @ (c - a) / 2, 0.0])
    return float(np.linalg.norm(a - center) - np.linalg.norm(p - center))


@pytest.mark.parametrize("shape", FOLD_SHAPES)
def test_the_whole_range(shape: str) -> None:
    """Proposition 2.7.6: an edge is illegal only if a corner is inside, unless it is folded shut."""
    gamma, seen = FOLD_SHAPES[shape][0], set()
    for delta, fold in product(ANGLES, FOLDS):
        one, pair = fold_state(shape, delta, fold), folded(shape, delta, fold)
        check_frame(one)
        assert pair.legal == (gamma + delta <= 180)
        assert one["caption"].startswith("legal" if pair.legal else "illegal")
        assert one["number"].startswith(f"γ + δ = {gamma + delta}°")
        a, b, c, d = np.array(pair.points, dtype=float)
        for inside, far in zip(pair.inside, (depth(np.array([a, b, c]), d), depth(np.array([a, b, d]), c))):
            assert abs(far) < 1e-9 or inside == (far > 0)
        bad = [item for item in one["items"] if item["kind"] == "circles" and item["role"] == "bad"]
        flat = 2 * (gamma + delta > 180)  # in the plane a circle contains the far corner of the other, or not
        assert sum(len(item["data"]) for item in bad) == sum(pair.inside) + flat
        if fold == 0:
            assert sum(pair.inside) == flat
        if fold < 180:
            assert pair.legal or any(pair.inside)
        seen.add((pair.legal, any(pair.inside)))
    assert {(True, True), (True, False), (False, True)} <= seen  # the converse is false


def test_folded_shut_the_hypothesis_fails() -> None:
    """Two equal obtuse angles: d is on the circle of abc, and neither corner is inside."""
    pair = folded("nasty: very obtuse", 130, 180)
    assert not pair.legal and pair.inside == (False, False)
    said = fold_state("nasty: very obtuse", 130, 180)
    assert said["caption"].endswith("the triangles lie upon each other")
    assert said["number"] == "γ + δ = 260°; of c and d, the deeper is on a sphere"
    assert pair.points[2] != pair.points[3]
    assert all(any(folded(shape, 130, 179).inside) for shape in FOLD_SHAPES)


def test_ties_are_exact() -> None:
    """Angles of 180 degrees together: legal, and in the plane both corners are on the circles."""
    for shape, (gamma, _) in FOLD_SHAPES.items():
        assert folded(shape, 180 - gamma, 0)[2:] == (True, (False, False))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("bent", 90, 0), "shape = 'bent' must be one of 'acute at c'"),
        (("acute at c", 180, 0), "angle_at_d = 180 must be between 0 and 180"),
        (("acute at c", 90, 181), "fold = 181 must be from 0 to 180"),
    ],
)
def test_wrong_arguments(arguments: tuple, said: str) -> None:
    with pytest.raises(InputError, match=said):
        folded(*arguments)
