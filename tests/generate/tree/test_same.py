"""Domains that are the same by what they are made of."""

from __future__ import annotations

import numpy as np

from unstruct import Bezier, Domain
from unstruct.generate.tree.same import same_domain

CORNERS = [(0, 0), (1, 0), (1, 1), (0, 1)]
SIDES = [(0, 1), (1, 2), (2, 3), (3, 0)]


def test_what_makes_a_difference() -> None:
    made = [
        lambda: None,
        lambda: Domain(CORNERS, SIDES),
        lambda: Domain(np.array(CORNERS) * 2, SIDES),
        lambda: Domain(CORNERS, SIDES[::-1]),
        lambda: Domain(CORNERS, SIDES, inner=[(0, 2)]),
        lambda: Domain(CORNERS, SIDES, markers={"a": [1]}),
        lambda: Domain(CORNERS, SIDES, markers={"a": [2]}),
        lambda: Domain(CORNERS, SIDES, regions={"a": [(0.5, 0.5)]}),
        lambda: Domain(CORNERS, SIDES, curves={1: Bezier([(1, 0), (1.5, 0.5), (1, 1)])}),
        lambda: Domain(CORNERS, SIDES, curves={1: Bezier([(1, 0), (1.4, 0.5), (1, 1)])}),
        lambda: Domain.box(),
        lambda: Domain.box((0, 0, 0), (1, 1, 2)),
        lambda: Domain.ball(size=0.5),
    ]
    for i, one in enumerate(made):
        for k, other in enumerate(made):
            assert same_domain(one(), other()) == (i == k), (i, k)
