"""Contrast of colors by WCAG 2, and the colors that a style sheet names."""

from __future__ import annotations

import re
from pathlib import Path

from matplotlib.colors import to_rgb

TEXT, GRAPHIC = 4.5, 3.0  # level AA: text; what else carries meaning


def luminance(color: str) -> float:
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(color))
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one: str, other: str) -> float:
    """From 1 (the same) to 21 (black and white)."""
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def variables(sheets: list[Path], theme: str) -> dict[str, str]:
    """The variables of a theme, "light" or "dark", as a browser has them: later rules replace earlier ones,
    and a variable may name another one."""
    found: dict[str, str] = {}
    rule = re.compile(
        rf"(?:^|(?<=[}},]))\s*html(?:\[data-theme=[\"']?{theme}[\"']?\])?\s*\{{([^}}]*)\}}", flags=re.M
    )
    for sheet in sheets:
        for block in rule.findall(sheet.read_text(encoding="utf-8")):
            found |= {name: value.strip() for name, value in re.findall(r"(--[\w-]+)\s*:\s*([^;]+)", block)}

    def value(name: str) -> str:
        inner = re.fullmatch(r"var\((--[\w-]+)\)", found[name])
        return value(inner[1]) if inner and inner[1] in found else found[name]

    return {name: value(name) for name in found}
