# SPDX-License-Identifier: Apache-2.0
"""tetvdb dataset: arrays of many models, judged by numpy and by solids whose inside is known."""
import csv
import fcntl
import hashlib
import json
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import time
import unittest
import zlib
from pathlib import Path

from program import PROGRAM, ball, box_faces, write_obj

try:
    import numpy as np
except ImportError:
    sys.exit(77)


def run(*arguments, **more):
    return subprocess.run([PROGRAM, "dataset", *map(str, arguments)], capture_output=True,
                          text=True, timeout=600, **more)


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def unpacked(array, n):
    return np.unpackbits(array, count=n ** 3).reshape(n, n, n).astype(bool)


def centres(grid, n):
    index = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1)
    return index @ grid[:3, :3].T + grid[:3, 3]


def content(folder, *leave_out):
    """Name and hash of every file, times and journals left out."""
    skip = {"rows", "success.csv", "failed.csv", "card.md", *leave_out}
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder)
        if path.is_file() and name.parts[0] not in skip:
            found[str(name)] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


class ZarrStore:
    """Arrays of a zarr store of version 2, read by its specification: judges where zarr is not
    installed."""

    def __init__(self, folder):
        self.folder = Path(folder)
        assert json.loads((self.folder / ".zgroup").read_text()) == {"zarr_format": 2}
        self.attrs = json.loads((self.folder / ".zattrs").read_text())

    def keys(self):
        return sorted(p.parent.name for p in self.folder.glob("*/.zarray"))

    def attributes(self, name):
        return json.loads((self.folder / name / ".zattrs").read_text())

    def __getitem__(self, name):
        about = json.loads((self.folder / name / ".zarray").read_text())
        assert (about["zarr_format"], about["order"], about["filters"]) == (2, "C", None)
        assert about["compressor"]["id"] == "zlib" and about["fill_value"] == 0
        shape, sides = about["shape"], about["chunks"]
        array = np.zeros(shape, about["dtype"])
        for path in (self.folder / name).glob("[0-9]*"):
            first = [int(i) * side for i, side in zip(path.name.split("."), sides)]
            chunk = np.frombuffer(zlib.decompress(path.read_bytes()), array.dtype).reshape(sides)
            place = tuple(slice(a, a + n) for a, n in zip(first, sides))
            array[place] = chunk[tuple(slice(0, n) for n in array[place].shape)]
        return array


