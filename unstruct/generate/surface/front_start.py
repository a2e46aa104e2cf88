"""What the front on a surface starts from: its curves, cut evenly, with an edge for each side."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.support import Support
from ...geometry.support_features import side_groups
from ...sizing.field import SizeField

__all__ = ["CutCurves", "cut_curves", "sides_of_curves"]

Array = NDArray[np.float64]
NO_LENGTH = 1e3  # scaled: no length
PROBES_OF_FEATURES = 8  # places in each feature edge, and in each wanted length, where the size is asked
