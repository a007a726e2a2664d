# SPDX-License-Identifier: Apache-2.0
"""tetvdb check, by the program."""

import unittest

import program
from program import lattice, medit
from test_fields import simulation


class Check(program.CommandLineTest):
    def test_what_voxelize_writes_is_fine(self):
        self.write("a.mesh", medit(*lattice(3)))
        self.succeed("voxelize", "a.mesh", "-o", "a.vdb", "--grid", "density,mask,surface",
                     "--resolution", 64)
        self.assertIn("nothing wrong", self.succeed("check", "a.vdb").out)
        report = self.report_of("check", "a.vdb", "--target", "houdini")
        self.assertEqual([f["code"] for f in report["findings"]], ["up-axis"])  # a note

    def test_findings_and_their_cures(self):
        self.write("a.vtu", simulation(scale=2e5))
        self.succeed("voxelize", "a.vtu", "-o", "a.vdb", "--grid", "temperature", "--resolution", 8)
        report = self.report_of("check", "a.vdb", status=8)
        self.assertEqual([f["code"] for f in report["findings"]], ["usual-name", "hidden-values"])
        self.assertIn("--remap temperature=0:1", report["findings"][1]["cure"])
        self.assertIn("[hidden-values]", self.succeed("check", "a.vdb", status=8).out)

    def test_gap_in_a_sequence(self):
        self.write("a.mesh", medit(*lattice(2)))
        for i in (1, 2, 4):
            self.succeed("voxelize", "a.mesh", "-o", f"s.{i:04}.vdb", "--resolution", 8)
        self.succeed("check", "s.0001.vdb", "s.0002.vdb")
        report = self.report_of("check", "s.0001.vdb", "s.0002.vdb", "s.0004.vdb", status=8)
        self.assertEqual([f["code"] for f in report["findings"]], ["sequence-gap"])

    def test_bad_arguments(self):
        self.refuse(3, "check", "none.vdb", says="none.vdb")
        self.write("no.vdb", "nothing")
        self.refuse(3, "check", "no.vdb", says="no.vdb")
        self.refuse(2, "check", says="required")
        self.refuse(2, "check", "no.vdb", "--target", "maya", says="maya")


if __name__ == "__main__":
    unittest.main()
