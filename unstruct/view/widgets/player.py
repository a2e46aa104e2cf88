"""The step-by-step player: Python computes the frames, and a small anywidget shows them one by one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import anywidget
import matplotlib.pyplot as plt
import traitlets

from ...base.errors import InputError
from ..draw import frames as fr
from ..draw.colors import styles
from ..draw.stills import STILL_DPI, picture_of, with_still
from ..draw.strips import draw

__all__ = ["Player", "player"]

WIDGET_FOLDER = Path(__file__).parent


class Player(anywidget.AnyWidget):
    """Buttons, a slider and the arrow keys step through ``frames``; see `player`.

    Attributes
    ----------
    frames : list of dict
        The frames; see `unstruct.view.draw.frames`.
    index : int
        The number of the frame that is shown.
    view : list of float
        The fixed window ``[xmin, xmax, ymin, ymax]``.
    alt : str
        A sentence for readers who cannot see the picture.
    variants : list of dict
        Several histories instead of one, each ``{"name": …, "frames": …, "view": …}``.
    variant : int
        The number of the history that is shown.
    grid : list of dict
        For a player made by `panel`, each parameter: ``{"label": …, "values": […], "list": …, "start": …}``.
    packed : str
        The histories of a panel for all combinations of its parameters, compressed; ``variant`` selects one.
    dragged : dict
        The last drag of a point with a handle: ``{"handle": name, "x": …, "y": …}``.
    """

    _esm = WIDGET_FOLDER / "player.js"
    _css = WIDGET_FOLDER.parent / "draw" / "player.css"
    frames: Any = traitlets.List().tag(sync=True)
    index = traitlets.Int(0).tag(sync=True)
    view: Any = traitlets.List().tag(sync=True)
    alt = traitlets.Unicode().tag(sync=True)
    width = traitlets.Int(480).tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)
    interval = traitlets.Int(900).tag(sync=True)
    variants: Any = traitlets.List().tag(sync=True)
    variant = traitlets.Int(0).tag(sync=True)
    grid: Any = traitlets.List().tag(sync=True)
    packed = traitlets.Unicode().tag(sync=True)
    styles = traitlets.Dict().tag(sync=True)
    dragged = traitlets.Dict().tag(sync=True)

    def show(self, frames: Sequence[fr.Frame], index: int | None = None) -> None:
        """Replace the frames and show one of them; the window remains unless the first frame has one."""
        with self.hold_sync():
            if "view" in frames[0]:
                self.view = fr.bounds(frames)
            self.frames = compact(frames, self.view)
            self.index = min(self.index if index is None else index, len(self.frames) - 1)

    def still(self) -> bytes:
        """The frame that is shown, with its caption, as the bytes of a PNG file."""
        one = self.frames[self.index]
        ax = plt.subplots(figsize=(self.width / STILL_DPI, self.height / STILL_DPI), dpi=STILL_DPI)[1]
        draw(one, ax, view=self.view)
        ax.set_title(one["caption"], wrap=True)
        return picture_of(ax)

    def _repr_mimebundle_(self, **_: Any) -> Any:
        return with_still(super()._repr_mimebundle_(), self.still())

    def __repr__(self) -> str:
        return f"Player({len(self.frames)} frame{'s' * (len(self.frames) != 1)}: {self.alt})"


def player(
    frames: Sequence[fr.Frame],
    *,
    alt: str,
    view: Sequence[float] | None = None,
    width: int = 480,
    height: int = 420,
    interval: int = 900,
) -> Player:
    """Step through the frames of a history, in JupyterLab and on a page without a kernel.

    Parameters
    ----------
    frames : sequence of dict
        The history, with one change per frame; see `unstruct.view.draw.frames`.
    alt : str
        A sentence for readers who cannot see the pictures; the caption of each frame is added to it.
    view : (xmin, xmax, ymin, ymax), optional
        The fixed window; by default it contains the items of all frames.
    width, height : int
        The largest size of the picture, in pixels.
    interval : int
        Milliseconds between two frames while the player runs.

    Returns
    -------
    Player

    Raises
    ------
    InputError
        If there are no frames, if ``alt`` is empty, or if a frame cannot be drawn (the item is named).
    """
    if not frames:
        raise InputError("a player needs at least one frame")
    if not alt.strip():
        raise InputError("alt must describe the pictures for readers who cannot see them")
    for one in frames:
        fr.check_frame(one)
    window = fr.bounds(frames) if view is None else [float(v) for v in view]
    return Player(
        frames=compact(frames, window),
        view=window,
        alt=alt.strip(),
        width=width,
        height=height,
        interval=interval,
        styles=styles(),
    )


def compact(frames: Sequence[fr.Frame], view: Sequence[float]) -> list[fr.Frame]:
    """The frames with coordinates rounded to a ten-thousandth of the window, a fifth of the bytes."""
    size = max(view[1] - view[0], view[3] - view[2])
    digits = 4 - math.floor(math.log10(size))

    def rounded(value: Any) -> Any:
        return [rounded(v) for v in value] if isinstance(value, list) else round(value, digits)

    return [{**f, "items": [{**i, "data": rounded(i["data"])} for i in f["items"]]} for f in frames]
