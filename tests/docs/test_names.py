# SPDX-License-Identifier: Apache-2.0
"""No name in a namespace stands for two types: the linker keeps one of the functions that both have."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN = re.compile(r"(?:inline )?namespace ([\w:]*) ?\{")
END = re.compile(r"\} // namespace")
# Types that belong to another (struct A::B) and declarations are no definitions.
TYPE = re.compile(r"(?:template <.*> )?(?:struct|class|enum|enum class|union) (?:alignas\(\w+\) )?(\w+)"
                  r"(?: final)?(?: : [^;]*)? ?\{")


def types(text):
    """Names of the types that a formatted source file defines outside of unnamed namespaces."""
    spaces = []
    for line in text.splitlines():
        if begin := BEGIN.match(line):
            spaces.append(begin[1])
        elif END.match(line):
            spaces.pop()
        elif (named := TYPE.match(line)) and "" not in spaces:
            yield "::".join([*spaces, named[1]])


class Names(unittest.TestCase):
    def test_types(self):
        found = {}
        for folder in ("lib", "nanovdb_kernels", "apps", "python"):
            for file in sorted((ROOT / folder).rglob("*")):
                if file.suffix in (".h", ".cpp", ".cu"):
                    for name in types(file.read_text()):
                        found.setdefault(name, set()).add(str(file.relative_to(ROOT)))
        self.assertGreater(len(found), 500)
        self.assertEqual({name: files for name, files in found.items() if len(files) > 1}, {})

    def test_what_is_found(self):
        text = "\n".join(["namespace a {", "namespace {", "struct Hidden {", "};", "} // namespace", "struct Open {",
                          "};", "class Later;", "struct Open::Inner {", "class B : public C {", "} // namespace a"])
        self.assertEqual(list(types(text)), ["a::Open", "a::B"])


if __name__ == "__main__":
    unittest.main()
