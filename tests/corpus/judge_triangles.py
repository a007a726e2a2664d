#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Judges `tetvdb voxelize` on every triangle file of the corpus by means of its own.

    TETVDB_PROGRAM=tetvdb TETVDB_JUDGE=winding_judge TETVDB_CORPUS=FOLDER judge_triangles.py [NAME...]

The file is read by the parsers of tri_oracle.py, the volume by OpenVDB's Python module; winding
numbers come from winding_judge, which sums solid angles face by face. Of each file at 64 voxels:

- the cleaned faces (--write-mesh) are among the file's own, as sets of three points, but for the last, which close
  components: as many as the report says, over boundary edges of the others, and with no boundary edges of their own;
- a voxel is active if and only if the winding number of the cleaned faces at its centre is above
  0.5: at voxels all over the box, beside the surface of the volume and beside the faces. Centres on
  a face (within 1e-5 voxel) are judged again, with the points on the lattice of 2^-20 voxel and the
  centre moved by (e, e^2, e^3), as docs/algorithms.md has it; only winding numbers within 1e-4 of
  0.5 are left out (0.02 where the program warns that it looked roughly), and they are counted;
- where nothing was turned or dropped, the file's own faces have the same winding numbers.

Meshes without an inside are in WITHOUT_INSIDE: no voxel may have one, and as a shell they must come
out as what lies within half the thickness.
"""
import concurrent.futures
import fractions
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
import zlib

try:
    import numpy
    import pyopenvdb
except ImportError as missing:
    print(f"SKIPPED: {missing} (Debian: apt-get install python3-openvdb python3-numpy)")
    sys.exit(77)

import tri_oracle

PROGRAM = os.environ.get("TETVDB_PROGRAM", "tetvdb")
JUDGE = os.environ.get("TETVDB_JUDGE", "winding_judge")
THREADS = os.environ.get("TETVDB_JUDGE_THREADS", "1")  # of one call; files are judged side by side
RESOLUTION = 64
SCALE = int(os.environ.get("TETVDB_TEST_SCALE", "1"))  # scripts/weekly.sh: 4
POINTS = 2500 * SCALE  # judged in a file; fewer, but FEWEST, where they and the faces are more than ANGLES
FEWEST = 1000 * SCALE
ANGLES = 1.9e7 * SCALE
UNDECIDED = 1e-4  # winding numbers this near to 0.5 are not judged
ROUGH = 0.02  # the same where the program says that it only looked roughly (warning rough-winding)
TOUCHING = 1e-5  # voxels: centres this near to a face are judged on the lattice
LATTICE = 2.0 ** 20
# Made of beams, which the parsers count and do not make: tests/io/formats/threemf/TestBeamLattice.cpp has them.
LATTICES = {"3mf-samples__spinal_implant.3mf"}
LARGE = 150000  # bytes: of files from here on one in four is judged, by their names, and all by SCALE 4

# Right to be refused without --shell, by what they look like.
WITHOUT_INSIDE = {
    "bullet3__part106.obj": "an open plate, a sixth of a voxel thick",
    "common3d__alligator.obj": "a plane figure",
    "geometry-central__lego.ply": "a plane figure",
    "lagrange__nonmanifold_vertex.obj": "two squares in a plane that meet at a corner",
    "lagrange__nonoriented_edge.obj": "two squares in a plane",
    "lagrange__moebius-160-10.ply": "a strip with half a twist",
    "libigl-tests-data__annulus.obj": "a plane ring",
    "libigl-tests-data__sliver_tet.ply": "one tetrahedron, a sliver between voxel centres",
    "openfoam__multiCollapse.stl": "13 triangles in a plane",
    "polyfem-data__top.obj": "a plane grid",
    "tinyobjloader__issue-140-zero-face-idx.obj": "one triangle",
    "tinyobjloader__issue-319-002.obj": "three polygons apart",
    "trimesh__notenoughindices.obj": "one triangle",
}


class Wrong(Exception):
    pass


def require(holds, text):
    if not holds:
        raise Wrong(text)


def require_none(wrong, voxels, windings, where):
    if wrong.any():
        first = wrong.nonzero()[0][0]
        raise Wrong("{} of {} doubtful voxels {} are wrong, such as {} with winding number {:.6f}".format(
            int(wrong.sum()), len(wrong), where, voxels[first].astype(int).tolist(), windings[first]))


class Soup:
    """Points and triangles as arrays."""

    def __init__(self, points, triangles):
        self.points = numpy.asarray(points, dtype=numpy.float64).reshape(-1, 3)
        self.triangles = numpy.asarray(triangles, dtype=numpy.int32).reshape(-1, 3)

    def used(self):
        return self.points[numpy.unique(self.triangles)]

    def corners(self):
        return self.points[self.triangles]

    def boundary(self):
        """The boundary edges, as triangles of zero width."""
        balance = {}
        for a, b, c in self.triangles.tolist():
            for v, w in ((a, b), (b, c), (c, a)):
                key = (min(v, w), max(v, w))
                balance[key] = balance.get(key, 0) + (1 if v < w else -1)
        return Soup(self.points, [(v, w, w) for (v, w), sum_ in balance.items() if sum_])

    def volume(self):
        a, b, c = (self.corners()[:, k] for k in range(3))
        return math.fsum((a * numpy.cross(b, c)).sum(axis=1)) / 6


def read_raw(path):
    """The file's good polygons as fans, and whether some were left out."""
    mesh = tri_oracle.read(path)
    status = mesh.result()[0]
    finite = [p is not None and all(map(math.isfinite, p)) for p in mesh.points]
    points = [p if good else (0, 0, 0) for p, good in zip(mesh.points, finite)]
    triangles = []
    for polygon in mesh.polygons:
        if len(polygon) > 2 and all(i is not None and 0 <= i < len(points) and finite[i] for i in polygon):
            triangles += [(polygon[0], polygon[j], polygon[j + 1]) for j in range(1, len(polygon) - 1)]
    return Soup(points, triangles), status


