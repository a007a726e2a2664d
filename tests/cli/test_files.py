# SPDX-License-Identifier: Apache-2.0
"""Files of the user's that a job must not destroy, and standard streams that do not work."""

import json
import os
import pathlib
import resource
import signal
import socket
import stat
import subprocess
import tempfile
import threading
import time
import unittest

from program import (PROGRAM, CommandLineTest, box_faces, lattice, medit, off, vtu)

IS_ROOT = os.geteuid() == 0


def has_unnamed_files():
    """Whether the file system of the tests' folders lets a file be named when it is done."""
    try:
        os.close(os.open(tempfile.gettempdir(), os.O_TMPFILE | os.O_RDWR))
        return True
    except OSError:
        return False


class FilesTest(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.mesh", medit(*lattice(2)))
        self.write("box.off", off(*box_faces()))

    def state(self):
        """What every file holds, is and is called."""
        found = {}
        for path in sorted(self.folder.rglob("*")):
            info = path.lstat()
            if path.is_symlink():
                content = os.readlink(path)
            else:
                content = path.read_bytes() if stat.S_ISREG(info.st_mode) else None
            found[str(path.relative_to(self.folder))] = (info.st_ino, info.st_mode, content)
        return found

    def refuse_untouched(self, *arguments, says=(), status=2, **options):
        before = self.state()
        result = self.refuse(status, *arguments, says=says, **options)
        self.assertEqual(self.state(), before, arguments)
        return result

    def shell(self, text, **options):
        """The status of a command as bash runs it, the program being $P."""
        return subprocess.run(["bash", "-c", text], cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120,
                              env={**os.environ, "P": PROGRAM}, **options)


class InputsStay(FilesTest):
    COMMANDS = (("voxelize", "box.mesh", "-o", "out.vdb"), ("tetrahedralize", "box.off", "-o", "o.msh"),
                ("repair", "box.off", "-o", "out.stl"), ("info", "box.mesh"), ("info", "box.off"),
                ("render", "box.off", "-o", "out.png"), ("check", "box.mesh"),
                ("compare", "box.mesh", "box.off"), ("report", "box.off", "-o", "out.html"))

    def test_report_onto_an_input(self):
        for command in self.COMMANDS:
            with self.subTest(command=command):
                self.refuse_untouched(*command, "--json", command[1], says=(command[1], "input"))
                # --force is for files that are no report, not for inputs
                self.refuse_untouched(*command, "--json", command[1], "--force", says="input")

    def test_report_onto_an_output(self):
        for command in self.COMMANDS:
            if "-o" in command:
                with self.subTest(command=command):
                    self.refuse_untouched(*command, "--json", command[-1], says="two outputs")

    def test_wildcard_after_json(self):
        for name in ("a.vtu", "b.vtu", "c.vtu"):
            self.write(name, vtu(*lattice(1)))
        self.refuse_untouched("info", "--json", "a.vtu", "b.vtu", "c.vtu",
                              says=("a.vtu", "no report", "--force"))
        self.refuse_untouched("info", "--json", "a.vtu", says="required")

    def test_other_names_of_an_input(self):
        os.symlink("box.mesh", self.path("symbolic.mesh"))
        os.link(self.path("box.mesh"), self.path("hard.mesh"))
        self.path("folder").mkdir()
        os.symlink("..", self.path("folder/up"))
        for name in ("./box.mesh", "folder/../box.mesh", "folder/up/box.mesh", "symbolic.mesh",
                     "hard.mesh", str(self.path("box.mesh"))):
            with self.subTest(name=name):
                self.refuse_untouched("voxelize", "box.mesh", "--write-mesh", name, says="input")
                self.refuse_untouched("voxelize", name, "--write-mesh", "box.mesh", says="input")
                self.refuse_untouched("info", "box.mesh", "--json", name, says="input")

    def test_outputs_that_are_one_file(self):
        os.symlink("later.png", self.path("dangling.png"))
        job = ("voxelize", "box.mesh")
        self.refuse_untouched(*job, "--write-mesh", "a.msh", "-o", "a.vdb", "--json", "a.msh",
                              says="two outputs")
        self.refuse_untouched(*job, "-o", "a.vdb", "--preview", "later.png", "--json", "dangling.png",
                              says="two outputs")
        self.refuse_untouched("render", "box.off", "-o", "turn.png", "--turntable", 3, "--json",
                              "turn.0002.png", says="two outputs")

    def test_files_that_an_input_refers_to(self):
        self.write("one.vtu", vtu(*lattice(1)))
        self.write("two.vtu", vtu(*lattice(1, origin=(1, 0, 0))))
        self.write("all.pvd", '<VTKFile type="Collection"><Collection>'
                   '<DataSet timestep="0" file="one.vtu"/><DataSet timestep="0" file="two.vtu"/>'
                   '</Collection></VTKFile>')
        self.refuse_untouched("voxelize", "all.pvd", "-o", "all.vdb", "--write-mesh", "two.vtu",
                              says=("two.vtu", "input"))
        self.refuse_untouched("info", "all.pvd", "--json", "one.vtu", "--force", says="input")

        self.write("part.pvtu", '<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid>'
                   '<Piece Source="one.vtu"/></PUnstructuredGrid></VTKFile>')
        self.refuse_untouched("voxelize", "part.pvtu", "--write-mesh", "one.vtu", says="input")

        points, tets = lattice(1)
        self.write("t.node", "%d 3 0 0\n" % len(points) + "".join(
            "%d %r %r %r\n" % (i, *p) for i, p in enumerate(points)))
        self.write("t.ele", "%d 4 0\n" % len(tets) + "".join(
            "%d %d %d %d %d\n" % (i, *t) for i, t in enumerate(tets)))
        self.refuse_untouched("info", "t.ele", "--json", "t.node", "--force", says="input")

    def test_frames(self):
        for i in (1, 2):
            self.write(f"f_{i}.vtu", vtu(*lattice(1)))
        self.refuse_untouched("voxelize", "f_*.vtu", "-o", "run.vdb", "--json", "run.0002.vdb",
                              says="two outputs")
        self.refuse_untouched("info", "f_1.vtu", "f_2.vtu", "--json", "f_2.vtu", "--force",
                              says="input")
        self.refuse_untouched("voxelize", "f_*.vtu", "-o", "run.vdb", "--json", "f_2.vtu", "--force",
                              says="input")
        # A frame that is the input of another.
        os.symlink("f_2.vtu", self.path("run.0001.vdb"))
        self.refuse_untouched("voxelize", "f_*.vtu", "-o", "run.vdb", says="input")

    def test_report_onto_a_file_of_the_user(self):
        self.write("notes.json", '{"my": "notes"}')
        self.write("cut.json", '{"version": "1", "command": "info", "status"')
        self.write("list.json", '[{"version": "1", "command": "info", "status": 0}]')
        for name in ("notes.json", "cut.json", "list.json"):
            self.refuse_untouched("info", "box.mesh", "--json", name, says=(name, "--force"))
            self.refuse_untouched("info", "none.mesh", "--json", name, says=(name, "--force"))
        self.succeed("info", "box.mesh", "--json", "notes.json", "--force")
        self.assertEqual(json.loads(self.path("notes.json").read_text())["command"], "info")

    def test_report_onto_a_report(self):
        self.write("new.json", "")
        for _ in range(2):
            self.succeed("info", "box.mesh", "--json", "new.json")
        self.assertEqual(self.run_program("info", "none.mesh", "--json", "new.json").status, 3)
        self.assertEqual(json.loads(self.path("new.json").read_text())["status"], 3)

    def test_a_failed_job_leaves_its_outputs(self):
        self.write("out.vdb", "precious")
        self.refuse_untouched("voxelize", "none.mesh", "-o", "out.vdb", says="none.mesh", status=3)

    @unittest.skipIf(IS_ROOT, "root may write everything")
    def test_a_file_that_is_write_protected(self):
        self.write("out.vdb", "precious")
        self.path("out.vdb").chmod(0o444)
        self.refuse_untouched("voxelize", "box.mesh", "-o", "out.vdb", says="denied", status=7)


class LinksAndPermissions(FilesTest):
    def test_a_link_stays_and_its_target_is_replaced(self):
        self.path("far").mkdir()
        self.write("far/real.vdb", "old")
        os.symlink("far/real.vdb", self.path("out.vdb"))
        os.symlink("out.vdb", self.path("twice.vdb"))
        self.succeed("voxelize", "box.mesh", "-o", "twice.vdb")
        self.assertEqual(os.readlink(self.path("twice.vdb")), "out.vdb")
        self.assertEqual(os.readlink(self.path("out.vdb")), "far/real.vdb")
        self.assertFalse(self.path("far/real.vdb").is_symlink())
        self.hash_of("far/real.vdb")

    def test_a_link_to_nothing_makes_its_target(self):
        self.path("far").mkdir()
        os.symlink("far/later.json", self.path("r.json"))
        self.succeed("info", "box.mesh", "--json", "r.json")
        self.assertTrue(self.path("r.json").is_symlink())
        self.assertEqual(json.loads(self.path("far/later.json").read_text())["status"], 0)
        os.symlink("b.json", self.path("a.json"))
        os.symlink("a.json", self.path("b.json"))
        self.refuse_untouched("info", "box.mesh", "--json", "a.json", status=7)

    def test_a_hard_link_keeps_the_old_file(self):
        self.write("out.vdb", "old")
        os.link(self.path("out.vdb"), self.path("kept.vdb"))
        self.succeed("voxelize", "box.mesh", "-o", "out.vdb")
        self.assertEqual(self.path("kept.vdb").read_text(), "old")

    def test_permissions(self):
        def mode(name):
            return stat.S_IMODE(self.path(name).stat().st_mode)
        for mask in (0o022, 0o077, 0o002):
            self.path("out.vdb").unlink(missing_ok=True)
            self.succeed("voxelize", "box.mesh", "-o", "out.vdb",
                         preexec_fn=lambda: os.umask(mask))
            self.assertEqual(mode("out.vdb"), 0o666 & ~mask)
        for given in (0o600, 0o640, 0o666, 0o755):
            self.path("out.vdb").chmod(given)
            self.succeed("voxelize", "box.mesh", "-o", "out.vdb")
            self.assertEqual(mode("out.vdb"), given)

    @unittest.skipUnless(IS_ROOT, "only root can give files away")
    def test_owner(self):
        self.write("out.vdb", "old")
        os.chown(self.path("out.vdb"), 12345, 23456)
        self.succeed("voxelize", "box.mesh", "-o", "out.vdb")
        info = self.path("out.vdb").stat()
        self.assertEqual((info.st_uid, info.st_gid), (12345, 23456))

    def running(self):
        """A job in the middle of its work, which writes out.vdb."""
        points, tets = lattice(12)
        self.write("big.mesh", medit([(x + 0.31 * y, y + 0.23 * z, z + 0.29 * x)
                                      for x, y, z in points], tets))
        return subprocess.Popen(
            [PROGRAM, "voxelize", "big.mesh", "-o", "out.vdb", "--grid", "tet_id,density",
             "--resolution", "400"], cwd=self.folder, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)

    def writes(self, job):
        """Waits until the job has written something; whether it has, and is still at work."""
        while job.poll() is None:
            try:
                for file in pathlib.Path(f"/proc/{job.pid}/fd").iterdir():
                    if os.readlink(file).startswith(f"{self.folder}/") and file.stat().st_size > 0:
                        return True
            except OSError:
                continue
        return False

    def test_killed_while_writing(self):
        for number in (signal.SIGKILL, signal.SIGTERM):
            self.write("out.vdb", "precious")
            job = self.running()
            before = {"box.mesh", "box.off", "big.mesh", "out.vdb"}
            self.writes(job)
            job.send_signal(number)
            job.wait(timeout=120)
            if job.returncode == 0:
                continue # the job was done before the signal came
            self.assertEqual(self.path("out.vdb").read_text(), "precious")
            left = {path.name for path in self.folder.iterdir()} - before
            if number == signal.SIGTERM or has_unnamed_files():
                self.assertEqual(left, set())
            for name in left:
                self.assertNotIn(str(job.pid), name)
                self.path(name).unlink()

    def test_a_planted_name_is_not_followed(self):
        # The name that was once used: OUT.tmpPID. It is planted for the process that is about to
        # start, whose number is known because the shell becomes the program.
        self.write("victim", "precious")
        done = self.shell('ln -s victim out.vdb.tmp$$; exec $P voxelize box.mesh -o out.vdb')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.path("victim").read_text(), "precious")
        self.hash_of("out.vdb")

    def test_long_names(self):
        name = "n" * 251 + ".vdb"
        self.succeed("voxelize", "box.mesh", "-o", name)
        self.hash_of(name)


