# SPDX-License-Identifier: Apache-2.0
"""Scripts for shells and manual pages know the commands and options that the help knows."""

import re
import shutil
import subprocess
import unittest

from program import PROGRAM, CommandLineTest


class Completions(CommandLineTest):
    def commands(self):
        text = self.succeed("--help").out
        listed = text[text.index("Subcommands:"):text.index("Examples:")]
        return re.findall(r"^  ([a-z]+) ", listed, re.MULTILINE)

    def options(self, command):
        text = self.succeed(command, "--help").out
        text = text[:text.index("Examples:")] if "Examples:" in text else text
        lines = re.findall(r"^  (-[^ ]*)", text, re.MULTILINE)
        return {name for line in lines for name in re.findall(r"--?[a-z][a-z-]*", line)}

    def complete(self, *words):
        """What bash offers for the last of `words`."""
        script = self.write("tetvdb.bash", self.succeed("completions", "bash").out)
        quoted = " ".join(f"'{word}'" for word in ("tetvdb", *words))
        done = subprocess.run(
            ["bash", "-c", f"compopt() {{ :; }}; source {script}; COMP_WORDS=({quoted}); "
             f"COMP_CWORD={len(words)}; _tetvdb; printf '%s\\n' \"${{COMPREPLY[@]}}\""],
            cwd=self.folder, capture_output=True, text=True, check=True)
        return set(done.stdout.split())

    def test_bash(self):
        self.assertEqual(self.complete("") - {"help"}, set(self.commands()))
        self.assertEqual(self.complete("vo"), {"voxelize"})
        for command in ("voxelize", "info", "completions"):
            self.assertEqual(self.complete(command, "-"), self.options(command))
        self.write("part.stl", "x")
        self.assertEqual(self.complete("info", "--hash", "par"), {"part.stl"})

    def test_other_shells(self):
        for shell in ("zsh", "fish"):
            script = self.succeed("completions", shell).out
            for command in self.commands():
                self.assertIn(command, script)
            self.assertIn("resolution", script)
            if shutil.which(shell):
                path = self.write("script", script)
                subprocess.run([shell, "-n", path], check=True)
        self.refuse(2, "completions", "csh")

    def test_manual_pages(self):
        self.succeed("manual", "man1")
        pages = {page.name for page in self.path("man1").iterdir()}
        self.assertEqual(pages, {"tetvdb.1"} | {f"tetvdb-{name}.1" for name in self.commands()})
        for command in self.commands():
            page = self.path(f"man1/tetvdb-{command}.1").read_text().replace("\\-", "-")
            for option in self.options(command):
                self.assertIn(f"\\fB{option}\\fR", page)
            if shutil.which("groff"):
                done = subprocess.run(
                    ["groff", "-man", "-Tascii", "-ww", "-z", self.path(f"man1/tetvdb-{command}.1")],
                    capture_output=True, text=True, check=True)
                self.assertEqual(done.stderr, "")


if __name__ == "__main__":
    unittest.main(verbosity=2)
