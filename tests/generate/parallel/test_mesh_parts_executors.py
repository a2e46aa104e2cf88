"""Parts meshed by processes and by Dask: the same bits, workers that die, parts that are tried again.

These start processes, which takes some seconds each.
"""

from __future__ import annotations

import os
import signal
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import unstruct
from unstruct.generate.parallel.records import mesh_part

DOMAIN = unstruct.Domain.disc()
SIZE = 0.05
PARTS = 6


def _equal(one, two):
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.simplices, two.simplices)
    assert all(np.array_equal(values, two.markers[name]) for name, values in one.markers.items())


def _once(folder, count):
    """Whether this is among the first ``count`` calls with this folder, in whatever process."""
    for k in range(count):
        try:
            os.close(os.open(Path(folder) / str(k), os.O_CREAT | os.O_EXCL))
            return True
        except FileExistsError:
            continue
    return False


def _raises(folder, count, domain, size):
    """Raise in the part with the center of the disc, the first ``count`` times."""
    if domain.contains((0.95, 0.05)) and _once(folder, count):
        raise OSError("the disk is full")
    return unstruct.voronoi_segment(domain, size)


def _dies(folder, domain, size):
    """End the process in the part with this place, once, and not cleanly."""
    if domain.contains((0.95, 0.05)) and _once(folder, 1):
        os.kill(os.getpid(), signal.SIGKILL)
    return unstruct.voronoi_segment(domain, size)


def _figures(mesh):
    return mesh.size, float(mesh.quality("min_angle").min())


def _gathered(client, **options):
    return lambda work, *rows: client.gather(client.map(work, *rows, pure=False, **options))


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def here():
    return unstruct.mesh_parts(DOMAIN, SIZE, PARTS)


def test_processes(here):
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        _equal(here, unstruct.mesh_parts(DOMAIN, SIZE, PARTS, map=pool.map))
        with pytest.raises(unstruct.InputError, match="cannot be sent"):
            unstruct.mesh_parts(DOMAIN, lambda x: np.full(len(x), 0.1), 2, map=pool.map)
        with pytest.raises(unstruct.MeshError, match=r"part \d of 2, .*TypeError"):
            method = partial(unstruct.voronoi_segment, nonsense=1)
            unstruct.mesh_parts(DOMAIN, SIZE, 2, method=method, map=pool.map)


def test_dask(client, here):
    _equal(here, unstruct.mesh_parts(DOMAIN, SIZE, PARTS, map=_gathered(client)))


def test_a_part_that_fails_once_is_tried_again(client, here, tmp_path):
    method = partial(_raises, str(tmp_path), 1)
    mesh = unstruct.mesh_parts(DOMAIN, SIZE, PARTS, method=method, map=_gathered(client, retries=2))
    _equal(here, mesh)
    assert (tmp_path / "0").exists()


def test_a_part_that_always_fails_is_named(client, tmp_path):
    method = partial(_raises, str(tmp_path), 1000)
    with pytest.raises(unstruct.MeshError, match=rf"part \d of {PARTS}, from .*OSError: the disk is full"):
        unstruct.mesh_parts(DOMAIN, SIZE, PARTS, method=method, map=_gathered(client, retries=1))
    assert len(list(tmp_path.iterdir())) == 2


def test_a_worker_that_dies(client, here, tmp_path):
    method = partial(_dies, str(tmp_path))
    _equal(here, unstruct.mesh_parts(DOMAIN, SIZE, PARTS, method=method, map=_gathered(client)))
    assert (tmp_path / "0").exists()


def test_a_dead_worker_with_results(client, here):
    """Results that were on a worker are made again, where the cluster has lost them."""
    found = unstruct.mesh_parts(DOMAIN, SIZE, PARTS, join=False, map=client.map)
    sizes = client.gather(client.map(_figures, found.meshes))
    workers = client.run(os.getpid)
    os.kill(next(iter(workers.values())), signal.SIGKILL)
    time.sleep(0.2)
    assert client.gather(client.map(_figures, found.meshes, pure=False)) == sizes
    _equal(here, found.join(client.gather(found.meshes)))


def test_results_stay_on_the_cluster(client, here, tmp_path):
    """Written there, by part, and reduced there: no mesh comes to the process that asked."""
    pytest.importorskip("meshio")
    found = unstruct.mesh_parts(DOMAIN, SIZE, PARTS, join=False, map=client.map)
    index, *files = found.write(tmp_path / "disc.pvtu", map=_gathered(client))
    assert len(files) == PARTS and index.exists()
    assert sum(unstruct.Mesh.read(file).size for file in files) == here.size
    figures = client.gather(client.map(_figures, found.meshes))
    assert sum(size for size, _ in figures) == here.size
    assert min(angle for _, angle in figures) == here.quality("min_angle").min()
    with pytest.raises(unstruct.InputError, match="gather"):
        found.join()
    _equal(here, found.join(client.gather(found.meshes)))


def test_what_a_part_carries(client):
    """A part is small: what bounds it, not what is in it."""
    import pickle

    found = unstruct.mesh_parts(DOMAIN, 0.005, 4, join=False, map=lambda work, parts: [None] * len(parts))
    assert max(len(pickle.dumps(part)) for part in found.parts) < 200_000
    assert mesh_part(found.parts[0]).size > 10_000
