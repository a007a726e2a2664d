# SPDX-License-Identifier: Apache-2.0
"""What a call and the import take, in CPU time: python3 python/benchmarks/overhead.py"""

import resource
import subprocess
import sys
import time
import timeit

import numpy as np

import tetvdb

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
TETS = np.array([[0, 1, 2, 3]], np.int32)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.int32)


def microseconds(call, number):
    return 1e6 / number * min(timeit.repeat(call, number=number, repeat=9,
                                            timer=time.process_time))


def refused():
    try:
        tetvdb.voxelize(POINTS, TETS + 9, threads=1)
    except tetvdb.Error:
        pass


def milliseconds(code):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", code], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)


solid = tetvdb.Solid(POINTS, FACES)
one = np.array([[0.1, 0.1, 0.1]])
million = np.random.default_rng(1).uniform(-1, 2, (1000000, 3))
grid = tetvdb.voxelize(POINTS, FACES, resolution=8)["density"]
print(f"a job whose mesh is refused when it is read  {microseconds(refused, 2000):8.1f} us")
print("voxelize, one tet, 4 voxels                  "
      f"{microseconds(lambda: tetvdb.voxelize(POINTS, TETS, resolution=4, threads=1), 300):8.1f} us")
print(f"Solid.query of one point                     "
      f"{microseconds(lambda: solid.query(one), 2000):8.1f} us")
print(f"Solid.query of a million                     "
      f"{microseconds(lambda: solid.query(million), 1) / 1e3:8.1f} ms")
print(f"to_numpy of 8 x 8 x 8 voxels                 "
      f"{microseconds(lambda: grid.to_numpy(), 2000):8.1f} us")
bare = min(milliseconds("pass") for _ in range(12))
print(f"import tetvdb                                "
      f"{min(milliseconds('import tetvdb') for _ in range(12)) - bare:8.1f} ms")
print(f"import numpy                                 "
      f"{min(milliseconds('import numpy') for _ in range(12)) - bare:8.1f} ms")
