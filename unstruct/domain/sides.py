"""The functions of a `Domain` that depend on its dimension."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..geometry.outline import Outline
from .plane import faults, inside, seeds
from .plane.repaired import Repaired, repaired
from .plane.sample import Sampled
from .plane.simplify import Simplified, simplified

__all__ = ["SIDES", "Side"]


class Side(NamedTuple):
    """The functions for one dimension."""

    repaired: Callable[[Outline], Repaired]
    find_faults: Callable[[Outline], list[faults.Fault]]
    check_ends: Callable[[Outline], None]
    check_seeds_off_pieces: Callable[[Outline], None]
    check_seeds: Callable[[Outline, Sampled], None]
    coarse: Callable[[Outline], Sampled]
    sized: Callable[[Outline, Any, float], Sampled]
    contains: Callable[[Outline, Sampled, np.ndarray], np.ndarray]
    area: Callable[[Outline, Sampled], float]
    bounds: Callable[[Outline, Sampled], np.ndarray]
    simplified: Callable[[Outline, Sampled, Any, Any], Simplified]


PLANE = Side(
    repaired,
    faults.find_faults,
    faults.check_ends,
    seeds.check_seeds_off_pieces,
    seeds.check_seeds,
    seeds.coarse,
    seeds.sized,
    inside.contains,
    inside.area,
    inside.bounds,
    simplified,
)
SIDES = {2: PLANE}
