# SPDX-License-Identifier: Apache-2.0
"""Threads, signals and processes around jobs."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import tetvdb
from conftest import cube_triangles, sphere_triangles

# A job of seconds; with threads = 1 only the calling thread runs it.
LONG = {"voxel_size": 1 / 1500, "grid": "surface", "half_width": 8, "max_memory": "64G"}


def long_job(**settings):
    return tetvdb.voxelize(*sphere_triangles(), **{**LONG, **settings})


def test_other_threads_run_meanwhile():
    """A job that holds the GIL would let the counter stand still until it ends."""
    counts = []
    done = threading.Event()

    def work():
        try:
            long_job(max_time=0.6)
        except tetvdb.Error as error:
            counts.append(error.code)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    steps = 0
    while not done.is_set():
        steps += 1
        time.sleep(0.001)
    thread.join()
    assert counts == ["cancelled"]
    assert steps > 20


def test_two_jobs_at_once():
    expected = tetvdb.voxelize(*sphere_triangles(), resolution=64).hash()
    found = []

    def work():
        for _ in range(5):
            found.append(tetvdb.voxelize(*sphere_triangles(), resolution=64).hash())

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 20


@pytest.mark.parametrize("threads", [1, 2])
def test_keyboard_interrupt(threads):
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        long_job(threads=threads, max_time=60)
    timer.join()


def test_handlers_that_raise():
    class Alarm(Exception):
        pass

    def ring(number, frame):
        raise Alarm

    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Alarm):
            long_job(max_time=60)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_handlers_that_do_not_raise():
    rung = []
    before = signal.signal(signal.SIGALRM, lambda number, frame: rung.append(number))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(tetvdb.Error) as caught:
            long_job(max_time=0.5)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert caught.value.code == "cancelled" and rung == [signal.SIGALRM]


def voxels_of(side):
    points, faces = cube_triangles((0.5, 0.5, 0.5), (side + 0.5,) * 3)
    return tetvdb.voxelize(points, faces, voxel_size=1)["density"].active_voxels


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_pools(method):
    voxels_of(20)  # the module's threads are there before the fork
    context = multiprocessing.get_context(method)
    with context.Pool(2) as pool:
        assert pool.map(voxels_of, range(1, 13), chunksize=3) == [n ** 3 for n in range(1, 13)]


def test_volumes_come_from_workers():
    with multiprocessing.get_context("fork").Pool(1) as pool:
        volume = pool.apply(tetvdb.voxelize, sphere_triangles(), {"resolution": 16})
    assert volume.hash() == tetvdb.voxelize(*sphere_triangles(), resolution=16).hash()


def test_loader_of_torch():
    torch = pytest.importorskip("torch")

    class Models(torch.utils.data.Dataset):
        def __len__(self):
            return 8

        def __getitem__(self, i):
            points, faces = cube_triangles((0.5,) * 3, (i + 1.5,) * 3)
            grid = tetvdb.voxelize(torch.from_numpy(points), torch.from_numpy(faces),
                                   voxel_size=1)["density"]
            return torch.from_numpy(grid.to_numpy(box=((0,) * 3, (15,) * 3)))

    voxels_of(20)
    loader = torch.utils.data.DataLoader(Models(), batch_size=4, num_workers=2)
    sums = torch.cat([batch.sum(dim=(1, 2, 3)) for batch in loader])
    assert sums.tolist() == [float((i + 1) ** 3) for i in range(8)]


def test_import_brings_no_numpy():
    code = "import sys, tetvdb; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
