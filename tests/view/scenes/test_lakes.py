"""Three meshes of the lake: what is said of area and shore is so, over all kinds and sizes."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError, check
from unstruct.examples import running_region
from unstruct.view import LAKE_MESHES, check_frame, lake_mesh, lake_state


def percent(part: str) -> float:
    return float(part.split()[-1].replace("−", "-").rstrip("%"))


@pytest.mark.parametrize("size", [0.4, 0.28, 0.2, 0.14, 0.1])
@pytest.mark.parametrize("kind", LAKE_MESHES)
def test_the_whole_range(kind: str, size: float) -> None:
    one, mesh = lake_state(kind, size), lake_mesh(kind, size)
    check_frame(one)
    area, shore = map(percent, one["number"].split(", "))
    points, segments = running_region(0.01)
    length = np.hypot(*(points[segments[:, 1]] - points[segments[:, 0]]).T).sum()
    ends = mesh.points[mesh.boundary]
    assert abs(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() / length - 1 - shore / 100) < 1e-3
    if kind == "triangles":
        assert check(mesh) and "folded" not in one["caption"] and -2 < area <= 0 and -4 < shore < 0
    if kind == "bent grid":
        assert bool(check(mesh)) == ("folded" not in one["caption"]) == (size > 0.3)
        assert area > 0  # folded cells count as positive, too
    if kind == "lattice":
        assert abs(area) < 4 and (size > 0.15 or shore > 15)


def test_stairs_do_not_converge() -> None:
    """Their length tends to the sum of |dx| + |dy|, and not to the length of the shore."""
    points, segments = running_region(0.01)
    step = points[segments[:, 1]] - points[segments[:, 0]]
    limit = np.abs(step).sum()
    found = []
    for size in (0.1, 0.05, 0.02):
        ends = lake_mesh("lattice", size)
        ends = ends.points[ends.boundary]
        found.append(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
    assert abs(found[-1] / limit - 1) < 0.02 and found[-1] > 1.23 * np.hypot(*step.T).sum()


@pytest.mark.parametrize(("kind", "size"), [("hexagons", 0.2), ("lattice", 0.01), ("lattice", float("nan"))])
def test_wrong_arguments(kind: str, size: float) -> None:
    with pytest.raises(InputError, match=r"no kind 'hexagons'|size = .* must lie between"):
        lake_mesh(kind, size)
