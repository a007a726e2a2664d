# SPDX-License-Identifier: Apache-2.0
"""Folders of the library include each other as docs/architecture.md says, and those that the fuzz targets of readers
are linked from need neither Embree nor OpenMesh."""

import collections
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "lib" / "tetvdb"
INCLUDE = re.compile(r'^\s*#include [<"]([^>"]+)[>"]', re.MULTILINE)


def permitted(text):
    """For each folder those that it may include, from lines as 'a <- {b, c} <- d; e <- d'."""
    below = {}
    for chain in re.split(r"[;\n]", text):
        links = [re.findall(r"\w+", link) for link in chain.split("<-")]
        for lower, upper in zip(links, links[1:]):
            for folder in upper:
                below.setdefault(folder, set()).update(lower)
    for _ in below:
        for folders in below.values():
            folders.update(*(below.get(folder, ()) for folder in list(folders)))
    return below


def documented():
    text = (ROOT / "docs" / "architecture.md").read_text()
    return permitted(re.search(r"Includes have one direction.*?\n\n(.*?)\n\n", text, re.DOTALL)[1])


def includes():
    """Folder, file and what it includes, for all sources of the library."""
    for file in sorted(LIBRARY.rglob("*")):
        if file.suffix in (".h", ".cpp"):
            path = file.relative_to(LIBRARY)
            for name in INCLUDE.findall(file.read_text()):
                yield path.parts[0], str(path), name


class Includes(unittest.TestCase):
    def test_directions(self):
        below = documented()
        for folder, folders in below.items():
            self.assertNotIn(folder, folders)
        count, wrong = 0, []
        for folder, path, name in includes():
            parts = name.split("/")
            if parts[0] == "tetvdb" and len(parts) > 2 and parts[1] != folder:
                count += 1
                if parts[1] not in below.get(folder, ()):
                    wrong.append((path, name))
        self.assertGreater(count, 1000)
        self.assertEqual(wrong, [])

    def test_libraries_of_readers(self):
        readers = {"core", "geometry", "mesh", "volume", "io"}
        found = collections.defaultdict(set)
        for folder, _, name in includes():
            found[name.split("/")[0]].add(folder)
        for library in ("embree3", "embree4", "OpenMesh"):
            self.assertTrue(found[library])
            self.assertEqual(found[library] & readers, set(), library)

    def test_what_is_permitted(self):
        below = permitted("a <- {b, c} <- d; e <- b\nd <- f")
        self.assertEqual(below["f"], {"a", "b", "c", "d", "e"})
        self.assertEqual(below["c"], {"a"})
        self.assertIn("g", permitted("g <- h <- g")["g"])


if __name__ == "__main__":
    unittest.main()
