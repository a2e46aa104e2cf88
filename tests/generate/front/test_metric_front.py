"""The front in a metric: valid meshes of any region in any metric, their quality, options, and remeshing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from interrupts import interrupt
from regions import KINDS, random_region

import unstruct
from unstruct import Domain, InputError, advancing_front, check, sizing, statistics
from unstruct.assess.statistics import metric_quality
from unstruct.generate.front.metric_cavity import ROOM_AROUND
from unstruct.generate.front.run import FRONT_REASONS, ORDERS
from unstruct.sizing.metric_table import root_at

SQUARE = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
ARC = unstruct.Arc.through((4, 0), (4.8, 1.5), (4, 3))
TWO = Domain(
    [[0, 0], [4, 0], [4, 3], [0, 3], [2, 0], [2, 3], [1, 2.2]],
    [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0]], inner=[[4, 5]], curves={2: ARC},
    markers={"bay": [2]}, regions={"left": [[0.3, 0.4]], "right": [[3, 1]]},
)  # fmt: skip


def wave(h: float, ratio: float) -> sizing.Metric:
    """A direction that turns; h is the geometric mean of the two lengths."""

    def direction(x: np.ndarray) -> np.ndarray:
        return np.stack([np.ones(len(x)), 0.6 * np.cos(3 * x[:, 0])], axis=1)

    return sizing.directional(direction, h * ratio**0.5, h / ratio**0.5)


def layer(h: float, ratio: float) -> sizing.Metric:
    """Cells stretched along a curve, and the same in all directions away from it."""

    def direction(x: np.ndarray) -> np.ndarray:
        return np.stack([np.ones(len(x)), 1.2 * np.cos(3 * x[:, 0])], axis=1)

    def across(x: np.ndarray) -> np.ndarray:
        return np.minimum(h, h / ratio + 0.3 * np.abs(x[:, 1] - 0.3 - 0.4 * np.sin(3 * x[:, 0])))

    return sizing.directional(direction, h, across)


def nasty(kind: str, domain: Domain, h: float, ratio: float, turns: float) -> sizing.Metric:
    """Metrics over the bounds of a domain, with the shorter length not below a 300th of them."""
    low, high = domain.bounds
    span = float((high - low).max())
    g = max(h * span / ratio, span / 300)
    h = min(g * ratio, 1e200)

    def phase(x: np.ndarray) -> np.ndarray:
        return turns * ((x[:, 0] - low[0]) / span + (x[:, 1] - low[1]) / span)

    def turning(x: np.ndarray) -> np.ndarray:
        return np.stack([np.cos(phase(x)), np.sin(phase(x))], axis=1)

    def jumping(x: np.ndarray) -> np.ndarray:
        return np.where(phase(x)[:, None] % 2 < 1, [[1.0, 0.3]], [[-0.3, 1.0]])

    def sharp(x: np.ndarray) -> np.ndarray:
        return np.clip(np.abs(phase(x) - 0.7 * turns) * span / 9, g, h)

    if kind == "constant":
        return sizing.directional([np.cos(turns), np.sin(turns)], h, g)
    if kind == "sharp":
        return sizing.directional([1, turns], h, sharp)
    return sizing.directional(turning if kind == "turning" else jumping, h, g)


# --- any region, any metric ------------------------------------------------------------------------


@settings(max_examples=50, deadline=None)
@given(
    st.sampled_from(sorted(KINDS)), st.integers(0, 10**6),
    st.sampled_from(["constant", "turning", "jumping", "sharp"]),
    st.sampled_from([0.1, 0.3]), st.sampled_from([1.0, 10.0, 100.0, 1e3, 1e4]), st.floats(0.3, 12),
    st.sampled_from(ORDERS), st.sampled_from(["circle", "equal sides"]),
)  # fmt: skip
def test_any_region_in_any_metric(
    region: str, seed: int, kind: str, h: float, ratio: float, turns: float, order: str, placement: str
) -> None:
    domain = random_region(seed, region)
    metric = nasty(kind, domain, h, ratio, turns)
    for finish in (False, True):
        mesh = advancing_front(domain, metric, order=order, placement=placement, finish=finish, budget=2000)
        assert check(mesh, domain=domain)
        assert mesh.complete == (len(mesh.unrefined) == 0) and len(mesh.reasons) == len(mesh.unrefined)


def test_curves_regions_markers_and_loose_points() -> None:
    slanted = sizing.directional([1, 1], 0.4, 0.04)
    for size in ({"left": slanted, None: 0.2}, {"left": 0.2, "right": slanted}, slanted):
        for finish in (False, True):
            mesh = advancing_front(TWO, size, finish=finish)
            assert check(mesh, domain=TWO)
            bay = mesh.points[np.unique(mesh.markers["bay"])]
            np.testing.assert_allclose(np.hypot(*(bay - ARC.center).T), ARC.radius, rtol=1e-14)
            assert 6 in mesh.origin.tolist() and mesh.regions == {"left": 0, "right": 1}


def test_pieces_are_cut_by_their_metric_length() -> None:
    metric = sizing.directional([1, 0], 0.5, 0.05)
    sampled = SQUARE.sampled(metric)
    assert np.bincount(sampled.piece).tolist() == [2, 20, 2, 20]
    graded = sizing.directional([1, 0], lambda x: 0.05 + 0.2 * x[:, 0], 0.5)
    points = SQUARE.sampled(graded).points
    x = np.unique(points[points[:, 1] == 0, 0])
    assert len(x) == round(5 * np.log(5)) + 1  # the integral of dx / (0.05 + 0.2 x)
    length = graded.length(
        np.stack([(x[1:] + x[:-1]) / 2, 0 * x[1:]], 1), np.stack([np.diff(x), 0 * x[1:]], 1)
    )
    assert 0.95 < length.min() and length.max() < 1.05
    narrow = sizing.directional([1, 0], lambda x: np.minimum(0.2, 0.002 + np.abs(x[:, 0] - 0.357)), 0.5)
    assert np.bincount(SQUARE.sampled(narrow).piece)[0] == pytest.approx(2 + 2 * np.log(100), abs=3)
    curved = np.bincount(TWO.sampled(sizing.directional([0, 1], 0.05, 0.5)).piece)
    assert curved[2] == pytest.approx(62, abs=3) and curved[3] == 4
    by_region = np.bincount(TWO.sampled({"left": metric, "right": 0.1}).piece)
    assert by_region[[0, 1, 5, 6]].tolist() == [4, 20, 60, 60]


# --- quality ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("metric", "close", "mean"),
    [
        (wave(0.01, 10), 0.99, 0.97), (layer(0.04, 10), 0.99, 0.97), (wave(0.01, 1), 0.999, 0.995),
        (sizing.directional([1, 0.4], 0.03, 0.003), 0.99, 0.98), (layer(0.04, 30), 0.98, 0.96),
        (layer(0.04, 100), 0.94, 0.92), (sizing.directional([1, 0.4], 0.3, 0.001), 0.96, 0.93),
        (sizing.directional([1, 0.4], 0.1, 0.001), 0.98, 0.97),
    ],
)  # fmt: skip
def test_quality(metric: sizing.Metric, close: float, mean: float) -> None:
    mesh = advancing_front(SQUARE, metric)
    found = statistics(mesh, metric)
    assert found.conforming > close and found.mean_metric > mean
    assert check(mesh, domain=SQUARE)
    own = mesh.figures
    assert own["mean metric quality after"] == pytest.approx(found.mean_metric, abs=0.01)
    assert own["edges within √2 after"] == pytest.approx(found.conforming, abs=0.02)
    assert own["mean metric quality after"] > own["mean metric quality before"]


def test_statistics_in_a_metric() -> None:
    metric = sizing.directional([1, 0], 1.0, 0.5)
    height = 0.5 * np.sqrt(0.75)
    mesh = unstruct.Mesh([[0, 0], [1, 0], [0.5, height], [1.5, height]], [[0, 1, 2], [1, 3, 2]])
    found = statistics(mesh, metric)
    assert found.conforming == 1.0 and found.least_metric == pytest.approx(1.0)
    assert found.short == pytest.approx(1.0) and found.long == pytest.approx(1.0)
    assert "mean metric quality" in str(found) and np.isnan(statistics(mesh, 1.0).mean_metric)
    x = advancing_front(SQUARE, wave(0.1, 5))
    same = sizing.as_metric(0.3)
    u, v, w = (np.linalg.norm(x.corners[:, i] - x.corners[:, i - 1], axis=1) ** 2 for i in range(3))
    np.testing.assert_allclose(metric_quality(x, same), 4 * np.sqrt(3) * x.volumes / (u + v + w), rtol=1e-9)


# --- the record, budgets, options ------------------------------------------------------------------


@pytest.mark.parametrize("order", ORDERS)
def test_the_record_replays_the_front(order: str) -> None:
    mesh = advancing_front(TWO, wave(0.2, 8), order=order, finish=False, history=True)
    steps = mesh.steps
    assert steps is not None and {len(column) for column in steps.values()} == {mesh.size}
    front = {tuple(pair) for pair in np.concatenate([mesh.segments, mesh.segments[:, ::-1]]).tolist()}
    for i, cell in enumerate(mesh.simplices.tolist()):
        a, b = steps["edge"][i].tolist()
        assert (a, b) in front and sorted((a, b, int(steps["apex"][i]))) == sorted(cell)
        for edge in ((cell[0], cell[1]), (cell[1], cell[2]), (cell[2], cell[0])):
            if edge in front:
                front.remove(edge)
            else:
                front.add(edge[::-1])
    new = steps["reason"] == "new point"
    assert set(np.unique(steps["reason"])) <= set(FRONT_REASONS)
    np.testing.assert_allclose(mesh.points[steps["apex"][new]], steps["ideal"][new], atol=1e-15)
    assert (steps["radius"][new] > 1.2 / np.sqrt(3) - 1e-9).all()
    np.testing.assert_allclose(steps["size"][new], 0.2, rtol=0.1)
    assert mesh.counts["new point"] == int(new.sum())


def test_budget_of_a_metric() -> None:
    with pytest.warns(unstruct.IncompleteWarning):
        mesh = advancing_front(SQUARE, wave(0.02, 10), budget=300)
    assert not mesh.complete and set(mesh.reasons) == {"budget"} and check(mesh, domain=SQUARE)
    assert len(mesh.points) <= 300 + len(SQUARE.sampled(wave(0.02, 10)).points)
    assert np.isin(mesh.unrefined, np.arange(mesh.size)).all()
    whole = advancing_front(SQUARE, wave(0.02, 10))
    assert whole.complete and whole.counts["moves"] > 0 and whole.steps is None


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([4, 30, 300]), st.integers(1, 40), st.booleans())
def test_no_two_points_are_near_however_rough_the_metric(
    seed: int, ratio: float, parts: int, finish: bool
) -> None:
    """A new point has no other vertex nearer than `ROOM_AROUND`, in the metric there: the front must end."""
    angle = np.random.default_rng(seed).uniform(0, np.pi, (parts, parts))

    def direction(x: np.ndarray) -> np.ndarray:
        i, j = np.clip((x * parts).astype(int), 0, parts - 1).T
        return np.stack([np.cos(angle[i, j]), np.sin(angle[i, j])], axis=1)

    metric = sizing.directional(direction, 0.1 * ratio**0.5, 0.1 / ratio**0.5)
    mesh = advancing_front(SQUARE, metric, finish=finish)
    assert check(mesh, domain=SQUARE)
    assert "budget" not in set(mesh.reasons)
    if not finish:  # vertices are in the order in which they were placed, and have not moved
        table, x = metric.table(*SQUARE.bounds, factor=1.0).nodes, mesh.points
        for v in range(len(SQUARE.sampled(metric).points), len(x)):
            m = root_at(table, *x[v])
            far = np.linalg.norm((x[:v] - x[v]) @ np.array([[m[0], m[1]], [m[1], m[2]]]), axis=1)
            assert far.min() >= ROOM_AROUND * (1 - 1e-9)


def test_options_that_a_metric_does_not_have() -> None:
    metric = wave(0.2, 4)
    for options, text in (
        ({"placement": "angle"}, "is for sizes"), ({"placement": lambda *a: None}, "is for sizes"),
        ({"placement": "other"}, "placement"), ({"order": "other"}, "order"), ({"budget": -1}, "budget"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=text):
            advancing_front(SQUARE, metric, **options)  # type: ignore[arg-type]
    broken = sizing.Metric(lambda x: np.where(x[:, :1, None] > 0.6, np.nan, 100 * np.eye(2)))
    with pytest.raises(InputError, match=r"positive definite and finite"):
        advancing_front(SQUARE, broken)
    with pytest.raises(InputError, match="region"):
        advancing_front(TWO, {"left": metric})


def test_same_input_same_mesh_also_after_an_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    metric = wave(0.1, 5)
    one, two = (advancing_front(SQUARE, metric, progress=k > 0) for k in range(2))
    assert np.array_equal(one.points, two.points) and np.array_equal(one.simplices, two.simplices)
    work = lambda: advancing_front(SQUARE, wave(0.003, 10), finish=False, progress=True)  # noqa: E731
    assert max(interrupt(monkeypatch, work, "points")) <= 50_000
    assert np.array_equal(advancing_front(SQUARE, metric).points, one.points)


# --- remeshing to a solution -----------------------------------------------------------------------


def transported(
    mesh: unstruct.Mesh, diffusion: float, velocity: Any, inflow: Any, start: np.ndarray
) -> np.ndarray:
    """Linear elements, stabilized along the stream, for velocity(x, u) . grad u = diffusion * Laplace u.

    ``inflow`` gives the points with given values, and these. Picard steps from ``start``.
    """
    skfem = pytest.importorskip("skfem")
    basis = skfem.Basis(mesh.to_skfem(), skfem.ElementTriP1())
    corners, cells = mesh.corners, mesh.simplices
    opposite = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    double = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    slopes = np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1) / double[:, None, None]

    @skfem.BilinearForm
    def form(u: Any, v: Any, w: Any) -> Any:
        b = velocity(w.u)
        along = b[0] * u.grad[0] + b[1] * u.grad[1], b[0] * v.grad[0] + b[1] * v.grad[1]
        rest = diffusion * (u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1])
        return rest + along[0] * v + w.tau * along[0] * along[1]

    fixed, values = inflow(mesh.points)
    u = np.where(fixed, values, start)
    for _ in range(40):
        b = np.stack(velocity(u[cells].mean(axis=1)), axis=1)
        rate = np.abs(np.einsum("tij,tj->ti", slopes, b)).sum(axis=1)
        tau = 1 / np.hypot(rate, 4 * diffusion * np.square(slopes).sum(axis=(1, 2)))
        w = basis.interpolate(u)
        matrix = form.assemble(basis, u=w, tau=np.repeat(tau[:, None], np.shape(w)[1], axis=1))
        new = skfem.solve(*skfem.condense(matrix, x=np.where(fixed, values, 0.0), D=np.flatnonzero(fixed)))
        change, u = np.abs(new - u).max(), 0.3 * u + 0.7 * new
        if change < 1e-4:
            break
    return u


def remeshed(solve: Any, error: float, least: float) -> list[tuple[unstruct.DomainMesh, np.ndarray]]:
    """Three rounds of solving and meshing by the second derivatives, from a coarse mesh."""
    mesh = advancing_front(SQUARE, 0.08)
    u = solve(mesh, np.zeros(len(mesh.points)))
    found = [(mesh, u)]
    for _ in range(3):
        metric = sizing.metric_from_hessian(
            mesh, sizing.hessian(mesh, u), error, lower=least, upper=0.15, ratio=100
        )
        fresh = advancing_front(SQUARE, sizing.gradation(metric, 0.7))
        assert check(fresh, domain=SQUARE)
        start = unstruct.interpolate(mesh, u, np.clip(fresh.points, 0, 1))
        mesh, u = fresh, solve(fresh, np.nan_to_num(start))
        found.append((mesh, u))
    return found


def test_remeshing_to_boundary_layers() -> None:
    """Heat carried across a square: layers at the walls behind, where u falls from 1 to 0."""

    def inflow(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        edge = (x == 0).any(axis=1) | (x == 1).any(axis=1)
        ahead = (x[:, 0] == 0) & (x[:, 1] < 1)
        return edge, np.where(ahead, 1.0, 0.0)

    diffusion = 5e-3
    rounds = remeshed(
        lambda mesh, start: transported(mesh, diffusion, lambda u: (1 + 0 * u, 0.5 + 0 * u), inflow, start),
        0.01, 1e-3,
    )  # fmt: skip
    (coarse, before), (mesh, u) = rounds[0], rounds[-1]
    assert (
        before.max() > 1.05 and u.max() < 1.02 and u.min() > -0.01
    )  # no overshoot where layers are resolved
    assert mesh.size < 3 * coarse.size
    near = (mesh.points[:, 1] > 0.7) & (mesh.points[:, 1] < 0.9)
    x, wanted = mesh.points[near, 0], 1 - np.exp((mesh.points[near, 0] - 1) / diffusion)
    assert np.abs(u[near] - wanted).max() < 0.08 and np.sum((x > 0.97) & (x < 1)) > 20
    sides = np.linalg.norm(np.roll(mesh.corners, -1, axis=1) - mesh.corners, axis=2)
    height = 2 * mesh.volumes / sides.max(axis=1)
    assert (sides.max(axis=1) / height).max() > 15 and height.min() < diffusion


def test_remeshing_to_a_shock() -> None:
    """Burgers' equation with time as a coordinate: the waves meet in (0.6, 0.5): a shock begins there."""

    def inflow(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        fixed = (x[:, 1] == 0) | (x[:, 0] == 0) | (x[:, 0] == 1)
        return fixed, 1.2 - 2 * x[:, 0]

    diffusion = 5e-3
    rounds = remeshed(
        lambda mesh, start: transported(mesh, diffusion, lambda u: (u, 1 + 0 * u), inflow, start), 0.02, 1e-3
    )
    (coarse, _), (mesh, u) = rounds[0], rounds[-1]
    assert -0.9 < u.min() and u.max() < 1.3 and mesh.size < 3 * coarse.size
    middle = mesh.corners.mean(axis=1)
    shock = np.abs(middle[:, 0] - 0.5 - 0.2 * middle[:, 1]) < 0.03
    shock &= (middle[:, 1] > 0.6) & (middle[:, 1] < 0.9)
    assert shock.sum() > 0.05 * mesh.size  # a tenth of this share of the area
    along = np.array([0.2, 1.0]) / np.hypot(0.2, 1.0)
    edges = np.roll(mesh.corners[shock], -1, axis=1) - mesh.corners[shock]
    longest = edges[np.arange(len(edges)), np.linalg.norm(edges, axis=2).argmax(axis=1)]
    cosines = np.abs(longest @ along) / np.linalg.norm(longest, axis=1)
    assert np.median(cosines) > 0.97  # long edges lie along the shock
