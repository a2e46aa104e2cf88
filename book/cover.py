"""Draw the picture of the front page: the running region, meshed, and the Voronoi cells of its points.

python book/cover.py       # writes book/cover.png
"""

from __future__ import annotations

from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

import unstruct
from unstruct import view
from unstruct.examples.running import inside_polygon, running_points, running_region, running_size
from unstruct.view.draw.colors import PNG

PICTURE = Path(__file__).parent / "cover.png"


def main() -> None:
    matplotlib.use("Agg")
    view.setup()
    points = running_points(seed=0)
    shore, segments = running_region(running_size)
    mesh = unstruct.delaunay(points)
    lake = mesh.select(inside_polygon(mesh.points[mesh.simplices].mean(axis=1), shore, segments))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6))
    view.plot(lake, left, vertices=False, values=lake.quality("2r/R"), label="shape: 1 is equilateral")
    view.plot_voronoi(mesh, right, delaunay=False, sites=False, vertices=False)
    water = shores(shore, segments)
    for artist in right.collections:
        artist.set_clip_path(water, right.transData)
        artist.set(linewidth=0.8, linestyle="solid")
    right.add_patch(PathPatch(water, fill=False, color=view.ROLES["constrained"].color, lw=1.4))
    for ax in (left, right):
        ax.set(xlim=(-0.05, 3.05), ylim=(-0.05, 2.05))
    figure.savefig(PICTURE, dpi=90, bbox_inches="tight", **PNG)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size / 1000:.0f} kB")


def shores(points: np.ndarray, segments: np.ndarray) -> Outline:
    """The outline as one path: shores follow each other, each a ring that closes on its first point."""
    first = np.flatnonzero(segments[:, 1] < segments[:, 0]) + 1
    rings = np.split(points, first[:-1])
    codes = [[Outline.MOVETO, *[Outline.LINETO] * (len(ring) - 1), Outline.CLOSEPOLY] for ring in rings]
    return Outline(np.concatenate([[*ring, ring[0]] for ring in rings]), np.concatenate(codes))


if __name__ == "__main__":
    main()
