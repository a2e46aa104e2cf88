"""Random bodies by the hundred: booleans of rotated boxes, cylinders and spheres, and noisy implicit bodies.

``python random_bodies.py make FOLDER --first 0 --count 100 --kind boolean`` writes them (booleans need
manifold3d); ``python random_bodies.py run FOLDER`` recovers each surface, checks the result, and tells what
was exact, divided, incomplete and why, refused, wrong, and how long it took.
"""

from __future__ import annotations

import argparse
import time
import traceback
from collections.abc import Iterator
from pathlib import Path

import numpy as np

Body = tuple[np.ndarray, np.ndarray]  # points and triangles


def boolean(seed: int) -> Body:
    """A rotated cube with some rotated boxes, cylinders and spheres added or taken away."""
    from manifold3d import Manifold

    rng = np.random.default_rng(seed)

    def turn() -> list[float]:
        return rng.uniform(0, 360, 3).tolist()

    made = Manifold.cube((1, 1, 1), True).rotate(turn())
    for _ in range(2 + seed % 4):
        kind = rng.integers(3)
        if kind == 0:
            other = Manifold.cube(rng.uniform(0.5, 1.2, 3).tolist(), True)
        elif kind == 1:
            other = Manifold.cylinder(2.0, rng.uniform(0.15, 0.4), -1, int(rng.integers(12, 32)), True)
        else:
            other = Manifold.sphere(rng.uniform(0.4, 0.7), int(rng.integers(12, 28)))
        other = other.rotate(turn()).translate(rng.uniform(-0.4, 0.4, 3).tolist())
        made = made + other if rng.random() < 0.5 else made - other
    mesh = made.to_mesh64()
    points, triangles = np.asarray(mesh.vert_properties)[:, :3].astype(float), np.asarray(mesh.tri_verts)
    same = np.arange(len(points))
    same[np.asarray(mesh.merge_from_vert, dtype=int)] = np.asarray(mesh.merge_to_vert, dtype=int)
    return joined(points, same[triangles])


def joined(points: np.ndarray, triangles: np.ndarray) -> Body:
    """Equal points as one, and only those that are used."""
    used = np.unique(triangles)
    unique, number = np.unique(points[used], axis=0, return_inverse=True)
    place = np.full(len(points), -1)
    place[used] = number.ravel()
    rows = place[triangles]
    whole = (rows[:, 0] != rows[:, 1]) & (rows[:, 1] != rows[:, 2]) & (rows[:, 0] != rows[:, 2])
    return unique, rows[whole].astype(np.int32)


