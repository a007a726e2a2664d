#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds everything with another OpenVDB than the system's, and runs the tests.
#
#   scripts/with_openvdb.sh PREFIX [-DOPTION=VALUE of CMake]... [ARGUMENTS OF CTEST]
#
# PREFIX is the folder that OpenVDB 10 to 13 is installed in, with NanoVDB's headers, Blosc and zlib;
# oneTBB and Embree are taken from it too where they are there. The build is
# build/with-openvdb-VERSION.
set -euo pipefail
[[ $# -ge 1 ]] || { sed -n '4,10s/^# \{0,1\}//p' "$0" >&2; exit 2; }
prefix=$(cd "$1" && pwd)
shift
options=()
while [[ ${1-} == -D?*=* ]]; do
  options+=("$1")
  shift
done
cd "$(dirname "$0")/.."

header=$prefix/include/openvdb/version.h
for needed in "$header" "$prefix/include/nanovdb/NanoVDB.h"; do
  [[ -f $needed ]] || { echo "with_openvdb: there is no $needed" >&2; exit 1; }
done
version=$(sed -n 's/^#define OPENVDB_LIBRARY_VERSION_STRING "\(.*\)"/\1/p' "$header")
build=build/with-openvdb-$version

folders=
for folder in "$prefix"/lib "$prefix"/lib64 "$prefix"/lib/*-linux-gnu; do
  if compgen -G "$folder/lib*.so*" >/dev/null; then
    folders+=$folder:
  fi
done
export LD_LIBRARY_PATH=$folders${LD_LIBRARY_PATH:-}

cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DOpenVDB_ROOT="$prefix" \
  -DCMAKE_PREFIX_PATH="$prefix${CMAKE_PREFIX_PATH:+;${CMAKE_PREFIX_PATH//:/;}}" -DCMAKE_UNITY_BUILD=ON \
  -DTETVDB_TESTS=ON -DTETVDB_BENCH=OFF "${options[@]}"
if ! grep -q "^OpenVDB_INCLUDE_DIR:.*=$prefix/" "$build/CMakeCache.txt"; then
  echo "with_openvdb: CMake found another OpenVDB; remove $build and try again" >&2
  exit 1
fi
cmake --build "$build"
echo "with_openvdb: $("$build/bin/tetvdb" --version | tr '\n' ' '), $(
  ldd "$build/bin/tetvdb" | grep -oE 'lib(openvdb|tbb|embree[34])\.so[^ ]*' | tr '\n' ' ')"
ctest --test-dir "$build" --output-on-failure -j "$(nproc)" --no-tests=error "$@"
