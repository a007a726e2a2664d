#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# From nothing to a volume: installs packages, builds, turns a real tetrahedral mesh into
# out/quadcopter.vdb and draws it as out/quadcopter.png.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh --build
cmake --preset release -DCMAKE_UNITY_BUILD=ON -DTETVDB_TESTS=OFF -DTETVDB_BENCH=OFF
cmake --build --preset release --target tetvdb_cli

mkdir -p out
tetvdb=build/release/bin/tetvdb
"$tetvdb" voxelize tests/data/quadcopter_frame.mesh -o out/quadcopter.vdb --resolution 512

"$tetvdb" render out/quadcopter.vdb -o out/quadcopter.png --size 960x640 --up-axis y --view -1,0.9,1.2 --perspective

echo
"$tetvdb" info out/quadcopter.vdb
echo
echo "The volume is out/quadcopter.vdb, its picture out/quadcopter.png; the program is $tetvdb."
