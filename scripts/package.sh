#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds the packages: a .deb for this Debian with the program and the library, and a .tar.xz of the
# program alone that brings its libraries along and runs from any folder on systems whose C and C++
# libraries are as new as those named at the end. OpenVDB is linked into the program
# (scripts/package/static_openvdb.sh), which starts in a third of the time then.
#
#   scripts/package.sh [FOLDER]      default: build/packages
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mkdir -p "${1:-build/packages}" && cd "${1:-build/packages}" && pwd)

for tool in patchelf dpkg-shlibdeps; do
  command -v "$tool" >/dev/null || {
    echo "package: installing patchelf and dpkg-dev"
    $([[ $(id -u) -eq 0 ]] || echo sudo) apt-get install -y patchelf dpkg-dev >/dev/null
    break
  }
done
scripts/setup.sh --build
scripts/package/static_openvdb.sh build/openvdb-static
build=build/package
cmake --preset release -B "$build" -DCMAKE_UNITY_BUILD=ON -DTETVDB_PACKAGE=ON -DTETVDB_TESTS=OFF \
  -DTETVDB_BENCH=OFF -DOpenVDB_ROOT="$PWD/build/openvdb-static" -DOPENVDB_USE_STATIC_LIBS=ON >/dev/null
cmake --build "$build" --target tetvdb tetvdb_cli

(cd "$build" && cpack -G DEB -B "$out" >"$out/cpack.log") || {
  tail -20 "$out/cpack.log"
  exit 1
}
rm -rf "$out/_CPack_Packages" "$out/cpack.log"

# The libraries that the program and its module load, but for those of the C and C++ run times.
version=$("$build/bin/tetvdb" --version | cut -d' ' -f2)
name=tetvdb-$version-$(uname -m)
tree=$out/$name
rm -rf "$tree"
cmake --install "$build" --component program --prefix "$tree" --strip >/dev/null
ldd "$build/bin/tetvdb" "$build/bin/tetvdb_formats.so" | awk '$3 ~ /^\// {print $3}' |
  grep -vE '/(libc|libm|libdl|libpthread|librt|libstdc\+\+|libgcc_s|libresolv)\.so' |
  sort -u | xargs -I{} cp -L {} "$tree/lib/tetvdb"
strip --strip-unneeded "$tree"/lib/tetvdb/*
# RPATH, not RUNPATH: the libraries' own libraries are found by it too.
patchelf --force-rpath --set-rpath '$ORIGIN/../lib/tetvdb' "$tree/bin/tetvdb"
for library in "$tree"/lib/tetvdb/*; do
  patchelf --force-rpath --set-rpath '$ORIGIN' "$library"
done
if LD_LIBRARY_PATH='' ldd "$tree/bin/tetvdb" "$tree/lib/tetvdb/tetvdb_formats.so" | awk '$3 ~ /^\// {print $3}' |
  grep -vE "^$tree/|/(libc|libm|libdl|libpthread|librt|libstdc\+\+|libgcc_s|libresolv)\.so"; then
  echo "package: the libraries above are not in the archive"
  exit 1
fi
tar -C "$out" -cJf "$out/$name.tar.xz" "$name"

newest() { # symbol prefix
  objdump -T "$tree/bin/tetvdb" "$tree"/lib/tetvdb/* | grep -o "$1_[0-9.]*" | sort -Vu | tail -1
}
needs="$(newest GLIBC) and $(newest GLIBCXX)"
# From another folder than it was made in.
rm -rf "$tree.tried" && mv "$tree" "$tree.tried"
"$tree.tried/bin/tetvdb" voxelize tests/data/table.msh -o "$out/tried.vdb" --resolution 16 -q ||
  { echo "package: the archive's program does not run"; exit 1; }
"$tree.tried/bin/tetvdb" voxelize tests/data/fenics_checkpoint.xdmf -o "$out/tried.vdb" --resolution 16 -q ||
  { echo "package: the archive's program does not read HDF5 files"; exit 1; }
rm -rf "$tree.tried" "$out/tried.vdb"
ls -sh "$out"/*.deb "$out/$name.tar.xz"
echo "package: $name.tar.xz needs $needs"
