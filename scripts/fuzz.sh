#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds the fuzz targets with libFuzzer and the sanitizers and runs each for a while, beginning
# with the meshes of tests/data and, where TETVDB_CORPUS names a folder, of its tet/ and tri/.
#
#   scripts/fuzz.sh [SECONDS each (60; 0: they are only built)] [TARGET...]
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-60}
shift || true
cmake --preset fuzz -DCMAKE_UNITY_BUILD=ON >/dev/null
cmake --build --preset fuzz --target fuzz_targets
[[ $seconds -gt 0 ]] || exit 0

# A target that is named FuzzGmsh takes its seeds from files that it can read; others are harmless.
seeds=build/fuzz/seeds
mkdir -p "$seeds"
for folder in tests/data "${TETVDB_CORPUS:-/nonexistent}"/{tet,tri}; do
  [[ -d $folder ]] || continue
  find "$folder" -type f -size -64k -exec cp -n {} "$seeds" \;
done

export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp
targets=("$@")
if [[ ${#targets[@]} -eq 0 ]]; then
  mapfile -t targets < <(cd build/fuzz/bin && printf '%s\n' Fuzz*)
fi
fuzz() { # target
  local found=build/fuzz/found/$1
  mkdir -p "$found"
  echo "fuzz: $1 for $seconds s"
  if ! build/fuzz/bin/"$1" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2500 \
    -max_len=65536 -artifact_prefix="$found/" -print_final_stats=1 \
    "$found" "$seeds" >build/fuzz/"$1".log 2>&1; then
    tail -40 build/fuzz/"$1".log
    echo "fuzz: $1 FAILED; the input lies in $found"
    return 1
  fi
  local executions edges
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' build/fuzz/"$1".log)
  edges=$(sed -n 's/.*DONE *cov: \([0-9]*\).*/\1/p' build/fuzz/"$1".log)
  echo "fuzz: $1 done, $executions executions, $edges edges of the program covered"
}
export -f fuzz
export seconds seeds
# As many at a time as there are processors.
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}'
