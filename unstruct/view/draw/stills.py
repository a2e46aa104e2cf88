"""Still pictures beside widgets: what a page shows until a kernel has drawn the widget."""

from __future__ import annotations

import base64
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from .colors import png

__all__ = ["STILL_DPI", "picture_of", "with_still"]

STILL_DPI = 90  # of a still picture, per inch


def picture_of(ax: Axes) -> bytes:
    """The figure of ``ax`` as the bytes of a PNG file; the figure is closed."""
    figure: Any = ax.figure  # never a part of one
    data = png(figure)
    plt.close(figure)
    return data


def with_still(shown: Any, still: bytes) -> Any:
    """What a widget gives a notebook to show (a dict, or a pair with one), with a picture in it.

    JupyterLab prefers the live view, and takes the picture as long as there is none.
    """
    data = shown[0] if isinstance(shown, tuple) else shown
    if data is not None:
        data["image/png"] = base64.b64encode(still).decode("ascii")
    return shown
