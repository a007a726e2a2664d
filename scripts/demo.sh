#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# From nothing to a volume: installs packages, builds, turns a real tetrahedral mesh into
# out/quadcopter.vdb and draws it as out/quadcopter.png.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh --demo
cmake --preset release -DTETVDB_TESTS=OFF -DTETVDB_BENCH=OFF
cmake --build --preset release --target tetvdb_cli

mkdir -p out
tetvdb=build/release/bin/tetvdb
"$tetvdb" voxelize tests/data/quadcopter_frame.mesh -o out/quadcopter.vdb --resolution 512

# The picture is made by OpenVDB's own tools: a smooth surface around the voxels, then rays.
surface=out/.quadcopter-surface.vdb
trap 'rm -f "$surface"' EXIT
vdb_tool -quiet -read out/quadcopter.vdb -iso2ls iso=0.5 voxel=0.0006 -gauss iter=1 -write "$surface"
vdb_render "$surface" out/quadcopter.png -res 960x640 -samples 4 \
  -translate 0.06,0.13,0.14 -lookat -0.075,0,-0.075 -up 0,1,0

echo
"$tetvdb" info out/quadcopter.vdb
echo
echo "The volume is out/quadcopter.vdb, its picture out/quadcopter.png; the program is $tetvdb."
