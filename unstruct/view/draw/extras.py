"""The packages that pictures and widgets need: without them, an error says what to install."""

from __future__ import annotations

from ...base.optional import optional

__all__ = ["NEEDED"]

NEEDED = tuple(optional(module, "unstruct.view") for module in ("matplotlib", "anywidget", "ipywidgets"))
