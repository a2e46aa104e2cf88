"""The local feature size of bodies, over exhaustive pairs by definition, and known shapes."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, InputError, check, refine, tetrahedralize
from unstruct.sizing import FeatureSize, from_features, limited, local_feature_size, minimum
from unstruct.sizing.apart import OPPOSED_BITS, Parts, parts_of


def to_triangle(p: np.ndarray, corners: np.ndarray) -> float:
    """The distance from a triangle: that from its plane if the foot is inside, or that from a side."""
    a, b, c = corners
    best = min(to_side(p, *side) for side in ((a, b), (b, c), (c, a)))
    n = np.cross(b - a, c - a)
    if (n == 0).all():
        return best
    inside = all(np.dot(np.cross(e - s, p - s), n) >= 0 for s, e in ((a, b), (b, c), (c, a)))
    return abs(np.dot(p - a, n)) / math.sqrt(np.dot(n, n)) if inside else best


def to_side(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    square = np.dot(b - a, b - a)
    t = min(max(np.dot(p - a, b - a) / square, 0.0), 1.0) if square > 0 else 0.0
    return math.dist(p, a + t * (b - a))


def apart(parts: Parts, i: int, j: int) -> bool:
    """The definition for elements: of parts without a common vertex, or of one part and facing each other."""
    if parts.part[i] == parts.part[j]:
        bit = int(parts.direction[j])
        opposed = int(OPPOSED_BITS[parts.direction[i], bit >> 6]) >> (bit & 63) & 1
        return bool(opposed) and not set(parts.vertices[i]) & set(parts.vertices[j])
    vertices = [set(parts.vertices[parts.part == parts.part[k]].ravel().tolist()) for k in (i, j)]
    return not vertices[0] & vertices[1]


def exhaustive(body: Domain, x: np.ndarray) -> list[float]:
    parts, factor = parts_of(body)
    pairs = [(i, j) for i, j in combinations(range(len(parts.part)), 2) if apart(parts, i, j)]
    far = np.array([[to_triangle(p * factor, corners) for corners in parts.corners] for p in x]) / factor
    i, j = np.array(pairs).T
    return np.maximum(far[:, i], far[:, j]).min(axis=1).tolist()


def of_complex(body: Domain, x: np.ndarray) -> list[float]:
    """The definition of a piecewise linear complex: vertices, sides and polygons without a common vertex."""
    features = [({v}, [(v, v, v)]) for v in range(len(body.points))]
    ends, _ = body.pieces.sides
    features += [({a, b}, [(a, b, b)]) for a, b in {tuple(sorted(row)) for row in ends.tolist()}]
    shell = body.triangulated
    for piece in range(len(body.pieces)):
        rows = shell.triangles[shell.piece == piece].tolist()
        if rows:
            features.append(({v for row in rows for v in row}, [tuple(row) for row in rows]))
    away = [[min(to_triangle(p, body.points[list(row)]) for row in rows) for _, rows in features] for p in x]
    pairs = [(i, j) for i, j in combinations(range(len(features)), 2) if not features[i][0] & features[j][0]]
    return [min(max(row[i], row[j]) for i, j in pairs) for row in away]


def two_boxes(gap: float) -> Domain:
    low, high = Domain.box((0, 0, 0), (1, 1, 1)), Domain.box((1 + gap, 0, 0), (2 + gap, 1, 1))
    return Domain(np.concatenate([low.points, high.points]), [*BOX, *(BOX + 8)])


BOX = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
BODIES = {
    "box": Domain.box((0, 0, 0), (1, 2, 0.1)),
    "two boxes": two_boxes(0.05),
    "ball": Domain.ball(size=0.7),
    "torus": Domain.torus(size=0.6, tube=0.4),
    "cylinder": Domain.cylinder(size=0.3),
    "prism": Domain.extruded(Domain.polygon([(0, 0), (2, 0), (2, 2), (1, 0.3), (0, 2)]), 0.4),
    "inner": Domain(
        np.concatenate([Domain.box().points, [(0.5, 0.5, 0.4), (0.5, 0.5, 0.6), (0.2, 0.2, 0.2)]]),
        BOX,
        inner=[[8, 9]],
    ),
    "wedge": Domain.revolved(Domain.polygon([(0, 0), (1, 0), (1, 0.3)]), 180.0),
}


@pytest.mark.parametrize("name", BODIES)
def test_it_is_that_of_all_pairs(name: str) -> None:
    body = BODIES[name]
    low, high = body.bounds
    rng = np.random.default_rng(1)
    x = low + rng.uniform(-0.3, 1.3, size=(30, 3)) * (high - low)
    x = np.concatenate([x, body.points[::7], [(low + high) / 2]])
    feature = FeatureSize(body)
    found, wanted = feature(x), exhaustive(body, x)
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12)
    one_by_one = np.concatenate([feature(row[None]) for row in x])
    assert found == pytest.approx(one_by_one, rel=1e-12)
    far = float(np.median(wanted))
    cut = feature(x, far)
    assert np.array_equal(np.isinf(cut), found > far) and np.array_equal(
        cut[found <= far], found[found <= far]
    )


@pytest.mark.parametrize("name", ["box", "two boxes", "prism", "inner"])
def test_with_sharp_edges_it_is_that_of_the_complex(name: str) -> None:
    body = BODIES[name]
    low, high = body.bounds
    x = low + np.random.default_rng(2).uniform(-0.2, 1.2, size=(40, 3)) * (high - low)
    assert local_feature_size(body, x) == pytest.approx(of_complex(body, x), rel=1e-9)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1e-150, 1e150]))
def test_it_is_lipschitz_and_positive(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    body = BODIES[str(rng.choice(list(BODIES)))]
    body = Domain(body.points * scale, body.triangulated.bounding)
    feature = FeatureSize(body)
    a, b = rng.normal(size=(2, 80, 3)) * scale
    b[:40] = a[:40] + 0.01 * rng.normal(size=(40, 3)) * scale
    away = np.sqrt((((a - b) / scale) ** 2).sum(axis=1)) * scale
    assert (np.abs(feature(a) - feature(b)) <= away * (1 + 1e-9) + 1e-12 * scale).all()
    assert (feature(a) > 0).all()


def test_known_sizes() -> None:
    plate = BODIES["box"]
    assert local_feature_size(plate, [[0.5, 1, 0.05], [0.5, 1, 0.0]]) == pytest.approx([0.05, 0.1])
    assert local_feature_size(two_boxes(0.02), [[1.01, 0.5, 0.5]]) == pytest.approx([0.01])
    ball = Domain.ball(size=0.1)
    middle, rim = local_feature_size(ball, [[0, 0, 0], [0, 0, 1]])
    assert middle == pytest.approx(1.0, rel=0.01) and 0.75 < rim < 1.2, "not the length of a triangle"
    tube = local_feature_size(Domain.torus(radius=1.0, tube=0.2, size=0.05), [[1, 0, 0]])[0]
    assert tube == pytest.approx(0.2, rel=0.05)
    hollow = Domain(
        np.concatenate([ball.points, 0.9 * ball.points]),
        np.concatenate(
            [ball.triangulated.triangles, ball.triangulated.triangles[:, ::-1] + len(ball.points)]
        ),
    )
    assert local_feature_size(hollow, [[0, 0, 0.95]])[0] == pytest.approx(0.05, rel=0.05)
    named = Domain(plate.points, BOX, markers={"one": [0], "other": [1]})
    assert local_feature_size(named, [[0.5, 1, 0.05]]) == pytest.approx([0.05])


def test_sizes_of_bodies_from_features() -> None:
    plate = Domain.box((0, 0, 0), (1, 1, 0.2))
    size = from_features(plate, far=0.25)
    x = np.random.default_rng(0).random((50, 3))
    assert size(x) == pytest.approx(np.minimum(0.5 * local_feature_size(plate, x), 0.25))
    assert size.growth == 0.5 and limited(size, 0.6, (0, 0), (1, 1)) is size
    assert minimum(size, 0.07)([[0.5, 0.5, 0.1]])[0] == pytest.approx(0.05)
    coarse = from_features(plate, 0.7, far=0.25)
    mesh = tetrahedralize(plate, coarse)
    assert mesh.complete and check(mesh, domain=plate) and 200 < len(mesh.simplices) < 60_000
    mesh = refine(plate, from_features(plate, 1.5, far=0.4))
    assert check(mesh, domain=plate) and len(mesh.simplices) > 100
    with pytest.raises(InputError, match=r"shape \(k, 3\)"):
        local_feature_size(plate, [[0, 0]])
