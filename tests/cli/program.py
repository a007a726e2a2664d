# SPDX-License-Identifier: Apache-2.0
"""Runs bin/tetvdb as a user would, and makes the meshes that the tests feed it."""

import functools
import json
import math
import os
import pathlib
import selectors
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.environ["TETVDB_PROGRAM"]
DATA = pathlib.Path(os.environ["TETVDB_TEST_DATA"])
SANITIZED = os.environ.get("TETVDB_SANITIZED", "") not in ("", "0")
SCALE = int(os.environ.get("TETVDB_TEST_SCALE", "1"))  # scripts/weekly.sh: 4


class Result:
    def __init__(self, status, out, err):
        self.status, self.out, self.err = status, out, err
        # A sanitizer says so where it looks up a report that it then suppresses.
        self.lines = [line for line in err.splitlines() if line.strip() and not line.startswith("LLVMSymbolizer: ")]

    def report(self):
        return json.loads(self.out)


class ProgramServer:
    """The program, started once: every command runs in a fork of it (ProgramServer.cpp)."""

    def __init__(self, library):
        self.socket, theirs = socket.socketpair()
        with theirs:
            self.process = subprocess.Popen(
                [PROGRAM], pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL,
                env={**os.environ, "LD_PRELOAD": library, "TETVDB_SERVER_SOCKET": str(theirs.fileno())})

    def run(self, arguments, folder, timeout, env=None):
        """As subprocess.run() with pipes and without input."""
        environment = os.environ if env is None else env
        texts = [b"".join(os.fsencode(line) + b"\0" for line in lines)
                 for lines in ((PROGRAM, *arguments), (f"{k}={v}" for k, v in environment.items()))]
        out, theirs_out = os.pipe()
        err, theirs_err = os.pipe()
        files = [os.open(os.devnull, os.O_RDONLY), theirs_out, theirs_err, os.open(folder, os.O_RDONLY)]
        socket.send_fds(self.socket, [struct.pack("II", *map(len, texts))], files)
        self.socket.sendall(b"".join(texts))
        for file in files:
            os.close(file)
        process = self.number()
        deadline = time.monotonic() + timeout
        said = {out: b"", err: b""}
        with selectors.DefaultSelector() as selector:
            for pipe in said:
                selector.register(pipe, selectors.EVENT_READ)
            while selector.get_map():
                ready = selector.select(max(deadline - time.monotonic(), 0))
                if not ready:
                    os.kill(process, signal.SIGKILL)
                    self.number()
                    raise subprocess.TimeoutExpired(arguments, timeout)
                for key, _ in ready:
                    data = os.read(key.fd, 1 << 16)
                    said[key.fd] += data
                    if not data:
                        selector.unregister(key.fd)
                        os.close(key.fd)
        status = os.waitstatus_to_exitcode(self.number())
        return subprocess.CompletedProcess(arguments, status, said[out], said[err])

    def number(self):
        return struct.unpack("i", self.socket.recv(4, socket.MSG_WAITALL))[0]


@functools.lru_cache(maxsize=None)
def server():
    library = os.environ.get("TETVDB_PROGRAM_SERVER")
    return ProgramServer(library) if library else None


