#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Debian 12 packages that TetVDB needs and that are not there yet.
#
#   scripts/setup.sh [--build] [--test] [--python] [--check] [--browser] [--blender]
#                                                                  without options: --build
#
# --build  compiler and libraries      --test   what the tests need besides
# --python  what building the Python module needs, and build/python-venv with pytest to test it
# --check  clang-format, clang-tidy, clang for the fuzzers
# --browser  Chromium, for the test that works the report's page (500 MB)
# --blender  Blender, for the tests that look at volumes in it (up to 1 GB)
set -euo pipefail

build=(g++ cmake ninja-build pkg-config libopenvdb-dev libboost-iostreams-dev libnanovdb-dev
  libblosc-dev libtbb-dev libnetcdf-dev libhdf5-dev libcgns-dev libpugixml-dev zlib1g-dev liblz4-dev liblzma-dev
  libxxhash-dev libembree-dev libopenmesh-dev libassimp-dev libpng-dev libcli11-dev
  nlohmann-json3-dev libfmt-dev libeigen3-dev)
test=(libgtest-dev librapidcheck-dev libbenchmark-dev python3 python3-openvdb
  python3-numpy python3-scipy python3-jsonschema python3-meshio python3-h5py python3-vtk9 python3-tifffile libopenvdb-tools libnanovdb-tools)
python=(python3-dev python3-venv python3-numpy)
check=(clang clang-format-14 clang-tidy-14)
browser=(chromium)
blender=(blender python3 python3-openvdb python3-numpy)

wanted=()
venv=
for option in "${@:---build}"; do
  case $option in
    --build) wanted+=("${build[@]}") ;;
    --test) wanted+=("${build[@]}" "${test[@]}") ;;
    --python) wanted+=("${python[@]}") venv=build/python-venv ;;
    --check) wanted+=("${check[@]}") ;;
    --browser) wanted+=("${browser[@]}") ;;
    --blender) wanted+=("${blender[@]}") ;;
    *) sed -n '4,13s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
  esac
done

missing=()
for package in $(printf '%s\n' "${wanted[@]}" | sort -u); do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
# The module's own tools are Python packages, in an environment of their own.
make_venv() {
  [[ -n $venv ]] || return 0
  cd "$(dirname "$0")/.."
  [[ -x $venv/bin/python ]] || /usr/bin/python3 -m venv --system-site-packages "$venv"
  "$venv/bin/python" -c 'import nanobind, pytest' 2>/dev/null ||
    "$venv/bin/pip" install -q 'nanobind>=2.4' pytest ||
    echo "setup: nanobind and pytest cannot be installed: the Python module is left out" >&2
}

if [[ ${#missing[@]} -eq 0 ]]; then
  make_venv
  echo "setup: everything is installed"
  exit 0
fi

root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: run as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  root=(sudo)
fi
echo "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${root[@]}" apt-get -q update
"${root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get -q -y install --no-install-recommends "${missing[@]}"
make_venv
