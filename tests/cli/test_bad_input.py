# SPDX-License-Identifier: Apache-2.0
"""What cannot work: the exit status, one line that names file and cause, nothing left behind."""

import os
import resource
import signal
import subprocess
import time
import unittest

from program import PROGRAM, SANITIZED, WRITERS, CommandLineTest, gmsh, lattice, medit, vtu

INVALID = 3


def limit(kind, value):
    return lambda: resource.setrlimit(kind, (value, value))


class BadMeshFiles(CommandLineTest):
    def refuse_file(self, name, content, says=()):
        self.write(name, content)
        says = (says,) if isinstance(says, str) else tuple(says)
        self.refuse(INVALID, "voxelize", name, "-o", "out.vdb", says=(name, *says))
        self.refuse(INVALID, "info", name, says=(name, *says))

    def test_missing_file(self):
        for name in ("none.mesh", "none.msh", "none.vtu", "no/such/folder/none.vtk"):
            self.refuse(INVALID, "voxelize", name, "-o", "out.vdb", says=(name, "no such file"))
            self.refuse(INVALID, "info", name, says=name)
        self.refuse(INVALID, "compare", "none.vdb", "other.vdb", says="none.vdb")

    def test_directory(self):
        self.path("folder.mesh").mkdir()
        self.refuse(INVALID, "voxelize", "folder.mesh", "-o", "out.vdb",
                    says=("folder.mesh", "directory"))

    def test_empty_file(self):
        for ending in WRITERS:
            self.refuse_file("void." + ending, b"", says="empty")

    def test_wrong_format(self):
        self.refuse_file("photo.mesh", b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 8)
        self.refuse_file("text.msh", "nothing of a mesh is in here\n" * 20)
        self.refuse_file("page.vtu", "<html><body>404 not found</body></html>\n")
        self.refuse_file("noise.xyz", os.urandom(4096))

    def test_formats_that_are_not_read_are_named(self):
        for name, text, says in (("a.mesh", "MFEM mesh v1.0\n\ndimension\n3\n", "MFEM"),
                                 ("a.xda", "libMesh-0.7.0+\n1\n", "libMesh"),
                                 ("a.unv", "    -1\n  2411\n", ".unv"), ("a.su2", "NDIME= 3\n", ".su2"),
                                 ("a.bdf", "BEGIN BULK\nENDDATA\n", "no points (GRID)"),
                                 ("a.step", "ISO-10303-21;\n", "STEP")):
            self.write(name, text)
            self.refuse(3, "voxelize", name, "-o", "out.vdb", "--resolution", "10", says=(name, says))

    def test_truncated_file(self):
        points, tets = lattice(3)
        for ending, writer in WRITERS.items():
            content = writer(points, tets).encode()
            for part in (0.02, 0.2, 0.5, 0.8, 0.95):
                with self.subTest(ending=ending, part=part):
                    self.refuse_file("cut." + ending, content[:int(part * len(content))])

    def test_index_out_of_range(self):
        points, tets = lattice(2)
        for wrong in (len(points), 10**9, -2):
            broken = [list(tet) for tet in tets]
            broken[5][2] = wrong
            for ending, writer in WRITERS.items():
                with self.subTest(ending=ending, wrong=wrong):
                    self.refuse_file("far." + ending, writer(points, broken))

    def test_coordinates_that_are_not_finite(self):
        points, tets = lattice(2)
        for number in ("nan", "inf", "-inf", "1e999"):
            for ending, writer in WRITERS.items():
                with self.subTest(ending=ending, number=number):
                    marked = [list(p) for p in points]
                    marked[7][1] = 0.123456789
                    content = writer(marked, tets).replace("0.123456789", number)
                    self.refuse_file("wild." + ending, content)

    def test_header_that_asks_for_10_to_the_12_vertices(self):
        points, tets = lattice(2)
        count = len(points)
        many = "1000000000000"
        contents = {
            "many.mesh": medit(points, tets).replace(f"Vertices\n{count}\n", f"Vertices\n{many}\n"),
            "many.msh": gmsh(points, tets).replace(f"$Nodes\n{count}\n", f"$Nodes\n{many}\n"),
            "many.vtu": vtu(points, tets).replace(f'NumberOfPoints="{count}"',
                                                  f'NumberOfPoints="{many}"'),
        }
        for name, content in contents.items():
            with self.subTest(name=name):
                self.assertIn(many, content)
                begin = time.monotonic()
                self.refuse_file(name, content)
                self.assertLess(time.monotonic() - begin, 20)

    def test_no_tets(self):
        points, _ = lattice(2)
        self.refuse_file("points.mesh", medit(points, []))
        self.refuse_file("points.msh", gmsh(points, []))
        self.refuse_file("points.vtu", vtu(points, []))
        surface = medit(points, []).replace("Tetrahedra\n0", "Triangles\n1\n1 2 4 0")
        self.write("surface.mesh", surface)
        self.refuse(INVALID, "voxelize", "surface.mesh", "-o", "out.vdb", says="--shell")

    def test_one_bad_file_of_several(self):
        points, tets = lattice(2)
        self.write("good.mesh", medit(points, tets))
        self.write("bad.mesh", "MeshVersionFormatted 2\n")
        self.refuse(INVALID, "voxelize", "good.mesh", "bad.mesh", "-o", "out.vdb", says="bad.mesh")
        result = self.run_program("info", "bad.mesh", "good.mesh")
        self.assertEqual(result.status, INVALID)
        self.assertIn("bad.mesh", result.err)
        self.assertIn("good.mesh", result.out)

    def test_volume_that_is_not_whole(self):
        self.write("box.mesh", medit(*lattice(2)))
        self.succeed("voxelize", "box.mesh", "-o", "box.vdb", "--resolution", 40)
        content = self.path("box.vdb").read_bytes()
        for part in (0.03, 0.3, 0.6, 0.9):
            self.write("cut.vdb", content[:int(part * len(content))])
            self.refuse(INVALID, "info", "cut.vdb", says="cut.vdb")
            self.refuse(INVALID, "compare", "box.vdb", "cut.vdb", says="cut.vdb")
        self.refuse(INVALID, "voxelize", "box.vdb", "-o", "out.vdb", says="box.vdb")


