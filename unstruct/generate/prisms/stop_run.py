"""The run of layers that are left out whole where there is no room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.progress import progress_bar
from .records import Rays
from .run import PrismRun
from .stopping import stopped

__all__ = ["StopRun"]


class StopRun(PrismRun):
    """As `PrismRun`, with a number of layers for each ray, whose heights are as wanted."""

    def advance(self) -> None:
        """Give rays directions and numbers of layers; lower these until all is valid."""
        self.begin()
        seen = self.height > 0.0
        whole = self.placed(np.where(seen, self.total, 0.0))
        rise = self.shares * self.total[: len(self.shares), None]  # one row for all, or one for each ray
        rays = np.arange(len(seen))
        every = np.arange(len(self.columns))

        def put(level: NDArray[np.int32]) -> None:
            self.places = whole[np.minimum(np.arange(self.levels + 1)[:, None], level), rays]
            self.height = np.where(seen, rise[np.minimum(rays, len(rise) - 1), level], 0.0)

        def wrong_columns(level: NDArray[np.int32]) -> NDArray[np.int64]:
            put(level)
            return self.columns[self.bad_columns(every, level)].ravel().astype(np.int64)

        def wrong_tops(level: NDArray[np.int32]) -> NDArray[np.int64]:
            put(level)
            return self.wrong_tops()

        with progress_bar(self.options.progress, " rounds") as bar:
            found = stopped(rise, self.edges, (self.height, self.reason), wrong_columns, wrong_tops, bar)
        put(found.level)
        self.rounds = found.rounds
        self.rays = Rays(
            rays.astype(np.int32), self.direction, self.height, self.total, found.level, found.reason
        )
