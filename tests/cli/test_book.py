# SPDX-License-Identifier: Apache-2.0
"""tetvdb_bench --book: pages, plots and targets, from tiny meshes."""

import json
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

BENCH = pathlib.Path(os.environ["TETVDB_PROGRAM"]).parent / "tetvdb_bench"
SVG = "{http://www.w3.org/2000/svg}"
OURS = "#0072b2"


@unittest.skipUnless(BENCH.exists(), "the benchmarks are not built")
class Book(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name) / "new" / "book"
        done = subprocess.run([BENCH, "occupancy", "resolution", "--shrink", "1000", "--repeat", "3", "--book",
                               cls.folder], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        cls.chapters = {name: json.loads((cls.folder / f"{name}.json").read_text())
                        for name in ("occupancy", "resolution")}

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def drawing(self, name):
        return xml.parse(self.folder / f"{name}.svg").getroot()

    def test_a_page_says_what_was_run_where_and_when(self):
        page = (self.folder / "occupancy.md").read_text()
        self.assertIn("tetvdb_bench occupancy --repeat 3 --shrink 1000 --book docs/benchmarks", page)
        machine = self.chapters["occupancy"]["machine"]
        for key in ("date", "processor", "revision", "compiler", "libraries"):
            self.assertTrue(machine[key], key)
            self.assertIn(machine[key], page)
        self.assertIn("![times](occupancy.svg)", page)
        for row in self.chapters["occupancy"]["result"]["rows"]:
            self.assertRegex(page, rf"(?m)^\| {re.escape(row['what'])} +\| {re.escape(row['peer'])} ")

    def test_bars_are_as_long_as_the_logarithms_of_medians(self):
        rows = self.chapters["occupancy"]["result"]["rows"]
        medians = {}
        for row in rows:
            medians[row["what"]] = sorted(row["ours_seconds"])[1]
        bars = [box for box in self.drawing("occupancy").iter(SVG + "rect") if box.get("fill") == OURS]
        self.assertEqual(len(bars), len(medians))
        widths = [float(box.get("width")) for box in bars]
        logs = [math.log10(seconds) for seconds in medians.values()]
        low, high = min(logs), max(logs)
        self.assertGreater(high, low)
        scale = (max(widths) - min(widths)) / (high - low)
        for width, value in zip(widths, logs):
            self.assertAlmostEqual(width, min(widths) + (value - low) * scale, delta=0.5)

    def test_curves_have_a_point_for_every_size(self):
        rows = self.chapters["resolution"]["result"]["rows"]
        ours = {(row["curve"], row["at"]) for row in rows}
        theirs = {row["at"] for row in rows if row["peer_seconds"]}
        dots = list(self.drawing("resolution").iter(SVG + "circle"))
        self.assertEqual(len(dots), len(ours) + len(theirs))
        words = {text.text for text in self.drawing("resolution").iter(SVG + "text")}
        self.assertLessEqual({"mask", "density", "tet_id", "paper's loop", "voxels along a side"}, words)

    def test_targets_are_judged_by_the_medians(self):
        asked = [row for row in self.chapters["occupancy"]["result"]["rows"] if row["target_ratio"] > 0]
        page = (self.folder / "targets.md").read_text()
        lines = [line for line in page.splitlines() if line.startswith("| mask") or line.startswith("| density")]
        self.assertEqual(len(lines), len(asked))
        reached = 0
        for row, line in zip(asked, lines):
            ratio = sorted(row["peer_seconds"])[1] / sorted(row["ours_seconds"])[1]
            self.assertEqual(" yes " in line, ratio >= row["target_ratio"], line)
            reached += ratio >= row["target_ratio"]
        self.assertIn(f"{reached} of {len(asked)} are reached", page)

    def test_other_chapters_stay(self):
        done = subprocess.run([BENCH, "rules", "--shrink", "1000", "--repeat", "1", "--book", self.folder],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "rules.md").exists())
        self.assertTrue((self.folder / "occupancy.md").exists())
        self.assertIn("[occupancy](occupancy.md)", (self.folder / "targets.md").read_text())

    def test_a_folder_that_cannot_be_made(self):
        done = subprocess.run([BENCH, "rules", "--shrink", "1000", "--repeat", "1", "--book", "/proc/none/book"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("/proc/none/book", done.stderr)


if __name__ == "__main__":
    unittest.main()
