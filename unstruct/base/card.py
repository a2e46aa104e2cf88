"""The frame of what a notebook shows for an object: a small inline SVG and a table, without matplotlib."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

import numpy as np

__all__ = ["card", "to_pixels"]

CARD_SIDE = 200  # width and height of the picture
MARGIN = 6  # pixels that stay free on each side


def card(label: str, drawing: str, rows: Iterable[tuple[str, int | str]]) -> str:
    """An HTML card: a picture with a label for readers who cannot see it, and a table beside it.

    Parameters
    ----------
    label : str
    drawing : str
        SVG elements, in pixels; see `to_pixels`.
    rows : iterable of (name, value)
        Counts or texts.
    """
    label = escape(label, quote=True)
    table = "".join(
        f"<tr><td style='text-align:left'>{escape(name)}</td>"
        f"<td style='text-align:right'>{f'{value:,}' if isinstance(value, int) else escape(value)}</td></tr>"
        for name, value in rows
    )
    return (
        "<div style='display:flex;align-items:center;gap:1em'>"
        f"<svg role='img' aria-label='{label}' width='{CARD_SIDE}' height='{CARD_SIDE}' "
        f"viewBox='0 0 {CARD_SIDE} {CARD_SIDE}' style='background:white'><title>{label}</title>"
        f"{drawing}</svg><table>{table}</table></div>"
    )


def to_pixels(points: np.ndarray) -> np.ndarray:
    """Points of the plane, (..., 2), in pixels: they fill the picture, and y points up."""
    if points.size == 0:
        return points
    largest = np.abs(points).max()
    points = points / largest if largest > 0 else points  # so that nothing overflows
    rows = points.reshape(-1, 2)
    low, high = rows.min(axis=0), rows.max(axis=0)
    span = (high - low).max()
    scale = (CARD_SIDE - 2 * MARGIN) / span if span > 0 else 1.0
    return (points - (low + high) / 2) * scale * [1, -1] + CARD_SIDE / 2
