"""Cells of second order in files: they are read by their corners; the nodes between them are left out."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..base.telling import tell
from .periodic import renumbered

__all__ = ["FIRST_ORDER", "without_middles"]

# Kinds of higher order, by meshio's names: the kind of their corners, which come first.
FIRST_ORDER = {
    **dict.fromkeys(["line3", "line4", "line5", "line6"], "line"),
    **dict.fromkeys(["triangle6", "triangle7", "triangle10", "triangle15", "triangle21"], "triangle"),
    **dict.fromkeys(["quad8", "quad9", "quad16", "quad25", "quad36"], "quad"),
    **dict.fromkeys(["tetra10", "tetra20", "tetra35", "tetra56"], "tetra"),
    **dict.fromkeys(["hexahedron20", "hexahedron24", "hexahedron27", "hexahedron64"], "hexahedron"),
    **dict.fromkeys(["wedge12", "wedge15", "wedge18", "wedge40"], "wedge"),
    **dict.fromkeys(["pyramid13", "pyramid14", "pyramid30"], "pyramid"),
}


def without_middles(name: str, arguments: dict[str, Any], middles: np.ndarray) -> dict[str, Any]:
    """Leave out vertices that are only middles of cells, and warn of it.

    Parameters
    ----------
    name : str
        Of the file, for the warning.
    arguments : dict
        Of a `Mesh`: points, simplices or cells, markers, perhaps origin and duplicates.
    middles : ndarray of int
        The nodes that are no corners.

    Returns
    -------
    dict
        ``origin`` counts the nodes of the file.
    """
    points = np.asarray(arguments["points"])
    cells = arguments.get("cells") or {"simplices": arguments["simplices"]}
    gone = np.zeros(len(points), dtype=bool)
    gone[middles.ravel()] = True
    for block in cells.values():
        for rows in block if isinstance(block, list | tuple) else [block]:
            gone[np.asarray(rows).ravel()] = False
    number = np.cumsum(~gone) - 1
    number[gone] = -1
    number = np.append(number, -1)  # the last entry belongs to -1, no vertex
    tell(
        f"{name} has cells of second or higher order: they are read by their corners, and {int(gone.sum())} "
        "nodes between corners are left out",
    )

    def renamed(block: Any) -> Any:
        return [number[row] for row in block] if isinstance(block, list | tuple) else number[block]

    result = {**arguments, "points": points[~gone]}
    if "cells" in arguments:
        result["cells"] = {kind: renamed(block) for kind, block in cells.items()}
    else:
        result["simplices"] = number[arguments["simplices"]]
    result["origin"] = np.asarray(arguments.get("origin", np.arange(len(points))))[~gone]
    copies = np.asarray(arguments.get("duplicates", np.empty((0, 2), dtype=int)))
    result["duplicates"] = number[copies][(number[copies] >= 0).all(axis=1)]
    result["periodic"] = renumbered(arguments.get("periodic", ()), number)
    result["markers"] = {}
    for key, values in arguments["markers"].items():
        if np.ndim(values) == 2:
            kept = ((number[values] >= 0) | (values < 0)).all(axis=1)
            values = number[values[kept]]
        result["markers"][key] = values
    return result