def noisy(seed: int) -> Body:
    """A ball with waves of random directions, by marching tetrahedra on a lattice: many needles."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(8, 25))
    x = np.stack(np.meshgrid(*[np.linspace(-1.4, 1.4, n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    f = np.linalg.norm(x, axis=1) - 0.8
    for _ in range(8):
        f = f + 0.08 * np.sin(x @ (rng.normal(size=3) * rng.uniform(2, 9)) + rng.uniform(0, 6))
    f = np.where(np.abs(x).max(axis=1) > 1.39, np.abs(f) + 0.05, f)  # closed
    return marched(n, x, f)


def marched(n: int, x: np.ndarray, f: np.ndarray) -> Body:
    """The surface f = 0 on a lattice of n^3 points whose cubes are divided in six tetrahedra each."""
    corner = np.arange(n**3).reshape(n, n, n)[:-1, :-1, :-1].ravel()
    step = np.array([n * n, n, 1])
    cells = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0)):
        path = np.concatenate([[0], np.cumsum(step[list(order)])])
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        cells.append(corner[:, None] + (path if even else path[[1, 0, 2, 3]]))
    tets = np.concatenate(cells)
    inside = f[tets] < 0
    ends, faces = [], []
    for row, within in zip(tets[inside.any(1) & ~inside.all(1)], inside[inside.any(1) & ~inside.all(1)]):
        a, b = row[within].tolist(), row[~within].tolist()
        if len(a) == 2:
            quad = [(a[0], b[0]), (a[0], b[1]), (a[1], b[1]), (a[1], b[0])]
            faces += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
        else:
            faces.append(tuple((p, q) for p in a for q in b))
    number: dict[tuple[int, int], int] = {}
    rows = [[number.setdefault(end, len(number)) for end in face] for face in faces]
    ends = np.array(list(number))
    low, high = f[ends[:, 0]], f[ends[:, 1]]
    share = np.clip(low / (low - high), 0.02, 0.98)[:, None]
    return joined(x[ends[:, 0]] * (1 - share) + x[ends[:, 1]] * share, np.array(rows))


MAKERS = {"boolean": boolean, "noisy": noisy}


def stored(folder: Path) -> Iterator[tuple[str, Body]]:
    """The bodies in a folder, by name."""
    for path in sorted(folder.glob("*.npz")):
        found = np.load(path)
        yield path.stem, (found["p"], found["t"])


def judged(points: np.ndarray, triangles: np.ndarray) -> tuple[str, int, int, str]:
    """What becomes of a body: a word, points on and off the surface, and the reason."""
    import warnings

    from unstruct import Domain, UnstructError, check, constrained_delaunay

    try:
        domain = Domain(points, triangles)
    except UnstructError as error:
        return "refused", 0, 0, str(error)[:90]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        start = time.process_time()
        mesh = constrained_delaunay(domain)
        spent = time.process_time() - start
    counts = mesh.counts
    report = check(mesh, domain=domain) if mesh.complete else check(mesh)
    word = (
        "exact" if mesh.complete and len(mesh.steiner) == 0 else "divided" if mesh.complete else "incomplete"
    )
    why = "" if mesh.complete else str(mesh.reasons[0])
    if not report:
        word, why = "WRONG", " ".join(str(report).split())[:200]
    return word, counts["added on pieces"], counts["added inside"], f"{spent:.2f} {why}"


def run(folder: Path, log: Path) -> None:
    """Judge each body of a folder and append a line for each that is not in the log yet."""
    known = {line.split()[0] for line in log.read_text().splitlines()} if log.exists() else set()
    for name, (points, triangles) in stored(folder):
        if name in known:
            continue
        try:
            word, on, off, rest = judged(points, triangles)
        except Exception:
            word, on, off, rest = "CRASH", 0, 0, traceback.format_exc(limit=-2).replace("\n", " ")[:300]
        with log.open("a") as file:
            file.write(f"{name} {len(triangles)} {word} {on} {off} {rest}\n")


def told(log: Path) -> None:
    """Print sums of a log, and what is not exact."""
    rows = [line.split(maxsplit=5) for line in log.read_text().splitlines()]
    words = [row[2] for row in rows]
    print({word: words.count(word) for word in sorted(set(words))}, "of", len(rows))
    done = [row for row in rows if row[2] not in ("refused", "CRASH")]
    spent = np.array([float(row[5].split()[0]) for row in done if len(row) > 5 and row[2] != "WRONG"])
    print("points on pieces", sum(int(row[3]) for row in done), "off", sum(int(row[4]) for row in done))
    print(f"CPU seconds: median {np.median(spent):.3f} largest {spent.max():.1f} sum {spent.sum():.1f}")
    for row in rows:
        if row[2] not in ("exact", "refused"):
            print(*row)


def main() -> None:
    """Make, run or tell; see the top of this file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["make", "run", "tell"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--kind", choices=list(MAKERS), default="boolean")
    parser.add_argument("--log", type=Path)
    args = parser.parse_args()
    log = args.log or args.folder / "log.txt"
    if args.what == "make":
        args.folder.mkdir(parents=True, exist_ok=True)
        for seed in range(args.first, args.first + args.count):
            points, triangles = MAKERS[args.kind](seed)
            if len(triangles):
                np.savez(args.folder / f"{args.kind}{seed:05d}.npz", p=points, t=triangles)
    elif args.what == "run":
        run(args.folder, log)
        told(log)
    else:
        told(log)


if __name__ == "__main__":
    main()