def read_off(path):
    with open(path, encoding="ascii") as file:
        words = file.read().split()
    n, faces = int(words[1]), int(words[2])
    points = numpy.array(words[4:4 + 3 * n], dtype=numpy.float64)
    rows = numpy.array(words[4 + 3 * n:], dtype=numpy.int64).reshape(faces, 4)
    require((rows[:, 0] == 3).all(), "the cleaned mesh has faces that are no triangles")
    return Soup(points, rows[:, 1:])


def judge(mode, soup, points, folder):
    """winding_judge's answers at `points`."""
    given, found = os.path.join(folder, "judge.in"), os.path.join(folder, "judge.out")
    with open(given, "wb") as file:
        file.write(numpy.array([len(soup.points), len(soup.triangles), len(points)], dtype=numpy.int64).tobytes())
        file.write(soup.points.tobytes())
        file.write(soup.triangles.tobytes())
        file.write(numpy.ascontiguousarray(points, dtype=numpy.float64).tobytes())
    subprocess.run([JUDGE, mode, given, found, THREADS], check=True)
    return numpy.fromfile(found, dtype=numpy.float64)


def winding_by_arctangents(soup, point):
    """The judge's judge: the sum as Van Oosterom and Strackee wrote it."""
    a, b, c = (soup.corners()[:, k] - point for k in range(3))
    la, lb, lc = (numpy.sqrt((v * v).sum(axis=1)) for v in (a, b, c))
    above = (a * numpy.cross(b, c)).sum(axis=1)
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return math.fsum(numpy.arctan2(above, below)) / (2 * math.pi)


def nearest(points, targets):
    found = numpy.empty(len(points), dtype=numpy.int64)
    for i in range(0, len(points), 256):
        between = points[i:i + 256, None, :] - targets[None, :, :]
        found[i:i + 256] = (between * between).sum(axis=2).argmin(axis=1)
    return found


def check_subset(raw, cleaned, rounded):
    """Every cleaned face is one of the file's; `rounded`: points were kept as floats meanwhile."""
    if rounded:  # the file's points become the cleaned ones nearest to them
        far = numpy.abs(raw.points[nearest(cleaned.points, raw.points)] - cleaned.points).max()
        require(far < 1e-6 * numpy.abs(raw.points).max(), f"a cleaned point is {far} from the file's")
        raw_names, names = nearest(raw.points, cleaned.points).tolist(), list(range(len(cleaned.points)))
    else:
        table = {}
        raw_names = [table.setdefault(p, len(table)) for p in map(tuple, (raw.points + 0.0).tolist())]
        names = [table.get(p) for p in map(tuple, (cleaned.points + 0.0).tolist())]
        require(None not in names, "a cleaned point is none of the file's")
    left = {}
    for a, b, c in raw.triangles.tolist():
        face = tuple(sorted((raw_names[a], raw_names[b], raw_names[c])))
        left[face] = left.get(face, 0) + 1
    for a, b, c in cleaned.triangles.tolist():
        face = tuple(sorted((names[a], names[b], names[c])))
        require(left.get(face, 0) > 0, f"cleaned face {face} is none of the file's, or is there too often")
        left[face] -= 1


