#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Jobs of every kind on small models, and the hashes of what they write: those of
tests/determinism/hashes.tsv, for every number of threads.

    scripts/determinism.py                     the jobs with 1, 2 and 7 threads; status 1 where one differs
    scripts/determinism.py --threads 1,64      with other numbers
    scripts/determinism.py --device cuda       grids of the device, which have the same hashes
    scripts/determinism.py --write             makes the table anew: for results that are meant to change

Volumes are judged by `tetvdb info --hash`, other files by their bytes without the program's version.
"""

import argparse
import hashlib
import json
import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
TABLE = ROOT / "tests/determinism/hashes.tsv"

PRINTER = "--pixels 80,60 --display 16,12 --layer-height 0.5"
# Arguments, without the threads, and what is hashed. Later jobs may read what earlier ones wrote.
JOBS = """
voxelize ball.stl -o density.vdb --resolution 64
voxelize ball.stl -o mask.vdb --resolution 64 --grid mask --mask-type mask
voxelize ball.stl -o surface.vdb --resolution 48 --grid surface
voxelize ball.stl -o wide.vdb --resolution 24 --grid surface --half-width all
voxelize ball.stl -o fog.vdb --resolution 48 --grid fog
voxelize ball.stl -o coverage.vdb --resolution 48 --grid coverage
voxelize ball.stl -o any.vdb --resolution 48 --rule any
voxelize ball.stl -o all.vdb --resolution 48 --rule all
voxelize ball.stl -o long.vdb --voxel-size 0.1,0.07,0.13
voxelize ball.stl -o fit.vdb --fit 32 --padding 2 --grid mask
voxelize ball.stl -o dense.nvdb --resolution 48 --grid density,surface
voxelize ball.stl -o dense.npy --resolution 32
voxelize ball.stl -o dense.raw --resolution 32 --grid surface
voxelize open.off -o holes.vdb --resolution 64
voxelize open.off -o shell.vdb --resolution 48 --shell 0.3
voxelize open.off -o side.vdb --resolution 48 --shell 0.3 --shell-side outward
voxelize crossed.off -o union.vdb --resolution 64 --grid density,surface
voxelize crossed.off -o nonzero.vdb --resolution 48 --inside nonzero
voxelize crossed.off -o parity.vdb --resolution 48 --inside parity
voxelize crossed.off -o flood.vdb --resolution 48 --inside flood
voxelize ball.stl open.off -o parts.vdb --resolution 48 --grid material,density
voxelize open.off -o enveloped.vdb --resolution 16 --mesher envelope --grid density,tet_id
voxelize lattice.msh -o owners.vdb --resolution 48 --grid density,tet_id
voxelize lattice.msh -o materials.vdb --resolution 48 --grid material,coverage
voxelize lattice.msh -o tets.vdb --resolution 48 --grid surface
voxelize lattice.msh -o touched.vdb --resolution 48 --rule any --grid mask
voxelize beam.vtu -o fields.vdb --resolution 48 --grid density,temperature,velocity
voxelize beam.vtu -o half.vdb --resolution 48 --grid temperature --half
voxelize rod.off -o rod.vdb --voxel-size 2 --grid mask --shard 0/2 : rod.0-of-2.vdb
voxelize rod.off -o rod.vdb --voxel-size 2 --grid mask --shard 1/2 : rod.1-of-2.vdb
merge rod.0-of-2.vdb rod.1-of-2.vdb -o merged.vdb
tetrahedralize crossed.off -o solid.msh --epsilon 2e-2d
tetrahedralize open.off -o closed.vtu --epsilon 2e-2d
repair open.off -o closed.off
repair crossed.off -o union.obj
repair open.off -o remade.off --remesh --resolution 24
repair ball.stl -o fewer.off --faces 60
prepare ball.stl -o hollow.off --hollow 0.3 --voxel-size 0.15
slice ball.stl -o layers.cli PRINTER
slice ball.stl -o layers PRINTER --format bmp
slice crossed.off -o grey PRINTER --aa area --format bmp
convert density.vdb -o again.nvdb
convert surface.vdb -o surface.off
convert coverage.vdb -o coverage.npy
convert lattice.msh -o lattice.mesh
dataset models -o set --resolution 16 --content occupancy,distance,points,samples --format npy --no-preview
render surface.vdb -o picture.png --size 64x48
"""


def ball(rings, radius, centre):
    points, faces = [], []
    for i in range(1, rings):
        for j in range(2 * rings):
            a, b = math.pi * i / rings, math.pi * j / rings
            points.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))
    at = lambda i, j: (i - 1) * 2 * rings + j % (2 * rings)
    for i in range(1, rings - 1):
        for j in range(2 * rings):
            faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    top, bottom = len(points), len(points) + 1
    points += [(0, 0, 1), (0, 0, -1)]
    for j in range(2 * rings):
        faces += [(top, at(1, j), at(1, j + 1)), (bottom, at(rings - 1, j + 1), at(rings - 1, j))]
    # Multiples of 2^-20, which every C library and every text prints alike.
    return [tuple(round((radius * c + o) * 2**20) / 2**20 for c, o in zip(p, centre))
            for p in points], faces


def box(low, high):
    points = [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, [(q[0], q[k], q[k + 1]) for q in squares for k in (1, 2)]


def joined(*meshes):
    points, faces = [], []
    for more, corners in meshes:
        faces += [[c + len(points) for c in face] for face in corners]
        points = points + list(more)
    return points, faces


def off(mesh):
    points, faces = mesh
    lines = ["OFF", f"{len(points)} {len(faces)} 0"] + ["%r %r %r" % tuple(p) for p in points]
    return "\n".join(lines + ["3 %d %d %d" % tuple(face) for face in faces] + [""])


def stl(mesh):
    points, faces = mesh
    data = bytes(80) + struct.pack("<I", len(faces))
    for face in faces:
        data += struct.pack("<12fH", 0, 0, 0, *(c for i in face for c in points[i]), 0)
    return data


def lattice(cells):
    n = cells + 1
    points = [(x / cells + y / 8, y / cells, z / cells) for z in range(n) for y in range(n) for x in range(n)]
    paths = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]
    tets = []
    for at in ((x, y, z) for z in range(cells) for y in range(cells) for x in range(cells)):
        for path in paths:
            corner, tet = list(at), [at[0] + n * (at[1] + n * at[2])]
            for axis in path:
                corner[axis] += 1
                tet.append(corner[0] + n * (corner[1] + n * corner[2]))
            tets.append(tet)
    return points, tets


def gmsh(points, tets):
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
    lines += ["%d %r %r %r" % (i + 1, *p) for i, p in enumerate(points)] + ["$EndNodes", "$Elements"]
    lines += [str(len(tets))] + ["%d 4 2 %d %d %d %d %d %d" % (i + 1, i % 3, i % 3, *(c + 1 for c in t))
                                 for i, t in enumerate(tets)]
    return "\n".join(lines + ["$EndElements", ""])


def vtu(points, tets):
    flat = lambda rows: " ".join(repr(v) for row in rows for v in row)
    array = lambda kind, name, n, text: (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{n}" '
                                         f'format="ascii">{text}</DataArray>')
    return (f'<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(tets)}"><PointData>'
            + array("Float64", "temperature", 1, flat((x * y + z,) for x, y, z in points))
            + array("Float64", "velocity", 3, flat((y, -x, z * z) for x, y, z in points))
            + "</PointData><Points>" + array("Float64", "Points", 3, flat(points)) + "</Points><Cells>"
            + array("Int64", "connectivity", 1, flat(tets))
            + array("Int64", "offsets", 1, flat((4 * (i + 1),) for i in range(len(tets))))
            + array("UInt8", "types", 1, flat((10,) for _ in tets))
            + "</Cells></Piece></UnstructuredGrid></VTKFile>")


def make_inputs(folder):
    sphere = ball(10, 1.5, (0.25, -0.125, 1.5))
    crossed = joined(box((0.0, 0.0, 0.0), (1.0, 1.25, 2.0)), ball(8, 0.75, (1.0, 0.5, 1.0)))
    slanted = joined(box((-30.0, 0.0, 0.0), (9000.0, 40.0, 30.0)))
    (folder / "ball.stl").write_bytes(stl(sphere))
    (folder / "open.off").write_text(off((sphere[0], sphere[1][:40] + sphere[1][46:])))
    (folder / "crossed.off").write_text(off(crossed))
    (folder / "rod.off").write_text(off(slanted))
    (folder / "lattice.msh").write_text(gmsh(*lattice(4)))
    (folder / "beam.vtu").write_text(vtu(*lattice(3)))
    (folder / "models").mkdir()
    (folder / "models/ball.stl").write_bytes(stl(sphere))
    (folder / "models/crossed.off").write_text(off(crossed))


def bytes_of(path, version):
    return path.read_bytes().replace(version, b"VERSION")


def hash_of(program, path, version):
    if path.suffix in (".vdb", ".nvdb"):
        report = subprocess.run([program, "info", path, "--hash", "--json", "-"], capture_output=True,
                                check=True)
        return json.loads(report.stdout)["input"][0]["hash"]
    digest = hashlib.sha256()
    for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
        if file.is_file() and file.suffix not in (".csv", ".json", ".jsonl", ".md"):
            digest.update(str(file.relative_to(path)).encode() + bytes_of(file, version))
    return digest.hexdigest()[:32]


def run_jobs(program, threads, device):
    """Hash of each job; what went wrong where there is none."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="tetvdb-determinism-"))
    version = subprocess.run([program, "--version"], capture_output=True, check=True).stdout.split()[1]
    hashes = {}
    try:
        make_inputs(folder)
        for line in JOBS.strip().splitlines():
            words, _, result = line.partition(" : ")
            words = words.replace("PRINTER", PRINTER).split()
            result = result or words[words.index("-o") + 1]
            more = ["--workers", str(threads)] if words[0] == "dataset" else (
                [] if words[0] in ("merge", "render") else ["--threads", str(threads)])
            if device and words[0] == "voxelize":
                more += ["--device", device]
            done = subprocess.run([program, *words, *more, "-q"], cwd=folder, capture_output=True, text=True)
            if done.returncode not in (0, 1):
                hashes[line] = f"status {done.returncode}: {done.stderr.strip()}"
            else:
                hashes[line] = hash_of(program, folder / result, version)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return hashes


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=os.environ.get(
        "TETVDB_PROGRAM", str(ROOT / "build/release/bin/tetvdb")))
    parser.add_argument("--threads", default="1,2,7")
    parser.add_argument("--device", default="")
    parser.add_argument("--write", action="store_true")
    settings = parser.parse_args()
    program = str(pathlib.Path(settings.program).resolve())
    numbers = [int(n) for n in settings.threads.split(",")]
    if settings.write:
        hashes = run_jobs(program, 1, "")
        TABLE.write_text("".join(f"{found}\t{line}\n" for line, found in hashes.items()))
        wrong = [line for line, found in hashes.items() if found.startswith("status")]
        print("\n".join(f"{line}\n  {hashes[line]}" for line in wrong))
        return 1 if wrong else 0
    expected = {line: found for found, line in
                (row.split("\t") for row in TABLE.read_text().splitlines())}
    wrong = 0
    for threads in numbers:
        hashes = run_jobs(program, threads, settings.device)
        for line in sorted(set(hashes) | set(expected)):
            if hashes.get(line) != expected.get(line):
                wrong += 1
                print(f"{threads} threads: tetvdb {line}\n  {hashes.get(line)}, not {expected.get(line)}")
    print(f"{len(expected)} jobs with {settings.threads} threads: {wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
