# SPDX-License-Identifier: Apache-2.0
"""Sequences of meshes into sequences of volumes."""

import unittest

import program
from program import lattice
from test_fields import vtu_with


def frame(shift=0.0, level=0.0, side=1.0, name="T"):
    points, tets = lattice(2, origin=(shift, 0.0, 0.0), side=side)
    return vtu_with(points, tets, [(name, [level + p[0] for p in points]),
                                   ("disp", [(0.25, 0, 0)] * len(points))])


class Sequences(program.CommandLineTest):
    def frames(self, count=3, pattern="f_%d.vtu", first=0, step=1):
        for i in range(count):
            self.write(pattern % (first + step * i), frame(shift=0.5 * i, level=10.0 * i))

    def grids_of(self, name):
        info = self.report_of("info", name)["input"][0]
        return {g["name"]: g for g in info["grids"]}, info

    def test_pattern_has_one_transform_and_contiguous_names(self):
        self.frames(count=3, first=8, step=2)  # 8, 10, 12: by number, not by letter
        report = self.report_of("voxelize", "f_*.vtu", "-o", "out.vdb", "--resolution", 32,
                                "--grid", "density,T")
        self.assertEqual([f["input"] for f in report["frames"]],
                         [["f_8.vtu"], ["f_10.vtu"], ["f_12.vtu"]])
        self.assertEqual(sorted(p.name for p in self.folder.glob("out*")),
                         ["out.0001.vdb", "out.0002.vdb", "out.0003.vdb"])
        for i in range(3):
            grids, info = self.grids_of(f"out.{i + 1:04}.vdb")
            # The union is 2 long: a voxel is 1/16, a frame 16 voxels, each 8 on from the last.
            self.assertEqual(grids["T"]["voxel_size"], [2 / 32] * 3)
            self.assertEqual(grids["density"]["active_voxels"], 16 ** 3)
            self.assertEqual(grids["T"]["box"]["min"], [8 * i, 0, 0])
            self.assertEqual(info["metadata"]["frame"], str(i + 1))

    def test_same_as_one_by_one(self):
        self.frames()
        self.succeed("voxelize", "f_*.vtu", "-o", "out.vdb", "--voxel-size", 0.1, "--grid", "all")
        for i in range(3):
            self.succeed("voxelize", f"f_{i}.vtu", "-o", "one.vdb", "--voxel-size", 0.1, "--grid",
                         "all")
            self.assertEqual(self.hash_of("one.vdb"), self.hash_of(f"out.{i + 1:04}.vdb"))

    def test_range_is_that_of_all_frames(self):
        self.frames()
        self.succeed("voxelize", "f_*.vtu", "-o", "out.vdb", "--resolution", 32, "--grid", "T",
                     "--remap", "0:1")
        # Values are 0..1, 10.5..11.5, 21..22.
        for i, low in enumerate((0.0, 10.5, 21.0)):
            grids, _ = self.grids_of(f"out.{i + 1:04}.vdb")
            self.assertAlmostEqual(grids["T"]["min"], low / 22, 5)
            self.assertEqual(float(grids["T"]["metadata"]["original_max"]), 22)

    def test_collection_with_times_and_parts(self):
        self.frames(count=4)
        self.write("run.pvd", """<?xml version="1.0"?>
<VTKFile type="Collection" version="0.1" byte_order="LittleEndian"><Collection>
<DataSet timestep="2.5" group="" part="0" file="f_3.vtu"/>
<DataSet timestep="0" group="" part="0" file="f_0.vtu"/>
<DataSet timestep="0" group="" part="1" file="f_2.vtu"/>
<DataSet timestep="1e-1" group="" part="0" file="f_1.vtu"/></Collection></VTKFile>""")
        report = self.report_of("voxelize", "run.pvd", "-o", "out.vdb", "--voxel-size", 0.1)
        self.assertEqual([f["time"] for f in report["frames"]], [0, 0.1, 2.5])
        self.assertEqual(report["frames"][0]["input"], ["f_0.vtu", "f_2.vtu"])
        grids, info = self.grids_of("out.0001.vdb")
        self.assertEqual(grids["density"]["active_voxels"], 2000)
        self.assertEqual(info["metadata"]["time"], "0")
        some = self.report_of("voxelize", "run.pvd", "-o", "some.vdb", "--voxel-size", 0.1,
                              "--frames", "2:3")
        self.assertEqual([f["time"] for f in some["frames"]], [0.1, 2.5])

    def test_steps_of_xdmf(self):
        points, tets = lattice(2)
        numbers = lambda rows: " ".join(str(x) for row in rows for x in row)
        item = lambda size, text, more="": (f'<DataItem Format="XML" Dimensions="{size}" {more}>'
                                            f'{text}</DataItem>')
        step = lambda time: (
            '<Grid><xi:include xpointer="xpointer(//Grid[@Name=&quot;mesh&quot;]/*[self::Topology '
            f'or self::Geometry])"/><Time Value="{time}"/><Attribute Name="T" Center="Node">'
            + item(len(points), " ".join(str(time * 10 + p[0]) for p in points))
            + "</Attribute></Grid>")
        self.write("run.xdmf", '<Xdmf Version="3.0" xmlns:xi="http://www.w3.org/2001/XInclude">'
                   '<Domain><Grid GridType="Collection" CollectionType="Temporal">'
                   + "".join(step(t) for t in (0, 0.5, 2)) + '</Grid><Grid Name="mesh">'
                   f'<Topology TopologyType="Tetrahedron" NumberOfElements="{len(tets)}">'
                   + item(4 * len(tets), numbers(tets), 'NumberType="Int"')
                   + '</Topology><Geometry GeometryType="XYZ">'
                   + item(3 * len(points), numbers(points), 'Precision="8"')
                   + "</Geometry></Grid></Domain></Xdmf>")
        report = self.report_of("voxelize", "run.xdmf", "-o", "out.vdb", "--voxel-size", 0.125,
                                "--grid", "T", "--frames", "all")
        self.assertEqual([f["time"] for f in report["frames"]], [0, 0.5, 2])
        grids, info = self.grids_of("out.0003.vdb")
        self.assertEqual(grids["T"]["active_voxels"], 8 ** 3)
        self.assertAlmostEqual(grids["T"]["max"], 20 + 0.875, places=5)
        self.assertEqual(info["metadata"]["time"], "2")
        self.succeed("voxelize", "run.xdmf", "-o", "last.vdb", "--voxel-size", 0.125, "--grid", "T")
        self.assertEqual(self.hash_of("last.vdb"), self.hash_of("out.0003.vdb"))

    def test_finished_frames_are_skipped(self):
        self.frames()
        run = lambda *more: [f["skipped"] for f in self.report_of(
            "voxelize", "f_*.vtu", "-o", "out.vdb", "--voxel-size", 0.1, *more)["frames"]]
        self.assertEqual(run(), [False] * 3)
        self.assertEqual(run(), [True] * 3)
        self.assertEqual(run("--again"), [False] * 3)
        self.path("out.0002.vdb").unlink()
        self.write("out.0003.vdb", "no volume")
        self.assertEqual(run(), [True, False, False])
        self.assertEqual(run("--grid", "mask"), [False] * 3)
        self.assertEqual(run(), [False] * 3)
        self.write("f_1.vtu", frame(shift=7))
        self.assertEqual(run(), [True, False, True])

    def test_same_bits_for_any_number_of_threads(self):
        self.frames(count=5)
        hashes = set()
        for n in (1, 2, 4):
            self.succeed("voxelize", "f_*.vtu", "-o", f"o{n}.vdb", "--voxel-size", 0.05, "--grid",
                         "all", "--threads", n)
            hashes.add(tuple(self.hash_of(f"o{n}.{i:04}.vdb") for i in range(1, 6)))
        self.assertEqual(len(hashes), 1)

    def test_warp_and_triangles(self):
        self.frames(count=2)
        self.succeed("voxelize", "f_*.vtu", "-o", "out.vdb", "--voxel-size", 0.125, "--warp",
                     "disp*2")
        grids, _ = self.grids_of("out.0001.vdb")
        self.assertEqual(grids["density"]["box"]["min"], [4, 0, 0])
        for i in range(2):
            self.write(f"t{i}.off", program.off(*program.box_faces(high=(1 + i, 1, 1))))
        self.succeed("voxelize", "t?.off", "-o", "t.vdb", "--resolution", 32, "--grid", "mask")
        counts = [self.grids_of(f"t.000{i}.vdb")[0]["mask"]["active_voxels"] for i in (1, 2)]
        self.assertEqual(counts, [16 ** 3, 2 * 16 ** 3])

    def test_gaps(self):
        self.frames()
        self.write("f_5.vtu", frame())
        self.refuse(3, "voxelize", "f_*.vtu", "-o", "out.vdb",
                    says=("number 3 is missing", "--allow-gaps"))
        report = self.report_of("voxelize", "f_*.vtu", "-o", "out.vdb", "--voxel-size", 0.2,
                                "--allow-gaps")
        self.assertEqual(report["frames"][-1]["output"], "out.0004.vdb")

    def test_numbered_files_are_frames_unless_united(self):
        self.frames(count=3, first=8)
        names = ["f_10.vtu", "f_8.vtu", "f_9.vtu"]  # as a shell sorts them
        run = self.succeed("voxelize", *names, "-o", "out.vdb", "--voxel-size", 0.125)
        self.assertIn("--union", run.out)
        self.assertEqual(sorted(p.name for p in self.folder.glob("out*")),
                         [f"out.000{i}.vdb" for i in (1, 2, 3)])
        self.succeed("voxelize", "f_8.vtu", "-o", "one.vdb", "--voxel-size", 0.125)
        self.assertEqual(self.hash_of("one.vdb"), self.hash_of("out.0001.vdb"))
        # Frames are unit cubes half a unit apart: together 2 x 1 x 1.
        self.succeed("voxelize", *names, "-o", "whole.vdb", "--voxel-size", 0.125, "--union")
        self.assertEqual(self.grids_of("whole.vdb")[0]["density"]["active_voxels"], 16 * 8 * 8)
        self.succeed("voxelize", "f_*.vtu", "-o", "same.vdb", "--voxel-size", 0.125, "--union")
        self.assertEqual(self.hash_of("whole.vdb"), self.hash_of("same.vdb"))
        some = self.report_of("voxelize", *names, "-o", "some.vdb", "--frames", "2:3")
        self.assertEqual([f["input"] for f in some["frames"]], [["f_9.vtu"], ["f_10.vtu"]])
        self.write("f_13.vtu", frame())
        self.refuse(3, "voxelize", *names, "f_13.vtu", "-o", "gap.vdb", says="number 11 is missing")
        self.refuse(2, "voxelize", *names, "-o", "x.vdb", "--union", "--frames", "all",
                    says="--frames")
        self.write("run.pvd", "<VTKFile type='Collection'><Collection>"
                              "<DataSet timestep='0' file='f_8.vtu'/></Collection></VTKFile>")
        self.refuse(2, "voxelize", "run.pvd", "-o", "x.vdb", "--union", says="times")

    def test_frames_of_a_case_are_made_again_where_its_files_changed(self):
        def foam(name, kind, text):
            path = self.path(name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("FoamFile\n{\n version 2.0;\n format ascii;\n class %s;\n object x;\n}\n%s\n"
                            % (kind, text))

        mesh = "case/constant/polyMesh/"
        foam(mesh + "points", "vectorField", "4((0 0 0)(1 0 0)(0 1 0)(0 0 1))")
        foam(mesh + "faces", "faceList", "4(3(0 2 1)3(0 1 3)3(1 2 3)3(2 0 3))")
        foam(mesh + "owner", "labelList", "4{0}")
        foam(mesh + "neighbour", "labelList", "0()")
        field = lambda value: "internalField uniform %d;" % value
        for time, value in (("0", 1), ("0.5", 2), ("1", 3)):
            foam("case/%s/T" % time, "volScalarField", field(value))
        self.write("case/case.foam", "")
        run = lambda: self.report_of("voxelize", "case/case.foam", "-o", "out.vdb", "--resolution", 16, "--grid", "T",
                                     "--frames", "all")["frames"]
        frames = run()
        self.assertEqual([f["time"] for f in frames], [0, 0.5, 1])
        self.assertEqual(self.grids_of("out.0003.vdb")[0]["T"]["max"], 3)
        self.assertEqual([f["skipped"] for f in run()], [True] * 3)
        foam("case/0.5/T", "volScalarField", field(200))
        self.assertEqual([f["skipped"] for f in run()], [True, False, True])
        self.assertEqual(self.grids_of("out.0002.vdb")[0]["T"]["max"], 200)

    def test_files_with_other_names_are_one_volume(self):
        for name, low in (("left", 0), ("right2", 1)):
            self.write(name + ".off", program.off(*program.box_faces(low=(low, 0, 0),
                                                                     high=(low + 1, 1, 1))))
        self.succeed("voxelize", "left.off", "right2.off", "-o", "both.vdb", "--voxel-size", 0.125,
                     "--mesher", "winding")
        self.assertEqual(self.grids_of("both.vdb")[0]["density"]["active_voxels"], 2 * 8 ** 3)

    def test_values_are_judged_over_all_frames(self):
        # A field that is 0 in the first frame, as most simulations begin.
        points, tets = lattice(2)
        for i, level in enumerate((0.0, 0.0, 1.0)):
            self.write(f"z_{i}.vtu", vtu_with(points, tets, [("T", [level] * len(points))]))
        make = lambda pattern, out: self.report_of("voxelize", pattern, "-o", out, "--voxel-size",
                                                   0.1, "--grid", "T", "--again")
        self.assertEqual(make("z_*.vtu", "z.vdb")["warnings"], [])
        check = self.report_of("check", *(f"z.{i:04}.vdb" for i in (1, 2, 3)))
        self.assertNotIn("hidden-values", [f["code"] for f in check["findings"]])
        self.write("z_1.vtu", vtu_with(points, tets, [("T", [-5.0] * len(points))]))
        (warning,) = make("z_*.vtu", "z.vdb")["warnings"]
        self.assertEqual(warning["code"], "hidden-values")
        self.assertIn("frame 2 (z_1.vtu)", warning["text"])
        check = self.report_of("check", *(f"z.{i:04}.vdb" for i in (1, 2, 3)), status=8)
        (finding,) = [f for f in check["findings"] if f["code"] == "hidden-values"]
        self.assertEqual(finding["file"], "z.0002.vdb")

    def test_arrays_that_change(self):
        self.frames()
        self.write("f_2.vtu", frame(name="U"))
        ask = lambda grid, says: self.refuse(3, "voxelize", "f_*.vtu", "-o", "out.vdb", "--grid",
                                             grid, says=says)
        ask("T", ("frame 3 (f_2.vtu)", "no array 'T'"))
        ask("all", ("frame 3 (f_2.vtu)", "other arrays", "U, disp in place of T, disp"))

    def test_bad_sequences(self):
        self.frames()
        ask = lambda status, *arguments, says: self.refuse(
            status, "voxelize", *arguments, "-o", "out.vdb", says=says)
        ask(3, "g_*.vtu", says="no file matches")
        ask(2, "f_*.vtu", "f_0.vtu", says="must be the only input")
        ask(2, "f_*.vtu", "--frames", "2:9", says="no frame 9")
        ask(2, "f_*.vtu", "--frames", "3:2", says="FIRST:LAST")
        ask(2, "f_*.vtu", "--frames", "x", says="FIRST:LAST")
        ask(2, "f_0.vtu", "--frames", "all", says="is no sequence")
        ask(2, "f_*.vtu", "--write-mesh", "m.msh", says="one mesh")
        self.write("f_1.vtu", frame()[:400])
        ask(3, "f_*.vtu", says="frame 2 (f_1.vtu)")
        self.write("bad.pvd", "<VTKFile type='Collection'><Collection>"
                              "<DataSet timestep='0' file='none.vtu'/></Collection></VTKFile>")
        ask(3, "bad.pvd", says="'none.vtu' is missing")
        self.write("empty.pvd", "<VTKFile type='Collection'><Collection/></VTKFile>")
        ask(3, "empty.pvd", says="empty")

    def test_exodus_steps(self):
        steps = self.make_exodus()
        report = self.report_of("voxelize", "e.exo", "-o", "out.vdb", "--frames", "all",
                                "--voxel-size", 0.25, "--grid", "T")
        self.assertEqual([f["time"] for f in report["frames"]], steps)
        for i in range(len(steps)):
            grids, _ = self.grids_of(f"out.{i + 1:04}.vdb")
            self.assertEqual((grids["T"]["min"], grids["T"]["max"]), (10.0 * i + 1, 10.0 * i + 1))
        self.succeed("voxelize", "e.exo", "-o", "last.vdb", "--voxel-size", 0.25, "--grid", "T")
        self.assertEqual(self.grids_of("last.vdb")[0]["T"]["min"], 10.0 * (len(steps) - 1) + 1)

    def make_exodus(self):
        """A classic netCDF file, by hand: a unit corner tet, three steps of one nodal variable."""
        import struct
        times = [0.0, 0.5, 2.0]
        names = ["time_step", "num_dim", "num_nodes", "num_elem", "num_el_blk", "num_el_in_blk1",
                 "num_nod_per_el1", "num_nod_var", "len_name"]
        sizes = [0, 3, 4, 1, 1, 1, 4, 1, 33]
        dim = names.index
        text = lambda s: struct.pack(">i", len(s)) + s.encode() + b"\0" * (-len(s) % 4)
        head = b"CDF\x01" + struct.pack(">i", len(times))
        head += struct.pack(">ii", 10, len(names))
        head += b"".join(text(n) + struct.pack(">i", s) for n, s in zip(names, sizes))
        head += struct.pack(">ii", 0, 0)  # no attributes
        doubles = lambda *v: struct.pack(">%dd" % len(v), *v)
        points = [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)]
        coord = doubles(*(p[a] for a in range(3) for p in points))
        connect = struct.pack(">4i", 1, 2, 3, 4)
        label = b"T".ljust(36, b"\0")
        kind = struct.pack(">ii", 12, 1) + text("elem_type") + struct.pack(">ii", 2, 5) + b"TETRA\0\0\0"
        none = struct.pack(">ii", 0, 0)
        fixed = [("coord", [dim("num_dim"), dim("num_nodes")], none, 6, coord),
                 ("connect1", [dim("num_el_in_blk1"), dim("num_nod_per_el1")], kind, 4, connect),
                 ("name_nod_var", [dim("num_nod_var"), dim("len_name")], none, 2, label)]
        records = [("time_whole", [0], none, 6, 8),
                   ("vals_nod_var1", [0, dim("num_nodes")], none, 6, 32)]

        def header(offsets):
            variables = struct.pack(">ii", 11, len(fixed) + len(records))
            sized = [(n, d, a, t, len(b)) for n, d, a, t, b in fixed] + records
            for (name, dims, attributes, kind_, size), offset in zip(sized, offsets):
                variables += text(name) + struct.pack(">i", len(dims))
                variables += struct.pack(">%di" % len(dims), *dims) + attributes
                variables += struct.pack(">iii", kind_, size, offset)
            return head + variables

        at = len(header([0] * 5))
        offsets = []
        for size in [len(b) for *_, b in fixed] + [8, 32]:
            offsets.append(at)
            at += size
        body = header(offsets) + b"".join(b for *_, b in fixed)
        for i, time in enumerate(times):
            body += doubles(time) + doubles(*[10.0 * i + 1] * 4)
        self.write("e.exo", body)
        return times


