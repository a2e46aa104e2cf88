"""The colors and line styles of all figures, players and widgets of the book.

A *role* says what an object is, such as "cell" or "cavity", and gives it its look. The colors are those of
Okabe and Ito (2008), with a few of Paul Tol's, some of them darkened: lines stand out from the paper and from
plain cells by at least 3 to 1, names by 4.5 to 1 (WCAG 2 AA), but for "muted", which is what no longer
matters. No two roles differ by color alone: width, dash and marker differ, too, so that a print in gray can
be read.
"""

from __future__ import annotations

import io
import warnings
from dataclasses import asdict, dataclass
from typing import Any

import matplotlib
from cycler import cycler
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from PIL import Image

from ...base.errors import IncompleteWarning

__all__ = ["PAPER", "ROLES", "Style", "line_style", "png", "role", "setup", "styles"]

PAPER = "#ffffff"  # the background of every picture, on light and on dark pages
DPI = 90
INK = 1.05 / 4.5 - 0.05  # the luminance that stands out from white paper by 4.5 to 1


PNG: dict[str, Any] = {"facecolor": PAPER, "metadata": {"Software": None}}  # the file contains no version


@dataclass(frozen=True)
class Style:
    """The style in which a role is drawn.

    Attributes
    ----------
    color : str
        Color of lines and markers, ``#rrggbb``.
    width : float
        Width of lines, in points.
    dash : tuple of float
        Lengths of dashes and gaps in points (on, off, on, …); empty for a solid line.
    marker : str
        matplotlib's character for the marker, one of ``o s D ^ v < > * X P p h .``.
    size : float
        Diameter of the marker, in points.
    fill : str
        Color inside polygons.
    alpha : float
        Opacity of that color, from 0 (transparent) to 1.
    hatch : str
        ``""``, ``"/"``, ``"x"`` or ``"."``, drawn over the fill in the role's color.
    """

    color: str
    width: float
    dash: tuple[float, ...]
    marker: str
    size: float
    fill: str
    alpha: float
    hatch: str = ""

    @property
    def ink(self) -> str:
        """The color of names: that of the lines, darkened until a small text can be read on paper."""
        color = self.color
        while _luminance(color) > INK:
            r, g, b = to_rgb(color)
            color = to_hex((0.98 * r, 0.98 * g, 0.98 * b))
        return color


def _luminance(color: str) -> float:
    """How light a color is by WCAG 2, from 0 (black) to 1 (white)."""
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(color))
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


ROLES: dict[str, Style] = {
    "cell": Style("#84898e", 0.8, (), ".", 4.0, "#eef1f4", 1.0),
    "muted": Style("#b8bcc0", 0.7, (3, 2), ".", 3.0, "#f6f7f8", 1.0),
    "edge": Style("#55595d", 1.0, (), ".", 5.0, "#ffffff", 0.0),
    "constrained": Style("#000000", 2.6, (), "s", 6.0, "#ffffff", 0.0),
    "vertex": Style("#1a1a1a", 1.2, (), "o", 5.0, "#1a1a1a", 0.15),
    "inserted": Style("#af4d00", 1.7, (), "*", 12.0, "#d55e00", 0.20),
    "cavity": Style("#b67e00", 2.2, (), "h", 7.0, "#e69f00", 0.38, "/"),
    "circumcircle": Style("#0072b2", 1.2, (5, 3), "P", 7.0, "#0072b2", 0.05),
    "voronoi": Style("#009e73", 1.6, (8, 2, 2, 2), "D", 5.5, "#009e73", 0.10),
    "accepted": Style("#2a7aad", 1.4, (), "^", 7.0, "#56b4e9", 0.50),
    "waiting": Style("#948700", 1.1, (1.5, 1.5), "v", 7.0, "#f0e442", 0.45, "."),
    "front": Style("#882255", 2.8, (7, 2), "<", 7.0, "#882255", 0.15),
    "layer": Style("#332288", 1.3, (2.5, 1.5), ">", 6.5, "#332288", 0.15),
    "highlight": Style("#b46a93", 3.2, (), "p", 9.0, "#cc79a7", 0.45),
    "bad": Style("#b2182b", 2.0, (3, 1.5), "X", 9.0, "#b2182b", 0.22, "x"),
}


def role(name: str) -> Style:
    """The style of a role; for an unknown name, a ``KeyError`` lists the known ones."""
    try:
        return ROLES[name]
    except KeyError:
        raise KeyError(f"no role {name!r}; use one of {', '.join(sorted(ROLES))}") from None


def line_style(name: str) -> dict[str, Any]:
    """Keyword arguments that give a matplotlib line or collection the look of a role."""
    style = role(name)
    # matplotlib scales dashes by the width of the line; here they are given in points, as in the players.
    dash = (0, tuple(d / style.width for d in style.dash)) if style.dash else "solid"
    return {"color": style.color, "linewidth": style.width, "linestyle": dash}


def styles() -> dict[str, dict[str, Any]]:
    """All roles as plain dictionaries, for the players' JavaScript."""
    return {
        name: {**asdict(style), "dash": list(style.dash), "ink": style.ink} for name, style in ROLES.items()
    }


def setup() -> None:
    """Set the style of matplotlib for the book; every notebook calls this first.

    Pictures are PNG files on opaque white at 90 dots per inch, with at most 256 colors and without a version
    or date, so that a notebook that is run twice stores the same bytes. Outside IPython only the style is
    set. The pages stop many methods early, to show what they have done so far, and say so; hence
    `unstruct.IncompleteWarning` is turned off.
    """
    warnings.simplefilter("ignore", IncompleteWarning)
    try:
        from IPython import get_ipython
    except ImportError:  # without IPython only the style is set
        shell = None
    else:
        shell = get_ipython()
    if shell is not None:
        shell.enable_matplotlib("inline")
        shell.display_formatter.formatters["image/png"].for_type(Figure, png)
    matplotlib.rcParams.update(RC)


def png(figure: Figure) -> bytes:
    """A figure as the bytes of a PNG file, cropped to its contents, with at most 256 colors."""
    full = io.BytesIO()
    figure.savefig(full, format="png", bbox_inches="tight", pad_inches=0.06, **PNG)
    with Image.open(full) as picture:
        few = picture.convert("RGB").quantize(
            256, Image.Quantize.MEDIANCUT, kmeans=1, dither=Image.Dither.NONE
        )
    small = io.BytesIO()
    few.save(small, format="png", optimize=True)
    return small.getvalue()


RC: Any = {
    "figure.dpi": DPI,
    "savefig.dpi": DPI,
    "figure.figsize": (6.0, 3.6),
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "savefig.facecolor": PAPER,
    "savefig.transparent": False,
    "figure.constrained_layout.use": True,
    "font.family": "DejaVu Sans",  # this font comes with matplotlib, so it is the same on every machine
    "font.size": 9.5,
    "axes.titlesize": 10,
    "axes.labelsize": 9.5,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.prop_cycle": cycler(
        color=["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#332288", "#b07800"],
        linestyle=["-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1, 1, 1))],
    ),
    "image.cmap": "cividis",
    "hatch.linewidth": 0.5,
    "lines.scale_dashes": True,
    "svg.hashsalt": "unstruct",
}
