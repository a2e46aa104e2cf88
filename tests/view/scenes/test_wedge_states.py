"""The wedges between two planes: what is said about their sections is what exact signs say."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from unstruct import InputError, Mesh
from unstruct.plain import prisms
from unstruct.view import check_frame
from unstruct.view.scenes.wedge_states import LOWER_TRIANGLE, WEDGES, wedge_coefficients, wedge_state


@pytest.mark.parametrize("wedge", WEDGES)
def test_the_whole_range(wedge: str) -> None:
    """The caption's sign is that of the area, and a wedge is positive exactly if all sections are."""
    b0, b1, b2 = wedge_coefficients(WEDGES[wedge])
    signs = []
    for k in range(21):
        t = Fraction(k, 20)
        area = b0 * (1 - t) ** 2 + 2 * b1 * t * (1 - t) + b2 * t * t
        one = wedge_state(wedge, k / 20)
        check_frame(one)
        word = "positive" if area > 0 else "zero" if area == 0 else "negative"
        number = float(one["number"].split(": ")[1].split(",")[0])
        assert word in one["number"] and abs(number - area) < 0.006
        signs.append(area > 0)
    rows = [(*p, 0) for p in LOWER_TRIANGLE] + [(*p, 3) for p in WEDGES[wedge]]
    positive = prisms.wedge_is_positive(rows[:3], rows[3:])
    mesh = Mesh(np.array(rows, dtype=float), cells={"wedge": [range(6)]})
    assert positive == all(signs) == (mesh.jacobian_signs()[0] == 1)
    assert positive == (wedge not in ("turned by 180 degrees", "six positive corners"))


def test_coefficients_are_those_of_the_plain_criterion() -> None:
    for upper in WEDGES.values():
        base = [(*p, 0) for p in LOWER_TRIANGLE]
        rays = [(*prisms.minus((*q, 0), (*p, 0))[:2], 3) for p, q in zip(LOWER_TRIANGLE, upper)]
        for c0, c1, c2 in prisms.quadratics(base, rays):
            found = [Fraction(c0, 27), (c0 + Fraction(c1, 2)) / 27, Fraction(c0 + c1 + c2, 27)]
            assert found == list(wedge_coefficients(upper))


def test_an_unknown_wedge() -> None:
    with pytest.raises(InputError, match="wedge = 'bent' must be one of 'straight'"):
        wedge_state("bent", 0.5)