class PipesAndDevices(FilesTest):
    def test_fifo_with_a_reader(self):
        reports = {}
        for name, command in (("r.json", ("info", "box.mesh", "--json", "r.json")),
                              ("o.vdb", ("voxelize", "box.mesh", "-o", "o.vdb")),
                              ("o.nvdb", ("voxelize", "box.mesh", "-o", "o.nvdb")),
                              ("o.png", ("render", "box.off", "-o", "o.png", "--size", "32x32")),
                              ("o.3mf", ("repair", "box.off", "-o", "o.3mf"))):
            with self.subTest(name=name):
                os.mkfifo(self.path(name))
                reader = threading.Thread(
                    target=lambda: reports.__setitem__(name, self.path(name).read_bytes()))
                reader.start()
                self.succeed(*command)
                reader.join(timeout=60)
                self.assertTrue(stat.S_ISFIFO(self.path(name).lstat().st_mode))
                self.assertGreater(len(reports[name]), 0)
        self.assertEqual(json.loads(reports["r.json"])["status"], 0)
        for name in ("o.vdb", "o.nvdb"):
            self.succeed("voxelize", "box.mesh", "-o", "file-" + name)
            self.write("piped-" + name, reports[name])
            self.assertEqual(self.hash_of("piped-" + name), self.hash_of("file-" + name))

    def test_fifo_gets_nothing_from_a_job_that_fails(self):
        os.mkfifo(self.path("o.vdb"))
        reader = os.open(self.path("o.vdb"), os.O_RDONLY | os.O_NONBLOCK)
        self.assertEqual(self.run_program("voxelize", "none.mesh", "-o", "o.vdb").status, 3)
        self.assertEqual(os.read(reader, 10), b"")
        os.close(reader)

    def test_fifo_whose_reader_leaves(self):
        os.mkfifo(self.path("o.vdb"))
        self.write("many.mesh", medit(*lattice(6)))
        done = self.shell('head -c 10 o.vdb >/dev/null & exec $P voxelize many.mesh -o o.vdb '
                          '--resolution 300 --grid tet_id')
        self.assertEqual(done.returncode, 7, done.stderr)
        self.assertTrue(stat.S_ISFIFO(self.path("o.vdb").lstat().st_mode))

    def test_socket(self):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(self.path("r.json")))
        listener.listen()
        got = []
        def serve():
            connection, _ = listener.accept()
            while part := connection.recv(65536):
                got.append(part)
            connection.close()
        server = threading.Thread(target=serve)
        server.start()
        self.succeed("info", "box.mesh", "--json", "r.json")
        server.join(timeout=60)
        self.assertEqual(json.loads(b"".join(got))["status"], 0)
        listener.close()
        self.assertTrue(stat.S_ISSOCK(self.path("r.json").lstat().st_mode))

    def test_devices(self):
        for device in ("/dev/null", "/dev/full", "/dev/stdout", "/dev/stderr"):
            before = os.lstat(device)
            result = self.run_program("info", "box.mesh", "--json", device)
            self.assertEqual(result.status, 7 if device == "/dev/full" else 0, result.err)
            after = os.lstat(device)
            self.assertEqual((before.st_ino, before.st_mode, before.st_rdev),
                             (after.st_ino, after.st_mode, after.st_rdev))
        os.symlink("/dev/null", self.path("o.vdb"))
        self.succeed("voxelize", "box.mesh", "-o", "o.vdb", "--json", "/dev/null")
        self.assertEqual(os.readlink(self.path("o.vdb")), "/dev/null")
        os.symlink("/dev/full", self.path("f.vdb"))
        self.refuse_untouched("voxelize", "box.mesh", "-o", "f.vdb", status=7, says="space")

    @unittest.skipUnless(IS_ROOT, "only root could replace a device")
    def test_a_device_node_of_its_own(self):
        try:
            os.mknod(self.path("null.json"), stat.S_IFCHR | 0o666, os.makedev(1, 3))
        except PermissionError:
            self.skipTest("no device nodes can be made here")
        if self.run_program("info", "box.mesh", "--json", "null.json").status != 7: # nodev
            self.assertTrue(stat.S_ISCHR(self.path("null.json").lstat().st_mode))

    def test_standard_output_that_is_a_file(self):
        self.write("log.txt", "a year of work\n")
        done = self.shell('$P info box.mesh --json /dev/stdout >> log.txt')
        self.assertEqual(done.returncode, 2, done.stderr) # what is there is no report
        self.assertEqual(self.path("log.txt").read_text(), "a year of work\n")
        done = self.shell('$P info box.mesh --json /dev/stdout --force >> log.txt')
        self.assertEqual(done.returncode, 0, done.stderr)
        text = self.path("log.txt").read_text()
        self.assertTrue(text.startswith("a year of work\n{"), text)
        done = self.shell('$P info box.mesh --json r.json > r.json')
        self.assertEqual(json.loads(self.path("r.json").read_text())["status"], 0)

    def test_two_things_on_standard_output(self):
        os.symlink("/dev/stdout", self.path("o.vdb"))
        done = self.shell('$P voxelize box.mesh -o o.vdb --json - | cat; exit ${PIPESTATUS[0]}')
        self.assertEqual((done.returncode, done.stdout), (2, b""))
        done = self.shell('$P voxelize box.mesh -o o.vdb | cat > piped.vdb; exit ${PIPESTATUS[0]}')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.hash_of("piped.vdb")


