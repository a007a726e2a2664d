# SPDX-License-Identifier: Apache-2.0
"""Links of the documentation lead to files, headings and pages that are there."""

import pathlib
import re
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"!?\[[^\]]*\]\(([^()\s]+(?:\([^()]*\))?)\)")


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")),
            *sorted((ROOT / "tests").rglob("*.md")), *sorted((ROOT / "scripts").rglob("*.md"))]


def without_code(text):
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^    .*$", "", text, flags=re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(path):
    """Of the headings of a page, as GitHub and mkdocs spell them."""
    text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.MULTILINE | re.DOTALL)
    found = {}
    for heading in re.findall(r"^#+ +(.+?) *#*$", text, re.MULTILINE):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        slug = re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")
        found[slug] = found.get(slug, -1) + 1
    return set(found) | {f"{slug}-{i}" for slug, n in found.items() for i in range(1, n + 1)}


def dead_links(page):
    for target in LINK.findall(without_code(page.read_text())):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = urllib.parse.unquote(target).partition("#")
        file = (page.parent / path).resolve() if path else page
        if not file.exists():
            yield f"{page.relative_to(ROOT)}: {target}: there is no such file"
        elif ROOT not in file.parents:
            yield f"{page.relative_to(ROOT)}: {target}: leads out of the checkout"
        elif anchor and file.suffix == ".md" and anchor not in anchors(file):
            yield f"{page.relative_to(ROOT)}: {target}: there is no such heading"


class Links(unittest.TestCase):
    def test_links(self):
        self.assertEqual([dead for page in pages() for dead in dead_links(page)], [])

    def test_every_page_is_found(self):
        """From the README, by links."""
        reached, waiting = set(), [ROOT / "README.md"]
        while waiting:
            page = waiting.pop()
            if page in reached:
                continue
            reached.add(page)
            for target in LINK.findall(page.read_text()):
                file = (page.parent / target.partition("#")[0]).resolve()
                if file.suffix == ".md" and file.exists():
                    waiting.append(file)
        missing = {page.name for page in (ROOT / "docs").rglob("*.md")} - {p.name for p in reached}
        self.assertEqual(missing, set())


if __name__ == "__main__":
    unittest.main(verbosity=2)
