"""A player with sliders and lists: the frames for all their values are computed beforehand.

So it moves in JupyterLab and, without a kernel, on the website. `panel` calls a pure function for every point
of a grid of parameters; the player's own script chooses among the results.
"""

from __future__ import annotations

import base64
import itertools
import json
import zlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...base.errors import InputError
from ..draw import frames as fr
from .player import Player, compact, player

__all__ = ["panel"]

CONTROLS = 3
MOST_STATES = 3000


def panel(
    state: Callable[..., fr.Frame | Sequence[fr.Frame]],
    grid: Mapping[str, Sequence[Any]],
    *,
    alt: str,
    start: Mapping[str, Any] | None = None,
    labels: Mapping[str, str] | None = None,
    view: Sequence[float] | None = None,
    width: int = 480,
    height: int = 420,
    interval: int = 900,
) -> Player:
    """Up to three sliders and drop-down lists that move a picture, with or without a kernel.

    ``state`` is called once for every combination of the values in ``grid``, when the panel is made. Equal
    items of different frames (the same mesh under a moving point) are stored once, and everything is
    compressed. If a frame has points with handles, the reader can drag them: the player goes to the
    combination whose frame has the handle nearest to the pointer; drop-down lists keep their values.

    Parameters
    ----------
    state : function
        ``state(name=value, ...)`` gives a frame, or a list of frames that the player steps through; see
        `unstruct.view.frames`. It must depend on its arguments only.
    grid : dict
        For each parameter (one to three) the sequence of its values. Numbers make a slider, anything else a
        drop-down list, for example of presets.
    alt : str
        A sentence for readers who cannot see the picture; the caption of each frame is added to it.
    start : dict, optional
        The values at the beginning and after a reset; by default the first of each sequence.
    labels : dict, optional
        What stands beside the controls; by default the names of the parameters, with spaces.
    view : (xmin, xmax, ymin, ymax), optional
        The fixed window; by default it contains the items of all frames.
    width, height : int
        The largest size of the picture, in pixels.
    interval : int
        Milliseconds between two frames while the player runs.

    Returns
    -------
    Player
        The number ``variant`` says which combination is shown, the last parameter running fastest.

    Raises
    ------
    InputError
        If ``grid`` is empty or too large, if ``start`` or ``labels`` do not fit it, or if a frame cannot be
        drawn (the parameters are named).

    Notes
    -----
    The time is that of one call of ``state`` for each combination, the size grows with what differs between
    the frames: 12 × 8 frames of 67 triangles that all move take 86 kB; 3 kB if they stay, and a point and a
    circle move. The window is fixed, and coordinates are rounded to a ten-thousandth of it.
    """
    names = list(grid)
    values = [[plain(value) for value in grid[name]] for name in names]
    check_grid(names, values)
    chosen = {name: column[0] for name, column in zip(names, values)}
    for given, what in ((start or {}, "start"), (labels or {}, "labels")):
        for name in given:
            if name not in chosen:
                raise InputError(f"{what} names {name!r}, which is no parameter of the grid {names}")
    chosen |= {name: plain(value) for name, value in (start or {}).items()}
    for name, column in zip(names, values):
        if chosen[name] not in column:
            raise InputError(f"start has {name}={chosen[name]!r}, which is not in the grid: {column}")
    points = list(itertools.product(*values))
    histories = [history(state, dict(zip(names, point))) for point in points]
    window = fr.bounds([one for frames in histories for one in frames]) if view is None else view
    first = points.index(tuple(chosen[name] for name in names))
    sizes = {"width": width, "height": height, "interval": interval}
    made = player(histories[first], alt=alt, view=window, **sizes)
    made.packed = packed(histories, made.view)
    made.grid = [
        {
            "label": (labels or {}).get(name, name.replace("_", " ")),
            "values": [text(value) for value in column],
            "list": not all(numeric(value) for value in column),
            "start": column.index(chosen[name]),
        }
        for name, column in zip(names, values)
    ]
    made.variant = first
    return made


def check_grid(names: Sequence[str], values: Sequence[Sequence[Any]]) -> None:
    """Raise `InputError` unless there are one to three parameters with few enough values."""
    if not 1 <= len(names) <= CONTROLS:
        raise InputError(f"a panel has one to {CONTROLS} parameters, not {len(names)}")
    for name, column in zip(names, values):
        if len(column) < 2:
            raise InputError(f"the parameter {name} needs at least two values, not {len(column)}")
        if len(set(column)) < len(column):
            raise InputError(f"the parameter {name} has a value twice: {column}")
    count = int(np.prod([len(column) for column in values]))
    if count > MOST_STATES:
        raise InputError(
            f"the grid has {count} combinations; take fewer values: at most {MOST_STATES} can be computed"
        )


def history(
    state: Callable[..., fr.Frame | Sequence[fr.Frame]], parameters: dict[str, Any]
) -> list[fr.Frame]:
    """The frames for one combination of parameters, each one checked."""
    found = state(**parameters)
    frames = [found] if isinstance(found, dict) else list(found)
    where = f"state({', '.join(f'{name}={value!r}' for name, value in parameters.items())})"
    if not frames:
        raise InputError(f"{where} gives no frame")
    for one in frames:
        try:
            fr.check_frame(one)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
    return frames


def packed(histories: Sequence[Sequence[fr.Frame]], window: Sequence[float]) -> str:
    """All frames as one text: equal items once, compressed, in letters that a notebook can store."""
    table: dict[str, int] = {}
    lists = [
        [
            {
                "caption": one["caption"],
                "number": one["number"],
                "items": [
                    table.setdefault(json.dumps(item, separators=(",", ":")), len(table))
                    for item in one["items"]
                ],
            }
            for one in compact(frames, window)
        ]
        for frames in histories
    ]
    whole = f'{{"items":[{",".join(table)}],"histories":{json.dumps(lists, separators=(",", ":"))}}}'
    return base64.b64encode(zlib.compress(whole.encode(), 9)).decode()


def plain(value: Any) -> Any:
    """A number of numpy as one of Python; everything else as it is."""
    return value.item() if isinstance(value, np.generic) else value


def numeric(value: Any) -> bool:
    """Whether a value belongs on a slider."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def text(value: Any) -> str:
    """A value as the reader sees it."""
    return f"{value:g}" if numeric(value) else str(value)