class FilesOfSeveralSteps(program.CommandLineTest):
    def test_the_last_step_is_taken_and_said(self):
        path = program.DATA / "readers" / "steps.vtkhdf"
        result = self.succeed("voxelize", path, "-o", "a.vdb", "--resolution", "16", "--grid", "T")
        self.assertIn("has 2 time steps; the last one, at 2, is taken", result.err)
        mesh = self.report_of("info", path)["input"][0]
        self.assertEqual(mesh["steps"], {"count": 2, "times": [0.5, 2.0]})
        self.assertIn("2, from 0.5 to 2", self.succeed("info", path).out)

    def test_every_step_becomes_a_frame(self):
        path = program.DATA / "readers" / "steps.vtkhdf"
        report = self.report_of("voxelize", path, "-o", "a.vdb", "--resolution", "16", "--grid", "T",
                                "--frames", "all")
        self.assertEqual(len(report["frames"]), 2)
        self.assertNotIn("last-step", [warning["code"] for warning in report["warnings"]])
        ranges = [self.report_of("info", f"a.000{i}.vdb")["input"][0]["grids"][0] for i in (1, 2)]
        self.assertLess(ranges[0]["max"], 1000)
        self.assertGreaterEqual(ranges[1]["min"], 1000)


class PolygonsOfCellFormats(program.CommandLineTest):
    def test_they_are_triangles(self):
        volumes = {self.report_of("voxelize", program.DATA / "readers" / name, "-o", "a.vdb",
                                  "--resolution", "32")["grids"][0]["active_voxels"]
                   for name in ("sphere_raw.vtp", "strips.vtp", "strips.vtk", "sphere.vtu")}
        self.assertEqual(len(volumes), 1)


if __name__ == "__main__":
    unittest.main()
