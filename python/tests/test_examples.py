# SPDX-License-Identifier: Apache-2.0
"""The programs of python/examples run, where the libraries that they use are installed."""

import pathlib
import subprocess
import sys

import pytest

EXAMPLES = pathlib.Path(__file__).parent.parent / "examples"


@pytest.mark.parametrize("name,library", [("trimesh_solid", "trimesh"), ("pyvista_field", "pyvista"),
                                          ("torch_loader", "torch"),
                                          ("torch_dataset", "torch")])
def test_example(name, library):
    pytest.importorskip(library, reason=f"{library} is not installed: the example needs it")
    run = subprocess.run([sys.executable, EXAMPLES / f"{name}.py"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout
