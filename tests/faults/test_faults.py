# SPDX-License-Identifier: Apache-2.0
"""Jobs whose calls of the system fail, one at a time or from one on: allocations, writes, reads,
maps, threads. A job then ends with a status of the table, and what it was to write is absent, as
it was before, or as it is without the failure. So it is after SIGKILL.

TETVDB_FAULTS is the number of failures of each kind for each job (1, of half of the kinds),
TETVDB_KILLS that of kills for each job (1), TETVDB_FAULT_JOBS chooses jobs by words of their
names."""

import json
import os
import pathlib
import random
import select
import shutil
import struct
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from program import (DATA, PROGRAM, SANITIZED, CommandLineTest, ball, box_faces, gmsh, joined,
                     lattice, off)

FAIL_CALLS = os.environ["TETVDB_FAIL_CALLS"]
FAULTS = int(os.environ.get("TETVDB_FAULTS", "1"))
KILLS = int(os.environ.get("TETVDB_KILLS", "1"))
CHOSEN = os.environ.get("TETVDB_FAULT_JOBS", "")
DONE = (0, 1, 8)
STATUSES = range(9)
OLD = b"what was there before"

# Kind of call, error number (0: the usual one).
KINDS = [("alloc", 0), ("write", 0), ("write", 5), ("sync", 0), ("rename", 0), ("read", 0),
         ("map", 0), ("open", 0), ("thread", 0)]


def stl(mesh):
    points, faces = mesh
    data = bytearray(80) + struct.pack("<I", len(faces))
    for face in faces:
        data += struct.pack("<12fH", 0, 0, 0, *(c for i in face for c in points[i]), 0)
    return bytes(data)


# Name: arguments, files that the job writes. OUT is the first of them.
PRINTER = "--pixels 40,30 --display 8,6 --layer-height 0.5"
JOBS = {
    "voxelize triangles": ("voxelize ball.stl -o OUT --resolution 24 --grid density,surface,mask",
                           "out.vdb"),
    "voxelize to nanovdb": ("voxelize ball.stl -o OUT --resolution 24", "out.nvdb"),
    "voxelize tets": ("voxelize cube.msh -o OUT --resolution 20 --grid density,tet_id,coverage",
                      "out.vdb"),
    "voxelize to an array": ("voxelize ball.stl -o OUT --resolution 16", "out.npz"),
    "voxelize by the mesher": ("voxelize open.off -o OUT --resolution 8 --mesher envelope "
                               "--write-mesh tets.msh", "out.vdb tets.msh"),
    "voxelize with a picture": ("voxelize ball.stl -o OUT --resolution 16 --preview a.png",
                                "out.vdb a.png"),
    "voxelize by a shard": ("voxelize rod.off -o OUT --voxel-size 1 --grid mask --shard 1/2",
                            "rod.1-of-2.vdb"),
    "prepare a mesh": ("plan cube.msh --prepare parts --resolution 20 --grid tet_id",
                       "parts/prepared.json parts/boundary.bin parts/nodes.bin parts/tets_0.bin"),
    "voxelize parts": ("voxelize cube.parts -o OUT --grid tet_id,density", "out.vdb"),
    "merge": ("merge part.0-of-2.vdb part.1-of-2.vdb -o OUT", "merged.vdb"),
    "voxelize in a child": ("voxelize cells.vtkhdf -o OUT --resolution 16", "out.vdb"),
    "tetrahedralize": ("tetrahedralize box.off -o OUT --epsilon 1e-2d", "out.msh"),
    "repair": ("repair open.off -o OUT", "out.stl"),
    "prepare": ("prepare ball.stl -o OUT --hollow 0.4 --voxel-size 0.2", "out.stl"),
    "slice": (f"slice ball.stl -o OUT {PRINTER}", "out.sl1"),
    "convert a mesh": ("convert ball.stl -o OUT", "out.obj"),
    "convert a volume": ("convert ball.vdb -o OUT", "out.npz"),
    "info": ("info ball.stl ball.vdb cube.msh --hash", ""),
    "compare": ("compare ball.vdb other.vdb", ""),
    "check": ("check ball.vdb --target blender", ""),
    "render": ("render ball.vdb -o OUT --size 64x48", "out.png"),
    "report": ("report models -o OUT --resolution 16", "out.html"),
    "data set": ("dataset models -o voxels --resolution 16 --workers 1 --no-preview", ""),
}