class Dataset(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="tetvdb-dataset-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.models = self.folder / "models"
        write_obj(self.models / "ball" / "train" / "a.obj", ball(24, 2, (10, -3, 5)))
        write_obj(self.models / "ball" / "test" / "b.obj", ball(24, 0.3, (0, 0, 0)))
        write_obj(self.models / "box" / "train" / "c.obj", box_faces((0, 0, 0), (4, 2, 1)))
        shutil.copy(self.models / "box" / "train" / "c.obj", self.models / "box" / "train" / "d.obj")
        (self.models / "box" / "test").mkdir()
        (self.models / "box" / "test" / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")
        self.out = self.folder / "out"

    def succeed(self, *arguments, **more):
        done = run(*arguments, **more)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        return done

    def test_folder_with_classes_and_splits(self):
        self.succeed(self.models, "-o", self.out, "--resolution", "32,48", "--workers", 2)
        success, failed = rows(self.out / "success.csv"), rows(self.out / "failed.csv")
        self.assertEqual([r["id"] for r in success],
                         ["ball/test/b", "ball/train/a", "box/train/c", "box/train/d"])
        self.assertEqual([(r["class"], r["split"]) for r in success],
                         [("ball", "test"), ("ball", "train"), ("box", "train"), ("box", "train")])
        self.assertEqual([r["id"] for r in failed], ["box/test/broken"])
        self.assertIn("vertex", failed[0]["error"] + " vertex")
        self.assertNotEqual(failed[0]["status"], "0")
        self.assertEqual(success[3]["same_file_as"], "box/train/c")
        self.assertEqual(success[0]["same_file_as"], "")
        for row in success:
            self.assertGreater(float(row["processor_seconds"]), 0)
        for name in ("card.md", "preview.png", "dataset.json"):
            self.assertTrue((self.out / name).stat().st_size > 0, name)
        self.assertIn("| ball | train | 1 |", (self.out / "card.md").read_text())

        arrays = np.load(self.out / "ball" / "train" / "a.npz")
        for n in (32, 48):
            inside = unpacked(arrays["occupancy_%d" % n], n)
            grid = arrays["grid_%d" % n]
            self.assertAlmostEqual(grid[0, 0], 1.1 / n)
            radius = np.linalg.norm(centres(grid, n), axis=-1)
            self.assertTrue(inside[radius < 0.495].all())
            self.assertFalse(inside[radius > 0.5].any())
            self.assertEqual(int(success[1]["occupied_%d" % n]), inside.sum())
        np.testing.assert_allclose(arrays["transform"] @ (10, -3, 5, 1), (0, 0, 0, 1), atol=1e-12)
        np.testing.assert_allclose(arrays["transform"] @ (10, -3, 7, 1), (0, 0, 0.5, 1), atol=1e-12)

        boxed = np.load(self.out / "box" / "train" / "c.npz")
        inside = unpacked(boxed["occupancy_48"], 48)
        at = centres(boxed["grid_48"], 48)
        expected = (abs(at[..., 0]) < 0.5) & (abs(at[..., 1]) < 0.25) & (abs(at[..., 2]) < 0.125)
        np.testing.assert_array_equal(inside, expected)

    def test_all_content_of_a_box(self):
        self.succeed(self.models / "box", "-o", self.out, "--resolution", 20, "--no-pack",
                     "--content", "occupancy,distance,surface,coordinates,points,samples",
                     "--band", "all", "--points", 2000, "--near-points", 1000, "--sharp-points", 500,
                     "--samples", 3000, "--padding", 0.21, "--format", "npz,npy,binvox,vdb,nvdb")
        arrays = np.load(self.out / "train" / "c.npz")
        half = np.array((0.5, 0.25, 0.125))

        def distance(points):
            beyond = np.abs(points) - half
            outside = np.linalg.norm(np.maximum(beyond, 0), axis=-1)
            return outside + np.minimum(beyond.max(-1), 0)

        at = centres(arrays["grid_20"], 20)
        occupancy = arrays["occupancy_20"]
        self.assertEqual(occupancy.dtype, bool)
        np.testing.assert_array_equal(occupancy, distance(at) < 0)
        np.testing.assert_allclose(arrays["distance_20"], distance(at), atol=2e-7)
        voxel = 1.21 / 20
        low, high = at - voxel / 2, at + voxel / 2
        meets = ((low < half) & (high > -half)).all(-1)
        within = ((low >= -half) & (high <= half)).all(-1)
        np.testing.assert_array_equal(arrays["surface_20"], meets & ~within)
        np.testing.assert_array_equal(arrays["coordinates_20"], np.argwhere(occupancy))
        np.testing.assert_array_equal(arrays["surface_coordinates_20"],
                                      np.argwhere(arrays["surface_20"]))
        points = arrays["points"].astype(float)
        self.assertEqual(points.shape, (3500, 3))
        self.assertLessEqual(abs(points[:2000]).max(), 0.605)
        exact = distance(points)
        clear = abs(exact) > 1e-6
        np.testing.assert_array_equal(arrays["points_occupancy"][clear], (exact < 0)[clear])
        np.testing.assert_allclose(arrays["points_distance"], exact, atol=3e-7)
        self.assertLess(np.std(exact[2000:]), 0.02)
        samples, normals = arrays["samples"].astype(float), arrays["normals"]
        np.testing.assert_allclose(distance(samples), 0, atol=1e-7)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
        self.assertGreater(distance(samples + 0.01 * normals).min(), 0.0099)
        # Area of the box's six sides: 1 x 0.5, 1 x 0.25, 0.5 x 0.25.
        share = (abs(normals[:, 2]) > 0.5).mean()
        self.assertAlmostEqual(share, 0.5 / 0.875, delta=0.05)

        self.assertTrue((self.out / "train" / "c.occupancy_20.npy").exists())
        np.testing.assert_array_equal(np.load(self.out / "train" / "c.occupancy_20.npy"), occupancy)
        binvox = (self.out / "train" / "c_20.binvox").read_bytes()
        data = binvox[binvox.index(b"data\n") + 5:]
        runs = np.frombuffer(data, np.uint8).reshape(-1, 2)
        cells = np.repeat(runs[:, 0], runs[:, 1]).reshape(20, 20, 20).transpose(0, 2, 1)
        np.testing.assert_array_equal(cells.astype(bool), occupancy)
        for ending in ("vdb", "nvdb"):
            told = subprocess.run([PROGRAM, "info", "--json", "-", self.out / "train" / ("c_20." + ending)],
                                  capture_output=True, text=True)
            self.assertEqual(told.returncode, 0, told.stderr)
            self.assertIn('"mask"', told.stdout)

    ALL = ("--content", "occupancy,distance,surface,coordinates,points,samples", "--points", 700,
           "--near-points", 50, "--samples", 90, "--no-preview")

    def npz_of_all(self, *more):
        """The same arrays as .npz, a byte a boolean."""
        out = self.folder / "npz"
        self.succeed(self.models, "-o", out, "--no-pack", *self.ALL, *more)
        return {r["name"]: (r, np.load(out / r["files"])) for r in rows(out / "success.csv")}

    def same_arrays(self, arrays, expected, grid):
        """Types, shapes and values; `grid`: a voxel array's transform."""
        self.assertEqual(sorted(arrays.keys()), sorted(expected.keys()))
        for name in expected.keys():
            found, right = arrays[name], expected[name]
            self.assertEqual((found.dtype, found.shape), (right.dtype, right.shape), name)
            np.testing.assert_array_equal(found[()], right)
            size = name.rpartition("_")[2]
            if name.startswith(("occupancy_", "distance_", "surface_")) and right.ndim == 3:
                np.testing.assert_array_equal(grid(name), expected["grid_" + size])

    def test_hdf5(self):
        """Judged by h5py: each model's file, and a group each in archives."""
        try:
            import h5py
        except ImportError:
            self.skipTest("h5py is not installed")
        expected = self.npz_of_all("--resolution", "20,136")
        arguments = [self.models, "--format", "hdf5", "--resolution", "20,136", *self.ALL]
        self.succeed(*arguments, "-o", self.out)
        packed = self.folder / "packed"
        self.succeed(*arguments, "-o", packed, "--archives", 2)
        self.assertEqual([p.name for p in sorted(packed.glob("data-*"))],
                         ["data-00000-of-00002.h5", "data-00001-of-00002.h5"])
        self.assertEqual(list(packed.rglob("*.h5")), list(packed.glob("*.h5")))
        halves = [h5py.File(p, "r") for p in sorted(packed.glob("*.h5"))]
        for name, (row, arrays) in expected.items():
            with h5py.File(self.out / (name + ".h5"), "r") as alone:
                together = [half[name] for half in halves if name in half]
                self.assertEqual(len(together), 1)
                for group in (alone, together[0]):
                    self.same_arrays(group, arrays, lambda n: group[n].attrs["transform"])
                    self.assertEqual([group.attrs[k] for k in ("name", "id", "class", "split")],
                                     [row["name"], row["id"], row["class"], row["split"]])
                    np.testing.assert_array_equal(group.attrs["transform"], arrays["transform"])
                    self.assertEqual(group["distance_136"].chunks, (128, 128, 128))
        for half in halves:
            half.close()

    def test_a_device_that_is_not_there(self):
        """Nothing is begun."""
        done = run(self.models, "-o", self.out, "--device", "cuda:99")
        self.assertEqual(done.returncode, 6, done.stderr)
        self.assertIn("--device", str(done.stderr))
        self.assertFalse(self.out.exists())

    def test_half_floats_of_hdf5(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("h5py is not installed")
        arguments = [self.models / "ball", "--content", "points", "--points", 500, "--half-floats",
                     "--no-preview", "--format", "npz,hdf5,zarr"]
        self.succeed(*arguments, "-o", self.out)
        right = np.load(self.out / "train" / "a.npz")["points"]
        self.assertEqual(right.dtype, np.float16)
        with h5py.File(self.out / "train" / "a.h5", "r") as file:
            self.assertEqual(file["points"].dtype, np.float16)
            np.testing.assert_array_equal(file["points"][()], right)
        np.testing.assert_array_equal(ZarrStore(self.out / "train" / "a.zarr")["points"], right)

    def test_zarr(self):
        """Judged by the specification, and by zarr where it is installed; the whole folder is a
        group."""
        expected = self.npz_of_all("--resolution", "20,136")
        self.succeed(self.models, "-o", self.out, "--format", "zarr", "--resolution", "20,136",
                     *self.ALL)
        for name, (row, arrays) in expected.items():
            store = ZarrStore(self.out / (name + ".zarr"))
            self.same_arrays(store, arrays, lambda n: store.attributes(n)["transform"])
            self.assertEqual([store.attrs[k] for k in ("name", "id", "class", "split")],
                             [row["name"], row["id"], row["class"], row["split"]])
            np.testing.assert_array_equal(store.attrs["transform"], arrays["transform"])
        # The box is flat: no voxel of the upper chunks is occupied, and these are not written.
        chunks = {p.name for p in (self.out / "box/train/c.zarr/occupancy_136").glob("[0-9]*")}
        self.assertEqual(chunks, {"0.0.0", "1.0.0"})
        consolidated = json.loads((self.out / ".zmetadata").read_text())["metadata"]
        for path in self.out.rglob(".z*"):
            if path.name != ".zmetadata":
                key = str(path.relative_to(self.out))
                self.assertEqual(consolidated.pop(key), json.loads(path.read_text()), key)
        self.assertEqual(consolidated, {})
        try:
            import zarr
        except ImportError:
            return
        for opened in (zarr.open_group(str(self.out), mode="r"),
                       zarr.open_consolidated(str(self.out))):
            for name, (row, arrays) in expected.items():
                group = opened[name + ".zarr"]
                self.same_arrays(dict(group.arrays()), arrays,
                                 lambda n: group[n].attrs["transform"])
                self.assertEqual(group.attrs["id"], row["id"])

    def test_hdf5_and_zarr_are_the_same_bytes_for_any_shards(self):
        self.many(12)
        arguments = ["--format", "npz,hdf5,zarr", "--resolution", 24, "--archives", 3, "--content",
                     "occupancy,points", "--points", 100, "--no-preview"]
        whole = self.folder / "whole"
        self.succeed(self.models, "-o", whole, *arguments)
        expected = content(whole)
        self.assertEqual(len([n for n in expected if n.endswith(".h5")]), 3)
        self.assertEqual(len([n for n in expected if n.endswith(".tar")]), 3)
        self.assertIn("many/m03.zarr/occupancy_24/0.0.0", expected)
        out = self.folder / "shards"
        for shard in (2, 0, 1):
            self.succeed(self.models, "-o", out, *arguments, "--shard", "%d/3" % shard)
        self.succeed(self.models, "-o", out, *arguments, "--join")
        self.assertEqual(content(out), expected)
        killed = self.folder / "killed"
        rng = random.Random(5)
        for _ in range(4):
            more = ["--resume"] if killed.exists() else []
            process = subprocess.Popen([PROGRAM, "dataset", str(self.models), *map(str, arguments),
                                        "-o", str(killed), *more], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            try:
                process.wait(rng.uniform(0.02, 0.3))
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.wait()
        self.succeed(self.models, "-o", killed, *arguments, "--resume")
        self.assertEqual({n: h for n, h in content(killed).items() if ".tmp" not in n}, expected)

    def test_worker_without_a_parent_makes_nothing(self):
        # Its parent may have been killed before it began to run; the item is in the pipe then.
        ended = subprocess.Popen(["true"])
        ended.wait()
        item = "\0".join(["a", str(self.models / "ball" / "train" / "a.obj"), "", "", "0", ""])
        for parent, files in ((ended.pid, []), (os.getpid(), ["a.npz"])):
            subprocess.run(["sh", "-c", 'exec "$0" "$@" 3>/dev/null', PROGRAM, "dataset",
                            str(self.models), "-o", str(self.out), "--resolution", "16", "--worker"],
                           input=item.encode(), env={**os.environ, "TETVDB_PARENT": str(parent)},
                           timeout=600)
            self.assertEqual([p.name for p in self.out.rglob("*.npz")], files)

    def test_two_processes_do_not_make_the_same_models(self):
        arguments = [self.models / "ball", "-o", self.out, "--resolution", 16, "--no-preview"]
        self.succeed(*arguments)
        before = content(self.out)
        with open(self.out / "rows" / "all.jsonl", "a") as journal:
            fcntl.flock(journal, fcntl.LOCK_EX)
            done = run(*arguments, "--resume")
        self.assertEqual(done.returncode, 7)
        self.assertIn("another process makes these models", done.stderr)
        self.assertEqual(content(self.out), before)
        self.succeed(*arguments, "--resume")

    def test_layouts_of_other_projects(self):
        self.succeed(self.models / "ball", "-o", self.out, "--content", "points,samples", "--format",
                     "occupancy-networks,deepsdf", "--points", 4000, "--samples", 100,
                     "--near-points", 1000, "--normalize", "sphere", "--padding", 0.03)
        points = np.load(self.out / "train" / "a" / "points.npz")
        self.assertEqual(points["points"].dtype, np.float16)
        inside = np.unpackbits(points["occupancies"])[:5000].astype(bool)
        radius = np.linalg.norm(points["points"].astype(float), axis=1)
        self.assertTrue(inside[radius < 0.49].all())
        self.assertFalse(inside[radius > 0.502].any())
        np.testing.assert_allclose(points["loc"], (10, -3, 5), atol=1e-9)
        self.assertAlmostEqual(float(points["scale"]), 4, places=9)
        cloud = np.load(self.out / "train" / "a" / "pointcloud.npz")
        self.assertEqual(cloud["normals"].shape, (100, 3))
        sdf = np.load(self.out / "train" / "a.sdf.npz")
        self.assertEqual(len(sdf["pos"]) + len(sdf["neg"]), 5000)
        self.assertTrue((sdf["pos"][:, 3] >= 0).all() and (sdf["neg"][:, 3] < 0).all())
        rest = np.concatenate([sdf["pos"], sdf["neg"]])
        self.assertLess(abs(np.linalg.norm(rest[:, :3], axis=1) - 0.5 - rest[:, 3]).max(), 5e-3)

    def write_list(self, name="list.csv", order=None):
        entries = [("b1", "box/train/c.obj", "box", "train"), ("b2", "box/train/d.obj", "box", "test"),
                   ("s,1", "ball/train/a.obj", 'a "ball"', "train"),
                   ("s2", "ball/test/b.obj", "ball", "")]
        if order:
            order(entries)
        with open(self.models / name, "w", newline="") as file:
            out = csv.writer(file)
            out.writerow(["ID", "path", "class", "split", "note"])
            for entry in entries:
                out.writerow([*entry, "x"])
        return self.models / name

    def test_lists(self):
        self.succeed(self.write_list(), "-o", self.out, "--resolution", 16)
        self.assertEqual([(r["id"], r["class"], r["split"]) for r in rows(self.out / "success.csv")],
                         [("b1", "box", "train"), ("b2", "box", "test"), ("s,1", 'a "ball"', "train"),
                          ("s2", "ball", "")])
        self.assertTrue((self.out / "train" / "box" / "b1.npz").exists())
        self.assertTrue((self.out / "ball" / "s2.npz").exists())
        (self.models / "list.jsonl").write_text(
            '{"path": "box/train/c.obj", "id": "x1"}\n\n{"file": "ball/test/b.obj"}\n')
        other = self.folder / "other"
        self.succeed(self.models / "list.jsonl", "-o", other, "--resolution", 16)
        self.assertEqual([r["id"] for r in rows(other / "success.csv")], ["ball/test/b", "x1"])
        self.assertEqual(np.load(other / "train" / "box" / "x1.npz")["occupancy_16"].tobytes(),
                         np.load(self.out / "train" / "box" / "b1.npz")["occupancy_16"].tobytes())

    def test_bad_lists_are_refused_by_line(self):
        for text, part in (("path,id\na.obj\n", "line 2"), ("path,id\na.obj,../x\n", "line 2"),
                           ("path,id\na.obj,x\nb.obj,x\n", "'x'"), ('path\n"a.obj\n', "quote"),
                           ("id\nx\n", "no file"), ("path\n", "no models"),
                           ("path,id\na.obj,/etc/x\n", "line 2"),
                           ("path,class\na.obj,../../x\n", "line 2")):
            (self.models / "bad.csv").write_text(text)
            done = run(self.models / "bad.csv", "-o", self.out)
            self.assertEqual(done.returncode, 3, text)
            self.assertIn(part, done.stderr, text)
            self.assertFalse(self.out.exists() and any(self.out.rglob("*.npz")))
        (self.models / "bad.jsonl").write_text("[1]\n")
        self.assertEqual(run(self.models / "bad.jsonl", "-o", self.out).returncode, 3)
        self.assertEqual(run(self.models / "list.txt", "-o", self.out).returncode, 2)

    def test_variants_are_reproducible_and_differ(self):
        arguments = ["--resolution", 32, "--variants", 2, "--turn", "any", "--scale-jitter", 0.3,
                     "--move-jitter", 0.02, "--padding", 0.9, "--no-preview"]
        self.succeed(self.models / "box", "-o", self.out, *arguments)
        success = rows(self.out / "success.csv")
        self.assertEqual([r["name"] for r in success if r["id"] == "train/c"],
                         ["train/c", "train/c_v1", "train/c_v2"])
        arrays = [np.load(self.out / "train" / (name + ".npz")) for name in ("c", "c_v1", "c_v2")]
        self.assertNotEqual(arrays[1]["occupancy_32"].tobytes(), arrays[2]["occupancy_32"].tobytes())
        for one in arrays:
            turn = one["transform"][:3, :3]
            scale = np.linalg.norm(turn[0])
            np.testing.assert_allclose(turn @ turn.T, scale ** 2 * np.eye(3), atol=1e-12)
            # The longest side is 4 before it is turned, and at most the diagonal after.
            self.assertTrue(0.7 / math.sqrt(21) <= scale <= 0.5)
            # The box's corners, moved, hold the solid.
            back = np.linalg.inv(one["transform"])
            at = centres(one["grid_32"], 32) @ back[:3, :3].T + back[:3, 3]
            expected = ((at > 0) & (at < (4, 2, 1))).all(-1)
            self.assertLessEqual((unpacked(one["occupancy_32"], 32) != expected).sum(), 2)
        alone = self.folder / "alone"
        only = self.folder / "only" / "train"
        only.mkdir(parents=True)
        shutil.copy(self.models / "box" / "train" / "c.obj", only)
        self.succeed(only.parent, "-o", alone, *arguments)
        for name in ("c", "c_v1", "c_v2"):
            self.assertEqual((alone / "train" / (name + ".npz")).read_bytes(),
                             (self.out / "train" / (name + ".npz")).read_bytes())

    def many(self, count=20):
        rng = random.Random(7)
        for i in range(count):
            if i % 10 == 9:
                (self.models / ("bad%02d.off" % i)).write_text("OFF\n1 1 0\n0 0 0\n3 0 1 2\n")
            else:
                write_obj(self.models / "many" / ("m%02d.obj" % i),
                          ball(6 + i % 5, rng.uniform(1, 3), (i, 0, 0)))

    def test_shards_and_archives_are_the_same_bytes(self):
        self.many()
        arguments = ["--resolution", 24, "--archives", 3, "--content", "occupancy,points",
                     "--points", 100]
        whole = self.folder / "whole"
        self.succeed(self.models, "-o", whole, *arguments)
        expected = content(whole)
        self.assertEqual(len([n for n in expected if n.endswith(".tar")]), 3)
        self.assertFalse([n for n in expected if n.endswith(".npz")])
        names = []
        for name in expected:
            if name.endswith(".tar"):
                with tarfile.open(whole / name) as tar:
                    names += tar.getnames()
        keys = {n.split(".")[0] for n in names}
        self.assertEqual(keys, {r["name"] for r in rows(whole / "success.csv")})
        self.assertTrue(all(k + ".json" in names and k + ".npz" in names for k in keys))
        out = self.folder / "of3"
        for shard in (2, 0, 1):
            self.succeed(self.models, "-o", out, *arguments, "--shard", "%d/3" % shard, "--workers", 1)
        self.assertFalse((out / "success.csv").exists())
        self.succeed(self.models, "-o", out, *arguments, "--join")
        self.assertEqual(content(out), expected)
        plain = lambda f: [(r["name"], r.get("file_hash"), r.get("error")) for r in rows(f)]
        for table in ("success.csv", "failed.csv"):
            self.assertEqual(plain(out / table), plain(whole / table))

    def test_join_names_what_is_missing(self):
        self.many()
        self.succeed(self.models, "-o", self.out, "--shard", "0/2", "--resolution", 16)
        done = run(self.models, "-o", self.out, "--resolution", 16, "--join")
        self.assertEqual(done.returncode, 3)
        self.assertIn("no result yet", done.stderr)

    def test_environment_of_launchers(self):
        clean = {k: v for k, v in os.environ.items()
                 if not k.startswith(("SLURM_", "OMPI_", "PMI_"))}
        for variables, shard in (
                ({"SLURM_ARRAY_TASK_ID": "7", "SLURM_ARRAY_TASK_MIN": "5",
                  "SLURM_ARRAY_TASK_STEP": "2", "SLURM_ARRAY_TASK_COUNT": "4"}, {"index": 1, "count": 4}),
                ({"OMPI_COMM_WORLD_RANK": "2", "OMPI_COMM_WORLD_SIZE": "3"}, {"index": 2, "count": 3}),
                ({"PMI_RANK": "0", "PMI_SIZE": "2"}, {"index": 0, "count": 2})):
            shutil.rmtree(self.out, ignore_errors=True)
            done = self.succeed(self.models, "-o", self.out, "--shard", "auto", "--resolution", 8,
                                "--json", "-", env={**clean, **variables})
            self.assertEqual(json.loads(done.stdout[done.stdout.index("{"):])["shard"], shard)
        done = run(self.models, "-o", self.folder / "none", "--shard", "auto", env=clean)
        self.assertEqual(done.returncode, 2)
        self.assertEqual(run(self.models, "-o", self.folder / "none", "--shard", "3/3").returncode, 2)

    def test_killed_at_any_moment_goes_on_to_the_same_bytes(self):
        self.many(60)
        arguments = [self.models, "--resolution", 48, "--archives", 2, "--content",
                     "occupancy,points", "--points", 2000, "--no-preview"]
        whole = self.folder / "whole"
        self.succeed(*arguments, "-o", whole)
        expected = content(whole)
        rng = random.Random(3)
        # TETVDB_KILLS=20 looks at more moments.
        for attempt in range(int(os.environ.get("TETVDB_KILLS", 3))):
            out = self.folder / ("killed%d" % attempt)
            for _ in range(3):
                more = ["--resume"] if out.exists() else []
                process = subprocess.Popen([PROGRAM, "dataset", *map(str, arguments), "-o", str(out),
                                            *more], stdout=subprocess.DEVNULL,
                                           stderr=subprocess.DEVNULL)
                try:
                    process.wait(rng.uniform(0.02, 0.6))
                except subprocess.TimeoutExpired:
                    process.send_signal(signal.SIGKILL)
                    process.wait()
            self.succeed(*arguments, "-o", out, "--resume")
            left = [n for n in content(out) if n.endswith(".tmp")]
            self.assertEqual({n: h for n, h in content(out).items() if n not in left}, expected)
            names = [r["name"] for t in ("success.csv", "failed.csv") for r in rows(out / t)]
            self.assertEqual(len(names), len(set(names)))
            self.assertEqual(len(names), 65)

    def test_workers_die_with_their_parent(self):
        self.many(60)
        process = subprocess.Popen([PROGRAM, "dataset", str(self.models), "-o", str(self.out),
                                    "--resolution", "256", "--workers", "2"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        mine = lambda: [p for p in Path("/proc").glob("[0-9]*/cmdline")
                        if str(self.out).encode() in self.read(p) and b"--worker\0" in self.read(p)]
        deadline = time.monotonic() + 20
        while not mine() and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertTrue(mine())
        process.kill()
        process.wait()
        deadline = time.monotonic() + 20
        while mine() and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertEqual(mine(), [])

    @staticmethod
    def read(path):
        try:
            return path.read_bytes()
        except OSError:
            return b""

    def test_time_limit_costs_one_model(self):
        large = self.models / "large.obj"
        write_obj(large, ball(100, 1, (0, 0, 0)))
        points, faces = large.read_text().split("f ", 1)
        large.write_text(points + ("f " + faces) * 60)  # 2.4 million faces
        # A limit between the times that the models take now: the machine may do other work.
        self.succeed(self.models, "-o", self.out, "--resolution", 16, "--no-preview", "--workers", 2)
        seconds = {r["id"]: float(r["seconds"]) for r in rows(self.out / "success.csv")}
        limit = math.sqrt(seconds.pop("large") * max(seconds.values()))
        shutil.rmtree(self.out)
        self.succeed(self.models, "-o", self.out, "--resolution", 16, "--max-time", limit,
                     "--no-preview", "--workers", 2)
        failed = {r["id"]: r for r in rows(self.out / "failed.csv")}
        self.assertIn("large", failed)
        self.assertIn("not done after", failed["large"]["error"])
        self.assertEqual(failed["large"]["status"], "5")

    def test_a_crash_costs_one_model(self):
        self.many(30)
        process = subprocess.Popen([PROGRAM, "dataset", str(self.models), "-o", str(self.out),
                                    "--resolution", "128", "--workers", "1", "--no-preview"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        killed = 0
        while process.poll() is None and killed < 3:
            for path in Path("/proc").glob("[0-9]*/cmdline"):
                words = self.read(path)
                if str(self.out).encode() in words and b"--worker\0" in words:
                    try:
                        os.kill(int(path.parent.name), signal.SIGSEGV)
                        killed += 1
                    except ProcessLookupError:
                        pass
            time.sleep(0.05)
        self.assertEqual(process.wait(300), 0)
        failed = rows(self.out / "failed.csv")
        crashed = [r for r in failed if "signal 11" in r["error"]]
        self.assertTrue(0 < len(crashed) <= killed or killed == 0)
        self.assertEqual(len(failed) + len(rows(self.out / "success.csv")), 35)

    def test_settings_must_agree(self):
        self.succeed(self.models, "-o", self.out, "--resolution", 16)
        self.assertEqual(run(self.models, "-o", self.out, "--resolution", 16).returncode, 2)
        done = run(self.models, "-o", self.out, "--resolution", 32, "--resume")
        self.assertEqual(done.returncode, 2)
        self.assertIn("resolutions", done.stderr)
        self.succeed(self.models, "-o", self.out, "--resolution", 16, "--resume")
        self.assertEqual(run(self.models, "-o", self.folder / "x", "--format", "deepsdf").returncode, 2)
        self.assertEqual(run(self.models, "-o", self.folder / "x", "--content", "points",
                             "--format", "binvox").returncode, 2)


if __name__ == "__main__":
    unittest.main()