def split_closing(cleaned, counts):
    """The cleaned mesh without the faces that close components."""
    kept = cleaned.triangles[:len(cleaned.triangles) - counts["closing_faces"]]
    require((counts["closed_holes"] > 0) == (counts["closing_faces"] > 0), "holes are closed without faces")
    given = Soup(cleaned.points[:kept.max() + 1], kept)
    if counts["closing_faces"]:
        before, after = ({tuple(edge[:2]) for edge in mesh.boundary().triangles.tolist()} for mesh in (given, cleaned))
        require(after < before, "faces that close components have boundary edges of their own")
    return given


def side(corners, point):
    """Of the plane through three corners: 1 where its normal points, -1, or by the rule for ties."""
    a, b, c, p = ([fractions.Fraction(float(x)) for x in v] for v in (*corners, point))
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, p))
    normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    for x in (sum(n * d for n, d in zip(normal, w)), *normal):
        if x != 0:
            return 1 if x > 0 else -1
    return 0


def jump(soup, centre, moved, folder):
    """What the winding number gains from `moved` back to the centre, perturbed as the rule has it."""
    gain = 0
    for triangle in soup.triangles:
        alone = Soup(soup.points, triangle)
        a, b, c = soup.points[triangle]
        normal = numpy.cross(b - a, c - a)
        if abs(normal @ (centre - a)) <= TOUCHING * math.sqrt(normal @ normal) and \
                judge("distance", alone, centre[None, :], folder)[0] < TOUCHING:
            gain += (side((a, b, c), moved) - side((a, b, c), centre)) // 2
    return gain


class Space:
    """Index space, moved by whole voxels so that the mesh begins near 0."""

    def __init__(self, soup, size, origin):
        self.size, self.origin = size, origin
        index = (soup.used() - origin) / size
        self.base = numpy.floor(index.min(axis=0)) - 4
        self.shape = (numpy.ceil(index.max(axis=0)) + 5 - self.base).astype(int)

    def cover(self, first, last):
        """Grows to hold these voxels as well: holes of many sheets may bulge out of the box."""
        end = numpy.maximum(self.base + self.shape, numpy.array(last) + 5)
        self.base = numpy.minimum(self.base, numpy.array(first) - 4)
        self.shape = (end - self.base).astype(int)

    def of(self, soup):
        return Soup((soup.points - self.origin) / self.size - self.base, soup.triangles)

    def on_lattice(self, soup):
        return Soup(numpy.rint((soup.points - self.origin) / self.size * LATTICE) / LATTICE - self.base,
                    soup.triangles)


def dense(grid, space):
    """Active states of the space's box; nothing may be active outside, nor off inside what is on."""
    values = numpy.zeros(tuple(space.shape), dtype=bool)
    first = tuple(int(b) for b in space.base)
    grid.copyToArray(values, ijk=first)
    require(int(values.sum()) == grid.activeVoxelCount(),
            f"{grid.activeVoxelCount()} voxels are active, {int(values.sum())} are true in the box")
    return values


