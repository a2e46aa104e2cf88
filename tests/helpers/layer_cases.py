"""Random regions of several bodies with layers: ``random_case(rng)``; and one mesh judged: ``judged(case)``.

``python tests/helpers/layer_cases.py COUNT --seed S`` meshes many and prints what was found.
"""

from __future__ import annotations

import argparse
import sys
import time
import traceback
import warnings
from collections import Counter
from typing import Any, NamedTuple

import numpy as np

from unstruct import Domain, DomainMesh, Layers, UnstructError, advancing_layers, check, sizing

Rng = np.random.Generator


class Case(NamedTuple):
    """A domain and the arguments of `advancing_layers`."""

    domain: Domain
    size: Any
    options: dict[str, Any]
    kind: str


def body(rng: Rng, kind: str, radius: float) -> np.ndarray:
    """A ring of corners about the origin."""
    if kind == "smooth":
        t = np.arange(48) / 48 * 2 * np.pi
        r = 1 + sum(rng.uniform(-0.25, 0.25) / k * np.cos(k * t + rng.uniform(0, 6)) for k in (2, 3, 5))
    elif kind == "star":
        m = int(rng.integers(3, 9))
        t = np.arange(2 * m) / (2 * m) * 2 * np.pi
        r = np.where(np.arange(2 * m) % 2, rng.uniform(0.25, 0.7), 1.0)
    elif kind == "polygon":
        t = np.sort(rng.uniform(0, 2 * np.pi, int(rng.integers(4, 10))))
        r = rng.uniform(0.4, 1.0, len(t))
    elif kind == "comb":
        teeth, depth = int(rng.integers(2, 5)), rng.uniform(0.2, 0.9)
        x = np.linspace(-1, 1, 4 * teeth)
        y = np.where(np.arange(4 * teeth) % 4 < 2, 0.6, 0.6 - depth)
        return radius * np.concatenate([[[-1, -0.6], [1, -0.6]], np.column_stack([x, y])[::-1]])
    elif kind == "wedge":
        return radius * np.array(
            [[-1, 0], [0.5, -rng.uniform(0.002, 0.2)], [1, 0], [0.5, rng.uniform(0.0, 0.2)]]
        )
    else:  # a plate with a hook
        w = rng.uniform(0.03, 0.2)
        return radius * np.array([[-1, -w], [1, -w], [1, 0.6], [1 - w, 0.6], [1 - w, w], [-1, w]])
    return radius * np.column_stack([r * np.cos(t), r * np.sin(t)])


KINDS = ("smooth", "star", "polygon", "comb", "wedge", "hook")


def random_case(rng: Rng | Any) -> Case:
    """One to four bodies in a box, as far apart as chance puts them."""
    rng = np.random.default_rng(rng)
    while True:
        rings, kinds = [], []
        for _ in range(int(rng.integers(1, 5))):
            kind = str(rng.choice(KINDS))
            ring = body(rng, kind, rng.uniform(0.08, 0.28))
            turn, at = rng.uniform(0, 2 * np.pi), rng.uniform(0.25, 0.75, 2)
            c, s = np.cos(turn), np.sin(turn)
            rings.append(ring @ np.array([[c, s], [-s, c]]) + at)
            kinds.append(kind)
        box = [[-0.2, -0.2], [1.2, -0.2], [1.2, 1.2], [-0.2, 1.2]]
        try:
            domain = Domain.polygon(box, rings)
        except UnstructError:
            continue
        break
    near, far = rng.uniform(0.012, 0.05), 0.15
    bodies = np.arange(4, len(domain.facets))
    size = sizing.sources(domain.points[domain.facets[bodies]], near, growth=0.25, far=far)
    layers = Layers(first=near * 10 ** rng.uniform(-4, -1), growth=rng.uniform(1.1, 1.5))
    if rng.random() < 0.2:
        layers = Layers(first=near * 10 ** rng.uniform(-2, -1), growth=1.2, count=int(rng.integers(1, 30)))
    options = {
        "layers": layers,
        "walls": None if rng.random() < 0.2 else bodies,
        "stop": str(rng.choice(["nearest", "spring"])),
        "cells": str(rng.choice(["triangle", "quad"])),
    }
    return Case(domain, size, options, "+".join(kinds))