class BadOptions(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.mesh", medit(*lattice(2)))

    def refuse_options(self, statuses, *options, says=()):
        return self.refuse(statuses, "voxelize", "box.mesh", "-o", "out.vdb", *options, says=says)

    def test_voxel_size_that_is_no_size(self):
        for size in ("0", "-0.1", "nan", "inf", "-inf", "x", "", "1,2", "1,0,1", "1,-1,1", "1 1 1"):
            with self.subTest(size=size):
                self.refuse_options(2, "--voxel-size", size, says="--voxel-size")

    def test_voxel_below_the_limit_of_openvdb(self):
        self.refuse_options((2, 3), "--voxel-size", "1e-6")
        self.refuse_options((2, 3), "--voxel-size", "1e-300")

    def test_grid_beyond_32_bits(self):
        wide = [[1e7 * c for c in p] for p in lattice(1)[0]]
        self.write("wide.mesh", medit(wide, lattice(1)[1]))
        self.refuse((2, 3, 4), "voxelize", "wide.mesh", "-o", "out.vdb", "--voxel-size", "1e-4")

    def test_resolution(self):
        for number in ("0", "-5", "1.5", "many", "99999999999"):
            self.refuse_options(2, "--resolution", number, says="--resolution")

    def test_words_that_are_not_known(self):
        self.refuse_options(2, "--grid", "surfaces", says=("--grid", "surfaces"))
        self.refuse_options(2, "--grid", "mask,mask", says="--grid")
        self.refuse_options(2, "--device", "abacus", says="--device")
        self.refuse_options(2, "--up-axis", "x", says="--up-axis")
        self.refuse_options(2, "--bbox", "0,0,0,1,1", says="--bbox")
        self.refuse_options(2, "--bbox", "0,0,0,1,1,nan", says="--bbox")
        self.refuse_options(2, "--origin", "0,inf,0", says="--origin")
        self.refuse_options(2, "--max-memory", "4X", says="--max-memory")
        self.refuse_options(2, "--max-time", "soon", says="--max-time")
        self.refuse_options(2, "--threads", "0", says="--threads")
        self.refuse_options(2, "--frobnicate", says="frobnicate")
        self.refuse_options(2, "--voxel-size", "1", "--resolution", "8")

    def test_usage(self):
        self.refuse(2, says="--help")
        self.refuse(2, "voxelise", "box.mesh", says="voxelise")
        self.refuse(2, "voxelize", "box.mesh", says="-o")
        self.refuse(2, "voxelize", "-o", "out.vdb")
        self.refuse(2, "compare", "box.mesh")
        self.refuse(2, "info")

    def test_region_that_the_mesh_does_not_have(self):
        self.refuse_options(2, "--region", "17", says=("box.mesh", "17"))
        self.refuse_options(2, "--region-array", "none", says=("box.mesh", "none"))
        self.refuse_options((2, 3), "--exclude", "1", says=("box.mesh", "--exclude"))
        self.refuse_options(3, "--bbox", "5,5,5,6,6,6", says=("box.mesh", "--bbox"))

    def test_device_that_is_not_there(self):
        self.refuse_options(6, "--device", "cuda:97", says="cuda")
        self.refuse_options(6, "--device", "cuda:97,98", says="cuda")
        for text in ("cuda:", "cuda:0,", "cuda:0,,1", "cuda:1,1", "cuda:-1", "gpu"):
            self.refuse_options(2, "--device", text, says="--device")

    def test_empty_result(self):
        tiny = [[0.3 + 0.1 * c for c in p] for p in lattice(1)[0]]
        self.write("tiny.mesh", medit(tiny, lattice(1)[1]))
        self.refuse(3, "voxelize", "tiny.mesh", "-o", "out.vdb", "--voxel-size", 1)
        self.succeed("voxelize", "tiny.mesh", "-o", "out.vdb", "--voxel-size", 1, "--allow-empty")
        self.assertTrue(self.path("out.vdb").exists())

    def test_report_of_a_failure(self):
        result = self.run_program("voxelize", "none.mesh", "-o", "out.vdb", "--json", "-")
        self.assertEqual(result.status, 3)
        self.assertEqual(result.report()["status"], 3)
        self.assertIn("none.mesh", result.report()["error"])
        self.assertEqual(result.report()["output"], [])


class BadOutputs(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.mesh", medit(*lattice(4)))

    def test_extension(self):
        for name in ("out.obj", "out", "out.vdb.gz", ".vdb"):
            self.refuse(2, "voxelize", "box.mesh", "-o", name, says=name)

    def test_extension_is_checked_before_the_input(self):
        self.refuse(2, "voxelize", "none.mesh", "-o", "out.xyz", says="out.xyz")

    def test_unwritable(self):
        self.path("folder.vdb").mkdir()
        self.refuse(7, "voxelize", "box.mesh", "-o", "folder.vdb", says="folder.vdb")
        self.refuse(7, "voxelize", "box.mesh", "-o", "no/such/out.vdb", says="no/such/out.vdb")
        self.refuse(7, "voxelize", "box.mesh", "-o", "box.mesh/out.vdb", says="box.mesh/out.vdb")
        self.refuse(7, "voxelize", "box.mesh", "-o", "/proc/out.vdb", says="/proc/out.vdb")
        self.refuse(7, "voxelize", "box.mesh", "-o", "o.vdb", "--json", "no/r.json",
                    says="no/r.json")

    @unittest.skipIf(os.getuid() == 0, "root may write everywhere")
    def test_folder_without_permission(self):
        self.path("closed").mkdir(mode=0o555)
        self.refuse(7, "voxelize", "box.mesh", "-o", "closed/out.vdb", says="closed/out.vdb")

    def test_input_is_not_overwritten(self):
        self.refuse(2, "voxelize", "box.mesh", "--write-mesh", "box.mesh", says="box.mesh")

    def test_file_size_limit(self):
        for name in ("out.vdb", "out.nvdb"):
            self.refuse(7, "voxelize", "box.mesh", "-o", name, "--resolution", 300, "--grid",
                        "tet_id", says=name, preexec_fn=limit(resource.RLIMIT_FSIZE, 20000))

    def test_old_file_survives_a_failure(self):
        self.write("out.vdb", "precious")
        self.refuse(7, "voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 300, "--grid",
                    "tet_id", preexec_fn=limit(resource.RLIMIT_FSIZE, 20000))
        self.assertEqual(self.path("out.vdb").read_text(), "precious")

    def test_full_disk(self):
        disk = self.path("disk")
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tetvdb-test", disk],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if mounted.returncode != 0:
            self.skipTest("cannot mount a small file system")
        try:
            for name in ("disk/out.vdb", "disk/out.nvdb"):
                self.refuse(7, "voxelize", "box.mesh", "-o", name, "--resolution", 300, "--grid",
                            "tet_id", says=(name, "space"))
                self.assertEqual(list(disk.iterdir()), [])
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_closed_standard_output(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([PROGRAM, "info", "box.mesh"], cwd=self.folder, stdout=full,
                                  stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 7)


class Limits(CommandLineTest):
    def setUp(self):
        super().setUp()
        # Nothing in it lies on the voxel lattice, and no node of it is full early.
        points, tets = lattice(12)
        turned = [(x + 0.31 * y - 0.17 * z, y + 0.23 * z - 0.4 * x, z + 0.29 * x + 0.11 * y)
                  for x, y, z in points]
        self.write("big.mesh", medit(turned, tets))

    def test_memory(self):
        self.refuse(4, "voxelize", "big.mesh", "-o", "out.vdb", "--resolution", 2000,
                    "--max-memory", "1M", says="memory")
        # The coarser grids are in memory where the others are streamed.
        self.refuse(4, "voxelize", "big.mesh", "-o", "out.nvdb", "--resolution", 4000, "--lod", "1:1",
                    "--max-memory", "200M", says="memory")

    @unittest.skipIf(SANITIZED, "sanitizers reserve address space")
    def test_address_space(self):
        self.refuse(4, "voxelize", "big.mesh", "-o", "out.nvdb", "--resolution", 4000, "--lod", "1:1",
                    preexec_fn=limit(resource.RLIMIT_AS, 700 << 20))

    def starts_threads(self):
        """Whether a library does before main(): Debian's OpenVDB has one that does."""
        return b"liblog4cplus" in subprocess.run(["ldd", PROGRAM], capture_output=True).stdout

    @unittest.skipIf(SANITIZED, "sanitizers reserve address space")
    def test_loading_without_room_for_threads(self):
        """Libraries start threads before main(): there is no abort where they cannot."""
        seen, said = set(), ""
        for megabytes in range(100, 700, 20):
            result = self.run_program("--version",
                                      preexec_fn=limit(resource.RLIMIT_AS, megabytes << 20))
            self.assertIn(result.status, (0, 4, 127), f"{megabytes} MB: {result.err}")
            if result.status == 4:
                self.assertRegex(result.err, "threads cannot be started|out of memory")
                said += result.err
            seen.add(result.status) # 127: the loader itself has no room
        self.assertEqual(seen, {0, 4, 127} if self.starts_threads() else {0, 127})
        self.assertEqual("threads cannot be started" in said, self.starts_threads())

    def test_loading_without_threads(self):
        def as_nobody():
            if os.geteuid() == 0: # whom the limit does not hold for
                os.setuid(65534)
            limit(resource.RLIMIT_NPROC, 1)()
        try:
            result = self.run_program("--version", preexec_fn=as_nobody)
        except PermissionError:
            self.skipTest("the program cannot be read by others")
        if not self.starts_threads():
            self.assertEqual(result.status, 0, result.err)
            return
        self.assertEqual(result.status, 4, result.err)
        self.assertEqual(len(result.lines), 1, result.err)
        self.assertIn("ulimit -u", result.err)

    def test_time(self):
        self.refuse(5, "voxelize", "big.mesh", "-o", "out.vdb", "--resolution", 2000, "--grid",
                    "tet_id", "--max-time", "0.05", says="time limit")

    def test_endless_input(self):
        self.refuse(3, "info", "/dev/zero", says="device")
        os.mkfifo(self.path("pipe"))
        if not SANITIZED: # which no limit of memory holds for
            with subprocess.Popen(["cat", "/dev/zero"], stdout=subprocess.PIPE) as zeros:
                result = subprocess.run([PROGRAM, "info", "/dev/stdin", "--max-memory", "100M"],
                                        stdin=zeros.stdout, capture_output=True, timeout=60)
                zeros.kill()
            self.assertEqual(result.returncode, 4, result.stderr)
            result = self.run_program("info", "pipe", "--max-time", "0.5", timeout=60) # tsan holds the signal back
            self.assertEqual(result.status, 5, result.err)

    def test_a_file_that_becomes_shorter(self):
        """Whatever moment it happens at, the program ends with a status of its own."""
        for delay in (0.0, 0.05, 0.1, 0.3):
            with open(self.path("long.stl"), "wb") as file:
                file.write(bytes(80) + (4_000_000).to_bytes(4, "little"))
                file.truncate(84 + 50 * 4_000_000)
            job = subprocess.Popen([PROGRAM, "info", "long.stl"], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            time.sleep(delay)
            os.truncate(self.path("long.stl"), 100)
            job.communicate(timeout=120)
            self.assertIn(job.returncode, (0, 3))

    def interrupt(self, *signals):
        """Sends signals to a long job; its status and stderr lines."""
        for resolution in (600, 1500, 3000):
            job = subprocess.Popen(
                [PROGRAM, "voxelize", "big.mesh", "-o", "out.vdb", "--grid", "tet_id,density",
                 "--resolution", str(resolution), "-v"], cwd=self.folder,
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while "voxelize" not in job.stderr.readline() and job.poll() is None:
                pass
            for number in signals:
                time.sleep(0.02)
                job.send_signal(number)
            _, err = job.communicate(timeout=120)
            if job.returncode != 0:
                return job.returncode, err
            self.path("out.vdb").unlink()
        self.fail("the job was always faster than the signal")

    def test_interrupt_leaves_nothing(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            status, err = self.interrupt(number)
            self.assertEqual(status, 5)
            self.assertIn("cancelled", err)
            self.assertEqual([p.name for p in self.folder.iterdir()], ["big.mesh"])

    def test_second_interrupt_ends_at_once(self):
        status, _ = self.interrupt(signal.SIGINT, signal.SIGINT)
        self.assertEqual(status, 5)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["big.mesh"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