def choose_points(values, soup, count, seed):
    """Voxels all over, in pairs beside the volume's surface, and beside faces: indices."""
    dice = numpy.random.default_rng(seed)
    shape = numpy.array(values.shape)
    chosen = [dice.integers(0, shape, size=(count // 2, 3))]
    pairs = []
    for axis in range(3):
        at = numpy.argwhere(numpy.diff(values, axis=axis))
        step = numpy.eye(3, dtype=int)[axis]
        pairs.append(numpy.stack([at, at + step], axis=1))
    pairs = numpy.concatenate(pairs)
    if len(pairs):
        chosen.append(pairs[dice.integers(0, len(pairs), size=count * 3 // 20)].reshape(-1, 3))
    corners = soup.corners()[dice.integers(0, len(soup.triangles), size=count // 5)]
    shares = dice.dirichlet((1, 1, 1), size=len(corners))
    chosen.append(numpy.rint((corners * shares[:, :, None]).sum(axis=1)).astype(int))
    chosen = numpy.concatenate(chosen)
    return chosen[((chosen >= 0) & (chosen < shape)).all(axis=1)]


def undecided_within(report):
    rough = any(warning["code"] == "rough-winding" for warning in report["warnings"])
    return ROUGH if rough else UNDECIDED


def compare(values, accessor, space, cleaned, margin, facts, folder, seed):
    """Active states against winding numbers."""
    soup = space.of(cleaned)
    points = choose_points(values, soup, max(FEWEST, min(POINTS, int(ANGLES / len(soup.triangles)))), seed)
    w = judge("winding", soup, points, folder)
    for i in range(0, len(points), max(1, len(points) // 3)):
        other = winding_by_arctangents(soup, points[i])
        if judge("distance", soup, points[i:i + 1], folder)[0] > TOUCHING:
            require(abs(w[i] - other) < 1e-8, f"the judge errs: {w[i]} for {other}")
    active = values[tuple(points.T)]
    for point, on in zip(points[:500], active[:500]):
        there = accessor.isValueOn(tuple(int(c) for c in point + space.base))
        require(there == on, "active state and value differ")
    facts["points"] = len(points)
    undecided = numpy.abs(w - 0.5) <= margin
    differ = ((w > 0.5) != active) & ~undecided
    if differ.any():
        doubtful = points[differ]
        apart = judge("distance", soup, doubtful, folder) >= TOUCHING
        require_none(apart, doubtful + space.base, w[differ], "off faces")
        moved = doubtful + numpy.array([2.0 ** -24, 2.0 ** -34, 2.0 ** -44])
        lattice = space.on_lattice(cleaned)
        again = judge("winding", lattice, moved, folder)
        wrong = ((again > 0.5) != active[differ]) & (numpy.abs(again - 0.5) > margin)
        facts["on faces"] = len(doubtful)
        boundary = soup.boundary()
        if wrong.any() and len(boundary.triangles):  # the winding number is not continuous there
            on_boundary = judge("distance", boundary, doubtful, folder) < TOUCHING
            facts["on boundary edges"] = int(on_boundary.sum())
            wrong &= ~on_boundary
        for i in wrong.nonzero()[0]:  # a plane may pass between the centre and where it was moved
            again[i] += jump(lattice, doubtful[i], moved[i], folder)
            wrong[i] = (again[i] > 0.5) != active[differ][i] and abs(again[i] - 0.5) > margin
        require_none(wrong, doubtful + space.base, again, "on faces")
    facts["undecided"] = int(undecided.sum())
    require(facts["undecided"] <= len(points) // 20, f"{facts['undecided']} points are undecided")
    return points, w


def compare_raw(raw, cleaned, space, points, w, report, facts, folder):
    """The changes that cleaning made."""
    step = max(1, len(points) // 2000)
    soup = space.of(raw)
    own = judge("winding", soup, points[::step], folder)
    w = w[::step]
    counts = report["mesh"]["cleaned"]
    if counts["flipped_faces"] + counts["duplicate_faces"] + counts["inner_faces"] == 0:
        apart = judge("distance", soup, points[::step][:200], folder) > TOUCHING
        off = numpy.abs(own[:200] - w[:200])[apart]
        require(off.size == 0 or off.max() < 1e-4, f"cleaning moved a winding number by {off.max():.3g}")
    changed = (numpy.abs(own) > 0.5) != (w > 0.5)
    if changed.any():
        facts["changed by cleaning"] = f"{changed.mean():.2%}"
    if counts["flipped_faces"] or counts["duplicate_faces"]:
        facts["cleaned"] = "{flipped_faces} turned, {duplicate_faces} duplicates".format(**counts)


def voxelize(path, folder, *options):
    report = os.path.join(folder, "report.json")
    done = subprocess.run(
        [PROGRAM, "voxelize", path, "--weld", "0", "--threads", "1", "--grid", "mask", "--json", report, "-q", *options],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    text = {}
    if os.path.exists(report):
        with open(report, encoding="utf-8") as file:
            text = json.load(file)
        os.remove(report)
    return done.returncode, done.stderr.strip(), text


def judge_without_inside(path, folder, status, said, facts, seed):
    require(status == 3 and said.count("\n") == 0, f"ended with {status}: {said}")
    off = os.path.join(folder, "cleaned.off")
    voxelize(path, folder, "--write-mesh", off)
    cleaned = read_off(off)
    used = cleaned.used()
    size = (used.max(axis=0) - used.min(axis=0)).max() / RESOLUTION
    space = Space(cleaned, size, numpy.zeros(3))
    soup = space.of(cleaned)
    points = choose_points(numpy.zeros(tuple(space.shape), dtype=bool), soup, POINTS, seed)
    w = judge("winding", soup, points, folder)
    inside = w > 0.5 + UNDECIDED
    if inside.any():
        apart = judge("distance", soup, points[inside], folder) >= TOUCHING
        require(not apart.any(), f"{int(apart.sum())} of {len(points)} voxels have an inside")
    facts["points"] = len(points)
    # As a shell.
    volume = os.path.join(folder, "shell.vdb")
    status, said, _ = voxelize(path, folder, "-o", volume, "--voxel-size", repr(float(size)), "--shell",
                               repr(float(3 * size)))
    require(status in (0, 1), f"as a shell ended with {status}: {said}")
    values = dense(pyopenvdb.readAll(volume)[0][0], space)
    apart = judge("distance", soup, points, folder)
    wrong = ((apart < 1.5) != values[tuple(points.T)]) & (numpy.abs(apart - 1.5) > TOUCHING)
    require(not wrong.any(), f"{int(wrong.sum())} of {len(points)} voxels of the shell are wrong")


def judge_file(path):
    """What there is to say of a file; raises Wrong."""
    name = os.path.basename(path)
    seed = zlib.crc32(name.encode())
    facts = {}
    with tempfile.TemporaryDirectory(prefix="tetvdb-judge-") as folder:
        volume, off = os.path.join(folder, "volume.vdb"), os.path.join(folder, "cleaned.off")
        started = time.monotonic()
        status, said, report = voxelize(path, folder, "-o", volume, "--resolution", str(RESOLUTION),
                                        "--write-mesh", off)
        facts["program"] = f"{time.monotonic() - started:.1f} s"
        try:
            raw, readable = read_raw(path)
        except tri_oracle.Refused as reason:
            require(status == 3 and said.count("\n") == 0, f"ended with {status}, is broken: {reason}")
            return {"refused": said}
        if name in WITHOUT_INSIDE:
            judge_without_inside(path, folder, status, said, facts, seed)
            return {"without inside": WITHOUT_INSIDE[name], **facts}
        doubtful = any(w["code"] == "doubtful-orientation" for w in report["warnings"])
        require(status == (1 if readable == "partial" or doubtful else 0), f"ended with {status}: {said}")
        if doubtful:
            facts["doubtful"] = "orientation"
        cleaned = read_off(off)
        counts = report["mesh"]["cleaned"]
        given = split_closing(cleaned, counts)
        check_subset(raw, given, path.lower().endswith(".3mf"))
        if counts["closed_holes"]:
            facts["closed"] = "{closed_holes} holes by {closing_faces} faces".format(**counts)
        grid = pyopenvdb.readAll(volume)[0][0]
        size, origin = numpy.array(grid.transform.voxelSize()), numpy.array(grid.transform.indexToWorld((0, 0, 0)))
        space = Space(cleaned, size, origin)
        space.cover(*grid.evalActiveVoxelBoundingBox())
        values = dense(grid, space)
        points, w = compare(values, grid.getConstAccessor(), space, cleaned, undecided_within(report), facts,
                            folder, seed)
        if report["mesh"]["closed"]:
            whole = numpy.abs(w - numpy.rint(w)) > 1e-6
            apart = judge("distance", space.of(cleaned), points[whole], folder) > TOUCHING if whole.any() else whole
            require(not apart.any(), "the mesh is called closed, but its winding numbers are not whole")
        if not counts["closed_holes"]:
            compare_raw(raw, cleaned, space, points, w, report, facts, folder)
        facts["volume"] = "{:.4g} of faces, {:.4g} of voxels".format(cleaned.volume() / size.prod(),
                                                                    int(values.sum()))
    return facts


def judged(path):
    try:
        return path, None, judge_file(path)
    except Wrong as wrong:
        return path, str(wrong), {}


def main(names):
    corpus = os.environ.get("TETVDB_CORPUS")
    if corpus is None:
        print("SKIPPED: TETVDB_CORPUS is not set")
        return 77
    folder = os.path.join(corpus, "tri")
    paths = [os.path.join(folder, name) for name in names or set(os.listdir(folder)) - LATTICES]
    if not names:
        paths = [path for path in paths
                 if os.path.getsize(path) < LARGE or zlib.crc32(os.path.basename(path).encode()) % 4 < SCALE]
    paths.sort(key=os.path.getsize, reverse=True)  # so that no long one comes last
    failed = 0
    with concurrent.futures.ProcessPoolExecutor(max_workers=os.cpu_count()) as workers:
        for path, wrong, facts in workers.map(judged, paths):
            failed += wrong is not None
            said = ", ".join(f"{key}: {value}" for key, value in facts.items())
            print(f"{'WRONG ' if wrong else 'right '} {os.path.basename(path)}: {wrong or said}", flush=True)
    print(f"{len(paths)} files, {failed} wrong")
    return 1 if failed or len(paths) == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
