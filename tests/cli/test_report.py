# SPDX-License-Identifier: Apache-2.0
"""`tetvdb report` and its page, in a browser where there is one (Debian's chromium)."""

import fcntl
import json
import os
import re
import shutil
import struct
import subprocess
import unittest

from program import PROGRAM, CommandLineTest, box_faces, lattice, medit, off

CHROMIUM = os.environ.get("TETVDB_CHROMIUM") or shutil.which("chromium")

# Works the page as a person would, and leaves what came of it in the document.
VISITOR = """
<script>
window.addEventListener("load", async () => {
  const result = { errors: window.pageErrors };
  const names = () => [...document.querySelectorAll("#rows tr")].filter(r => !r.hidden)
    .map(r => r.querySelector("td.name b").textContent);
  const head = text => [...document.querySelectorAll("#heads button")].find(b => b.textContent === text);
  try {
    result.start = names();
    head("Size").click(); result.falling = names();
    result.fallingAria = head("Size").parentElement.getAttribute("aria-sort");
    head("Size").click(); result.rising = names();
    const type = (id, text) => {
      const box = document.getElementById(id);
      box.value = text;
      box.dispatchEvent(new Event("input", { bubbles: true }));
    };
    type("text", "open edges"); result.open = names();
    result.shown = document.getElementById("shown").textContent;
    result.pointsOfOne = document.querySelectorAll("#plots circle").length;
    type("text", "no such thing"); result.nothing = names();
    result.noneVisible = !document.getElementById("none").hidden;
    type("text", "");
    type("status", "refused"); result.refused = names();
    type("status", ""); type("defect", "open edges"); result.byDefect = names();
    type("defect", "");
    result.points = document.querySelectorAll("#plots circle").length;
    result.pictures = [];
    for (const image of document.querySelectorAll("#rows img")) {
      image.loading = "eager";
      for (let i = 0; i < 100 && !(image.complete && image.naturalWidth); ++i)
        await new Promise(resolve => setTimeout(resolve, 50));
      result.pictures.push([image.naturalWidth, image.naturalHeight]);
    }
    document.querySelector("#rows td.picture button").click();
    result.dialog = document.getElementById("large").open;
    document.getElementById("large").close();
    const paper = () => getComputedStyle(document.body).backgroundColor;
    const before = paper(); document.getElementById("theme").click();
    result.themes = [before, paper()];
    result.wide = document.documentElement.scrollWidth <= window.innerWidth;
  } catch (error) { result.failed = String(error.stack); }
  const pre = document.createElement("pre");
  pre.id = "result";
  pre.textContent = JSON.stringify(result);
  document.body.replaceChildren(pre);
});
</script>
"""
LISTENER = """<script>
window.pageErrors = [];
window.addEventListener("error", e => window.pageErrors.push(String(e.message)));
</script>
"""


def png_size(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])


NAMES = ["<b>&.off", "box.off", "broken.stl", "cut.off", "deep/open.off", "grid.mesh"]


