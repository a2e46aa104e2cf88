"""Chords in place of curves: as near as is asked, and fine enough for the smallest cell."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Arc, Bezier, Curve, Domain, InputError, quadtree
from unstruct.generate.tree import chords
from unstruct.generate.tree.chords import straightened


@pytest.mark.parametrize("deviation", [1e-1, 1e-3, 1e-6])
def test_a_circle(deviation: float) -> None:
    straight = straightened(Domain.disc(), deviation)
    ends = straight.domain.points[straight.domain.facets]
    sagitta = 1 - np.sqrt((ends.mean(axis=1) ** 2).sum(axis=1))
    assert sagitta.max() <= deviation
    # no more than halving to the next power of two makes: at most four times less than asked
    assert deviation == 1e-1 or sagitta.max() > deviation / 4.1
    assert len(straight.piece) == len(ends) and not straight.domain.curves


def test_turn() -> None:
    straight = straightened(Domain.disc(), 1.0, np.radians(3.0))
    assert 120 <= len(straight.domain.facets) <= 256


def test_no_more_chords_for_the_turn_than_are_allowed() -> None:
    straight = straightened(Domain.disc(), 1.0, np.radians(0.01), 1000)
    assert 500 < len(straight.domain.facets) <= 1000
    assert len(straightened(Domain.disc(), 1e-6, np.radians(0.01), 1000).domain.facets) > 1000  # for these


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("limit", [{"budget": 1000}, {"max_level": 5}])
def test_a_budget_bounds_the_chords_of_turning(limit: dict) -> None:
    """A thousandth of a degree took 2.9 million chords and 3 GB, for 900 leaves; the tree is the same."""
    tree = quadtree(Domain.disc(), turning=0.001, **limit)
    assert tree.boundary is not None and len(tree.boundary.pieces) <= 1 << 15
    assert not tree.complete and tree == quadtree(Domain.disc(), turning=0.03, **limit)


def test_straight_pieces_stay_whole_and_pieces_are_known() -> None:
    points = [(0, 0), (2, 0), (2, 1), (0, 1)]
    ends = [(0, 1), (1, 2), (2, 3), (3, 0)]
    bend = Bezier([(2, 1), (1.5, 2), (0.5, 0.5), (0, 1)])
    straight = straightened(Domain(points, ends, curves={2: bend}, markers={"top": [2]}), 1e-4)
    assert [(straight.piece == k).sum() for k in (0, 1, 3)] == [1, 1, 1]
    assert (straight.piece == 2).sum() == len(straight.domain.facets) - 3 > 16
    t = np.linspace(0, 1, 2000)
    x = bend.point(t)
    chain = straight.domain.points[straight.domain.facets[straight.piece == 2]]
    u, away = chain[:, 1] - chain[:, 0], x[:, None] - chain[:, 0]
    s = np.clip((away * u).sum(axis=2) / (u * u).sum(axis=1), 0, 1)
    gaps = np.sqrt(((away - s[..., None] * u) ** 2).sum(axis=2)).min(axis=1)
    assert gaps.max() <= 1.01e-4


def test_too_many_chords(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chords, "MOST_CHORDS", 100)
    with pytest.raises(
        InputError, match="more than 100 chords are needed to follow the curves to within 1e-06"
    ):
        straightened(Domain.disc(), 1e-6)


def test_a_kink_ends() -> None:
    def function(t):
        return np.column_stack([t, np.abs(t - 0.4375)])

    points = [(0, 0.4375), (1, 0.5625), (1, 2), (0, 2)]
    domain = Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0)], curves={0: Curve(function)})
    assert len(straightened(domain, 1e-9).domain.facets) < 100


def state_of_disc(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """States of boxes for the unit circle, and how far each is from another state."""
    near = np.clip(0.0, low, high)
    far = np.maximum(np.abs(low), np.abs(high))
    least, most = np.sqrt((near * near).sum(axis=1)), np.sqrt((far * far).sum(axis=1))
    state = np.where(most < 1, 1, np.where(least > 1, -1, 0))
    return state, np.minimum(np.abs(most - 1), np.abs(least - 1))


@pytest.mark.parametrize("options", [{"boundary_size": 0.1}, {"boundary_size": 0.002}, {"size": 0.05},
                                     {"turning": 3.0}])  # fmt: skip
def test_states_are_those_of_the_circle_up_to_the_deviation(options: dict) -> None:
    tree = quadtree(Domain.disc(), **options)
    expected, margin = state_of_disc(*tree.corners)
    wrong = expected != tree.states
    assert tree.boundary.deviation <= tree.sides.min() / 64
    assert (margin[wrong] <= tree.boundary.deviation).all() and wrong.mean() < 0.02


def test_curves_are_cut_again_for_small_cells() -> None:
    points = [(0.8, 0.6), (0.8, 0.6 + 4e-9)]
    tree = quadtree(Domain.disc(), points=points)
    assert tree.depth > 25 and len(tree.boundary.pieces) > 10_000
    arc = Domain([(0, 0), (1, 0)], [(0, 1), (1, 0)], curves={0: Arc((0.5, 0), 0.5, np.pi, np.pi)})
    assert quadtree(arc, 0.1).boundary.deviation > 0
    assert quadtree(Domain.polygon([(0, 0), (1, 0), (0, 1)]), 0.1).boundary.deviation == 0