def chosen():
    return [name for name in JOBS if all(word in name for word in CHOSEN.split())]


@unittest.skipIf(SANITIZED, "the sanitizers bring their own allocation")
class Faults(CommandLineTest):
    known = {} # expected(), by job
    seconds = {} # of that

    def setUp(self):
        super().setUp()
        self.random = random.Random(20)
        self.inputs = self.path("inputs")
        self.inputs.mkdir()
        round_ball = ball(8, 2.0, (0, 0, 2))
        writes = {
            "ball.stl": stl(round_ball),
            "box.off": off(*box_faces()),
            "open.off": off(round_ball[0], round_ball[1][:-3]),
            "rod.off": off(*box_faces((-30.0, 0.0, 0.0), (5000.0, 20.0, 20.0))),
            "cube.msh": gmsh(*lattice(3)),
        }
        for name, content in writes.items():
            (self.inputs / name).write_bytes(content if isinstance(content, bytes)
                                             else content.encode())
        (self.inputs / "models").mkdir()
        for name in ("ball.stl", "box.off"):
            shutil.copy(self.inputs / name, self.inputs / "models" / name)
        shutil.copy(DATA / "readers/block.vtkhdf", self.inputs / "cells.vtkhdf")
        for command in ("voxelize ball.stl -o ball.vdb --resolution 24 --grid density,surface",
                        "voxelize ball.stl -o other.vdb --resolution 25 --grid density,surface",
                        "voxelize rod.off -o part.vdb --voxel-size 1 --grid mask --shard 0/2",
                        "voxelize rod.off -o part.vdb --voxel-size 1 --grid mask --shard 1/2",
                        "plan cube.msh --prepare cube.parts --resolution 20 --grid tet_id"):
            subprocess.run([PROGRAM, *command.split(), "-q"], cwd=self.inputs, check=True)
        self.temporary = self.path("temporary")

    # --- one job ---

    def start(self, job, folder, old=False, **environment):
        """A process in a fresh folder that holds the inputs and, with `old`, files in the place of
        the outputs."""
        words, outputs = JOBS[job]
        outputs = outputs.split()
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.inputs, folder, copy_function=os.link)
        shutil.rmtree(self.temporary, ignore_errors=True)
        self.temporary.mkdir()
        for name in outputs if old else ():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_bytes(OLD)
        out = outputs[0] if outputs else ""
        if job == "voxelize by a shard":
            out = "rod.vdb"
        words = words.replace("OUT", out).split()
        words += ["--json", "report.json", "--threads", "2"] if words[0] not in (
            "report", "info", "compare", "check", "merge", "dataset", "render", "convert"
        ) else ["--json", "report.json"]
        self.pipe, inherited = os.pipe() # at end of file the process and its children have ended
        process = subprocess.Popen(
            [PROGRAM, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, pass_fds=(inherited,),
            env={**os.environ, "TMPDIR": str(self.temporary), **environment})
        os.close(inherited)
        return process

    def end(self, process, seconds):
        """Standard error, once the process and its children have ended; else TimeoutExpired."""
        try:
            _, error = process.communicate(timeout=seconds)
            if not select.select([self.pipe], [], [], 20)[0]:
                raise subprocess.TimeoutExpired("children", 20)
        finally:
            os.close(self.pipe)
        return error.decode(errors="replace")

    def run_job(self, job, folder, **more):
        """Status and standard error."""
        process = self.start(job, folder, **more)
        try:
            error = self.end(process, 120)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return "hangs", ""
        return process.returncode, error

    def files(self, folder):
        """What a job left: content by name."""
        there = {str(path.relative_to(folder)): path.read_bytes()
                 for path in sorted(folder.rglob("*")) if path.is_file()}
        return {name: content for name, content in there.items()
                if not (self.inputs / name).exists()}

    def expected(self, job):
        """Status and files of a run without failures, and the names of those that are the same
        bytes in another."""
        if job not in Faults.known:
            began = time.monotonic()
            Faults.known[job] = self.run_twice(job)
            Faults.seconds[job] = (time.monotonic() - began) / 2
        return Faults.known[job]

    def run_twice(self, job):
        folder = self.path("right")
        status, error = self.run_job(job, folder)
        self.assertIn(status, DONE, f"{job}: {error}")
        right = self.files(folder)
        right.pop("report.json")
        again = self.run_job(job, folder)
        self.assertEqual(again[0], status)
        same = {name for name, content in self.files(folder).items() if right.get(name) == content}
        return status, right, same

    def judge(self, job, folder, status, error, right, same, usual):
        """What is wrong, as one sentence; empty: nothing."""
        if status not in STATUSES:
            return f"status {status}"
        left = self.files(folder)
        report = left.pop("report.json", None)
        if report is not None:
            try:
                said = json.loads(report)["status"]
            except (ValueError, KeyError):
                return "the report is no JSON"
            if said != status:
                return f"status {status}, but {said} in the report"
        strange = {name for name in left if name not in right} if job != "data set" else {
            name for name in left if ".tmp" in name}
        if strange:
            return f"left {sorted(strange)}"
        if job == "data set": # a model that failed is missing, and in the tables
            left = {name: content for name, content in left.items() if name.endswith(".npz")}
        kept = {name for name, content in left.items() if content == OLD}
        if status == usual and set(right) - set(left) | kept and job != "data set":
            return f"status {status} without {sorted(set(right) - set(left) | kept)}"
        for name in (set(left) & same) - kept:
            if left[name] != right[name]:
                return f"{name} is not what it is without the failure"
        if status not in DONE and not error.strip():
            return f"status {status} without a message"
        if any(self.temporary.iterdir()) and "out of memory" not in error:
            # Without memory a folder cannot be removed; the next report does it.
            return f"left {[p.name for p in self.temporary.iterdir()]} in TMPDIR"
        return ""

    def counts(self, job):
        path = self.path("counts")
        self.run_job(job, self.path("work"), LD_PRELOAD=FAIL_CALLS, FAIL_CALLS=f"count {path}")
        lines = (line.split() for line in path.read_text().splitlines())
        return {name: int(number) for name, number in lines}

    def test_failing_calls(self):
        wrong = []
        for job in chosen():
            usual, right, same = self.expected(job)
            counts = self.counts(job)
            if job != "info" and JOBS[job][1]:
                self.assertGreater(counts["write"], 0, job)
            for kind, error_number in KINDS if FAULTS > 1 else self.random.sample(KINDS, 5):
                for _ in range(FAULTS if kind == "alloc" else min(FAULTS, 2 * counts[kind], 1 if kind == "thread" else FAULTS)):
                    first = self.random.randint(1, max(counts[kind], 1))
                    length = self.random.choice((0, 1))
                    if kind == "thread": # a process that can have no more
                        first, length = 1, 0
                    calls = f"{kind} {first} {length} {error_number}"
                    folder = self.path("work")
                    status, error = self.run_job(
                        job, folder, old=self.random.random() < 0.5, LD_PRELOAD=FAIL_CALLS,
                        FAIL_CALLS=calls)
                    fault = self.judge(job, folder, status, error, right, same, usual)
                    if fault:
                        wrong.append(f"{job}, FAIL_CALLS='{calls}': {fault}; {error[-300:]}")
                        print(wrong[-1], flush=True)
        self.assertEqual(wrong, [])

    def test_killed_jobs(self):
        wrong = []
        for job in chosen():
            usual, right, same = self.expected(job)
            seconds = self.seconds[job]
            for _ in range(KILLS):
                folder = self.path("work")
                process = self.start(job, folder) # what replaces has a name for a moment
                time.sleep(self.random.uniform(0, seconds))
                process.kill()
                self.end(process, 120)
                for name, content in self.files(folder).items():
                    if name == "report.json":
                        json.loads(content)
                    elif name in same and content not in (OLD, right[name]):
                        wrong.append(f"{job}: {name} is half written after SIGKILL")
                    elif name.startswith(".parts."): # a folder has a name while it is made
                        pass
                    elif name not in right and (job != "data set" or ".tmp" in name):
                        wrong.append(f"{job}: SIGKILL left {name}")
        self.assertEqual(wrong, [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
