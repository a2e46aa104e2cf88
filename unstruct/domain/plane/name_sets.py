"""Which names each piece has, as one number per piece: pieces with equal numbers have equal names."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

__all__ = ["name_sets"]


def name_sets(markers: Mapping[str, np.ndarray], many: int) -> tuple[np.ndarray, list[frozenset[str]]]:
    """The number of each piece's set of names, (many,) int64, and the sets; pieces without names have 0.

    Each name divides the sets that its pieces have had so far, so that all names together take a time
    proportional to the entries of ``markers``, up to sorting.
    """
    label = np.zeros(many, dtype=np.int64)
    sets: list[frozenset[str]] = [frozenset()]
    for name, pieces in markers.items():
        old, back = np.unique(label[pieces], return_inverse=True)
        label[pieces] = len(sets) + back
        sets += [sets[k] | {name} for k in old.tolist()]
    return label, sets
