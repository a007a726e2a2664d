#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds the system's version of OpenVDB as a static library, for programs that start fast: most of
# the start of a program that loads the shared one is the relocation of its 60 MB.
#
#   scripts/package/static_openvdb.sh PREFIX [SOURCE]
#
# PREFIX gets the library, its headers and NanoVDB's; where they are, nothing is done. SOURCE is a
# folder with OpenVDB's source; without it Debian's source package is taken, by apt.
set -euo pipefail
[[ $# -ge 1 ]] || { sed -n '4,10s/^# \{0,1\}//p' "$0" >&2; exit 2; }
prefix=$(mkdir -p "$1" && cd "$1" && pwd)
[[ ! -f $prefix/LICENSE.openvdb ]] || exit 0 # which comes last
work=$prefix/work
rm -rf "$work"
mkdir -p "$work"/{parts,lists/partial}

source=${2:-}
if [[ -z $source ]]; then
  # Lists of source packages of their own: the system's settings stay as they are.
  for file in /etc/apt/sources.list.d/*.sources; do
    [[ ! -f $file ]] || sed 's/^Types:.*/Types: deb-src/' "$file" >"$work/parts/${file##*/}"
  done
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [[ ! -f $file ]] || sed -n 's/^deb /deb-src /p' "$file" >"$work/parts/${file##*/}.list"
  done
  apt=(apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$work/parts"
    -o Dir::State::lists="$work/lists" -o Dir::Cache::srcpkgcache= -o Dir::Cache::pkgcache=
    -o APT::Sandbox::User=)
  version=$(dpkg-query -W -f '${Version}' libopenvdb-dev)
  (cd "$work" && "${apt[@]}" update && "${apt[@]}" source --download-only --tar-only "openvdb=$version")
  tar -C "$work" -xf "$work"/openvdb_*.orig.tar.*
  source=$(echo "$work"/openvdb-*/)
fi

echo "static_openvdb: building $source"
cmake -Wno-deprecated -S "$source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
  -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DOPENVDB_CORE_SHARED=OFF \
  -DOPENVDB_CORE_STATIC=ON -DOPENVDB_BUILD_BINARIES=OFF -DUSE_EXPLICIT_INSTANTIATION=OFF \
  -DUSE_IMATH_HALF=ON -DUSE_NANOVDB=ON -DNANOVDB_BUILD_TOOLS=OFF >"$work/log" &&
  cmake --build "$work/build" --target install >>"$work/log" || {
  tail -30 "$work/log" >&2
  exit 1
}
cp "$source/LICENSE" "$prefix/LICENSE.openvdb"
rm -rf "$work"