def run(*arguments, folder=".", timeout=300, **options):
    """As subprocess.run(), for the program; its output as bytes."""
    arguments = [str(argument) for argument in arguments]
    # The workers of `dataset` are started by the command line that the system has of the process.
    if server() is not None and options.keys() <= {"env"} and "dataset" not in arguments:
        return server().run(arguments, folder, timeout, **options)
    return subprocess.run([PROGRAM, *arguments], cwd=folder, stdin=subprocess.DEVNULL, timeout=timeout,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


class CommandLineTest(unittest.TestCase):
    """Every test works in an empty folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="tetvdb-cli-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return self.folder / name

    def write(self, name, content):
        path = self.path(name)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def run_program(self, *arguments, timeout=300, **options):
        done = run(*arguments, folder=self.folder, timeout=timeout, **options)
        return Result(done.returncode, done.stdout.decode(errors="replace"),
                      done.stderr.decode(errors="replace"))

    def succeed(self, *arguments, status=0, **options):
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.status, status, result.err)
        return result

    def report_of(self, *arguments, status=0):
        return self.succeed(*arguments, "--json", "-", status=status).report()

    def refuse(self, statuses, *arguments, says=(), **options):
        """The program must fail with one of `statuses`, say why in one line, and leave nothing."""
        before = sorted(p.name for p in self.folder.iterdir())
        result = self.run_program(*arguments, **options)
        statuses = (statuses,) if isinstance(statuses, int) else tuple(statuses)
        self.assertIn(result.status, statuses, f"{arguments}: {result.err}")
        self.assertEqual(len(result.lines), 1, result.err)
        for text in (says,) if isinstance(says, str) else says:
            self.assertIn(text.lower(), result.lines[0].lower())
        self.assertEqual(result.out, "")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), before)
        return result

    def hash_of(self, path):
        return self.report_of("info", path, "--hash")["input"][0]["hash"]


def ball(rings, radius, centre, stretch=1.0):
    """A closed ball of triangles, `stretch` times as long along z: points, faces."""
    points, faces = [], []
    for i in range(1, rings):
        for j in range(2 * rings):
            a, b = math.pi * i / rings, math.pi * j / rings
            points.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b),
                           stretch * math.cos(a)))
    at = lambda i, j: (i - 1) * 2 * rings + j % (2 * rings)
    for i in range(1, rings - 1):
        for j in range(2 * rings):
            faces.append([at(i, j), at(i + 1, j), at(i + 1, j + 1)])
            faces.append([at(i, j), at(i + 1, j + 1), at(i, j + 1)])
    top, bottom = len(points), len(points) + 1
    points += [(0, 0, stretch), (0, 0, -stretch)]
    for j in range(2 * rings):
        faces.append([top, at(1, j), at(1, j + 1)])
        faces.append([bottom, at(rings - 1, j + 1), at(rings - 1, j)])
    return [tuple(radius * c + o for c, o in zip(p, centre)) for p in points], faces


def lattice(cells, origin=(0.0, 0.0, 0.0), side=1.0, inverted=False):
    """A cube cut into cells^3 small cubes of six tets each: points, tets. With `inverted`, every
    second tet is turned inside out."""
    n = cells + 1
    points = [tuple(origin[a] + side * index[a] / cells for a in range(3))
              for index in ((x, y, z) for z in range(n) for y in range(n) for x in range(n))]

    def number(x, y, z):
        return x + n * (y + n * z)

    tets = []
    paths = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]
    for z in range(cells):
        for y in range(cells):
            for x in range(cells):
                for order, path in enumerate(paths):
                    corner = [x, y, z]
                    tet = [number(*corner)]
                    for axis in path:
                        corner[axis] += 1
                        tet.append(number(*corner))
                    if order >= 3 and not inverted:
                        tet[2], tet[3] = tet[3], tet[2]
                    tets.append(tet)
    return points, tets


def medit(points, tets, regions=None):
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    lines += ["%r %r %r 0" % tuple(p) for p in points]
    lines += ["Tetrahedra", str(len(tets))]
    for i, tet in enumerate(tets):
        lines.append("%d %d %d %d %d" % (*(c + 1 for c in tet), regions[i] if regions else 1))
    return "\n".join(lines + ["End", ""])


def gmsh(points, tets, regions=None, names=None):
    """Gmsh 2.2, ASCII."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    if names:
        lines += ["$PhysicalNames", str(len(names))]
        lines += ['3 %d "%s"' % item for item in names.items()] + ["$EndPhysicalNames"]
    lines += ["$Nodes", str(len(points))]
    lines += ["%d %r %r %r" % (i + 1, *p) for i, p in enumerate(points)]
    lines += ["$EndNodes", "$Elements", str(len(tets))]
    for i, tet in enumerate(tets):
        region = regions[i] if regions else 1
        lines.append("%d 4 2 %d %d %d %d %d %d" % (i + 1, region, region, *(c + 1 for c in tet)))
    return "\n".join(lines + ["$EndElements", ""])


def vtu(points, tets):
    numbers = lambda rows: " ".join(str(v) for row in rows for v in row)
    return f"""<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(tets)}">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{numbers(points)}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{numbers(tets)}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{" ".join(str(4 * (i + 1)) for i in range(len(tets)))}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{" ".join(["10"] * len(tets))}</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
"""


def box_faces(low=(0.0, 0.0, 0.0), high=(1.0, 1.0, 1.0)):
    """A box of twelve triangles that look outward: points, faces."""
    points = [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, [[q[0], q[k], q[k + 1]] for q in squares for k in (1, 2)]


def opened(mesh):
    """A mesh of triangles without the first and a neighbour in another plane: the hole is not plane, so that the
    winding number closes it."""
    points, faces = mesh

    def normal(face):
        p, q, r = (points[c] for c in face)
        u, v = ([x[k] - p[k] for k in range(3)] for x in (q, r))
        return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]

    first = normal(faces[0])
    for i, face in enumerate(faces[1:], 1):
        other = normal(face)
        across = sum(x * y for x, y in zip(first, other)) ** 2
        if len(set(face) & set(faces[0])) == 2 and across < 0.99 * sum(x * x for x in first) * sum(x * x for x in other):
            return points, faces[1:i] + faces[i + 1:]
    raise ValueError("no neighbour lies in another plane")


def volume(mesh):
    """Of a closed mesh of triangles."""
    points, faces = mesh
    total = 0
    for a, b, c in faces:
        a, b, c = points[a], points[b], points[c]
        total += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                  + a[2] * (b[0] * c[1] - b[1] * c[0]))
    return total / 6


def joined(*meshes):
    """One mesh of several: points, faces."""
    points, faces = [], []
    for more, corners in meshes:
        faces += [[c + len(points) for c in face] for face in corners]
        points = points + list(more)
    return points, faces


def inverted(mesh):
    """The same mesh inside out."""
    return mesh[0], [face[::-1] for face in mesh[1]]


def off(points, faces):
    lines = ["OFF", "%d %d 0" % (len(points), len(faces))]
    lines += ["%r %r %r" % tuple(p) for p in points]
    lines += ["%d %s" % (len(face), " ".join(str(c) for c in face)) for face in faces]
    return "\n".join(lines + [""])


def write_obj(path, mesh):
    """Triangles, as points and faces, into a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    points, faces = mesh
    with open(path, "w") as out:
        for p in points:
            out.write("v %r %r %r\n" % tuple(p))
        for f in faces:
            out.write("f %d %d %d\n" % tuple(i + 1 for i in f))


WRITERS = {"mesh": medit, "msh": gmsh, "vtu": vtu}
