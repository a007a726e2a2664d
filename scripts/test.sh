#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Installs packages, builds everything in Release, runs every test. Arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh --test --python
python=(-DTETVDB_PYTHON=OFF)
if build/python-venv/bin/python -c 'import nanobind, pytest' 2>/dev/null; then
  python=(-DTETVDB_PYTHON=ON -DPython_EXECUTABLE="$PWD/build/python-venv/bin/python")
fi
cmake --preset release -DCMAKE_UNITY_BUILD=ON -DTETVDB_TESTS=ON -DTETVDB_BENCH=ON "${python[@]}"
cmake --build --preset release
ctest --preset release -j "$(nproc)" --no-tests=error "$@"
