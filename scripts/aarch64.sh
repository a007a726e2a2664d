#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Compiles what is exact (lib/tetvdb/core, lib/tetvdb/geometry) and its tests for AArch64, with the
# options that CMake gives these files, and runs the tests by qemu-user. Installs the cross compiler,
# qemu-user and libraries of AArch64 from Debian's packages, the latter into build/aarch64.
#
#   scripts/aarch64.sh [ARGUMENTS OF GOOGLETEST]
set -euo pipefail
cd "$(dirname "$0")/.."
build=build/aarch64
mkdir -p "$build"

missing=()
for package in g++-aarch64-linux-gnu qemu-user libgtest-dev ninja-build python3; do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
if [[ ${#missing[@]} -gt 0 ]]; then
  echo "aarch64: installing ${missing[*]}"
  $([[ $(id -u) -eq 0 ]] || echo sudo) apt-get -q -y install --no-install-recommends "${missing[@]}"
fi

# Lists of their own: the system's architectures stay as they are.
if [[ ! -d $build/libraries ]]; then
  mkdir -p "$build"/{lists/partial,packages}
  apt=(apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64
    -o "Dir::State::Lists=$PWD/$build/lists" -o APT::Sandbox::User=)
  "${apt[@]}" update
  (cd "$build/packages" && "${apt[@]}" download libtbb12 libfmt9 libxxhash0)
  for package in "$build"/packages/*.deb; do
    dpkg -x "$package" "$build/unpacked"
  done
  mv "$build/unpacked/usr/lib/aarch64-linux-gnu" "$build/libraries"
fi

cmake -S . -B "$build/options" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTETVDB_TESTS=ON -DTETVDB_BENCH=OFF \
  -DTETVDB_CUDA=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >"$build/cmake.log"
python3 - "$build" <<'PYTHON'
import json, pathlib, re, shlex, sys

root, build = pathlib.Path.cwd(), pathlib.Path(sys.argv[1]).resolve()
wanted = re.compile(r"(lib/tetvdb|tests)/(core|geometry)/[^/]*\.cpp")
# Headers that have no architecture are the system's, behind those of the cross compiler.
compiler = "aarch64-linux-gnu-g++ -idirafter /usr/include"
text = ["rule cxx", f"  command = {compiler} $options -MD -MF $out.d -c $in -o $out",
        "  depfile = $out.d", "  deps = gcc",
        "rule link", "  command = aarch64-linux-gnu-g++ $in -pthread -o $out"]
objects = []

def add(source, options):
    objects.append(f"{build}/objects/{len(objects)}.o")
    text.extend([f"build {objects[-1]}: cxx {source}", f"  options = {options}"])

for entry in json.loads((build / "options/compile_commands.json").read_text()):
    source = pathlib.Path(entry["file"])
    if source.is_relative_to(root) and wanted.fullmatch(str(source.relative_to(root))):
        words = shlex.split(entry["command"])
        begin = next(i for i, word in enumerate(words) if re.fullmatch(r".*/(c|g|clang)\+\+[^/]*", word))
        add(source, shlex.join(words[begin + 1:words.index("-o")]).replace("$", "$$"))
if not objects:
    sys.exit("aarch64: CMake knows none of the files")
for name in ("gtest-all", "gtest_main"):
    add(f"/usr/src/googletest/googletest/src/{name}.cc",
        "-O2 -std=c++17 -I/usr/src/googletest/googletest -I/usr/src/googletest/googletest/include")
libraries = sorted(str(path) for path in (build / "libraries").glob("*.so.*")
                   if re.fullmatch(r"lib(tbb|fmt|xxhash)\.so\.\d+", path.name))
text.append(f"build test_exact: link {' '.join(objects + libraries)}")
(build / "build.ninja").write_text("\n".join(text) + "\n")
PYTHON
ninja -C "$build" test_exact
qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="$PWD/$build/libraries" "$build/test_exact" "$@"
