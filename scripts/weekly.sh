#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# What takes too long for every change: tests at their full sizes, failing calls, random commands,
# fuzzing, hashes, the sanitizers. Hours long. Ends with a table of what ran, for how long and with
# what result, which build/weekly/ keeps with the logs; the status is 0 if nothing failed.
#
#   scripts/weekly.sh [STEP...]    these steps alone: full faults commands fuzz hashes asan tsan
#
#   TETVDB_CORPUS         folder with real meshes; without it tests of the corpus are skipped
#   TETVDB_FUZZ_SECONDS   for each fuzz target (600)
set -uo pipefail
cd "$(dirname "$0")/.." || exit
logs=build/weekly
mkdir -p "$logs"
table=$logs/result.txt
: >"$table"
failed=0

step() { # name, command...
  local name=$1 started=$SECONDS result=passed
  shift
  if [[ ${#chosen[@]} -gt 0 && " ${chosen[*]} " != *" $name "* ]]; then
    echo "$name: not run (not asked for)" >>"$table"
    return
  fi
  echo "== $name: $*"
  if ! "$@" >"$logs/$name.log" 2>&1; then
    result="FAILED, see $logs/$name.log"
    failed=$((failed + 1))
  fi
  local counted skipped
  counted=$(grep -o '[0-9]* tests failed out of [0-9]*' "$logs/$name.log" | tail -1)
  skipped=$(grep -c '\*\*\*Skipped' "$logs/$name.log")
  echo "$name: $result, $((SECONDS - started)) s${counted:+, $counted}, $skipped skipped: $*" | tee -a "$table"
}
preset() { # name, ctest's options...
  local name=$1
  shift
  cmake --preset "$name" -DTETVDB_TESTS=ON && cmake --build --preset "$name" &&
    ctest --preset "$name" -j "$(nproc)" --no-tests=error --timeout 7200 "$@"
}
tsan() {
  [[ -d build/tsan-tbb ]] || scripts/build_tsan_tbb.sh || return
  preset tsan
}

chosen=("$@")
for name in "${chosen[@]}"; do
  if [[ ! $name =~ ^(full|faults|commands|fuzz|hashes|asan|tsan)$ ]]; then
    echo "$name: no step; steps are full faults commands fuzz hashes asan tsan" >&2
    exit 2
  fi
done
step full env TETVDB_TEST_SCALE=4 scripts/test.sh
step faults env TETVDB_FAULTS=50 TETVDB_KILLS=50 ctest --preset release -R '^faults$' --timeout 36000
step commands scripts/fuzz_commands.py --program build/release/bin/tetvdb --seconds 3600
step fuzz scripts/fuzz.sh "${TETVDB_FUZZ_SECONDS:-600}"
step hashes scripts/determinism.py --program build/release/bin/tetvdb --threads 1,2,7,64
step asan preset asan
step tsan tsan
echo
cat "$table"
[[ $failed -eq 0 ]]