class ReportTest(CommandLineTest):
    def make_models(self):
        models = self.path("models")
        (models / "deep").mkdir(parents=True)
        points, faces = box_faces()
        (models / "box.off").write_text(off(points, faces))
        (models / "deep" / "open.off").write_text(off(points, faces[:-1]))
        (models / "grid.mesh").write_text(medit(*lattice(3)))
        (models / "broken.stl").write_bytes(b"solid nothing")
        (models / "<b>&.off").write_text(off(points, faces))
        (models / "cut.off").write_text("OFF\n3000000000 1 0\n0 0 0\n")
        (models / "notes.txt").write_text("not a mesh")
        return models

    def data_of(self, page):
        found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
        return json.loads(found.group(1))

    def test_the_page_has_a_row_a_model(self):
        models = self.make_models()
        report = self.report_of("report", models, "-o", self.path("r.html"), "--resolution", "24")
        page = self.path("r.html").read_text()
        data = self.data_of(page)
        rows = {row["name"]: row for row in data["rows"]}
        self.assertEqual(sorted(rows), NAMES)
        self.assertTrue(rows["cut.off"]["verdict"].startswith("line 2: "), rows["cut.off"]["verdict"])
        self.assertEqual(rows["cut.off"]["picture_seconds"], 0)
        drawn = [row for row in data["rows"] if row["picture"]]
        self.assertTrue(all(0 < row["picture_seconds"] < row["seconds"] for row in drawn))
        self.assertAlmostEqual(report["picture_seconds"], sum(row["picture_seconds"] for row in drawn))
        box = rows["box.off"]
        self.assertEqual((box["status"], box["size"], box["defects"]), (0, 12, {}))
        self.assertEqual(box["voxels"], 24 ** 3)
        self.assertIn("input", box["panels"])
        self.assertIn("slice", box["panels"])
        self.assertEqual(rows["grid.mesh"]["kind"], "tets")
        self.assertEqual(rows["grid.mesh"]["tets"], 6 * 27)
        self.assertEqual(rows["deep/open.off"]["defects"]["open edges"], 3)
        broken = rows["broken.stl"]
        self.assertEqual((broken["status"], broken["picture"]), (3, None))
        self.assertTrue(broken["verdict"])
        self.assertNotIn(str(self.folder), broken["verdict"])
        self.assertEqual([m["name"] for m in report["models"]], [r["name"] for r in data["rows"]])

        # Nothing comes from elsewhere.
        self.assertEqual(re.findall(r'(?:src|href)="(?!data:)[^"]*"', page), [])
        self.assertNotIn("http://", page.replace("http://www.w3.org/2000/svg", ""))
        self.assertNotIn("https://", page)
        self.assertNotIn("<b>&.off", page.split('id="data">')[1].split("</script>")[0])
        import base64
        for row in data["rows"]:
            if row["picture"]:
                png = base64.b64decode(row["picture"].split(",")[1])
                self.assertEqual(png_size(png), (row["width"], row["height"]))

    def test_what_a_killed_report_left_is_removed_by_the_next(self):
        self.write("a.off", off(*box_faces()))
        temporary = self.path("temporary")
        temporary.mkdir()
        other = temporary / "tetvdb-report-others"
        other.write_text("no folder")
        environment = {**os.environ, "TMPDIR": str(temporary)}
        arguments = ["report", "a.off", "-o", "r.html", "--resolution", "16"]
        process = subprocess.Popen([PROGRAM, *arguments], cwd=self.folder, env=environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None and not [p for p in temporary.iterdir() if p.is_dir()]:
            pass
        process.kill()
        process.wait()
        left = [p for p in temporary.iterdir() if p.is_dir()]
        if process.returncode < 0:
            self.assertEqual(len(left), 1)
            # Its children end with it, but not at once, and hold the folder's lock too.
            folder = os.open(left[0], os.O_RDONLY)
            fcntl.flock(folder, fcntl.LOCK_EX)
            os.close(folder)
        self.assertFalse(self.path("r.html").exists() and process.returncode < 0)
        self.succeed(*arguments, env=environment)
        self.assertEqual(list(temporary.iterdir()), [other])

    def test_files_by_name_and_bad_usage(self):
        points, faces = box_faces()
        self.write("a.off", off(points, faces))
        self.succeed("report", "a.off", "-o", "r.html", "--resolution", "16", "--mesher", "winding")
        self.assertIn("a.off", self.path("r.html").read_text())
        self.path("r.html").unlink()
        self.refuse(3, "report", "b.off", "-o", "r.html", says="no such file")
        self.refuse(2, "report", "a.off", "-o", "r.png", says="html")
        self.refuse(7, "report", "a.off", "-o", "nowhere/r.html")
        (self.folder / "empty").mkdir()
        self.refuse(3, "report", "empty", "-o", "r.html", says="no mesh files")

    @unittest.skipUnless(CHROMIUM, "chromium is not installed")
    def test_the_page_in_a_browser(self):
        models = self.make_models()
        self.succeed("report", models, "-o", self.path("r.html"), "--resolution", "24")
        page = self.path("r.html").read_text()
        page = page.replace("<head>", "<head>" + LISTENER, 1).replace("</body>", VISITOR + "</body>", 1)
        self.path("visited.html").write_text(page)
        for width, height in ((1400, 900), (500, 900)):
            done = subprocess.run(
                [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                 f"--user-data-dir={self.path('profile')}", f"--window-size={width},{height}",
                 "--enable-logging=stderr", "--virtual-time-budget=20000", "--dump-dom",
                 self.path("visited.html").as_uri()],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
            console = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
            self.assertEqual(console, [])
            found = re.search(r'<pre id="result">(.*?)</pre>', done.stdout, re.S)
            self.assertTrue(found, done.stderr[-2000:])
            import html
            result = json.loads(html.unescape(found.group(1)))
            self.assertNotIn("failed", result, result)
            self.assertEqual(result["errors"], [])
            self.assertEqual(result["start"], NAMES)
            self.assertEqual(result["falling"][0], "grid.mesh")
            self.assertEqual(set(result["falling"][-2:]), {"broken.stl", "cut.off"})  # no size
            self.assertEqual(result["fallingAria"], "descending")
            self.assertEqual(result["rising"][0], "deep/open.off")
            self.assertEqual(set(result["rising"][-2:]), {"broken.stl", "cut.off"})
            self.assertEqual(result["open"], ["deep/open.off"])
            self.assertEqual(result["byDefect"], ["deep/open.off"])
            self.assertEqual(result["shown"], "1 of 6 shown")
            self.assertEqual(result["pointsOfOne"], 2)
            self.assertEqual(result["points"], 8)
            self.assertEqual((result["nothing"], result["noneVisible"]), ([], True))
            self.assertEqual(result["refused"], ["broken.stl", "cut.off"])
            self.assertEqual(len(result["pictures"]), 4)
            self.assertTrue(all(w > 600 and h > 100 for w, h in result["pictures"]))
            self.assertTrue(result["dialog"])
            self.assertNotEqual(*result["themes"])
            self.assertTrue(result["wide"], "the page scrolls sideways")


if __name__ == "__main__":
    unittest.main()