def least_corner(domain: Domain) -> float:
    """The least angle between two pieces at a vertex, in degrees."""
    least = 360.0
    for v in range(len(domain.points)):
        rows = np.flatnonzero((domain.pieces == v).any(axis=1))
        ends = domain.pieces[rows]
        other = np.where(ends[:, 0] == v, ends[:, 1], ends[:, 0])
        u = domain.points[other] - domain.points[v]
        angle = np.sort(np.degrees(np.arctan2(u[:, 1], u[:, 0])))
        gaps = np.append(np.diff(angle), 360 + angle[0] - angle[-1])
        middle = np.radians(angle + gaps / 2)
        inside = domain.contains(domain.points[v] + 1e-9 * np.column_stack([np.cos(middle), np.sin(middle)]))
        least = min(least, gaps[inside].min(initial=360.0))
    return float(least)


def judged(case: Case, full: bool = True) -> tuple[DomainMesh, dict[str, Any]]:
    """The mesh of a case and what is to be known of it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh = advancing_layers(case.domain, case.size, **case.options)
    found: dict[str, Any] = {"valid": True}
    if full:
        report = check(mesh, domain=case.domain)
        found["valid"] = bool(report)
        found["report"] = "" if report else str(report)
    rest = mesh.steps["cell_layer"] == 0
    found["fill angle"] = float(mesh.quality("min_angle")[rest].min(initial=180.0))
    found["largest"] = float(mesh.quality("max_angle").max())
    level, reason = mesh.steps["level"], mesh.steps["reason"]
    none = level == 0
    # In gaps narrower than some first layers there is no room; everywhere else there should be layers.
    narrow = none & np.isin(reason, ["near", "match"])
    found["rays"], found["narrow"] = len(level), int(narrow.sum())
    found["refused"] = int((none & (reason != "end") & ~narrow).sum())
    found["ends"] = int(((level == 0) & (reason == "end")).sum())
    return mesh, found


def main() -> None:
    """Mesh many cases; print the worst."""
    parser = argparse.ArgumentParser()
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    tally: Counter[str] = Counter()
    worst: list[tuple[float, int, str, float]] = []
    angles = []
    started = time.time()
    for i in range(given.first, given.first + given.count):
        case = random_case((given.seed, i))
        try:
            mesh, found = judged(case)
        except Exception as error:
            tally["errors"] += 1
            print(i, case.kind, type(error).__name__, str(error)[:300])
            if tally["errors"] < 3:
                traceback.print_exc()
            continue
        tally["cases"] += 1
        tally["rays"] += found["rays"]
        tally["refused"] += found["refused"]
        tally["narrow"] += found["narrow"]
        tally["ends"] += found["ends"]
        tally["rounds"] += mesh.counts["rounds"]
        if not found["valid"]:
            tally["invalid"] += 1
            print(i, case.kind, found["report"])
        angles.append(found["fill angle"])
        if found["refused"]:
            print(i, case.kind, "refused", found["refused"], "of", found["rays"])
        if found["fill angle"] < 15:
            worst.append((found["fill angle"], i, case.kind, least_corner(case.domain)))
    for angle, i, kind, corner in sorted(worst)[:40]:
        print(f"least angle of the rest {angle:6.2f} case {i} {kind} least corner of the input {corner:.1f}")
    print(dict(tally), f"median {np.median(angles):.1f}, {time.time() - started:.0f} s")
    sys.exit(tally["invalid"] + tally["errors"] > 0)


if __name__ == "__main__":
    main()