class StandardStreams(FilesTest):
    def setUp(self):
        super().setUp()
        # Warnings, progress and notes: much for standard error.
        points, faces = box_faces()
        self.write("open.off", off(points, faces[:-1]))

    def test_standard_error_that_cannot_be_written(self):
        for redirect in ("2>/dev/full", "2>&-", "2>&- 0<&-"):
            for job, status in (("voxelize open.off -o out.vdb -v", (0, 1)),
                                ("info open.off -v", (0,)), ("info none.off", (3,)),
                                ("voxelize open.off", (2,)), ("nonsense", (2,)),
                                ("compare box.off open.off", (8,)),
                                ("tetrahedralize box.off -o o.msh -v", (0,)),
                                ("render box.off -o o.png -v --size 16x16", (0,))):
                with self.subTest(redirect=redirect, job=job):
                    done = self.shell(f"exec $P {job} {redirect}")
                    self.assertIn(done.returncode, status)

    def test_an_output_does_not_become_standard_error(self):
        # Descriptors are given out from the lowest that is free.
        for redirect in ("2>&-", "1>&-", "0<&- 1>&- 2>&-"):
            with self.subTest(redirect=redirect):
                self.path("out.vdb").unlink(missing_ok=True)
                done = self.shell(f"exec $P voxelize box.mesh -o out.vdb -q {redirect}")
                self.assertEqual(done.returncode, 0)
                self.succeed("voxelize", "box.mesh", "-o", "same.vdb", "-q")
                self.assertEqual(self.hash_of("out.vdb"), self.hash_of("same.vdb"))
                self.assertEqual(self.path("out.vdb").stat().st_size,
                                 self.path("same.vdb").stat().st_size)

    def test_standard_output_that_cannot_be_written(self):
        for redirect in (">/dev/full", ">&-"):
            for job in ("info box.mesh", "info box.mesh --json -", "--help", "--version",
                        "voxelize --help", "info box.mesh --json /dev/full"):
                with self.subTest(redirect=redirect, job=job):
                    done = self.shell(f"exec $P {job} {redirect}")
                    self.assertEqual(done.returncode, 7)
                    self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            # Nothing is to be printed there.
            done = self.shell(f"exec $P voxelize box.mesh -o out.vdb -q {redirect}")
            self.assertEqual(done.returncode, 0, done.stderr)
            # An error has a status of its own.
            self.assertEqual(self.shell(f"exec $P info none.mesh {redirect}").returncode, 3)

    def test_a_pipe_that_nobody_reads_any_more(self):
        for job in ("voxelize open.off -o out.vdb -v --resolution 200",
                    "tetrahedralize box.off -o o.msh -v", "info box.mesh"):
            with self.subTest(job=job):
                done = self.shell(f"$P {job} 2>&1 | head -1; exit ${{PIPESTATUS[0]}}")
                self.assertIn(done.returncode, (0, 1))
                done = self.shell(f"$P {job} 2>&1 | true; exit ${{PIPESTATUS[0]}}")
                self.assertIn(done.returncode, (0, 1))
        for command in ("help voxelize", "voxelize --help", "--version", "formats", "info box.mesh --json -"):
            with self.subTest(command=command):  # the pipe is closed before the program begins
                done = self.shell(f"({{ sleep 0.2; $P {command}; echo $? >status; }} 2>said) | true; cat said status")
                self.assertEqual(done.stdout, b"0\n")


if __name__ == "__main__":
    unittest.main(verbosity=2)
