"""`advancing_front` for a body in space by a metric: the run, and what is measured of the result."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...sizing.space_metric import SpaceMetric
from ...sizing.space_metric_table import scaled_nodes
from ..bodies.dividing import divided
from ..bodies.laying import Filler
from ..bodies.tetrahedralize import as_parts
from ..volume.filling import filled
from ..volume.improving import improved
from ..volume.lattice import MOST_INNER
from . import ledger as book
from .metric_count import expected_cells, refuse_too_many_cells
from .metric_space_steps import MetricMarch, advance_in_space_metric, start_in_space_metric
from .metric_start import recovered_in_metric
from .run import SpaceFrontRun

__all__ = ["metric_space_front"]

METRIC_ORDERS, METRIC_PLACEMENTS = ("widest", "oldest"), ("equal sides", "sphere")
EDGES_IN_METRIC = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
FINISHINGS = 2  # the metric of a vertex that moves is that where it was
LONG_IN_METRIC = 2.5  # cells with a longer edge, in the metric, are reported
Array = NDArray[np.float64]


class MetricSpaceRun(SpaceFrontRun):
    """As `SpaceFrontRun`, with a table of a metric for limits."""

    def marching(self) -> MetricMarch:
        """The arrays as they are now, in one record for the kernels."""
        return MetricMarch(
            self.cells.solid(), self.star, self.edges, self.limits, self.links, self.gates, self.turn,
            self.later, self.rule, np.zeros((4, 3)),
        )  # fmt: skip

    def _start(self, cells: NDArray[np.int32]) -> None:
        start_in_space_metric(self.marching(), cells, self.out)

    def _advance(self, limit: int) -> int:
        return int(advance_in_space_metric(self.marching(), self.diary, self.counts, self.out, limit))

    def _steps(self, vertex: NDArray[np.int32]) -> dict[str, NDArray]:
        """The record by columns; lengths are in the metric."""
        steps, made = super()._steps(vertex), int(self.counts[book.CELLS_DONE])
        return steps | {
            "size": self.diary.numbers[:made, 3].copy(),
            "radius": self.diary.numbers[:made, 4].copy(),
        }


def metric_space_front(
    domain: Domain,
    metric: SpaceMetric,
    fill: Filler,
    *,
    order: str = "widest",
    placement: Any = "equal sides",
    finish: bool = True,
    split_boundary: bool | None = None,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """`advancing_front` for a body in space by a metric; see there. ``fill`` meshes its polygons."""
    for name, value, choices in (
        ("order", order, METRIC_ORDERS), ("placement", placement, METRIC_PLACEMENTS),
    ):  # fmt: skip
        if not (isinstance(value, str) and value in choices):
            raise InputError(
                f"{name} = {value!r} must be one of {', '.join(map(repr, choices))} with a metric in space"
            )
    most = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    table = metric.table(domain.bounds[0], domain.bounds[1])
    expected = expected_cells(domain, table)
    if budget is None or split_boundary is not False:
        refuse_too_many_cells(expected, most)
    cut = None
    if split_boundary is not False:
        cut = divided(domain, metric, bool(split_boundary), MOST_INNER if budget is None else most, fill)
    body = domain if cut is None else cut.domain
    cells, found = recovered_in_metric(body, metric, progress)
    if not found.complete:
        mesh = filled(body, names=domain.name if cut is None else cut.name, progress=progress)
        return mesh if cut is None else as_parts(domain, cut, mesh)
    run = MetricSpaceRun(body, cells, found, order, placement, history)
    with progress_bar(progress, " points", desc="front") as bar:
        run.march(scaled_nodes(table, cells.factor), most, bar)
    made = run.result() if cut is None else as_parts(domain, cut, run.result())
    wanted = {"tetrahedra expected": expected}
    if run.spent:
        made.figures = made.figures | wanted | figures_of(made, metric)
        return made
    mesh, figures = made, figures_of(made, metric)
    if finish:
        mesh = finished(made, metric, progress)
        figures = {f"{name} before": x for name, x in figures.items()}
        figures |= {f"{name} after": x for name, x in figures_of(mesh, metric).items()}
    mesh.figures, mesh.steps = made.figures | wanted | figures, made.steps
    long = measured(mesh, metric)[0].max(axis=1, initial=0.0) > LONG_IN_METRIC
    mesh.unrefined = np.flatnonzero(long).astype(np.int32)
    mesh.reasons = np.full(len(mesh.unrefined), "too large: no room for a point")
    return mesh


def finished(mesh: DomainMesh, metric: SpaceMetric, progress: bool) -> DomainMesh:
    """The mesh after `improve`, its shapes judged in the metric; again where vertices have moved."""
    for _ in range(FINISHINGS):
        before = dict(mesh.counts)
        mesh = improved(mesh, np.hstack([mesh.points, metric.inverses(mesh.points)]), 0, progress)
        done = {name: mesh.counts[name] for name in ("refills", "moves")}
        mesh.counts = mesh.counts | {name: before.get(name, 0) + count for name, count in done.items()}
        if sum(done.values()) == 0:
            break
    return mesh


def measured(mesh: DomainMesh, metric: SpaceMetric) -> tuple[Array, Array]:
    """The metric lengths (t, 6) of the edges of cells, and their metric qualities, both at barycenters."""
    x = mesh.points[mesh.simplices]
    middle, v = x.mean(axis=1), x[:, 1:] - x[:, :1]
    lengths = np.stack([metric.length(middle, x[:, j] - x[:, i]) for i, j in EDGES_IN_METRIC], axis=1)
    six = np.abs((np.cross(v[:, 0], v[:, 1]) * v[:, 2]).sum(axis=1)) / metric.lengths(middle).prod(axis=1)
    return lengths, 12.0 * (six / 2.0) ** (2.0 / 3.0) / np.square(lengths).sum(axis=1)


def figures_of(mesh: DomainMesh, metric: SpaceMetric) -> dict[str, float]:
    """The number of cells, their metric qualities, and the metric lengths of edges, at their middles."""
    _, quality = measured(mesh, metric)
    ends = mesh.simplices[:, EDGES_IN_METRIC].reshape(-1, 2)
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    a, b = mesh.points[ends].swapaxes(0, 1)
    length = metric.length((a + b) / 2, b - a)
    within = (length >= np.sqrt(0.5)) & (length <= np.sqrt(2.0))
    return {
        "tetrahedra": float(len(quality)),
        "minimum metric quality": float(quality.min()),
        "mean metric quality": float(quality.mean()),
        "edges within √2": float(within.mean()),
        "shortest edge": float(length.min()),
        "longest edge": float(length.max()),
    }
