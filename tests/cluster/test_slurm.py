# SPDX-License-Identifier: Apache-2.0
"""Data sets and shards of a volume by a real slurmctld and slurmd on this host, and by mpirun; skipped where they are not
installed, or where this is not root, as the daemons want it. Slurm lets a requeued task wait for two
minutes."""
import getpass
import hashlib
import os
import random
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "cli"))
from program import PROGRAM, ball, write_obj

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts" / "slurm"
MODELS = int(os.environ.get("TETVDB_SLURM_MODELS", "200"))


def write_models(folder, count):
    rng = random.Random(1)
    for i in range(count):
        points, faces = ball(6 + i % 5, 1, (0, 0, 0))
        bumps = [1 + 0.2 * rng.random() for _ in points]
        points = [tuple(b * c for c in p) for b, p in zip(bumps, points)]
        write_obj(folder / ("m%05d.obj" % i), (points, faces))
    (folder / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")


def content(folder):
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest()
            for p in folder.rglob("*")
            if p.is_file() and p.suffix in (".npz", ".tar", ".json", ".png")}


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Cluster:
    """munged, slurmctld and slurmd with a configuration of their own."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        host = socket.gethostname().split(".")[0]
        (folder / "munge").mkdir(mode=0o700)
        key = folder / "munge" / "key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self.socket = folder / "munge" / "socket"
        for name in ("state", "spool", "log"):
            (folder / name).mkdir()
        self.conf = folder / "slurm.conf"
        self.conf.write_text("\n".join((
            "ClusterName=test", "SlurmctldHost=%s(127.0.0.1)" % host,
            "AuthType=auth/munge", "AuthInfo=socket=%s" % self.socket, "CredType=cred/munge",
            "SlurmUser=root", "SlurmdUser=root",
            "SlurmctldPort=%d" % free_port(), "SlurmdPort=%d" % free_port(),
            "StateSaveLocation=%s/state" % folder, "SlurmdSpoolDir=%s/spool" % folder,
            "SlurmctldPidFile=%s/slurmctld.pid" % folder, "SlurmdPidFile=%s/slurmd.pid" % folder,
            "SlurmctldLogFile=%s/log/slurmctld" % folder, "SlurmdLogFile=%s/log/slurmd" % folder,
            "ProctrackType=proctrack/linuxproc", "TaskPlugin=task/none", "SwitchType=switch/none",
            "MpiDefault=none", "ReturnToService=2", "SchedulerType=sched/backfill",
            "SelectType=select/cons_tres", "SelectTypeParameters=CR_Core",
            "AccountingStorageType=accounting_storage/none", "JobAcctGatherType=jobacct_gather/none",
            "SlurmctldTimeout=300", "SlurmdTimeout=300", "InactiveLimit=0", "KillWait=5", "MinJobAge=300",
            "NodeName=%s NodeAddr=127.0.0.1 CPUs=%d State=UNKNOWN" % (host, os.cpu_count() or 1),
            "PartitionName=all Nodes=%s Default=YES MaxTime=INFINITE State=UP" % host, "")))
        self.environment = {**os.environ, "SLURM_CONF": str(self.conf), "TETVDB": PROGRAM}
        self.start("munged", "--foreground", "--force", "--key-file=%s" % key, "--socket=%s" % self.socket,
                   "--pid-file=%s/munge/pid" % folder, "--log-file=%s/munge/log" % folder,
                   "--seed-file=%s/munge/seed" % folder)
        self.wait_for(self.socket.exists, "munged")
        self.start("slurmctld", "-D", "-f", self.conf)
        self.start("slurmd", "-D", "-f", self.conf, "-N", host)
        self.wait_for(lambda: "idle" in self.call("sinfo", "-h", "-o", "%T").stdout, "slurm")

    def start(self, *words):
        with open(self.folder / (words[0] + ".out"), "w") as log:
            self.processes.append(subprocess.Popen([str(w) for w in words], env=self.environment,
                                                   stdout=log, stderr=subprocess.STDOUT))

    def call(self, *words):
        return subprocess.run([str(w) for w in words], env=self.environment, capture_output=True,
                              text=True, cwd=self.folder, timeout=300)

    def wait_for(self, ready, what):
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            if ready():
                return
            time.sleep(0.2)
        logs = "".join(p.read_text(errors="replace")[-2000:] for p in (self.folder / "log").glob("*"))
        raise RuntimeError(what + " does not start:\n" + logs)

    def stop(self):
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


NO_SLURM = (any(shutil.which(p) is None for p in ("munged", "slurmctld", "slurmd", "sbatch"))
            or getpass.getuser() != "root")
MPIRUN = ["mpirun", *(["--allow-run-as-root"] if getpass.getuser() == "root" else []), "--oversubscribe"]


class ShardsOnACluster(unittest.TestCase):
    """A rod through several cubes of 4096^3 voxels, in parts."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="tetvdb-slurm-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        corners = [(x, y, z) for x in (0, 9000) for y in (0, 60) for z in (0, 60)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        with open(self.folder / "rod.obj", "w") as out:
            for x, y, z in corners:
                out.write("v %r %r %r\n" % (x * 0.8 - y * 0.6 - 4600, x * 0.48 + y * 0.64 - z * 0.6 - 4000,
                                            x * 0.36 + y * 0.48 + z * 0.8 - 3000))
            out.writelines("f %d %d %d %d\n" % tuple(c + 1 for c in f) for f in faces)
        self.options = ["--voxel-size", "1", "--grid", "mask"]
        subprocess.run([PROGRAM, "voxelize", "rod.obj", "-o", "alone.vdb", *self.options], check=True,
                       capture_output=True, cwd=self.folder)

    def expect_merged(self):
        self.assertTrue((self.folder / "rod.vdb").read_bytes() == (self.folder / "alone.vdb").read_bytes())

    @unittest.skipIf(NO_SLURM, "Slurm is not installed, or this is not root")
    def test_array(self):
        cluster = Cluster(self.folder)
        self.addCleanup(cluster.stop)
        job = cluster.call("sbatch", "--parsable", "--array=0-3", SCRIPTS / "shards.sh", "rod.obj", "rod.vdb",
                           *self.options)
        self.assertEqual(job.returncode, 0, job.stderr)
        end = cluster.call("sbatch", "--parsable", "--wait", "--dependency=afterok:" + job.stdout.strip(),
                           SCRIPTS / "merge.sh", "rod.vdb", "4")
        logs = "".join(p.read_text() for p in self.folder.glob("slurm-*.out"))
        self.assertEqual(end.returncode, 0, end.stderr + logs)
        self.expect_merged()

    @unittest.skipIf(shutil.which("mpirun") is None, "there is no mpirun")
    def test_mpirun(self):
        done = subprocess.run([*MPIRUN, "-n", "4", PROGRAM, "voxelize", "rod.obj", "-o", "rod.vdb", *self.options,
                               "--shard", "auto"], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        parts = sorted(p.name for p in self.folder.glob("rod.*-of-4.vdb"))
        self.assertEqual(len(parts), 4)
        subprocess.run([PROGRAM, "merge", *parts, "-o", "rod.vdb"], check=True, capture_output=True, cwd=self.folder)
        self.expect_merged()


class DatasetOnACluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="tetvdb-slurm-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        write_models(cls.folder / "models", MODELS)
        cls.options = ["--resolution", "32", "--archives", "4"]
        cls.alone = cls.folder / "alone"
        subprocess.run([PROGRAM, "dataset", cls.folder / "models", "-o", cls.alone, *cls.options],
                       check=True, capture_output=True)

    @unittest.skipIf(NO_SLURM, "Slurm is not installed, or this is not root")
    def test_array_with_a_task_that_is_killed_and_requeued(self):
        cluster = Cluster(self.folder)
        self.addCleanup(cluster.stop)
        out = self.folder / "slurm"
        job = cluster.call("sbatch", "--parsable", "--array=0-7", SCRIPTS / "dataset.sh",
                           self.folder / "models", out, *self.options)
        self.assertEqual(job.returncode, 0, job.stderr)
        number = job.stdout.strip()
        deadline = time.monotonic() + 60
        requeued = False
        while not requeued and time.monotonic() < deadline:
            running = cluster.call("squeue", "-h", "-t", "R", "-o", "%i").stdout.split()
            if running:
                requeued = cluster.call("scontrol", "requeue", running[-1]).returncode == 0
            time.sleep(0.05)
        end = cluster.call("sbatch", "--parsable", "--wait", "--dependency=afterok:" + number,
                           SCRIPTS / "join.sh", self.folder / "models", out, *self.options)
        logs = "".join(p.read_text() for p in self.folder.glob("slurm-*.out"))
        self.assertEqual(end.returncode, 0, end.stderr + logs)
        self.assertEqual(len(list((out / "rows").glob("*-of-8.jsonl"))), 8)
        self.assertEqual(content(out), content(self.alone))

    @unittest.skipIf(shutil.which("mpirun") is None, "there is no mpirun")
    def test_mpirun(self):
        out = self.folder / "mpi"
        done = subprocess.run([*MPIRUN, "-n", "4", PROGRAM, "dataset",
                               self.folder / "models", "-o", out, *self.options, "--shard", "auto",
                               "--workers", "1"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        subprocess.run([PROGRAM, "dataset", self.folder / "models", "-o", out, *self.options,
                        "--join"], check=True, capture_output=True)
        self.assertEqual(content(out), content(self.alone))


if __name__ == "__main__":
    if all(shutil.which(p) is None for p in ("slurmctld", "mpirun")):
        sys.exit(77)
    unittest.main()
