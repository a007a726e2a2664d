#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds oneTBB with the thread sanitizer into build/tsan-tbb, from Debian's own source package.
# Debian's binary is not instrumented, and the sanitizer then reports races in every parallel loop
# (silencing tbb::detail would hide the real races of loop bodies too). After it:
#
#   cmake --preset tsan && cmake --build --preset tsan && ctest --preset tsan
set -euo pipefail
cd "$(dirname "$0")/.."

target=$PWD/build/tsan-tbb
if [[ -e $target/lib/libtbb.so.12 ]]; then
  echo "tsan-tbb: already built in $target"
  exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# apt with lists of its own, of the archive that the system's packages come from: fetching sources
# needs neither root nor a change to the system's lists.
mkdir -p "$work/lists/partial" "$work/cache/archives/partial" "$work/source"
read -r mirror suite < <(apt-get indextargets --format '$(REPO_URI) $(CODENAME)' \
  'Created-By: Packages' 'Origin: Debian' | head -1) ||
  { echo "tsan-tbb: apt knows no Debian archive to fetch sources from" >&2; exit 1; }
echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $suite main" \
  >"$work/sources.list"
apt=(-q -o "Dir::Etc::SourceList=$work/sources.list" -o "Dir::Etc::SourceParts=-"
  -o "Dir::State::Lists=$work/lists" -o "Dir::Cache=$work/cache" -o "APT::Sandbox::User=")
apt-get "${apt[@]}" update
(cd "$work/source" && apt-get "${apt[@]}" source --download-only onetbb)
tar -xf "$work"/source/onetbb_*.orig.tar.* -C "$work/source"

cmake -S "$work"/source/oneTBB-*/ -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
  -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF -DCMAKE_INSTALL_LIBDIR=lib \
  -DCMAKE_INSTALL_PREFIX="$target"
cmake --build "$work/build"
cmake --install "$work/build" >/dev/null
echo "tsan-tbb: built in $target"
