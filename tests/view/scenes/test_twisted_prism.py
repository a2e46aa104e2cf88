"""The twisted prism: what the captions say is true."""

from __future__ import annotations

import pytest

from unstruct.plain import refilling as plain
from unstruct.view import check_frame
from unstruct.view.scenes.twisted_prism import TWISTED_WALLS, twisted_prism, twisted_prism_state


@pytest.mark.parametrize("twist", range(-60, 60, 10))
def test_the_twisted_prism(twist: int) -> None:
    """Tetrahedra fit exactly where the exhaustive search finds some."""
    one = twisted_prism_state(twist, 40)
    check_frame(one)
    rows = twisted_prism(twist).round(9).tolist()
    inward = frozenset(least_first((a, c, b)) for a, b, c in TWISTED_WALLS)
    ways = len(list(plain.refills(rows, inward))) if twist else 0  # all sides flat: by symmetry none
    assert ways == (0 if twist >= 0 else 3 if twist == -60 else 6)
    where = "inside: four" if twist < 0 else "outside: no" if twist else "on its sides: no"
    assert f"are {where} " in one["number"]


def least_first(face: tuple[int, int, int]) -> tuple[int, int, int]:
    k = face.index(min(face))
    return face[k], face[(k + 1) % 3], face[(k + 2) % 3]
