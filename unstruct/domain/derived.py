"""Domains derived from a domain: fewer vertices, or the subsegments of its pieces."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Self

import numpy as np

from ..geometry.outline import Outline
from .arguments import composed
from .plane.account import Repair
from .plane.sample import Sampled
from .sides import SIDES, Side

__all__ = ["Derived"]


class Derived(Outline):
    """What a `Domain` knows about its input, and the domains that follow from it."""

    origin: np.ndarray
    piece_origin: np.ndarray
    repairs: list[Repair]
    max_areas: dict[str, float]
    hole_seeds: np.ndarray

    @property
    def dimension(self) -> int:
        """The number of coordinates: 2."""
        return self.points.shape[1]

    @property
    def _side(self) -> Side:
        return SIDES[self.dimension]

    @cached_property
    def _coarse(self) -> Sampled:
        return self._side.coarse(self)

    def simplified(self, tolerance: float | None = None, *, size: Any = None) -> Self:
        """The region with fewer vertices on its straight pieces; it stays valid, and there is an account.

        Parameters
        ----------
        tolerance : float, optional
            How far old and new pieces may be from each other (Hausdorff distance). As many vertices as
            possible are dropped, those with the least deviation first.
        size : number, function (k, 2) -> (k,), or size field, optional
            The wanted edge length: only vertices at pieces shorter than 3/4 of it are dropped. Without a
            tolerance they may be half of it away from the new pieces.

        Returns
        -------
        Domain
            Nothing crosses, and rings keep their nesting; loose vertices and seeds stay on their side, by
            exact signs. Curves, and vertices where pieces branch or change their names, stay. Only rings
            smaller than the tolerance are dropped, unless they enclose anything that stays or are the last
            of a name. `repairs` lists all that was dropped; `origin` and `piece_origin` refer to the input
            of this domain, and a new piece to the first of those that it replaces.

        Raises
        ------
        InputError
            Without a tolerance or a size, and if the whole region is smaller than the tolerance.

        Notes
        -----
        A vertex is dropped if the closed triangle with its neighbors is empty (after M. Visvalingam, J. D.
        Whyatt, *Line generalisation by repeated elimination of points*, 1993). Book: 2.6d.
        """
        found = self._side.simplified(self, self._coarse, tolerance, size)
        make: Any = type(self)
        return self.followed(make(**found.parts), found.origin, found.piece_origin, found.repairs)

    def followed(self, new: Any, origin: Any, pieces: Any, repairs: Any = ()) -> Any:
        """A new domain made of parts of this one, with what this one knows about its input.

        Parameters
        ----------
        new : Domain
        origin, pieces : array_like of int
            The vertex and the piece of this domain that each vertex and piece of the new one comes from.
        repairs : sequence of Repair
            What was done.
        """
        new.origin, new.piece_origin = composed(self.origin, origin), composed(self.piece_origin, pieces)
        new.hole_seeds = self.hole_seeds
        new.repairs, new.max_areas = [*self.repairs, *repairs], dict(self.max_areas)
        return new
