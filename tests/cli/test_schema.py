# SPDX-License-Identifier: Apache-2.0
"""Reports of every command agree with docs/schema, which names every key that they have."""

import copy
import json
import pathlib
import sys
import unittest

from program import (CommandLineTest, ball, box_faces, gmsh, joined, lattice, medit, off, opened)
from test_fields import vtu_with

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed: the schemas are not tested")
    sys.exit(77)

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/schema"
SCHEMAS = {path.name: json.loads(path.read_text()) for path in FOLDER.glob("*.schema.json")}
PRINTER = ["--pixels", "40,30", "--display", "8,6", "--layer-height", "0.5"]


def closed(schema):
    """The same schema, for reports without keys that it does not name."""
    if isinstance(schema, list):
        return [closed(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    made = {key: part if key in ("if", "then", "else") else closed(part)
            for key, part in schema.items()}
    if schema.get("type") in ("object", ["object", "null"]) and "properties" in schema:
        made["additionalProperties"] = False
    return made


def faults(report, schemas):
    name = f"{report['command']}.schema.json"
    resolver = jsonschema.RefResolver(name, schemas[name], store=schemas)
    validator = jsonschema.Draft202012Validator(schemas[name], resolver=resolver)
    return [f"{report['command']} {'/'.join(map(str, e.absolute_path))}: {e.message[:300]}"
            for e in validator.iter_errors(report)]


class Schemas(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.closed = {name: closed(schema) for name, schema in SCHEMAS.items()}
        points, faces = ball(6, 2.0, (0, 0, 2))
        self.write("ball.off", off(points, faces))
        self.write("open.off", off(*opened((points, faces))))
        self.write("box.off", off(*box_faces()))
        self.write("two.off", off(*joined(box_faces(), box_faces((3.0, 0.0, 0.0), (4.0, 1.0, 1.0)))))
        self.write("island.off", off(*joined(box_faces(), box_faces((3.0, 0.0, 2.0), (4.0, 1.0, 4.0)))))
        self.write("rod.off", off(*box_faces((-30.0, 0.0, 0.0), (5000.0, 20.0, 20.0))))
        points, tets = lattice(2)
        self.write("cube.msh", gmsh(points, tets, [1 + i % 2 for i in range(len(tets))],
                                    {1: "one", 2: "two"}))
        self.write("cube.mesh", medit(points, tets))
        for i in (1, 2):
            self.write(f"run.{i}.vtu", vtu_with(points, tets, [("t", [i + p[0] for p in points])]))
        self.seen = set()

    def check(self, *arguments, status=0):
        result = self.run_program(*arguments, "--json", "report.json", "--force")
        self.assertEqual(result.status, status, f"{arguments}: {result.err}")
        report = json.loads(self.path("report.json").read_text())
        self.assertEqual(faults(report, SCHEMAS), [], arguments)
        self.assertEqual(faults(report, self.closed), [], arguments)
        self.seen.add(report["command"])
        return report

    def test_the_schemas_are_schemas(self):
        for schema in SCHEMAS.values():
            jsonschema.Draft202012Validator.check_schema(schema)

    def test_reports(self):
        check = self.check
        size = ("--resolution", 12)
        check("voxelize", "ball.off", "-o", "ball.vdb", *size, "--grid", "density,surface,coverage",
              "--preview", "p.png")
        check("voxelize", "open.off", "-o", "env.vdb", "--resolution", 6, "--mesher", "envelope",
              "--grid", "density,tet_id", "--write-mesh", "tets.msh")
        check("voxelize", "cube.msh", "-o", "cube.nvdb", *size, "--grid", "density,material")
        check("voxelize", "run.1.vtu", "-o", "t.npz", "--fit", 8, "--grid", "density,t")
        check("voxelize", "run.*.vtu", "-o", "run.vdb", "--frames", "all", *size)
        for shard in ("0/2", "1/2"):
            check("voxelize", "rod.off", "-o", "rod.vdb", "--voxel-size", 1, "--grid", "mask",
                  "--shard", shard)
        check("voxelize", "ball.off", "--tiles", "tiles", *size)
        check("voxelize", "ball.off", "-o", "levels.vdb", *size, "--lod", "1:2")
        check("convert", "ball.vdb", "--tiles", "more")
        check("voxelize", "ball.off", "-o", "x.vdb", "--grid", "nothing", status=2)
        check("voxelize", "none.off", "-o", "x.vdb", status=3)
        check("plan", "rod.off", "--voxel-size", 1, "--shards", 2)
        check("plan", "cube.msh", *size, "--prepare", "parts", "--shards", 2, "--grid", "tet_id")
        check("plan", "ball.off", *size, "--prepare", "parts", status=2)
        check("voxelize", "parts", "-o", "parts.vdb", "--grid", "tet_id")
        check("merge", "rod.0-of-2.vdb", "rod.1-of-2.vdb", "-o", "merged.vdb")
        check("merge", "rod.0-of-2.vdb", "-o", "merged2.vdb", status=3)
        check("tetrahedralize", "box.off", "-o", "box.msh", "--epsilon", "1e-2d")
        check("tetrahedralize", "none.off", "-o", "box.msh", status=3)
        check("info", "ball.off", "open.off", "cube.msh", "run.1.vtu", "ball.vdb", "cube.nvdb", "--hash")
        check("info", "ball.off", "none.off", status=3)
        check("info", "none.off", status=3)
        check("compare", "ball.vdb", "env.vdb", status=8)
        check("compare", "ball.off", "open.off", "-o", "c.png", status=8)
        check("compare", "ball.vdb", "ball.vdb", "-o", "d.png")
        check("repair", "open.off", "-o", "closed.stl")
        check("repair", "open.off", "-o", "remade.3mf", "--remesh", *size)
        check("repair", "two.off", "box.off", "-o", "two.3mf", "--smooth", 0.05)
        check("repair", "ball.vdb", "-o", "surface.obj")
        check("repair", "none.off", "-o", "closed.stl", status=3)
        check("convert", "ball.off", "-o", "ball.stl")
        check("convert", "cube.msh", "-o", "cube.vtu")
        check("convert", "ball.vdb", "-o", "ball.npz")
        check("convert", "run.0*.vdb", "-o", "run.npz")
        check("prepare", "ball.off", "-o", "hollow.stl", "--hollow", 0.5, "--voxel-size", 0.25)
        check("slice", "ball.off", "-o", "ball.sl1", *PRINTER)
        check("slice", "cube.msh", "-o", "cube", *PRINTER, "--materials")
        check("render", "ball.vdb", "-o", "ball.png", "--size", "32x32")
        check("render", "run.1.vtu", "-o", "t.png", "--size", "320x240", "--color", "t")
        check("render", "open.off", "-o", "o.png", "--size", "320x240", "--defects")
        check("check", "ball.vdb", "--target", "blender")
        check("check", "rod.0-of-2.vdb", "--target", "blender", status=8)
        check("check", "ball.off", "--target", "sla", *PRINTER)
        check("check", "island.off", "--target", "sla", *PRINTER, status=8)
        check("report", "ball.off", "open.off", "-o", "r.html", *size)
        self.path("models").mkdir()
        self.path("models/box.off").write_text(self.path("box.off").read_text())
        check("dataset", "models", "-o", "set", *size, "--workers", 1)
        check("dataset", "models", "-o", "half", *size, "--workers", 1, "--shard", "0/2")
        check("formats")
        check("grids")
        check("completions", "bash")
        check("manual", "man1")
        self.assertEqual({f"{name}.schema.json" for name in self.seen} | {"common.schema.json"},
                         set(SCHEMAS))

    def test_other_reports_are_refused(self):
        report = self.check("voxelize", "ball.off", "-o", "ball.vdb", "--resolution", 8)
        for path, value in ((("status",), "0"), (("status",), 9), (("grids", 0, "active_voxels"), -1),
                            (("grids", 0, "name"), 5), (("input", 0, "path"), None),
                            (("mesh", "inside"), "somehow"), (("transform", 0), [1, 2, 3])):
            wrong = copy.deepcopy(report)
            at = wrong
            for key in path[:-1]:
                at = at[key]
            at[path[-1]] = value
            self.assertNotEqual(faults(wrong, SCHEMAS), [], path)
        for key in ("output", "grids", "warnings"):
            wrong = copy.deepcopy(report)
            del wrong[key]
            self.assertNotEqual(faults(wrong, SCHEMAS), [], key)
        self.assertEqual(faults({**report, "later": 1}, SCHEMAS), [])
        self.assertEqual(len(faults({**report, "later": 1}, self.closed)), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
