"""A point in six tetrahedra: what is hidden, against the plain version."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError, check
from unstruct.plain import modernized as plain
from unstruct.view import check_frame
from unstruct.view.scenes.hidden_facets import hidden_facet_state, hiding_mesh, hiding_place


def test_the_mesh_is_valid_and_not_delaunay() -> None:
    assert check(hiding_mesh()) and not check(hiding_mesh(), delaunay=True)


@pytest.mark.parametrize("place", np.linspace(0.05, 0.95, 13))
def test_the_whole_range(place: float) -> None:
    mesh = hiding_mesh()
    cells = mesh.simplices.tolist()
    rows = [*mesh.points.tolist(), hiding_place(place).tolist()]
    step = plain.insert(rows, cells, 6)
    hidden = plain.hidden(plain.exact_points(rows), map(tuple, cells), step.component, 6)
    for azimuth in (-160.0, 0.0, 160.0):
        one = hidden_facet_state(place, azimuth)
        check_frame(one)
        numbers = [int(part.split("= ")[1]) for part in one["number"].split(", ")]
        assert numbers == [len(step.component), len(hidden), len(step.deleted)]
        named = one["caption"].removeprefix("hidden from P: ").split(", ")
        expected = {" ".join(map(str, sorted(facet))) for _, facet in hidden}
        assert set(named) == (expected or {"all facets are seen"})


@pytest.mark.parametrize("place", [0.0, 1.0])
def test_wrong_places(place: float) -> None:
    with pytest.raises(InputError, match=r"place = .* must lie between 0.05"):
        hidden_facet_state(place)
