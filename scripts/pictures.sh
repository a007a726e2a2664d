#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Makes the pictures of README.md and docs/ anew, from the drone's frame in tests/data.
#
#   scripts/pictures.sh [PROGRAM]      default: build/release/bin/tetvdb
set -euo pipefail
cd "$(dirname "$0")/.."
tetvdb=$(realpath "${1:-build/release/bin/tetvdb}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
frame=tests/data/quadcopter_frame.mesh
eye=(--up-axis y --view -1,0.9,1.2)

"$tetvdb" voxelize "$frame" -o "$work/frame.vdb" --resolution 1024 -q
"$tetvdb" render "$work/frame.vdb" -o docs/images/drone.png --size 720x480 "${eye[@]}" --perspective -q
"$tetvdb" render "$frame" -o docs/images/drone-tets.png --size 720x480 "${eye[@]}" --cut z=0.5 \
  --color quality --wire -q
"$tetvdb" voxelize "$frame" -o "$work/small.vdb" --resolution 96 -q
"$tetvdb" render "$work/small.vdb" -o docs/images/drone-voxels.png --size 720x480 "${eye[@]}" \
  --style voxels -q

# A scan gone wrong: the frame's surface, its z axis up, without every ninth of its faces in one half.
"$tetvdb" repair "$frame" -o "$work/frame.off" --resolution 512 -q
python3 - "$work/frame.off" "$work/broken.off" <<'PYTHON'
import sys
lines = open(sys.argv[1]).read().splitlines()
points, faces, _ = map(int, lines[1].split())
place = [line.split() for line in lines[2:2 + points]]
turned = [f"{p[0]} {-float(p[2])!r} {p[1]}" for p in place]
x = [float(p[0]) for p in place]
middle = (min(x) + max(x)) / 2
kept = [line for i, line in enumerate(lines[2 + points:2 + points + faces])
        if i % 9 or x[int(line.split()[1])] > middle]
with open(sys.argv[2], "w") as out:
    out.write("\n".join([lines[0], f"{points} {len(kept)} 0", *turned, *kept, ""]))
PYTHON
"$tetvdb" voxelize "$work/broken.off" -o "$work/whole.vdb" --resolution 192 \
  --preview docs/images/preview.png -q
ls -l docs/images
