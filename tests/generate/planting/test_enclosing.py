"""Roots and boundaries of domains."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError
from unstruct.generate.planting.enclosing import bounded, domain_of, root_of


def test_what_is_a_domain() -> None:
    disc = Domain.disc()
    assert (
        domain_of(disc, 2) is disc and domain_of([(0, 0), (1, 1)], 2) is None and domain_of(None, 3) is None
    )
    assert len(domain_of(disc.sampled(0.5), 2).curves) == 0
    with pytest.raises(InputError, match="the domain has points of 2 coordinates"):
        domain_of(disc, 3)


def test_roots() -> None:
    ball = Domain.ball(size=1.0)
    root = root_of(ball, ball, None, 3)
    assert np.ptp(root[1] - root[0]) < 1e-15 and (root[0] < ball.bounds[0]).all()
    with pytest.raises(InputError, match="does not contain the domain"):
        root_of(ball, ball, ball.bounds * 0.99, 3)
    assert root_of(ball, ball, ball.bounds, 3).tolist() == ball.bounds.tolist()


def test_pieces() -> None:
    ball, disc = Domain.ball(size=1.0), Domain.disc()
    root = np.array([[-2.0] * 3, [2.0] * 3])
    boundary = bounded(ball, root, 0.1, np.inf, 1000)
    assert boundary.pieces.shape == (len(ball.facets), 3) and boundary.deviation == 0
    assert np.abs(boundary.points).max() <= 1 and boundary.factor == 0.25
    boundary = bounded(disc, root[:, :2], 1e-3, np.inf, 1000)
    assert boundary.deviation == 1e-3 and boundary.contains(np.zeros((1, 2))).all()
