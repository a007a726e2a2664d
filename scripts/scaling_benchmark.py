#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times stages of tetvdb's commands with 1, 2, 4, ... threads, and prints how many times faster each
is than with one thread. The minimum of --repeat runs.

    scripts/scaling_benchmark.py [--program build/release/bin/tetvdb] [--threads 1,2,4,8,16] [--repeat 3]
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from slice_benchmark import bumpy_ellipsoid  # noqa: E402


def tet_grid(path, n):
    """6 n^3 tets (Kuhn) of a bent block with a point array, as legacy VTK."""
    axis = np.arange(n + 1)
    index = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1)
    points = index.reshape(-1, 3) / n
    points = points + 0.1 * np.sin(3 * points[:, [1, 2, 0]])
    number = lambda i: (i[..., 0] * (n + 1) + i[..., 1]) * (n + 1) + i[..., 2]
    corner = index[:-1, :-1, :-1].reshape(-1, 3)
    tets = []
    for first in range(3):
        for second in range(3):
            if first != second:
                a = np.eye(3, dtype=int)[first]
                b = a + np.eye(3, dtype=int)[second]
                tets.append(np.stack([number(corner), number(corner + a), number(corner + b),
                                      number(corner + 1)], -1))
    tets = np.concatenate(tets)
    cells = np.concatenate([np.full((len(tets), 1), 4), tets], 1)
    with open(path, "wb") as file:
        file.write(b"# vtk DataFile Version 3.0\nblock\nBINARY\nDATASET UNSTRUCTURED_GRID\n")
        file.write(b"POINTS %d double\n" % len(points) + points.astype(">f8").tobytes())
        file.write(b"\nCELLS %d %d\n" % (len(tets), cells.size) + cells.astype(">i4").tobytes())
        file.write(b"\nCELL_TYPES %d\n" % len(tets) + np.full(len(tets), 10, ">i4").tobytes())
        file.write(b"\nPOINT_DATA %d\nSCALARS heat double 1\nLOOKUP_TABLE default\n" % len(points))
        file.write(np.cos(9 * points).sum(1).astype(">f8").tobytes())


def without_patch(source, path):
    """The triangles of a binary STL but those of a patch."""
    data = np.frombuffer(pathlib.Path(source).read_bytes()[84:], np.uint8).reshape(-1, 50)
    corners = data[:, 12:48].copy().view("<f4").reshape(-1, 3, 3)
    kept = data[corners[:, 0, 2] < 0.8 * corners[..., 2].max()]
    pathlib.Path(path).write_bytes(b"\0" * 80 + np.uint32(len(kept)).tobytes() + kept.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--program", default="build/release/bin/tetvdb")
    parser.add_argument("--threads", default="1,2,4,8,16")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    threads = [int(t) for t in options.threads.split(",")]
    program = os.path.abspath(options.program)

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        bumpy_ellipsoid("closed.stl", 640, 240, 1)
        bumpy_ellipsoid("coarse.stl", 160, 80, 1)
        without_patch("closed.stl", "open.stl")
        tet_grid("tets.vtk", 55)
        subprocess.run([program, "voxelize", "closed.stl", "-o", "fog.vdb", "--resolution", "512", "--grid",
                        "fog", "-q"], check=True)
        jobs = [  # name, command, and the stage: without one, all but reading and writing
            ("triangles, density, 2048^3",
             "voxelize closed.stl -o o.vdb --resolution 2048 --device cpu"),
            ("open triangles, density, 256^3",
             "voxelize open.stl -o o.vdb --resolution 256 --device cpu"),
            ("triangles, level set, 512^3",
             "voxelize closed.stl -o o.vdb --resolution 512 --grid surface --device cpu"),
            ("triangles, coverage, 256^3",
             "voxelize closed.stl -o o.vdb --resolution 256 --grid coverage --device cpu"),
            ("10^6 tets, density, 512^3",
             "voxelize tets.vtk -o o.vdb --resolution 512 --grid density --device cpu"),
            ("10^6 tets, tet_id, 256^3",
             "voxelize tets.vtk -o o.vdb --resolution 256 --grid tet_id --device cpu"),
            ("10^6 tets, point array, 256^3",
             "voxelize tets.vtk -o o.vdb --resolution 256 --grid heat --device cpu"),
            ("writing that array's .vdb",
             "voxelize tets.vtk -o o.vdb --resolution 512 --grid heat --device cpu", "write"),
            ("tetrahedralize 25,280 triangles",
             "tetrahedralize coarse.stl -o o.msh"),
            ("repair, cleaning of 305,920 triangles",
             "repair closed.stl -o o.stl"),
            ("render a fog volume", "render fog.vdb -o o.png"),
        ]
        print("| | " + " | ".join(f"{t} thread{'s'[:t > 1]}" for t in threads) + " | faster |")
        print("|---|" + "---|" * (len(threads) + 1))
        for name, command, *stage in jobs:
            seconds = []
            for count in threads:
                best = float("inf")
                for _ in range(options.repeat):
                    subprocess.run([program, *command.split(), "--threads", str(count), "-q",
                                    "--json", "r.json"], check=True)
                    made = json.load(open("r.json"))["stages"]
                    best = min(best, sum(
                        s["seconds"] for s in made
                        if s["name"] in stage or not (stage or s["name"] in ("read", "write"))))
                seconds.append(best)
            print(f"| {name} | " + " | ".join(f"{1e3 * s:.0f} ms" for s in seconds)
                  + f" | {seconds[0] / seconds[-1]:.1f} |", flush=True)


if __name__ == "__main__":
    main()
