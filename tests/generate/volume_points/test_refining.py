"""refine in space: valid meshes of the domain, limits met, and the truth about those that are not."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from unstruct import Domain, DomainMesh, IncompleteWarning, check, refine


def refined(domain: Domain, *args: Any, **options: Any) -> DomainMesh:
    """The mesh, after `check`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = refine(domain, *args, **options)
    report = check(mesh, domain=domain)
    assert report, report
    return mesh


@pytest.mark.parametrize("h", [0.5, 0.2])
def test_a_box(h: float) -> None:
    mesh = refined(Domain.box(), h)
    assert mesh.complete
    ends = mesh.points[mesh.edges]
    assert np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max() <= np.sqrt(2) * h * (1 + 1e-9)
