"""The widget of circumcenter insertion."""

from __future__ import annotations

from ..scenes.centers import CENTERS, circumcenter_history
from .widgets import Panel, chosen

__all__ = ["circumcenters"]


def circumcenters() -> Panel:
    """Step through circumcenter insertion: without boundary, edges kept, edges split. Book: 2.6a."""
    histories = {name: circumcenter_history(name) for name in CENTERS}
    return chosen(
        histories,
        "Triangulations, each with its maximal triangle, the circle of it, and the next point.",
    )
