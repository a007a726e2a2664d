# SPDX-License-Identifier: Apache-2.0
"""Tests that ask Blender, which takes long to start: all questions of a class go to one start.

    class Volumes(blender.Test):
        @blender.asks
        def test_box(self):
            self.succeed("voxelize", self.box(), "-o", "box.vdb")
            answer, = yield [self.question("surface", "box.vdb", grid="density", threshold=0.5)]
            self.assertEqual(answer["open_edges"], 0)
"""

import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

import numpy

import program

BLENDER = os.environ["TETVDB_BLENDER"]
SCRIPTS = HERE.parent.parent / "scripts"


def run_blender(script, *arguments, folder, timeout=240):
    """What Blender says on the way; a script that fails is an error. Add-ons go to `folder`."""
    done = subprocess.run(
        [BLENDER, "-b", "--factory-startup", "--python-exit-code", "1", "--python", str(script),
         "--", *map(str, arguments)],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        timeout=timeout, env={**os.environ, "TETVDB_SCRIPTS": str(SCRIPTS),
                              "BLENDER_USER_SCRIPTS": str(folder)})
    said = done.stdout.decode(errors="replace")
    if done.returncode != 0:
        raise RuntimeError(f"Blender ended with {done.returncode}:\n{said[-4000:]}")
    return said


def asks(generator):
    """A test that yields its questions, once, and is given the answers."""
    @functools.wraps(generator)
    def test(self):
        self.go_on()
    test.generator = generator
    return test


class Test(program.CommandLineTest):
    probe = HERE / "probe.py"

    @classmethod
    def setUpClass(cls):
        cls.root = pathlib.Path(tempfile.mkdtemp(prefix="tetvdb-blender-"))
        cls.addClassCleanup(shutil.rmtree, cls.root, ignore_errors=True)
        cls.waiting, questions = {}, []
        for name in dir(cls):
            if not hasattr(getattr(cls, name), "generator"):
                continue
            test = cls(name)
            test.folder = cls.root / name
            test.folder.mkdir()
            steps = getattr(cls, name).generator(test)
            try:
                asked = next(steps)
                cls.waiting[name] = (steps, len(questions), len(asked))
                questions += asked
            except Exception as error:
                cls.waiting[name] = error
        listed, answers = cls.root / "questions.json", cls.root / "answers.json"
        listed.write_text(json.dumps(questions))
        cls.said = run_blender(cls.probe, listed, answers, folder=cls.root / "scripts")
        cls.version = tuple(map(int, re.search(r"Blender (\d+)\.(\d+)", cls.said).groups()))
        cls.answers = json.loads(answers.read_text())

    def setUp(self):
        self.folder = self.root / self._testMethodName
        self.folder.mkdir(exist_ok=True)

    def go_on(self):
        waiting = self.waiting[self._testMethodName]
        if isinstance(waiting, Exception):
            raise waiting
        steps, first, count = waiting
        answers = self.answers[first:first + count]
        for answer in answers:
            if answer.get("exception"):
                self.fail(answer["exception"])
        try:
            steps.send(answers)
        except StopIteration:
            return
        self.fail("a test asks once")

    def question(self, ask, name, **arguments):
        return {"ask": ask, "path": str(self.path(name)), **arguments}

    def picture_question(self, name, grid, view="z", centre=(0, 0, 0), width=1.0, pixels=32,
                         kind="emission", **arguments):
        save = self.path("%s-%s-%s-%s-%d.npy" % (name, grid, view, kind, len(self.taken)))
        self.taken.append(Picture(save, view, centre, width, pixels))
        return self.question("render", name, grid=grid, kind=kind, view=view, save=str(save),
                             centre=list(centre), width=width, pixels=pixels, **arguments)

    @functools.cached_property
    def taken(self):
        """The pictures asked for, in order."""
        return []


class Picture:
    """An orthographic picture: `values[row, column]` where rows run up and columns to the right,
    along the two world axes that the view sees."""

    AXES = {"x": (1, 2, 0), "y": (0, 2, 1), "z": (0, 1, 2)}

    def __init__(self, path, view, centre, width, pixels):
        self.path, self.axes = path, self.AXES[view]
        self.side = width / pixels
        steps = (numpy.arange(pixels) + 0.5) * self.side - width / 2
        self.u, self.v = (steps + centre[axis] for axis in self.axes[:2])

    @functools.cached_property
    def colors(self):
        return numpy.load(self.path).astype(float)

    @property
    def values(self):
        return self.colors[..., 0]

    def total(self):
        """The integral over the picture."""
        return self.values.sum() * self.side ** 2

    def centroid(self):
        """{axis: coordinate} of the two axes that are seen."""
        weight = self.values.sum()
        return {self.axes[0]: (self.values.sum(0) * self.u).sum() / weight,
                self.axes[1]: (self.values.sum(1) * self.v).sum() / weight}
